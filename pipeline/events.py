"""Which records are of one earthquake: what is left out together, and resampled together, in every statistic.

.. note:: Channels of one earthquake are no independent observations. Agencies name events in their own words or not at
   all, and their clocks differ by minutes, so records are joined by name and by time; a table of the user's own decides
   where that is not right.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import datetime

from rockpulse.errors import ConfigError
from rockpulse.record import Record

__all__ = ["JOINED_WITHIN_S", "group_events"]

#: Records that start within this of one another are of one earthquake [s]; so are those of one name, unless their times
#: are known to lie further apart.
JOINED_WITHIN_S = 600.0

#: Words of event titles that name no earthquake.
# fmt: off
GENERIC = frozenset({
    "EARTHQUAKE", "EQ", "EVENT", "MAINSHOCK", "MAIN", "SHOCK", "RECORD", "RCRD", "RECORDED", "OF", "THE", "UNKNOWN",
    "UNNAMED", "NONE", "NA", "NULL", "JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV",
    "DEC", "JANUARY", "FEBRUARY", "MARCH", "APRIL", "JUNE", "JULY", "AUGUST", "SEPTEMBER", "OCTOBER", "NOVEMBER",
    "DECEMBER", "MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN", "GMT", "UTC", "UT", "PST", "PDT", "JST", "AVOL",
    "CA",
})
# fmt: on


def group_events(records: Sequence[Record], named: Mapping[str, str] | None = None) -> list[str]:
    """The earthquake of every record, as a label that records of one earthquake share.

    Parameters
    ----------
    records : sequence of Record
        As read; `event`, `start_time` and `source` are looked at.
    named : mapping of str to str, optional
        Label by record id, in place of what the files say. Records that are not in it are grouped among themselves.

    Returns
    -------
    list of str
        One label a record: the user's, else the first title or start time found in the group.

    Raises
    ------
    ConfigError
        Where `named` holds an id that no record has.

    Notes
    -----
    Two records are joined when they come from one file, start within :data:`JOINED_WITHIN_S` of each other, or have
    titles with the same words once dates, numbers and general words are taken out and no times that say otherwise.
    Joining is transitive.

    Examples
    --------
    >>> at = [Record([0.0, 1.0], dt=0.01, id=name, event=name) for name in ("KOBE 01/16/95 2046", "Kobe", "Maule 2010")]
    >>> group_events(at)
    ['KOBE 01/16/95 2046', 'KOBE 01/16/95 2046', 'Maule 2010']
    """
    named = dict(named or {})
    if unknown := sorted(set(named) - {record.id for record in records}):
        raise ConfigError(
            f"events: no record has the id {', '.join(unknown[:5])}; ids are those that `rockpulse assess` prints"
        )
    groups = list(range(len(records)))

    def root(index: int) -> int:
        while groups[index] != index:
            index = groups[index]
        return index

    free = [index for index, record in enumerate(records) if record.id not in named]
    for place, later in enumerate(free):
        for earlier in free[:place]:
            if _one_event(records[earlier], records[later]):
                first, second = sorted((root(earlier), root(later)))
                groups[second] = first
    titles: dict[int, str] = {}
    for index in free:
        title = records[index].event.strip() if _words(records[index].event) else ""
        titles[root(index)] = titles.get(root(index)) or title
    return [
        named[record.id] if record.id in named else titles[root(index)] or _time_or_source(records[root(index)])
        for index, record in enumerate(records)
    ]


def _one_event(one: Record, other: Record) -> bool:
    if one.source and one.source == other.source:
        return True
    if one.start_time is not None and other.start_time is not None:
        apart = abs((one.start_time - other.start_time).total_seconds())
        if apart <= JOINED_WITHIN_S:
            return True
        # A clock may be off by its time zone, never by more than a day.
        if apart > 86400.0:
            return False
    words = _words(one.event)
    if words or one.event.strip() != other.event.strip():
        return bool(words) and words == _words(other.event)
    return bool(one.event.strip()) and any(character.isdigit() for character in one.event)


def _words(title: str) -> frozenset[str]:
    return frozenset(re.findall(r"[^\W\d_]{2,}", title.upper())) - GENERIC


def _time_or_source(record: Record) -> str:
    if record.event.strip():
        return record.event.strip()
    start: datetime | None = record.start_time
    return start.strftime("%Y-%m-%d %H:%M") if start is not None else record.source or record.id
