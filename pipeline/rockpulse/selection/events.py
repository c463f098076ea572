"""Groups records by earthquake; records that may be of one earthquake are put into one group.

The groups are needed because records of one earthquake are not independent: statistics resample whole earthquakes.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from datetime import datetime, timedelta
from itertools import chain, combinations, pairwise

from rockpulse.config.configuration import Config, located
from rockpulse.errors import ConfigError, Failure, some, unread
from rockpulse.record.record import Record
from rockpulse.selection.tables import read_event_table

#: Records that start within this time of each other are assigned to one earthquake [s].
JOINED_WITHIN_S = 600.0
#: Largest difference between two stated origin times of one earthquake [s], and between two stated magnitudes of any
#: scale; if origin times differ by more than `JOINED_WITHIN_S`, the earthquakes are different, unless other records
#: connect them.
SAME_ORIGIN_S = 60.0
SAME_MAGNITUDE = 1.0
#: Largest error of a clock, which may show another time zone [s].
CLOCK_S = 86400.0
_GENERIC = (
    "EARTHQUAKE EQ EVENT MAINSHOCK MAIN SHOCK RECORD RCRD RECORDED OF THE UNKNOWN UNNAMED NONE NA NULL MAG MAGNITUDE "
    "MW ML MS MB MD MC MA ME JAN FEB MAR APR MAY JUN JUL AUG SEP OCT NOV DEC JANUARY FEBRUARY MARCH APRIL JUNE JULY "
    "AUGUST SEPTEMBER OCTOBER NOVEMBER DECEMBER MON TUE WED THU FRI SAT SUN GMT UTC UT PST PDT MST MDT CST CDT EST "
    "EDT HST AKST AKDT JST NZST NZDT AVOL CA"
)
#: Words of event titles that do not name an earthquake.
GENERIC = frozenset(_GENERIC.split())
#: Pattern of dates with the year at the end or the start: 10/15/1979, 01/16/95, 2010-02-27.
_DATE = re.compile(
    r"\b\d{1,2}[/.-]\d{1,2}[/.-](\d{4})\b|\b\d{1,2}[/-]\d{1,2}[/-](\d\d)\b|\b(\d{4})[/.-]\d{1,2}[/.-]\d{1,2}\b"
)
_YEAR = re.compile(r"\b((?:19|20)\d\d)\b")
#: Smallest two-digit year that is read as a year of the twentieth century.
_CENTURY = 30
#: Pattern of the number of an earthquake in its sequence, as in NGA: Imperial Valley-06.
_NUMBER = re.compile(r"[A-Za-z]-(\d\d)\b")


def pairs_of_one_event(records: Sequence[Record], free: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Yield pairs of indices from `free`; a chain of pairs connects all records of one earthquake."""
    by_file = _grouped(free, lambda index: records[index].source or None)
    for members in by_file + _grouped(free, lambda index: records[index].together or None):
        yield from pairwise(members)
    timed = [(moment, index) for index in free if (moment := moment_of(records[index])) is not None]
    yield from _near(records, timed, JOINED_WITHIN_S, _may_be_one)
    with_origin = [(origin, index) for index in free if (origin := records[index].origin_time) is not None]
    yield from _near(records, with_origin, SAME_ORIGIN_S, _alike)
    for members in _grouped(
        free, lambda index: (records[index].format, event) if (event := records[index].event_id) else None
    ):
        groups = _grouped(members, lambda index: (records[index].origin_time,))  # as for `_may_be_one`
        yield from chain.from_iterable(map(pairwise, groups))
        for one, other in combinations(_ends(groups), 2):
            if _may_be_one(records[one], records[other]):
                yield one, other
    for members in _grouped(free, lambda index: name_of(records[index].event) or None):
        yield from _of_one_name(records, members)


def _grouped(members: Iterable[int], key: Callable[[int], Hashable]) -> list[list[int]]:
    groups: dict[Hashable, list[int]] = defaultdict(list)
    for index in members:
        if (found := key(index)) is not None:
            groups[found].append(index)
    return list(groups.values())


def _near(
    records: Sequence[Record],
    timed: Iterable[tuple[datetime, int]],
    within: float,
    agree: Callable[[Record, Record], bool],
) -> Iterator[tuple[int, int]]:
    """Yield pairs of indices; a chain of pairs connects records at most `within` s apart for which `agree` is true."""
    # Records with equal origin time and magnitude agree with the same records: only the latest one is compared.
    last: dict[Hashable, tuple[datetime, int]] = {}
    for moment, index in sorted(timed):
        last = {key: one for key, one in last.items() if (moment - one[0]).total_seconds() <= within}
        for _, other in last.values():
            if agree(records[other], records[index]):
                yield other, index
        last[records[index].origin_time, repr(records[index].magnitude)] = (moment, index)


