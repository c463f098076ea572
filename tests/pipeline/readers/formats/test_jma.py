"""Acceleration files of JMA: Japanese time, Shift-JIS, three components."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.jma import jma

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read

TABLE = np.round([pulse(200, 5.0), pulse(200, -12.0), pulse(200, 9.0)], 3)
NAME = "acc.csv"


def test_the_three_components(write):
    north, east, up = read(write(jma(TABLE)))
    for record, column in zip((north, east, up), TABLE, strict=True):
        assert record.acceleration == pytest.approx(0.01 * column, abs=1e-12)
    assert (north.azimuth, east.azimuth, up.orientation) == (0.0, 90.0, "vertical")
    assert north.start_time == datetime(2024, 1, 1, 7, 10, 10, tzinfo=UTC)
    assert (north.dt, north.source_unit, north.station) == (0.01, "gal", "E0001")
    assert (north.station_latitude, north.station_longitude) == (37.3906, 136.8953)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"unit": "gal(m/s/s)"}, UnitError, "states two units"),
        ({"unit": "V"}, UnitError, "unknown unit"),
        ({"rate": "0Hz"}, RecordFormatError, "SAMPLING RATE"),
        ({"names": "X,Y,Z"}, RecordFormatError, "NS,EW,UD"),
        ({"names": "NS,EW"}, RecordFormatError, ":8: expected a row of 2"),
    ],
)
def test_damage_is_named(write, change, error, words):
    with pytest.raises(error, match=words):
        read(write(jma(TABLE, **change)))


def test_a_start_that_is_none_is_told(write):
    record = read(write(jma(TABLE, start="????")))[0]
    assert record.start_time is None
    assert "cannot be read" in record.warnings[0]
