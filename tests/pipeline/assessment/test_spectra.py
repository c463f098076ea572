"""The overturning spectrum of a record and what bodies read from it; the rocking spectrum and every single block."""

import math

import numpy as np
import pytest
import xarray as xr

import rockpulse as rp
from rocking import OverturningSpectrum, spectrum_lanes
from rockpulse.assessment.spectra import (
    overturning_factors,
    overturning_spectrum,
    rocking_spectrum,
    stored_spectrum_values,
)
from rockpulse.models import Block, recorded_response
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import LEVELS, ROTATIONS
from synthetic import synthetic_motion

RECORD = rp.Record(synthetic_motion(3, pga=3.0)[:2000], dt=0.01, id="synthetic", processed=True)
P = np.array([1.5, 1.7, 1.9])
C = np.array([0.85, 0.95])
BODIES = Block.from_parameters(p=[1.5, 1.7, 1.9], alpha=[0.1, 0.2, 0.25], restitution=[0.85, 0.95, 0.85], log=False)


@pytest.fixture(scope="module")
def spectrum():
    return overturning_spectrum(RECORD, P, C)


def test_the_variables_tell_their_units_and_axes(spectrum):
    assert spectrum["spectrum"].dims == ("p", "restitution")
    assert spectrum["probability"].dims == ("p", "restitution", "level")
    assert spectrum["rotation_spectrum"].dims == ("rotation", "p", "restitution")
    assert spectrum["spectrum"].attrs["units"] == "m s^-1"
    assert spectrum["p"].attrs["units"] == "s^-1"
    assert spectrum["level"].values.tolist() == LEVELS.tolist()
    assert spectrum["rotation"].values.tolist() == ROTATIONS.tolist()
    assert spectrum.attrs == {"record": "synthetic", "method": "nonlinear"}


def test_the_interval_holds_the_spectrum_and_probability_reaches_both_ends(spectrum):
    assert np.all(spectrum["spectrum_low"] < spectrum["spectrum"])
    assert np.all(spectrum["spectrum"] < spectrum["spectrum_high"])
    assert np.all((spectrum["probability"] >= 0.0) & (spectrum["probability"] <= 1.0))
    assert np.all(spectrum["probability"][..., 0] < 1e-3)
    assert np.all(spectrum["probability"][..., -1] > 0.999)
    # A smaller rotation is reached by a weaker motion: it takes more from the record.
    assert np.all(spectrum["rotation_spectrum"].diff("rotation") <= 1e-12)


def test_on_the_axes_a_body_reads_what_it_reads_from_the_lanes(spectrum):
    read = overturning_factors(spectrum, BODIES)
    direct = OverturningSpectrum(spectrum_lanes(RECORD.acceleration, RECORD.dt, P)).factors(BODIES)
    assert read["factor_mean"] == pytest.approx(direct.factor_mean, rel=1e-3)
    assert read["factor_10"] == pytest.approx(direct.factor_10, rel=0.01)
    assert read["factor_50"] == pytest.approx(direct.factor_50, rel=0.01)
    assert read["overturning_probability"] == pytest.approx(direct.at_one, abs=0.01)


def test_restitutions_that_the_lanes_do_not_reach_are_gaps(spectrum):
    lanes = OverturningSpectrum(spectrum_lanes(RECORD.acceleration, RECORD.dt, P), rp.models.Uncertainty())
    found = stored_spectrum_values(lanes, np.array([0.5, C[0], 0.6, C[1]]))
    assert set(found) == set(spectrum.data_vars)
    for name, values in found.items():
        axis = spectrum[name].dims.index("restitution")
        np.testing.assert_array_equal(np.take(values, [1, 3], axis=axis), spectrum[name].values)
        assert np.isnan(np.take(values, [0, 2], axis=axis)).all()
    none = stored_spectrum_values(lanes, np.array([0.5]))
    assert {name: values.shape for name, values in none.items()} == {
        "spectrum": (3, 1),
        "spectrum_low": (3, 1),
        "spectrum_high": (3, 1),
        "rotation_spectrum": (ROTATIONS.size, 3, 1),
        "probability": (3, 1, LEVELS.size),
    }
    assert all(np.isnan(values).all() for values in none.values())


