"""Record: what it accepts, its derived numbers, its id."""

import math
import pickle
from dataclasses import FrozenInstanceError
from datetime import UTC, datetime

import numpy as np
import pytest
import scipy.constants
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.errors import RecordFormatError
from rockpulse.record.record import STANDARD_GRAVITY, Record, distinct_ids, id_matches, outline_of, record_id

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)


def record(name="a", values=(0.0, 1.0, -2.0), **fields) -> Record:
    return Record(acceleration=np.array(values), dt=0.01, id=name, **fields)


def test_derived_numbers():
    one = record()
    assert (one.npts, one.duration, one.pga) == (3, 0.02, 2.0)
    assert one.unit_factor == 1.0  # of samples that are given in m/s2
    assert one.time == pytest.approx([0.0, 0.01, 0.02])


def test_samples_beyond_any_ground_motion_are_refused():
    assert record(values=(0.0, -1e9)).pga == 1e9
    for value in (-1e200, -1.001e9):
        with pytest.raises(
            RecordFormatError, match=rf"sample 1 is {value:.3g} m/s2, too large for ground motion".replace("+", r"\+")
        ):
            record(values=(0.0, value))


def test_samples_are_a_read_only_copy():
    values = np.array([0.0, 1.0, 2.0])
    one = Record(acceleration=values, dt=0.01, id="a")
    values[0] = 5.0
    assert one.acceleration[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        one.acceleration[0] = 1.0
    locked = values.view()
    locked.flags.writeable = False  # the array below is not
    one = Record(acceleration=locked, dt=0.01, id="a")
    values[1] = 5.0
    assert one.acceleration[1] == 1.0
    with pytest.raises(FrozenInstanceError):
        one.dt = 1.0  # type: ignore[misc]


@pytest.mark.parametrize("values", [[], [1.0], [[1.0, 2.0], [3.0, 4.0]]])
def test_fewer_than_two_samples_or_a_table_are_refused(values):
    with pytest.raises(RecordFormatError, match="expected a one-dimensional array of at least 2 samples"):
        record(values=values, source="file.txt")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_finite_is_named_by_its_index(bad):
    with pytest.raises(RecordFormatError, match=r"file.txt: 1 of 4 samples are NaN or infinite, the first at index 2"):
        record(values=[0.0, 1.0, bad, 2.0], source="file.txt")
    with pytest.raises(RecordFormatError, match=r"file.txt: 2 of 3 samples are NaN or infinite, the first at index 0"):
        record(values=[bad, 1.0, bad], source="file.txt")


@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf])
def test_an_interval_that_is_not_positive_is_refused(dt):
    with pytest.raises(RecordFormatError, match="expected a positive sampling interval"):
        Record(acceleration=np.zeros(3), dt=dt, id="a")


def test_a_record_survives_pickling():
    full = record(start_time=START, warnings=("x",), magnitude=7.1, network="C" + "I" * len("a"))
    one, other = (pickle.loads(pickle.dumps(full)) for _ in range(2))
    assert one.acceleration == pytest.approx([0.0, 1.0, -2.0])
    assert (one.start_time, one.warnings, one.magnitude, one.network) == (START, ("x",), 7.1, "CI")
    # Thousands of records have one text, one number and one NaN in common, but zeros keep their sign.
    assert (one.network is other.network, one.magnitude is other.magnitude) == (True, True)
    for zero in (0.0, -0.0):
        assert math.copysign(1.0, pickle.loads(pickle.dumps(record(azimuth=zero))).azimuth) == math.copysign(1.0, zero)
    assert one.vs30 is other.azimuth is math.nan
    # A text from an array of numpy is taken as it is.
    of_array = Record(np.zeros(2), dt=0.01, id="a", event=np.array(["Friuli"])[0])
    assert pickle.loads(pickle.dumps(of_array)).event == "Friuli"


