"""Reads the layout that files of CSMIP, USC, RENADIC and BHRC share: channels, headers, equally spaced samples.

Volume 1 is uncorrected, volume 2 corrected. A channel begins with 13 lines of text (in volume 2 after a title and
before 11 more lines), then integers (16I5) and floating-point values (8F10), which repeat some of the text. It ends at
a line ``/&`` or at the next title.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers import kit

#: Number of lines of text, and number of all header lines, of a channel of volume 1.
TEXT_LINES, HEADER_LINES = 13, 13 + 7 + 7
_HEADING = re.compile(r"(?i)\s*(\d{1,15})\s+(?:(accel)erogram points|points of (acc|vel|disp)\w* data)\b(.*)")
_KINDS = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_RATE = re.compile(r"\bat\s+([\d.]+)\s*(?:pts|points|samples)/sec", re.IGNORECASE)
_STEP = re.compile(r"\bspaced at\s+([\d.]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(r".*?(?:\bunits\s*(?:of|:)|,\s*in)\s*([^\s)]+)", re.IGNORECASE)
_FORMAT = re.compile(r"\((\d{1,3})[fe](\d{1,3})\.\d+\)", re.IGNORECASE)
_ROW = 8
_CHANNEL = re.compile(r"(?i)\s*chan\s*(\d+)\s*:\s*(.*?)\s*(?:\(sta chn:\s*(\d*)[^)]*\)\s*)?(?:location:\s*(.*?)\s*)?$")
_PLACE_AFTER = re.compile(r"(\d{1,3}\s*deg|up|down)\b[\s,:-]+(.*)", re.IGNORECASE)
_STATION = re.compile(r"\s*station (?:id|no)\.\s+(\w+)\s+\d+\.\d*\s*[NS]", re.IGNORECASE)
_COUNTED = re.compile(r"\((\d{1,3})\s*chns?\s+of\s+\d{1,3}", re.IGNORECASE)
_SEED_CODES = re.compile(r"\s*(\w+)\.(\w\w)\.(\w+)\.([\w-]{2})\.\w")
_START = re.compile(r"(?i)(?:start|trigger) time:\s*(\d+)/\s*(\d+)/\s*(\d+),?\s+(\d+):\s*(\d+):\s*([\d.]+)\s+([A-Z]+)")
# The trigger time is used as the time of the first sample. Digital CSMIP recorders state it so (in the SSA-1 record of
# Hesperia, 1992, the P wave arrives at the right time), and film recorders store nothing before the trigger.
_ORIGIN = re.compile(r"\(origin(?:\([^)]{0,20}\))?:(.{0,40})", re.IGNORECASE)
_DEPTH = re.compile(r"\bH\s*=\s*(\d{1,3}(?:\.\d{0,6})?)\s*KM", re.ASCII | re.IGNORECASE)
#: Pattern of the first row of integers; the fourth integer is the number of channels of the recorder.
_FIRST_ROW = re.compile(r"[ \d-]{15} *(\d{1,3})(?=[ \d-]{60}$)", re.ASCII)
#: Position and pattern of header integer 27, in the second row: the azimuth of the channel, or a code.
_AZIMUTH, _CODE = slice(50, 55), re.compile(r" *\d{1,3}", re.ASCII)
_UP, _DOWN = 500, 600
#: Position of header integer 28, the number of points of volume 1, and the largest number that it can contain.
_POINTS, _MOST_POINTS = slice(55, 60), 99_999
#: Number of rows of integers, number of characters of a floating-point value, and the values that mean unknown.
_INTEGER_ROWS, _REAL_WIDTH, _UNKNOWN = 7, 10, (0.0, -999.0)
_REAL = re.compile(r" *-?\d{0,8}\.\d{0,8}", re.ASCII)


@dataclass(frozen=True)
class CsmipHeader:
    """The header of one CSMIP channel, without the samples."""

    component: str  # direction of the sensor
    place: str = ""  # location of the sensor, if the file states it
    about: dict[str, Any] = field(default_factory=dict)  # station, earthquake, start time: arguments of `build_record`
    warnings: tuple[str, ...] = ()
    recorder: str = ""  # line that names the recorder
    number: str = ""  # numbers of the channel on the recorder and at the station; empty if not stated
    counted: int = 0  # number of channels of the recorder; 0 if it is not stated
    code: int = 0  # code of the direction, header integer 27; 0 if it is not stated
    repeated: tuple[str, ...] = ()  # the direction as further lines state it

    @property
    def full_component(self) -> str:
        """Return direction and location of the sensor as one text."""
        return f"{self.component} ({self.place})" if self.place else self.component

    def record(
        self, file: kit.SourceFile, number: int, block: kit.ChannelSamples, warnings: Sequence[str] = (), **further: Any
    ) -> kit.Record:
        """Return the record of this channel with the samples `block`; `further` is passed to `build_record`."""
        return kit.build_record(
            file,
            block.samples,
            block.dt,
            block.unit,
            number=number,
            component=self.full_component,
            facing=one_direction(self.component, self.code, self.repeated),
            original_peak=block.peak,
            warnings=(*block.warnings, *self.warnings, *warnings),
            **self.about,
            **further,
        )


@dataclass(frozen=True)
class SeriesHeading:
    """The heading line above a series of equally spaced values."""

    at: int  # index of the line
    kind: str  # "acceleration", "velocity" or "displacement"
    count: int  # number of values, as the line states it
    words: str  # the rest of the line
    warnings: tuple[str, ...] = ()

    @property
    def layout(self) -> tuple[int, int] | None:
        """Return the numbers of fields per row and characters per field; None if the line has no Fortran format."""
        match = _FORMAT.search(self.words)
        return (int(match[1]), int(match[2])) if match else None

    @property
    def unit(self) -> str:
        """Return the unit as the line states it; empty if the line states no unit."""
        return kit.matched(_UNIT, self.words)


def channels(
    file: kit.SourceFile, title: re.Pattern[str], wording: str, header_lines: int = 1
) -> tuple[list[str], list[kit.Span], tuple[str, ...]]:
    """Return the lines of a file, the span of each channel (which begins with a line like `title`), and warnings."""
    lines = kit.text_lines(file.content)
    if all(line.startswith(" ") for line in lines if line):
        lines = [line[1:] for line in lines]
    spans: list[kit.Span] = []
    notes: list[str] = []
    start = 0
    while start < len(lines):
        if not title.match(lines[start]):
            expected, found = f"{wording!r} (channel {len(spans) + 1})", repr(lines[start][:60].strip())
            raise kit.unexpected(f"{file.name}:{start + 1}", expected, found, kit.FILE_DAMAGED)
        first, start = start, kit.last_of_equal(lines, start)
        ends = (i for i in range(start + 1, len(lines)) if lines[i].startswith("/&") or title.match(lines[i]))
        end = next(ends, len(lines))
        spans.append((start, end))
        closed = end < len(lines) and lines[end].startswith("/&")
        closing = kit.last_of_equal(lines, end) if closed else end
        notes += (*kit.repeated_marker(first, start), *kit.repeated_marker(end, closing))
        start = next((i for i in range(closing + closed, len(lines)) if lines[i].strip()), len(lines))
    spans, copies = kit.distinct_sections(lines, spans)
    for number, (start, end) in enumerate(spans, 1):
        kit.check_count(f"{file.name}:{end}", header_lines, end - start, f"header lines of channel {number}")
    return lines, spans, (*notes, *copies)


def heading_at(lines: Sequence[str], at: int) -> SeriesHeading | None:
    """Return the heading in the line with index `at`; None if this line is not a heading."""
    match = _HEADING.match(lines[at][: kit.LONGEST_LINE]) if at < len(lines) else None
    if not match:
        return None
    last, kind = kit.last_of_equal(lines, at), _KINDS[(match[2] or match[3])[0].lower()]
    return SeriesHeading(last, kind, int(match[1]), match[4], kit.repeated_marker(at, last))


def equal_block(name: str, lines: Sequence[str], heading: SeriesHeading, end: int, unit: str) -> kit.ChannelSamples:
    """Read the accelerations between a heading and the line with index `end`; `unit` is their unit as stated."""
    where = f"{name}:{heading.at + 1}"
    rate, step = _RATE.search(heading.words), _STEP.search(heading.words)
    try:
        dt = 1.0 / float(rate[1]) if rate else float(step[1]) if step else 0.0
    except (ValueError, ZeroDivisionError):
        dt = 0.0
    if not dt > 0.0:
        expected, words = "'at N pts/sec' or 'equally spaced at N sec' with N > 0", repr(heading.words.strip())
        raise kit.unexpected(where, expected, words, "correct the line")
    found = kit.canonical_unit(unit, where)
    first, count = heading.at + 1, heading.count
    kit.check_count(where, count, count if first < end else 0)
    per_row, width = heading.layout or (_ROW, max(len(lines[first].rstrip()) // min(_ROW, count), 1))
    if per_row < 1 or width < 1:
        raise RecordFormatError(f"{where}: expected a format such as (8f9.6), found ({per_row}f{width})")
    samples, left = kit.fixed_block(name, lines, (first, end), width, per_row, count)
    return kit.ChannelSamples(samples, dt, found, dt * np.arange(count), samples, (*heading.warnings, *left))


def read_csmip_header(lines: Sequence[str]) -> CsmipHeader:
    """Read the header of one channel, which begins with the title 'Uncorrected Accelerogram Data'."""
    text, behind = [line[: kit.LONGEST_LINE] for line in lines[:TEXT_LINES]], lines[TEXT_LINES:]
    match = _CHANNEL.match(text[6])
    component, place = (match[2], match[4] or "") if match else (text[6].strip(), "")
    placed = _PLACE_AFTER.fullmatch(component)
    if placed:
        component, place = placed[1], place or placed[2]
    start_time, notes = _start_time(text[3])
    seed, origin, depth = _SEED_CODES.match(text[3]), _ORIGIN.search(text[2]), _DEPTH.search(text[8])
    recorded = _COUNTED.search(text[4]) or _FIRST_ROW.match(_row(behind, 0)[: kit.LONGEST_LINE].rstrip())
    about = {
        # Sensors on several floors of a structure have the same direction; the channel number, preferably the one at
        # the station, distinguishes them.
        "channel": (match[3] or match[1]) if match and place else "",
        "structural": kit.on_structure(place, stated=True),
        "network": seed[2] if seed else "",
        "station": seed[3] if seed else kit.matched(_STATION, text[4]),
        "location": seed[4].replace("-", "") if seed else "",
        "station_name": re.split(r"\s{2,}|\s+s/n\b", text[5].strip(), flags=re.IGNORECASE)[0],
        "event": " ".join(re.split(r"\s{2,}\(", text[1].strip())[0].split()),
        "start_time": start_time,
        "event_id": seed[1] if seed and seed[1].isdecimal() else "",
        "origin_time": kit.written(origin[1]) if origin else None,
        "magnitude": kit.magnitudes(text[8]),
        "hypocentre": kit.coordinates(text[8]),
        "depth_km": depth[1] if depth else "",
        "station_place": kit.coordinates(text[4]),
    }
    return CsmipHeader(
        component,
        place,
        about,
        warnings=notes,
        recorder=text[4].strip(),
        number=f"{match[1]} {match[3] or ''}" if match else "",
        counted=int(recorded[1]) if recorded else 0,
        code=direction_code(behind),
    )


def missing_channels(
    name: str, lines: Sequence[str], spans: Sequence[kit.Span], headers: Sequence[CsmipHeader]
) -> tuple[str, ...]:
    """Return a warning for each recorder whose channels are not all in the file."""
    pairs = zip(spans, headers, strict=True)
    counts = (kit.Counted(span[0] + 1, header.recorder, header.number, header.counted) for span, header in pairs)
    return kit.completeness(name, counts, closed=spans[-1][1] < len(lines))


def _start_time(line: str) -> tuple[datetime | None, tuple[str, ...]]:
    """Return the UTC time of the first sample, or None and a warning that states why it is unknown."""
    match = _START.search(line)
    if not match:
        return None, ()
    try:
        month, day, year, hour, minute = (int(text) for text in match.groups()[:5])
        if year < 100:
            year += 1900 if year >= 69 else 2000
        local = datetime(year, month, day, hour, minute, tzinfo=UTC) + timedelta(seconds=float(match[6]))
        moment = local - timedelta(hours=kit.ZONES[match[7].upper()])
    except (ValueError, KeyError, OverflowError):
        return None, (f"the start time {match[0]!r} cannot be read",)
    # A clock that was never set starts at midnight in its own time zone.
    fault = kit.clock_fault(local)
    return (None, (fault,)) if fault else (moment, ())


def _row(behind: Sequence[str], number: int) -> str:
    """Return row `number` (from 0) of the header values in `behind`, the lines after the text; empty if missing."""
    rows = (at for at, line in enumerate(behind) if _FIRST_ROW.match(line[: kit.LONGEST_LINE].rstrip()))
    at = next(rows, len(behind)) + number
    return behind[at] if at < len(behind) else ""


def direction_code(behind: Sequence[str]) -> int:
    """Return header integer 27, an azimuth or a code for up or down, from the lines after the text; 0 if not stated."""
    text = _row(behind, 1)[_AZIMUTH]
    return int(text) if _CODE.fullmatch(text) else 0


def held_count(behind: Sequence[str], points: int) -> list[str]:
    """Return a warning if header integer 28, the number of points, differs from `points`, stated in the text."""
    text = _row(behind, 1)[_POINTS]
    if not re.fullmatch(r" *\d{1,5}", text, re.ASCII) or int(text) in (0, points) or points > _MOST_POINTS:
        return []
    return [f"integer 28 of the header states {int(text)} points, but the text states {points}"]


def real_header_value(behind: Sequence[str], number: int) -> str:
    """Return floating-point header value `number` (from 1) as text, from the lines after the header text; else ""."""
    row, column = divmod(number - 1, 8)
    text = _row(behind, _INTEGER_ROWS + row)[_REAL_WIDTH * column : _REAL_WIDTH * (column + 1)]
    known = _REAL.fullmatch(text) and any(map(str.isdigit, text)) and float(text) not in _UNKNOWN
    return text if known else ""


def held_peak_real(behind: Sequence[str], number: int, block: kit.ChannelSamples, per_unit: float) -> list[str]:
    """Return a warning if the samples contradict the peak in floating-point header value `number` [`per_unit` m/s2]."""
    peak, rounding = kit.printed_number(real_header_value(behind, number))
    unit = per_unit / kit.STANDARD_GRAVITY
    stated, found = abs(peak) * unit, block.peak * kit.UNITS[block.unit] / kit.STANDARD_GRAVITY
    if abs(stated - found) > kit.PEAK_TOLERANCE * max(stated, found) + rounding * unit:
        value = f"floating-point value {number} of the header states a peak of {stated:.4g} g"
        return [f"{value}, but the samples have {found:.4g} g"]
    return []


def one_direction(component: str, code: int, repeated: Sequence[str] = ()) -> kit.Direction:
    """Return the direction of a channel; unknown, with a warning, if the header states different directions."""
    # The codes 0, 1100 and 1200 mean sensors without an azimuth.
    coded = kit.Direction("horizontal", float(code % 360)) if 1 <= code <= 360 else kit.Direction()
    if code in (_UP, _DOWN):
        coded = kit.Direction("vertical", sign=1.0 if code == _UP else -1.0)
    note = f"the text says {component!r}, but integer 27 of the header says {code}: the direction is unknown"
    facing = kit.held_direction(kit.direction(component), coded, note)
    for other in repeated:
        note = f"the text says {component!r}, but another line of the header says {other!r}: the direction is unknown"
        facing = facing if facing.note else kit.held_direction(facing, kit.direction(other), note)
    return facing
