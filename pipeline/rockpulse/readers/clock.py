"""Start times from the numbers of a header, held against the time of the earthquake where the header states it."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

__all__ = ["instant", "later", "near_event"]

#: A record starts at most this long before or after its earthquake; the waves cross the Earth in a third of it.
NEAR = timedelta(hours=1)


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
