"""USGS SMC: the sample, raw pairs, refused series, damaged files."""

import re
import time
from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse, smc

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.formats.smc import is_smc
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

NAME = "test.smc"


def test_the_sample(samples):
    (record,) = read(samples / "2516b_a.smc")
    assert (record.npts, record.dt) == (41200, 0.005)
    assert record.pga / STANDARD_GRAVITY == pytest.approx(0.03987, rel=1e-3)
    assert record.id == ".2555..360@20110823T175056"
    assert record.start_time == datetime(2011, 8, 23, 17, 50, 56, tzinfo=UTC)
    assert (record.orientation, record.azimuth, record.processed) == ("horizontal", 0.0, True)
    assert record.station_name == "VA: Reston; Fire Station #25"
    assert record.event == "MINERAL, VA"
    assert record.warnings == ()
    # The first fields touch: " 2.3489E-2-1.6646E-2 7.7538E-3".
    assert record.acceleration[:3] == pytest.approx([2.3489e-4, -1.6646e-4, 7.7538e-5], rel=1e-12)


def test_a_corrected_accelerogram(write):
    values = pulse(250, peak=120.0)
    (record,) = read(write(smc(values, codes={18: 1})))
    assert any("integer 18" in note for note in record.warnings)  # a problem that the agency flags
    uncommented = smc(values, codes={16: -32768, 18: 0}).replace(b"|\n| written by a test\n", b"")
    assert np.array_equal(read(write(uncommented))[0].acceleration, record.acceleration)
    assert read(write(uncommented))[0].warnings == ()
    assert record.acceleration == pytest.approx(0.01 * values, rel=1e-4, abs=1e-9)
    assert (record.dt, record.processed, record.source_unit) == (0.01, True, "cm/s2")
    assert record.start_time == datetime(2011, 8, 23, 17, 50, 56, 250000, tzinfo=UTC)


def test_raw_pairs_are_made_equal_in_step(write):
    times = np.array([0.0, 0.004, 0.0105, 0.015, 0.021, 0.025, 0.031])
    values = np.column_stack([times, 1000.0 * times]).ravel()
    (record,) = read(write(smc(values, kind="1 UNCORRECTED ACCELEROGRAM", rate=None)))
    assert record.processed is False
    assert record.acceleration == pytest.approx(10.0 * record.time, rel=1e-3)
    assert "resampled" in record.warnings[0]
    values[8] = 0.01  # the fifth pair is the first of the second row
    with pytest.raises(RecordFormatError, match=r"test.smc:31: expected increasing times, found 0.01 s after 0.015 s"):
        read(write(smc(values, kind="1 UNCORRECTED ACCELEROGRAM", rate=None)))


@pytest.mark.parametrize(
    ("arguments", "orientation", "azimuth"),
    [
        ({"component": "up", "azimuth": -32768, "vertical": 0}, "vertical", np.nan),
        ({"component": "S 58 E", "azimuth": 122}, "horizontal", 122.0),
        ({"component": "S 58 E", "azimuth": 45}, "horizontal", np.nan),
        ({"component": "up", "azimuth": 45, "vertical": 0}, "vertical", np.nan),
        ({"component": "up", "azimuth": 45}, "unknown", np.nan),
        ({"component": "?", "azimuth": -32768, "vertical": 0}, "vertical", np.nan),
        ({"component": "down", "azimuth": -32768, "vertical": 180}, "vertical", np.nan),
        ({"component": "up", "azimuth": -32768, "vertical": 180}, "unknown", np.nan),
        ({"component": "?", "azimuth": 75, "vertical": 90}, "horizontal", 75.0),
        ({"component": "?", "azimuth": 360}, "horizontal", 0.0),
        ({"component": "?", "azimuth": 361}, "unknown", np.nan),
        ({"component": "?", "azimuth": -1}, "unknown", np.nan),
        ({"station": "CA: Alhambra, 12th Fl"}, "structural", 0.0),
    ],
)
def test_direction_from_the_wording_else_from_the_integers(write, arguments, orientation, azimuth):
    (record,) = read(write(smc(pulse(), **arguments)))
    assert record.orientation == orientation
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert np.sign(record.unit_factor) == (-1.0 if arguments.get("component") == "down" else 1.0)


