"""Files of the Turkish network before AFAD's own format (NSMN, ``kyhdata``).

Lines ``KEY : value`` in ISO-8859-9 (Turkish Latin), a line that names the columns N-S, E-W and U-D, then one row of
three accelerations [gal] for each sample. The values are those of the recorder with the mean taken off: the peaks that
the header calls raw are the peaks of the columns.
"""

from __future__ import annotations

import re
from datetime import datetime

from rockpulse.errors import RecordFormatError
from rockpulse.readers.channel import build_record
from rockpulse.readers.clock import instant, near_event
from rockpulse.readers.facts import Facts, coordinates, stated
from rockpulse.readers.fields import check_count, free_rows, printed_number, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.pairs import surplus
from rockpulse.readers.source import SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_nsmn", "read_nsmn"]

_TITLE = re.compile(rb"\s*STRONG GROUND MOTION RECORDS OF T", re.IGNORECASE)
_COLUMNS = re.compile(r"\s*([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s*$", re.IGNORECASE)
_KEY = re.compile(r"\s*([A-Z][A-Z ]{0,40}?)\s*(?:\(([^)]{0,20})\))?\s*:(.*)", re.IGNORECASE)
_PEAK = re.compile(r"\(([NSEWUD]-[NSEWUD])\)\s*(-?\d{1,6}(?:\.\d{0,9})?)", re.ASCII | re.IGNORECASE)
_DECIMAL = re.compile(r"\d{0,6}\.?\d{1,9}", re.ASCII)
_CLOCK = r"\s+(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d{0,9})?)\s*(?:\((\w+)\))?"
_DAY_FIRST = re.compile(r"(\d{1,2})[/.](\d{1,2})[/.](\d{4})" + _CLOCK, re.ASCII)
_YEAR_FIRST = re.compile(r"(\d{4})[/.](\d{1,2})[/.](\d{1,2})" + _CLOCK, re.ASCII)
#: Lines of the header, and characters of one; a damaged one may be longer.
_LONGEST_HEADER, _LONGEST_LINE = 60, 200


def is_nsmn(head: bytes, name: str) -> bool:
    """Whether the first line is ``STRONG GROUND MOTION RECORDS OF TURKIYE``."""
    return bool(_TITLE.match(head[:200]))


