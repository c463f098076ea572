"""Channels, headers and headings in the layout of CSMIP, USC and RENADIC."""

import re
from datetime import UTC, datetime

import numpy as np
import pytest

from rockpulse.readers.kit.checks import held_length
from rockpulse.readers.kit.csmip_layout import (
    CsmipHeader,
    SeriesHeading,
    channels,
    equal_block,
    heading_at,
    one_direction,
    read_csmip_header,
)
from rockpulse.readers.kit.spacing import ChannelSamples
from rockpulse.readers.source import SourceFile
from rockpulse.record.defects import deciding
from rockpulse.record.record import STANDARD_GRAVITY as G
from rockpulse.record.record import Record

TITLE = re.compile("title", re.IGNORECASE)


def spans_of(*lines):
    content = "\n".join(lines).encode()
    return channels(SourceFile("a.v1", content, lambda: content), TITLE, "Title")


@pytest.mark.parametrize(
    ("lines", "spans", "notes"),
    [
        (["Title 1", "x", "Title 2", "y", "z"], [(0, 2), (2, 5)], []),
        (["Title 1", "x", "/& end", "", " ", "Title 2", "y", "/&"], [(0, 2), (5, 7)], []),
        (["Title 1", "x", "/&", "Title 2", "y", "/&", "Title 3", "z"], [(0, 2), (3, 5), (6, 8)], []),
        (
            ["Title", "Title", "x", "/&", "Title 2", "y"],
            [(1, 3), (4, 6)],
            ["line 1: the line is repeated up to line 2"],
        ),
        (["Title", "x", "/&", "", "/&", "Title 2"], [(0, 2), (5, 6)], ["line 3: the line is repeated up to line 5"]),
        (
            ["Title 1", "x", "/&", "Title 1", "x", "/&"],
            [(0, 2)],
            ["line 4: the channel of line 1 is repeated in the file"],
        ),
        (["Title 1"], [(0, 1)], []),
        (["Title 1", "Title 2", "x", "/&", "", "Title 3", "/&", "Title 4"], [(0, 1), (1, 3), (5, 6), (7, 8)], []),
    ],
)
def test_the_channels_of_a_file(lines, spans, notes):
    found, where, told = spans_of(*lines)
    assert (found, where) == (lines, spans)
    assert [note[: len(start)] for note, start in zip(told, notes, strict=True)] == notes


def test_a_blank_in_front_of_every_line_is_that_of_a_printer():
    assert spans_of(" Title", "", "  x", " /&")[0] == ["Title", "", " x", "/&"]
    assert spans_of("Title", " x")[0] == ["Title", " x"]


@pytest.mark.parametrize(
    ("words", "dt"),
    [("at 200 pts/sec", 0.005), ("at 50 samples/sec", 0.02), ("spaced at .25 sec", 0.25), ("spaced at 2.0 sec", 2.0)],
)
def test_the_interval_of_a_heading(words, dt):
    block = equal_block("a", ["x", "heading", "  1.  2. -3."], SeriesHeading(1, "acceleration", 3, words), 3, "cm/sec2")
    assert (block.dt, block.unit, block.warnings) == (dt, "cm/s2", ())
    assert list(block.samples) == list(block.values) == [1.0, 2.0, -3.0]
    assert list(block.times) == [0.0, dt, 2.0 * dt]


@pytest.mark.parametrize(
    ("count", "words", "rows", "notes"),
    [
        (10, "", [" 1 2 3 4 5 6 7 8", " 910"], []),
        (10, "", [" 1 2 3 4 5 6 7 8", " 91011", "12"], ["line 4: numbers beyond", "line 5: 1 rows beyond"]),
        (8, "", [" 1 2 3 4 5 6 7 8", ""], []),
        (1, "", ["1"], []),
        (3, "(2f2.0)", [" 1 2", " 3 4"], ["line 4: numbers beyond the declared"]),
        (2, "(1f1.0)", ["1", "2", "3"], ["line 5: 1 rows beyond the declared"]),
    ],
)
def test_the_rows_below_a_heading(count, words, rows, notes):
    heading = SeriesHeading(1, "acceleration", count, f"at 100 pts/sec {words}", ("own",))
    assert heading_at(["x"], 1) is None  # there is no second line
    block = equal_block("a", ["x", "heading", *rows, "behind"], heading, 2 + len(rows), "g")
    assert list(block.samples) == list(np.arange(1.0, count + 1.0))
    assert block.warnings[0] == "own"
    assert [note[: len(start)] for note, start in zip(block.warnings[1:], notes, strict=True)] == notes


