"""BHRC volume 1 (Iran): three channels, azimuths in the station line, damaged files."""

import numpy as np
import pytest
from record_writers._shared import pulse
from record_writers.bhrc import bhrc
from source_files import got

from rockpulse.errors import RockpulseError

THREE = tuple(pulse(403, peak, dt=0.005) for peak in (1.9, 1.0, 2.6))


@pytest.mark.parametrize(
    ("azimuths", "expected"),
    [
        ("Azimuth L 352   T 82 ", (352.0, 82.0)),
        ("Azimuth L 0     T 90", (0.0, 90.0)),
        ("Azimuth L       T   ", (np.nan, np.nan)),
        ("Azimuth L 999   T 82", (np.nan, 82.0)),
        ("Azimuth L 360   T 90", (0.0, 90.0)),
        ("Azimuth L 361   T 90", (np.nan, 90.0)),
        ("", (np.nan, np.nan)),
    ],
)
def test_azimuths(azimuths, expected):
    first, vertical, third = got(bhrc(THREE, azimuths=azimuths))
    assert (first.azimuth, third.azimuth) == pytest.approx(expected, nan_ok=True)
    assert np.isnan(vertical.azimuth)
    assert [record.orientation for record in (first, vertical, third)] == ["horizontal", "vertical", "horizontal"]


def test_the_epicentre_is_not_the_place_of_the_station():
    for record in got(bhrc(THREE)):
        assert (record.station_latitude, record.station_longitude) == (35.816, -117.598)
        assert (record.hypocentre_latitude, record.hypocentre_longitude) == (35.77, -117.599)


@pytest.mark.parametrize("duration", [b"2.025", b"2.005"])
def test_a_duration_may_be_off_by_two_steps(duration):
    records = got(bhrc(THREE).replace(b"DURATION =   2.015", b"DURATION =   " + duration))
    assert [(record.npts, record.warnings) for record in records] == [(403, ())] * 3


def test_rows_beyond_the_declared_count_are_reported():
    records = got(bhrc(THREE, count=400))
    assert [record.npts for record in records] == [400] * 3
    assert "1 rows beyond the declared count" in records[0].warnings[0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (bhrc(THREE)[:5000], r"stream:\d+: expected 403 numbers .* found"),
        (bhrc(THREE)[:1000], r"stream:\d+: expected 27 header lines of channel 1"),
        (bhrc(THREE, count=99_999_999), r"expected 99999999 numbers .* found 403"),
        (bhrc(THREE, rate=100.0), r"stream:22: expected a sampling rate that gives 403 points in 2.015 s"),
        (bhrc(THREE, unit="UNITS ARE SECONDS AND FURLONG"), "stream:12: unknown unit"),
        (bhrc(THREE).replace(b"COMP V2", b"COMP X2"), r"stream:76: expected 'COMP L1'"),
        (bhrc(THREE).replace(b"E-01", b"X-01").replace(b"X-01", b"E-01", 2), "stream:38: expected a finite"),
        (
            bhrc(THREE).replace(b"DURATION", b"D").replace(b" .200000E+03", b" .000000E+00"),
            "unknown number of s, found 0",
        ),
        (bhrc(THREE).replace(b"DURATION =   2.015", b"DURATION =   2.026"), "stream:22: .* in 2.026 s"),
        (bhrc(THREE) + b"more\n", r"expected '\* VOL1DS FILE:' \(channel 4\), found 'more'"),
    ],
)
def test_damage_is_named(content, message):
    with pytest.raises(RockpulseError, match=message):
        got(content)


@pytest.mark.parametrize(("azimuth", "told"), [(85, False), (86, True), (79, False), (78, True), (262, False)])
def test_l_and_t_are_at_right_angles(azimuth, told):
    for record in got(bhrc(THREE, azimuths=f"Azimuth L 352   T {azimuth} ")):
        words = f"the azimuths of L and T, 352 and {azimuth} degrees, are not at right angles"
        assert record.warnings == ((words,) if told else ())


@pytest.mark.parametrize(("letter", "told"), [(b"T", True), (b"l", False), (b"X", False)])
def test_the_letter_of_the_component(letter, told):
    record = got(bhrc(THREE).replace(b"\r\nL\r\n", b"\r\n" + letter + b"\r\n"))[0]
    note = "the header names both T and L as the component; one of them is wrong"
    assert record.warnings == ((note,) if told else ())


def test_a_file_that_ends_before_its_third_channel_says_so():
    records = got(bhrc(THREE[:2]))
    assert all("have 3 channels of this recorder, but this file has 2" in record.warnings[-1] for record in records)
    assert not any(record.warnings for record in got(bhrc(THREE)))
