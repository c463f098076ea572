"""Finds the half-waves of a record and their impulses; the acceleration is linear between samples."""

import heapq
import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from rocking.pictures import BLUE, GREY, RED, Picture, Shown, brief
from rockpulse.errors import ConfigError
from rockpulse.record.record import Record, largest, read_only

#: Names of the arrays of `HalfWaves`, which contain one value for each wave.
COLUMNS = ("impulse", "centroid", "start", "end", "peak", "lobes")
#: Number of samples whose lobes are computed at once, so that the arrays of a record of days are small.
AT_ONCE = 2**18
#: Smallest impulse of a merged wave, as a share of the sum of the absolute impulses of its lobes.
KEPT_SHARE = 0.5
#: Shares of the largest impulse above which an impulse in a picture is strong, and below which it is not drawn.
STRONG, VISIBLE = 0.5, 0.01


@dataclass(frozen=True, eq=False, repr=False)
class HalfWaves(Shown):
    """The half-waves of one record, in order of time.

    Attributes
    ----------
    impulse : (k,) ndarray
        Integral of the acceleration over the wave [m/s], positive for positive acceleration.
    centroid : (k,) ndarray
        Time of the centroid of the acceleration over the wave [s] from the first sample, inside [start, end].
    start, end : (k,) ndarray
        Zero crossings that bound the wave [s] from the first sample; an end of the record if it cuts the wave.
    peak : (k,) ndarray
        Largest acceleration with the sign of the impulse [m/s2].
    lobes : (k,) ndarray of int
        Number of lobes of one sign that were merged into the wave: 1 without merging, otherwise odd.
    dt : float
        Sampling interval of the record [s].
    record_id : str
        Identifier of the record.

    Examples
    --------
    >>> waves = rp.half_waves(record, threshold=0.2)
    >>> len(waves), round(waves.largest, 2), waves.centroid.round(2).tolist()
    (8, 1.19, [2.39, 2.77, 3.26, 3.75, 4.25, 4.74, 5.23, 5.61])
    """

    impulse: np.ndarray
    centroid: np.ndarray
    start: np.ndarray
    end: np.ndarray
    peak: np.ndarray
    lobes: np.ndarray
    dt: float
    record_id: str = ""

    def __post_init__(self) -> None:
        for name in COLUMNS:
            values = read_only(getattr(self, name), np.int64 if name == "lobes" else float)
            object.__setattr__(self, name, values)

    def __len__(self) -> int:
        return int(self.impulse.size)

    @property
    def largest(self) -> float:
        """Largest absolute impulse [m/s]; 0 if there are no waves."""
        return largest(self.impulse)

    def between(self, start: float, end: float) -> "HalfWaves":
        """Return the waves whose centroid is between two times [s] from the first sample, both included."""
        inside = (self.centroid >= start) & (self.centroid <= end)
        return replace(self, **{name: getattr(self, name)[inside] for name in COLUMNS})

    def _facts(self) -> dict[str, str]:
        facts = {"of": self.record_id} if self.record_id else {}
        facts["waves"] = str(len(self))
        if len(self):
            facts["largest impulse"] = brief(self.largest, "m/s")
            facts["from"] = f"{self.start[0]:.4g} to {self.end[-1]:.4g} s"
        return facts

    def _picture(self) -> Picture | None:
        """Draw the impulses at their centroids; impulses above half of the largest impulse have another colour."""
        if not len(self):
            return None
        reach = self.largest or 1.0
        first, last = float(self.start[0]), float(self.end[-1])
        picture = Picture((first, last), (-reach, reach))
        picture.line([first, last], [0.0, 0.0], GREY, 0.5)
        strong = np.abs(self.impulse) >= STRONG * reach
        weak = (np.abs(self.impulse) >= VISIBLE * reach) & ~strong
        picture.stems(self.centroid[weak], self.impulse[weak], BLUE)
        picture.stems(self.centroid[strong], self.impulse[strong], RED, 2.0)
        picture.words(f"{reach:.3g} m/s", first, reach, "start")
        picture.words(f"{last:.4g} s", last, -reach, "end")
        return picture


