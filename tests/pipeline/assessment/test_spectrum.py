"""The rocking spectrum is the response of every single block, and rests where nothing can be lifted."""

import numpy as np
import pytest

from rockpulse.assessment.spectrum import rocking_spectrum
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


def test_blocks_rest_where_the_record_is_too_weak_to_lift_them():
    spectrum = rocking_spectrum(SINE, P, ALPHA)
    rest = np.max(np.abs(SINE.acceleration)) <= 9.80665 * np.tan(ALPHA)
    assert np.array_equal((spectrum["outcome"] == Outcome.AT_REST).all("p"), rest)
    assert rest.tolist() == [False, False, False, True]


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
