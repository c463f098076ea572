"""What every format is checked for when its numbers become a record."""

import re
import time
from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.kit.channel import build_record, clipping_warning, odd_peak, usable_channels
from rockpulse.readers.kit.direction import Direction
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record.defects import deciding
from rockpulse.record.record import STANDARD_GRAVITY as G
from rockpulse.warning_text import code_of

FILE = SourceFile("a.V1", b"x", lambda: b"x")


def record(peak=0.3, unit="g", samples=None, **known):
    samples = pulse(peak=peak) if samples is None else samples
    return build_record(FILE, samples, 0.01, unit, number=1, format="test", processed=None, **known)


@pytest.mark.parametrize(("stated", "decides"), [(0.45, True), (0.44, False), (0.2, True), (0.21, False), (0.0, False)])
def test_a_peak_that_differs_greatly_from_the_header_must_be_confirmed(stated, decides):
    assert bool(deciding(record(header_peak=(stated, 0.0)))) is decides


def test_a_channel_of_zeros_is_dead_whatever_peak_its_header_states():
    for stated in (np.nan, 0.0, 0.3):
        (note,) = record(samples=np.zeros(9), header_peak=(stated, 0.0)).warnings
        assert code_of(note) == "dead_channel"


@pytest.mark.parametrize(
    ("peak", "unit", "words"),
    [
        (50.0, "g", r"peak 50 g if the unit is g; 0.051 g if it is cm/s2"),
        (6000.0, "cm/s2", r"peak 6.12 g if the unit is cm/s2; 0.612 g if it is mm/s2"),
        (5.01, "g", r"peak 5.01 g if the unit is g; 0.511 g if it is m/s2"),
        (9.9e-7, "g", r"peak 9.9e-07 g if the unit is g; "),
        (5e-7, "g", r"peak 5e-07 g if the unit is g; 5.1e-08 g if it is m/s2, which is not an ordinary"),
        (5e-3, "mm/s2", r"peak 5.1e-07 g if the unit is mm/s2; .*0.005 g if it is g"),
    ],
)
def test_a_peak_beyond_belief_is_printed_in_both_units(peak, unit, words):
    (warning,) = record(peak, unit).warnings
    assert re.search(words, warning)


@pytest.mark.parametrize(
    ("stated", "code", "words"),
    [
        (0.306 * G, None, ""),
        (0.31 * G, "header_peak_near", "the header states a peak of 0.31 g, but the data have 0.3 g: 3.2 % less"),
        (-0.449 * G, "header_peak_near", "the header states a peak of 0.449 g, but the data have 0.3 g: 33.2 % less"),
        (
            0.451 * G,
            "header_peak",
            "0.451 g, but the data have 0.3 g; check the unit, and whether the file is complete",
        ),
        (0.201 * G, "header_peak_near", "the header states a peak of 0.201 g, but the data have 0.3 g: 49.3 % more"),
        (0.199 * G, "header_peak", "0.199 g, but the data have 0.3 g; check"),
        (0.0, "header_peak", "the header states a peak of 0 g"),
    ],
)
def test_only_a_peak_one_and_a_half_times_that_of_the_header_is_doubted(stated, code, words):
    warnings = record(header_peak=(stated, 0.0), peak_factor=1.0).warnings
    assert [code_of(warning) for warning in warnings] == ([code] if code else [])
    assert words in " ".join(warnings)


@pytest.mark.parametrize(
    ("stated", "rounding", "codes"),
    [(3.0, 0.0, ["header_peak"]), (2.5, 0.0, ["header_peak_near"]), (2.5, 0.5, []), (2.5, 0.25, ["header_peak_near"])],
)
def test_a_peak_may_be_off_by_its_rounding(stated, rounding, codes):
    told = record(samples=np.array([0.0, 2.0, -1.0]), unit="m/s2", header_peak=(stated, rounding))
    assert [code_of(warning) for warning in told.warnings] == codes
    assert told.header_peak == stated


def test_the_header_describes_the_peak_before_resampling():
    samples = np.array([0.0, 2.0, -1.0])
    assert record(samples=samples, unit="m/s2", header_peak=(3.0, 0.0), original_peak=3.0).warnings == ()
    (warning,) = record(samples=samples, unit="m/s2", header_peak=(2.0, 0.0), original_peak=3.0).warnings
    assert "a peak of 0.2039 g, but the data have 0.3059 g" in warning


