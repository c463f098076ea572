"""CSMIP volume 1 files of the California Geological Survey (and the networks that write the same layout).

Each channel has 13 lines of text, 100 integers (16I5), 50 reals (8F10) and then, on newer files, a heading line that
names count, rate, unit and Fortran format of the accelerations. Older files have no heading: pairs of time [s] and
acceleration [g/10] with unequal steps follow. A line ``/&`` ends the channel; channels differ in length.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record, clock_fault
from rockpulse.readers.facing import direction, on_structure
from rockpulse.readers.fields import check_count, fixed_width, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import SourceFile
from rockpulse.readers.spacing import make_even
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record import STANDARD_GRAVITY, Record

__all__ = ["FORMAT", "is_csmip_v1", "read_csmip_v1"]

_TITLE = re.compile(r"\s?uncorrected accelerogram data\b", re.IGNORECASE)
_HEADER_LINES = 13 + 7 + 7
_HEADING = re.compile(r"\s*(\d+)\s+(?:accelerogram points|points of accel data)\b(.*)", re.IGNORECASE)
_RATE = re.compile(r"\bat\s+([\d.]+)\s*pts/sec", re.IGNORECASE)
_STEP = re.compile(r"\bspaced at\s+([\d.]+)\s*sec", re.IGNORECASE)
_UNIT = re.compile(r"units\s*(?:of|:)\s*([^\s)]+)", re.IGNORECASE)
_FORMAT = re.compile(r"\((\d+)f(\d+)\.\d+\)", re.IGNORECASE)
_PAIR_UNIT = re.compile(r"units of uncor (?:accel|data) (?:is|are)\s+(?:sec and\s+)?(\S+)", re.IGNORECASE)
_POINTS = re.compile(r"no\. of points\s*=\s*(\d+)", re.IGNORECASE)
_PEAK = re.compile(r"max\s*=\s*(-?\d*\.\d+)\s*g\b", re.IGNORECASE)
_CHANNEL = re.compile(
    r"\s*chan\s*(\d+)\s*:\s*(.*?)\s*(?:\(sta chn:[^)]*\)\s*)?(?:location:\s*(.*?)\s*)?$", re.IGNORECASE
)
_STATION = re.compile(r"\s*station (?:id|no)\.\s+(\w+)\s+\d+\.\d*\s*[NS]", re.IGNORECASE)
_SEED_CODES = re.compile(r"\s*\w+\.(\w\w)\.(\w+)\.([\w-]{2})\.\w")
_START = re.compile(
    r"(?:start|trigger) time:\s*(\d+)/\s*(\d+)/\s*(\d+),?\s+(\d+):\s*(\d+):\s*([\d.]+)\s+([A-Z]+)", re.IGNORECASE
)
_ZONES = {"UTC": 0, "GMT": 0, "PST": -8, "PDT": -7}
_PLACE_AFTER = re.compile(r"(\d{1,3}\s*deg|up|down)\b[\s,:-]+(.*)", re.IGNORECASE)
_PAIRS_PER_ROW = 5


def is_csmip_v1(head: bytes, name: str) -> bool:
    """Whether the first line is the title of an uncorrected volume."""
    return bool(_TITLE.match(head[:200].decode("latin-1")))


def read_csmip_v1(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel.

    Parameters
    ----------
    file : SourceFile
        The file.
    options : ReadOptions
        Not used: the format states everything.

    Raises
    ------
    RecordFormatError, UnitError
        With file and line, what was found and what was expected.
    """
    lines = text_lines(file.content)
    if lines[0].startswith(" ") and all(line.startswith(" ") for line in lines if line):
        # Carriage control of a line printer in front of every line.
        lines = [line[1:] for line in lines]
    records: list[Record] = []
    start = 0
    while start < len(lines):
        if not _TITLE.match(lines[start]):
            raise RecordFormatError(
                f"{file.name}:{start + 1}: expected 'Uncorrected Accelerogram Data' (channel {len(records) + 1}), "
                f"found {lines[start][:60].strip()!r}; the file is damaged: download it again"
            )
        ends = (i for i in range(start + 1, len(lines)) if lines[i].startswith("/&") or _TITLE.match(lines[i]))
        end = next(ends, len(lines))
        records.append(_channel(file, lines, start, end, len(records) + 1))
        start = end + 1 if end < len(lines) and lines[end].startswith("/&") else end
        while start < len(lines) and not lines[start].strip():
            start += 1
    return records


def _channel(file: SourceFile, lines: Sequence[str], start: int, end: int, number: int) -> Record:
    check_count(f"{file.name}:{end}", _HEADER_LINES, end - start, f"header lines of channel {number}")
    header = lines[start : start + 13]
    heading = lines[start + _HEADER_LINES] if start + _HEADER_LINES < end else ""
    read_block = _equal_steps if _HEADING.match(heading) else _pairs
    samples, step, unit, original_peak, warnings = read_block(file.name, lines, start, end)
    match = _CHANNEL.match(header[6])
    component, place = (match[2], match[3] or "") if match else (header[6].strip(), "")
    placed = _PLACE_AFTER.fullmatch(component)
    if placed:
        component, place = placed[1], place or placed[2]
    network, station, location = _codes(header)
    start_time, note = _start_time(header)
    peak = _PEAK.search(header[11])
    header_peak, rounding = printed_number(peak[1]) if peak else (float("nan"), 0.0)
    return build_record(
        file,
        number,
        samples,
        step,
        unit,
        format="csmip_v1",
        processed=False,
        component=f"{component} ({place})" if place else component,
        facing=direction(component),
        # Building files repeat a direction on every floor; there the number tells the channels apart.
        channel=match[1] if match and place else "",
        structural=on_structure(place, stated=True),
        network=network,
        station=station,
        location=location,
        station_name=re.split(r"\s{2,}", header[5].strip())[0],
        event=" ".join(re.split(r"\s{2,}\(", header[1].strip())[0].split()),
        start_time=start_time,
        header_peak=header_peak * STANDARD_GRAVITY,
        peak_rounding=rounding * STANDARD_GRAVITY,
        original_peak=original_peak,
        warnings=[*warnings, *note],
    )


