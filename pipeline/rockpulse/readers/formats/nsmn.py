"""Files of the Turkish network before AFAD's own format (NSMN, ``kyhdata``).

A file has lines ``KEY : value`` in ISO-8859-9 (Turkish Latin), a line of column names, then rows of three accelerations
[gal], whose mean the agency has already removed; the header gives their peaks as ``RAW PGA VALUES``.
"""

import re
from contextlib import suppress
from datetime import datetime

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

_TITLE = re.compile(r"\s*STRONG GROUND MOTION RECORDS OF T", re.ASCII | re.IGNORECASE)
_COLUMNS = re.compile(r"\s*([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s*$", re.IGNORECASE)
_KEY = re.compile(r"\s*([A-Z][A-Z ]{0,40}?)\s*(?:\(([^)]{0,20})\))?\s*:(.*)", re.IGNORECASE)
_PEAK = re.compile(r"\(([NSEWUD]-[NSEWUD])\)\s*(-?\d{1,6}(?:\.\d{0,9})?)", re.ASCII | re.IGNORECASE)
_DECIMAL = re.compile(r"\d{0,6}\.?\d{1,9}", re.ASCII)
_CLOCK = r"\s+(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d{0,9})?)\s*(?:\((\w+)\))?"
_DAY_FIRST = re.compile(r"(\d{1,2})[/.](\d{1,2})[/.](\d{4})" + _CLOCK, re.ASCII)
_YEAR_FIRST = re.compile(r"(\d{4})[/.](\d{1,2})[/.](\d{1,2})" + _CLOCK, re.ASCII)
_LONGEST_HEADER = 60  # largest number of lines of the header


def read_nsmn(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the three channels; `options` is not used, because the file states unit and interval."""
    lines = kit.text_lines(file.content)
    head = [line[: kit.LONGEST_LINE] for line in lines[:_LONGEST_HEADER]]
    found = next(((at, columns) for at, line in enumerate(head) if (columns := _COLUMNS.match(line))), None)
    if found is None:
        where, expected = f"{file.name}:{min(len(lines), _LONGEST_HEADER)}", "a line 'N-S  E-W  U-D' above the values"
        raise kit.unexpected(where, expected, "none", "the file is damaged or cut off: download it again")
    first, components = found[0] + 1, [text.upper() for text in found[1].groups()]
    header = kit.Entries(file.name, first)
    for number, line in enumerate(head[: found[0]], start=1):
        if entry := _KEY.match(line):
            header[entry[1].upper()] = kit.Entry(entry[3].strip(), entry[2] or "", number)
    keys = ("NUMBER OF DATA", "SAMPLING INTERVAL")
    samples_stated, step = (float(header.positive(key, _DECIMAL, f"'{key} : ' and a number above 0")) for key in keys)
    count, end = int(samples_stated), first + int(samples_stated)
    kit.check_count(f"{file.name}:{len(lines)}", count, len(lines) - first, "rows")
    table = kit.free_rows(lines[first:end], first + 1, 3, file.name)
    unit = kit.canonical_unit(header["RAW PGA VALUES"].aside, header.where("RAW PGA VALUES"))
    peaks = {name.upper(): kit.printed_number(value) for name, value in _PEAK.findall(header.text("RAW PGA VALUES"))}
    (start_time, notes), date = _start_time(header), header.text("EARTHQUAKE DATE")
    if peaks and sorted(peaks) != sorted(components):
        notes.append(f"the header states the peaks of {', '.join(peaks)}, but the columns are {', '.join(components)}")
    place = header.text("PLACE")
    with suppress(UnicodeEncodeError):  # ISO-8859-9 differs from Latin-1 in six letters
        place = place.encode("latin-1").decode("iso8859-9")
    magnitude = header.text("EARTHQUAKE MAGNITUDE")
    size, _, scale = magnitude.partition(" ")
    return [
        kit.build_record(
            file,
            samples,
            step,
            unit,
            number=number,
            processed=False,
            component=component,
            channel=component.replace("-", ""),
            station=header.text("STATION ID"),
            station_name=place,
            event=f"{date} M {magnitude}" if magnitude else date,
            start_time=start_time,
            origin_time=_moment(date)[0],
            magnitude=(size, scale),
            hypocentre=kit.coordinates(header.text("EPICENTER COORDINATES")),
            depth_km=header.text("EARTHQUAKE DEPTH"),
            station_place=kit.coordinates(header.text("STATION COORDINATES")),
            header_peak=peaks.get(component, kit.printed_number("")),
            warnings=[*notes, *kit.surplus(lines, end, len(lines))],
        )
        for number, (samples, component) in enumerate(zip(table.T, components, strict=True), start=1)
    ]


def _moment(text: str) -> tuple[datetime | None, str]:
    """Return the UTC time and an empty text; for a time in another zone, None and the name of the zone."""
    match = _YEAR_FIRST.match(text) or _DAY_FIRST.match(text)
    if not match:
        return None, ""
    if match[7] not in (None, "GMT", "UTC"):
        return None, match[7]
    day = [int(part) for part in match.groups()[:3]]
    clock = (int(match[4]), int(match[5]), float(match[6]))
    return kit.instant(day if len(match[1]) == 4 else day[::-1], clock), ""


def _start_time(header: kit.Entries) -> tuple[datetime | None, list[str]]:
    text = header.text("RECORD TIME")
    if not text:
        return None, []
    start, zone = _moment(text)
    if start is None:
        reason = f"is in the unknown zone {zone!r}" if zone else "cannot be read"
        return None, [f"the start time {text!r} {reason}; it was left out"]
    return kit.near_event(start, _moment(header.text("EARTHQUAKE DATE"))[0])


NSMN = Format(
    name="nsmn",
    what="NSMN (Turkey, before AFAD)",
    recognised="first line 'STRONG GROUND MOTION RECORDS OF T...'",
    unit="gal, from the header",
    example="20170720223109_0921.txt",
    detect=begins_with(_TITLE),
    parse=read_nsmn,
)