def half_waves(record: Record, threshold: float = 0.0, min_duration_s: float = 0.0, merge: bool = True) -> HalfWaves:
    """Return the half-waves of a record, with noise lobes merged into the half-wave that they interrupt.

    A lobe is a part of the record with one sign. It ends where the acceleration changes sign, or remains zero for a
    whole sampling interval. Parts at zero belong to no lobe; the partial lobes at both ends of the record are included.

    Parameters
    ----------
    record : Record
        Ground acceleration, (n,) [m/s2].
    threshold : float
        Lobes with a peak below this fraction of the PGA are noise [-], 0 to 1.
    min_duration_s : float
        Lobes shorter than this are noise [s].
    merge : bool
        Whether noise is merged; if False, every lobe is a wave, and the two limits above are ignored.

    Returns
    -------
    HalfWaves
        Empty for a record that is zero throughout.

    Raises
    ------
    ConfigError
        For a threshold outside [0, 1] or a negative duration.

    Notes
    -----
    A noise lobe is merged only with both its neighbours: the three become one wave with the neighbours' sign. It is not
    merged if the centroid would be outside the wave, if the impulse in the neighbours' direction would be less than
    half the sum of the absolute impulses of all its lobes, or if a neighbour is missing or has the same sign. The
    noise lobe with the smallest absolute impulse is merged first (the earlier of two equal ones); a merged wave that is
    still noise may be merged again. No lobe is dropped, so that the sum of all impulses does not change.

    Examples
    --------
    >>> waves = half_waves(Record([0.0, 3.0, -3.0, 0.0], dt=0.1, id="two triangles"))
    >>> waves.impulse.round(3).tolist(), waves.centroid.round(6).tolist()
    ([0.225, -0.225], [0.083333, 0.216667])
    """
    if not 0.0 <= threshold <= 1.0:
        raise ConfigError(f"half_waves: threshold: expected a fraction of the PGA from 0 to 1, got {threshold!r}")
    if not (math.isfinite(min_duration_s) and min_duration_s >= 0.0):
        raise ConfigError(f"half_waves: min_duration_s: expected a duration in s, zero or more, got {min_duration_s!r}")
    lobes = _lobes(record)
    if not merge or (threshold == 0.0 and min_duration_s == 0.0):
        return lobes
    return _merge(lobes, threshold * record.pga, min_duration_s)


def _lobes(record: Record) -> HalfWaves:
    """Return every lobe of a record as a half-wave; the record is processed in parts to save memory."""
    acceleration = record.acceleration
    positive, negative = acceleration > 0.0, acceleration < 0.0
    crossing = np.flatnonzero((positive[:-1] & negative[1:]) | (negative[:-1] & positive[1:]))
    del positive, negative
    places = np.unique(np.searchsorted(crossing, np.arange(AT_ONCE, acceleration.size, AT_ONCE)))
    places = places[places < crossing.size]
    columns: list[list[np.ndarray]] = [[] for _ in COLUMNS]
    for first, last in pairwise([None, *places.tolist(), None]):
        found = _lobes_between(record, crossing, first, last)
        for column, values in zip(columns, found, strict=True):
            column.append(values)
    joined: dict[str, Any] = {}
    for name, column in zip(COLUMNS, columns, strict=True):
        joined[name] = np.concatenate(column)
        joined[name].setflags(write=False)  # HalfWaves makes no copy of such an array
        column.clear()
    return HalfWaves(**joined, dt=record.dt, record_id=record.id)