def _of_one_name(records: Sequence[Record], members: Iterable[int]) -> Iterator[tuple[int, int]]:
    """Yield pairs of indices; a chain of pairs connects records of one title that may be of one earthquake."""
    groups = _by_day(records, members)
    yield from chain.from_iterable(map(pairwise, groups))
    for one, other in _that_may_agree(records, _ends(groups)):
        if _agree(records[one], records[other]):
            yield one, other


def _ends(groups: Iterable[Sequence[int]]) -> list[int]:
    """Return the first and the last index of each group; comparing these is sufficient to compare the groups."""
    return [index for same in groups for index in dict.fromkeys((same[0], same[-1]))]


def _that_may_agree(records: Sequence[Record], ends: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Yield all pairs of the indices `ends` whose records may be of one earthquake, and some other pairs."""
    timed = sorted((moment, index) for index in ends if (moment := moment_of(records[index])) is not None)
    first = 0
    for place, (moment, index) in enumerate(timed):
        while (moment - timed[first][0]).total_seconds() > CLOCK_S:
            first += 1
        yield from ((other, index) for _, other in timed[first:place])
    marks = {index: (set(_NUMBER.findall(records[index].event)), _years(records[index])) for index in ends}
    of_number: dict[str, list[int]] = defaultdict(list)
    # Records by year (None if unknown): all records, and those without a number. If one of two records has no time,
    # they may be of one earthquake if they share a number and a year; an unknown number or year counts as shared.
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


def _by_day(records: Sequence[Record], members: Iterable[int]) -> list[list[int]]:
    """Group records with the same title and origin time that start within `CLOCK_S` of the first one in the group."""
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
    """Return the time that identifies the earthquake of a record: its start or, if unknown, the stated origin time."""
    return record.start_time or record.origin_time


def _may_be_one(one: Record, other: Record) -> bool:
    """Return whether the origin times of two records may be of one earthquake; True if one of them is not stated."""
    if one.origin_time is None or other.origin_time is None:
        return True
    return abs((one.origin_time - other.origin_time).total_seconds()) <= JOINED_WITHIN_S


def _alike(one: Record, other: Record) -> bool:
    """Return whether the magnitudes of two records may be of one earthquake; True if one of them is not stated."""
    return not abs(one.magnitude - other.magnitude) > SAME_MAGNITUDE


def _agree(one: Record, other: Record) -> bool:
    """Return whether two records with the same title may be of one earthquake, judged by time, number and year."""
    if not _may_be_one(one, other):
        return False
    first, second = moment_of(one), moment_of(other)
    if first is not None and second is not None:
        return abs((first - second).total_seconds()) <= CLOCK_S
    numbers = [set(_NUMBER.findall(record.event)) for record in (one, other)]
    years = [_years(record) for record in (one, other)]
    return all(not mine or not theirs or bool(mine & theirs) for mine, theirs in (numbers, years))


def _years(record: Record) -> set[int]:
    """Return the years in the event title of a record or, without any, the year of its time (two near New Year)."""
    found = ["".join(years) for years in _DATE.findall(record.event)] or _YEAR.findall(record.event)
    moment = moment_of(record)
    if not found and moment is not None:
        slack = timedelta(seconds=CLOCK_S)
        return {(moment - slack).year, (moment + slack).year}
    return {int(text) + (0 if len(text) == 4 else 1900 if int(text) >= _CENTURY else 2000) for text in found}


def words_of(title: str) -> frozenset[str]:
    """Return the words of a title that may name an earthquake, in capitals."""
    return frozenset(re.findall(r"[^\W\d_]{2,}", title.upper())) - GENERIC


def name_of(title: str) -> frozenset[str] | str:
    """Return the words of a title that may name an earthquake or, without any, a title with a digit, otherwise ""."""
    return words_of(title) or (title.strip() if any(character.isdigit() for character in title) else "")


#: Label of all records whose earthquake neither the files nor the user's table states.
UNKNOWN = "unknown: neither name nor time stated, counted as one"


def group_events(records: Sequence[Record], named: Mapping[str, str] | None = None) -> list[str]:
    """Return the earthquake of every record, as a label that records of one earthquake share.

    `named` contains the user's labels by record id, which replace the information in the files; ConfigError is raised
    if it contains an unknown id or an empty label. The label of any other group is its most frequent title, its
    earliest time or file if it has no title, or :data:`UNKNOWN`. Labels of groups with the same title end with their
    time (or file). Two records are put into one group if

    - they are from one file;
    - their files, of one format, state the same `event_id`;
    - their files state origin times within a minute of each other, and no magnitudes that differ by more than 1;
    - they start, or have their origin times, within :data:`JOINED_WITHIN_S` of each other;
    - their titles have the same words except dates, numbers and general words, unless their times are more than a day
    apart, or their titles name different years or different numbers in a sequence ("Imperial Valley-02", "-06").

    If the stated origin times are more than :data:`JOINED_WITHIN_S` apart, only records of one file are put together:
    shocks of one sequence share a name, and often occur within an hour. Different ids do not separate records, since
    agencies number one earthquake differently. If A and B, and B and C are put together, A and C are in the same group.
    Records that state neither a title nor a time count as one earthquake.
    """
    named = dict(named or {})
    ids = [record.id for record in records]
    if unknown := sorted(set(named) - set(ids)):
        raise ConfigError(
            f"[records] events: no record has the id {some(unknown, 5)}; expected ids of channels as they were "
            f"read, such as {some(ids, 3)}"
        )
    if empty := sorted(name for name, label in named.items() if not label.strip()):
        raise ConfigError(f"events: expected the name of an earthquake for {', '.join(empty[:5])}, found an empty text")
    free = [index for index, record in enumerate(records) if record.id not in named]
    parent = {index: index for index in free}

    def root(index: int) -> int:
        while parent[index] != index:
            parent[index] = parent[parent[index]]
            index = parent[index]
        return index

    for one, other in pairs_of_one_event(records, free):
        first, second = sorted((root(one), root(other)))
        parent[second] = first
    grouped: dict[int, list[Record]] = defaultdict(list)
    for index in free:
        grouped[root(index)].append(records[index])
    known = {top: of for top, of in grouped.items() if any(name_of(one.event) or moment_of(one) for one in of)}
    titles = dict.fromkeys(grouped, UNKNOWN) | _distinct(known)
    return [named[record.id] if record.id in named else titles[root(index)] for index, record in enumerate(records)]


def event_table(config: Config) -> dict[str, str]:
    """Return the earthquake of each record id in the table ``[records] events``; empty if no table is given."""
    given = config.records.events
    return {} if given is None else read_event_table(located(given, config.folder))


def events_by_id(
    records: Sequence[Record], named: Mapping[str, str], failures: Iterable[Failure] = ()
) -> tuple[dict[str, str], list[Failure]]:
    """Return the earthquake of each record id, and a failure for ids in `named` that may be in unread files."""
    ids = [record.id for record in records]
    failures = list(failures)
    failed = {row.place for row in failures if row.kind == "failed"}  # these have rows of their own
    unknown = sorted(set(named) - set(ids) - failed) if unread(failures) else []
    left = failed.difference(ids).union(unknown)
    labels = group_events(records, {name: label for name, label in named.items() if name not in left})
    found = dict(zip(ids, labels, strict=True))
    if not unknown:
        return found, []
    reason = (
        f"[records] events names records that were not read: {some(unknown, 5)}; examples of the "
        f"records that were read: {some(ids, 3)}: correct the names, unless they are records of the files that failed"
    )
    return found, [Failure("[records] events", "events", reason, "failed")]


def _distinct(groups: Mapping[int, Sequence[Record]]) -> dict[int, str]:
    """Return a distinct label for each group."""
    labels = {top: _title(members) or _time_or_file(members) for top, members in groups.items()}
    often = {label for label, count in Counter(labels.values()).items() if count > 1}
    taken: set[str] = set()
    for top in sorted(labels, key=lambda top: (_time_or_file(groups[top]), min(record.id for record in groups[top]))):
        label = labels[top]
        if label in often:
            label = f"{label} ({_time_or_file(groups[top])})"
        plain, number = label, 2
        while label in taken:
            label, number = f"{plain} ~{number}", number + 1
        taken.add(label)
        labels[top] = label
    return labels


def _title(members: Sequence[Record]) -> str:
    """Return the most frequent title, preferably with words; of equally frequent titles, the first alphabetically."""
    counts = Counter(record.event.strip() for record in members if name_of(record.event))
    return min(counts, key=lambda title: (not words_of(title), -counts[title], title), default="")


def _time_or_file(members: Sequence[Record]) -> str:
    starts = [record.start_time for record in members if record.start_time is not None]
    starts = starts or [record.origin_time for record in members if record.origin_time is not None]
    return f"{min(starts):%Y-%m-%d %H:%M}" if starts else min(record.source or record.id for record in members)