def test_the_unit_of_an_odd_peak():
    assert "peak 10 g if the unit is m/s2; 0.1 g if it is cm/s2" in odd_peak(10.0 * G, "", 7.0)
    # 200 G counts, which are 2 G m/s2 if a count is a cm/s2
    assert "peak 100 g if the unit is counts x 0.5 m/s2; 2 g if it is cm/s2" in odd_peak(100.0 * G, "counts", -0.5)


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
    warnings = [f"the channel code {known['channel']} means vertical, but the header states "] if told else []
    assert [warning[: len(warnings[0])] for warning in one.warnings] == warnings
    assert told in " ".join(one.warnings)
    assert np.isnan(one.azimuth) == (orientation == "unknown" or bool(told) or known["channel"] == "BNZ")
    assert np.array_equal(one.acceleration, record().acceleration)


@pytest.mark.parametrize(
    ("samples", "dt"),
    [(pulse(), -0.01), (np.zeros(1), 0.01), (np.zeros(0), 0.01), (pulse(), 0.0), (pulse(), np.nan), (pulse(), np.inf)],
)
def test_what_is_no_series_is_refused(samples, dt):
    with pytest.raises(RecordFormatError, match=r"a.V1: channel 1: expected (at least 2 samples|a positive sampling)"):
        build_record(FILE, samples, dt, "g", number=1, format="test", processed=None)


def test_a_component_of_blanks_costs_no_time():
    begin = time.process_time()
    built = record(component="x" + " " * 200_000 + "x")
    assert time.process_time() - begin < 1.0
    assert built.orientation == "unknown"


@pytest.mark.parametrize("component", ["90 Deg", "90DEG", "90  degrees", "90"])
def test_the_channel_is_the_component_without_its_unit(component):
    assert record(component=component).channel == "90"


@pytest.mark.parametrize(
    ("stated", "kept"), [(0.0, 0.0), (-0.5, np.nan), (3.0, 3.0), (3.25, 3.25), (10e3, 10e3), (10_000.5, np.nan)]
)
def test_a_depth_of_the_sensor_that_cannot_be_is_left_out(stated, kept):
    built = record(sensor_depth=stated)
    np.testing.assert_equal(built.sensor_depth, kept)
    assert bool(built.warnings) == (kept > 3.0)


@pytest.mark.parametrize(("dt", "told"), [(0.1, False), (0.11, True)])
def test_a_long_interval_is_told(dt, told):
    built = build_record(FILE, pulse(), dt, "g", number=3, format="test", processed=None)
    assert [code_of(warning) for warning in built.warnings] == ["long_interval"] * told
    assert built.channel == "3"


def test_a_time_of_a_clock_that_was_never_set_is_left_out():
    built = record(start_time=datetime(1980, 1, 1, tzinfo=UTC))
    assert built.start_time is None
    assert len(built.warnings) == 1
    start = datetime(2011, 3, 11, tzinfo=UTC)
    assert (record(start_time=start).start_time, record(start_time=start).warnings) == (start, ())


def test_a_channel_that_is_positive_downwards_is_turned():
    built = record(component="Down")
    assert np.array_equal(built.acceleration, -record(component="Up").acceleration)
    assert (built.unit_factor, [code_of(warning) for warning in built.warnings]) == (-G, ["positive_downwards"])
    assert record(component="Up").warnings == ()


def test_clipping_is_told_once_and_not_of_corrected_records():
    clipped = np.minimum(pulse(peak=0.3), 0.2)
    (note,) = record(samples=clipped).warnings
    assert "the record may be clipped" in note
    assert record(samples=clipped, warnings=("first", note)).warnings == ("first", note)
    assert build_record(FILE, clipped, 0.01, "g", number=1, format="test", processed=True).warnings == ()


def test_the_usable_channels_of_a_file_are_kept():
    def refuse(fault):
        raise fault

    velocity, gap, other = NotAcceleration("velocity"), RecordRefused("a gap"), RecordRefused("another gap")
    built = record(warnings=("own",))
    assert usable_channels([lambda: built, lambda: built]) == [built, built]
    (kept,) = usable_channels([lambda: refuse(velocity), lambda: built, lambda: refuse(gap)], ["of all"])
    left_out = [f"another channel of the file is left out: {reason}" for reason in ("velocity", "a gap")]
    assert kept.warnings == ("own", "of all", *left_out)
    for faults, raised in (([velocity, gap, other], gap), ([gap, velocity], gap), ([velocity], velocity)):
        with pytest.raises(RecordRefused) as told:
            usable_channels([lambda fault=fault: refuse(fault) for fault in faults])
        assert told.value is raised


WAVE = np.round(pulse(2000, peak=5e5, dt=0.005))


