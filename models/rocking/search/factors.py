"""Intervals of the factor on an input in which a block exceeds a limit, which need not be monotonic."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from rocking.arguments import ArrayLike
from rocking.lanes import OF_LANES, LaneValues
from rocking.pictures import one_line

#: Below the first exceedance, where the safety factor is read, a step of the scan is halved for the k-th time where the
#: lane may come this near the limit in it (docs/decisions/008).
NEAR = (0.2, 0.45, 0.7, 0.95, 1.2, 1.45)
#: Steps of a lane that are halved together, from the lowest on: half of all that are due, at least these.
TOGETHER = 4
#: Tells of lanes (n,) and factors (q, n) which exceed a limit.
Exceeds = Callable[[np.ndarray, np.ndarray], np.ndarray]
#: Factors times lanes of one call of the scan: it bounds the memory of a call.
CASES_AT_ONCE = 16384
#: The fields of :class:`ScaleIntervals` with one value for each interval.
OF_INTERVALS = ("lower", "upper", "open", "resolved")
#: Most factors of the scan in one lane.
POINTS_MAX = 10**7


@dataclass(frozen=True, eq=False)
class ScaleIntervals(LaneValues):
    """Factors on the input at which a limit is exceeded, for m lanes that have k intervals together.

    Attributes
    ----------
    safety_factor, safe_up_to : (m,) ndarray
        Smallest factor found to exceed the limit [-], inf if none; largest factor up to which the search found nothing:
        the lower end of the last bracket, or the end of the search.
    lane : (k,) ndarray of int
        Lane of each interval; ascending, and within a lane the intervals ascend.
    lower, upper : (k,) ndarray
        Ends of the intervals of exceedance [-]; the limit is exceeded at both.
    open, resolved : (k,) ndarray of bool
        True if the limit is still exceeded at the end of the search, which then is `upper`; False if it counts as
        exceeded at `lower` because the model cannot answer there.
    step : (m,) ndarray
        Ratio of neighbouring factors of the scan [-]: narrower intervals, and gaps, may be missed. One if nothing can
        be missed (closed form, or a start beyond the end of the search); NaN if nothing was searched.
    """

    __repr__ = one_line

    safety_factor: np.ndarray = field(metadata=OF_LANES)
    safe_up_to: np.ndarray = field(metadata=OF_LANES)
    lane: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    open: np.ndarray
    step: np.ndarray = field(metadata=OF_LANES)
    resolved: np.ndarray

    @classmethod
    def unknown(cls, lanes: tuple[int, ...]) -> Self:
        """Of lanes of a shape that were not searched: NaN, without an interval."""
        nan, none, no_flag = np.full(lanes, np.nan), np.empty(0), np.empty(0, dtype=bool)
        return cls(nan, nan, np.empty(0, dtype=np.int64), none, none, no_flag, nan, no_flag)

    def among(self, known: np.ndarray) -> Self:
        """These of the lanes that are `known` (m,), as those of all; the others were not searched."""
        return self.join([self], [np.flatnonzero(known)], known.size)

    def take(self, places: np.ndarray) -> Self:
        """Some lanes by their places, each once at most."""
        number = np.full(self.safety_factor.size, -1)
        number[places] = np.arange(len(places))
        return super().take(places)._of_lanes(number[self.lane])

    @classmethod
    def join(cls, parts: Sequence[Self], places: Sequence[np.ndarray], count: int, **fills: Any) -> Self:
        """As :meth:`rocking.lanes.LaneValues.join`, with the intervals of all parts."""
        whole = super().join(parts, places, count, **fills)
        rows = {name: np.concatenate([getattr(part, name) for part in parts]) for name in OF_INTERVALS}
        lane = np.concatenate([own[part.lane] for own, part in zip(places, parts, strict=True)])
        return whole.changed(**rows)._of_lanes(lane)

    def _of_lanes(self, lane: np.ndarray) -> Self:
        """The same with its intervals in the order of the lanes (k,) that they belong to, -1 for none."""
        order = np.argsort(lane, kind="stable")[np.count_nonzero(lane < 0) :]
        return self.changed(lane=lane[order], **{name: getattr(self, name)[order] for name in OF_INTERVALS})

    @property
    def count(self) -> np.ndarray:
        """Number of intervals of each lane: (m,) ndarray of int."""
        return np.bincount(self.lane, minlength=self.safety_factor.size)

    @property
    def factor_resolved(self) -> np.ndarray:
        """(m,) ndarray of bool: False where the model cannot answer at `safety_factor`, which is a lower bound then."""
        answered = np.ones(self.safety_factor.size, dtype=bool)
        first = np.flatnonzero(np.diff(self.lane, prepend=-1))
        answered[self.lane[first]] = self.resolved[first]
        return answered


def exceedance_intervals(
    exceeds: Exceeds, start: np.ndarray, factor_max: float, points: ArrayLike, tolerance: float = 1e-6
) -> ScaleIntervals:
    """Intervals of the factor in which each lane exceeds a limit: a scan on a log grid, and every edge refined.

    Parameters
    ----------
    exceeds : callable
        Takes numbers of lanes (n,), which may repeat, and factors (q, n) with a column for each of them, and returns
        a (q, n) array: bool, or a number that is 1 or more if the limit is exceeded and says below 1 how near the
        lane came to it; NaN, no answer, counts as exceeding. It need not be monotonic in the factor.
    start : (m,) array_like
        Below this no exceedance is possible, > 0 [-]; the scan of a lane begins here. If it is above `factor_max`, inf
        included, the lane has no interval.
    factor_max : float
        End of the search [-].
    points : int or (m,) array_like of int
        Factors of the scan in each lane, both ends included; at least 2.
    tolerance : float
        Relative width of the bracket that each edge ends with, at least 1e-12.

    Notes
    -----
    The scan has the step (factor_max/start)^(1/(points - 1)), and the factor one besides. Below the first exceedance of
    a lane, steps in which it may come near the limit are halved. A narrower interval, or gap between two, is seen only
    if a factor happens to fall into it. Then all edges are bisected together, one edge of each bracket.

    Examples
    --------
    >>> found = exceedance_intervals(lambda lanes, s: (s > 1.2) & (s < 2.0) | (s > 3.0), [0.5], 10.0, 64)
    >>> found.lower.round(5), found.upper.round(5), found.open
    (array([1.2, 3. ]), array([ 2., 10.]), array([False,  True]))
    """
    start = np.asarray(start, dtype=float)
    if start.ndim != 1:
        raise ValueError(f"start: expected one factor for each lane, (m,), got shape {start.shape}")
    given = np.broadcast_to(np.asarray(points, dtype=float), start.shape)
    if not (math.isfinite(factor_max) and factor_max > 0.0):
        raise ValueError(f"factor_max: expected a positive number, got {factor_max}")
    if not np.all(start > 0.0):
        raise ValueError(f"start: expected positive factors, got a smallest of {np.min(start)}")
    if not np.all((given >= 2.0) & (given <= POINTS_MAX) & (given == np.floor(given))):
        raise ValueError(f"points: expected whole numbers from 2 to {POINTS_MAX}, got {points!r}")
    counts = given.astype(np.int64)
    if not 1e-12 <= tolerance < 1.0:
        raise ValueError(f"tolerance: expected at least 1e-12 and below 1, got {tolerance}")
    searched = np.flatnonzero(start <= factor_max)
    at_once = max(1, CASES_AT_ONCE // int(np.max(counts, initial=2)))
    parts = [
        _scan(exceeds, searched[first : first + at_once], start, factor_max, counts)
        for first in range(0, searched.size, at_once)
    ]
    parts.append((np.empty(0, dtype=np.int64), np.empty(0), np.empty(0, dtype=bool)))
    lane, factor, over = (np.concatenate(column) for column in zip(*parts, strict=True))
    same = lane[1:] == lane[:-1]
    rise, fall = over.copy(), over.copy()
    rise[1:] &= ~(over[:-1] & same)
    fall[:-1] &= ~(over[1:] & same)
    # An interval begins in the step before its first factor, or with the scan, and ends in the step after its last
    # one, or not at all.
    before = np.where(np.append(False, same), np.roll(factor, 1), factor)
    after = np.where(np.append(same, False), np.roll(factor, -1), np.inf)
    lane, count = lane[rise], np.count_nonzero(rise)
    below, above = np.append(before[rise], factor[fall]), np.append(factor[rise], after[fall])
    _bisect(exceeds, np.tile(lane, 2), below, above, np.arange(2 * count) < count, tolerance)
    lower, upper = above[:count], below[count:]
    safe, safety = np.full(start.size, float(factor_max)), np.full(start.size, np.inf)
    first = np.flatnonzero(np.diff(lane, prepend=-1))
    safety[lane[first]], safe[lane[first]] = lower[first], below[first]
    step = np.where(start <= factor_max, (factor_max / start) ** (1.0 / (counts - 1)), 1.0)
    return ScaleIntervals(safety, safe, lane, lower, upper, above[count:] == np.inf, step, np.ones(count, dtype=bool))


def _reach(exceeds: Exceeds, lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """The answers of `exceeds` as numbers; inf where it has none."""
    reach = np.asarray(exceeds(lanes, factors), dtype=float)
    return np.where(np.isnan(reach), np.inf, reach)


def _scan(
    exceeds: Exceeds, lanes: np.ndarray, start: np.ndarray, factor_max: float, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lane, factor, and whether it exceeds the limit, by lane and upwards."""
    points = int(np.max(counts[lanes]))
    # Lanes with fewer factors than others repeat the last one.
    share = np.minimum(np.arange(points)[:, np.newaxis] / (counts[lanes] - 1.0), 1.0)
    factors = start[lanes] * (factor_max / start[lanes]) ** share
    factors[share == 1.0] = factor_max
    # The input as it is: what the search says of it must not differ from what a model says of it.
    factors = np.sort(np.vstack((factors, np.clip(1.0, start[lanes], factor_max))), axis=0)
    reach = _reach(exceeds, lanes, factors).T.reshape(-1)
    lane, factor = np.repeat(lanes, points + 1), factors.T.reshape(-1)
    once = np.append(True, (lane[1:] != lane[:-1]) | (factor[1:] > factor[:-1]))
    return _denser(exceeds, lane[once], factor[once], reach[once])


