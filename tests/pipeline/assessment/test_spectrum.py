"""The rocking spectrum is the response of every single block, and rests where nothing can be lifted."""

import numpy as np
import pytest

from rockpulse.assessment import spectra as module
from rockpulse.assessment.spectra import rocking_spectrum
from rockpulse.models import Block, Outcome, recorded_response
from rockpulse.record.record import Record

SINE = Record(3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01)), dt=0.01, id="one sine")
P, ALPHA = np.array([1.0, 2.0, 4.0]), np.array([0.1, 0.25, 0.29, 0.31])


@pytest.mark.parametrize("restitution", ["housner", 0.8])
def test_every_cell_is_the_response_of_that_block(restitution):
    spectrum = rocking_spectrum(SINE, P, ALPHA, restitution=restitution)
    for alpha in ALPHA:
        for p in P:
            block = Block.from_parameters(p=p, alpha=alpha, restitution=restitution)
            response = recorded_response(block, SINE.acceleration, SINE.dt)
            cell = spectrum.sel(p=p, alpha_c=alpha)
            assert int(cell["outcome"]) == response.outcome
            assert float(cell["peak_rotation_ratio"]) == response.peak_rotation_ratio
            assert float(cell["restitution"]) == block.restitution


def test_the_blocks_of_the_default_are_those_of_the_documentation():
    """R = 3 g/(4 p^2) from 7.4 m to 0.2 m and slenderness from 20 to 2.4, both in even steps."""
    assert 3.0 * 9.80665 / (4.0 * np.array(module.P)[[0, -1]] ** 2) == pytest.approx([7.355, 0.2043], abs=0.0005)
    assert 1.0 / np.tan(np.array(module.ALPHAS)[[0, -1]]) == pytest.approx([19.98, 2.365], abs=0.005)
    assert np.diff(module.P) == pytest.approx(0.05)
    assert np.diff(module.ALPHAS) == pytest.approx(0.005)
    assert (module.P[7], module.ALPHAS[7]) == (1.35, 0.085)  # as they are written


def test_the_vertical_acts_and_gravity_is_that_of_the_place():
    up = 2.0 * np.cos(5.0 * SINE.time)
    found = rocking_spectrum(SINE, P, ALPHA, vertical=up, gravity=3.7)
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution="housner", gravity=3.7)
    expected = recorded_response(block, SINE.acceleration, SINE.dt, vertical=up)
    assert found["peak_rotation_ratio"].sel(p=2.0, alpha_c=0.25).item() == expected.peak_rotation_ratio
    assert found.attrs == {"record": "one sine", "scale": 1.0, "gravity": 3.7}


def test_blocks_rest_where_the_record_is_too_weak_to_lift_them():
    spectrum = rocking_spectrum(SINE, P, ALPHA)
    rest = np.max(np.abs(SINE.acceleration)) <= 9.80665 * np.tan(ALPHA)
    assert np.array_equal((spectrum["outcome"] == Outcome.AT_REST).all("p"), rest)
    assert rest.tolist() == [False, False, False, True]


def test_a_spectrum_of_one_cell_is_that_cell():
    whole = rocking_spectrum(SINE, P, ALPHA).sel(p=[2.0], alpha_c=[0.25])
    assert whole.identical(rocking_spectrum(SINE, [2.0], [0.25]))


def test_a_factor_on_the_record_scales_it():
    twice = Record(2.0 * SINE.acceleration, dt=SINE.dt, id=SINE.id)
    found, expected = rocking_spectrum(SINE, P, ALPHA, scale=2.0), rocking_spectrum(twice, P, ALPHA)
    assert np.array_equal(found["outcome"], expected["outcome"])
    assert found.attrs["scale"] == 2.0


def test_every_variable_has_its_unit_and_meaning():
    spectrum = rocking_spectrum(SINE, P, ALPHA)
    for variable in spectrum.variables.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
    assert spectrum["p"].attrs["units"] == "s-1"
