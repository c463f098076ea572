"""Search for the intervals of the scale factor in which a block exceeds a limit; exceedance need not be monotonic."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from rocking.arguments import ArrayLike
from rocking.lanes import OF_LANES, LaneValues
from rocking.pictures import short_repr

#: Below the first exceedance, which gives the safety factor, a step of the scan is halved for the k-th time if the
#: response in it, divided by the limit, is estimated to reach the k-th number (docs/decisions/008).
NEAR = (0.2, 0.45, 0.7, 0.95, 1.2, 1.45)
#: Smallest number of steps of a block that are halved at once, from the lowest on; half of the steps if that is more.
TOGETHER = 4
#: A function of block indices (n,) and factors (q, n) that returns which of them exceed a limit.
Exceeds = Callable[[np.ndarray, np.ndarray], np.ndarray]
#: Largest number of factors times blocks in one call of the scan, which limits the memory.
CASES_AT_ONCE = 16384
#: The fields of :class:`ScaleIntervals` with one value for each interval.
OF_INTERVALS = ("lower", "upper", "open", "resolved")
#: Largest width of the final bracket of each edge, divided by the scale factor [-].
TOLERANCE = 1e-6
#: Largest number of factors of the scan of one block.
POINTS_MAX = 10**7


@dataclass(frozen=True, eq=False)
class ScaleIntervals(LaneValues):
    """Scale factors at which a limit is exceeded, for m blocks with k intervals in total.

    Attributes
    ----------
    safety_factor, safe_up_to : (m,) ndarray
        Smallest scale factor found at which the limit is exceeded [-], inf if there is none; largest one up to which no
        exceedance was found: the lower end of the last bracket, or the end of the search.
    lane : (k,) ndarray of int
        Index of the block of each interval, ascending; the intervals of a block ascend, too.
    lower, upper : (k,) ndarray
        Ends of the intervals of exceedance [-]; the limit is exceeded at both.
    open, resolved : (k,) ndarray of bool
        `open` is True if the limit is still exceeded at the end of the search, which is then `upper`; `resolved` is
        False if the model gives no result at `lower`, which counts as exceeding the limit.
    step : (m,) ndarray
        Ratio of neighbouring scale factors of the scan [-]: narrower intervals and gaps may be missed. 1 if none can be
        missed (closed form, or a start beyond the end of the search); NaN without a search.

    Examples
    --------
    >>> found = rocking.exceedance_intervals(lambda lanes, factors: factors > 1.2, [0.5], 10.0, 64)
    >>> found.safety_factor.round(3), found.upper, found.open
    (array([1.2]), array([10.]), array([ True]))
    """

    __repr__ = short_repr

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
        """Return a result for blocks that were not searched: no intervals, and NaN for all numbers."""
        nan, none, no_flag = np.full(lanes, np.nan), np.empty(0), np.empty(0, dtype=bool)
        return cls(nan, nan, np.empty(0, dtype=np.int64), none, none, no_flag, nan, no_flag)

    def among(self, known: np.ndarray) -> Self:
        """Return the result of all (m,) blocks from that of the `known` blocks; the others have no intervals."""
        return self.join([self], [np.flatnonzero(known)], known.size)

    def take(self, places: np.ndarray) -> Self:
        """Select blocks by index, each at most once."""
        number = np.full(self.safety_factor.size, -1)
        number[places] = np.arange(len(places))
        return super().take(places)._of_lanes(number[self.lane])

    @classmethod
    def join(cls, parts: Sequence[Self], places: Sequence[np.ndarray], count: int, **fills: Any) -> Self:
        """Join parts as :meth:`rocking.lanes.LaneValues.join` does, with the intervals of all parts."""
        whole = super().join(parts, places, count, **fills)
        rows = {name: np.concatenate([getattr(part, name) for part in parts]) for name in OF_INTERVALS}
        lane = np.concatenate([own[part.lane] for own, part in zip(places, parts, strict=True)])
        return whole.changed(**rows)._of_lanes(lane)

    def _of_lanes(self, lane: np.ndarray) -> Self:
        """Return a copy whose k intervals belong to the blocks `lane`, sorted; intervals of block -1 are dropped."""
        order = np.argsort(lane, kind="stable")[np.count_nonzero(lane < 0) :]
        return self.changed(lane=lane[order], **{name: getattr(self, name)[order] for name in OF_INTERVALS})

    @property
    def count(self) -> np.ndarray:
        """Number of intervals of each block: (m,) ndarray of int."""
        return np.bincount(self.lane, minlength=self.safety_factor.size)

    @property
    def factor_resolved(self) -> np.ndarray:
        """(m,) ndarray of bool: False if the model gives no result at `safety_factor`, which is then a lower bound."""
        answered = np.ones(self.safety_factor.size, dtype=bool)
        first = np.flatnonzero(np.diff(self.lane, prepend=-1))
        answered[self.lane[first]] = self.resolved[first]
        return answered


def exceedance_intervals(
    exceeds: Exceeds, start: np.ndarray, factor_max: float, points: ArrayLike, tolerance: float = TOLERANCE
) -> ScaleIntervals:
    """Find the scale factor intervals in which each block exceeds a limit, by a log-spaced scan with refined edges.

    Parameters
    ----------
    exceeds : callable
        Takes block indices (n,), which may repeat, and scale factors (q, n), one column per index, and returns a (q, n)
        array: bool, or the response divided by the limit, at least 1 if the limit is exceeded; NaN (no result) counts
        as exceeding. The result need not be monotonic.
    start : (m,) array_like
        Scale factor > 0 below which no exceedance is possible [-]; the scan of a block starts here. A block whose start
        is above `factor_max`, or inf, has no interval.
    factor_max : float
        End of the search [-].
    points : int or (m,) array_like of int
        Number of scale factors of the scan of each block, both ends included; at least 2.
    tolerance : float
        Relative width of the final bracket of each edge, at least 1e-12.

    Notes
    -----
    The scan has the step (factor_max/start)^(1/(points - 1)) and also includes the scale factor 1. Below the first
    exceedance of a block, steps in which its response may come close to the limit are halved. A narrower interval
    or gap is found only if a scale factor of the scan lies in it. Then all edges are refined by bisection at the
    same time.

    Examples
    --------
    >>> found = exceedance_intervals(lambda lanes, s: (s > 1.2) & (s < 2.0) | (s > 3.0), [0.5], 10.0, 64)
    >>> found.lower.round(5), found.upper.round(5), found.open
    (array([1.2, 3. ]), array([ 2., 10.]), array([False,  True]))
    """
    start = np.asarray(start, dtype=float)
    if start.ndim != 1:
        raise ValueError(f"start: expected a scale factor for each block, (m,), got shape {start.shape}")
    given = np.broadcast_to(np.asarray(points, dtype=float), start.shape)
    if not (math.isfinite(factor_max) and factor_max > 0.0):
        raise ValueError(f"factor_max: expected a positive number, got {factor_max}")
    if not np.all(start > 0.0):
        raise ValueError(f"start: expected positive scale factors, got {np.min(start)}")
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
    # An interval begins in the step before its first factor, or at the start of the scan, and ends in the step after
    # its last factor, or is open.
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
    """Return the results of `exceeds` as numbers, the response divided by the limit; NaN (no result) becomes inf."""
    reach = np.asarray(exceeds(lanes, factors), dtype=float)
    return np.where(np.isnan(reach), np.inf, reach)


def _scan(
    exceeds: Exceeds, lanes: np.ndarray, start: np.ndarray, factor_max: float, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return block, scale factor and whether the limit is exceeded for each trial, sorted by block and scale factor."""
    points = int(np.max(counts[lanes]))
    # Blocks with fewer factors than others repeat the last factor.
    share = np.minimum(np.arange(points)[:, np.newaxis] / (counts[lanes] - 1.0), 1.0)
    factors = start[lanes] * (factor_max / start[lanes]) ** share
    factors[share == 1.0] = factor_max
    # The factor one is included so that the search and a run of the unscaled input agree.
    factors = np.sort(np.vstack((factors, np.clip(1.0, start[lanes], factor_max))), axis=0)
    reach = _reach(exceeds, lanes, factors).T.reshape(-1)
    lane, factor = np.repeat(lanes, points + 1), factors.T.reshape(-1)
    once = np.append(True, (lane[1:] != lane[:-1]) | (factor[1:] > factor[:-1]))
    return _denser(exceeds, lane[once], factor[once], reach[once])


def _denser(
    exceeds: Exceeds, lane: np.ndarray, factor: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Below the first exceedance, halve each step within which `reach`, by its second differences, may exceed 1."""
    halvings = np.zeros(lane.size, dtype=np.int64)  # for the step that begins at the factor
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
        # The lowest steps of a block come first: an exceedance in one of them makes all higher ones needless.
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
    """Bisect the brackets (below, above) of the ends of all intervals of all blocks at the same time, in place."""
    while True:
        wide = np.flatnonzero(np.isfinite(above) & (above - below > tolerance * above))
        if wide.size == 0:
            return
        middle = 0.5 * (below[wide] + above[wide])
        over = _reach(exceeds, lane[wide], middle[np.newaxis])[0] >= 1.0
        upwards = over != rises[wide]
        below[wide[upwards]], above[wide[~upwards]] = middle[upwards], middle[~upwards]
