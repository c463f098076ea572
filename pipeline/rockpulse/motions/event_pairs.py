"""Which records may be of one earthquake: by their files, the times and numbers that these state, and their titles."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from datetime import datetime, timedelta
from itertools import chain, combinations, pairwise

from rockpulse.record.record import Record

#: Records that start within this of one another are of one earthquake [s]; so are those of one name, unless their times
#: are known to lie further apart.
JOINED_WITHIN_S = 600.0

#: Earthquakes whose stated origin times lie within this are one [s], if their stated magnitudes, of whatever scale, do
#: not differ by more than that; those further apart than `JOINED_WITHIN_S` are two, unless further records join them.
SAME_ORIGIN_S = 60.0
SAME_MAGNITUDE = 1.0

#: A clock may be off by its time zone, never by more than this [s].
CLOCK_S = 86400.0

_GENERIC = (
    "EARTHQUAKE EQ EVENT MAINSHOCK MAIN SHOCK RECORD RCRD RECORDED OF THE UNKNOWN UNNAMED NONE NA NULL MAG MAGNITUDE "
    "MW ML MS MB MD MC MA ME JAN FEB MAR APR MAY JUN JUL AUG SEP OCT NOV DEC JANUARY FEBRUARY MARCH APRIL JUNE JULY "
    "AUGUST SEPTEMBER OCTOBER NOVEMBER DECEMBER MON TUE WED THU FRI SAT SUN GMT UTC UT PST PDT MST MDT CST CDT EST "
    "EDT HST AKST AKDT JST NZST NZDT AVOL CA"
)

#: Words of event titles that name no earthquake.
GENERIC = frozenset(_GENERIC.split())

#: Dates with their year at the end or the start: 10/15/1979, 01/16/95, 2010-02-27.
_DATE = re.compile(
    r"\b\d{1,2}[/.-]\d{1,2}[/.-](\d{4})\b|\b\d{1,2}[/-]\d{1,2}[/-](\d\d)\b|\b(\d{4})[/.-]\d{1,2}[/.-]\d{1,2}\b"
)
_YEAR = re.compile(r"\b((?:19|20)\d\d)\b")

#: Two-digit years from this on are of the twentieth century.
_CENTURY = 30

#: The number of an earthquake in its sequence, as NGA writes it: Imperial Valley-06.
_NUMBER = re.compile(r"[A-Za-z]-(\d\d)\b")


def pairs_of_one_event(records: Sequence[Record], free: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Pairs of records of one earthquake, enough of them to connect each group."""
    by_file: dict[str, list[int]] = defaultdict(list)
    by_id: dict[Hashable, list[int]] = defaultdict(list)
    by_name: dict[Hashable, list[int]] = defaultdict(list)

    for index in free:
        record = records[index]
        if record.source:
            by_file[record.source].append(index)
        if record.event_id:
            by_id[record.format, record.event_id].append(index)
        if name := name_of(record.event):
            by_name[name].append(index)
    for members in by_file.values():
        yield from pairwise(members)
    timed = [(moment, index) for index in free if (moment := moment_of(records[index])) is not None]
    yield from _near(records, timed, JOINED_WITHIN_S, _may_be_one)
    told = [(origin, index) for index in free if (origin := records[index].origin_time) is not None]
    yield from _near(records, told, SAME_ORIGIN_S, _alike)
    for members in by_id.values():
        groups = _by_origin(records, members)
        yield from chain.from_iterable(map(pairwise, groups))
        for one, other in combinations(_ends(groups), 2):
            if _may_be_one(records[one], records[other]):
                yield one, other
    for members in by_name.values():
        yield from _of_one_name(records, members)


def _near(
    records: Sequence[Record],
    timed: Iterable[tuple[datetime, int]],
    within: float,
    agree: Callable[[Record, Record], bool],
) -> Iterator[tuple[int, int]]:
    """Pairs of records that agree, whose moments lie within so many seconds, enough of them to connect each group.

    Records that state the same origin and magnitude agree with the same others. So a record is held against the latest
    one of each origin and magnitude alone.
    """
    last: dict[Hashable, tuple[datetime, int]] = {}
    for moment, index in sorted(timed):
        last = {key: one for key, one in last.items() if (moment - one[0]).total_seconds() <= within}
        for _, other in last.values():
            if agree(records[other], records[index]):
                yield other, index
        last[records[index].origin_time, repr(records[index].magnitude)] = (moment, index)


def _of_one_name(records: Sequence[Record], members: Iterable[int]) -> Iterator[tuple[int, int]]:
    """Pairs of records of one name that agree, enough of them to connect each group."""
    groups = _by_day(records, members)
    yield from chain.from_iterable(map(pairwise, groups))
    for one, other in _that_may_agree(records, _ends(groups)):
        if _agree(records[one], records[other]):
            yield one, other


def _ends(groups: Iterable[Sequence[int]]) -> list[int]:
    """The first and the last record of each group, with which others agree if they do with any of the group."""
    return [index for same in groups for index in dict.fromkeys((same[0], same[-1]))]