def _denser(
    exceeds: Exceeds, lane: np.ndarray, factor: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The scan with those steps halved that, by the second difference of the reach, may hide an earlier one."""
    halvings = np.zeros(lane.size, dtype=np.int64)  # of the step that begins at the factor
    due = np.append(NEAR, np.inf)
    while True:
        over = np.flatnonzero(reach >= 1.0)
        first = np.full(int(lane[-1]) + 1, np.inf)
        np.minimum.at(first, lane[over], factor[over])
        near = np.minimum(reach, 1.0)
        bend = np.zeros(lane.size)
        bend[1:-1] = np.where(lane[2:] == lane[:-2], np.abs(near[2:] - 2.0 * near[1:-1] + near[:-2]), 0.0)
        may_reach = np.maximum(near[:-1], near[1:]) + np.maximum(bend[:-1], bend[1:])
        inside = (lane[1:] == lane[:-1]) & (factor[:-1] < first[lane[:-1]])
        step = np.flatnonzero(inside & (may_reach >= due[halvings[:-1]]))
        if step.size == 0:
            return lane, factor, reach >= 1.0
        # The lowest steps of a lane go ahead of the others: what exceeds in one of them spares all above it.
        begin = np.flatnonzero(np.diff(lane[step], prepend=-1))
        count = np.diff(begin, append=step.size)
        step = step[np.arange(step.size) - np.repeat(begin, count) < np.repeat(np.maximum(TOGETHER, count / 2), count)]
        middle = np.sqrt(factor[step] * factor[step + 1])
        halvings[step] += 1
        reach = np.insert(reach, step + 1, _reach(exceeds, lane[step], middle[np.newaxis])[0])
        lane, factor, halvings = (
            np.insert(values, step + 1, new)
            for values, new in ((lane, lane[step]), (factor, middle), (halvings, halvings[step]))
        )


def _bisect(
    exceeds: Exceeds, lane: np.ndarray, below: np.ndarray, above: np.ndarray, rises: np.ndarray, tolerance: float
) -> None:
    """Narrow the brackets (below, above) of all edges of all lanes in the same rounds, in place."""
    while True:
        wide = np.flatnonzero(np.isfinite(above) & (above - below > tolerance * above))
        if wide.size == 0:
            return
        middle = 0.5 * (below[wide] + above[wide])
        over = _reach(exceeds, lane[wide], middle[np.newaxis])[0] >= 1.0
        upwards = over != rises[wide]
        below[wide[upwards]], above[wide[~upwards]] = middle[upwards], middle[~upwards]
