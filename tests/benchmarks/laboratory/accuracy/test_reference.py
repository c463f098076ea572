"""The stored reference of the accuracy report, and the script that makes it."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from laboratory.accuracy.reference import TABLE, load_reference, motion_of
from rocking.response import Outcome
from rockpulse.errors import RockpulseError
from rockpulse.record.conditioning import condition

pytestmark = pytest.mark.sweep


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


def test_table_has_enough_cases_of_every_kind(stored):
    synthetic = stored[stored["motion"].str.startswith("synthetic-")]
    assert synthetic["motion"].nunique() >= 20
    assert np.count_nonzero(synthetic["equation"] == "linear") >= 200
    assert np.count_nonzero(synthetic["equation"] == "nonlinear") >= 120
    assert set(stored["outcome"]) == {"AT_REST", "ROCKS", "OVERTURNS"} < set(Outcome.__members__)
    assert np.mean(synthetic["outcome"] == "AT_REST") < 0.05
    assert stored["case"].is_unique
    assert TABLE.stat().st_size < 300_000


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


def test_spread_keeps_the_digits_that_a_difference_of_floats_loses(stored):
    rocks = stored[(stored["outcome"] == "ROCKS") & np.isfinite(stored["spread"])]
    assert np.min(rocks["spread"]) < 1e-17 < np.max(rocks["spread"])
    assert np.median(rocks["spread"]) > 0.0


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


def test_record_that_is_missing_is_named(stored):
    row = next(row for row in stored.itertuples() if not row.motion.startswith("synthetic-"))
    with pytest.raises(RockpulseError, match="which is not among those given") as raised:
        motion_of(row)
    assert row.motion in str(raised.value)


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
        *(pytest.param(*case, marks=pytest.mark.sweep) for case in (("linear", "ROCKS"), ("nonlinear", "OVERTURNS"))),
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


def test_run_goes_on_where_the_last_one_stopped(make_reference, tmp_path, monkeypatch):
    cases = list(make_reference.synthetic_cases())[:3]
    monkeypatch.setattr(make_reference, "synthetic_cases", lambda: cases)
    monkeypatch.setattr(make_reference, "sample_cases", list)
    monkeypatch.setattr(make_reference, "row", lambda case: [case.name] + ["0"] * 17)
    path = tmp_path / "table.csv"
    for most in ("1", "5"):
        monkeypatch.setattr("sys.argv", ["make_reference.py", "--output", str(path), "--most", most])
        make_reference.main()
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    assert lines[0] == ",".join(make_reference.COLUMNS)
    assert [line.split(",")[0] for line in lines[1:]] == [case.name for case in cases]
