"""The stored reference of the accuracy report, and the script that makes it."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from laboratory.accuracy.reference import load_reference, motion_of
from rockpulse.errors import RockpulseError
from rockpulse.record.conditioning import condition

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def stored():
    return load_reference()


@pytest.fixture(scope="module")
def conditioned(ridgecrest):
    return {record.id: condition(record) for record in ridgecrest if record.orientation == "horizontal"}


def first(table, **wanted):
    """The first row with these values."""
    for name, value in wanted.items():
        table = table[table[name] == value]
    return next(table.itertuples())


def test_columns_are_consistent(stored):
    assert np.array_equal(np.isinf(stored["peak"]), stored["outcome"] == "OVERTURNS")
    assert np.array_equal(stored["peak"] == 0.0, stored["outcome"] == "AT_REST")
    nonlinear_overturns = (stored["outcome"] == "OVERTURNS") & (stored["equation"] == "nonlinear")
    assert np.array_equal(np.isfinite(stored["overturning_time"]), nonlinear_overturns)
    assert stored["impacts"].dtype.kind == "i"
    assert not stored["spread"].isna().any()
    flips = (stored["outcome"] != stored["lowered_outcome"]) | (stored["outcome"] != stored["scaled_outcome"])
    assert np.array_equal(np.isinf(stored["spread"]), flips)
    assert "140-bit numbers" in stored.attrs["provenance"]


def test_synthetic_motions_are_those_of_the_reference(stored):
    """Twenty motions, each checked by its SHA-256 in `motion_of`."""
    for row in stored.drop_duplicates("motion").itertuples():
        if row.motion.startswith("synthetic-"):
            acceleration, dt = motion_of(row)
            assert (acceleration.size, dt) == (6001, 0.01)


def test_sample_motions_are_those_of_the_reference(stored, conditioned):
    rows = [row for row in stored.drop_duplicates("motion").itertuples() if not row.motion.startswith("synthetic-")]
    assert {row.motion for row in rows} == set(conditioned)
    for row in rows:
        acceleration, dt = motion_of(row, conditioned)
        assert acceleration == pytest.approx(conditioned[row.motion].acceleration, abs=1e-9)
        assert dt == conditioned[row.motion].dt


def test_other_samples_than_those_of_the_reference_are_refused(stored, conditioned):
    row = next(row for row in stored.itertuples() if row.motion in conditioned)
    record = conditioned[row.motion]
    changed = {row.motion: replace(record, acceleration=record.acceleration * 1.001)}
    with pytest.raises(RockpulseError, match="the reference does not apply"):
        motion_of(row, changed)


@pytest.mark.parametrize(
    ("equation", "outcome"),
    [
        ("linear", "OVERTURNS"),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in (("linear", "ROCKS"), ("nonlinear", "OVERTURNS"))),
    ],
)
def test_script_makes_the_stored_answer_again(stored, make_reference, equation, outcome):
    """To all stored digits but the last few, whichever library of numbers is installed."""
    # The earliest fall is the shortest computation; rows without a time of falling stay in their order.
    row = first(stored.sort_values("overturning_time", kind="stable"), equation=equation, outcome=outcome)
    case = next(case for case in make_reference.synthetic_cases() if case.name == row.case)
    made = dict(zip(make_reference.COLUMNS, make_reference.row(case), strict=True))
    for name in ("motion_sha256", "dt", "scale", "p", "alpha", "restitution", "outcome", "lowered_outcome", "impacts"):
        assert made[name] == getattr(row, name)
    assert made["overturning_time"] == pytest.approx(row.overturning_time, rel=1e-15, nan_ok=True)
    for name in ("peak_text", "lowered_peak_text", "scaled_peak_text"):
        assert_same_digits(made[name], getattr(row, name))


def assert_same_digits(made, stored):
    if not math.isfinite(float(stored)):
        assert made == stored
        return
    context = mpmath.MPContext()
    context.dps = 40
    assert abs(context.mpf(made) - context.mpf(stored)) <= context.mpf(10) ** -21 * context.mpf(stored)
