"""BHRC volume 1 files of Iran (Building and Housing Research Center), uncorrected.

Each channel has 13 lines of text, 7 of integers, 7 of reals and the accelerations in g/10, 10 fields of 13 characters;
a line ``/&`` ends it. The azimuths of L and T stand in the line of the station. The time that the files state is that
of the earthquake: when the record starts is not known.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.channel_count import Counted, completeness
from rockpulse.readers.clock import written
from rockpulse.readers.csmip_layout import HEADER_LINES, LONGEST_LINE, TEXT_LINES, channels
from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.facts import coordinates, magnitudes, stated
from rockpulse.readers.fields import check_count, fixed_width
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import held_units
from rockpulse.readers.pairs import declared_points, pair_unit, surplus
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_bhrc", "read_bhrc"]

_TITLE = re.compile(r"\s*\*\s*vol1\w*\s+file\s*:", re.IGNORECASE)
_WIDTH, _PER_ROW = 13, 10
_COMPONENTS = 3
_COMPONENT = re.compile(r"\s*comp\s+([LVT])\s*\d*\s*$", re.IGNORECASE)
_STATION = re.compile(r"(.*?)\s+station\b", re.IGNORECASE)
_AZIMUTH = r"azimuth\b.*\b{}\s+(\d{{1,3}}(?:\.\d*)?)(?!\S)"
_ORIGIN = re.compile(r"\s*origin time\s*:\s*(.*)", re.IGNORECASE)
_DEPTH = re.compile(r"\bFD\s*(\d{1,3}(?:\.\d{0,3})?)\s*km", re.ASCII | re.IGNORECASE)
_DURATION = re.compile(r"duration\s*=\s*(\d{1,6}(?:\.\d{0,9})?)", re.IGNORECASE)
#: The stated duration, of the samples or of the steps between them, may be off by this many steps.
_DURATION_STEPS = 2.0
#: L and T are at right angles, within so many degrees.
_SQUARE = 3.0


def is_bhrc(head: bytes, name: str) -> bool:
    """Whether the first line is ``* VOL1DS FILE:`` or the like."""
    return bool(_TITLE.match(head[:200].decode("latin-1")))


def read_bhrc(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel; the options are not used, because the format states everything."""
    lines, spans, copies = channels(file, _TITLE, "* VOL1DS FILE:")
    records = [_channel(file, lines, start, end, number) for number, (start, end) in enumerate(spans, start=1)]
    counts = (
        Counted(start + 1, "", record.component, _COMPONENTS) for (start, _), record in zip(spans, records, strict=True)
    )
    units = held_units((record.component, record.source_unit) for record in records)
    notes = (*completeness(file.name, counts, "files of this format hold"), *copies, *units, *_held_azimuths(records))
    return [replace(record, warnings=(*record.warnings, *notes)) for record in records]


def _channel(file: SourceFile, lines: Sequence[str], start: int, end: int, number: int) -> Record:
    check_count(f"{file.name}:{end}", HEADER_LINES, end - start, f"header lines of channel {number}")
    header, first = [line[:LONGEST_LINE] for line in lines[start : start + TEXT_LINES]], start + HEADER_LINES
    count = declared_points(header[10], f"{file.name}:{start + 11}")
    unit = pair_unit(header[11], f"{file.name}:{start + 12}")
    step = _step(file.name, lines, start, count)
    samples = fixed_width(lines[first:end], first + 1, _WIDTH, _PER_ROW, count, file.name)
    rows = -(-count // _PER_ROW)
    left = surplus(lines, first + rows, end, used=_WIDTH * (count - (rows - 1) * _PER_ROW))
    component = _COMPONENT.match(header[6])
    if not component:
        raise RecordFormatError(
            f"{file.name}:{start + 7}: expected 'COMP L1', 'COMP V2' or 'COMP T3', found {header[6].strip()!r}; "
            "the header is damaged: download the file again"
        )
    station, origin, depth = _STATION.match(header[7]), _ORIGIN.match(header[2]), _DEPTH.search(header[8])
    return build_record(
        file,
        number,
        samples,
        step,
        unit,
        format="bhrc",
        processed=False,
        component=component[1].upper(),
        facing=_facing(component[1].upper(), header[7]),
        station_name=station[1].strip() if station else "",
        event=" ".join(origin[1].split()) if origin else "",
        facts=stated(
            origin_time=written(origin[1]) if origin else None,
            magnitude=magnitudes(header[8]),
            hypocentre=coordinates(header[8]),
            depth_km=depth[1] if depth else "",
            station=coordinates(header[7]),
        ),
        warnings=[*_held_letter(header[4], component[1]), *left],
    )


def _held_letter(line: str, component: str) -> list[str]:
    """A warning where the fifth line of the header names another component than the seventh."""
    letter = line.strip().upper()
    if letter not in ("L", "V", "T") or letter == component.upper():
        return []
    return [f"the header names the component {letter} and {component.upper()}; one of them is wrong"]


def _held_azimuths(records: Sequence[Record]) -> list[str]:
    """A warning where L and T, as the lines of the station have them, are not at right angles."""
    azimuths = {record.component: record.azimuth for record in records}
    turn = abs(azimuths.get("T", np.nan) - azimuths.get("L", np.nan)) % 180.0
    if abs(turn - 90.0) <= _SQUARE or np.isnan(turn):
        return []
    return [f"the azimuths of L and T, {azimuths['L']:g} and {azimuths['T']:g} degrees, are not at right angles"]


def _step(name: str, lines: Sequence[str], start: int, count: int) -> float:
    """Sampling interval [s] from real 9 of the header, the rate; the duration must agree."""
    # The rows of eight reals are cut short on paper's width; the ninth begins the second row.
    rate = float(fixed_width([lines[start + 21][:_WIDTH]], start + 22, _WIDTH, 1, 1, name)[0])
    duration = _DURATION.search(lines[start + 10][:LONGEST_LINE])
    if not rate > 0.0 or (duration and abs(float(duration[1]) * rate - count) > _DURATION_STEPS):
        raise RecordFormatError(
            f"{name}:{start + 22}: expected the samples per s of {count} points in "
            f"{duration[1] if duration else 'an unknown number of'} s, found {rate:g}; "
            "the header is damaged: download the file again"
        )
    return 1.0 / rate


def _facing(letter: str, station_line: str) -> Direction:
    azimuth = re.search(_AZIMUTH.format(letter), station_line, re.IGNORECASE)
    if letter == "V" or not azimuth or float(azimuth[1]) > 360.0:
        return direction(letter)
    return Direction("horizontal", float(np.mod(float(azimuth[1]), 360.0)))


FORMATS = (
    Format(
        name="bhrc",
        what="BHRC (Iran) volume 1",
        recognised="first line '* VOL1DS FILE:'",
        unit="g/10, from the header",
        processed="no",
        example="5520-1.V1",
        detect=is_bhrc,
        parse=read_bhrc,
    ),
)