def _that_may_agree(records: Sequence[Record], ends: Sequence[int]) -> Iterator[tuple[int, int]]:
    """All pairs of records of one name that `_agree` may join, and few others: a name may have thousands of shocks.

    Two that have times lie within `CLOCK_S`. Where one has none, numbers and years decide: those of both share one, or
    one has none.
    """
    timed = sorted((moment, index) for index in ends if (moment := moment_of(records[index])) is not None)
    first = 0
    for place, (moment, index) in enumerate(timed):
        while (moment - timed[first][0]).total_seconds() > CLOCK_S:
            first += 1
        yield from ((other, index) for _, other in timed[first:place])
    marks = {index: (_numbers(records[index]), _years(records[index])) for index in ends}
    of_number: dict[str, list[int]] = defaultdict(list)
    # By the year, None for none: of all records, and of those without a number.
    of_year: dict[bool, dict[int | None, list[int]]] = {False: defaultdict(list), True: defaultdict(list)}
    for index, (numbers, years) in marks.items():
        for number in numbers:
            of_number[number].append(index)
        for year in years or [None]:
            of_year[False][year].append(index)
            if not numbers:
                of_year[True][year].append(index)
    for index, (numbers, years) in marks.items():
        if moment_of(records[index]) is None:
            among = of_year[bool(numbers)]
            near = [of_number[number] for number in numbers]
            near += [among.get(year, []) for year in (*years, None)] if years else among.values()
            yield from ((other, index) for other in dict.fromkeys(chain.from_iterable(near)) if other != index)


def _by_origin(records: Sequence[Record], members: Iterable[int]) -> list[list[int]]:
    """The records in groups of one stated origin time, which is all that `_may_be_one` asks for."""
    groups: dict[datetime | None, list[int]] = defaultdict(list)
    for index in members:
        groups[records[index].origin_time].append(index)
    return list(groups.values())


def _by_day(records: Sequence[Record], members: Iterable[int]) -> list[list[int]]:
    """The records in groups of one title and stated origin time, in the order of their times, `CLOCK_S` long at most.

    So `_agree` holds between those of a group, and what it says of another record it says of the first or the last.
    """
    groups: dict[Hashable, list[tuple[datetime | None, int]]] = defaultdict(list)
    for index in members:
        record, moment = records[index], moment_of(records[index])
        groups[record.event.strip(), record.origin_time, moment is None].append((moment, index))
    runs: list[list[int]] = []
    for group in groups.values():
        first: datetime | None = None
        for place, (moment, index) in enumerate(sorted(group)):
            if not place or (first and moment and (moment - first).total_seconds() > CLOCK_S):
                first = moment
                runs.append([])
            runs[-1].append(index)
    return runs


def moment_of(record: Record) -> datetime | None:
    """The time that tells the earthquake of a record: its start, else the origin time that its file states."""
    return record.start_time or record.origin_time


def _may_be_one(one: Record, other: Record) -> bool:
    """Whether the origin times that two files state, if they do, may be those of one earthquake."""
    if one.origin_time is None or other.origin_time is None:
        return True
    return abs((one.origin_time - other.origin_time).total_seconds()) <= JOINED_WITHIN_S


def _alike(one: Record, other: Record) -> bool:
    """Whether the magnitudes that two files state, if they do, may be those of one earthquake."""
    return not abs(one.magnitude - other.magnitude) > SAME_MAGNITUDE


def _agree(one: Record, other: Record) -> bool:
    """Whether nothing says that two records with the same name are of different earthquakes."""
    if not _may_be_one(one, other):
        return False
    first, second = moment_of(one), moment_of(other)
    if first is not None and second is not None:
        return abs((first - second).total_seconds()) <= CLOCK_S
    numbers = [_numbers(record) for record in (one, other)]
    years = [_years(record) for record in (one, other)]
    return all(not mine or not theirs or bool(mine & theirs) for mine, theirs in (numbers, years))


def _numbers(record: Record) -> set[str]:
    """The numbers of a title in a sequence of shocks."""
    return set(_NUMBER.findall(record.event))


def _years(record: Record) -> set[int]:
    """The years that a title or, where it names none, the clock tells; near New Year a clock tells two."""
    found = ["".join(years) for years in _DATE.findall(record.event)] or _YEAR.findall(record.event)
    moment = moment_of(record)
    if not found and moment is not None:
        slack = timedelta(seconds=CLOCK_S)
        return {(moment - slack).year, (moment + slack).year}
    return {int(text) + (0 if len(text) == 4 else 1900 if int(text) >= _CENTURY else 2000) for text in found}


def names_earthquake(title: str) -> bool:
    """Whether a title has a word that names an earthquake, beside dates, numbers and general words.

    Examples
    --------
    >>> names_earthquake("KOBE 01/16/95 2046"), names_earthquake("Rcrd of Fri Jul 5, 2019 20:19:37.0 PDT")
    (True, False)
    """
    return bool(words_of(title))


def words_of(title: str) -> frozenset[str]:
    """The words of a title that may name an earthquake, in capitals."""
    return frozenset(re.findall(r"[^\W\d_]{2,}", title.upper())) - GENERIC


def name_of(title: str) -> frozenset[str] | str:
    """The words that titles of one earthquake have in common or, without any, the title if it holds a number."""
    return words_of(title) or (title.strip() if any(character.isdigit() for character in title) else "")
