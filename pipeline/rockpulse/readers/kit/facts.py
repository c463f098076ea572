"""Reads start times, and data on earthquake and site, from headers; impossible values are omitted without an error.

It also replaces dates and times at the start of rows by the seconds after the first row.
"""

import math
import re
from collections.abc import Iterable, Sequence
from datetime import UTC, date, datetime, timedelta
from typing import Any, TypedDict, Unpack

#: Longest time between the earthquake and the start of a record; waves cross the Earth in a third of this time.
NEAR = timedelta(hours=1)
# An earlier time than the first accelerogram (Long Beach, 11 March 1933 UTC) means a wrong clock.
_FIRST_YEAR = 1933
# Times at which clocks start that were never set (Unix, PC, GPS). Only the first hour is suspect: the Azores had a
# strong earthquake on 1 January 1980, 16:42 UTC.
_CLOCK_ORIGINS = tuple(datetime(*day, tzinfo=UTC) for day in ((1970, 1, 1), (1980, 1, 1), (1980, 1, 6)))
_CLOCK_RUN = timedelta(hours=1)
#: Time zones, with the hours by which each is ahead of UTC.
ZONES = {"UTC": 0.0, "GMT": 0.0, "UT": 0.0, "Z": 0.0, "PST": -8.0, "PDT": -7.0}
#: Pattern of letters after a time that mean an unknown clock: zones (JST, LT), AM and PM.
_OTHER_CLOCK = re.compile(r"(?!AT$)[A-Z]{1,3}T|[AP]M|LOC")
#: Pattern of 06/16/2005, 20:53:26.1 UTC or 2018/11/30 17:29:29 or 2009-04-06T01:32:39+01:00, with an optional zone.
_DATE = r"(?<!\d)(?:(\d{1,2})/\s?(\d{1,2})/\s?(\d{2}|\d{4})|(\d{4})([/-])\s?(\d{1,2})\5\s?(\d{1,2}))"
_TIME = r"(\d{1,2}):\s?(\d{1,2}):\s?(\d{1,2}(?:\.\d{0,6})?|\.\d{1,6})"
_ZONE = r"(?:\s{0,4}(Z|[A-Z]{2,4})\b|([+-]\d\d):?(\d\d)(?!\d))?"
_WRITTEN = re.compile(rf"{_DATE}(?:T|,?\s+){_TIME}{_ZONE}", re.ASCII | re.IGNORECASE)
_CENTURY = 30  # two-digit years from 30 on are in the 1900s: accelerographs exist since the 1930s


def clock_fault(moment: datetime) -> str:
    """Return the reason why a start time cannot be right; empty if it is plausible."""
    if moment.year < _FIRST_YEAR:
        return f"the start time {moment:%Y-%m-%d %H:%M:%S} is earlier than any accelerogram; it was left out"
    if any(origin <= moment < origin + _CLOCK_RUN for origin in _CLOCK_ORIGINS):
        return f"the start time {moment:%Y-%m-%d %H:%M:%S} is that of a clock that was never set; it was left out"
    return ""


def instant(day: Sequence[float], time: Sequence[float], zone_hours: float = 0.0) -> datetime | None:
    """Return the UTC time from date, time and the hours by which the zone is ahead of UTC; None if they are invalid."""
    hour, minute, second = time
    if not (0 <= hour < 24 and 0 <= minute < 60 and 0.0 <= second < 61.0):
        return None
    try:
        midnight = datetime(int(day[0]), int(day[1]), int(day[2]), tzinfo=UTC)
        return midnight + timedelta(hours=float(hour) - zone_hours, minutes=float(minute), seconds=float(second))
    except (ValueError, OverflowError):
        return None


def later(moment: datetime | None, seconds: float) -> datetime | None:
    """Return the time `seconds` after `moment`; None if `moment` is unknown or the result is out of range."""
    try:
        return None if moment is None else moment + timedelta(seconds=seconds)
    except OverflowError:
        return None


def near_event(start: datetime | None, origin: datetime | None) -> tuple[datetime | None, list[str]]:
    """Return the start time; if it is further than `NEAR` from the origin time, return None and a warning."""
    if start is None or origin is None or abs(start - origin) <= NEAR:
        return start, []
    away = f"{abs(start - origin) / timedelta(hours=1):.1f} h from the earthquake of {origin:%Y-%m-%d %H:%M:%S}"
    return None, [f"the start time {start:%Y-%m-%d %H:%M:%S} lies {away}; it was left out"]


def written(text: str) -> datetime | None:
    """Return the first date and time in a text as UTC (the default zone); None if missing or in an unknown zone."""
    found = _WRITTEN.search(text)
    if not found:
        return None
    letters = (found[11] or "").upper()
    if letters not in ZONES and _OTHER_CLOCK.fullmatch(letters):
        return None
    ahead = 0.0
    if found[12]:
        ahead = float(f"{found[12][0]}1") * (int(found[12][1:]) + int(found[13]) / 60.0)
    date = (found[4], found[6], found[7]) if found[4] else (found[3], found[1], found[2])
    year, month, day = map(int, date)
    if year < 100:
        year += 1900 if year >= _CENTURY else 2000
    clock = (int(found[8]), int(found[9]), float(found[10]))
    return instant((year, month, day), clock, ZONES.get(letters, ahead))


