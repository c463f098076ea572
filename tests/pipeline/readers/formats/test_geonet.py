"""GeoNet V1A and V2A (New Zealand): both volumes, directions, clocks, damaged files."""

from __future__ import annotations

import io
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from make_format_samples import source_channels
from record_writers._shared import pulse
from record_writers.geonet import START, geonet, samples

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.record.record import STANDARD_GRAVITY, Record

THREE = tuple(np.round(pulse(203, peak, dt=0.005), 1) for peak in (2394.8, 2584.4, 1589.9))


def got(content: bytes) -> list[Record]:
    return read(io.BytesIO(content))


# npts, dt, PGA [g], azimuths, start, processed.
REAL = {
    "20161113_110300_HSES_20.V1A": (65536, 0.005, (0.2442, 0.2635, 0.1621), (10.0, 280.0), 20, False),
    "20161113_110313_THZ_20.V2A": (8192, 0.02, (0.03649, 0.04764, 0.02288), (90.0, 0.0), 33, True),
}


@pytest.mark.parametrize("name", REAL)
def test_real_files(records_folder, name):
    records = read(records_folder / "geonet" / name)
    count, dt, peaks, azimuths, second, processed = REAL[name]
    assert [(record.npts, record.dt, record.processed) for record in records] == [(count, dt, processed)] * 3
    assert [record.pga / STANDARD_GRAVITY for record in records] == pytest.approx(peaks, rel=5e-4)
    assert [record.header_peak for record in records] == pytest.approx([record.pga for record in records], rel=1e-9)
    assert [record.orientation for record in records] == ["horizontal", "horizontal", "vertical"]
    assert tuple(record.azimuth for record in records[:2]) == azimuths
    # The buffer begins 36 and 23 s before the earthquake of 11:02:56.
    assert {record.start_time for record in records} == {datetime(2016, 11, 13, 11, 2, second, tzinfo=UTC)}
    assert {record.event for record in records} == {"5 km south-west of Waiau"}
    assert {record.warnings for record in records} == {()}


def test_codes_of_a_real_file(records_folder):
    record = read(records_folder / "geonet" / "20161113_110313_THZ_20.V2A")[0]
    assert record.id == ".THZ.20.S90E@20161113T110233"
    assert (record.station_name, record.format, record.source_unit) == ("Top House", "geonet", "mm/s2")


@pytest.mark.parametrize("name", ["clc_geonet.V1A", "clc_geonet.V2A"])
def test_the_format_samples_give_back_the_channels(name):
    channels = source_channels()
    for record, channel in zip(got(samples(channels)[name]), channels, strict=True):
        assert record.acceleration == pytest.approx(channel.acceleration, abs=0.051e-3)
        assert (record.dt, record.start_time) == (channel.dt, channel.start_time)
        assert record.azimuth == pytest.approx(channel.azimuth, nan_ok=True)
        assert record.orientation == channel.orientation


@pytest.mark.parametrize("corrected", [False, True])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_only_the_accelerations_of_both_volumes_are_read(corrected, end):
    records = got(geonet(THREE, corrected=corrected, end=end))
    assert [record.processed for record in records] == [corrected] * 3
    for record, values in zip(records, THREE, strict=True):
        assert record.acceleration == pytest.approx(0.001 * values, rel=1e-12)
        assert (record.dt, record.start_time) == (0.005, START)


def test_fields_of_eight_characters_touch():
    values = -np.abs(10.0 * THREE[0]) - 10_000.0
    content = geonet([values], ["Up"])
    assert b".0-1" in content
    (record,) = got(content)
    assert record.acceleration == pytest.approx(0.001 * values, rel=1e-9)


def test_readings_in_another_unit_are_multiplied():
    record, _, _ = got(geonet(THREE, reading=0.5))
    assert record.unit_factor == 0.0005
    assert record.acceleration == pytest.approx(0.001 * THREE[0], abs=0.03e-3)
    assert record.warnings == ()


def test_a_header_peak_that_differs_is_reported():
    (record,) = got(geonet([THREE[0]], ["N10E"], peak=-3000.0))
    assert "the header states a peak of 0.3059 g" in record.warnings[0]


