"""Replaces dates and times at the start of rows by seconds from the first of them."""

import re
from collections.abc import Sequence
from datetime import date, datetime

from rockpulse.readers.kit.facts import written

#: Pattern of 2024-01-31T12:00:00.125Z, 2024/01/31,12:00:00,125 or a time of day, quoted or not, and the delimiter.
_STAMP = re.compile(
    r"[\s\"']{0,20}(?:(?:(?P<year>\d{4})[-/.](?P<month>\d\d)[-/.](?P<day>\d\d)|"
    r"(?P<first>\d\d)[/.-](?P<middle>\d\d)[/.-](?P<last>\d{4}))(?:T|[ ,;\t]\s{0,3}))?"
    r"(?P<hour>\d{1,2}):(?P<minute>\d\d):(?P<second>\d\d)(?:[.,](?P<part>\d{1,9}))?"
    r"\s{0,2}(?P<zone>Z|UTC|GMT|[+-]\d\d:?\d\d)?[\"']?(?=[,;\s]|$)",
    re.ASCII,
)
_LOOK_AT, _FEWEST = 60, 3  # number of lines that are searched, and number of consecutive rows with a time
_NANO, _DIGITS = 10**9, 9


def first_stamp(lines: Sequence[str]) -> int | None:
    """Return the index of the first of several rows that begin with a time of day or a date and time."""
    run = 0
    for index, line in enumerate(lines[:_LOOK_AT]):
        run = run + 1 if _STAMP.match(line) else 0
        if run == _FEWEST:
            return index + 1 - _FEWEST
    return None


def without_stamps(lines: Sequence[str]) -> tuple[Sequence[str], datetime | None]:
    """Return the rows with seconds in place of dates and times, and the UTC time of the first row, if known."""
    first = first_stamp(lines)
    if first is None:
        return lines, None
    begin = _STAMP.match(lines[first])
    origin = _nanoseconds(begin) if begin else None
    if begin is None or origin is None:
        return lines, None
    found = list(lines)
    for index in range(first, len(lines)):
        match = _STAMP.match(lines[index])
        moment = _nanoseconds(match) if match else None
        if match and moment is not None:
            seconds, rest = divmod(abs(moment - origin), _NANO)
            sign = "-" if moment < origin else ""
            found[index] = f"{sign}{seconds}.{rest:0{_DIGITS}d}{lines[index][match.end() :]}"
    # Without a time zone, the UTC time is unknown.
    return found, written(begin[0].strip(" \"'")) if begin["zone"] and begin["year"] else None


def _nanoseconds(match: re.Match[str]) -> int | None:
    """Return a date and time as nanoseconds from the year 1 (a time of day from midnight); None if invalid."""
    try:
        day = date(int(match["year"]), int(match["month"]), int(match["day"])).toordinal() if match["year"] else 0
        if match["last"]:  # the day is assumed to come first
            day = date(int(match["last"]), int(match["middle"]), int(match["first"])).toordinal()
    except ValueError:
        return None
    clock = (day * 24 + int(match["hour"])) * 3600 + int(match["minute"]) * 60 + int(match["second"])
    return clock * _NANO + int((match["part"] or "0").ljust(_DIGITS, "0"))
