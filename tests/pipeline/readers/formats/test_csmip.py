"""CSMIP volumes 1 and 2: both layouts, pairs, which block is read, structures, damage; spectra are refused."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import csmip_equal, csmip_pairs, pulse
from record_writers.csmip_v2 import NEW, OLD, csmip_v2

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.formats.csmip import CSMIP_V1
from rockpulse.record.record import STANDARD_GRAVITY

# npts and PGA [g] as measured independently on the same files.
SAMPLES = {
    "CICCC.RAW": ((35430, 35402, 35406), (0.5667, 0.471, 0.3612)),
    "CICLC.v1": ((31932, 32080, 32190), (0.3443, 0.5108, 0.3471)),
    "CITOW2.RAW": ((35562, 35540, 35710), (0.4373, 0.3863, 0.3599)),
}
NAME = "TEST.V1"
MOTION = np.round(pulse(403, peak=250.0), 3)


@pytest.mark.parametrize("name", SAMPLES)
def test_the_samples_have_the_known_counts_and_peaks(samples, name):
    records = read(samples / name)
    counts, peaks = SAMPLES[name]
    assert tuple(record.npts for record in records) == counts
    assert [record.dt for record in records] == [0.01] * 3
    assert [record.pga / STANDARD_GRAVITY for record in records] == pytest.approx(peaks, rel=1e-3)
    assert [record.warnings for record in records] == [()] * 3
    assert [record.orientation for record in records] == ["horizontal", "horizontal", "vertical"]
    assert [record.azimuth for record in records[:2]] == [90.0, 0.0]
    assert np.isnan(records[2].azimuth)


def test_the_fields_of_a_sample(samples):
    record = read(samples / "CICLC.v1")[0]
    assert record.id == "CI.CLC..90@20190706T031608"
    assert (record.network, record.station, record.location, record.channel) == ("CI", "CLC", "", "90")
    assert record.station_name == "China Lake, G2 Tower Rd."
    assert record.start_time == datetime(2019, 7, 6, 3, 16, 8, tzinfo=UTC)
    assert record.component == "90 Deg"
    assert (record.format, record.source_unit, record.unit_factor) == ("csmip_v1", "g", STANDARD_GRAVITY)
    assert record.processed is False
    assert record.header_peak == pytest.approx(0.344 * STANDARD_GRAVITY)
    assert record.source == str(samples / "CICLC.v1")
    # The first two values of the file are -.000011 and -.000011, the third .000001 g.
    assert record.acceleration[:3] == pytest.approx(np.array([-1.1e-5, -1.1e-5, 1e-6]) * STANDARD_GRAVITY, rel=1e-12)


def test_renadic_files_in_the_same_layout_are_left_to_their_own_reader():
    content = csmip_pairs([0.0, 0.01, 0.02], [0.1, 0.2, 0.3])
    chilean = content.replace(b"TEST EARTHQUAKE     JANUARY", b"UNIVERSIDAD DE CHILE - RENADIC")
    assert CSMIP_V1.detect(content, "x.v1")
    assert not CSMIP_V1.detect(chilean, "x.v1")


def swapped(old: bytes, new: bytes):
    """A change of a file: other words in the place of some."""
    return lambda content: content.replace(old, new)


def cut(content: bytes, lines: int) -> bytes:
    return b"\n".join(content.split(b"\n")[:lines])


VELOCITY = "{n:5d} POINTS OF VELOC DATA EQUALLY SPACED AT .010 SEC.  (UNITS: CM/SEC)"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: cut(c, 35), r"TEST.V1:\d+: expected 160 numbers .* found 56"),
        (lambda c: cut(c, 20), "expected 27 header lines"),
        (swapped(b"   160 Acc", b"999999999999 Acc"), "expected 999999999999 numbers"),
        (swapped(b"   160 Acc", b"     0 Acc"), "expected a positive number"),
        (swapped(b"at 100 pts", b"at 0 pts"), "TEST.V1:28: expected 'at N pts/sec'"),
        (swapped(b"units of g.", b"units of furlong."), "TEST.V1:28: unknown unit"),
        (swapped(b"(8f9.6)", b"(0f9.6)"), "expected a format such as"),
        (swapped(b"(8f9.6)", b"(8f0.6)"), "expected a format such as"),
        (lambda c: cut(c, 28), r"TEST.V1:28: expected 160 samples \(header\), found 0"),
        (swapped(b" 0.300000", b"      NaN"), r"TEST.V1:\d+: .* found 'NaN'"),
        (swapped(b" 0.300000", b" 0.3000"), r"TEST.V1:\d+: expected 8 fields of 9"),
        (lambda c: c + b"something else\n", "expected 'Uncorrected Accelerogram Data'"),
        (lambda c: csmip_equal(pulse(), heading=VELOCITY), "TEST.V1:28: expected points of acceleration, found veloc"),
    ],
)
def test_damage_of_a_volume_1(write, change, message):
    content = csmip_equal(np.round(pulse(160), 6), end="\n")
    assert change(content) != content
    with pytest.raises(RockpulseError, match=message):
        read(write(change(content)))


@pytest.mark.parametrize(("rate", "refused"), [("33", False), ("34", True), ("33.37", False), ("33.36", True)])
def test_the_rate_in_the_text_may_be_off_by_its_rounding_or_a_thousandth(write, rate, refused):
    content = csmip_equal(np.round(pulse(400), 6), dt=1 / 33.4).replace(b"at 100 pts", b"at 33.4 pts")
    content = content.replace(b" SEC\r\n", f" SEC   AT {rate} SAMPLES/SEC\r\n".encode(), 1)
    if refused:
        with pytest.raises(RecordFormatError, match=rf"expected {rate} samples/sec .* found a heading with 33.4"):
            read(write(content))
    else:
        assert read(write(content))[0].dt == pytest.approx(1 / 33.4, rel=1e-12)


@pytest.mark.parametrize(("length", "told"), [(b"4.040", False), (b"4.042", True), (b"3.960", False), (b"3.958", True)])
@pytest.mark.parametrize("place", [b"LENGTH =  ", b".000     "])
def test_the_length_may_be_off_by_two_steps_and_five_thousandths(write, length, told, place):
    content = csmip_equal(np.round(pulse(400), 6))
    assert content.count(place + b"4.000") == 1
    assert bool(read(write(content.replace(place + b"4.000", place + length)))[0].warnings) is told


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
def test_both_layouts_give_back_the_acceleration(write, heading):
    (record,) = read(write(csmip_v2(MOTION, 0.005, heading, 5 if heading is NEW else 3)))
    assert record.acceleration == pytest.approx(MOTION / 100.0, abs=1e-12)
    assert record.dt == 0.005
    assert (record.format, record.unit_factor, record.processed) == ("csmip_v2", 0.01, True)
    assert record.start_time == datetime(2019, 7, 6, 3, 19, 58, tzinfo=UTC)
    assert record.azimuth == 90.0
    assert record.header_peak == pytest.approx(2.5)
    assert record.warnings == ()


def test_a_rate_that_the_text_rounds_is_taken_from_the_heading(write):
    content = csmip_v2(MOTION, 1 / 300, " points of {kind} data at 300 pts/sec, in cm/sec2. (8f10.5)")
    assert b"INTERVALS OF    .003  SEC" in content
    (record,) = read(write(content))
    assert record.dt == pytest.approx(1 / 300, rel=1e-12)


def with_real(content: bytes, number: int, text: str) -> bytes:
    """The content with another text in one of the reals, which follow 25 lines of text and 7 rows of integers."""
    lines = content.split(b"\n")
    at, place = 32 + (number - 1) // 8, 10 * ((number - 1) % 8)
    lines[at] = lines[at][:place] + text.rjust(10).encode() + lines[at][place + 10 :]
    return b"\n".join(lines)


def test_an_interval_may_be_off_by_the_rounding_of_the_text(write):
    content = csmip_v2(MOTION, end="\n")
    spaced = b"accel data equally spaced at "
    near = content.replace(spaced + b" .010", spaced + b".0104").replace(b"4.020 SEC", b"4.191 SEC")
    near = with_real(with_real(near, 60, "4.191"), 65, ".125").replace(b"AT     .120 ", b"AT     .125 ")
    for wrong, told in ((".010", 0), (".011", 1)):
        (record,) = read(write(with_real(near, 61, wrong)))
        assert record.dt == 0.0104
        assert len(record.warnings) == told
    with pytest.raises(RecordFormatError, match=r"expected an interval of 0.01 s .* found a heading with 0.0106 s"):
        read(write(content.replace(spaced + b" .010", spaced + b".0106")))


def test_a_channel_without_acceleration_is_left_out_with_a_warning_on_the_others(write):
    content = csmip_v2(MOTION, number=1) + csmip_v2(MOTION, number=2, blocks="vd") + csmip_v2(MOTION, number=3)
    for record in read(write(content)):
        assert len(record.warnings) == 1
        assert "channel 2 holds velocity but no acceleration; it was left out" in record.warnings[0]


def test_without_a_unit_in_the_heading_that_of_the_peak_counts(write):
    (record,) = read(write(csmip_v2(MOTION, heading=" POINTS OF {kind} DATA EQUALLY SPACED AT {dt} SEC.")))
    assert record.source_unit == "cm/s2"


ACCEL, STEP = b"   403 points of accel", b"accel data equally spaced at  "


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: cut(c, 20), "TEST.V1:20: expected 25 header lines of channel 1"),
        (lambda c: cut(c, 40), r"TEST.V1:40: expected a line 'N points of accel data"),
        (lambda c: cut(c, 60), r"TEST.V1:60: expected 51 rows of acceleration .*, found 14; .* truncated"),
        (lambda c: cut(c, 120), "TEST.V1:120: expected 51 rows of velocity .* found 22"),
        (lambda c: cut(c, 95) + c[len(cut(c, 96)) :], "TEST.V1:96: expected 51 rows of acceleration .*, found 50"),
        (lambda c: csmip_v2(MOTION, blocks="vd"), "TEST.V1:46: expected points .*, found velocity; re"),
        (swapped(ACCEL, b"     0 points of accel"), "positive"),
        (swapped(b"   403 POINTS", b"   503 POINTS"), "TEST.V1:46: expected 503 points .* found a heading with 403"),
        (swapped(STEP + b".010", STEP + b".050"), "TEST.V1:46: expected an interval of 0.01 s .* with 0.05"),
        (swapped(STEP + b".010", STEP + b".0.0"), "TEST.V1:46: expected 'at N pts/sec' or 'equally spaced at N sec'"),
        (swapped(b"cm/sec2.", b"furlong."), "TEST.V1:46: unknown unit of acceleration 'furlong.'"),
        (swapped(b"CM/SEC/SEC", b"CM/SEC/SEX"), "TEST.V1:18: unknown unit of acceleration 'CM/SEC/SEX'"),
        (lambda c: c.replace(b", in cm/sec2.", b"").replace(b"CM/SEC/SEC", b""), "TEST.V1:46: expected the unit of"),
        (swapped(b"(8f10.5)", b"(0f10.5)"), "expected a format such as"),
        (swapped(b" 250.00000", b"250.00000"), r"expected 8 fields of 10"),
        (swapped(b" 250.00000", b"  25o.0000"), r"TEST.V1:\d+: .*'25o.0000'"),
        (swapped(b"points of veloc", b"points of accel"), "found a second block of acceleration"),
        (lambda c: c + b"something else\n", "expected 'Corrected accelerogram' .channel 2."),
    ],
)
def test_damage_of_a_volume_2(write, change, message):
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