def _surplus(lines: Sequence[str], first: int, used: int, end: int) -> list[str]:
    """A warning for rows between the declared samples and the end of the channel."""
    rows = sum(1 for line in lines[first + used : end] if line.strip())
    return [f"line {first + used + 1}: {rows} rows beyond the declared count were left out"] if rows else []


def _equal_steps(
    name: str, lines: Sequence[str], start: int, end: int
) -> tuple[np.ndarray, float, str, float, list[str]]:
    at = start + _HEADER_LINES
    where = f"{name}:{at + 1}"
    match = _HEADING.match(lines[at])
    assert match is not None
    count, rest = int(match[1]), match[2]
    rate, step, unit, layout = (pattern.search(rest) for pattern in (_RATE, _STEP, _UNIT, _FORMAT))
    try:
        dt = 1.0 / float(rate[1]) if rate else float(step[1]) if step else 0.0
    except (ValueError, ZeroDivisionError):
        dt = 0.0
    if not dt > 0.0:
        raise RecordFormatError(
            f"{where}: expected 'at N pts/sec' or 'equally spaced at N sec' with N > 0, found {lines[at].strip()!r}; "
            "repair the line or download the file again"
        )
    found = canonical_unit(unit[1] if unit else "", where)
    first = at + 1
    check_count(where, count, count if first < end else 0)
    per_row, width = (int(layout[1]), int(layout[2])) if layout else (8, _row_width(lines, first, end, min(8, count)))
    if per_row < 1 or width < 1:
        raise RecordFormatError(f"{where}: expected a format such as (8f9.6), found ({per_row}f{width})")
    samples = fixed_width(lines[first:end], first + 1, width, per_row, count, name)
    return samples, dt, found, float(np.max(np.abs(samples))), _surplus(lines, first, -(-count // per_row), end)


def _row_width(lines: Sequence[str], first: int, end: int, fields: int) -> int:
    """Field width from the length of the first row, for headings that name no format."""
    return len(lines[first].rstrip()) // fields if first < end and fields else 0


def _pairs(name: str, lines: Sequence[str], start: int, end: int) -> tuple[np.ndarray, float, str, float, list[str]]:
    points, unit = _POINTS.search(lines[start + 10]), _PAIR_UNIT.search(lines[start + 11])
    if not points:
        raise RecordFormatError(
            f"{name}:{start + 11}: expected 'No. of Points = N', found {lines[start + 10].strip()!r}; "
            "the header is damaged: download the file again"
        )
    found = canonical_unit(unit[1] if unit else lines[start + 11].strip(), f"{name}:{start + 12}")
    first, count = start + _HEADER_LINES, int(points[1])
    width = _row_width(lines, first, end, 2 * min(_PAIRS_PER_ROW, count)) or 7
    pairs = fixed_width(lines[first:end], first + 1, width, 2 * _PAIRS_PER_ROW, 2 * count, name).reshape(-1, 2)
    warnings = _surplus(lines, first, -(-count // _PAIRS_PER_ROW), end)
    peak = float(np.max(np.abs(pairs[:, 1])))
    gravity = UNITS[found] / STANDARD_GRAVITY
    samples, dt, notes = make_even(pairs[:, 0], pairs[:, 1], name, first + 1, _PAIRS_PER_ROW, gravity)
    return samples, dt, found, peak, warnings + notes


def _codes(header: Sequence[str]) -> tuple[str, str, str]:
    """Network, station and location codes."""
    seed = _SEED_CODES.match(header[3])
    if seed:
        return seed[1], seed[2], seed[3].replace("-", "")
    station = _STATION.match(header[4])
    return "", station[1] if station else "", ""


def _start_time(header: Sequence[str]) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample, or a warning that says why there is none."""
    match = _START.search(header[3])
    if not match:
        return None, []
    month, day, year, hour, minute = (int(text) for text in match.groups()[:5])
    zone = match[7].upper()
    if year < 100:
        year += 1900 if year >= 69 else 2000
    try:
        local = datetime(year, month, day, hour, minute, tzinfo=UTC) + timedelta(seconds=float(match[6]))
        moment = local - timedelta(hours=_ZONES[zone])
    except (ValueError, KeyError, OverflowError):
        return None, [f"the start time {match[0]!r} cannot be read"]
    # A clock that was never set begins at midnight of its own zone.
    fault = clock_fault(local)
    return (None, [fault]) if fault else (moment, [])


FORMAT = Format(
    name="csmip_v1",
    what="CSMIP volume 1, both layouts",
    recognised="first line 'Uncorrected Accelerogram Data'",
    unit="g or g/10, from the header",
    processed="no",
    example="CICLC.v1",
    detect=is_csmip_v1,
    parse=read_csmip_v1,
)
