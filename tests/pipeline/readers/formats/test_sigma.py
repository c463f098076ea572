"""SIGMA/ITACA .acc: header, touching fields, directions, what is no acceleration, damaged files."""

import numpy as np
import pytest
from record_writers import pulse
from record_writers.sigma import sigma
from source_files import got_one

from rockpulse.errors import RockpulseError
from rockpulse.readers.formats.sigma import SIGMA
from rockpulse.record.record import STANDARD_GRAVITY

VALUES = np.array([float(f"{value:.7E}") for value in -pulse(302, peak=2.0)])
CONTENT = sigma(VALUES)


def test_fields_touch_and_the_last_row_is_short():
    assert CONTENT.count(b"-", CONTENT.index(b"m/s/s")) > VALUES.size
    record = got_one(CONTENT)
    assert np.array_equal(record.acceleration, VALUES)
    assert (record.source_unit, record.dt, record.format, record.warnings) == ("m/s2", 0.01, "sigma", ())


def test_rows_whose_first_blank_was_cut_off_are_read_at_the_blanks():
    head, _, block = sigma(np.abs(VALUES)).decode().rpartition("m/s/s\n")
    record = got_one((head + "m/s/s\n" + "\n".join(row.strip() for row in block.split("\n"))).encode())
    assert np.array_equal(record.acceleration, np.abs(VALUES))
    assert record.warnings == ()


@pytest.mark.parametrize(
    ("words", "orientation", "azimuth"),
    [
        ("WE", "horizontal", 90.0),
        ("SN", "horizontal", 0.0),
        ("Z", "vertical", np.nan),
        ("H1", "horizontal", np.nan),
        ("N35E", "horizontal", 35.0),
        ("", "unknown", np.nan),
    ],
)
def test_directions(words, orientation, azimuth):
    record = got_one(sigma(VALUES, orientation=words))
    assert (record.orientation, record.component, record.channel) == (orientation, words, words or "1")
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)


@pytest.mark.parametrize(
    ("series", "factor"),
    [
        ("Acceleration time series in m/s/s", 1.0),
        ("Accelaration time history in cm/s/s", 0.01),
        ("ACCELERATION TIME SERIES IN CM/S**2", 0.01),
        ("Acceleration time series in g", STANDARD_GRAVITY),
    ],
)
def test_the_unit_is_that_of_the_line_above_the_samples(series, factor):
    record = got_one(sigma(VALUES, series=series))
    assert record.acceleration == pytest.approx(factor * VALUES)
    assert any("the header states a peak" in note for note in record.warnings) is (factor != 1.0)


@pytest.mark.parametrize(
    ("words", "corners", "processed", "processing"),
    [
        ("none", "", False, ("file: none",)),
        ("", "", None, ()),
        ("Baseline correction", "", None, ("file: Baseline correction",)),
        ("", "0.05-30", True, ("file: filtered, 0.05-30 Hz",)),
        ("Band pass filter", "variable", True, ("file: Band pass filter", "file: filter variable")),
    ],
)
def test_processing(words, corners, processed, processing):
    record = got_one(sigma(VALUES, processing=words, corners=corners))
    assert (record.processed, record.processing) == (processed, processing)


def changed(old: str, new: str) -> bytes:
    assert old.encode() in CONTENT
    return CONTENT.replace(old.encode(), new.encode(), 1)