#: A number, or its text in the header.
Number = float | str
#: Latitude and longitude [degrees north, degrees east].
Place = tuple[Number, Number]
_NUMBER = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,15}|\.\d{1,15})(?:[eE][+-]?\d{1,3})?", re.ASCII)
#: Patterns of decimal degrees ("35.525N", "19.33 LAT. N") or degrees, minutes and seconds ("34 06 52N") with the
#: hemisphere.
_DECIMAL = re.compile(r"(?<![\d.])(\d{1,3}\.\d{0,9})\s*(?:LAT\.|LONG\.)?\s*([NSEW])(?![A-Z])", re.ASCII | re.IGNORECASE)
_SEXAGESIMAL = re.compile(r"(?ai)(?<![\d.])(\d{1,3})\s{1,3}(\d{1,2})\s{1,3}(\d{1,2}(?:\.\d{0,6})?)\s*([NSEW])(?![A-Z])")
_MAGNITUDE = re.compile(r"(?<![A-Za-z0-9.])(M[A-Za-z]?)\s{0,10}[=:]?\s{0,10}(\d{1,2}(?:\.\d{0,3})?)(?![\d.])", re.ASCII)
#: Magnitude scales by their letters, in the order of preference if a header states several.
_SCALES = {"mw": "Mw", "ms": "Ms", "ml": "ML", "mb": "mb"}
_NO_TEXT = re.compile(r"[-_.?/\s]*|n/?a|none|null|unknown", re.IGNORECASE)  # texts that mean "no value"
_MAGNITUDES = (-1.0, 10.0)
#: Depth of the deepest earthquakes, and half the circumference of the Earth [km].
_DEEPEST, _FARTHEST = 800.0, 20_040.0
_VS30 = (30.0, 5000.0)  # velocities of shear waves in mud and in the hardest rock [m/s]


class Facts(TypedDict, total=False):
    """Data on earthquake and station from a header; numbers may be given as text."""

    event_id: str
    origin_time: datetime | None
    magnitude: tuple[Number, str]  # with its scale
    hypocentre: Place
    depth_km: Number
    distance_km: Number
    station_place: Place
    vs30: Number  # [m/s]
    site_class: str


def stated(**facts: Unpack[Facts]) -> dict[str, Any]:
    """Return the fields of a `Record` from the statements of a header; impossible values are NaN, None or empty."""
    nowhere, time = (math.nan, math.nan), facts.get("origin_time")
    size, scale = facts.get("magnitude", (math.nan, ""))
    magnitude = _within(size, *_MAGNITUDES, zero=False)
    latitude, longitude = _place(facts.get("hypocentre", nowhere))
    station_latitude, station_longitude = _place(facts.get("station_place", nowhere))
    depth = _within(facts.get("depth_km", math.nan), 0.0, _DEEPEST, zero=not math.isnan(latitude))
    return {
        "event_id": _text(facts.get("event_id", "")),
        "origin_time": None if time is None or clock_fault(time) else time,
        "magnitude": magnitude,
        "magnitude_type": "" if math.isnan(magnitude) else _scale(scale),
        "hypocentre_latitude": latitude,
        "hypocentre_longitude": longitude,
        "hypocentre_depth": 1e3 * depth,
        "epicentral_distance": 1e3 * _within(facts.get("distance_km", math.nan), 0.0, _FARTHEST, zero=False),
        "station_latitude": station_latitude,
        "station_longitude": station_longitude,
        "vs30": _within(facts.get("vs30", math.nan), *_VS30),
        "site_class": _text(facts.get("site_class", "")),
    }


def coordinates(text: str) -> tuple[float, float]:
    """Return latitude and longitude from ``33.929N, 118.260W`` or ``42 30 00S 173 15 00E``; NaN if missing."""
    found = {"N": math.nan, "E": math.nan}
    named = [(float(degrees), side) for degrees, side in _DECIMAL.findall(text)]
    for *parts, side in _SEXAGESIMAL.findall(text):
        degrees, minutes, seconds = map(float, parts)
        named.append((round(degrees + minutes / 60.0 + seconds / 3600.0, 6), side))
    for value, side in reversed(named):  # the first of several values has priority
        axis = "N" if side.upper() in "NS" else "E"
        found[axis] = value if side.upper() == axis else -value
    return found["N"], found["E"]


def magnitudes(text: str) -> tuple[float, str]:
    """Return the preferred magnitude and its scale from a line such as ``ML=6.6, MW=6.7(CIT)``."""
    return preferred((value, scale) for scale, value in _MAGNITUDE.findall(text))


def preferred(named: Iterable[tuple[Number, str]]) -> tuple[float, str]:
    """Return the preferred magnitude and its scale: Mw, else Ms, ML, mb, else the first; NaN if there is none."""
    read = [(_within(value, *_MAGNITUDES, zero=False), _scale(scale)) for value, scale in named]
    found = [one for one in read if not math.isnan(one[0])]
    order = list(_SCALES.values())
    return min(found, key=lambda one: order.index(one[1]) if one[1] in order else len(order), default=(math.nan, ""))


def _scale(text: str) -> str:
    text = text.strip()
    return "" if text.upper() == "M" else _SCALES.get(text.lower(), text)


def _within(value: Number, low: float, high: float, zero: bool = True) -> float:
    """Return the value if it lies between `low` and `high`, else NaN; 0 is allowed only if `zero` is true."""
    if isinstance(value, str):
        value = float(value) if _NUMBER.fullmatch(value.strip()) else math.nan
    return float(value) if low <= value <= high and (zero or value != 0.0) else math.nan


def _place(place: Place) -> tuple[float, float]:
    latitude, longitude = _within(place[0], -90.0, 90.0), _within(place[1], -360.0, 360.0)
    if math.isnan(latitude + longitude) or latitude == longitude == 0.0:
        return math.nan, math.nan
    return latitude, longitude if abs(longitude) <= 180.0 else longitude - math.copysign(360.0, longitude)


def _text(text: str) -> str:
    words = " ".join(text.split())
    return "" if _NO_TEXT.fullmatch(words) else words


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
        if match and (moment := _nanoseconds(match)) is not None:
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
