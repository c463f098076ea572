"""The common layout of volumes 1 and 2 of CSMIP, USC and RENADIC: channels in a file, their header, equal steps.

A channel begins with 13 lines of text (volume 2: a title before them and 11 lines behind them), integers (16I5) and
reals (8F10). A line ``/&`` or the next title ends it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.channel_count import Counted, completeness
from rockpulse.readers.clock import ZONES, clock_fault, written
from rockpulse.readers.csmip_numbers import channel_count, direction_code, one_direction
from rockpulse.readers.facing import on_structure
from rockpulse.readers.facts import NOTHING, Facts, coordinates, magnitudes, stated
from rockpulse.readers.fields import check_count, fixed_width, text_lines
from rockpulse.readers.pairs import Block, surplus
from rockpulse.readers.repeats import distinct_sections, last_of_equal, repeated_marker
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import canonical_unit
from rockpulse.record.record import Record

__all__ = [
    "HEADER_LINES",
    "LONGEST_LINE",
    "TEXT_LINES",
    "Header",
    "Heading",
    "channels",
    "equal_block",
    "heading_at",
    "missing_channels",
    "read_header",
]

#: Lines of text, and all lines in front of the samples, of a channel of volume 1.
TEXT_LINES, HEADER_LINES = 13, 13 + 7 + 7

#: No line of these formats is longer; a damaged one may be.
LONGEST_LINE = 200
_HEADING = re.compile(
    r"\s*(\d{1,15})\s+(?:(accel)erogram points|points of (acc|vel|disp)\w* data)\b(.*)", re.IGNORECASE
)
_KINDS = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_RATE = re.compile(r"\bat\s+([\d.]+)\s*(?:pts|points|samples)/sec", re.IGNORECASE)
_STEP = re.compile(r"\bspaced at\s+([\d.]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(r"(?:\bunits\s*(?:of|:)|,\s*in)\s*([^\s)]+)", re.IGNORECASE)
_FORMAT = re.compile(r"\((\d{1,3})[fe](\d{1,3})\.\d+\)", re.IGNORECASE)
_ROW = 8

_CHANNEL = re.compile(
    r"\s*chan\s*(\d+)\s*:\s*(.*?)\s*(?:\(sta chn:\s*(\d*)[^)]*\)\s*)?(?:location:\s*(.*?)\s*)?$", re.IGNORECASE
)
_PLACE_AFTER = re.compile(r"(\d{1,3}\s*deg|up|down)\b[\s,:-]+(.*)", re.IGNORECASE)
_STATION = re.compile(r"\s*station (?:id|no)\.\s+(\w+)\s+\d+\.\d*\s*[NS]", re.IGNORECASE)
_COUNTED = re.compile(r"\((\d{1,3})\s*chns?\s+of\s+\d{1,3}", re.IGNORECASE)
_SEED_CODES = re.compile(r"\s*(\w+)\.(\w\w)\.(\w+)\.([\w-]{2})\.\w")
_START = re.compile(
    r"(?:start|trigger) time:\s*(\d+)/\s*(\d+)/\s*(\d+),?\s+(\d+):\s*(\d+):\s*([\d.]+)\s+([A-Z]+)", re.IGNORECASE
)
# A trigger time is taken as that of the first sample: those of digital CSMIP recorders are (on the SSA-1 record of
# Hesperia, 1992, the P wave arrives when it must), and film recorders have no memory of what was before.
_ORIGIN = re.compile(r"\(origin(?:\([^)]{0,20}\))?:(.{0,40})", re.IGNORECASE)
_DEPTH = re.compile(r"\bH\s*=\s*(\d{1,3}(?:\.\d{0,6})?)\s*KM", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True)
class Header:
    """The text of one channel, without its samples; fields without a comment are those of `Record`."""

    component: str  # direction of the sensor
    place: str = ""  # location of the sensor, where the file names one
    channel: str = ""  # number of the channel, where a direction does not tell the channels of a station apart
    structural: bool = False  # whether the sensor is on a structure
    network: str = ""
    station: str = ""
    location: str = ""
    station_name: str = ""
    event: str = ""
    start_time: datetime | None = None
    facts: Facts = NOTHING
    warnings: tuple[str, ...] = ()
    recorder: str = ""  # line that names the recorder
    number: str = ""  # numbers of the channel on the recorder and at the station; empty where the file numbers none
    counted: int = 0  # channels of the recorder; 0 where the file does not say
    code: int = 0  # of the direction, integer 27; 0 where the file does not say
    repeated: tuple[str, ...] = ()  # the direction as further lines have it

    def noting(self, *warnings: str) -> Header:
        """The same header with further warnings."""
        return replace(self, warnings=(*self.warnings, *warnings))

    def record(
        self,
        file: SourceFile,
        number: int,
        block: Block,
        *,
        format: str,
        processed: bool,
        peak: tuple[float, float] = (float("nan"), 0.0),
        processing: Sequence[str] = (),
    ) -> Record:
        """The record of this channel with the samples of `block`; see `build_record`.

        `peak` is the peak that the header states, and half a unit of its last digit [m/s2].
        """
        return build_record(
            file,
            number,
            block.samples,
            block.dt,
            block.unit,
            format=format,
            processed=processed,
            component=f"{self.component} ({self.place})" if self.place else self.component,
            facing=one_direction(self.component, self.code, self.repeated),
            channel=self.channel,
            structural=self.structural,
            network=self.network,
            station=self.station,
            location=self.location,
            station_name=self.station_name,
            event=self.event,
            start_time=self.start_time,
            facts=self.facts,
            header_peak=peak[0],
            peak_rounding=peak[1],
            original_peak=block.peak,
            warnings=(*block.warnings, *self.warnings),
            processing=processing,
        )


@dataclass(frozen=True)
class Heading:
    """The line in front of a block of equally spaced values."""

    at: int  # index of the line
    kind: str  # "acceleration", "velocity" or "displacement"
    count: int  # number of values that it declares
    words: str  # the rest of the line
    warnings: tuple[str, ...] = ()

    @property
    def layout(self) -> tuple[int, int] | None:
        """Fields in a row and characters of a field, where the line names a Fortran format."""
        match = _FORMAT.search(self.words)
        return (int(match[1]), int(match[2])) if match else None

    @property
    def unit(self) -> str:
        """Unit as the line words it; empty where it names none."""
        match = _UNIT.search(self.words)
        return match[1] if match else ""


def channels(
    file: SourceFile, title: re.Pattern[str], wording: str
) -> tuple[list[str], list[tuple[int, int]], tuple[str, ...]]:
    """The lines of a file without the carriage control of a line printer, the span of each channel in them, warnings.

    A span is the index of the first line of a channel and of the line behind its last. The first line of each channel
    must match `title`, which `wording` describes in messages; raises RecordFormatError where another line stands there.
    A title or an end that stands there twice, and a channel that is a copy of another one, count once, with a warning.
    """
    lines = text_lines(file.content)
    if all(line.startswith(" ") for line in lines if line):
        lines = [line[1:] for line in lines]
    spans: list[tuple[int, int]] = []
    notes: list[str] = []
    start = 0
    while start < len(lines):
        if not title.match(lines[start]):
            raise RecordFormatError(
                f"{file.name}:{start + 1}: expected {wording!r} (channel {len(spans) + 1}), found "
                f"{lines[start][:60].strip()!r}; the file is damaged: download it again"
            )
        first, start = start, last_of_equal(lines, start)
        ends = (i for i in range(start + 1, len(lines)) if lines[i].startswith("/&") or title.match(lines[i]))
        end = next(ends, len(lines))
        spans.append((start, end))
        closing = last_of_equal(lines, end) if end < len(lines) and lines[end].startswith("/&") else end
        notes += (*repeated_marker(first, start), *repeated_marker(end, closing))
        start = closing + 1 if end < len(lines) and lines[end].startswith("/&") else end
        while start < len(lines) and not lines[start].strip():
            start += 1
    spans, copies = distinct_sections(lines, spans)
    return lines, spans, (*notes, *copies)


def heading_at(lines: Sequence[str], at: int) -> Heading | None:
    """The heading at index `at` of the lines of a file; None if the line is no heading or behind the last.

    Where the line stands there twice, the heading is that of the last one, with a warning.
    """
    match = _HEADING.match(lines[at][:LONGEST_LINE]) if at < len(lines) else None
    if not match:
        return None
    last = last_of_equal(lines, at)
    return Heading(last, _KINDS[(match[2] or match[3])[0].lower()], int(match[1]), match[4], repeated_marker(at, last))


def _interval(heading: Heading, where: str) -> float:
    rate, step = _RATE.search(heading.words), _STEP.search(heading.words)
    try:
        dt = 1.0 / float(rate[1]) if rate else float(step[1]) if step else 0.0
    except (ValueError, ZeroDivisionError):
        dt = 0.0
    if not dt > 0.0:
        raise RecordFormatError(
            f"{where}: expected 'at N pts/sec' or 'equally spaced at N sec' with N > 0, found "
            f"{heading.words.strip()!r}; repair the line or download the file again"
        )
    return dt


def equal_block(name: str, lines: Sequence[str], heading: Heading, end: int, unit: str) -> Block:
    """Read the accelerations below a heading, up to the line at index `end`; `unit` is as the file words it.

    Raises RecordFormatError for no interval, an impossible format, too few numbers or a damaged row; UnitError.
    """
    where = f"{name}:{heading.at + 1}"
    dt = _interval(heading, where)
    found = canonical_unit(unit, where)
    first, count = heading.at + 1, heading.count
    check_count(where, count, count if first < end else 0)
    fields = min(_ROW, count)
    per_row, width = heading.layout or (_ROW, max(len(lines[first].rstrip()) // fields, 1))
    if per_row < 1 or width < 1:
        raise RecordFormatError(f"{where}: expected a format such as (8f9.6), found ({per_row}f{width})")
    samples = fixed_width(lines[first:end], first + 1, width, per_row, count, name)
    rows = -(-count // per_row)
    left = surplus(lines, first + rows, end, used=width * (count - (rows - 1) * per_row))
    return Block(samples, dt, found, dt * np.arange(count), samples, (*heading.warnings, *left))


def read_header(lines: Sequence[str]) -> Header:
    """Read the at least `TEXT_LINES` (13) lines of text of a CSMIP channel, volume 1 or 2, or of RENADIC.

    The lines begin with 'Uncorrected Accelerogram Data' and may go on behind the text.
    """
    text = [line[:LONGEST_LINE] for line in lines[:TEXT_LINES]]
    match = _CHANNEL.match(text[6])
    component, place = (match[2], match[4] or "") if match else (text[6].strip(), "")
    placed = _PLACE_AFTER.fullmatch(component)
    if placed:
        component, place = placed[1], place or placed[2]
    network, station, location = _codes(text)
    start_time, notes = _start_time(text[3])
    return Header(
        component,
        place,
        # Structures repeat a direction on every floor; there the number tells the channels apart, that of the station
        # rather than that of the recorder.
        channel=(match[3] or match[1]) if match and place else "",
        structural=on_structure(place, stated=True),
        network=network,
        station=station,
        location=location,
        station_name=re.split(r"\s{2,}|\s+s/n\b", text[5].strip(), flags=re.IGNORECASE)[0],
        event=" ".join(re.split(r"\s{2,}\(", text[1].strip())[0].split()),
        start_time=start_time,
        facts=_facts(text),
        warnings=notes,
        recorder=text[4].strip(),
        number=f"{match[1]} {match[3] or ''}" if match else "",
        counted=_counted(text[4], lines[TEXT_LINES:]),
        code=direction_code(lines[TEXT_LINES:]),
    )


def _counted(recorder: str, behind: Sequence[str]) -> int:
    """Channels of the recorder, from its line of text, else from the integers; 0 where neither says."""
    found = _COUNTED.search(recorder)
    return int(found[1]) if found else channel_count(behind)


def missing_channels(
    name: str, lines: Sequence[str], spans: Sequence[tuple[int, int]], headers: Sequence[Header]
) -> tuple[str, ...]:
    """Warnings for missing channels, see `completeness`; `spans` and `headers` belong to the channels in `lines`."""
    counts = (
        Counted(start + 1, header.recorder, header.number, header.counted)
        for (start, _), header in zip(spans, headers, strict=True)
    )
    return completeness(name, counts, closed=spans[-1][1] < len(lines))


def _codes(text: Sequence[str]) -> tuple[str, str, str]:
    """Network, station and location codes."""
    seed = _SEED_CODES.match(text[3])
    if seed:
        return seed[2], seed[3], seed[4].replace("-", "")
    station = _STATION.match(text[4])
    return "", station[1] if station else "", ""


def _facts(text: Sequence[str]) -> Facts:
    """The earthquake by lines 3 and 9 of the text, or 4 where its number stands before the codes; the station by 5."""
    origin, depth, seed = _ORIGIN.search(text[2]), _DEPTH.search(text[8]), _SEED_CODES.match(text[3])
    return stated(
        event_id=seed[1] if seed and seed[1].isdecimal() else "",
        origin_time=written(origin[1]) if origin else None,
        magnitude=magnitudes(text[8]),
        hypocentre=coordinates(text[8]),
        depth_km=depth[1] if depth else "",
        station=coordinates(text[4]),
    )


def _start_time(line: str) -> tuple[datetime | None, tuple[str, ...]]:
    """UTC time of the first sample, or a warning that says why there is none."""
    match = _START.search(line)
    if not match:
        return None, ()
    zone = match[7].upper()
    try:
        month, day, year, hour, minute = (int(text) for text in match.groups()[:5])
        if year < 100:
            year += 1900 if year >= 69 else 2000
        local = datetime(year, month, day, hour, minute, tzinfo=UTC) + timedelta(seconds=float(match[6]))
        moment = local - timedelta(hours=ZONES[zone])
    except (ValueError, KeyError, OverflowError):
        return None, (f"the start time {match[0]!r} cannot be read",)
    # A clock that was never set begins at midnight of its own zone.
    fault = clock_fault(local)
    return (None, (fault,)) if fault else (moment, ())
