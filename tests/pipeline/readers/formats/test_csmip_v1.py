"""CSMIP volume 1: the samples, the old pair layout, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import csmip_equal, csmip_pairs, pulse

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.formats.csmip import CSMIP_V1
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

# npts and PGA [g] as measured independently on the same files.
SAMPLES = {
    "CICCC.RAW": ((35430, 35402, 35406), (0.5667, 0.471, 0.3612)),
    "CICLC.v1": ((31932, 32080, 32190), (0.3443, 0.5108, 0.3471)),
    "CITOW2.RAW": ((35562, 35540, 35710), (0.4373, 0.3863, 0.3599)),
}
NAME = "TEST.RAW"


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


def test_a_leading_carriage_control_blank_on_every_line_is_dropped(write):
    content = csmip_equal(np.round(pulse(), 6), end="\n")
    (plain,) = read(write(content))
    shifted = b"".join(b" " + line for line in content.splitlines(keepends=True))
    (record,) = read(write(shifted, "shifted.RAW"))
    assert np.array_equal(record.acceleration, plain.acceleration)
    assert record.component == plain.component


def test_equally_spaced_pairs_in_tenths_of_g_keep_their_samples(write):
    values = np.round(pulse(300, peak=2.5), 3)
    (record,) = read(write(csmip_pairs(np.arange(300) * 0.005, values)))
    assert record.dt == pytest.approx(0.005, rel=1e-12)
    assert record.source_unit == "g/10"
    assert record.acceleration == pytest.approx(values * STANDARD_GRAVITY / 10.0, rel=1e-12)
    assert record.start_time == datetime(1994, 1, 17, 12, 31, 4, 100000, tzinfo=UTC)
    assert record.warnings == ()


def test_renadic_files_in_the_same_layout_are_left_to_their_own_reader():
    content = csmip_pairs([0.0, 0.01, 0.02], [0.1, 0.2, 0.3])
    chilean = content.replace(b"TEST EARTHQUAKE     JANUARY", b"UNIVERSIDAD DE CHILE - RENADIC")
    assert CSMIP_V1.detect(content, "x.v1")
    assert not CSMIP_V1.detect(chilean, "x.v1")


def test_points_of_velocity_are_no_acceleration(write):
    content = csmip_equal(pulse(), heading="{n:5d} POINTS OF VELOC DATA EQUALLY SPACED AT .010 SEC.  (UNITS: CM/SEC)")
    with pytest.raises(NotAcceleration, match=r"TEST.RAW:28: expected points of acceleration, found velocity"):
        read(write(content))


def damaged(change) -> bytes:
    return change(csmip_equal(np.round(pulse(160), 6), end="\n"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: b"\n".join(c.split(b"\n")[:35]), r"TEST.RAW:\d+: expected 160 numbers .* found 56"),
        (lambda c: b"\n".join(c.split(b"\n")[:20]), "expected 27 header lines"),
        (lambda c: c.replace(b"   160 Acc", b"999999999999 Acc"), "expected 999999999999 numbers"),
        (lambda c: c.replace(b"   160 Acc", b"     0 Acc"), "expected a positive number"),
        (lambda c: c.replace(b"at 100 pts", b"at 0 pts"), "TEST.RAW:28: expected 'at N pts/sec'"),
        (lambda c: c.replace(b"units of g.", b"units of furlong."), "TEST.RAW:28: unknown unit"),
        (lambda c: c.replace(b"(8f9.6)", b"(0f9.6)"), "expected a format such as"),
        (lambda c: c.replace(b" 0.300000", b"      NaN"), r"TEST.RAW:\d+: .* found 'NaN'"),
        (lambda c: c.replace(b" 0.300000", b" 0.3000"), r"TEST.RAW:\d+: expected 8 fields of 9"),
        (lambda c: c + b"something else\n", "expected 'Uncorrected Accelerogram Data'"),
    ],
)
def test_damage_is_named_with_file_and_line(write, change, message):
    content = damaged(change)
    assert content != damaged(lambda c: c)
    with pytest.raises(RockpulseError, match=message):
        read(write(content))


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