@pytest.mark.parametrize(("component", "azimuth"), [("S87W", 267.0), ("N03W", 357.0), ("N00E", 0.0), ("S90E", 90.0)])
def test_directions(component, azimuth):
    (record,) = got(geonet([THREE[0]], [component]))
    assert (record.azimuth, record.channel) == (azimuth, component)


def test_the_fraction_of_the_start_is_in_milliseconds():
    start = datetime(2016, 2, 14, 0, 13, 25, 845000, tzinfo=UTC)
    (record,) = got(geonet([THREE[0]], ["Up"], start=start, origin=datetime(2016, 2, 14, 0, 13, 43, tzinfo=UTC)))
    assert record.start_time == start


@pytest.mark.parametrize(("hours", "kept"), [(-0.9, True), (0.9, True), (-13.0, False), (2.0, False)])
def test_a_start_far_from_the_earthquake_is_left_out(hours, kept):
    start = START + timedelta(hours=hours)
    (record,) = got(geonet([THREE[0]], ["Up"], start=start))
    assert record.start_time == (start if kept else None)
    assert any("h from the earthquake of 2016-11-13 11:02:56" in note for note in record.warnings) is not kept


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        (geonet(THREE)[:1400], RecordFormatError, r"stream:\d+: expected 26 header lines of component 1"),
        (geonet(THREE)[:3000], RecordFormatError, r"stream:\d+: expected 21 rows of values of component 1"),
        (geonet(THREE, corrected=True)[:-200], RecordFormatError, "expected 63 rows of values of component 3"),
        (geonet(THREE).replace(b"points    203", b"points    204"), RecordFormatError, r"stream:10: expected 'Number"),
        (geonet(THREE).replace(b"     203", b"99999999"), RecordFormatError, r"stream:10: expected 'Number of points"),
        (geonet(THREE).replace(b"  0.0050  0.0050", b"  0.0050  0.0500"), RecordFormatError, "stream:11: .* of 0.05 s"),
        (geonet(THREE).replace(b"of 1.00 mm/s/s", b"of 1.00 furlong"), UnitError, "stream:11: unknown unit"),
        (geonet(THREE, corrected=True).replace(b"mm/s/s", b"stone "), UnitError, "stream:14: unknown unit"),
        (geonet(THREE).replace(b"    82.0\n", b"    8x.0\n"), RecordFormatError, r"stream:\d+: expected a finite"),
        (geonet(THREE) + b"more\n", RecordFormatError, "expected the title of component 4"),
    ],
    ids=["header", "rows", "displacement", "text", "huge", "step", "unit", "unit-2", "letter", "trailing"],
)
def test_damage_is_named(content, error, message):
    with pytest.raises(error, match=message):
        got(content)


@pytest.mark.parametrize(("component", "azimuth"), [("N 53 W", 307.0), ("S 5 E", 175.0), ("N 53W", 307.0)])
def test_directions_with_blanks(component, azimuth):
    (record,) = got(geonet([THREE[0]], [component]))
    assert (record.azimuth, record.component) == (azimuth, component)


@pytest.mark.parametrize(("coded", "azimuth"), [(10, 10.0), (11, 10.0), (0, 10.0), (280, np.nan)])
def test_an_azimuth_that_text_and_integer_do_not_agree_on(coded, azimuth):
    content = geonet([THREE[0]], ["N10E"])
    assert content.count(b"      10      10     140") == 1
    (record,) = got(content.replace(b"      10      10     140", f"      10{coded:8d}     140".encode()))
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert record.orientation == "horizontal"
    assert any("integer 28 of the header says 280" in note for note in record.warnings) is bool(np.isnan(azimuth))


def test_an_azimuth_that_only_the_integer_states():
    content = geonet([THREE[0]], ["X1"]).replace(b"      10       0     140", b"      10      45     140")
    assert got(content)[0].azimuth == 45.0


def test_a_file_that_ends_before_its_third_component_says_so():
    records = got(geonet(THREE[:2], ["N10E", "N80W"]))
    assert [record.warnings[-1] for record in records] == [
        "files of this format hold 3 channels of this recorder, the file holds 2; it may be truncated"
    ] * 2
    assert not any(record.warnings for record in got(geonet(THREE)))


def test_a_component_twice_is_damage():
    with pytest.raises(RecordFormatError, match=r":\d+: expected another channel, found that of line 1 a second time"):
        got(geonet(THREE, ["N10E", "N80W", "N10E"]))
