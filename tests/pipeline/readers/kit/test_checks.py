"""Statements of a header against the samples and against each other: where the limits are, and what is no statement."""

import io
import re
from types import SimpleNamespace

import numpy as np
import pytest
from make_format_samples import FORMATS as FOLDER
from make_format_samples import format_samples, read_options

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.kit.checks import (
    Counted,
    completeness,
    held_direction,
    held_length,
    held_lengths_of_units,
    held_peak_time,
    held_units,
)
from rockpulse.readers.kit.csmip_layout import (
    direction_code,
    held_count,
    held_peak_real,
    one_direction,
    real_header_value,
)
from rockpulse.readers.kit.direction import Direction, direction
from rockpulse.record.record import STANDARD_GRAVITY, Record

TIMES = 0.01 * np.arange(1000)
PEAK = 4.0 * np.exp(-(((TIMES - 5.0) / 0.02) ** 2)) - 1.0 * np.exp(-(((TIMES - 8.0) / 0.02) ** 2))


@pytest.mark.parametrize(
    ("text", "spare", "told"),
    [
        *((text, 0.0, False) for text in ("9.99", "10.02", "10.020000000000", "10", "", "none", "1e400")),
        *((text, 0.0, True) for text in ("10.03", "10.1", "9.96", "11")),
        ("10.04", 0.02, False),
    ],
)
def test_a_length_may_be_off_by_two_steps_and_its_rounding(text, spare, told):
    assert bool(held_length(text, 1000, 0.01, spare)) is told
    assert bool(held_length(text, 1000, 0.01)) is (told or spare > 0.0)
    assert held_length("11", 1050, 0.01) == []


@pytest.mark.parametrize(
    ("text", "told"), [("5.00", False), ("5.025", False), ("5.026", True), ("4.97", True), ("99", True), ("-5", True)]
)
def test_the_time_of_the_peak_is_where_nine_tenths_of_it_are(text, told):
    assert bool(held_peak_time(text, TIMES, PEAK)) is told
    assert bool(held_peak_time(text, TIMES, -0.25 * PEAK)) is told
    assert held_peak_time(text, TIMES, np.zeros(1000)) == []


def test_two_peaks_that_are_nearly_equal_are_both_right():
    both = PEAK + np.roll(PEAK, 200) * 0.95
    assert held_peak_time("7.00", TIMES, both) == held_peak_time("5.00", TIMES, both) == []
    tenths = [0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 9.0]  # nine tenths are enough
    assert held_peak_time("7.0", np.arange(8.0), np.array(tenths)) == []


def test_a_peak_that_is_stated_in_no_number_or_of_one_sample_tells_nothing():
    assert held_peak_time("soon", TIMES, PEAK) == held_peak_time("3", TIMES[:1], np.array([2.0])) == []
    assert held_peak_time("0.9", TIMES[:2], np.array([0.5, 2.0])) == [
        "the header states the peak at 0.9 s, but at the interval of 0.01 s the samples have it at 0.01 s"
    ]


def test_one_unit_under_two_names_is_one():
    assert held_units([("a", "cm/s2"), ("b", "gal")]) == held_units([("a", "g")]) == held_units([]) == []
    assert held_units([("a", "cm/s2"), ("b", "mm/s2")])[0].startswith("the units of one file differ: cm/s2 (a), mm/s2")


def test_one_length_in_several_spellings_is_one():
    assert held_lengths_of_units(["CMS/SEC/SEC", "cm/s", "cm"]) == []
    assert held_lengths_of_units(["mm/s/s", "CM/s"]) == [
        "the header states the units mm/s/s and CM/s, with different units of length; one of them is wrong"
    ]


@pytest.mark.parametrize(
    ("said", "told", "found"),
    [
        *(("N90E", told, ("horizontal", 90.0, False)) for told in ("90", "91")),
        ("N90E", "92", ("horizontal", np.nan, True)),
        ("N", "359", ("horizontal", 0.0, False)),
        *((said, told, ("horizontal", np.nan, True)) for said, told in (("N", "358.5"), ("358.5", "N"), ("E", "W"))),
        ("H1", "H2", ("horizontal", np.nan, False)),
        *(("UP", told, ("unknown", np.nan, True)) for told in ("90", "DOWN")),
        *((said, told, ("horizontal", 45.0, False)) for said, told in (("?", "45"), ("45", "?"), ("H1", "45"))),
        ("?", "?", ("unknown", np.nan, False)),
    ],
)
def test_two_statements_of_a_direction(said, told, found):
    facing = held_direction(direction(said), direction(told), "they differ")
    assert (facing.orientation, bool(facing.note)) == (found[0], found[2])
    assert facing.azimuth == pytest.approx(found[1], nan_ok=True)


