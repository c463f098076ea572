"""GeoNet volume 1 and 2 files of New Zealand (V1A uncorrected, V2A corrected).

Each component has 16 lines of text, 40 integers (10I8), 60 reals (10F8) and the accelerations, 10 fields of 8
characters in mm/s2; in a V2A file velocities and displacements of the same count follow, which are passed over.
Layout: https://www.geonet.org.nz/data/types/strong_motion
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.channel_count import Counted, completeness
from rockpulse.readers.clock import instant, near_event
from rockpulse.readers.facing import Direction, direction, on_structure
from rockpulse.readers.facts import Facts, coordinates, magnitudes, stated
from rockpulse.readers.fields import check_count, fixed_width, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import (
    held_direction,
    held_length,
    held_lengths_of_units,
    held_peak_time,
    held_units,
    left_in_row,
)
from rockpulse.readers.repeats import distinct_sections, last_of_equal, repeated_marker
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_geonet", "read_geonet"]

_TITLE = re.compile(r"(un)?corrected accelerogram\s+\d{8}_\d{6}_([^\W_]+)(?:_(\w+))?", re.IGNORECASE)
_TEXT_LINES, _INTEGER_LINES, _REAL_LINES = 16, 4, 6
_HEADER_LINES = _TEXT_LINES + _INTEGER_LINES + _REAL_LINES
_WIDTH, _PER_ROW = 8, 10
_COMPONENTS = 3
_POINTS = re.compile(r"number of points\s+(\d{1,9})\b", re.IGNORECASE)
_READINGS = re.compile(r"raw readings in units of\s+(\d{1,9}(?:\.\d{0,9})?)\s+(\S+)", re.IGNORECASE)
_STEP = re.compile(r"\bat (?:intervals of\s+)?(\d{0,3}\.\d{1,6})\s*s", re.IGNORECASE)
_COMPONENT = re.compile(r"component\s+([NS]\s*\d{1,2}(?:\.\d{0,3})?\s*[EW]\b|\S+)", re.IGNORECASE)
_DISTANCE = re.compile(r"\bdist\s+(\d{1,5})\s*km", re.ASCII | re.IGNORECASE)
_DEPTH = re.compile(r"\bdepth\s+(\d{1,3})\s*km", re.ASCII | re.IGNORECASE)
_PEAK = re.compile(
    r"acceleration:\s+peak\s*(-?\d{1,9}(?:\.\d{0,9})?)\s*(\S+)(?:\s+at\s+(\d{0,6}\.\d{1,6})\s*s)?", re.IGNORECASE
)
_OTHER_PEAKS = re.compile(r"(?:velocity|displacement):\s+peak\s*-?\d{1,9}(?:\.\d{0,9})?\s*(\S+)", re.IGNORECASE)
_DURATION = re.compile(r".{0,60}?\bduration\s+(\d{0,6}\.\d{1,6})\s*s", re.IGNORECASE)


def is_geonet(head: bytes, name: str) -> bool:
    """Whether the first line is the title of a component, with date, time and site."""
    return bool(_TITLE.match(head[:200].decode("latin-1")))


def read_geonet(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the accelerations of every component; the options are not used, because the format states everything."""
    lines = text_lines(file.content)
    records: list[Record] = []
    spans: list[tuple[int, int]] = []
    notes: list[str] = []
    start = 0
    while start < len(lines):
        if not _TITLE.match(lines[start]):
            raise RecordFormatError(
                f"{file.name}:{start + 1}: expected the title of component {len(records) + 1}, 'Corrected' or "
                f"'Uncorrected accelerogram', found {lines[start][:60].strip()!r}; "
                "the file is damaged: download it again"
            )
        first, start = start, last_of_equal(lines, start)
        notes += repeated_marker(first, start)
        record, rows = _component(file, lines[start:], start + 1, len(records) + 1)
        spans.append((start, start + _HEADER_LINES + rows))
        records.append(record)
        start += _HEADER_LINES + rows
        while start < len(lines) and not lines[start].strip():
            start += 1
    kept, copies = distinct_sections(lines, spans, "component")
    records = [record for record, span in zip(records, spans, strict=True) if span in kept]
    counts = (
        Counted(start + 1, lines[start], record.component, _COMPONENTS)
        for (start, _), record in zip(kept, records, strict=True)
    )
    notes += (*copies, *completeness(file.name, counts, "files of this format hold"))
    notes += held_units(
        (record.component or str(number), record.source_unit) for number, record in enumerate(records, 1)
    )
    return [replace(record, warnings=(*record.warnings, *notes)) for record in records]


