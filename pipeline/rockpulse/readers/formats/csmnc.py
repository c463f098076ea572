"""Files of the China Strong Motion Network Centre (CSMNC), each with one component.

A file has 16 header lines, of which the last is blank, then 8 accelerations per row; some copies end every line with
``$``. The second line contains the time of the earthquake in Beijing (UTC+8); the time of the first sample is unknown.
"""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

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
#: Largest number of lines that are searched for the header (16 lines and blank lines), and for the origin time.
_LONGEST_HEADER, _ORIGIN_LINES = 30, 6
_BEIJING_HOURS = 8.0
_CUT_OFF = 0.5  # tolerance of durations [s], which are printed in whole seconds and may be truncated instead of rounded


def read_csmnc(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file; raise kit.NotAcceleration for velocity and displacement."""
    lines = [line.rstrip().rstrip("$") for line in kit.text_lines(file.content)]
    head = lines[:_LONGEST_HEADER]
    kind_at, kind = _find(file.name, head, _KIND, "UNCORRECTED ACCELERATION  UNIT: CM/SEC/SEC")
    if kind[2].upper() != "ACCELERATION":
        raise kit.no_acceleration(f"{file.name}:{kind_at + 1}", "acceleration", kind[2].lower())
    unit = kit.canonical_unit(kind[3], f"{file.name}:{kind_at + 1}")
    step_at, step = _find(file.name, head, _STEP, "EQUALLY SPACED INTERVALS OF:  0.005  SEC")
    count_at, declared = _find(file.name, head, _COUNT, "NO. OF POINTS:  12000")
    dt, count, above = float(step[1]), int(declared[1]), max(kind_at, step_at, count_at) + 1
    first = next((i for i in range(above, min(len(lines), above + 10)) if _ROW.match(lines[i])), len(lines))
    samples, end = _samples(file.name, lines, first, count)
    component, facing, notes = _direction(file, kit.first_match(_COMPONENT, head).strip())
    named_at, origin = _origin(head)
    event = [head[named_at].strip(), f"{origin:%Y-%m-%d %H:%M:%S} UTC" if origin else ""] if named_at else []
    magnitude = kit.first_match(_MAGNITUDE, head).strip()
    return [
        kit.build_record(
            file,
            samples,
            dt,
            unit,
            processed=not kind[1],
            component=component,
            facing=facing,
            structural=kit.on_structure(kit.first_match(_POINT, head).strip(), stated=True),
            station=kit.first_match(_STATION, head),
            event=" ".join(part for part in [*event, f"M {magnitude}" if magnitude else ""] if part),
            origin_time=origin,
            magnitude=(kit.first_match(_SIZE, head), kit.first_match(_SIZE, head, 2)),
            hypocentre=kit.coordinates(kit.first_match(_EPICENTRE, head)),
            depth_km=kit.first_match(_DEPTH, head),
            station_place=kit.coordinates(kit.first_match(_STATION_LINE, head)),
            site_class=kit.first_match(_SITE, head),
            header_peak=kit.printed_number(kit.first_match(_PEAK, head)),
            warnings=[
                *notes,
                *kit.held_length(kit.first_match(_DURATION, head), count, dt, _CUT_OFF),
                *kit.held_peak_time(kit.first_match(_PEAK_TIME, head), dt * np.arange(count), samples),
                *kit.surplus(lines, end, len(lines)),
            ],
        )
    ]


def _find(name: str, head: Sequence[str], pattern: re.Pattern[str], wanted: str) -> tuple[int, re.Match[str]]:
    """Return the index of the first header line that contains a pattern, and the match; raise an error if none does."""
    for index, line in enumerate(head):
        if match := pattern.search(line[: kit.LONGEST_LINE]):
            return index, match
    raise kit.unexpected(f"{name}:{len(head)}", f"a line such as {wanted!r} in the header", "none")


def _samples(name: str, lines: Sequence[str], first: int, count: int) -> tuple[np.ndarray, int]:
    """Return the samples, and the index of the line after them; only the last row may be shorter."""
    per_row = len(lines[first].split()) if first < len(lines) else 1
    kit.check_count(f"{name}:{len(lines)}", count, per_row * (len(lines) - first))
    end, rest = first + count // per_row, count % per_row
    samples = kit.free_rows(lines[first:end], first + 1, per_row, name).ravel()
    last = kit.free_rows(lines[end : end + 1], end + 1, rest, name) if rest else np.empty(0)
    return np.concatenate([samples, last.ravel()]), end + (rest > 0)


def _direction(file: kit.SourceFile, word: str) -> tuple[str, kit.Direction, list[str]]:
    """Return component, direction and warnings from the header or, if it names none, from the file name."""
    named = _NAMED.search(file.path.name)
    if not word:
        word = named[1].upper() if named else ""
        return word, kit.direction(word), ["the component is taken from the file name"] if word else []
    facing = kit.direction(word)
    if named and kit.contradictory(kit.direction(named[1]), facing):
        note = f"the header says {word}, but the file name says {named[1].upper()}: the direction is unknown"
        facing = kit.Direction(note=kit.doubted_direction(kit.direction(named[1]), facing, note))
    return word, facing, []


def _origin(head: Sequence[str]) -> tuple[int, datetime | None]:
    """Return the index of the line that names the earthquake, and the earthquake's UTC time; 0 and None if missing."""
    for index, line in enumerate(head[:_ORIGIN_LINES]):
        if match := _ORIGIN.match(line[: kit.LONGEST_LINE]):
            numbers = [float(text) for text in match.groups()[:6]]
            ahead = 0.0 if match[7] in ("UTC", "GMT", "UT") else _BEIJING_HOURS
            return index + 1, kit.instant(numbers[:3], numbers[3:], ahead)
    return 0, None


CSMNC = Format(
    name="csmnc",
    what="CSMNC (China)",
    recognised="'EQUALLY SPACED INTERVALS OF:' in the header",
    unit="cm/s2, from the header",
    processed="by title",
    example="051WCW080512142801.EW.dat",
    detect=begins_with(re.compile(rf"(?ai)[\s\S]*?{_STEP.pattern}"), 2500),
    parse=read_csmnc,
)
