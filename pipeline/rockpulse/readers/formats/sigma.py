"""SIGMA and ITACA ``.acc`` text files (Italy, France): one corrected component with a header of ``key : value`` lines.

The line ``Accelaration time series in m/s/s``, in the spelling of the files, ends the header; the samples follow, five
in a row in fields of 14 characters that may touch. The time in the header is that of the earthquake: when the record
starts is not known.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import written
from rockpulse.readers.facing import direction
from rockpulse.readers.facts import stated
from rockpulse.readers.fields import check_count, fixed_width, free_numbers, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.pairs import surplus
from rockpulse.readers.repeats import last_of_equal, repeated_marker
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_sigma", "read_sigma"]

#: Lines in which the header ends; a header has ten.
_HEADER_LIMIT = 40
_LONGEST_LINE = 400
_KEYS = (
    *("event date & time", "station code / name", "network", "orientation", "processing info"),
    *("filter cut-off frequency", "time increment", "number of data", "pga"),
)
#: A text with fewer of the keys is another one.
_FEWEST_KEYS = 4
_LINE = re.compile(r"\s*([A-Za-z][^:(]{0,40}?)\s*(?:\(([^()]{0,20})\)\s*)?:\s*(.*)")
_SERIES = re.compile(r"\s*(acc\w*|vel\w*|disp\w*)\s+time\s+(?:series|history)\s+in\s+(\S+)\s*", re.IGNORECASE)
_KINDS = {"a": "acceleration", "v": "velocity", "d": "displacement"}
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_DECIMAL = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,12}|\.\d{1,12})(?:[eEdD][+-]?\d{1,2})?", re.ASCII)
_CORNERS = re.compile(r"(\d{1,6}\.?\d{0,6})\s*-\s*(\d{1,6}\.?\d{0,6})", re.ASCII)
_WIDTH = 14
#: Rows that show how the fields are written.
_LOOK_AT = 50
#: The components that run from the first letter to the second, under their usual names.
_OTHER_WAY_ROUND = {"WE": "EW", "W-E": "EW", "SN": "NS", "S-N": "NS"}


@dataclass(frozen=True)
class _Value:
    """What the header says of one key."""

    text: str
    unit: str  # in brackets behind the key; empty where there is none
    line: int  # from 1


@dataclass(frozen=True)
class _Header:
    """The values by key, and the line that names the series."""

    name: str
    values: dict[str, _Value]
    at: int  # index of the line that names the series
    series: re.Match[str]
    warnings: tuple[str, ...]

    def text(self, key: str) -> str:
        """The value of a key; empty where it is blank or missing."""
        return self.values[key].text if key in self.values else ""

    def where(self, key: str) -> str:
        """``file:line`` of a key, or of the end of the header where it is missing."""
        return f"{self.name}:{self.values[key].line if key in self.values else self.at + 1}"


def is_sigma(head: bytes, name: str) -> bool:
    """Whether the first lines hold several of the keys of this format."""
    lines = [line[:_LONGEST_LINE] for line in text_lines(head[: _HEADER_LIMIT * _LONGEST_LINE])[:_HEADER_LIMIT]]
    keys = {match[1].lower() for line in lines if (match := _LINE.match(line))}
    return len(keys.intersection(_KEYS)) >= _FEWEST_KEYS and not keys.isdisjoint(_KEYS[-3:-1])


def read_sigma(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the one component of the file; raises NotAcceleration for velocity and displacement.

    The options are not used, because the format states everything.
    """
    lines = text_lines(file.content)
    header = _header(file.name, lines)
    kind = _KINDS[header.series[1][0].lower()]
    if kind != "acceleration":
        raise NotAcceleration(
            f"{file.name}:{header.at + 1}: expected 'Acceleration time series', found {kind}; "
            "read the acceleration file of the same record"
        )
    unit = canonical_unit(header.series[2], f"{file.name}:{header.at + 1}")
    step, count = _step(header), header.text("number of data")
    if not _COUNT.fullmatch(count):
        raise RecordFormatError(
            f"{header.where('number of data')}: expected 'Number of Data : n', found {count[:40]!r}; "
            "the header is damaged: download the file again"
        )
    samples, notes = _samples(file.name, lines, header.at + 1, int(count))
    peak, rounding = _peak(header)
    if np.isnan(peak) and header.text("pga"):
        line, found = header.values["pga"].line, header.text("pga")[:40]
        notes.append(f"line {line}: the peak is no number that can be: {found!r}")
    network, _, _ = header.text("network").partition("(")
    station, _, place = header.text("station code / name").partition("/")
    component = header.text("orientation")
    processed, processing = _processing(header)
    return [
        build_record(
            file,
            1,
            samples,
            step,
            unit,
            format="sigma",
            processed=processed,
            component=component,
            facing=direction(_OTHER_WAY_ROUND.get(component.upper(), component)),
            network=network.strip(),
            station=station.strip(),
            station_name=place.strip(),
            event=header.text("event date & time"),
            facts=stated(origin_time=written(header.text("event date & time"))),
            header_peak=peak,
            peak_rounding=rounding,
            warnings=[*header.warnings, *notes],
            processing=processing,
        )
    ]


