"""Duplicate selection: chooses the record to assess if several records contain the same ground motion.

Records contain the same ground motion if they agree in station, time (overlap of at least half the shorter record) and
direction (within 5 degrees); a pair that is rotated contains every direction. The choice is among recordings: a
recording is the set of channels that one instrument recorded together.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from operator import attrgetter, itemgetter
from pathlib import PurePath

from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure, some, unread
from rockpulse.record.components import concurrent, find_pairs, instrument, place_on_structure, sensor_level, uncovered
from rockpulse.record.record import Record, id_matches
from rockpulse.selection.twins import Comparison
from rockpulse.warning_text import find

#: Largest angle between two channels that are regarded as parallel [degrees].
SAME_DIRECTION = 5.0


_PROCESSED = {True: "a processed record", None: "one that may be processed", False: "a raw one"}


def without_duplicates(
    records: Sequence[Record],
    settings: RecordSettings | None = None,
    failures: Iterable[Failure] = (),
    advice: str = "[records] keep with this id assesses both",
) -> tuple[list[Record], list[Failure], dict[str, list[Comparison]]]:
    """Return one record of each ground motion, a failure for each duplicate, and comparisons of some accepted records.

    Recordings are compared by these criteria, in this order: a recording is preferred if it is at the surface; if the
    user has confirmed it; if all its horizontal channels are usable; if it has a pair or a vertical channel, if these
    are requested; if it is processed; if its sampling rate is higher; if it is longer; if its path comes first. A dead
    channel, or a channel with an unconfirmed doubtful peak, is used only if there is no other. Records of ``[records]
    keep`` are assessed in addition to the chosen record. The reason of each failure ends with `advice`. A duplicate is
    to be compared with the accepted record, by the id of which the comparisons are given, if both have one direction.
    """
    settings = settings or RecordSettings()
    rows = unmatched_patterns("[records] keep", settings.keep, [record.id for record in records], failures)
    sites: dict[tuple[str, ...], list[Record]] = defaultdict(list)
    for record in records:
        site = _site(record, settings.structural)
        if site is not None:
            sites[site].append(record)
    rejected: dict[int, Failure] = {}
    twins: dict[str, list[Comparison]] = defaultdict(list)
    for members in sites.values():
        for at_once in _at_once(members):
            selection = _DuplicateSelection(at_once, settings, advice)
            rejected |= selection.rejected
            for name, comparison in selection.twins:
                twins[name].append(comparison)
    selected = [record for record in records if id(record) not in rejected]
    return selected, [*rows, *(rejected[id(record)] for record in records if id(record) in rejected)], twins


def unmatched_patterns(
    option: str, patterns: Sequence[str], ids: Sequence[str], failures: Iterable[Failure] = ()
) -> list[Failure]:
    """Return a failure if a pattern matches no record id; if all files could be read, raise ConfigError instead."""
    idle = [pattern for pattern in patterns if not any(id_matches(name, [pattern]) for name in ids)]
    if not idle:
        return []
    reason = f"{option}: no record id matches {', '.join(idle)}; the ids are {some(ids, 3)}"
    if not unread(failures):
        raise ConfigError(f"{reason}; correct or remove the pattern")
    reason_text = f"{reason}; correct the pattern unless it is meant for one of the files that could not be read"
    return [Failure(option, "select", reason_text, "failed")]


def _site(record: Record, structural: bool) -> tuple[str, ...] | None:
    """Return network, station and, on a structure, location of a record; None if it is not compared with others."""
    if not record.station or record.start_time is None or record.orientation == "unknown":
        return None
    if record.orientation != "vertical" and not math.isfinite(record.azimuth):
        return None
    if record.orientation != "structural":
        return record.network, record.station
    place = place_on_structure(record)
    return (record.network, record.station, place) if structural and place else None


def _at_once(members: Sequence[Record]) -> Iterator[list[Record]]:
    """Yield groups of records of a site; a time without any record separates two groups."""
    stretch: list[Record] = []
    end = -math.inf
    timed = [(record.start_time.timestamp(), record) for record in members if record.start_time is not None]
    for start, record in sorted(timed, key=itemgetter(0)):
        if start >= end and stretch:
            yield stretch
            stretch = []
        stretch.append(record)
        end = max(end, start + record.duration)
    yield stretch


class _Recording:
    """The channels that one instrument recorded together, all in different directions."""

    def __init__(self, channels: list[Record], confirm: Sequence[str]) -> None:
        self.channels, self.confirm = channels, confirm  # confirm: patterns of ids with confirmed peaks
        self.horizontal = [one for one in channels if one.orientation != "vertical"]
        self.vertical = [one for one in channels if one.orientation == "vertical"]
        self.level, self.processed = sensor_level(channels[0]), channels[0].processed
        # Longest interval, to six digits: some headers state a rate, others an interval.
        self.dt = float(f"{max(one.dt for one in channels):.6g}")
        self.duration = max(one.duration for one in channels)

    @cached_property
    def pair(self) -> tuple[Record, ...]:
        """Return the two horizontal channels that can be rotated; empty if there is no such pair."""
        pairs, _ = find_pairs([one for one in self.horizontal if not _fault(one, self.confirm)])
        return pairs[0].channels if len(pairs) == 1 else ()

    def rank(self, settings: RecordSettings) -> tuple[object, ...]:
        """Return the key by which recordings are sorted; the preferred recording has the smallest key."""
        return (
            self.level,
            not any(id_matches(one.id, self.confirm) for one in self.horizontal),
            any(_fault(one, self.confirm) for one in self.horizontal),
            settings.components != "horizontal" and not self.pair,
            settings.include_vertical and all(_fault(one, self.confirm) for one in self.vertical),
            [True, None, False].index(self.processed),
            self.dt,
            -self.duration,
            min((one.source, one.id) for one in self.channels),
        )


class _DuplicateSelection:
    """The duplicate selection among records of one site that overlap in time."""

    def __init__(self, records: Sequence[Record], settings: RecordSettings, advice: str) -> None:
        self.settings, self.advice = settings, advice
        self.rejected: dict[int, Failure] = {}
        self.twins: list[tuple[str, Comparison]] = []  # id of an accepted record, and a rejected one of its direction
        if len(records) == 1:
            return
        self.recordings = sorted(_recordings(records, settings.confirm), key=lambda recording: recording.rank(settings))
        self.accepted: list[tuple[Record, _Recording]] = []
        for faulty in (False, True):
            for recording in self.recordings:
                for record in recording.horizontal:
                    if bool(_fault(record, settings.confirm)) is faulty:
                        self._decide(record, recording)
        # Accept vertical channels of recordings with accepted horizontal channels; of others accept one per motion.
        used = {id(one): any(id(each) not in self.rejected for each in one.horizontal) for one in self.recordings}
        for following in (True, False):
            for recording in self.recordings:
                if used[id(recording)] is following:
                    for record in recording.vertical:
                        self._decide(record, recording, following)

    def _decide(self, record: Record, recording: _Recording, following: bool = False) -> None:
        """Accept a record, or reject it as a duplicate of an accepted one; if `following` is true, always accept it."""
        rivals = [(one, other) for one, other in self.accepted if self._same(record, one, other, recording)]
        if following or not rivals:
            self.accepted.append((record, recording))
        elif not id_matches(record.id, self.settings.keep):
            nearest = next((rival for rival in rivals if _one_direction(record, rival[0])), rivals[0])
            self.rejected[id(record)] = self._row(record, recording, *nearest)
            accepted, of_accepted = nearest
            faults = [bool(_fault(one, self.settings.confirm)) for one in (record, accepted)]
            alike = _one_direction(record, accepted) and recording.level == of_accepted.level
            if alike and record.orientation != "vertical" and faults[0] <= faults[1]:
                beside = tuple(one for one in recording.channels if one is not record)
                self.twins.append((accepted.id, Comparison("duplicate", 0, record, beside)))

    def _same(self, record: Record, accepted: Record, of_accepted: _Recording, recording: _Recording) -> bool:
        """Return whether a record and an accepted record of another recording contain the same ground motion."""
        if recording is of_accepted or not concurrent(record, accepted):
            return False
        if _one_direction(record, accepted):
            return True
        whole = self.settings.components != "horizontal" and any(accepted is one for one in of_accepted.pair)
        return whole and record.orientation != "vertical" and all(concurrent(record, one) for one in of_accepted.pair)

    def _row(self, record: Record, recording: _Recording, accepted: Record, of_accepted: _Recording) -> Failure:
        deeper = recording.level > of_accepted.level
        how = "duplicate of" if _one_direction(record, accepted) else "duplicate of the pair with"
        reason_text = f"{record.id}: {how} {accepted.id} in {accepted.source}, which is used instead: "
        reason_text += self._why(record, recording, accepted, of_accepted)
        if (bare := uncovered(accepted, record)) > 0.5 * record.duration:
            reason_text += f"; {bare:.0f} s of the {record.duration:.0f} s of this record are not in that one"
        reason_text += f"; {self.advice}" if self.advice else ""
        return Failure(record.source, "select", reason_text, "depth" if deeper else "duplicate")

    def _why(self, record: Record, recording: _Recording, accepted: Record, of_accepted: _Recording) -> str:
        """Return the reason why the accepted record is preferred, as text."""
        confirm = self.settings.confirm
        if (fault := _fault(record, confirm)) and not _fault(accepted, confirm):
            return fault
        own, others = recording.rank(self.settings), of_accepted.rank(self.settings)
        if record.orientation == "vertical" and own < others:
            return "the horizontal channels of its recording are assessed"
        place = next(place for place, pair in enumerate(zip(own, others, strict=True)) if pair[0] != pair[1])
        depth = (
            "at the bottom of a borehole" if math.isinf(recording.level) else f"{recording.level:g} m below the ground"
        )
        rules = (
            f"this one was recorded {depth}, the other {'at' if of_accepted.level == 0.0 else 'nearer to'} the surface",
            "its recording is confirmed ([records] confirm), but the recording of this one is not",
            "all horizontal channels of its recording can be used, but not all those of this one's recording",
            "its recording has two horizontal channels that can be rotated, but the recording of this one does not",
            "its recording has a vertical channel that can be used, but the recording of this one does not",
            f"{_PROCESSED[of_accepted.processed]} is preferred to {_PROCESSED[recording.processed]}",
            f"it has a sample every {of_accepted.dt:g} s, this one every {recording.dt:g} s",
            f"it lasts {of_accepted.duration:.6g} s, this one {recording.duration:.6g} s",
            "both are alike in processing, rate and length; the first by path is used",
        )
        return rules[place]


def _recordings(records: Sequence[Record], confirm: Sequence[str]) -> list[_Recording]:
    """Group the records of a site into recordings; a second channel in the same direction begins a new recording."""
    channels = Counter(record.source for record in records)
    groups: dict[tuple[object, ...], list[list[Record]]] = defaultdict(list)
    for record in sorted(records, key=attrgetter("start_time", "source", "channel", "id")):
        # Treat members of an archive as files in a folder.
        folder = str(PurePath(record.source.replace("!", "/")).parent)
        together = record.source if channels[record.source] > 1 else folder
        found = groups[*instrument(record), together]
        for recording in found:
            if all(concurrent(record, one) and not _one_direction(record, one) for one in recording):
                recording.append(record)
                break
        else:
            found.append([record])
    return [_Recording(recording, confirm) for found in groups.values() for recording in found]


def _one_direction(record: Record, other: Record) -> bool:
    """Return whether two channels of a site are both vertical, or have the same or opposite directions."""
    vertical = [one.orientation == "vertical" for one in (record, other)]
    if any(vertical):
        return all(vertical)
    return abs(math.remainder(record.azimuth - other.azimuth, 180.0)) <= SAME_DIRECTION


def _fault(record: Record, confirm: Sequence[str]) -> str:
    """Return the fault of a record that makes a duplicate preferable to it; an empty text if it has no fault."""
    if find(record.warnings, "dead_channel"):
        return "this channel is dead"
    odd = find(record.warnings, "odd_peak")
    if odd is None or id_matches(record.id, confirm):
        return ""
    return f"this one has a peak of {odd.values['peak']:.3g} g, which has not been confirmed"
