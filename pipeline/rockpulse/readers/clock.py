"""Start times from the numbers of a header, held against the time of the earthquake where the header states it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

__all__ = ["clock_fault", "instant", "later", "near_event", "written"]

#: A record starts at most this long before or after its earthquake; the waves cross the Earth in a third of it.
NEAR = timedelta(hours=1)

# Earlier than the first accelerogram of a strong earthquake (Long Beach, 11 March 1933 UTC) only a clock is wrong.
_FIRST_YEAR = 1933
# Times from which clocks start that nobody set (Unix, PC, GPS). The first hour only: on 1 January 1980, 16:42 UTC, the
# Azores had a strong earthquake.
_CLOCK_ORIGINS = tuple(datetime(*day, tzinfo=UTC) for day in ((1970, 1, 1), (1980, 1, 1), (1980, 1, 6)))
_CLOCK_RUN = timedelta(hours=1)

#: Hours by which the clocks of a zone are ahead of UTC.
ZONES = {"UTC": 0.0, "GMT": 0.0, "UT": 0.0, "Z": 0.0, "PST": -8.0, "PDT": -7.0}
#: Letters behind a time that tell of another clock, which is not known: zones (JST, LT), halves of the day. Others, as
#: the scale of a magnitude, say nothing of the time.
_OTHER_CLOCK = re.compile(r"(?!AT$)[A-Z]{1,3}T|[AP]M|LOC")
#: 06/16/2005, 20:53:26.1 UTC or 2018/11/30 17:29:29 or 2009-04-06T01:32:39+01:00, and the zone, if it is given.
_DATE = r"(?<!\d)(?:(\d{1,2})/\s?(\d{1,2})/\s?(\d{2}|\d{4})|(\d{4})([/-])\s?(\d{1,2})\5\s?(\d{1,2}))"
_TIME = r"(\d{1,2}):\s?(\d{1,2}):\s?(\d{1,2}(?:\.\d{0,6})?|\.\d{1,6})"
_ZONE = r"(?:\s{0,4}(Z|[A-Z]{2,4})\b|([+-]\d\d):?(\d\d)(?!\d))?"
_WRITTEN = re.compile(rf"{_DATE}(?:T|,?\s+){_TIME}{_ZONE}", re.ASCII | re.IGNORECASE)
#: The century of a year of two digits: accelerographs came in the thirties.
_CENTURY = 30


def clock_fault(moment: datetime) -> str:
    """The reason why a start time [UTC, or the zone of the file] cannot be right; empty if it can."""
    if moment.year < _FIRST_YEAR:
        return f"the start time {moment:%Y-%m-%d %H:%M:%S} lies before the first accelerograms; it was left out"
    if any(origin <= moment < origin + _CLOCK_RUN for origin in _CLOCK_ORIGINS):
        return f"the start time {moment:%Y-%m-%d %H:%M:%S} is that of a clock that was never set; it was left out"
    return ""


def instant(day: Sequence[float], time: Sequence[float], zone_hours: float = 0.0) -> datetime | None:
    """UTC time from year, month, day and hour, minute, second; None where they are no date or no time of day.

    The second may have a fraction, and be a leap second; the clock of the header is `zone_hours` ahead of UTC.

    Examples
    --------
    >>> instant((2018, 2, 6), (23, 50, 29), zone_hours=8)
    datetime.datetime(2018, 2, 6, 15, 50, 29, tzinfo=datetime.timezone.utc)
    >>> instant((2018, 2, 30), (0, 0, 0)) is None
    True
    """
    hour, minute, second = time
    if not (0 <= hour < 24 and 0 <= minute < 60 and 0.0 <= second < 61.0):
        return None
    try:
        midnight = datetime(int(day[0]), int(day[1]), int(day[2]), tzinfo=UTC)
        return midnight + timedelta(hours=float(hour) - zone_hours, minutes=float(minute), seconds=float(second))
    except (ValueError, OverflowError):
        return None


def later(moment: datetime | None, seconds: float) -> datetime | None:
    """The time `seconds` after `moment`; None where the moment is unknown or the result beyond the calendar."""
    try:
        return None if moment is None else moment + timedelta(seconds=seconds)
    except OverflowError:
        return None


def near_event(start: datetime | None, origin: datetime | None) -> tuple[datetime | None, list[str]]:
    """The start time [UTC], or None and a warning where it is further than `NEAR` from the origin of the earthquake."""
    if start is None or origin is None or abs(start - origin) <= NEAR:
        return start, []
    return None, [
        f"the start time {start:%Y-%m-%d %H:%M:%S} lies {abs(start - origin) / timedelta(hours=1):.1f} h from the "
        f"earthquake of {origin:%Y-%m-%d %H:%M:%S}; it was left out"
    ]


def written(text: str) -> datetime | None:
    """UTC time from the first date and time in a text, year or month first.

    None where there is none, or where its zone is not known.

    Examples
    --------
    >>> written("(ORIGIN(CIT): 01/17/94, 12:30:55.4 GMT)")
    datetime.datetime(1994, 1, 17, 12, 30, 55, 400000, tzinfo=datetime.timezone.utc)
    >>> written("2009-04-06T01:32:39 ML 5.8")
    datetime.datetime(2009, 4, 6, 1, 32, 39, tzinfo=datetime.timezone.utc)
    >>> written("Origin: To be determined") is None
    True
    """
    found = _WRITTEN.search(text)
    if not found:
        return None
    letters = (found[11] or "").upper()
    if letters not in ZONES and _OTHER_CLOCK.fullmatch(letters):
        return None
    ahead = 0.0
    if found[12]:
        ahead = int(found[12][1:]) + int(found[13]) / 60.0
        ahead = -ahead if found[12].startswith("-") else ahead
    date = (found[4], found[6], found[7]) if found[4] else (found[3], found[1], found[2])
    year, month, day = map(int, date)
    if year < 100:
        year += 1900 if year >= _CENTURY else 2000
    clock = (int(found[8]), int(found[9]), float(found[10]))
    return instant((year, month, day), clock, ZONES.get(letters, ahead))
