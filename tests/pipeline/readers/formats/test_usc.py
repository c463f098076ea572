"""USC volumes 1 and 2."""

from __future__ import annotations

import numpy as np
import pytest
from record_writers import pulse
from record_writers.usc import usc_v1, usc_v2

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import FORMATS, read
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

TENTH = STANDARD_GRAVITY / 10.0
TIMES = np.round(0.005 * np.arange(203), 3)
MOTION = np.round(pulse(203, peak=2.5), 3)


@pytest.fixture
def write(tmp_path):
    def written(content: bytes, name: str = "TEST.USC"):
        path = tmp_path / name
        path.write_bytes(content)
        return path

    return written


def test_a_real_volume_1(records_folder):
    (record,) = read(records_folder / "usc_v1" / "017m30lw.e0a")
    # 7065 pairs at 3 to 13 ms, on average 4.25 ms, become 7504 samples at 4 ms.
    assert (record.npts, record.dt) == (7504, 0.004)
    assert record.duration == pytest.approx(30.013, abs=0.004)
    assert record.pga / STANDARD_GRAVITY == pytest.approx(0.156, rel=5e-3)
    assert record.acceleration[:2] == pytest.approx([0.046 * TENTH, 0.022 * TENTH])
    assert (record.azimuth, record.orientation, record.processed) == (185.0, "horizontal", False)
    assert (record.station, record.station_name) == ("0017", "8510 WONDERLAND AVE., LOS ANGELES, CA")
    assert record.event == "NORTHRIDGE EARTHQUAKE JAN 17, 1994 -1230 GMT"
    assert record.start_time is None  # the header knows the minute of the earthquake
    assert record.id == "017m30lw.S05W"
    (warning,) = record.warnings
    assert "unequal steps of 0.003 to 0.013 s" in warning


def test_a_real_volume_2(records_folder):
    (record,) = read(records_folder / "usc_v2" / "274o42pv.s0a")
    assert (record.npts, record.dt, record.processed, record.source_unit) == (573, 0.02, True, "cm/s2")
    assert record.pga / STANDARD_GRAVITY == pytest.approx(0.007004, rel=1e-4)
    assert record.header_peak == pytest.approx(0.06869)
    assert record.acceleration[[0, -1]] == pytest.approx([-0.01208, -0.02063])
    assert (record.azimuth, record.station) == (238.0, "0042")
    assert record.station_name == "2161 VIA OLIVERA, PALOS VERDES ESTATES, CA"
    assert record.start_time is None
    assert record.warnings == ()
    assert record.processing == (
        "by the agency: instrument and baseline corrected",
        "by the agency: band-pass filtered between .600-1.100 and 25.00-27.00 cyc/sec",
    )


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_equal_pairs_keep_their_samples(write, end):
    (record,) = read(write(usc_v1(TIMES, MOTION, end=end)))
    assert record.acceleration == pytest.approx(MOTION * TENTH, abs=1e-12)
    assert record.dt == 0.005
    assert (record.format, record.source_unit) == ("usc_v1", "g/10")
    assert record.warnings == ()


def test_pairs_that_touch_are_split_by_their_width(write):
    times, values = 100.0 + TIMES, MOTION - 12.0
    content = usc_v1(times, values)
    assert b"-11.7" in content
    assert b"100.015-1" in content
    (record,) = read(write(content))
    assert record.acceleration == pytest.approx(values * TENTH, abs=1e-12)


def test_unequal_pairs_are_interpolated_with_a_warning(write):
    times = np.cumsum(np.tile([0.004, 0.006, 0.005, 0.003, 0.005], 30))
    (record,) = read(write(usc_v1(times, np.round(20.0 * times, 3))))  # a line stays one
    assert record.dt == 0.005
    assert record.acceleration == pytest.approx(20.0 * (times[0] + record.time) * TENTH, abs=1e-3)
    assert "unequal steps of 0.003 to 0.006 s" in record.warnings[0]


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
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_the_acceleration_of_a_volume_2(write, blocks, end):
    (record,) = read(write(usc_v2(100.0 * MOTION, 0.02, blocks, end=end)))
    assert record.acceleration == pytest.approx(MOTION, abs=1e-12)
    assert (record.format, record.dt, record.processed, record.warnings) == ("usc_v2", 0.02, True, ())


def test_a_volume_2_without_acceleration_is_refused(write):
    with pytest.raises(NotAcceleration, match=r"TEST.USC:46: expected points of acceleration, found velocity"):
        read(write(usc_v2(MOTION, blocks="vd")))


def test_the_unit_of_a_volume_2_is_never_assumed(write):
    content = usc_v2(MOTION)
    with pytest.raises(UnitError, match=r"TEST.USC:46: expected the unit of acceleration"):
        read(write(content.replace(b"CMS/SEC/SEC", b"           ")))
    with pytest.raises(UnitError, match=r"TEST.USC:18: unknown unit of acceleration 'INS/SEC/SEC'"):
        read(write(usc_v2(MOTION, peak_unit="INS/SEC/SEC")))


def rewritten(number: int, change) -> bytes:
    """A volume 1 with one line changed, counted from 1."""
    lines = usc_v1(TIMES, MOTION, end="\n").split(b"\n")
    lines[number - 1] = change(lines[number - 1])
    return b"\n".join(lines)


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        (usc_v1(TIMES, MOTION)[:900], RecordFormatError, "TEST.USC:11: expected 27 header lines of channel 1"),
        (usc_v1(TIMES, MOTION)[:4000], RecordFormatError, r"TEST.USC:\d+: expected 203 pairs .*truncated"),
        (rewritten(11, lambda line: line.replace(b"203", b"2x3")), RecordFormatError, "TEST.USC:11: expected 'No. of"),
        (rewritten(11, lambda line: line.replace(b"=    203", b"=900000203")), RecordFormatError, "expected 900000203"),
        (rewritten(11, lambda line: line.replace(b"=    203", b"=      0")), RecordFormatError, "positive number of"),
        (rewritten(11, lambda line: line.replace(b"=    203", b"=    200")), None, "1 rows beyond the declared count"),
        (rewritten(12, lambda line: line.replace(b"G/10", b"G/12")), UnitError, "TEST.USC:12: unknown unit .*'G/12'"),
        (rewritten(12, lambda line: b""), UnitError, "TEST.USC:12: unknown unit of acceleration ''"),
        (rewritten(30, lambda line: line[:-1]), RecordFormatError, "TEST.USC:30: expected 10 fields of 7 characters"),
        (rewritten(30, lambda line: line[:-3] + b"***"), RecordFormatError, "TEST.USC:30: expected a finite number"),
        (
            rewritten(40, lambda line: b"    .000" + line[8:]),
            RecordFormatError,
            "TEST.USC:40: expected increasing times",
        ),
    ],
    ids=["header", "rows", "count", "huge", "zero", "fewer", "unit", "no-unit", "short", "stars", "back"],
)
def test_damage_of_a_volume_1(write, content, error, message):
    if error is None:
        (record,) = read(write(content))
        assert message in record.warnings[0]
        return
    with pytest.raises(error, match=message):
        read(write(content))


def test_only_one_reader_claims_each_volume():
    for content, name in ((usc_v1(TIMES, MOTION), "usc_v1"), (usc_v2(MOTION), "usc_v2")):
        claimed = [row.name for row in FORMATS if row.name != "columns" and row.detect(content, "x.dat")]
        assert claimed == [name]
