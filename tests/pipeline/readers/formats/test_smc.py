"""USGS SMC: the sample, raw pairs, refused series, damaged files."""

from __future__ import annotations

import time
from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse, smc

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY


@pytest.fixture
def write(tmp_path):
    def written(content: bytes):
        path = tmp_path / "test.smc"
        path.write_bytes(content)
        return path

    return written


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


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_corrected_accelerogram(write, end):
    values = pulse(250, peak=120.0)
    (record,) = read(write(smc(values, end=end)))
    assert record.acceleration == pytest.approx(0.01 * values, rel=1e-4, abs=1e-9)
    assert (record.dt, record.processed, record.source_unit) == (0.01, True, "cm/s2")
    assert record.start_time == datetime(2011, 8, 23, 17, 50, 56, 250000, tzinfo=UTC)


def test_raw_pairs_are_made_equal_in_step(write):
    times = np.array([0.0, 0.004, 0.0105, 0.015, 0.021, 0.025])
    values = np.column_stack([times, 1000.0 * times]).ravel()
    (record,) = read(write(smc(values, kind="1 UNCORRECTED ACCELEROGRAM", rate=None)))
    assert record.processed is False
    assert record.acceleration == pytest.approx(10.0 * record.time, rel=1e-3)
    assert "resampled" in record.warnings[0]


def test_raw_equal_steps(write):
    (record,) = read(write(smc(pulse(100, 50.0), kind="1 UNCORRECTED ACCELEROGRAM", rate=200.0)))
    assert (record.npts, record.dt, record.processed) == (100, 0.005, False)


@pytest.mark.parametrize("kind", ["3 VELOCITY", "4 DISPLACEMENT", "5 RESPONSE SPECTRA", "6 FOURIER AMPLITUDE SPECTRUM"])
def test_other_series_are_refused(write, kind):
    with pytest.raises(NotAcceleration, match=r"test.smc:1: expected an accelerogram .* found type"):
        read(write(smc(pulse(), kind=kind)))


@pytest.mark.parametrize(
    ("arguments", "orientation", "azimuth"),
    [
        ({"component": "up", "azimuth": -32768, "vertical": 0}, "vertical", np.nan),
        ({"component": "S 58 E", "azimuth": 122}, "horizontal", 122.0),
        ({"component": "S 58 E", "azimuth": 45}, "horizontal", np.nan),
        ({"component": "up", "azimuth": 45, "vertical": 0}, "vertical", np.nan),
        ({"component": "up", "azimuth": 45}, "unknown", np.nan),
        ({"component": "?", "azimuth": 75}, "horizontal", 75.0),
        ({"component": "?", "azimuth": -32768, "vertical": 0}, "vertical", np.nan),
        ({"component": "?", "azimuth": -32768}, "unknown", np.nan),
        ({"station": "CA: Alhambra, 12th Fl"}, "structural", 0.0),
    ],
)
def test_direction_from_the_wording_else_from_the_integers(write, arguments, orientation, azimuth):
    (record,) = read(write(smc(pulse(), **arguments)))
    assert record.orientation == orientation
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)


@pytest.mark.parametrize(
    ("number", "message"),
    [(16, r"test.smc:28: expected 8 fields of 10 characters"), (17, "expected a positive number of numbers .*found 0")],
)
def test_a_header_without_a_number_of_comments_or_of_values_is_damaged(write, number, message):
    with pytest.raises(RecordFormatError, match=message):
        read(write(smc(pulse(), codes={number: -32768})))