def read_nsmn(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the three channels; the options are not used, because the format states everything."""
    lines = text_lines(file.content)
    head = [line[:_LONGEST_LINE] for line in lines[:_LONGEST_HEADER]]
    found = next(((at, columns) for at, line in enumerate(head) if (columns := _COLUMNS.match(line))), None)
    if found is None:
        raise RecordFormatError(
            f"{file.name}:{min(len(lines), _LONGEST_HEADER)}: expected a line 'N-S  E-W  U-D' above the values, found "
            "none; the file is damaged or cut off: download it again"
        )
    at, columns = found
    first = at + 1
    entries: dict[str, tuple[str, str, int]] = {}
    for number, line in enumerate(head[:at], start=1):
        entry = _KEY.match(line)
        if entry:
            entries[entry[1].upper()] = (entry[3].strip(), entry[2] or "", number)
    count, step = (_number(file.name, entries, key, first) for key in ("NUMBER OF DATA", "SAMPLING INTERVAL"))
    check_count(f"{file.name}:{len(lines)}", int(count), len(lines) - first, "rows")
    end = first + int(count)
    table = free_rows(lines[first:end], first + 1, 3, file.name)
    peaks, unit_text, at = entries.get("RAW PGA VALUES", ("", "", first))
    unit = canonical_unit(unit_text, f"{file.name}:{at}")
    stated = {name.upper(): printed_number(value) for name, value in _PEAK.findall(peaks)}
    heads = [columns[number].upper() for number in (1, 2, 3)]
    unnamed = []
    if stated and sorted(stated) != sorted(heads):
        unnamed = [f"the header states the peaks of {', '.join(stated)}, the columns are {', '.join(heads)}"]
    (start_time, notes), facts = _start_time(entries), _facts(entries)
    records = []
    for number, samples in enumerate(table.T, start=1):
        component = columns[number].upper()
        peak, rounding = stated.get(component, (float("nan"), 0.0))
        records.append(
            build_record(
                file,
                number,
                samples,
                step,
                unit,
                format="nsmn",
                processed=False,
                component=component,
                channel=component.replace("-", ""),
                station=entries.get("STATION ID", ("",))[0],
                station_name=_turkish(entries.get("PLACE", ("",))[0]),
                event=_event(entries),
                start_time=start_time,
                facts=facts,
                header_peak=peak * UNITS[unit],
                peak_rounding=rounding * UNITS[unit],
                warnings=[*notes, *unnamed, *surplus(lines, end, len(lines))],
            )
        )
    return records


def _number(name: str, entries: dict[str, tuple[str, str, int]], key: str, first: int) -> float:
    value, _, at = entries.get(key, ("", "", first))
    if not _DECIMAL.fullmatch(value) or not float(value) > 0.0:
        raise RecordFormatError(
            f"{name}:{at}: expected '{key} : ' and a number above 0, found {value!r}; "
            "the header is damaged: download the file again"
        )
    return float(value)


def _turkish(text: str) -> str:
    """The text decoded anew as ISO-8859-9, which differs from Latin-1 in six letters."""
    try:
        return text.encode("latin-1").decode("iso8859-9")
    except UnicodeEncodeError:
        return text


def _event(entries: dict[str, tuple[str, str, int]]) -> str:
    date, magnitude = (entries.get(key, ("",))[0] for key in ("EARTHQUAKE DATE", "EARTHQUAKE MAGNITUDE"))
    return f"{date} M {magnitude}" if magnitude else date


def _facts(entries: dict[str, tuple[str, str, int]]) -> Facts:
    def entry(key: str) -> str:
        return entries.get(key, ("",))[0]

    magnitude, _, scale = entry("EARTHQUAKE MAGNITUDE").partition(" ")
    return stated(
        origin_time=_moment(entry("EARTHQUAKE DATE"))[0],
        magnitude=(magnitude, scale),
        hypocentre=coordinates(entry("EPICENTER COORDINATES")),
        depth_km=entry("EARTHQUAKE DEPTH"),
        station=coordinates(entry("STATION COORDINATES")),
    )


def _moment(text: str) -> tuple[datetime | None, str]:
    """UTC time and an empty text, or None and the name of the zone that is not UTC."""
    match = _YEAR_FIRST.match(text) or _DAY_FIRST.match(text)
    if not match:
        return None, ""
    if match[7] not in (None, "GMT", "UTC"):
        return None, match[7]
    day = [int(part) for part in match.groups()[:3]]
    clock = (int(match[4]), int(match[5]), float(match[6]))
    return instant(day if len(match[1]) == 4 else day[::-1], clock), ""


def _start_time(entries: dict[str, tuple[str, str, int]]) -> tuple[datetime | None, list[str]]:
    """UTC time of the first sample, and warnings about it."""
    text = entries.get("RECORD TIME", ("",))[0]
    if not text:
        return None, []
    start, zone = _moment(text)
    if start is None:
        reason = f"is in the unknown zone {zone!r}" if zone else "cannot be read"
        return None, [f"the start time {text!r} {reason}; it was left out"]
    return near_event(start, _moment(entries.get("EARTHQUAKE DATE", ("",))[0])[0])


FORMATS = (
    Format(
        name="nsmn",
        what="NSMN (Turkey, before AFAD)",
        recognised="first line 'STRONG GROUND MOTION RECORDS OF T...'",
        unit="gal, from the header",
        processed="no",
        example="20170720223109_0921.txt",
        detect=is_nsmn,
        parse=read_nsmn,
    ),
)
