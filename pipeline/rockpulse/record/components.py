"""Selects horizontal channels, finds pairs among them, and finds the vertical channel recorded with each channel."""

import os
import re
import sys
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from rocking.pictures import short_repr
from rockpulse.errors import Failure, Remedy, some, stored_remedies
from rockpulse.record.record import Record
from rockpulse.warning_text import WarningText

_REASONS = {
    "vertical": "vertical channel; it was read but not assessed: only horizontal channels are assessed",
    "structural": "channel on a structure; it was read but not assessed: only ground motion is assessed",
}
_TAKEN = " ([records] structural = true assesses it as well)"
_UPWARDS = (
    "channel on a structure, vertical or in an unknown direction; it was read but not assessed: only "
    "horizontal channels are assessed"
)
_INSTEAD = 'components = "horizontal" assesses it as it was recorded'
_PAIR = Remedy("pair")
_BOTH_IN_ONE = (
    f"{_PAIR.advice()}, or put both directions into one file with headings such as 'time [s],acc N [g],acc E [g]'"
)
#: Pattern of a SEED channel code: letters for the band, the kind of instrument and the direction. The channels of one
#: sensor differ only in the last letter.
_SEED = re.compile(r"([FGDCESHBMLV])([HLMGN])[ENZ123]")
#: Pattern of a KiK-net channel at the bottom of a borehole (1); channels at the surface end with 2.
_BOTTOM = re.compile(r"(?:EW|NS|UD)1")
#: Largest depth [m] of a sensor that is treated as a sensor at the surface, since it may be in a vault or a cellar.
SHALLOW = 3.0
#: Pattern of the location of a channel on a structure, which readers write in brackets after the direction.
_PLACE = re.compile(r"\((.*)\)")
#: Smallest overlap in time of the two channels of a pair, as a share of the duration of the shorter channel.
OVERLAP_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class Pair:
    """Two horizontal channels of one instrument with known azimuths.

    >>> [channel.azimuth for channel in rp.Pair(records[2], records[3]).channels]
    [0.0, 90.0]
    """

    __repr__ = short_repr

    first: Record
    second: Record

    @property
    def channels(self) -> tuple[Record, Record]:
        """Return the first and the second channel."""
        return self.first, self.second


class Neighbours:
    """An index of channels by file, time and earthquake, which quickly finds channels recorded together."""

    def __init__(self, records: Sequence[Record]) -> None:
        self._records = records
        starts = [(record.start_time, place) for place, record in enumerate(records)]
        self._timed = sorted((start.timestamp(), place) for start, place in starts if start is not None)
        self._longest = max((records[place].duration for _, place in self._timed), default=0.0)
        self._alike: dict[object, list[int]] = defaultdict(list)
        for place, record in enumerate(records):
            keys: set[object] = {record.source, record.together or record.source}
            for key in keys | ({_occasion(record)} if record.start_time is None else set()):
                self._alike[key].append(place)

    def of(self, record: Record) -> list[Record]:
        """Return the channels in the file of a record or near it in time (if unknown: with its event and folder)."""
        places = {*self._alike.get(record.together or record.source, ())}
        if record.start_time is None:
            places.update(self._alike.get(_occasion(record), ()))
        else:
            start = record.start_time.timestamp()
            # One sampling interval is added for rounded start times.
            first = bisect_left(self._timed, (start - self._longest - record.dt,))
            last = bisect_left(self._timed, (start + record.duration + record.dt,))
            places.update(place for _, place in self._timed[first:last])
        return [self._records[place] for place in sorted(places)]


def select_horizontal(
    records: Iterable[Record], structural: bool = False, configured: bool = True
) -> tuple[list[Record], list[Failure]]:
    """Return the horizontal channels on the ground, and a failure for each other channel.

    If `structural` is true, horizontal channels on structures are returned too. If `configured` is true, the failures
    of such channels name the option of the configuration with which they are returned.
    """
    horizontal, failures = [], []
    for record in records:
        kind = record.orientation
        if kind == "vertical" or (kind == "structural" and not (structural and np.isfinite(record.azimuth))):
            reason = _UPWARDS if kind == "structural" and structural else _REASONS[kind]
            reason += _TAKEN if kind == "structural" and configured and not structural else ""
            failures.append(Failure(record.source, "select", f"{record.id}: {reason}", kind))
        else:
            note = {"structural": "on_structure", "unknown": "orientation_unknown"}.get(kind)
            horizontal.append(record.with_warning(WarningText(note)) if note else record)
    return horizontal, failures