def text_of(**lines):
    """The 13 lines of text of a channel, some of them given, as ``line7``, and two rows of integers."""
    text = [lines.get(f"line{number}", f"words {number}") for number in range(1, 14)]
    integers = ["    1    2    3    5" + "    0" * 12, "    0" * 10 + "   90" + "    0" * 5]
    return [*text, *integers]


@pytest.mark.parametrize(
    ("line", "component", "place", "channel", "number", "structural"),
    [
        ("CHAN  3: 90 DEG", "90 DEG", "", "", "3 ", False),
        ("Chan  3: 90 Deg (Sta Chn: 16)  Location: Roof: N wall ", "90 Deg", "Roof: N wall", "16", "3 16", True),
        ("Chan  3: Up  Location: Courtyard", "Up", "Courtyard", "3", "3 ", True),
        ("Chan  3: Up  Location: FREEFIELD", "Up", "FREEFIELD", "3", "3 ", False),
        ("Chan  3: 270 Deg - Deck", "270 Deg", "Deck", "3", "3 ", True),
        ("Chan  3: 270 Deg - Deck (Sta Chn: 16) Location: Roof", "270 Deg", "Roof", "16", "3 16", True),
        ("  vertical  ", "vertical", "", "", "", False),
        ("Chan  3: " + 300 * "x", 191 * "x", "", "", "3 ", False),
    ],
)
def test_the_direction_and_place_of_a_channel(line, component, place, channel, number, structural):
    header = read_csmip_header(text_of(line7=line))
    assert (header.component, header.place, header.about["channel"]) == (component, place, channel)
    assert (header.number, header.about["structural"]) == (number, structural)
    assert (header.counted, header.code, header.recorder) == (5, 90, "words 5")


def test_the_words_of_a_header():
    lines = {
        "line2": "  Big   Bear  (preliminary)  (not whole)",
        "line3": "(ORIGIN(CIT): 01/17/94, 12:30:55.4 GMT)",
        "line4": "38457511.CE.23837.0-.x  Start time: 7/06/19, 03:16: 8.5 PST",
        "line5": " Station No. 14403   33.5N, 118.25W  (7 chns of 12 at sta) ",
        "line6": "  Pomona   Orange Grove",
        "line9": "Hypocenter: 34.25N, 118.5W, H=18.5KM. ML=6.5",
    }
    header = read_csmip_header(text_of(**lines))
    assert (header.about["network"], header.about["station"], header.about["location"]) == ("CE", "23837", "0")
    assert (header.about["event"], header.about["station_name"]) == ("Big Bear", "Pomona")
    assert header.about["start_time"] == datetime(2019, 7, 6, 11, 16, 8, 500000, tzinfo=UTC)
    assert (header.counted, header.warnings, header.recorder) == (7, (), lines["line5"].strip())
    assert (header.about["event_id"], header.about["magnitude"]) == ("38457511", (6.5, "ML"))
    assert header.about["origin_time"] == datetime(1994, 1, 17, 12, 30, 55, 400000, tzinfo=UTC)
    assert (header.about["hypocentre"], header.about["depth_km"]) == ((34.25, -118.5), "18.5")
    assert header.about["station_place"] == (33.5, -118.25)

    fewer = read_csmip_header(text_of(**lines | {"line4": "ci12.CE.23837.--.x", "line6": "Pomona S/N 12 S/N 13"}))
    assert (fewer.about["event_id"], fewer.about["location"], fewer.about["station_name"]) == ("", "", "Pomona")
    assert (fewer.about["start_time"], fewer.warnings) == (None, ())
    assert read_csmip_header(text_of(line9="H= 18 km")).about["depth_km"] == "18"
    fewer = read_csmip_header(text_of(**lines | {"line4": "", "line3": "", "line9": ""}))
    assert (fewer.about["network"], fewer.about["station"], fewer.about["location"]) == ("", "14403", "")
    assert (fewer.about["event_id"], fewer.about["origin_time"], fewer.about["depth_km"]) == ("", None, "")
    assert read_csmip_header(text_of()).about["station"] == ""


