"""What every format is checked for when its numbers become a record."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.facing import Direction
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import STANDARD_GRAVITY as G
from rockpulse.remark import code_of

FILE = SourceFile("a.V1", b"x", lambda: b"x")


def record(peak=0.3, unit="g", samples=None, **known):
    samples = pulse(peak=peak) if samples is None else samples
    return build_record(FILE, 1, samples, 0.01, unit, format="test", processed=None, **known)


@pytest.mark.parametrize(
    ("peak", "unit", "words"),
    [
        (50.0, "g", r"peak 50 g in the unit g; the values would be 0.051 g if it were cm/s2"),
        (6000.0, "cm/s2", r"peak 6.12 g in the unit cm/s2; the values would be 0.612 g if it were mm/s2"),
        (5e-7, "g", r"peak 5e-07 g in the unit g; the values would be 5.1e-08 g if it were m/s2, no ordinary"),
        (5e-3, "mm/s2", r"peak 5.1e-07 g in the unit mm/s2; .*0.005 g if it were g"),
    ],
)
def test_a_peak_beyond_belief_is_printed_in_both_units(peak, unit, words):
    (warning,) = record(peak, unit).warnings
    assert re.search(words, warning)


@pytest.mark.parametrize("peak", [1.01e-6, 1e-3, 4.99])
def test_an_ordinary_peak_is_no_news(peak):
    assert record(peak).warnings == ()


def test_a_peak_that_differs_from_the_header_is_printed_beside_it():
    (warning,) = record(header_peak=0.6 * G).warnings
    assert warning.startswith("the header states a peak of 0.6 g, the data have 0.3 g; check the unit")
    assert record(header_peak=-0.302 * G).warnings == ()
    assert record(header_peak=0.4 * G, peak_rounding=0.1001 * G).warnings == ()


@pytest.mark.parametrize(
    ("stated", "code", "words"),
    [
        (0.306 * G, None, ""),
        (0.31 * G, "header_peak_near", "the header states a peak of 0.31 g, the data have 0.3 g: 3.2 % less"),
        (-0.449 * G, "header_peak_near", "the header states a peak of 0.449 g, the data have 0.3 g: 33.2 % less"),
        (0.451 * G, "header_peak", "0.451 g, the data have 0.3 g; check the unit and that the file is whole"),
        (0.201 * G, "header_peak_near", "the header states a peak of 0.201 g, the data have 0.3 g: 49.3 % more"),
        (0.199 * G, "header_peak", "0.199 g, the data have 0.3 g; check"),
        (0.0, "header_peak", "the header states a peak of 0 g"),
    ],
)
def test_only_a_peak_one_and_a_half_times_that_of_the_header_is_doubted(stated, code, words):
    warnings = record(header_peak=stated).warnings
    assert [code_of(warning) for warning in warnings] == ([code] if code else [])
    assert words in " ".join(warnings)


@pytest.mark.parametrize(
    ("known", "orientation", "told"),
    [
        ({"channel": "BNZ", "component": "0 Deg"}, "vertical", "an azimuth of 0 degrees"),
        ({"channel": "HNZ", "facing": Direction("horizontal")}, "vertical", "a horizontal direction"),
        ({"channel": "BNZ", "component": "Up"}, "vertical", ""),
        ({"channel": "BNE", "component": "0 Deg"}, "horizontal", ""),
        ({"channel": "HHZ", "facing": Direction("horizontal", 90.0), "structural": True}, "structural", "90 degrees"),
        ({"channel": "ANZ", "component": "0 Deg"}, "horizontal", ""),
        ({"channel": "BNZ", "component": "east or so"}, "unknown", ""),
    ],
)
def test_a_channel_code_that_says_vertical_outweighs_a_horizontal_azimuth(known, orientation, told):
    one = record(**known)
    assert one.orientation == orientation
    warnings = [f"the channel code {known['channel']} says vertical, the header "] if told else []
    assert [warning[: len(warnings[0])] for warning in one.warnings] == warnings
    assert told in " ".join(one.warnings)
    assert np.isnan(one.azimuth) == (orientation == "unknown" or bool(told) or known["channel"] == "BNZ")
    assert np.array_equal(one.acceleration, record().acceleration)


def test_a_dead_channel_is_called_one():
    assert record(samples=np.zeros(10)).warnings == ("all samples are zero: a dead channel",)


@pytest.mark.parametrize(
    ("samples", "dt"), [(np.zeros(1), 0.01), (np.zeros(0), 0.01), (pulse(), 0.0), (pulse(), np.nan), (pulse(), np.inf)]
)
def test_what_is_no_series_is_refused(samples, dt):
    with pytest.raises(RecordFormatError, match=r"a.V1: channel 1: expected (at least 2 samples|a positive sampling)"):
        build_record(FILE, 1, samples, dt, "g", format="test", processed=None)


def test_a_component_of_blanks_costs_no_time():
    begin = time.process_time()
    built = record(component="x" + " " * 200_000 + "x")
    assert time.process_time() - begin < 1.0
    assert built.orientation == "unknown"


@pytest.mark.parametrize("component", ["90 Deg", "90DEG", "90  degrees", "90"])
def test_the_channel_is_the_component_without_its_unit(component):
    assert record(component=component).channel == "90"


@pytest.mark.parametrize(
    ("stated", "kept"), [(0.0, 0.0), (260.0, 260.0), (-9999.0, np.nan), (-1.0, np.nan), (99999.0, np.nan)]
)
def test_a_depth_of_the_sensor_that_cannot_be_is_left_out(stated, kept):
    np.testing.assert_equal(record(sensor_depth=stated).sensor_depth, kept)