def find_pairs(horizontal: Sequence[Record]) -> tuple[list[Pair], list[Failure]]:
    """Return the pairs of channels that were recorded together in two known directions.

    Two channels are partners if they have the same format, state of processing, network, station, location and sensor
    (the first two letters of a SEED channel code, or the depth of a KiK-net channel), are both on the ground or at the
    same location on a structure, overlap in time by at least half of the shorter channel, and come

    - from one file, or from two files that the user states to be a pair, or
    - from files with station codes and start times, or
    - from files in one folder without start times, but with the same event, station name and sampling interval
      (PEER AT2, CSMNC).

    Partners in the same file have priority. Two channels are a pair only if neither has another partner.

    Parameters
    ----------
    horizontal : sequence of Record
        Horizontal channels.

    Returns
    -------
    pairs : list of Pair
        In the order of their first channels.
    failures : list of Failure
        A failure for each channel without a known azimuth, without a partner, or with several partners.

    Examples
    --------
    >>> pairs, failures = rp.find_pairs(rp.read("data/samples/records/CICLC.v1"))
    >>> [one.azimuth for one in pairs[0].channels], len(failures)  # the vertical channel has no azimuth
    ([90.0, 0.0], 1)
    """
    groups: dict[tuple[object, ...], list[Record]] = defaultdict(list)
    for record in horizontal:
        groups[instrument(record)].append(record)
    partners = {}
    for group in groups.values():
        neighbours = Neighbours([record for record in group if np.isfinite(record.azimuth)])
        for record in group:
            together = [one for one in neighbours.of(record) if one is not record]
            together = [one for one in together if _together(record, one) and concurrent(record, one)]
            partners[id(record)] = [one for one in together if one.source == record.source] or together
    pairs, failures = [], []
    taken: set[int] = set()
    of_file = Counter(record.source for record in horizontal)
    for record in horizontal:
        found = partners[id(record)] if np.isfinite(record.azimuth) else []
        mutual = [partners[id(one)] for one in found] == [[record]]
        if not mutual:
            reason = f"{record.id}: {_no_pair(record, found, partners)}; {_INSTEAD}"
            alone = record.format == "columns" and of_file[record.source] == 1
            failures.append(Failure(record.source, "pair", reason, "failed", stored_remedies([_PAIR] * alone)))
        elif id(record) not in taken:
            pairs.append(Pair(record, *found))
            taken |= {id(record), *map(id, found)}
    return pairs, failures


def matching_vertical(record: Record, verticals: Iterable[Record]) -> Record | None:
    """Return the vertical channel recorded together with a horizontal channel; None without such a channel.

    The rules are those of :func:`find_pairs`, but the two may differ in format and length. If several vertical channels
    are found, preference is given, in this order, to the same state of processing, the same SEED band, the same file
    and the longest overlap. None is returned for a channel on a structure, as a vertical channel may be on another
    floor.
    """
    if record.orientation == "structural":
        return None
    together = [one for one in verticals if _together(record, one) and _seed(record)[1] == _seed(one)[1]]

    def nearness(one: Record) -> tuple[bool, bool, bool, float]:
        band = _seed(record)[0] == _seed(one)[0]
        return one.processed == record.processed, band, one.source == record.source, _overlap(record, one)

    return max(together, key=nearness, default=None)


def align(vertical: Record, record: Record) -> np.ndarray:
    """Return the vertical acceleration (n,) [m/s2], positive up, at the sample times of a record.

    It is zero before the start and after the end of the vertical channel.
    """
    start = offset(record, vertical)
    return np.interp(record.time, vertical.time + start, vertical.acceleration, left=0.0, right=0.0)