#: The largest is at 0.04 s, the least at 0.1 s.
UNEVEN = [1.0, 5.0, 50.0, 7.0, -3.0, -20.0, -2.0, 0.5, 0.0, 3.0, 1.0, -1.0, 0.0, 2.0, 0.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("facts", "told"),
    [
        ({}, []),
        ({30: 51.0, 32: -21.0}, []),  # two hundredths of the peak away
        ({30: 51.5}, ["floating-point value 30 of the header states 51.5 cm/s2 as the largest value, but the"]),
        ({30: 48.5}, ["floating-point value 30 of the header states 48.5 cm/s2 as the largest value, but the"]),
        ({32: -21.5}, ["floating-point value 32 of the header states -21.5 cm/s2 as the least value, but the"]),
        ({30: 0.0}, ["floating-point value 30 .* states 0 cm/s2 as the largest value, but the samples have 50"]),
        ({32: 0.0}, ["floating-point value 32 .* states 0 cm/s2 as the least value, but the samples have -20"]),
        ({29: 0.28}, ["the header states the peak at 0.28 s, .* the samples have it at 0.04 s"]),
        ({31: 0.3}, ["the header states the peak at 0.3 s, .* the samples have it at 0.1 s"]),
        ({29: 0.0, 30: 0.0, 31: 9.0, 32: 0.0}, []),  # nobody has filled them in
        (dict.fromkeys((29, 30, 31, 32), 1.7e38), []),
    ],
)
def test_the_largest_and_the_least_value_are_held_against_the_samples(write, facts, told):
    (record,) = read(write(smc(UNEVEN, rate=50.0, facts=facts)))
    assert len(record.warnings) == len(told)
    assert all(re.match(words, warning) for words, warning in zip(told, record.warnings, strict=True))


@pytest.mark.parametrize(("number", "scale"), [(6, "Mw"), (7, "Ms"), (8, "ML"), (9, "")])
def test_the_facts_of_the_header(write, number, scale):
    facts = {3: 37.9, 4: -77.9, 5: 6.5, 11: 38.9, 12: -77.3, 17: 121.4, number: 5.8}
    (record,) = read(write(smc(UNEVEN, rate=50.0, facts=facts, note="eventid: us2011abc")))
    assert (record.magnitude, record.magnitude_type) == (5.8, scale)
    assert (record.hypocentre_latitude, record.hypocentre_longitude, record.hypocentre_depth) == (37.9, -77.9, 6500.0)
    assert (record.station_latitude, record.station_longitude) == (38.9, -77.3)
    assert record.epicentral_distance == 121_400.0
    assert record.origin_time == datetime(2011, 8, 23, 17, 51, tzinfo=UTC)
    assert (record.event_id, record.event) == ("us2011abc", "TEST EARTHQUAKE")


def test_without_a_line_of_the_earthquake_the_start_stands(write):
    (record,) = read(write(smc(pulse(), event="unknown", note="EventID: \u00e9", moment=(2011, 235, 17, 50, 56, 999))))
    assert record.start_time == datetime(2011, 8, 23, 17, 50, 56, 999_000, tzinfo=UTC)
    assert (record.event, record.event_id, record.origin_time, record.warnings) == ("", "", None, ())
    # Without milliseconds, the time is the minute of the earthquake.
    for component, name in (("360", "test.360"), ("", "test.1")):
        (record,) = read(write(smc(pulse(), component=component, moment=(1987, 274, 14, 42, 0, -32768))))
        assert (record.start_time, record.id) == (None, name)