def test_a_time_without_milliseconds_is_the_minute_of_the_earthquake_not_of_the_record(write):
    (record,) = read(write(smc(pulse(), moment=(1987, 274, 14, 42, 0, -32768))))
    assert record.start_time is None
    assert record.id == "test.360"
    (record,) = read(write(smc(pulse(), component="", moment=(1987, 274, 14, 42, 0, -32768))))
    assert record.id == "test.1"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (smc(pulse(400), count=4000), "expected 4000 numbers .* found 400"),
        (smc(pulse(400), count=-5), "expected a positive number"),
        (smc(pulse(400), rate=-100.0), "expected a sampling rate"),
        (smc(pulse(400), rate=None), "expected a sampling rate .* found none"),
        (smc(pulse(401), kind="1 UNCORRECTED ACCELEROGRAM", rate=None), "expected an even number"),
        (smc(pulse(400))[:900], "expected|header lines"),
        (smc(pulse(400)).replace(b"| written", b"  written"), r"test.smc:29: expected comment 2 of 2"),
        (
            smc(pulse(400)).replace(b"1.0000E+2", b"1.0000X+2").replace(b"E-1", b"X-1", 1),
            r"test.smc:\d+: expected a finite",
        ),
        (smc([1.0]), "at least 2 samples, found 1"),
    ],
    ids=["truncated", "negative", "rate", "no-rate", "odd", "cut", "comment", "letter", "one"],
)
def test_damage_is_named(write, content, message):
    with pytest.raises(RecordFormatError, match=message):
        read(write(content))


# The raw one is resampled at its median step; four pairs after the declared count run backwards and are left out.
REAL = {
    "0165b_a.smc": (6014, 0.005, 0.2799, "structural"),
    "891018_1.cra-1.0210j.smc": (34656, 0.0014, 0.1183, "structural"),
}


@pytest.mark.parametrize("name", REAL)
def test_real_files(records_folder, name):
    (record,) = read(records_folder / "smc" / name)
    count, dt, peak, orientation = REAL[name]
    assert (record.npts, record.orientation) == (count, orientation)
    assert record.dt == pytest.approx(dt, rel=1e-12)
    assert record.pga / STANDARD_GRAVITY == pytest.approx(peak, rel=0.02)


@pytest.mark.parametrize(
    ("codes", "structural"),
    [
        ({}, False),
        ({19: 1}, True),
        ({19: 1, 25: 12}, True),
        ({25: 12}, True),
        ({19: 2, 27: 3}, True),
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


@pytest.mark.parametrize(("flag", "warned"), [(-32768, False), (0, False), (1, True)])
def test_a_problem_that_the_agency_flags_is_passed_on(write, flag, warned):
    (record,) = read(write(smc(pulse(), codes={18: flag})))
    assert any("integer 18" in note for note in record.warnings) is warned


@pytest.mark.parametrize(
    ("moment", "words"),
    [
        ((2011, 235, 17, 50, 56, 9_999_999_999), "is no start time"),
        ((2011, 235, 17, 50, 56, -1), "is no start time"),
        ((2011, 235, 17, 50, 56, 1000), "is no start time"),
        ((2011, 366, 17, 50, 56, 0), "is no start time"),
        ((2011, 0, 17, 50, 56, 0), "is no start time"),
        ((2011, 235, 24, 50, 56, 0), "is no start time"),
        ((9999, 365, 23, 59, 60, 999), "is no start time"),
        ((2011, 235, 5, 50, 56, 0), "lies 12.0 h from the earthquake of 2011-08-23 17:51:00"),
    ],
)
def test_a_start_that_cannot_be_is_left_out_with_a_word(write, moment, words):
    (record,) = read(write(smc(pulse(), moment=moment)))
    assert record.start_time is None
    assert words in record.warnings[-1]


def test_the_last_day_of_a_leap_year(write):
    (record,) = read(write(smc(pulse(), moment=(2012, 366, 17, 50, 56, 7), event="2012  12  31    1751 TEST")))
    assert record.start_time == datetime(2012, 12, 31, 17, 50, 56, 7000, tzinfo=UTC)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"station = ", b"station = " + b" " * 500_000 + b"x"),
        (b"station = ", b"station = " * 50_000),
        (b"pk acc =  3.00E-01", b"pk acc =  1E" + b"1" * 5000),
        (b"pk acc =  3.00E-01", b"pk acc =  1E999"),
        (b"     2011  08", b"     2011 " + b"1 " * 500_000),
    ],
    ids=["blanks", "words", "exponent", "infinite", "event"],
)
def test_lines_without_end_cost_no_time_and_huge_numbers_are_none(write, old, new):
    content = smc(pulse())
    assert old in content
    path = write(content.replace(old, new))
    begin = time.process_time()
    (record,) = read(path)
    assert time.process_time() - begin < 1.0
    assert not np.isinf(record.header_peak)
