"""Which vertical channel belongs to a horizontal one, and its samples."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from rockpulse.components import align, matching_vertical, uncovered
from rockpulse.record import Record

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)


def record(orientation, start=START, station="CCC", n=100, dt=0.01, source="a.v1", name=""):
    return Record(
        dt * np.arange(n),
        dt,
        id=name or f"{station}.{orientation}",
        network="CI",
        station=station,
        orientation=orientation,
        start_time=start,
        source=source,
    )


def test_later_start_shifts_the_vertical_and_leaves_zeros_before_it():
    up = align(record("vertical", START + timedelta(seconds=0.5)), record("horizontal"))
    assert np.all(up[:50] == 0.0)
    assert up[50:] == pytest.approx(0.01 * np.arange(50))


def test_vertical_that_ends_early_is_followed_by_zeros():
    short = record("vertical", n=40)
    up = align(short, record("horizontal"))
    assert np.all(up[40:] == 0.0)
    assert up[39] == pytest.approx(0.39)
    assert uncovered(short, record("horizontal")) == pytest.approx(0.6)


def test_other_sampling_is_interpolated_as_the_piecewise_linear_record_it_is():
    up = align(record("vertical", n=20, dt=0.05), record("horizontal"))
    assert up[:96] == pytest.approx(0.01 * np.arange(96))


def test_other_station_or_other_event_does_not_match():
    later = record("vertical", START + timedelta(hours=1), source="b.v1")
    assert matching_vertical(record("horizontal"), [record("vertical", station="CLC", source="c.v1"), later]) is None


def test_same_file_comes_before_a_longer_overlap():
    short = record("vertical", n=30, name="same file")
    long = record("vertical", source="b.v1", name="other file")
    assert matching_vertical(record("horizontal"), [long, short]).id == "same file"


def test_longest_overlap_of_the_station_is_taken_from_other_files():
    ups = [record("vertical", n=n, source=f"{n}.v1", name=str(n)) for n in (30, 90, 60)]
    assert matching_vertical(record("horizontal"), ups).id == "90"


def test_without_times_only_the_same_file_matches():
    one = record("horizontal", start=None)
    assert matching_vertical(one, [record("vertical", start=None, source="b.v1")]) is None
    assert matching_vertical(one, [record("vertical", start=None)]) is not None


def test_unknown_station_never_matches_another_file():
    blank = record("horizontal", station="")
    assert matching_vertical(blank, [record("vertical", station="", source="b.v1")]) is None