@pytest.mark.parametrize(
    ("start", "moment", "note"),
    [
        ("Trigger time: 11/02/69, 3:04: 5.25 utc", (1969, 11, 2, 3, 4, 5, 250000), ""),
        ("start time: 11/02/68, 3:04: 5.25 UTC", (2068, 11, 2, 3, 4, 5, 250000), ""),
        ("start time: 11/ 2/99 3:04:05 PDT", (1999, 11, 2, 10, 4, 5), ""),
        ("start time: 11/02/1999, 23:59:30 PST", (1999, 11, 3, 7, 59, 30), ""),
        ("start time: 11/02/100, 3:04:05 UTC", None, "earlier than any accelerogram"),
        ("start time: 1/1/1980, 0:04:05 PST", None, "that of a clock that was never set"),
        ("start time: 13/02/1999, 3:04:05 UTC", None, "cannot be read"),
        *((f"start time: 11/02/1999, 3:04:{end}", None, "cannot be read") for end in ("0.5.5 UTC", "05 XYZ")),
        (f"start time: 11/02/1999, 3:04:{'9' * 20} UTC", None, "cannot be read"),
        ("started", None, ""),
    ],
)
def test_the_start_of_a_channel(start, moment, note):
    header = read_csmip_header(text_of(line4=f"x  {start}"))
    assert header.about["start_time"] == (datetime(*moment, tzinfo=UTC) if moment else None)
    assert len(header.warnings) == bool(note)
    assert note in "".join(header.warnings)


def test_the_record_of_a_channel():
    samples = np.array([0.0, 0.25, -0.5])
    block = ChannelSamples(
        samples, 0.02, "g", 0.02 * np.arange(4), np.array([0.0, 0.25, -0.75, 0.5]), ("of the block",)
    )
    header = CsmipHeader("90 Deg", "Roof", {"station": "CLC"}, ("of the header",))
    file = SourceFile("a.v1", b"x", lambda: b"x")
    how = {"format": "csmip_v1", "processed": True, "processing": ("step",)}
    record = header.record(file, 2, block, ("and another",), **how, header_peak=(0.75 * G, 0.1), peak_factor=1.0)
    assert list(record.acceleration) == [0.0, 0.25 * G, -0.5 * G]
    assert (record.dt, record.component, record.azimuth, record.station) == (0.02, "90 Deg (Roof)", 90.0, "CLC")
    assert record.warnings == ("of the block", "of the header", "and another")
    assert (record.processing, record.format, record.processed) == (("step",), "csmip_v1", True)
    assert len(header.record(file, 2, block, **how, header_peak=(0.85 * G, 0.11 * G), peak_factor=1.0).warnings) == 2
    assert len(header.record(file, 2, block, **how, header_peak=(0.85 * G, 0.09 * G), peak_factor=1.0).warnings) == 3
    assert CsmipHeader("Up").record(file, 2, block, **how).component == "Up"
    orientations = [
        CsmipHeader("Up", about={"structural": inside}).record(file, 2, block, **how).orientation
        for inside in (False, True)
    ]
    assert [record.orientation, *orientations] == ["horizontal", "vertical", "structural"]
    turned = CsmipHeader("90 Deg", code=270, repeated=("45",)).record(file, 2, block, **how)
    assert np.isnan(turned.azimuth)
    assert np.isnan(CsmipHeader("90 Deg", repeated=("45",)).record(file, 2, block, **how).azimuth)


@pytest.mark.parametrize(
    ("component", "code", "decides"),
    [("Up", 90, True), ("90 Deg", 500, True), ("Up", 600, False), ("90 Deg", 45, False)],
)
def test_a_channel_that_may_be_vertical_must_be_confirmed(component, code, decides):
    record = Record(np.sin(np.arange(50.0)), 0.01, id="a", warnings=(one_direction(component, code).note,))
    assert bool(deciding(record)) is decides


@pytest.mark.parametrize(
    ("stated", "decides"), [("15", True), ("14.9", False), ("6.6", True), ("6.7", False), ("0", False)]
)
def test_a_length_that_differs_greatly_must_be_confirmed(stated, decides):
    notes = held_length(stated, 1000, 0.01)
    assert notes == [f"the header states a duration of {stated} s, but 1000 samples at 0.01 s last 10 s"]
    assert bool(deciding(Record(np.sin(np.arange(50.0)), 0.01, id="a", warnings=notes))) is decides
