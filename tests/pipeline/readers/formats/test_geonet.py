"""GeoNet V1A and V2A (New Zealand): both volumes, directions, clocks, damaged files."""

from datetime import timedelta

import numpy as np
import pytest
from record_writers._shared import pulse
from record_writers.geonet import START, geonet
from source_files import got

from rockpulse.errors import RockpulseError

THREE = tuple(np.round(pulse(203, peak, dt=0.005), 1) for peak in (2394.8, 2584.4, 1589.9))


@pytest.mark.parametrize("corrected", [False, True])
def test_only_the_accelerations_of_both_volumes_are_read(corrected):
    records = got(geonet(THREE, corrected=corrected))
    assert [record.processed for record in records] == [corrected] * 3
    for record, values in zip(records, THREE, strict=True):
        assert record.acceleration == pytest.approx(0.001 * values, rel=1e-12)
        assert (record.dt, record.start_time) == (0.005, START)
        assert (record.station, record.station_name) == ("HSES", "Hanmer Springs Emergency Centre")


def test_readings_in_another_unit_are_multiplied():
    record, _, _ = got(geonet(THREE, reading=0.5))
    assert record.unit_factor == 0.0005
    assert record.acceleration == pytest.approx(0.001 * THREE[0], abs=0.03e-3)
    assert record.warnings == ()


@pytest.mark.parametrize(("hours", "kept"), [(-0.9, True), (0.9, True), (-13.0, False), (2.0, False)])
def test_a_start_far_from_the_earthquake_is_left_out(hours, kept):
    start = START + timedelta(hours=hours, milliseconds=845)
    (record,) = got(geonet([THREE[0]], ["Up"], start=start))
    assert record.start_time == (start if kept else None)
    assert any("h from the earthquake of 2016-11-13 11:02:56" in note for note in record.warnings) is not kept


#: The first value of the second component is no number.
LETTER = geonet((THREE[0], np.concatenate([[-5.0], THREE[1]]), THREE[2])).replace(b"    -5.0", b"      5x", 1)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (geonet(THREE)[:1400], r"stream:\d+: expected 26 header lines of component 1"),
        (geonet(THREE)[:3000], r"stream:\d+: expected 21 rows of values of component 1"),
        (geonet(THREE, corrected=True)[:-200], "expected 63 rows of values of component 3"),
        (geonet(THREE).replace(b"points    203", b"points    204"), r"stream:10: expected 'Number"),
        (geonet(THREE).replace(b"  0.0050  0.0050", b"  0.0050  0.0500"), "stream:11: .* of 0.05 s"),
        (geonet(THREE).replace(b"of 1.00 mm/s/s", b"of 1.00 furlong"), "stream:11: unknown unit"),
        (geonet(THREE, corrected=True).replace(b"mm/s/s", b"stone "), "stream:14: unknown unit"),
        (geonet(THREE).replace(b"    82.0\n", b"    8x.0\n"), r"stream:\d+: expected a finite"),
        (geonet(THREE).replace(b"      10       0       2", b"      1o       0       2"), "stream:113:"),
        (LETTER, r"stream:74: expected a finite number, found '5x'"),
        (geonet(THREE).replace(b" at intervals of 0.005 s", b""), "stream:11: .* of 0.005 s"),
        (geonet(THREE).replace(b"     203       0", b"     203      -1"), r"stream:20: .* found \[203, -1, 0\]"),
        (geonet(THREE) + b"more\n", "expected the title of component 4"),
    ],
)
def test_damage_is_named(content, message):
    with pytest.raises(RockpulseError, match=message):
        got(content)


def test_a_title_that_is_repeated_with_other_spaces_is_one_title():
    content = geonet([THREE[0]], ["Up"])
    title = content.split(b"\n")[0]
    (record,) = got(title + b"\n " + title.replace(b" ", b"  ") + content[len(title) :])
    assert any("the line is repeated" in note for note in record.warnings)


@pytest.mark.parametrize(("component", "azimuth"), [("N 53 W", 307.0), ("S 5 E", 175.0), ("N 53W", 307.0)])
def test_directions_with_blanks(component, azimuth):
    (record,) = got(geonet([THREE[0]], [component]))
    assert (record.azimuth, record.component) == (azimuth, component)


@pytest.mark.parametrize(("coded", "azimuth"), [(10, 10.0), (11, 10.0), (0, 10.0), (280, np.nan)])
def test_an_azimuth_that_text_and_integer_do_not_agree_on(coded, azimuth):
    content = geonet([THREE[0]], ["N10E"])
    assert content.count(b"      10      10       2") == 1
    (record,) = got(content.replace(b"      10      10       2", f"      10{coded:8d}     140".encode()))
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert record.orientation == "horizontal"
    assert any("integer 28 of the header says 280" in note for note in record.warnings) is bool(np.isnan(azimuth))


@pytest.mark.parametrize(("padding", "told"), [("  0.0000", 0), ("  0.1500", 1)])
def test_the_time_of_the_peak_does_not_count_what_the_processing_put_before(padding, told):
    content = geonet(THREE)
    times = 0.005 * np.arange(203)
    padded = content.replace(b"    1.01    0.00    0.00    1.01", f"    1.01{padding}    0.00    1.01".encode())
    record = got(padded)[0]
    assert len(record.warnings) == told
    if told:
        peak = times[int(np.argmax(np.abs(THREE[0])))]
        assert f"the samples have it at {peak - 0.15:g} s" in record.warnings[0]


def test_components_without_a_name_are_counted():
    content = geonet(THREE)
    for component in (b"N10E", b"N80W", b"Up"):
        content = content.replace(b"Component " + component, b"Component ")
    content = content.replace(b"1.00 mm/s/s", b"1.00 cm/s/s", 2).replace(b"1.00 cm/s/s", b"1.00 mm/s/s", 1)
    records = got(content)
    assert [record.channel for record in records] == ["1", "2", "3"]
    note = "the units of one file differ: mm/s2 (1), cm/s2 (2), mm/s2 (3)"
    assert all(note in " ".join(record.warnings) for record in records)


def test_a_file_that_ends_before_its_third_component_says_so():
    records = got(geonet(THREE[:2], ["N10E", "N80W"]))
    assert [record.warnings[-1] for record in records] == [
        "files of this format have 3 channels of this recorder, but this file has 2; it may be truncated"
    ] * 2
    assert not any(record.warnings for record in got(geonet(THREE)))
