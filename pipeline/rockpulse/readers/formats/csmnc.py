"""Files of the China Strong Motion Network Centre (CSMNC).

16 lines of header, the last one blank, then accelerations, 8 in a row; some copies end every line with ``$``. One file
holds one component. The header::

    <station><date and hour of the earthquake><number>
    <time of the earthquake> 2013-04-20 8:2:46 BTM
    <name of the earthquake>
    EPICENTER  30.300N 103.000E DEPTH 13 KM
    MAGNITUDE  7.0(Ms)
    STATION: <code> 30.400N 102.800E
    SITE CONDITION: ROCK
    INSTRUMENT TYPE: <recorder>/<sensor>
    OBSERVING POINT: GROUND
    COMP. EW
    UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC
    NO. OF POINTS:  12000  EQUALLY SPACED INTERVALS OF:  0.005  SEC
    PEAK VALUE:     -100.350   AT   26.35 SEC    DURATION:  60 SEC
    PRE-EVENT TIME:  20  SEC
    CSMNC

.. note:: The second line is the time of the earthquake in Beijing (UTC+8), and the length of the memory before the
   trigger says nothing about the time of the trigger: the time of the first sample is not known.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import instant
from rockpulse.readers.facing import Direction, direction, on_structure
from rockpulse.readers.facts import Facts, coordinates, stated
from rockpulse.readers.fields import check_count, free_rows, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import contradictory, held_length, held_peak_time
from rockpulse.readers.pairs import surplus
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_csmnc", "read_csmnc"]

_STEP = re.compile(r"EQUALLY SPACED INTERVALS? OF\s*:\s*(\d{0,3}\.?\d{1,9})\s*SEC", re.ASCII | re.IGNORECASE)
_COUNT = re.compile(r"NO\. OF POINTS\s*:\s*(\d{1,9})\b", re.ASCII | re.IGNORECASE)
_KIND = re.compile(r"\s*(UN|)CORRECTED\s+(\w+)\s+UNIT\s*:\s*(\S+)", re.IGNORECASE)
_PEAK_TIME = re.compile(r"\s*PEAK VALUE\s*:.{0,30}?\bAT\s+(\d{0,6}\.?\d{0,6})\s*SEC", re.ASCII | re.IGNORECASE)
_DURATION = re.compile(r".{0,80}?\bDURATION\s*:\s*(\d{0,6}\.?\d{0,6})\s*SEC", re.ASCII | re.IGNORECASE)
_PEAK = re.compile(r"\s*PEAK VALUE\s*:\s*([+-]?\d{1,9}\.?\d{0,9})\b", re.ASCII | re.IGNORECASE)
_STATION = re.compile(r"\s*STATION\s*:\s*(\w+)", re.ASCII | re.IGNORECASE)
_COMPONENT = re.compile(r"\s*COMP\.\s*:?\s*(.*)", re.IGNORECASE)
_POINT = re.compile(r"\s*OBSERVING POINT\s*:\s*(.*)", re.IGNORECASE)
_MAGNITUDE = re.compile(r"\s*MAGNITUDE\s*:?\s*(.*)", re.IGNORECASE)
_SIZE = re.compile(r"\s*MAGNITUDE\s*:?\s*(\d{1,2}(?:\.\d{0,3})?)\s*(?:\((\w{1,3})\))?", re.ASCII | re.IGNORECASE)
_EPICENTRE = re.compile(r"\s*EPICENT(?:ER|RE)\b(.*)", re.IGNORECASE)
_DEPTH = re.compile(r"\s*EPICENT(?:ER|RE)\b.{0,80}?DEPTH\s*(\d{1,3}(?:\.\d{0,3})?)\s*KM", re.ASCII | re.IGNORECASE)
_STATION_LINE = re.compile(r"\s*STATION\s*:(.*)", re.IGNORECASE)
_SITE = re.compile(r"\s*SITE CONDITION\s*:(.*)", re.IGNORECASE)
_ORIGIN = re.compile(
    r"\s*\d+\s+(\d{4})-(\d{1,2})-(\d{1,2})\s+(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d{0,6})?)\s*([A-Z]*)", re.ASCII
)
_NAMED = re.compile(r"(?:^|[._\-\d])(EW|NS|UD)(?=[._\-]|$)", re.IGNORECASE)
_ROW = re.compile(r"\s*[+-]?(?:\d|\.\d)", re.ASCII)
#: The header has 16 lines, copies may have a blank one more.
_LONGEST_HEADER = 30
_BEIJING_HOURS = 8.0
#: Durations are printed in whole seconds, which may be cut off rather than rounded [s].
_CUT_OFF = 0.5


def is_csmnc(head: bytes, name: str) -> bool:
    """Whether one of the first lines says ``EQUALLY SPACED INTERVALS OF:  0.005  SEC``."""
    return bool(_STEP.search(head[:2500].decode("latin-1")))


def read_csmnc(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the one channel of the file; raises NotAcceleration for velocity and displacement."""
    lines = [line.rstrip().rstrip("$") for line in text_lines(file.content)]
    head = lines[:_LONGEST_HEADER]
    kind_at, kind = _find(file.name, head, _KIND, "UNCORRECTED ACCELERATION  UNIT: CM/SEC/SEC")
    if kind[2].upper() != "ACCELERATION":
        raise NotAcceleration(
            f"{file.name}:{kind_at + 1}: expected acceleration, found {kind[2].lower()}; "
            "read the acceleration file of the same record"
        )
    unit = canonical_unit(kind[3], f"{file.name}:{kind_at + 1}")
    step_at, step = _find(file.name, head, _STEP, "EQUALLY SPACED INTERVALS OF:  0.005  SEC")
    count_at, stated = _find(file.name, head, _COUNT, "NO. OF POINTS:  12000")
    dt = float(step[1])
    count, above = int(stated[1]), max(kind_at, step_at, count_at) + 1
    first = next((i for i in range(above, min(len(lines), above + 10)) if _ROW.match(lines[i])), len(lines))
    samples, end = _samples(file.name, lines, first, count)
    peak = _first(head, _PEAK)
    header_peak, rounding = printed_number(peak) if peak else (float("nan"), 0.0)
    component, facing, notes = _direction(file, head)
    return [
        build_record(
            file,
            1,
            samples,
            dt,
            unit,
            format="csmnc",
            processed=not kind[1],
            component=component,
            facing=facing,
            structural=on_structure(_first(head, _POINT), stated=True),
            station=_first(head, _STATION),
            event=_event(head),
            facts=_facts(head),
            header_peak=header_peak * UNITS[unit],
            peak_rounding=rounding * UNITS[unit],
            warnings=[
                *notes,
                *held_length(_first(head, _DURATION), count, dt, _CUT_OFF),
                *held_peak_time(_first(head, _PEAK_TIME), dt * np.arange(count), samples),
                *surplus(lines, end, len(lines)),
            ],
        )
    ]