@pytest.mark.parametrize(
    ("content", "known"),
    [
        (b"", False),
        (b"2 corrected accelerogram\n", True),
        (b"2 CORRECTED ACCELEROGRAM\n" + 9 * b"*\n" + b"*", True),
        (b"2 CORRECTED ACCELEROGRAM\n" + 10 * b"*\n" + b"    -32768         7", True),
        (b"2 CORRECTED ACCELEROGRAM\n" + 10 * b"*\n" + b"words", False),
        (b"7 CORRECTED ACCELEROGRAM\n" + 10 * b"*\n" + b"    -32768         7", False),
    ],
)
def test_the_format_is_known_by_its_title_and_integers(content, known):
    assert is_smc(content, "test.smc") is known


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            smc(pulse(), kind="3 VELOCITY"),
            "test.smc:1: expected an accelerogram .* found type 3, velocity; read the acc",
        ),
        (smc(pulse(400), count=4000), "expected 4000 numbers .* found 400"),
        (smc(pulse(400), count=-5), "expected a positive number"),
        (smc(pulse(400), facts={2: 0.0}), r"test.smc:18: expected a sampling rate .* found 0"),
        (smc(pulse(400), rate=10_000.5), "expected a sampling rate .* found 10000.5"),
        (smc(pulse(400)).replace(b"       360    -32", b"       36O    -32"), r"test.smc:13: expected a finite"),
        (smc(pulse(400)).replace(b" 1.0000000E+02", b" 1.0000000X+02"), r"test.smc:18: expected a finite"),
        (smc([7.0, *pulse(400)]).replace(b" 7.0000E+0", b" 7.0000X+0"), r"test.smc:30: expected a finite"),
        (smc(pulse(400), rate=None), "expected a sampling rate .* found none"),
        (smc(pulse(401), kind="1 UNCORRECTED ACCELEROGRAM", rate=None), "expected an even number"),
        (smc(pulse(400))[:900], "expected|header lines"),
        (smc(pulse(400)).replace(b"| written", b"  written"), r"test.smc:29: expected comment 2 of 2"),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises((RecordFormatError, NotAcceleration), match=message):
        read(write(content))
    assert read(write(smc(pulse(400), rate=10_000.0)))[0].dt == 1e-4  # the largest rate


@pytest.mark.parametrize(
    ("codes", "structural"),
    [
        ({}, False),
        ({19: 5}, False),
        ({19: 2, 27: 1}, True),
        ({19: 1}, True),
        ({25: 12}, True),
        ({19: 2, 27: 0}, False),
        ({19: 3, 28: 2}, True),
        ({19: 3, 28: 0}, False),
        ({19: 3}, True),
        ({19: 4}, True),
    ],
)
def test_the_integers_know_structures_that_the_name_does_not(write, codes, structural):
    (record,) = read(write(smc(pulse(), codes=codes)))
    assert (record.orientation == "structural") is structural


@pytest.mark.parametrize(
    ("moment", "words"),
    [
        ((2011, 235, 17, 50, 56, -1), "is not a valid start time"),
        ((2011, 235, 17, 50, 56, 1000), "is not a valid start time"),
        ((2011, 366, 17, 50, 56, 0), "is not a valid start time"),
        ((2011, 0, 17, 50, 56, 0), "is not a valid start time"),
        ((2011, 235, 24, 50, 56, 0), "is not a valid start time"),
        ((9999, 365, 23, 59, 60, 999), "is not a valid start time"),
        ((2011, 235, 5, 50, 56, 0), "lies 12.0 h from the earthquake of 2011-08-23 17:51:00"),
    ],
)
def test_a_start_that_cannot_be_is_left_out_with_a_word(write, moment, words):
    (record,) = read(write(smc(pulse(), moment=moment)))
    assert record.start_time is None
    assert words in record.warnings[-1]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"station = ", b"station = " + b" " * 500_000 + b"x"),
        (b"station = ", b"station = " * 50_000),
        (b"pk acc =  3.00E-01", b"pk acc =  1E" + b"1" * 5000),
        (b"pk acc =  3.00E-01", b"pk acc =  1E999"),
        (b"     2011  08", b"     2011 " + b"1 " * 500_000),
    ],
)
def test_lines_without_end_cost_no_time_and_huge_numbers_are_none(write, old, new):
    content = smc(pulse())
    assert old in content
    path = write(content.replace(old, new))
    begin = time.process_time()
    (record,) = read(path)
    assert time.process_time() - begin < 1.0
    assert not np.isinf(record.header_peak)
