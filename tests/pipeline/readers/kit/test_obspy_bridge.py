"""The direction of a channel by its SEED code and the angles of its station metadata."""

import os
import sys
import warnings
from datetime import UTC, datetime

import numpy as np
import obspy
import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.obspy_bridge import obspy_notes, obspy_stream, seed_direction, utc_time
from rockpulse.readers.source import SourceFile


@pytest.mark.parametrize(
    ("code", "azimuth", "dip", "expected"),
    [
        ("HNE", None, None, ("horizontal", 90.0)),
        ("HN1", None, None, ("horizontal", None)),
        ("HN1", 33.0, None, ("horizontal", 33.0)),
        ("HNR", None, 0.0, ("horizontal", None)),
        ("HNR", 210.0, 0.0, ("horizontal", 210.0)),
        ("HNE", 450.0, 0.0, ("horizontal", 90.0)),
        ("HNE", float("nan"), float("inf"), ("horizontal", 90.0)),
        *((code, 0.0, dip, ("vertical", None)) for code, dip in (("HNZ", -90.0), ("HNZ", None), ("HN3", 90.0))),
        *((code, 90.0, dip, ("unknown", None)) for code, dip in (("HNZ", -45.0), ("HNE", -90.0), ("HN1", -35.3))),
    ],
)
def test_the_direction_of_a_channel_code_with_angles(code, azimuth, dip, expected):
    facing = seed_direction(code, azimuth, dip)
    assert (facing.orientation, None if np.isnan(facing.azimuth) else facing.azimuth) == expected
    assert bool(facing.note) == (expected[0] == "unknown")
    assert facing.sign == (-1.0 if (facing.orientation, dip) == ("vertical", 90.0) else 1.0)


def test_a_code_that_says_vertical_outweighs_a_dip_of_zero_and_says_so():
    facing = seed_direction("HNZ", 0.0, 0.0)
    assert (facing.orientation, facing.sign) == ("vertical", 1.0)
    assert facing.note == (
        "the channel code HNZ means vertical, but the header states a dip of 0 degrees "
        "(-90 is up, 0 horizontal); used as vertical"
    )


@pytest.mark.parametrize(
    ("dip", "lies", "sign"),
    [
        *((dip, "vertical", -1.0) for dip in (60.0, 89.5, 90.0)),
        *((dip, "vertical", 1.0) for dip in (-60.0, -90.0)),
        *((dip, "horizontal", 1.0) for dip in (0.0, 30.0, -30.0)),
        *((dip, "unknown", 1.0) for dip in (30.5, -45.0, 59.5, 90.5, -90.5)),
    ],
)
def test_a_dip_of_up_to_30_degrees_is_horizontal_and_one_of_60_or_more_vertical(dip, lies, sign):
    facing = seed_direction("HN3", 400.0, dip)
    assert (facing.orientation, facing.sign, bool(facing.note)) == (lies, sign, lies == "unknown")
    assert facing.azimuth == pytest.approx(40.0 if lies == "horizontal" else np.nan, nan_ok=True)


@pytest.mark.parametrize(("code", "axis"), [("HNN", 0.0), ("HNE", 90.0)])
@pytest.mark.parametrize(
    ("off", "told"), [(45.0, False), (-45.0, False), (135.0, False), (46.0, True), (-46.0, True), (134.0, True)]
)
def test_an_azimuth_more_than_45_degrees_off_the_axis_of_the_code_is_told(code, axis, off, told):
    facing = seed_direction(code, axis + off, None)
    assert facing.azimuth == (axis + off) % 360.0
    assert bool(facing.note) is told


def test_the_warnings_in_a_block_are_told_once_each_and_those_about_obspy_itself_are_not():
    with warnings.catch_warnings(record=True) as outside:
        warnings.simplefilter("always")
        with obspy_notes() as notes:
            for category in (UserWarning, DeprecationWarning, FutureWarning, ResourceWarning, UserWarning):
                warnings.warn(f"a  word\nof {category.__name__}", category, stacklevel=1)
            before = sys.unraisablehook
            sys.unraisablehook(type("Lost", (), {"exc_value": ValueError("an odd letter")}))
            os.write(2, b"a line on the terminal\n")
        assert sys.unraisablehook is not before
    assert outside == []
    assert notes == [
        "obspy: a word of UserWarning",
        "obspy: a warning of its C library could not be read (an odd letter)",
    ]


def opened(content):
    return SourceFile("x.mseed", content, lambda: content)


def test_times_beyond_the_calendar_are_named():
    assert utc_time(opened(b""), obspy.UTCDateTime(5.25)) == datetime(1970, 1, 1, 0, 0, 5, 250_000, tzinfo=UTC)
    with pytest.raises(RecordFormatError, match=r"x.mseed: expected a start time in .*, found 1000000000000.0 s"):
        utc_time(opened(b""), obspy.UTCDateTime(ns=10**21))


def test_a_file_without_a_waveform_or_of_times_that_cannot_be_printed_is_named(monkeypatch):
    late = obspy.Trace(np.zeros(3), {"starttime": obspy.UTCDateTime(ns=10**21)})
    for traces, words in (([], "no waveform in the file"), ([late], "expected a start time in the years 1 to 9999")):
        monkeypatch.setattr(obspy, "read", lambda *_, traces=traces, **__: obspy.Stream(traces))
        with pytest.raises(RecordFormatError, match=f"x.mseed: {words}"):
            obspy_stream(opened(b"1"), "MSEED")
