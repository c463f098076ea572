"""CSMIP volume 2: both layouts, which block is read, structures, damage; spectra are refused."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.csmip_v2 import NEW, OLD, csmip_v2

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.source import NotAcceleration

MOTION = np.round(pulse(403, peak=250.0), 3)
NAME = "TEST.V2"


@pytest.mark.sweep
def test_the_channels_on_the_meloland_overpass_are_structural_and_the_free_field_is_not(records_folder):
    records, failures = read_all(records_folder / "csmip_v2" / "imperialvalley79_ce01336p.zip")
    assert len({record.id for record in records}) == len(records) == 26
    ground = {record.channel: record for record in records if record.orientation != "structural"}
    # Of the station; the second recorder counts them 1, 2 and 11.
    assert list(ground) == ["14", "15", "24"]
    assert [record.orientation for record in ground.values()] == ["vertical", "horizontal", "horizontal"]
    assert [record.azimuth for record in ground.values()] == pytest.approx([np.nan, 0.0, 270.0], nan_ok=True)
    assert [record.npts for record in ground.values()] == [5696, 5690, 5694]
    assert [record.npts for record in records[:13]] == [1138] * 13
    assert {record.dt for record in records[:13]} == {0.02}
    assert {record.dt for record in records[13:]} == {0.01}
    assert [record.pga for record in records] == pytest.approx([record.header_peak for record in records], rel=1e-6)
    assert {record.start_time for record in records} == {None}  # the header knows the minute of the earthquake
    assert all(not record.warnings for record in records)
    assert len(failures) == 26
    assert all("found response and Fourier spectra (volume 3" in failure.reason for failure in failures)


@pytest.mark.parametrize("heading", [NEW, OLD])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("tail", [b"", b"\x1a" * 300])
def test_both_layouts_give_back_the_acceleration(write, heading, end, tail):
    decimals = 5 if heading is NEW else 3
    (record,) = read(write(csmip_v2(MOTION, 0.005, heading, decimals, end=end) + tail))
    assert record.acceleration == pytest.approx(MOTION / 100.0, abs=1e-12)
    assert record.dt == 0.005
    assert (record.format, record.unit_factor, record.processed) == ("csmip_v2", 0.01, True)
    assert record.start_time == datetime(2014, 8, 24, 10, 20, 33, tzinfo=UTC)
    assert record.azimuth == 90.0
    assert record.header_peak == pytest.approx(2.5)
    assert record.warnings == ()


def test_a_rate_that_the_text_rounds_is_taken_from_the_heading(write):
    content = csmip_v2(MOTION, 1 / 300, " points of {kind} data at 300 pts/sec, in cm/sec2. (8f10.5)")
    assert b"INTERVALS OF    .003  SEC" in content
    (record,) = read(write(content))
    assert record.dt == pytest.approx(1 / 300, rel=1e-12)


@pytest.mark.parametrize(("blocks", "found"), [("vd", "velocity"), ("d", "displacement")])
def test_a_file_without_acceleration_is_refused(write, blocks, found):
    with pytest.raises(NotAcceleration, match=rf"TEST.V2:46: expected points of acceleration, found {found}"):
        read(write(csmip_v2(MOTION, blocks=blocks)))


def with_real(content: bytes, number: int, text: str) -> bytes:
    """The content with another text in one of the reals, which follow 25 lines of text and 7 rows of integers."""
    lines = content.split(b"\n")
    at, place = 32 + (number - 1) // 8, 10 * ((number - 1) % 8)
    lines[at] = lines[at][:place] + text.rjust(10).encode() + lines[at][place + 10 :]
    return b"\n".join(lines)


def test_an_interval_may_be_off_by_the_rounding_of_the_text(write):
    content = csmip_v2(MOTION, end="\n")
    for wrong, told in ((".010", 0), (".011", 1)):
        near = with_real(content, 61, wrong).replace(
            b"accel data equally spaced at  .010", b"accel data equally spaced at .0104"
        )
        near = near.replace(b"4.020 SEC", b"4.191 SEC")
        (record,) = read(
            write(with_real(with_real(near, 60, "4.191"), 65, ".125").replace(b"AT     .120 ", b"AT     .125 "))
        )
        assert record.dt == 0.0104
        assert len(record.warnings) == told
    with pytest.raises(RecordFormatError, match=r"expected an interval of 0.01 s .* found a heading with 0.0106 s"):
        read(write(content.replace(b"accel data equally spaced at  .010", b"accel data equally spaced at .0106")))


def test_a_channel_without_acceleration_is_left_out_with_a_warning_on_the_others(write):
    content = csmip_v2(MOTION, number=1) + csmip_v2(MOTION, number=2, blocks="vd") + csmip_v2(MOTION, number=3)
    for record in read(write(content)):
        assert len(record.warnings) == 1
        assert "channel 2 holds velocity but no acceleration; it was left out" in record.warnings[0]


def test_without_a_unit_in_the_heading_that_of_the_peak_counts(write):
    (record,) = read(write(csmip_v2(MOTION, heading=" POINTS OF {kind} DATA EQUALLY SPACED AT {dt} SEC.")))
    assert record.source_unit == "cm/s2"


def cut(content: bytes, lines: int) -> bytes:
    return b"\n".join(content.split(b"\n")[:lines])


DAMAGE = {
    "header": (lambda c: cut(c, 20), "TEST.V2:20: expected 25 header lines of channel 1"),
    "numbers": (lambda c: cut(c, 40), r"TEST.V2:40: expected a line 'N points of accel data"),
    "truncated": (lambda c: cut(c, 60), r"TEST.V2:60: expected 51 rows of acceleration .*, found 14; .* truncated"),
    "velocity": (lambda c: cut(c, 120), "TEST.V2:120: expected 51 rows of velocity .* found 22"),
    "one-row": (
        lambda c: b"\n".join([*c.split(b"\n")[:96], *c.split(b"\n")[97:]]),
        r"TEST.V2:96: expected 51 rows of acceleration .*, found 50",
    ),
    "old": (
        lambda c: cut(csmip_v2(MOTION, 0.005, OLD, 3, end="\n"), 60),
        r"TEST.V2:60: expected 51 rows of acceleration .*, found 14",
    ),
    "huge": (
        lambda c: c.replace(b"   403 points of accel", b"999999999999 points of accel"),
        "expected 125000000000 rows of acceleration",
    ),
    "zero": (lambda c: c.replace(b"   403 points of acc", b"     0 points of acc"), "positive"),
    "text": (
        lambda c: c.replace(b"   403 POINTS", b"   503 POINTS"),
        "TEST.V2:46: expected 503 points .* found a heading with 403",
    ),
    "interval": (
        lambda c: c.replace(b"accel data equally spaced at  .010", b"accel data equally spaced at  .050"),
        "TEST.V2:46: expected an interval of 0.01 s .* found a heading with 0.05",
    ),
    "no-interval": (
        lambda c: c.replace(b"accel data equally spaced at  .010", b"accel data equally spaced at  .0.0"),
        "TEST.V2:46: expected 'at N pts/sec' or 'equally spaced at N sec'",
    ),
    "unit": (lambda c: c.replace(b"cm/sec2.", b"furlong."), "TEST.V2:46: unknown unit of acceleration 'furlong.'"),
    "peak-unit": (
        lambda c: c.replace(b"CM/SEC/SEC", b"CM/SEC/SEX"),
        "TEST.V2:18: unknown unit of acceleration 'CM/SEC/SEX'",
    ),
    "no-unit": (
        lambda c: c.replace(b", in cm/sec2.", b"").replace(b"CM/SEC/SEC", b""),
        "TEST.V2:46: expected the unit of acceleration",
    ),
    "format": (lambda c: c.replace(b"(8f10.5)", b"(0f10.5)"), "expected a format such as"),
    "short-row": (lambda c: c.replace(b" 250.00000", b"250.00000"), r"expected 8 fields of 10"),
    "letters": (lambda c: c.replace(b" 250.00000", b"  25o.0000"), r"TEST.V2:\d+: .*'25o.0000'"),
    "not-finite": (lambda c: c.replace(b" 250.00000", b"       NaN"), r"TEST.V2:\d+: .*'NaN'"),
    "twice": (lambda c: c.replace(b"points of veloc", b"points of accel"), "found a second block of acceleration"),
    "behind": (lambda c: c + b"something else\n", "expected 'Corrected accelerogram' .channel 2."),
}


@pytest.mark.parametrize(("change", "message"), DAMAGE.values(), ids=DAMAGE)
def test_damage_is_named_with_file_and_line(write, change, message):
    content = csmip_v2(MOTION, end="\n")
    assert change(content) != content
    with pytest.raises(RockpulseError, match=message):
        read(write(change(content)))


def test_channels_that_the_header_counts_and_the_file_lacks(write):
    first, second, third = (csmip_v2(MOTION, number=number) for number in (1, 2, 3))
    assert not any(record.warnings for record in read(write(first + second + third)))
    for content in (first + second, first + third):
        for record in read(write(content)):
            assert "the header states 3 channels of this recorder, but this file has 2" in record.warnings[0]
    assert read(write(second))[0].warnings == ()
    assert "this file has 1" in read(write(second[: second.index(b"/&")]))[0].warnings[0]