#: The second row of a real header of the Strong Motion Instrumentation Program, whose fields touch.
ROWS = [
    "    1  100    1    3    3  100 -999    3    1    0  605 4114    050599   41    0",
    "    3   19   37    8  187    7    6 2019   10    3   9035430   39   36   74 -999",
]


def test_the_direction_among_the_integers_of_a_channel():
    assert direction_code(ROWS) == direction_code(["words", *ROWS]) == 90
    assert direction_code(ROWS[:1]) == direction_code([]) == 0
    assert direction_code([ROWS[0], ROWS[1].replace("   90", " 1100")]) == 0  # a sensor without an azimuth
    assert direction_code([ROWS[0], ROWS[1].replace("   90", "1  90")]) == 0  # damaged


@pytest.mark.parametrize(
    ("component", "code", "orientation", "azimuth"),
    [
        ("90 Deg", 90, "horizontal", 90.0),
        ("0 Deg", 0, "horizontal", 0.0),
        *(("?", code, "horizontal", azimuth) for code, azimuth in ((1, 1.0), (359, 359.0), (360, 0.0))),
        *(("?", code, "unknown", np.nan) for code in (0, 361)),
        *((word, code, "vertical", np.nan) for word, code in (("Up", 500), ("Down", 600), ("?", 500), ("?", 600))),
        *(("Up", code, "unknown", np.nan) for code in (600, 90)),
        ("H1", 45, "horizontal", 45.0),
        ("H1", 0, "horizontal", np.nan),
        ("90 Deg", 45, "horizontal", np.nan),
    ],
)
def test_a_direction_in_words_and_as_an_integer(component, code, orientation, azimuth):
    facing = one_direction(component, code)
    assert facing.orientation == orientation
    assert facing.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert bool(facing.note) is ((np.isnan(azimuth) and code in (45, 90)) or (component, code) == ("Up", 600))


def test_a_direction_that_another_line_repeats():
    twice = one_direction("90 Deg", 90, ("S00E", "90 DEG", "45"))
    assert twice.note.endswith("another line of the header says 'S00E': the direction is unknown")
    assert one_direction("90 Deg", 90, ("90 DEG", "S00E")).note.endswith(
        "another line of the header says 'S00E': the direction is unknown"
    )
    assert one_direction("90 Deg", 90, ("90 DEG", "?")) == Direction("horizontal", 90.0)


#: Seven rows of integers, then the first rows of reals, whose fields touch.
BEHIND = [
    *ROWS,
    *["    0" * 16] * 4,
    "    0" * 4,
    "  .0050000  .7071000 354.30000  .0213656 1.0000000 4989.6760 -.5666587 39.410000",
    " 200.00000 2.3841880  .4778242-999.00000 10.000000-999.00000 4.0000000      .000",
]


def test_the_reals_of_a_channel():
    known = [real_header_value(BEHIND, number).strip() for number in (3, 7, 8, 9)]
    assert known == ["354.30000", "-.5666587", "39.410000", "200.00000"]
    assert [real_header_value(BEHIND, number) for number in (12, 16, 17)] == ["", "", ""]  # unknown, zero, not there
    assert real_header_value(["words", *BEHIND], 8) == " 39.410000"
    for damaged in ("         .", "        -.", " 3x.410000", "   39 .410"):
        assert real_header_value([row.replace(" 39.410000", damaged) for row in BEHIND], 8) == ""
    assert real_header_value([], 3) == real_header_value(BEHIND[:7], 3) == ""


def test_the_count_in_the_integers():
    for rows, points in ((BEHIND, 35430), ([], 35430), (ROWS[:1], 5), (["    0" * 16] * 7, 35430)):
        assert held_count(rows, points) == []
    assert held_count(BEHIND, 35429) == ["integer 28 of the header states 35430 points, but the text states 35429"]
    assert held_count(BEHIND, 100_000) == []  # for which there is no room
    assert held_count(BEHIND, 99_999) == ["integer 28 of the header states 35430 points, but the text states 99999"]
    assert held_count([ROWS[0], ROWS[1].replace("35430", "    1")], 2) != []