@pytest.mark.parametrize(
    ("codes", "start", "expected"),
    [
        (("CI", "CCC", "", "HNE"), START, "CI.CCC..HNE@20190706T031953"),
        (("", "2555", "", "360"), START, ".2555..360@20190706T031953"),
        (("CI", "CCC", "", ""), START, "CI.CCC..2@20190706T031953"),
        (("CI", "CCC", "", "HNE"), None, "stem.HNE"),
        (("", "", "", ""), START, "stem.2"),
        (("", "", "", "a/b c°"), None, "stem.a_b_c_"),
    ],
)
def test_id(codes, start, expected):
    assert record_id(*codes, start, "stem", 2) == expected


def test_letters_of_any_alphabet_stay_in_an_id():
    """Also where a file system takes an accented letter apart."""
    for stem in ("séisme 2", "se\u0301isme 2"):
        assert record_id("", "", "", "Acceleration", None, stem, 1) == "séisme_2.Acceleration"
    assert record_id("", "", "", "N", None, "Düzce/地震#1 \udcff", 1) == "Düzce_地震_1__.N"


@pytest.mark.sweep
@given(st.lists(st.sampled_from(["a", "b", "a~2", "a~3"]), max_size=8))
@settings(derandomize=True, deadline=None, max_examples=60)
def test_ids_become_distinct_and_stay_so(names):
    once = distinct_ids([record(name) for name in names])
    assert len({one.id for one in once}) == len(names)
    assert [one.id for one in distinct_ids(once)] == [one.id for one in once]


def test_a_record_without_its_samples_takes_no_memory_and_keeps_everything_else():
    full = Record(np.arange(100_000.0), dt=0.01, id="a", warnings=("x",))
    empty = full.without_samples()
    assert (empty.npts, empty.duration, empty.warnings) == (full.npts, full.duration, full.warnings)
    small = pickle.dumps(empty.with_warning("y"))
    assert len(small) < 2000
    again = pickle.loads(small)
    assert (again.npts, again.pga, again.warnings) == (100_000, 0.0, ("x", "y"))
    assert all(one.acceleration.strides == (0,) and not one.acceleration.flags.writeable for one in (empty, again))


def test_a_constant_is_kept_as_one_number_and_any_other_array_is_copied():
    constant = Record(np.broadcast_to(2.0, 5), dt=0.01, id="a")
    for one in (constant, pickle.loads(pickle.dumps(constant))):
        assert one.acceleration.tolist() == [2.0] * 5
        assert one.acceleration.strides == (0,)
    assert Record(np.broadcast_to(2, 5), dt=0.01, id="a").acceleration.dtype == float
    loose = np.lib.stride_tricks.as_strided(np.array([2.0]), (5,), (0,))
    one = Record(loose, dt=0.01, id="a")
    loose[0] = 3.0
    assert one.pga == 2.0
    with pytest.raises(RecordFormatError, match="samples are NaN"):
        Record(np.broadcast_to(np.nan, 5), dt=0.01, id="a")


@pytest.mark.parametrize(
    ("patterns", "expected"),
    [([], False), (["CI.CCC*"], True), (["ci.ccc*"], False), (["x", "*HN?@*"], True), (["CI.CCC..HNE"], False)],
)
def test_an_id_is_matched_as_a_whole_and_by_its_capital_letters(patterns, expected):
    assert id_matches("CI.CCC..HNE@20190706T031953", patterns) is expected


def test_a_record_is_told_in_a_line_and_drawn(ccc):
    record = ccc[0]
    told = f"<Record {record.id}, samples"
    assert repr(record).startswith(told)
    assert f"samples {record.npts}" in repr(record)
    card = record._repr_html_()
    assert record.id in card
    assert "<svg" in card
    assert len(card) < 12_000


def test_the_outline_is_the_length_the_peak_and_when_shares_of_the_energy_are_reached():
    steady = Record(0.3 + np.tile([1.0, -1.0], 500), 0.01, id="steady")
    assert outline_of(steady) == pytest.approx((1000, 1.0, 0.5, 2.5, 5.0, 7.5, 9.5), abs=0.011)


def test_gravity_is_the_standard_one():
    assert scipy.constants.g == STANDARD_GRAVITY  # 3rd General Conference on Weights and Measures, 1901