@pytest.mark.parametrize(("low", "high"), [(-np.inf, 3e5), (-2e5, np.inf)])
def test_either_polarity(low, high):
    (warning,) = clipping_warning(np.clip(WAVE, low, high), "counts")
    assert ("largest" if np.isinf(low) else "smallest") in warning
    assert clipping_warning(WAVE, "counts") == []


@pytest.mark.parametrize(("length", "warned"), [(4, False), (5, True)])
def test_five_samples_in_a_row_at_the_edge_are_clipping(length, warned):
    wave = np.concatenate([np.arange(0, 1000, 20), np.full(length, 1000), np.arange(980, -900, -20), [-881]])
    assert bool(clipping_warning(wave, "counts")) is warned


@pytest.mark.parametrize("offset", [0.0, 1e7, -1e7])
def test_an_offset_does_not_matter(offset):
    assert clipping_warning(np.minimum(WAVE, 3e5) + offset, "g")
    assert not clipping_warning(WAVE + offset, "g")


@pytest.mark.parametrize(("top", "warned"), [(200, True), (199, False)])
def test_the_extremes_are_two_hundred_of_the_smallest_steps_apart(top, warned):
    wave = np.r_[0, 1, 50, 100, np.full(5, top), 100, 50]
    assert bool(clipping_warning(wave)) is bool(clipping_warning(3.0 - 7.0 * wave, "g")) is warned


@pytest.mark.parametrize(("left", "right", "warned"), [(9, 9, False), (10, 9, True), (9, 10, True)])
@pytest.mark.parametrize("length", [5, 6, 7])
def test_half_a_run_beside_it_the_trace_has_fallen_by_ten_steps(left, right, warned, length):
    near = [3, 4, 5][: length // 2]
    crest = np.r_[20, left, near[::-1], np.zeros(length), near, right, 20]
    notes = clipping_warning(1000.0 - np.r_[1000, 999, 500, crest, 300])
    assert notes == ([f"{length} samples in a row at the largest value: the record may be clipped"] if warned else [])


@pytest.mark.parametrize(("outside", "warned"), [([], False), ([20], True), ([9], False)])
def test_half_a_run_beside_it_may_lie_beyond_the_record(outside, warned):
    wave = 1000.0 - np.r_[outside, np.zeros(5), 3, 4, 9, 20, 500, 999, 1000]
    assert bool(clipping_warning(wave)) is bool(clipping_warning(wave[::-1])) is warned


def test_one_end_does_not_hide_the_other():
    spread = np.r_[np.tile([1000, 0], 5), np.arange(0, 500, 10), 1]
    (note,) = clipping_warning(np.r_[spread, np.full(6, -300), 0])
    assert note == "6 samples in a row at the smallest value: the record may be clipped"
    (note,) = clipping_warning(-np.r_[spread, np.full(6, -300), 0])
    assert note == "6 samples in a row at the largest value: the record may be clipped"


@pytest.mark.parametrize(("lengths", "warned"), [((3, 3), True), ((3, 2, 2), False), ((4, 2, 3), True), ((4,), False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_several_short_flat_crests_are_clipping_too(lengths, warned, sign):
    crests = [np.r_[700, 300, 200, 300, 700, np.zeros(length), 700, 300] for length in lengths]
    notes = clipping_warning(sign * (1000.0 - np.concatenate([[1001, 1000], *crests])), "g")
    count = sum(length > 2 for length in lengths)
    said = f"{count} crests are flat at the largest or smallest value: the record may be clipped"
    assert notes == ([said] if warned else [])


@pytest.mark.parametrize("amplitude", [20, 150, 1000, 30_000])
@pytest.mark.parametrize("period", [50, 500, 5000])
def test_a_smooth_crest_that_rounding_made_flat_is_no_clipping(amplitude, period):
    crest = np.round(amplitude * np.sin(2.0 * np.pi * np.arange(3 * period) / period))
    assert clipping_warning(crest, "counts") == []


@pytest.mark.parametrize("samples", [np.zeros(100), np.full(100, 7.0), np.r_[np.zeros(50), 1.0, np.zeros(50)]])
def test_a_dead_channel_or_one_step_is_no_clipping(samples):
    assert clipping_warning(samples, "counts") == []


@pytest.mark.parametrize(
    ("peak", "expected"),
    [(8_368_524, 1), (8_388_608, 1), (8_388_609, 0), (0.99 * 2**23, 1), (8_304_721, 0), (16_000_000, 0)],
)
def test_counts_at_the_end_of_24_bits(peak, expected):
    trace = np.r_[np.arange(100.0), -float(peak), np.arange(50.0)]
    assert len(clipping_warning(trace, "counts")) == expected
    assert clipping_warning(trace, "g") == []