@pytest.mark.parametrize(
    ("peak", "per_unit", "told"),
    [
        *((peak * STANDARD_GRAVITY, STANDARD_GRAVITY / 100.0, False) for peak in (2.00, 1.97, 2.03)),
        *((peak * STANDARD_GRAVITY, STANDARD_GRAVITY / 100.0, True) for peak in (1.95, 2.05)),
        (2.0, 0.01, False),
        (20.0, 0.01, True),
    ],
)
@pytest.mark.parametrize(("unit", "factor"), [("m/s2", 1.0), ("cm/s2", 0.01), ("g", STANDARD_GRAVITY)])
def test_the_peak_among_the_reals(peak, per_unit, told, unit, factor):
    block = SimpleNamespace(peak=peak / factor, unit=unit)
    assert bool(held_peak_real(BEHIND, 9, block, per_unit)) is told
    negative = [row.replace(" 200.00000", "-200.00000") for row in BEHIND]
    assert bool(held_peak_real(negative, 9, block, per_unit)) is told
    assert held_peak_real(BEHIND, 12, block, per_unit) == []  # unknown


@pytest.mark.parametrize(("peak", "told"), [(0.243, True), (0.245, False), (0.356, False), (0.358, True)])
def test_the_rounding_of_the_peak_among_the_reals_counts(peak, told):
    rows = [row.replace(" 200.00000", "        3.") for row in BEHIND]  # 0.25 to 0.35 m/s2, and 2 % more
    assert bool(held_peak_real(rows, 9, SimpleNamespace(peak=peak, unit="m/s2"), 0.1)) is told


SHORT = 150
HALVES = format_samples(SHORT // 2)
FILES = {name: content for name, content in format_samples(SHORT).items() if not name.endswith(".xml")}
#: Rows of numbers alone: nothing tells a copy from a motion that repeats itself.
WITHOUT_WORDS = {"clc_rows.g3"}
#: Files of several channels, and the lines with which a channel and, where there is one, its block begins or ends.
MARKERS = {
    "CLC_NEW.V1": (b"UNCORRECTED ACCEL", b"ACCELEROGRAM POINTS", b"/&"),
    "CLC_OLD.V1": (b"UNCORRECTED ACCEL", b"/&"),
    "clc_90.v2": (b"CORRECTED ACCEL", b"POINTS OF ACCEL", b"/&"),
    "clc_bhrc.V1": (b"* VOL1DS", b"/&"),
    "clc_cosmos.V1C": (b"TEXT LINES)", b" PTS, ", b"END-OF-DATA"),
    "clc_geonet.V1A": (b"UNCORRECTED ACCEL",),
    "clc_geonet.V2A": (b"CORRECTED ACCEL",),
    "clc_renadic.v1": (b"UNCORRECTED ACCEL", b"/&"),
    "clc_usc.v1": (b"OF UNCORRECTED",),
}


def got(content: bytes, name: str) -> list[Record]:
    stream = io.BytesIO(content)
    stream.name = str(FOLDER / name)
    return read(stream, **read_options().get(name, {}))


def same(records: list[Record], expected: list[Record]) -> bool:
    return [record.channel for record in records] == [record.channel for record in expected] and all(
        np.array_equal(one.acceleration, other.acceleration) and one.dt == other.dt
        for one, other in zip(records, expected, strict=True)
    )


@pytest.mark.parametrize("name", sorted(set(FILES) - WITHOUT_WORDS))
def test_a_file_that_holds_everything_twice_is_read_once(name):
    expected, records = got(FILES[name], name), got(2 * FILES[name], name)
    assert same(records, expected)
    assert all("copy of the first half; the content was read once" in record.warnings[-1] for record in records)
    assert records[0].source_sha256 != expected[0].source_sha256


def begins(name: str, mark: bytes) -> list[int]:
    """Where each line that holds a marker begins; the titles of CSMIP begin their lines."""
    before = rb"(?im)^\s?" if mark in (b"UNCORRECTED ACCEL", b"CORRECTED ACCEL") else rb"(?im)^.*"
    return [match.start() for match in re.finditer(before + re.escape(mark), FILES[name])]


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "mark"), [(name, mark) for name, marks in MARKERS.items() for mark in marks])
def test_a_marker_that_is_written_twice_counts_once(name, mark):
    content = FILES[name]
    places = begins(name, mark)
    assert places
    for at in (places[0], places[-1]):
        line = content[at : content.index(b"\n", at) + 1]
        records = got(content[:at] + line + content[at:], name)
        assert same(records, got(content, name)), at
        told = [note for record in records for note in record.warnings if "was read once" in note]
        assert told or mark == b"END-OF-DATA"


