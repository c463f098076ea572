"""GeoNet volume 1 and 2 files of New Zealand (V1A uncorrected, V2A corrected).

Each component has 16 lines of text, 40 integers (10I8), 60 floating-point values (10F8) and the accelerations [mm/s2]
(10F8), in a V2A file followed by velocities and displacements. Layout:
https://www.geonet.org.nz/data/types/strong_motion
"""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

_TITLE = re.compile(r"(un)?corrected accelerogram\s+\d{8}_\d{6}_([^\W_]+)(?:_(\w+))?", re.IGNORECASE)
_TEXT_LINES, _INTEGER_LINES, _REAL_LINES = 16, 4, 6
_HEADER_LINES = _TEXT_LINES + _INTEGER_LINES + _REAL_LINES
_WIDTH, _PER_ROW = 8, 10
_COMPONENTS = 3
_POINTS = re.compile(r"number of points\s+(\d{1,9})\b", re.IGNORECASE)
_READINGS = re.compile(r"raw readings in units of\s+(\d{1,9}(?:\.\d{0,9})?)\s+(\S+)", re.IGNORECASE)
_STEP = re.compile(r"\bat (?:intervals of\s+)?(\d{0,3}\.\d{1,6})\s*s", re.IGNORECASE)
_COMPONENT = re.compile(r"component\s+([NS]\s*\d{1,2}(?:\.\d{0,3})?\s*[EW]\b|\S+)", re.IGNORECASE)
_DISTANCE = re.compile(r".*?\bdist\s+(\d{1,5})\s*km", re.ASCII | re.IGNORECASE)
_DEPTH = re.compile(r".*?\bdepth\s+(\d{1,3})\s*km", re.ASCII | re.IGNORECASE)
_PEAK = re.compile(r"(?i)acceleration:\s+peak\s*(-?\d{1,9}(?:\.\d{0,9})?)\s*(\S+)(?:\s+at\s+(\d{0,6}\.\d{1,6})\s*s)?")
_OTHER_PEAKS = re.compile(r"(?:velocity|displacement):\s+peak\s*-?\d{1,9}(?:\.\d{0,9})?\s*(\S+)", re.IGNORECASE)
_DURATION = re.compile(r".{0,60}?\bduration\s+(\d{0,6}\.\d{1,6})\s*s", re.IGNORECASE)


