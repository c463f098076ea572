"""USC volumes 1 and 2."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.usc import usc_v1, usc_v2

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.record.record import STANDARD_GRAVITY

TENTH = STANDARD_GRAVITY / 10.0
TIMES = np.round(0.005 * np.arange(203), 3)
MOTION = np.round(pulse(203, peak=2.5), 3)
NAME = "TEST.USC"


def test_a_damped_basement_is_a_structure(write):
    station = "UNION BANK, 445 FIGUEROA STREET, SUB-BASEMENT, LOS ANGELES"
    assert read(write(usc_v1(TIMES, MOTION, station=station)))[0].orientation == "structural"
    assert read(write(usc_v2(MOTION, station=station)))[0].orientation == "structural"


@pytest.mark.parametrize(
    ("component", "orientation", "sign"),
    [("UP", "vertical", 1.0), ("DOWN", "vertical", -1.0), ("N21E", "horizontal", 1)],
)
def test_directions(write, component, orientation, sign):
    for content, factor in (
        (usc_v1(TIMES, MOTION, component=component), TENTH),
        (usc_v2(MOTION, component=component), 0.01),
    ):
        (record,) = read(write(content))
        assert record.orientation == orientation
        assert record.acceleration == pytest.approx(sign * MOTION * factor, abs=1e-12)


@pytest.mark.parametrize("blocks", ["a", "avd"])
def test_the_acceleration_of_a_volume_2(write, blocks):
    (record,) = read(write(usc_v2(100.0 * MOTION, 0.02, blocks)))
    assert record.acceleration == pytest.approx(MOTION, abs=1e-12)
    assert (record.format, record.dt, record.processed, record.warnings) == ("usc_v2", 0.02, True, ())


def rewritten(number: int, change) -> bytes:
    """A volume 1 with one line changed, counted from 1."""
    lines = usc_v1(TIMES, MOTION, end="\n").split(b"\n")
    lines[number - 1] = change(lines[number - 1])
    return b"\n".join(lines)


def test_the_facts_of_both_volumes(write):
    place = (34 + 6 / 60 + 52 / 3600, -(118 + 22 / 60 + 47 / 3600))
    hypocentre = (35 + 46 / 60 + 12 / 3600, -(117 + 35 / 60 + 56 / 3600))
    reals = b"".join(b"%10.1f" % real for real in (9.5, 10.5, 121.5, 5.5, 13.5, 11.5, 15.5, 16.5))
    first = rewritten(22, lambda line: reals)
    unnamed = first.replace(b"TEST EARTHQUAKE   JAN", b" " * 18 + b"JAN").replace(
        b"   JAN 17, 1994 -1230 GMT", b" " * 25
    )
    for content, event in ((first, "TEST EARTHQUAKE JAN 17, 1994 -1230 GMT"), (unnamed, "TEST EARTHQUAKE")):
        (record,) = read(write(content))
        assert (record.event, record.station, record.magnitude) == (event, "0017", 5.5)
        assert (record.epicentral_distance, record.hypocentre_depth) == (121_500.0, 11_500.0)
    (record,) = read(write(first))
    (second,) = read(write(usc_v2(MOTION, moment="DEC 31, 1994 -1230 GMT")))
    assert record.origin_time == datetime(1994, 1, 17, 12, 30, tzinfo=UTC)
    assert second.origin_time == datetime(1994, 12, 31, 12, 30, tzinfo=UTC)
    assert (second.magnitude, second.epicentral_distance) == (5.9, 44_150.0)
    for one in (record, second):
        assert (one.station_latitude, one.station_longitude) == pytest.approx(place, abs=1e-6)
        assert (one.hypocentre_latitude, one.hypocentre_longitude) == pytest.approx(hypocentre, abs=1e-6)


def ones(count: int) -> np.ndarray:
    """(203,) values whose mean square is `count` millionths over 203."""
    return 0.001 * np.where(np.arange(203) < count, (-1.0) ** np.arange(203), 0.0)


@pytest.mark.parametrize(
    ("values", "square", "told"),
    [
        (1000.0 * ones(203), "1.199", False),
        (1000.0 * ones(203), "1.202", True),
        (1000.0 * ones(203), " .834", False),
        (1000.0 * ones(203), " .832", True),
        # Of small ones the rounding counts: 0.0005, 0.0003, 0.0004 and 0.0007.
        (ones(51), " .001", False),
        (ones(18), " .001", True),
        (ones(32), " .000", False),
        (ones(100), " .000", True),
    ],
)
def test_the_root_of_the_mean_square_holds_the_unit(write, values, square, told):
    content = usc_v1(TIMES, values, end="\n").split(b"\n")
    assert b"RECORD =" in content[12]
    content[12] = content[12][:32] + square.encode().rjust(8) + content[12][40:]
    (record,) = read(write(b"\n".join(content)))
    notes = [note for note in record.warnings if "root mean square" in note]
    assert bool(notes) is told
    if square == "1.202":
        assert notes == ["the header states 0.12 g as the root mean square, but the samples have 0.1 g; check the unit"]


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        (usc_v1(TIMES, MOTION)[:900], RecordFormatError, "TEST.USC:11: expected 27 header lines of channel 1"),
        (usc_v1(TIMES, MOTION)[:4000], RecordFormatError, r"TEST.USC:\d+: expected 203 pairs .*truncated"),
        (rewritten(11, lambda line: line.replace(b"203", b"2x3")), RecordFormatError, "TEST.USC:11: expected 'No. of"),
        (rewritten(11, lambda line: line.replace(b"=    203", b"=      0")), RecordFormatError, "positive number of"),
        (rewritten(12, lambda line: line.replace(b"G/10", b"G/12")), UnitError, "TEST.USC:12: unknown unit .*'G/12'"),
        (
            usc_v2(MOTION).replace(b"CMS/SEC/SEC", b" " * 11),
            UnitError,
            "TEST.USC:46: expected the unit of acceleration",
        ),
        (usc_v2(MOTION, peak_unit="INS/SEC/SEC"), UnitError, "TEST.USC:18: unknown unit of acceleration 'INS/SEC/SEC'"),
    ],
)
def test_damage_is_named(write, content, error, message):
    with pytest.raises(error, match=message):
        read(write(content))


@pytest.mark.filterwarnings("error")
def test_a_sample_whose_square_is_no_number_is_refused_in_words_alone(write):
    content = rewritten(40, lambda line: line[:-7] + b"  1E200")
    with pytest.raises(RecordFormatError, match=r"sample \d+ is 9.81e\+199 m/s2, too large for ground motion"):
        read(write(content))