def _find(name: str, head: Sequence[str], pattern: re.Pattern[str], wanted: str) -> tuple[int, re.Match[str]]:
    """Index of the first line with the pattern, and the match."""
    for index, line in enumerate(head):
        match = pattern.search(line[:200])
        if match:
            return index, match
    raise RecordFormatError(
        f"{name}:{len(head)}: expected a line such as {wanted!r} in the header, found none; "
        "the header is damaged: download the file again"
    )


def _first(head: Sequence[str], pattern: re.Pattern[str]) -> str:
    """The first group of the first line that matches; empty where none does."""
    return next((match[1].strip() for line in head if (match := pattern.match(line[:200]))), "")


def _samples(name: str, lines: Sequence[str], first: int, count: int) -> tuple[np.ndarray, int]:
    """Samples in rows of equal length but for the last, which holds the rest, and the index of the line behind them."""
    per_row = len(lines[first].split()) if first < len(lines) else 1
    check_count(f"{name}:{len(lines)}", count, per_row * (len(lines) - first))
    full, rest = divmod(count, per_row)
    end = first + full
    samples = free_rows(lines[first:end], first + 1, per_row, name).ravel()
    if not rest:
        return samples, end
    last = free_rows(lines[end : end + 1], end + 1, rest, name)
    return np.concatenate([samples, last.ravel()]), end + 1


def _direction(file: SourceFile, head: Sequence[str]) -> tuple[str, Direction, list[str]]:
    """Component, direction and warnings from the header, or from the name of the file where the header has none."""
    word, named = _first(head, _COMPONENT), _NAMED.search(file.path.name)
    if not word:
        word = named[1].upper() if named else ""
        return word, direction(word), ["the component is that of the file name"] if word else []
    facing = direction(word)
    if named and contradictory(direction(named[1]), facing):
        note = f"the header says {word}, the file name {named[1].upper()}: the direction is unknown"
        return word, Direction(note=note), []
    return word, facing, []


def _event(head: Sequence[str]) -> str:
    """Name, time in UTC and magnitude of the earthquake."""
    parts = []
    for index, line in enumerate(head[:6]):
        match = _ORIGIN.match(line[:200])
        if match:
            moment = _origin(match)
            parts = [head[index + 1].strip(), f"{moment:%Y-%m-%d %H:%M:%S} UTC" if moment else ""]
            break
    magnitude = _first(head, _MAGNITUDE)
    return " ".join(part for part in [*parts, f"M {magnitude}" if magnitude else ""] if part)


def _facts(head: Sequence[str]) -> Facts:
    origin = next((match for line in head[:6] if (match := _ORIGIN.match(line[:200]))), None)
    magnitude = next((match for line in head if (match := _SIZE.match(line[:200]))), None)
    return stated(
        origin_time=_origin(origin) if origin else None,
        magnitude=(magnitude[1], magnitude[2] or "") if magnitude else (math.nan, ""),
        hypocentre=coordinates(_first(head, _EPICENTRE)),
        depth_km=_first(head, _DEPTH),
        station=coordinates(_first(head, _STATION_LINE)),
        site_class=_first(head, _SITE),
    )


def _origin(match: re.Match[str]) -> datetime | None:
    zone = 0.0 if match[7] in ("UTC", "GMT", "UT") else _BEIJING_HOURS
    day, clock = ([float(match[part]) for part in parts] for parts in ((1, 2, 3), (4, 5, 6)))
    return instant(day, clock, zone)


FORMATS = (
    Format(
        name="csmnc",
        what="CSMNC (China)",
        recognised="'EQUALLY SPACED INTERVALS OF:' in the header",
        unit="cm/s2, from the header",
        processed="by title",
        example="051WCW080512142801.EW.dat",
        detect=is_csmnc,
        parse=read_csmnc,
    ),
)