def read_geonet(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the accelerations of every component; `options` is not used, because the file states unit and interval."""
    lines = kit.text_lines(file.content)
    components: dict[kit.Span, kit.Record] = {}
    notes: list[str] = []
    start = 0
    while start < len(lines):
        if not _TITLE.match(lines[start]):
            expected = f"the title of component {len(components) + 1}, 'Corrected' or 'Uncorrected accelerogram'"
            found = repr(lines[start][:60].strip())
            raise kit.unexpected(f"{file.name}:{start + 1}", expected, found, kit.FILE_DAMAGED)
        first, start = start, kit.last_of_equal(lines, start)
        notes += kit.repeated_marker(first, start)
        record, end = _component(file, lines, start, len(components) + 1)
        components[start, end] = record
        start = next((at for at in range(end, len(lines)) if lines[at].strip()), len(lines))
    kept, copies = kit.distinct_sections(lines, list(components), "component")
    records = [components[span] for span in kept]
    pairs = zip(kept, records, strict=True)
    counts = (kit.Counted(start + 1, lines[start], record.component, _COMPONENTS) for (start, _), record in pairs)
    notes += (*copies, *kit.completeness(file.name, counts, "files of this format have"))
    units = ((record.component or str(number), record.source_unit) for number, record in enumerate(records, 1))
    return kit.with_warnings(records, (*notes, *kit.held_units(units)))


def _component(file: kit.SourceFile, lines: Sequence[str], start: int, number: int) -> tuple[kit.Record, int]:
    """Read the component that begins at index `start`; return the record and the index of the line after its values."""
    end = f"{file.name}:{len(lines)}"
    kit.check_count(end, _HEADER_LINES, len(lines) - start, f"header lines of component {number}")
    text, integer_line, first = lines[start : start + _TEXT_LINES], start + _TEXT_LINES, start + _HEADER_LINES
    title = _TITLE.match(" ".join(text[0].split()))  # a repeated title may have other spaces
    assert title is not None
    integers = kit.fixed_width(lines[integer_line:], integer_line + 1, _WIDTH, _PER_ROW, 40, file.name)
    # Only the third row of floating-point values is needed.
    at = integer_line + _INTEGER_LINES + 2
    reals = kit.fixed_width(lines[at:], at + 1, _WIDTH, _PER_ROW, _PER_ROW, file.name)
    count, rows = _counts(file.name, text[9], start, integers)
    kit.check_count(end, rows, len(lines[first : first + rows]), f"rows of values of component {number}")
    values = (first, first + -(-count // _PER_ROW))
    samples, surplus = kit.fixed_block(file.name, lines, values, _WIDTH, _PER_ROW, count)
    raw = title[1] is not None
    peak, readings = _PEAK.match(text[13]), _READINGS.match(text[10])
    source, line = (readings, 10) if raw else (peak, 13)
    unit = kit.canonical_unit(source[2] if source else "", f"{file.name}:{start + 1 + line}")
    peak_unit = kit.canonical_unit(peak[2], f"{file.name}:{start + 14}") if peak else unit
    start_time, notes = kit.near_event(*_times(integers))
    step, interval = float(reals[5]), _STEP.search(text[10])
    stated, rounding = kit.printed_number(interval[1] if interval else "")
    if not (step > 0.0 and abs(step - stated) <= 1.01 * rounding):
        expected = f"an interval of {step:g} s (floating-point value 26 of the header)"
        raise kit.unexpected(f"{file.name}:{start + 11}", expected, repr(text[10].strip()))
    notes += (*surplus, *kit.held_length(kit.matched(_DURATION, text[9]), count, step))
    notes += kit.held_peak_time(kit.matched(_PEAK, text[13], 3), step * np.arange(count) - reals[1], samples)
    others = [match[1] for line in text[14:] if (match := _OTHER_PEAKS.match(line))]
    notes += kit.held_lengths_of_units([peak[2], *others]) if peak else []
    component, azimuth = kit.matched(_COMPONENT, text[12]), int(integers[27])
    coded = kit.Direction("horizontal", float(azimuth % 360)) if 0 < azimuth <= 360 else kit.Direction()
    note = f"the text says {component!r}, but integer 28 of the header says {azimuth}: the direction is unknown"
    record = kit.build_record(
        file,
        samples,
        step,
        unit,
        number=number,
        factor=kit.UNITS[unit] * (float(readings[1]) if readings else 1.0),
        processed=not raw,
        component=component,
        facing=kit.held_direction(kit.direction(component), coded, note),
        structural=kit.on_structure(text[2]),
        station=title[2],
        location=title[3] or "",
        station_name=text[2].strip(),
        event=text[6].strip(),
        start_time=start_time,
        origin_time=_times(integers)[1],
        magnitude=kit.magnitudes(text[8]),
        hypocentre=kit.coordinates(text[8]),
        depth_km=kit.matched(_DEPTH, text[8]),
        distance_km=kit.matched(_DISTANCE, text[8]),
        station_place=kit.coordinates(text[1]),
        header_peak=kit.printed_number(peak[1] if peak else ""),
        peak_factor=kit.UNITS[peak_unit],
        warnings=notes,
    )
    return record, first + rows


def _counts(name: str, line: str, start: int, integers: np.ndarray) -> tuple[int, int]:
    """Return the number of accelerations and of rows in all series; raise an error if text and integers differ."""
    points, where = _POINTS.match(line), f"{name}:{start + 10}"
    blocks = [int(value) for value in integers[33:36]]
    if not points or int(points[1]) != blocks[0]:
        raise kit.unexpected(where, f"'Number of points {blocks[0]}' (integer 34 of the header)", repr(line.strip()))
    kit.check_count(where, blocks[0], blocks[0])
    if min(blocks) < 0:
        expected = "counts of accelerations, velocities and displacements of at least 0"
        raise kit.unexpected(f"{name}:{start + _TEXT_LINES + 4}", expected, str(blocks))
    return blocks[0], sum(-(-block // _PER_ROW) for block in blocks)


def _times(integers: np.ndarray) -> tuple[datetime | None, datetime | None]:
    """Return the UTC times of the first sample and of the earthquake from the header's integers."""
    year, month, day, hour, minute, tenths = (float(value) for value in integers[:6])
    begins = [float(integers[number - 1]) for number in (9, 10, 19, 20, 39, 40)]
    start = kit.instant(begins[:3], (begins[3], begins[4], 0.001 * begins[5]))
    return start, kit.instant((year, month, day), (hour, minute, 0.1 * tenths))


GEONET = Format(
    name="geonet",
    what="GeoNet (New Zealand) V1A and V2A, the accelerations",
    recognised="first line 'Corrected' or 'Uncorrected accelerogram', date_time_site",
    unit="mm/s2",
    processed="by type",
    example="20161113_110313_THZ_20.V2A",
    detect=begins_with(_TITLE),
    parse=read_geonet,
)