def _component(file: SourceFile, lines: Sequence[str], first: int, number: int) -> tuple[Record, int]:
    """The component that begins at line `first` of the file, and the number of its rows of values."""
    check_count(
        f"{file.name}:{first + len(lines) - 1}", _HEADER_LINES, len(lines), f"header lines of component {number}"
    )
    title = _TITLE.match(lines[0])
    assert title is not None
    integer_line = first + _TEXT_LINES
    integers = fixed_width(lines[_TEXT_LINES:], integer_line, _WIDTH, _PER_ROW, 40, file.name)
    # The third row of reals; nothing in the others is needed.
    at = _TEXT_LINES + _INTEGER_LINES + 2
    reals = fixed_width(lines[at:], first + at, _WIDTH, _PER_ROW, _PER_ROW, file.name)
    count, rows = _counts(file.name, lines, first, integers)
    block = lines[_HEADER_LINES : _HEADER_LINES + rows]
    check_count(f"{file.name}:{first + len(lines) - 1}", rows, len(block), f"rows of values of component {number}")
    samples = fixed_width(block, first + _HEADER_LINES, _WIDTH, _PER_ROW, count, file.name)
    raw = title[1] is not None
    peak, readings = _PEAK.match(lines[13]), _READINGS.match(lines[10])
    stated, line = (readings, 10) if raw else (peak, 13)
    unit = canonical_unit(stated[2] if stated else "", f"{file.name}:{first + line}")
    header_peak, rounding = printed_number(peak[1]) if peak else (float("nan"), 0.0)
    peak_factor = UNITS[canonical_unit(peak[2], f"{file.name}:{first + 13}")] if peak else 1.0
    start_time, notes = _start_time(integers)
    step = _step(f"{file.name}:{first + 10}", lines[10], float(reals[5]))
    last = -(-count // _PER_ROW) - 1
    notes += left_in_row(block[last], first + _HEADER_LINES + last, _WIDTH * (count - _PER_ROW * last))
    notes += _held(lines, step, step * np.arange(count) - reals[1], samples)
    stated_component = _COMPONENT.match(lines[12])
    component = stated_component[1] if stated_component else ""
    record = build_record(
        file,
        number,
        samples,
        step,
        unit,
        factor=UNITS[unit] * (float(readings[1]) if readings else 1.0),
        format="geonet",
        processed=not raw,
        component=component,
        facing=_facing(component, int(integers[27])),
        structural=on_structure(lines[2]),
        station=title[2],
        location=title[3] or "",
        station_name=lines[2].strip(),
        event=lines[6].strip(),
        start_time=start_time,
        facts=_facts(lines, integers),
        header_peak=header_peak * peak_factor,
        peak_rounding=rounding * peak_factor,
        warnings=notes,
    )
    return record, rows


def _counts(name: str, lines: Sequence[str], first: int, integers: np.ndarray) -> tuple[int, int]:
    """Number of accelerations, and of rows of all blocks, on which the text and integers 34 to 36 must agree."""
    points = _POINTS.match(lines[9])
    blocks = [int(value) for value in integers[33:36]]
    if not points or int(points[1]) != blocks[0]:
        raise RecordFormatError(
            f"{name}:{first + 9}: expected 'Number of points {blocks[0]}' (integer 34 of the header), "
            f"found {lines[9].strip()!r}; the header is damaged: download the file again"
        )
    check_count(f"{name}:{first + 9}", blocks[0], blocks[0])
    if min(blocks) < 0:
        raise RecordFormatError(
            f"{name}:{first + _TEXT_LINES + 3}: expected counts of accelerations, velocities and displacements of at "
            f"least 0, found {blocks}; the header is damaged: download the file again"
        )
    return blocks[0], sum(-(-block // _PER_ROW) for block in blocks)


def _step(where: str, line: str, step: float) -> float:
    """Sampling interval [s], real 26 of the header; the text, with fewer digits, must agree."""
    match = _STEP.search(line)
    stated, rounding = printed_number(match[1]) if match else (np.nan, np.nan)
    if not (step > 0.0 and abs(step - stated) <= 1.01 * rounding):
        raise RecordFormatError(
            f"{where}: expected an interval of {step:g} s (real 26 of the header), found {line.strip()!r}; "
            "the header is damaged: download the file again"
        )
    return step


def _held(lines: Sequence[str], step: float, times: np.ndarray, samples: np.ndarray) -> list[str]:
    """Warnings where the duration, the time of the peak or the units in the text contradict the samples.

    The times (n,) [s] are those of the text, which are 0 at the beginning of the raw record: real 22 is what the
    processing has put before it.
    """
    peak, duration = _PEAK.match(lines[13]), _DURATION.match(lines[9])
    others = [match[1] for line in lines[14:_TEXT_LINES] if (match := _OTHER_PEAKS.match(line))]
    notes = held_length(duration[1], samples.size, step) if duration else []
    if peak and peak[3]:
        notes += held_peak_time(peak[3], times, samples)
    return notes + (held_lengths_of_units([peak[2], *others]) if peak else [])


def _facing(component: str, azimuth: int) -> Direction:
    """The direction of the wording; unknown, with a note, where integer 28, its azimuth if above 0, contradicts it."""
    told = Direction("horizontal", float(azimuth % 360)) if 0 < azimuth <= 360 else Direction()
    note = f"the text says {component!r}, integer 28 of the header says {azimuth}: the direction is unknown"
    return held_direction(direction(component), told, note)


def _start_time(integers: np.ndarray) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample: integers 9, 10, 19, 20, 39, 40; the earthquake stands in integers 1 to 6."""
    numbers = [float(value) for value in integers]
    day, time = (numbers[8], numbers[9], numbers[18]), (numbers[19], numbers[38], 0.001 * numbers[39])
    return near_event(instant(day, time), _origin(integers))


def _origin(integers: np.ndarray) -> datetime | None:
    year, month, day, hour, minute, tenths = (float(value) for value in integers[:6])
    return instant((year, month, day), (hour, minute, 0.1 * tenths))


def _facts(lines: Sequence[str], integers: np.ndarray) -> Facts:
    """The station by line 2 of the text, the earthquake by line 9 and the integers."""
    distance, depth = _DISTANCE.search(lines[8]), _DEPTH.search(lines[8])
    return stated(
        origin_time=_origin(integers),
        magnitude=magnitudes(lines[8]),
        hypocentre=coordinates(lines[8]),
        depth_km=depth[1] if depth else "",
        distance_km=distance[1] if distance else "",
        station=coordinates(lines[1]),
    )


FORMATS = (
    Format(
        name="geonet",
        what="GeoNet (New Zealand) V1A and V2A, the accelerations",
        recognised="first line 'Corrected' or 'Uncorrected accelerogram', date_time_site",
        unit="mm/s2",
        processed="by type",
        example="20161113_110313_THZ_20.V2A",
        detect=is_geonet,
        parse=read_geonet,
    ),
)
