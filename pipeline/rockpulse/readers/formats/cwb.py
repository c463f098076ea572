"""CWB and CWA free-field files of Taiwan.

Lines that begin with ``#``, then rows of the time [s] and the accelerations [gal] of three channels in 4F10.3; fields
may touch. Clocks are local time (GMT+08). The files are raw but for the offset.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import instant, later, near_event
from rockpulse.readers.csmip_layout import LONGEST_LINE
from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.facts import Facts, stated
from rockpulse.readers.fields import check_count, fixed_width, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import SourceFile
from rockpulse.readers.spacing import printed_at
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_cwb", "read_cwb"]

_UNIT_LINE = re.compile(rb"#[^\0]{0,2000}?[\r\n]#\s*AmplitudeUnit\s*:", re.IGNORECASE)
_ENTRY = re.compile(r"#\s*([^:(]+)(?:\(([^)]*)\))?\s*:(.*)")
_NUMBER = re.compile(r"\d{1,9}(?:\.\d{0,9})?", re.ASCII)
_FORMAT = re.compile(r"(\d{1,2})F(\d{1,2})\.\d{1,2}", re.ASCII | re.IGNORECASE)
_CHANNEL = re.compile(r"([UVZNE])\s*\(([+-])\)", re.IGNORECASE)
_PEAK = re.compile(r"(-?\d{1,9}\.?\d{0,9})\s*~\s*(-?\d{1,9}\.?\d{0,9})", re.ASCII)
_MOMENT = re.compile(
    r"(\d{4})/\s*(\d{1,2})/\s*(\d{1,2})-\s*(\d{1,2}):\s*(\d{1,2}):\s*(\d{1,2}(?:\.\d{0,9})?)", re.ASCII
)
_ZONE = re.compile(r"GMT\s*([+-]\s*\d{1,2})", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True)
class _Entry:
    """One line of the header."""

    value: str = ""  # text behind the colon
    aside: str = ""  # text in the parentheses of the key
    line: int = 1  # number of the line


def is_cwb(head: bytes, name: str) -> bool:
    """Whether the lines begin with ``#`` and one of them is ``#AmplitudeUnit:``."""
    return bool(_UNIT_LINE.match(head))