ACCELERATION = "stream:10: expected 'Acceleration time series', found "
DAMAGE = {
    "velocity": (sigma(VALUES, series="Velocity time series in m/s"), f"{ACCELERATION}velocity"),
    "unit": (sigma(VALUES, series="Acceleration time series in m/s"), "stream:10: unknown unit of acceleration 'm/s'"),
    "fewer": (changed(": 302", ": 306"), r"stream:72: expected 306 numbers \(header\), found 302"),
    "none": (changed(": 302", ": 0"), "positive number of samples"),
    "no-count": (changed(": 302", ": many"), r"stream:8: expected 'Number of Data : n', found 'many'"),
    "no-step": (changed("0.01\n", "\n"), r"stream:7: expected 'Time Increment \(s\) : dt', found ''"),
    "zero-step": (changed("0.01\n", "0\n"), "positive sampling interval"),
    "step-in-ms": (changed("Increment (s)", "Increment (ms)"), r"stream:7: .*\(ms\)"),
    "two-counts": (changed("PGA (m/s/s)  ", "Number of Data : 300\nPGA (m/s/s)"), "stream:9: expected one value of"),
    "no-series": (changed("Accelaration time series", "Samples"), "stream:40: expected the line 'Acceleration time"),
    "no-samples": (CONTENT[: CONTENT.index(b"m/s/s\n") + 6], r"expected 302 samples \(header\), found 0"),
    "letters": (CONTENT[:-40] + b"x" + CONTENT[-39:], r"stream:70: expected a finite number|stream:71"),
    "short-row": (CONTENT[:-60] + CONTENT[-59:], "stream:70: expected 5 fields of 14 characters"),
}


@pytest.mark.parametrize(("content", "message"), DAMAGE.values(), ids=DAMAGE)
def test_damage_is_named_with_file_and_line(content, message):
    with pytest.raises(RockpulseError, match=message):
        got_one(content)


def test_a_count_below_the_numbers_of_the_file_is_reported():
    for count, told in ((301, "line 71: 1 numbers beyond"), (300, "line 71: 1 rows beyond the declared count")):
        assert told in got_one(sigma(VALUES, count=count)).warnings[0]
        lines = sigma(np.abs(VALUES), count=count).decode().split("\n")
        (note,) = got_one("\n".join([*lines[:10], *(row.strip() for row in lines[10:])]).encode()).warnings
        assert told in note


@pytest.mark.parametrize("moment", ["6 April 2009", "2009-13-06 01:32", "2009-04-06"])
def test_a_time_of_the_earthquake_that_is_none_is_left_out(moment):
    record = got_one(sigma(VALUES, event=moment))
    assert (record.event, record.origin_time) == (moment, None)


def test_a_peak_that_is_no_number_is_told():
    record = got_one(CONTENT.replace(b": 2.0000000E+00", b": 2.0000000E+999"))
    assert record.warnings == ("line 9: the peak is not a valid number: '2.0000000E+999'",)
    assert np.isnan(record.header_peak)


@pytest.mark.parametrize(("peak", "told"), [("197", 0), ("194", 1)])
def test_the_peak_has_a_unit_and_a_rounding_of_its_own(peak, told):
    content = CONTENT.replace(b"PGA (m/s/s) ", b"PGA (cm/s/s)").replace(b": 2.0000000E+00", f": {peak}".encode())
    record = got_one(content)
    assert record.header_peak == pytest.approx(0.01 * float(peak), rel=1e-12)
    assert len(record.warnings) == told


def test_recognition_by_some_of_the_keys():
    row = SIGMA
    assert row.detect(CONTENT, "x") is True
    assert row.detect(b"\n".join(CONTENT.split(b"\n")[3:9]), "x") is True
    assert row.detect(b"Network : a\nOrientation : b\nTime Increment (s) : 1\n", "x") is False
    assert row.detect(b"Network : a\nOrientation : b\nPGA : 1\nProcessing Info: no\n", "x") is False
    three = b"Network : a\nOrientation : b\nProcessing Info : no\n"
    for key, known in ((b"Time Increment", True), (b"Number of Data", True), (b"Filter Cut-off Frequency", False)):
        assert row.detect(three + key + b" : 1\n", "x") is known
        assert row.detect(b"words\n" * 36 + three + key + b" : 1\n", "x") is known
        assert row.detect(b"words\n" * 37 + three + key + b" : 1\n", "x") is False
