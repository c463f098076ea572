"""A part of a file that stands in it twice is one motion, told; two parts that differ are never joined or lost."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest
from make_format_samples import FORMATS as FOLDER
from make_format_samples import format_samples, read_options

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read
from rockpulse.readers.kit.checks import distinct_sections, last_of_equal
from rockpulse.record.record import Record

SHORT = 150
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
    assert all("copy of the first: it was read once" in record.warnings[-1] for record in records)
    assert records[0].source_sha256 != expected[0].source_sha256


def begins(name: str, mark: bytes) -> list[int]:
    """Where each line that holds a marker begins; the titles of CSMIP begin their lines."""
    before = rb"(?im)^\s?" if mark in (b"UNCORRECTED ACCEL", b"CORRECTED ACCEL") else rb"(?im)^.*"
    return [match.start() for match in re.finditer(before + re.escape(mark), FILES[name])]


@pytest.mark.parametrize(("name", "mark"), [(name, mark) for name, marks in MARKERS.items() for mark in marks])
def test_a_marker_that_is_written_twice_counts_once(name, mark):
    content = FILES[name]
    places = begins(name, mark)
    assert places
    for at in (places[0], places[-1]):
        line = content[at : content.index(b"\n", at) + 1]
        records = got(content[:at] + line + content[at:], name)
        assert same(records, got(content, name)), at
        told = [note for record in records for note in record.warnings if "it was read once" in note]
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
            assert all(any("stands in the file again" in note for note in record.warnings) for record in records)


@pytest.mark.parametrize("name", sorted(set(FILES) - WITHOUT_WORDS))
def test_two_records_in_one_file_are_never_one_motion(name):
    """Half of the motion behind the whole one: two records, or a refusal, or a warning; never more samples of one."""
    other = format_samples(SHORT // 2)[name]
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


def test_sections_and_markers_by_their_words():
    lines = ["TITLE", "", "TITLE ", "1 2", "TITLE", "1 2  ", "", "TITLE", "1 3"]
    assert [last_of_equal(lines, at) for at in (0, 2, 3, 8)] == [2, 2, 3, 8]
    kept, notes = distinct_sections(lines, [(2, 4), (4, 7), (7, 9)])
    assert kept == [(2, 4), (7, 9)]
    assert notes == ("line 5: the channel of line 3 stands in the file again; it was read once",)