@pytest.mark.parametrize("name", MARKERS)
def test_a_channel_that_stands_there_twice_is_read_once(name):
    content = FILES[name]
    starts = [*begins(name, MARKERS[name][0]), len(content)]
    expected = got(content, name)
    for first, last in ((starts[0], starts[1]), (starts[-2], starts[-1])):
        records = got(content + content[first:last], name)
        assert same(records, expected)
        if len(starts) > 2:
            assert all(any("is repeated in the file" in note for note in record.warnings) for record in records)


@pytest.mark.parametrize("name", sorted(set(FILES) - WITHOUT_WORDS))
def test_two_records_in_one_file_are_never_one_motion(name):
    """Half of the motion behind the whole one: two records, or a refusal, or a warning; never more samples of one."""
    other = HALVES[name]
    expected = got(FILES[name], name)
    try:
        records = got(FILES[name] + other, name)
    except RockpulseError:
        return
    lengths = {record.npts for record in [*expected, *got(other, name)]}
    assert {record.npts for record in records} <= lengths
    assert len(records) == 2 * len(expected) or all(record.warnings for record in records)


def test_blocks_of_one_kind_that_differ_are_refused():
    content = FILES["clc_90.v2"]
    at = begins("clc_90.v2", b"POINTS OF ACCEL")[0]
    block = content[at : content.rindex(b"\n", 0, content.index(b"points of veloc")) + 1]
    again = got(content[:at] + block + content[at:], "clc_90.v2")
    assert same(again, got(content, "clc_90.v2"))
    assert "the block of line" in again[0].warnings[0]
    changed = block[:-12] + block[-12:].translate(bytes.maketrans(b"0123456789", b"1234567890"))
    with pytest.raises(RecordFormatError, match="found a second block of acceleration"):
        got(content[:at] + changed + content[at:], "clc_90.v2")


def channels(numbers: str, counted: int, recorder: str = "A") -> list[Counted]:
    return [Counted(line, recorder, number, counted) for line, number in enumerate(numbers, start=1)]


@pytest.mark.parametrize(
    ("numbers", "counted", "closed", "warned"),
    [
        *(("12", 3, True, True), ("1", 3, False, True), ("1", 3, True, False)),
        *((numbers, counted, False, False) for numbers, counted in (("123", 3), ("1234", 3), ("1", 0), ("12", 0))),
    ],
)
def test_fewer_channels_than_are_counted(numbers, counted, closed, warned):
    notes = completeness("a.V1", channels(numbers, counted), closed=closed)
    words = f"the header states 3 channels of this recorder, but this file has {len(numbers)}; it may be truncated"
    assert notes == ((words,) if warned else ())


def test_recorders_are_counted_apart():
    both = [*channels("123", 3), *channels("12", 3, "B")]
    assert len(completeness("a.V1", both)) == 1
    assert len(completeness("a.V1", both, closed=True)) == 1
    assert completeness("a.V1", [*both, Counted(6, "B", "3", 3)]) == ()


def test_a_channel_may_come_once():
    with pytest.raises(RecordFormatError, match=r"a.V1:3: expected another channel, found that of line 1"):
        completeness("a.V1", channels("121", 3))


def test_channels_without_a_number_and_of_another_kind_are_others():
    assert completeness("a.V1", [Counted(1, "A", "", 2), Counted(9, "A", "", 2)]) == ()
    both = [Counted(1, "A", "1", 1, "acceleration"), Counted(9, "A", "1", 1, "velocity")]
    assert completeness("a.V1", both) == ()


def test_the_largest_count_of_a_recorder_holds():
    uneven = [Counted(1, "A", "1", 2), Counted(5, "A", "2", 4), Counted(9, "A", "3", 2)]
    assert completeness("a.V1", uneven, "its numbers tell of") == (
        "its numbers tell of 4 channels of this recorder, but this file has 3; it may be truncated",
    )