def _header(name: str, lines: Sequence[str]) -> _Header:
    """The header; RecordFormatError where the line of the series is missing, or a key says two things."""
    values: dict[str, _Value] = {}
    for at, line in enumerate(lines[:_HEADER_LIMIT]):
        series = _SERIES.fullmatch(line[:_LONGEST_LINE])
        if series:
            last = last_of_equal(lines, at)
            return _Header(name, values, last, series, repeated_marker(at, last))
        match = _LINE.match(line[:_LONGEST_LINE])
        if not match:
            continue
        key, value = match[1].lower(), _Value(match[3].strip(), (match[2] or "").strip(), at + 1)
        before = values.setdefault(key, value)
        if key in _KEYS and (before.text, before.unit) != (value.text, value.unit):
            raise RecordFormatError(
                f"{name}:{at + 1}: expected one value of {match[1]!r}, found {value.text[:40]!r} and, in line "
                f"{before.line}, {before.text[:40]!r}; find out which is right and remove the other line"
            )
    end = min(len(lines), _HEADER_LIMIT)
    raise RecordFormatError(
        f"{name}:{end}: expected the line 'Acceleration time series in m/s/s' below the header, found none; "
        "the header is damaged: download the file again"
    )


def _step(header: _Header) -> float:
    """The sampling interval [s]."""
    said = header.values.get("time increment", _Value("", "s", 0))
    if not (_DECIMAL.fullmatch(said.text) and said.unit.lower() in ("", "s", "sec")):
        raise RecordFormatError(
            f"{header.where('time increment')}: expected 'Time Increment (s) : dt', found {said.text[:40]!r} "
            f"({said.unit or 'no unit'}); the header is damaged: download the file again"
        )
    return printed_number(said.text)[0]


def _samples(name: str, lines: Sequence[str], first: int, count: int) -> tuple[np.ndarray, list[str]]:
    """The declared number of samples, and warnings for what stands behind them.

    The fields are cut by their width where the rows have that of the format, else at blanks.
    """
    rows = [line.rstrip() for line in lines[first : first + _LOOK_AT]]
    check_count(f"{name}:{len(lines)}", count, count if rows else 0)
    lengths = Counter(map(len, rows))
    length = max(lengths, key=lengths.__getitem__)
    if length and length % _WIDTH == 0:
        per_row = length // _WIDTH
        samples = fixed_width(lines[first:], first + 1, _WIDTH, per_row, count, name)
        end = first + -(-count // per_row)
        spare = len(lines[end - 1].rstrip()) // _WIDTH - (count - (end - first - 1) * per_row)
    else:
        total, end = 0, first
        while end < len(lines) and total < count:
            total += len(lines[end].split())
            end += 1
        check_count(f"{name}:{len(lines)}", count, total)
        samples = free_numbers(lines[first:end], first + 1, name)[:count]
        spare = total - count
    notes = [f"line {end}: {spare} numbers beyond the declared count were left out"] if spare > 0 else []
    return samples, [*notes, *surplus(lines, end, len(lines), name, _SERIES)]


def _peak(header: _Header) -> tuple[float, float]:
    """The peak that the header states and half a unit of its last digit [m/s2]; NaN and 0 where it states none."""
    said = header.values.get("pga")
    if said is None or not _DECIMAL.fullmatch(said.text):
        return float("nan"), 0.0
    value, rounding = printed_number(said.text)
    factor = UNITS[canonical_unit(said.unit or header.series[2], header.where("pga"))]
    return value * factor, rounding * factor


def _processing(header: _Header) -> tuple[bool | None, list[str]]:
    """Whether the volume is a corrected one, and the words of the file for what was done."""
    words, said = header.text("processing info"), header.text("filter cut-off frequency")
    corners = _CORNERS.fullmatch(said)
    notes = [f"file: {' '.join(words.split())}"] if words else []
    if corners:
        notes.append(f"file: filtered, {float(corners[1]):g}-{float(corners[2]):g} Hz")
    elif said:
        notes.append(f"file: filter {said}")
    if corners or "filter" in words.lower():
        return True, notes
    return (False if words.lower() in ("none", "unprocessed", "raw") else None), notes


FORMATS = (
    Format(
        name="sigma",
        what="SIGMA/ITACA .acc",
        recognised="first lines 'Event Date & Time :', 'Time Increment (s) :', 'Number of Data :'",
        unit="m/s2, from the header",
        processed="by the header",
        example="16837_H2.cor.acc",
        detect=is_sigma,
        parse=read_sigma,
    ),
)