def _lobes_between(record: Record, crossing: np.ndarray, first: int | None, last: int | None) -> tuple[np.ndarray, ...]:
    """Return the arrays `COLUMNS` of the lobes from zero crossing `first` to `last` (None: an end of the record)."""
    dt, begin = record.dt, 0 if first is None else int(crossing[first])
    acceleration = record.acceleration[begin : None if last is None else crossing[last] + 2]
    crossing = crossing[first : None if last is None else last + 1] - begin
    before, after = acceleration[crossing], acceleration[crossing + 1]
    # Both parts of an interval are computed from the samples, as 1 - fraction loses digits of a short second part.
    fraction, rest = before / (before - after), after / (after - before)

    # Points are the samples and the crossings between them; pieces connect two points; lengths are in units of dt.
    value = np.insert(acceleration, crossing + 1, 0.0)
    whole = begin + np.insert(np.arange(acceleration.size), crossing + 1, crossing)
    part = np.insert(np.zeros(acceleration.size), crossing + 1, fraction)
    length = np.ones(value.size - 1)
    inserted = crossing + 1 + np.arange(crossing.size)
    length[inserted - 1] = fraction
    length[inserted] = rest

    left, right = value[:-1], value[1:]
    sign = np.sign(left + right)
    start = np.flatnonzero(np.concatenate(([True], sign[1:] != sign[:-1])))
    end = np.append(start[1:], value.size - 1)
    lobe = np.repeat(np.arange(start.size), end - start)
    # Offsets are relative to the start of the lobe, as moments about the start of the record would lose digits.
    offset = (whole[:-1] - whole[start][lobe]) + (part[:-1] - part[start][lobe])
    piece_impulse = 0.5 * length * (left + right)
    piece_moment = piece_impulse * offset + length**2 * (left + 2.0 * right) / 6.0

    impulse = np.add.reduceat(piece_impulse, start)
    moment = np.add.reduceat(piece_moment, start)
    peak = sign[start] * np.maximum.reduceat(np.maximum(np.abs(left), np.abs(right)), start)
    kept = impulse != 0.0  # omits parts at zero, and parts whose impulse underflows
    # The pieces before the first and after the last crossing belong to lobes of other parts.
    kept[0] &= first is None
    kept[-1] &= last is None
    begins = dt * (whole[start][kept] + part[start][kept])
    ends = dt * (whole[end][kept] + part[end][kept])
    # A lobe may be shorter than the rounding error of its time.
    centroid = np.clip(begins + dt * (moment[kept] / impulse[kept]), begins, ends)
    return dt * impulse[kept], centroid, begins, ends, peak[kept], np.ones(begins.size, dtype=np.int64)


def _merge(lobes: HalfWaves, floor: float, min_duration: float) -> HalfWaves:
    count = len(lobes)
    impulse, start, end, peak = (values.tolist() for values in (lobes.impulse, lobes.start, lobes.end, lobes.peak))
    moment = (lobes.impulse * (lobes.centroid - lobes.start)).tolist()  # about the start of the wave
    gross = np.abs(lobes.impulse).tolist()
    size = [1] * count
    before, after = list(range(-1, count - 1)), [*range(1, count), -1]
    stamp = [0] * count  # an entry of the queue with an old stamp is ignored
    queue: list[tuple[float, int, int]] = []

    def offer(wave: int) -> None:
        stamp[wave] += 1
        if abs(peak[wave]) < floor or end[wave] - start[wave] < min_duration:
            heapq.heappush(queue, (abs(impulse[wave]), wave, stamp[wave]))

    for wave in range(count):
        offer(wave)
    while queue:  # ends, as every merger removes two waves and queues at most three
        _, middle, valid = heapq.heappop(queue)
        if stamp[middle] != valid:
            continue
        left, right = before[middle], after[middle]
        if left < 0 or right < 0:
            continue
        direction = math.copysign(1.0, impulse[left])
        if direction * impulse[middle] > 0.0 or direction * impulse[right] < 0.0:
            continue
        merged = impulse[left] + impulse[middle] + impulse[right]
        total = gross[left] + gross[middle] + gross[right]
        if direction * merged < KEPT_SHARE * total:
            continue
        merged_moment = (
            moment[left]
            + (moment[middle] + impulse[middle] * (start[middle] - start[left]))
            + (moment[right] + impulse[right] * (start[right] - start[left]))
        )
        if not 0.0 <= merged_moment / merged <= end[right] - start[left]:
            continue
        impulse[left], gross[left], moment[left], end[left] = merged, total, merged_moment, end[right]
        size[left] += size[middle] + size[right]
        peak[left] = max(peak[left], peak[right], key=abs)
        stamp[middle] = stamp[right] = -1
        after[left] = after[right]
        if after[left] >= 0:
            before[after[left]] = left
        for wave in (before[left], left, after[left]):
            if wave >= 0:
                offer(wave)

    kept = np.flatnonzero(np.array(stamp) > 0)
    waves = (np.array(own)[kept] for own in (impulse, moment, start, end, peak, size))
    total_impulse, total_moment, first, last, highest, count_of_lobes = waves
    centroid = np.clip(first + total_moment / total_impulse, first, last)
    return HalfWaves(total_impulse, centroid, first, last, highest, count_of_lobes, lobes.dt, lobes.record_id)
