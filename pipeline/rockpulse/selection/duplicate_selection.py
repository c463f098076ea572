"""Duplicate selection: chooses the record that is assessed among several of one motion.

Records are of one motion if they agree in station, time (half of the shorter) and direction (within 5 degrees); a pair
that is rotated contains every direction. The choice is among volumes, the channels that one instrument recorded
together.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter, itemgetter
from pathlib import PurePath

from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure, some, unread
from rockpulse.record.components import concurrent, find_pairs, instrument, place_on_structure, sensor_level, uncovered
from rockpulse.record.record import Record, id_matches
from rockpulse.warning_text import find

#: Largest difference, or difference from 180 degrees, of azimuths of one direction [degrees].
SAME_DIRECTION = 5.0


@dataclass(frozen=True, eq=False)
class Twin:
    """A duplicate: a record that is not used, as another one of its motion is."""

    voter: Record
    record: Record
    beside: tuple[Record, ...]  # the other channels of its volume


_PROCESSED = {True: "a processed volume", None: "one that may be processed", False: "a raw one"}


def without_duplicates(
    records: Sequence[Record],
    settings: RecordSettings | None = None,
    failures: Iterable[Failure] = (),
    advice: str = "[records] keep with this id assesses both",
) -> tuple[list[Record], list[Failure], list[Twin]]:
    """Return one record of each motion, in the given order, rows for the others, and twins to be compared.

    Preferred are, in this order, volumes at the surface; confirmed ones; those whose horizontal channels can all be
    used; with a pair or a vertical channel if these are requested; processed; with the higher sampling rate; longer;
    first by path. A dead channel, and one with an unconfirmed odd peak, is used only if there is no other. Records of
    ``[records] keep`` are assessed in addition to the chosen one. A row ends with `advice`.
    """
    settings = settings or RecordSettings()
    rows = unmatched_patterns("[records] keep", settings.keep, [record.id for record in records], failures)
    sites: dict[tuple[str, ...], list[Record]] = defaultdict(list)
    for record in records:
        site = _site(record, settings.structural)
        if site is not None:
            sites[site].append(record)
    rejected: dict[int, Failure] = {}
    twins: list[Twin] = []
    for members in sites.values():
        for at_once in _at_once(members):
            poll = _DuplicateSelection(at_once, settings, advice)
            rejected |= poll.rejected
            twins += poll.twins
    selected = [record for record in records if id(record) not in rejected]
    return selected, [*rows, *(rejected[id(record)] for record in records if id(record) in rejected)], twins


def unmatched_patterns(
    option: str, patterns: Sequence[str], ids: Sequence[str], failures: Iterable[Failure] = ()
) -> list[Failure]:
    """Return a row if patterns of an option match no id and files are unread; raise ConfigError if all were read."""
    idle = [pattern for pattern in patterns if not any(id_matches(name, [pattern]) for name in ids)]
    if not idle:
        return []
    reason = f"{option}: no record id matches {', '.join(idle)}; the ids are {some(ids, 3)}"
    if not unread(failures):
        raise ConfigError(f"{reason}; correct or remove the pattern")
    reason_text = f"{reason}; correct the pattern unless it is meant for one of the files that could not be read"
    return [Failure(option, "select", reason_text, "failed")]


def _site(record: Record, structural: bool) -> tuple[str, ...] | None:
    """Return network, station and, on a structure, location; None for a record that cannot be a duplicate."""
    if not record.station or record.start_time is None or record.orientation == "unknown":
        return None
    if record.orientation != "vertical" and not math.isfinite(record.azimuth):
        return None
    if record.orientation != "structural":
        return record.network, record.station
    place = place_on_structure(record)
    return (record.network, record.station, place) if structural and place else None


def _at_once(members: Sequence[Record]) -> Iterator[list[Record]]:
    """Group the records of a site into periods between which the station did not record."""
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


class _Volume:
    """The channels that one instrument recorded together, all in different directions."""

    def __init__(self, channels: list[Record], confirm: Sequence[str]) -> None:
        self.channels, self.confirm = channels, confirm  # patterns of the ids of channels whose peak is right
        self.horizontal = [one for one in channels if one.orientation != "vertical"]
        self.vertical = [one for one in channels if one.orientation == "vertical"]
        self.level, self.processed = sensor_level(channels[0]), channels[0].processed
        # Longest interval, to six digits: some headers state a rate, others an interval.
        self.dt = float(f"{max(one.dt for one in channels):.6g}")
        self.duration = max(one.duration for one in channels)

    @cached_property
    def pair(self) -> tuple[Record, ...]:
        """Return the two horizontal channels without a fault that can be rotated; empty if there are none."""
        pairs, _ = find_pairs([one for one in self.horizontal if not _fault(one, self.confirm)])
        return pairs[0].channels if len(pairs) == 1 else ()

    def rank(self, settings: RecordSettings) -> tuple[object, ...]:
        """Return the sort key of volumes, the preferred ones first."""
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
    """The duplicate selection among the records of a site at one time."""

    def __init__(self, records: Sequence[Record], settings: RecordSettings, advice: str) -> None:
        self.settings, self.advice = settings, advice
        self.rejected: dict[int, Failure] = {}
        self.twins: list[Twin] = []
        if len(records) == 1:
            return
        self.volumes = sorted(_volumes(records, settings.confirm), key=lambda volume: volume.rank(settings))
        self.voters: list[tuple[Record, _Volume]] = []
        for yields in (False, True):
            for volume in self.volumes:
                for record in volume.horizontal:
                    if bool(_fault(record, settings.confirm)) is yields:
                        self._ask(record, volume)
        # Vertical channels go with the horizontal ones of their volume; of the others one of each motion stays.
        stays = {id(volume): any(id(one) not in self.rejected for one in volume.horizontal) for volume in self.volumes}
        for following in (True, False):
            for volume in self.volumes:
                if stays[id(volume)] is following:
                    for record in volume.vertical:
                        self._ask(record, volume, following)

    def _ask(self, record: Record, volume: _Volume, following: bool = False) -> None:
        """Accept a record, or reject it as a duplicate of an accepted one; `following` records are always accepted."""
        rivals = [(one, other) for one, other in self.voters if self._same(record, one, other, volume)]
        if following or not rivals:
            self.voters.append((record, volume))
        elif not id_matches(record.id, self.settings.keep):
            nearest = next((rival for rival in rivals if _one_direction(record, rival[0])), rivals[0])
            self.rejected[id(record)] = self._row(record, volume, *nearest)
            voter, elected = nearest
            faults = [bool(_fault(one, self.settings.confirm)) for one in (record, voter)]
            alike = _one_direction(record, voter) and volume.level == elected.level and record.orientation != "vertical"
            if alike and faults[0] <= faults[1]:
                self.twins.append(Twin(voter, record, tuple(one for one in volume.channels if one is not record)))

    def _same(self, record: Record, voter: Record, elected: _Volume, volume: _Volume) -> bool:
        """Return whether a record and an accepted one, each in its volume, are of one motion."""
        if volume is elected or not concurrent(record, voter):
            return False
        if _one_direction(record, voter):
            return True
        whole = self.settings.components != "horizontal" and any(voter is one for one in elected.pair)
        return whole and record.orientation != "vertical" and all(concurrent(record, one) for one in elected.pair)

    def _row(self, record: Record, volume: _Volume, voter: Record, elected: _Volume) -> Failure:
        deeper = volume.level > elected.level
        how = "duplicate of" if _one_direction(record, voter) else "duplicate of the pair with"
        reason_text = f"{record.id}: {how} {voter.id} in {voter.source}, which is used instead: "
        reason_text += self._why(record, volume, voter, elected)
        if (bare := uncovered(voter, record)) > 0.5 * record.duration:
            reason_text += f"; {bare:.0f} s of the {record.duration:.0f} s of this record are not in it"
        reason_text += f"; {self.advice}" if self.advice else ""
        return Failure(record.source, "select", reason_text, "depth" if deeper else "duplicate")

    def _why(self, record: Record, volume: _Volume, voter: Record, elected: _Volume) -> str:
        """Return the rule by which one record is preferred to the other."""
        confirm = self.settings.confirm
        if (fault := _fault(record, confirm)) and not _fault(voter, confirm):
            return fault
        own, others = volume.rank(self.settings), elected.rank(self.settings)
        if record.orientation == "vertical" and own < others:
            return "the horizontal channels of its volume are assessed"
        place = next(place for place, pair in enumerate(zip(own, others, strict=True)) if pair[0] != pair[1])
        depth = "at the bottom of a borehole" if math.isinf(volume.level) else f"{volume.level:g} m below the ground"
        rules = (
            f"this one was recorded {depth}, the other {'at' if elected.level == 0.0 else 'nearer to'} the surface",
            "its volume is confirmed ([records] confirm), that of this one is not",
            "all horizontal channels of its volume can be used, but not all those of this one's volume",
            "its volume holds a pair of horizontal channels that can be used, that of this one does not",
            "its volume holds a vertical channel that can be used, that of this one does not",
            f"{_PROCESSED[elected.processed]} is preferred to {_PROCESSED[volume.processed]}",
            f"it has a sample every {elected.dt:g} s, this one every {volume.dt:g} s",
            f"it lasts {elected.duration:.6g} s, this one {volume.duration:.6g} s",
            "both are alike in processing, rate and length; the first by path is used",
        )
        return rules[place]


def _volumes(records: Sequence[Record], confirm: Sequence[str]) -> list[_Volume]:
    """Return the volumes of the records of a site; a second channel in the same direction begins a new volume."""
    channels = Counter(record.source for record in records)
    groups: dict[tuple[object, ...], list[list[Record]]] = defaultdict(list)
    for record in sorted(records, key=attrgetter("start_time", "source", "channel", "id")):
        # Members of an archive lie in folders of it.
        folder = str(PurePath(record.source.replace("!", "/")).parent)
        together = record.source if channels[record.source] > 1 else folder
        found = groups[*instrument(record), together]
        for volume in found:
            if all(concurrent(record, one) and not _one_direction(record, one) for one in volume):
                volume.append(record)
                break
        else:
            found.append([record])
    return [_Volume(volume, confirm) for found in groups.values() for volume in found]


def _one_direction(record: Record, other: Record) -> bool:
    """Return whether two channels of a site are both vertical, or have the same or opposite directions."""
    vertical = [one.orientation == "vertical" for one in (record, other)]
    if any(vertical):
        return all(vertical)
    return abs(math.remainder(record.azimuth - other.azimuth, 180.0)) <= SAME_DIRECTION


def _fault(record: Record, confirm: Sequence[str]) -> str:
    """Return why any other record of the same motion is preferred to a record; empty for most records."""
    if find(record.warnings, "dead_channel"):
        return "this channel is dead"
    odd = find(record.warnings, "odd_peak")
    if odd is None or id_matches(record.id, confirm):
        return ""
    return f"this one has a peak of {odd.values['peak']:.3g} g, which has not been confirmed"
