"""Which vertical channel belongs to a horizontal one."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from rockpulse.components import matching_vertical
from rockpulse.record import Record

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)


def record(orientation, start=START, station="CCC", n=100, dt=0.01, source="a.v1", slope=1.0):
    return Record(
        slope * dt * np.arange(n),
        dt,
        id=f"{station}.{orientation}",
        network="CI",
        station=station,
        orientation=orientation,
        start_time=start,
        source=source,
    )


def test_later_start_shifts_the_vertical_and_leaves_zeros_before_it():
    up = matching_vertical(record("horizontal"), [record("vertical", START + timedelta(seconds=0.5))])
    assert np.all(up[:50] == 0.0)
    assert up[50:] == pytest.approx(0.01 * np.arange(50))


def test_vertical_that_ends_early_is_followed_by_zeros():
    up = matching_vertical(record("horizontal"), [record("vertical", n=40)])
    assert np.all(up[40:] == 0.0)
    assert up[39] == pytest.approx(0.39)


def test_other_sampling_is_interpolated_as_the_piecewise_linear_record_it_is():
    up = matching_vertical(record("horizontal"), [record("vertical", n=20, dt=0.05)])
    assert up[:96] == pytest.approx(0.01 * np.arange(96))


def test_other_station_or_other_event_does_not_match():
    later = record("vertical", START + timedelta(hours=1))
    assert matching_vertical(record("horizontal"), [record("vertical", station="CLC"), later]) is None


def test_without_times_only_the_same_file_matches():
    one = record("horizontal", start=None)
    assert matching_vertical(one, [record("vertical", start=None, source="b.v1")]) is None
    assert matching_vertical(one, [record("vertical", start=None)]) is not None