def test_between_the_axes_the_logarithm_is_linear():
    """On a made-up spectrum S = p^2 with P a step, the capacity of any p is g tan(alpha)/p^3."""
    p, level = np.array([1.0, 2.0]), np.array([0.5, 0.999, 1.001, 2.0])
    made = xr.Dataset(
        {
            "spectrum": (("p", "restitution"), (p**2)[:, None]),
            "probability": (("p", "restitution", "level"), np.broadcast_to([0.0, 0.0, 1.0, 1.0], (2, 1, 4))),
        },
        {"p": p, "restitution": [0.9], "level": level},
    )
    block = Block.from_parameters(p=math.sqrt(2.0), alpha=0.1, restitution=0.9, log=False)
    read = overturning_factors(made, block)
    assert read["factor_mean"] == pytest.approx([block.gravity * math.tan(0.1) / math.sqrt(2.0) ** 3])
    assert read["factor_50"] == pytest.approx(read["factor_mean"], rel=1e-6)


@pytest.mark.parametrize(
    "block",
    [
        Block.from_parameters(p=3.0, alpha=0.1, restitution=0.9, log=False),
        Block.from_parameters(p=1.7, alpha=0.1, restitution=0.7, log=False),
        Block.from_parameters(p=1.7, alpha=0.5, restitution=0.9, log=False),
    ],
)
def test_a_body_outside_the_spectrum_is_refused(spectrum, block):
    with pytest.raises(ValueError, match="not 1 of 1"):
        overturning_factors(spectrum, block)


def test_without_rotations_all_else_is_the_same(spectrum):
    xr.testing.assert_identical(overturning_spectrum(RECORD, P, C, rotations=False), spectrum.drop_dims("rotation"))


def test_an_unknown_method_is_refused():
    with pytest.raises(ValueError, match="nonlinear, rule"):
        overturning_spectrum(RECORD, P, C, method="linear")


def test_by_the_rule_nothing_overturns_before_it_lifts():
    """Half-waves of many seconds: a block falls as soon as it is lifted, at the peak."""
    slow = rp.Record(np.sin(np.pi * np.arange(0.0, 20.005, 0.01) / 10.0), dt=0.01, id="slow", processed=True)
    p = np.array([6.0, 8.0])
    found = overturning_spectrum(slow, p, C, method="rule")["spectrum"].values
    assert np.all(found <= slow.pga / p[:, np.newaxis] * 1.05)  # 4 % of the angle is lost in the mean
    assert np.all(found > slow.pga / p[:, np.newaxis])


def test_the_rule_takes_no_other_uncertainty():
    with pytest.raises(ValueError, match="method 'rule' was fitted with the default, and accepts no other"):
        overturning_spectrum(RECORD, P, C, method="rule", uncertainty=rp.models.Uncertainty(factor=0.2))


SINE = Record(3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01)), dt=0.01, id="one sine")
CELL_P, CELL_ALPHA = np.array([1.0, 2.0, 4.0]), np.array([0.1, 0.25, 0.29, 0.31])


@pytest.mark.parametrize("restitution", ["housner", 0.8])
def test_every_cell_is_the_response_of_that_block(restitution):
    spectrum = rocking_spectrum(SINE, CELL_P, CELL_ALPHA, restitution=restitution)
    for alpha in CELL_ALPHA:
        for p in CELL_P:
            block = Block.from_parameters(p=p, alpha=alpha, restitution=restitution)
            response = recorded_response(block, SINE.acceleration, SINE.dt)
            cell = spectrum.sel(p=p, alpha_c=alpha)
            assert int(cell["outcome"]) == response.outcome
            assert float(cell["peak_rotation_ratio"]) == response.peak_rotation_ratio
            assert float(cell["restitution"]) == block.restitution


def test_the_vertical_acts_and_gravity_is_that_of_the_place():
    up = 2.0 * np.cos(5.0 * SINE.time)
    found = rocking_spectrum(SINE, CELL_P, CELL_ALPHA, vertical=up, gravity=3.7)
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution="housner", gravity=3.7)
    expected = recorded_response(block, SINE.acceleration, SINE.dt, vertical=up)
    assert found["peak_rotation_ratio"].sel(p=2.0, alpha_c=0.25).item() == expected.peak_rotation_ratio
    assert found.attrs == {"record": "one sine", "scale": 1.0, "gravity": 3.7}


def test_a_factor_on_the_record_scales_it():
    twice = Record(2.0 * SINE.acceleration, dt=SINE.dt, id=SINE.id)
    found, expected = (
        rocking_spectrum(SINE, CELL_P, CELL_ALPHA, scale=2.0),
        rocking_spectrum(twice, CELL_P, CELL_ALPHA),
    )
    assert np.array_equal(found["outcome"], expected["outcome"])
    assert found.attrs["scale"] == 2.0
