"""Records of one earthquake, which are left out together, and resampled together, in every statistic.

.. note:: Channels of one earthquake are no independent observations. Agencies name events in their own words or not at
   all, and their clocks differ by minutes, so records are joined by the number and the time of the earthquake where
   the files state them, else by name and by time; a table of the user's own decides where that is not right. In doubt
   records are joined: fewer events mean wider intervals, never narrower ones. So records that state neither an
   earthquake nor a time count as one earthquake.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence

from rockpulse.config.configuration import Config, located
from rockpulse.errors import ConfigError, Failure, some, unread
from rockpulse.motions.event_pairs import JOINED_WITHIN_S, moment_of, name_of, pairs_of_one_event, words_of
from rockpulse.motions.tables import read_event_table
from rockpulse.record.record import Record

__all__ = [
    "JOINED_WITHIN_S",
    "UNKNOWN",
    "event_table",
    "events_by_id",
    "group_events",
]

#: Label of all records together of which neither the files nor the user's table tell the earthquake.
UNKNOWN = "unknown: neither name nor time stated, counted as one"


def group_events(records: Sequence[Record], named: Mapping[str, str] | None = None) -> list[str]:
    """The earthquake of every record, as a label that records of one earthquake share.

    `named` are labels by record id in place of what the files say. Records that are not in it are grouped among
    themselves; those whose group has the same label belong to it. A label is the user's, else the title that most of
    the group have, else its earliest start time, else :data:`UNKNOWN`. Of groups with the same title each has its time
    (or file) behind it.

    Raises
    ------
    ConfigError
        Where `named` holds an id that no record has, or an empty label.

    Notes
    -----
    Two records are joined when

    - they come from one file;
    - their files, of one format, state the same `event_id`;
    - their files state origin times within a minute of each other, and no magnitudes that differ by more than 1;
    - they start within :data:`JOINED_WITHIN_S` of each other; where the start of a record is not known, the origin time
      that its file states stands for it;
    - their titles have the same words once dates, numbers and general words are taken out, unless their times lie more
      than a day apart, their titles name other years, or other numbers in a sequence ("Imperial Valley-02", "-06").

    Only records of one file are joined where the stated origin times lie more than :data:`JOINED_WITHIN_S` apart:
    shocks of one sequence share a name, and often an hour. Different ids keep nothing apart, since agencies, and the
    versions of one catalogue, number one earthquake differently. Joining is transitive, and so two shocks may be joined
    after all: by a title that tells less, as "Imperial Valley" does, or by a record of their name that states no origin
    time. The table of events keeps them apart. Records that state neither a title nor a time, as plain columns do, may
    all be of one earthquake, and are counted so.

    Examples
    --------
    >>> at = [Record([0.0, 1.0], dt=0.01, id=name, event=name) for name in ("KOBE 01/16/95 2046", "Kobe", "Maule 2010")]
    >>> group_events(at)
    ['KOBE 01/16/95 2046', 'KOBE 01/16/95 2046', 'Maule 2010']
    """
    named = dict(named or {})
    ids = [record.id for record in records]
    if unknown := sorted(set(named) - set(ids)):
        raise ConfigError(
            f"[records] events: no record has the id {some(unknown, 5)}; expected ids of channels as they were "
            f"read, such as {some(ids, 3)}"
        )
    if empty := sorted(name for name, label in named.items() if not label.strip()):
        raise ConfigError(f"events: expected a label for {', '.join(empty[:5])}, got an empty one")
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
    groups: dict[int, list[int]] = defaultdict(list)
    for index in free:
        groups[root(index)].append(index)
    told = {top: [records[index] for index in members] for top, members in groups.items()}
    known = {
        top: members for top, members in told.items() if any(name_of(one.event) or moment_of(one) for one in members)
    }
    titles = dict.fromkeys(told, UNKNOWN) | _distinct(known)
    return [named[record.id] if record.id in named else titles[root(index)] for index, record in enumerate(records)]


def event_table(config: Config) -> dict[str, str]:
    """The user's own table of events, ``[records] events``: event by record id; empty where there is none.

    Raises ConfigError for a file that is not there, or no such table; OSError where it cannot be opened.
    """
    if config.records.events is None:
        return {}
    path = located(config.records.events, config.folder)
    if not path.exists():
        raise ConfigError(
            f"[records] events: {path}: no such file; expected a CSV table with the columns record, event"
        )
    return read_event_table(path)


def events_by_id(
    records: Sequence[Record], named: Mapping[str, str], failures: Iterable[Failure] = ()
) -> tuple[dict[str, str], list[Failure]]:
    """The earthquake that every record is counted to, the same in every verb: label by record id.

    With it comes a row where the table `named` names records that may be those of files that could not be read, by the
    failures of reading. Where every file was read, ConfigError as by :func:`group_events`.
    """
    ids = [record.id for record in records]
    unknown = sorted(set(named) - set(ids)) if unread(failures) else []
    labels = group_events(records, {name: label for name, label in named.items() if name not in unknown})
    reason = (
        f"[records] events names records that were not read: {some(unknown, 5)}; the records read are such as "
        f"{some(ids, 3)}: if these are no records of the files that failed, correct the names"
    )
    rows = [Failure("[records] events", "events", reason, "failed")] if unknown else []
    return dict(zip(ids, labels, strict=True)), rows


def _distinct(groups: Mapping[int, Sequence[Record]]) -> dict[int, str]:
    """A label for each group, no two the same."""
    labels = {top: _title(members) or _time_or_file(members) for top, members in groups.items()}
    often = {label for label, count in Counter(labels.values()).items() if count > 1}
    taken: set[str] = set()
    for top in sorted(labels, key=lambda top: _order(groups[top])):
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
    """The title that most records have, the first in the alphabet of several; titles with words come first."""
    counts = Counter(record.event.strip() for record in members if name_of(record.event))
    return min(counts, key=lambda title: (not words_of(title), -counts[title], title), default="")


def _time_or_file(members: Sequence[Record]) -> str:
    starts = [record.start_time for record in members if record.start_time is not None]
    starts = starts or [record.origin_time for record in members if record.origin_time is not None]
    return f"{min(starts):%Y-%m-%d %H:%M}" if starts else min(record.source or record.id for record in members)


def _order(members: Sequence[Record]) -> tuple[str, str]:
    return _time_or_file(members), min(record.id for record in members)