def read_cwb(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel; the options are not used, because the format states everything."""
    lines = text_lines(file.content)
    first = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")), len(lines))
    header = _header(lines[:first])
    unit_entry = header.get("amplitudeunit", _Entry())
    unit = canonical_unit(unit_entry.value.partition(".")[0], f"{file.name}:{unit_entry.line}")
    rate, _ = _positive(file.name, header, "samplerate", "a line '#SampleRate(Hz)' with a number of samples per s")
    length, rounding = _positive(file.name, header, "recordlength", "a line '#RecordLength(sec)' with a duration")
    sequence, layout = header.get("datasequence", _Entry(line=first)), header.get("data", _Entry(line=first))
    channels, fields = _CHANNEL.findall(sequence.value), _FORMAT.fullmatch(layout.value)
    if not sequence.value.lower().startswith("time") or not channels:
        raise RecordFormatError(
            f"{file.name}:{sequence.line}: expected '#DataSequence: Time U(+); N(+); E(+)', found {sequence.value!r}; "
            "the header is damaged: download the file again"
        )
    if not fields or int(fields[1]) != len(channels) + 1:
        raise RecordFormatError(
            f"{file.name}:{layout.line}: expected '#Data: {len(channels) + 1}F10.3' for the time and {len(channels)} "
            f"channels, found {layout.value!r}; the header is damaged: download the file again"
        )
    columns, rows = len(channels) + 1, len(lines) - first
    check_count(f"{file.name}:{len(lines)}", max(1, int((length - rounding) * rate)), rows, "rows")
    table = fixed_width(lines[first:], first + 1, int(fields[2]), columns, rows * columns, file.name)
    table = table.reshape(rows, columns)
    _check_times(file.name, first, table[:, 0], rate)
    (start_time, notes), facts = _start_time(header, float(table[0, 0])), _facts(header)
    if rows > (length + rounding) * rate + 1.0:
        notes.append(f"the header states {length:g} s at {rate:g} samples per s, the file has {rows} rows")
    records = []
    for number, (letter, sign) in enumerate(channels, start=1):
        peak, rounding = _peak(header, letter)
        records.append(
            build_record(
                file,
                number,
                table[:, number],
                1.0 / rate,
                unit,
                format="cwb",
                processed=False,
                component=f"{letter}({sign})",
                facing=_facing(letter, sign),
                channel=letter.upper(),
                station=header.get("stationcode", _Entry()).value,
                station_name=header.get("stationname", _Entry()).value,
                event=header.get("origintime", _Entry()).value,
                start_time=start_time,
                facts=facts,
                header_peak=peak * UNITS[unit],
                peak_rounding=rounding * UNITS[unit],
                warnings=notes,
            )
        )
    return records


def _header(lines: Sequence[str]) -> dict[str, _Entry]:
    """Entries by the letters of their keys, lower case, without the text in parentheses."""
    matches = ((line, _ENTRY.match(text[:LONGEST_LINE])) for line, text in enumerate(lines, start=1))
    return {
        re.sub(r"[\W_]", "", match[1]).lower(): _Entry(match[3].strip(), match[2] or "", line)
        for line, match in matches
        if match
    }


def _positive(name: str, header: dict[str, _Entry], key: str, what: str) -> tuple[float, float]:
    """A number above 0 that the header must state, and half a unit of its last digit."""
    entry = header.get(key, _Entry())
    if not _NUMBER.fullmatch(entry.value) or not float(entry.value) > 0.0:
        raise RecordFormatError(
            f"{name}:{entry.line}: expected {what} above 0, found {entry.value or 'none'!r}; "
            "the header is damaged: download the file again"
        )
    return printed_number(entry.value)


def _check_times(name: str, first: int, times: np.ndarray, rate: float) -> None:
    """The column of times must be that of samples at the stated rate."""
    with np.errstate(over="ignore"):
        if printed_at(times, 1.0 / rate):
            return
    expected = times[0] + np.arange(times.size) / rate
    row = int(np.argmax(np.abs(times - expected) > 0.1 / rate))
    raise RecordFormatError(
        f"{name}:{first + row + 1}: expected {expected[row]:g} s ({rate:g} samples per s, header), "
        f"found {times[row]:g} s; "
        "rows are missing or the rate is wrong: download the file again"
    )


def _start_time(header: dict[str, _Entry], first: float) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample, which stands at `first` seconds of the time column, and warnings about it."""
    entry = header.get("starttime", _Entry())
    if not entry.value:
        return None, []
    if not _ZONE.search(entry.aside):
        return None, [f"the start time {entry.value!r} names no time zone; it was left out"]
    start = _moment(entry)
    if start is None:
        return None, [f"the start time {entry.value!r} cannot be read"]
    start, notes = near_event(start, _moment(header.get("origintime", _Entry())))
    return later(start, first), notes


def _facts(header: dict[str, _Entry]) -> Facts:
    def entry(key: str) -> _Entry:
        return header.get(key, _Entry())

    return stated(
        origin_time=_moment(entry("origintime")),
        magnitude=(entry("magnitude").value, entry("magnitude").aside),
        hypocentre=(entry("epicenterlatitude").value, entry("epicenterlongitude").value),
        depth_km=entry("depth").value,
        station=(entry("stationlatitude").value, entry("stationlongitude").value),
    )


def _moment(entry: _Entry) -> datetime | None:
    """UTC time from 2018/02/06-23:50:29.000 and the zone beside the key; None from anything else."""
    moment, zone = _MOMENT.fullmatch(entry.value), _ZONE.search(entry.aside)
    if not moment or not zone:
        return None
    day, time = (int(moment[1]), int(moment[2]), int(moment[3])), (int(moment[4]), int(moment[5]), float(moment[6]))
    return instant(day, time, float(zone[1].replace(" ", "")))


def _peak(header: dict[str, _Entry], letter: str) -> tuple[float, float]:
    """Largest absolute value that the header states for a channel, and half a unit of its last digit [file unit]."""
    stated = _PEAK.fullmatch(header.get(f"amplitudemax{letter.lower()}", _Entry()).value)
    return max(printed_number(text.lstrip("-")) for text in stated.groups()) if stated else (math.nan, 0.0)


def _facing(letter: str, sign: str) -> Direction:
    """Direction of a channel by its letter, U, N, E and so on, in the opposite sense where `sign` is a minus."""
    facing = direction(letter)
    if sign == "+":
        return facing
    if facing.orientation == "vertical":
        return replace(facing, sign=-1.0)
    return replace(facing, azimuth=facing.azimuth + 180.0)  # of N or E


FORMATS = (
    Format(
        name="cwb",
        what="CWB or CWA free field (Taiwan)",
        recognised="lines that begin with '#', one of them '#AmplitudeUnit:'",
        unit="gal, from the header",
        processed="no",
        example="2-EGF.dat",
        detect=is_cwb,
        parse=read_cwb,
    ),
)