def uncovered(vertical: Record, record: Record) -> float:
    """Return the length of the part of a record that its vertical channel does not cover [s]."""
    return record.duration - max(0.0, _overlap(record, vertical))


def offset(record: Record, other: Record) -> float:
    """Return the time [s] from the start of a record to the start of another record; 0 if a start time is unknown."""
    if record.start_time is None or other.start_time is None:
        return 0.0
    return (other.start_time - record.start_time).total_seconds()


def concurrent(record: Record, other: Record) -> bool:
    """Return whether two channels overlap in time by at least half of the shorter channel."""
    return _overlap(record, other) >= OVERLAP_SHARE * min(record.duration, other.duration)


def sensor_level(record: Record) -> float:
    """Return the depth of the sensor [m]; 0 if unknown or at most :data:`SHALLOW`, inf at the bottom of a borehole."""
    if np.isfinite(record.sensor_depth):
        return 0.0 if record.sensor_depth <= SHALLOW else record.sensor_depth
    return float("inf") if _BOTTOM.fullmatch(record.channel) else 0.0


def place_on_structure(record: Record) -> str:
    """Return the location of a channel on a structure, in capitals; empty if it is not stated."""
    place = _PLACE.search(record.component)
    return place[1].strip().upper() if place else ""


def instrument(record: Record) -> tuple[object, ...]:
    """Return the properties that the channels of one instrument have in common."""
    codes = (record.network, record.station, record.location, record.format, record.processed)
    place = record.together or ("" if record.station else record.station_name or record.source)
    on_structure = record.orientation == "structural"
    if on_structure:
        place = place_on_structure(record) or record.source
    return *codes, place, on_structure, _seed(record), sensor_level(record)


def _seed(record: Record) -> tuple[str, str]:
    """Return the letters for band and instrument of a SEED channel code; empty texts for other codes."""
    seed = _SEED.fullmatch(record.channel)
    return (seed[1], seed[2]) if seed else ("", "")


def _no_pair(record: Record, found: Sequence[Record], partners: dict[int, list[Record]]) -> str:
    if not np.isfinite(record.azimuth):
        how = f"; {_BOTH_IN_ONE}" if record.format == "columns" else ""
        return f"its azimuth is unknown, so that it cannot be rotated{how}"
    if not found:
        how = f"; files of columns state no station or time: {_BOTH_IN_ONE}" if record.format == "columns" else ""
        return f"no second horizontal channel with a known azimuth was recorded together with it{how}"
    if len(found) == 1:
        rivals = [other.id for one in found for other in partners[id(one)] if other is not record]
        others = f"but also with {some(rivals, 4)}: it is not clear which two are a pair"
        return f"{found[0].id} was recorded together with it, {others}"
    names = some([one.id for one in found], 4)
    return f"expected one other horizontal channel recorded together with it, found {len(found)}: {names}"


def _together(record: Record, other: Record) -> bool:
    if _overlap(record, other) <= 0.0 or (record.station, sensor_level(record)) != (other.station, sensor_level(other)):
        return False
    starts = [one.start_time is not None for one in (record, other)]
    if record.together or other.together:
        return record.together == other.together
    if (record.network, record.location) == (other.network, other.location) and (
        record.source == other.source or (record.station and all(starts))
    ):
        return True
    # Two files without times may be parts of one recording.
    named = bool(record.event and (record.station or record.station_name))
    return not any(starts) and named and _occasion(record) == _occasion(other)


def _occasion(record: Record) -> tuple[object, ...]:
    """Return the event, station, sampling interval and folder, by which channels without a start time are matched."""
    return record.event, record.station_name, record.dt, folder_of(record)


def folder_of(record: Record) -> str:
    """Return the folder of a record; all its files share one text in memory."""
    return sys.intern(os.path.dirname(os.path.normpath(record.source)))  # noqa: PTH120


def _overlap(record: Record, other: Record) -> float:
    start = offset(record, other)
    return min(record.duration, start + other.duration) - max(0.0, start)
