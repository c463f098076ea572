"""The uncertainty of a body and of the strength of a record, and its effect on the scale factor.

.. note:: In a random sample the scale factor f becomes f F with ln F normal, C is a share of the nominal C, and alpha
   becomes alpha exp(-g abs(N)), N standard normal, with the R, p and C of the nominal body. For a slender body, factor
   and geometry together are one shift of ln f: Z = s N_1 + g abs(N_2), skew-normal with the scale hypot(s, g) and the
   shape g/s (Azzalini 1985, Scand. J. Stat. 12(2), 171-178).

Lane i was computed at ln f_i with the outcome v_i, 1 if it overturned. A block at the scale factor f experiences
f exp(Z), so P(f) is the outcome smoothed with the density h of Z,

P(f) = integral of h(t - ln f) v(t) dt,  estimated inside by sum_i w_i h(t_i - ln f) v_i/sum_i w_i h(t_i - ln f)

with w_i = 1/(density of the lanes in ln f); the denominator is near 1 and removes the effect of unequal spacing. No
lane overturns below `bottom` and all do above `top`; the probability of a shift into these ranges is known.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.special import ndtr, owens_t

from rocking.arguments import ArrayLike, numbers
from rocking.kernel_cache import njit
from rocking.pictures import short_repr

#: Smallest standard deviation of ln f [-]: a finite number of lanes cannot resolve a smaller one.
LEAST_SPREAD = 0.02
#: Largest standard deviations that are accepted [-]; larger numbers are probably in a wrong unit.
LARGEST_SPREAD = 1.0
#: Largest restitution divided by the nominal one that is accepted [-].
LARGEST_SHARE = 2.0
#: Largest restitution that is computed; it represents 1, because a block with C = 1 never comes to rest after the
#: record and takes twenty times as long.
MOST_RESTITUTION = 0.999
#: If the sum of weights at a level is below this, no lane is near the level.
NO_LANE = 1e-9
#: Truncation of the shift divided by its scale: the density there is 1e-14 of its maximum.
FARTHEST = 8.0
#: Number of points for each scale of the shift (more for a skewed one) at which its density is stored for sums over
#: many lanes; between them it is interpolated by parabolas, with an error of 4e-8 of its maximum.
BELL_POINTS = 256


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of the record, the restitution and the geometry in a probability of overturning.

    Attributes
    ----------
    factor : float
        Standard deviation of the logarithm of the scale factor on the record [-], 0.02 to 1.
    restitution : (v,) tuple of float
        Restitutions divided by the nominal C [-], two or more, above 0, at most 2. Two are the limits of a uniform
        distribution; more are measured values of equal probability, with a quantile that is linear between them. A C
        above 1 counts as 1.
    geometry : float
        Random reduction of alpha [-]: alpha exp(-geometry abs(N)), N standard normal, at fixed R and p; 0 to 1.

    Examples
    --------
    >>> known = Uncertainty(geometry=0.0)
    >>> float(known.density(0.0).round(6))                        # 1/(0.1 sqrt(2 pi))
    3.989423
    >>> Uncertainty(restitution=(0.9, 1.0, 1.02)).restitutions(0.95, np.array([0.0, 0.5, 1.0])).round(3).tolist()
    [0.855, 0.95, 0.969]
    """

    __repr__ = short_repr

    factor: float = 0.10
    restitution: tuple[float, ...] = (0.95, 1.05)
    geometry: float = 0.05

    def __post_init__(self) -> None:
        expected = f"a standard deviation of {LEAST_SPREAD:g} to {LARGEST_SPREAD:g}"
        if not LEAST_SPREAD <= numbers("factor", self.factor, expected, lanes=False) <= LARGEST_SPREAD:
            raise ValueError(f"factor: expected {expected}, got {self.factor!r}")
        expected = f"two or more restitutions divided by the nominal one, above 0 and at most {LARGEST_SHARE:g}"
        shares = numbers("restitution", self.restitution, expected)
        if shares.size < 2 or np.any(shares <= 0.0) or np.any(shares > LARGEST_SHARE):
            raise ValueError(f"restitution: expected {expected}, got {self.restitution!r}")
        expected = f"a share from 0 to {LARGEST_SPREAD:g}"
        if not 0.0 <= numbers("geometry", self.geometry, expected, lanes=False) <= LARGEST_SPREAD:
            raise ValueError(f"geometry: expected {expected}, got {self.geometry!r}")

    def restitutions(self, nominal: ArrayLike, rank: np.ndarray) -> np.ndarray:
        """Return the quantiles of C (..., n) at the probabilities `rank` (n,), for `nominal` restitutions (...) [-]."""
        shares = np.quantile(self.restitution, rank)
        return np.minimum(np.asarray(nominal, dtype=float)[..., np.newaxis] * shares, MOST_RESTITUTION)

    @property
    def spread(self) -> float:
        """Standard deviation of the shift Z of ln f due to scale factor and geometry together [-]."""
        return math.sqrt(self.factor**2 + (1.0 - 2.0 / math.pi) * self.geometry**2)

    def density(self, shift: ArrayLike) -> np.ndarray:
        """Return the probability density of the shift Z of ln f due to scale factor and geometry together [-]."""
        given = np.asarray(shift, dtype=float)
        return lane_bells(given.ravel(), np.ones(given.size), np.zeros(1), self).reshape(given.shape)

    def below(self, shift: ArrayLike) -> np.ndarray:
        """Return the probability that the random shift Z of :meth:`density` is at most `shift` [-]."""
        at = np.asarray(shift, dtype=float) / math.hypot(self.factor, self.geometry)
        return ndtr(at) - 2.0 * owens_t(at, self.geometry / self.factor)


#: A smaller decrease of a probability is a rounding error.
ROUNDING = 1e-12


def rising(probability: np.ndarray) -> np.ndarray:
    """Fit non-decreasing probabilities (..., k) [-] by isotonic least squares (pool adjacent violators; Busing 2022).

    Busing, F. M. T. A. (2022), J. Stat. Softw. 102, Code Snippet 1, doi:10.18637/jss.v102.c01.
    """
    fitted = np.array(probability, dtype=float)
    rows = fitted.reshape(-1, fitted.shape[-1])
    _pool(rows, np.flatnonzero(np.any(np.diff(rows, axis=1) < -ROUNDING, axis=1)), np.empty(rows.shape[1]))
    return np.maximum.accumulate(rows, axis=1).reshape(fitted.shape)


@njit(_nrt=False)
def _pool(rows, chosen, size):
    # The first places of a row and of `size` hold the means and sizes of the blocks of equal values so far.
    for number in chosen:
        row = rows[number]
        last, place = -1, 0
        while place < row.size:
            mean, members = row[place], 1.0
            place += 1
            if last >= 0 and row[last] >= mean:  # a new block takes the next values first, then the blocks before it
                total = size[last] * row[last] + mean
                members += size[last]
                mean = total / members
                last -= 1
                while place < row.size and mean >= row[place]:
                    total += row[place]
                    members += 1.0
                    mean = total / members
                    place += 1
                while last >= 0 and row[last] >= mean:
                    total += size[last] * row[last]
                    members += size[last]
                    mean = total / members
                    last -= 1
            last += 1
            row[last], size[last] = mean, members
        end = row.size
        for block in range(last, -1, -1):  # from the last block, as the values take the places of the means
            mean, begin = row[block], end - int(size[block])
            for place in range(begin, end):
                row[place] = mean
            end = begin


def factor_at(share: float, level: np.ndarray, probability: np.ndarray) -> np.ndarray:
    """Return the scale factor at which rising P (..., k) reaches `share`, interpolated in ln f; inf if it does not."""
    reached = probability >= share
    after = np.argmax(reached, axis=-1)
    before = np.maximum(after - 1, 0)
    high = np.take_along_axis(probability, after[..., np.newaxis], axis=-1)[..., 0]
    low = np.take_along_axis(probability, before[..., np.newaxis], axis=-1)[..., 0]
    logs = np.log(level)
    part = np.divide(share - low, high - low, out=np.ones(np.shape(low)), where=high > low)
    return np.where(np.any(reached, axis=-1), np.exp(logs[before] + part * (logs[after] - logs[before])), np.inf)


def mean_capacity(level: np.ndarray, probability: np.ndarray) -> np.ndarray:
    """Return the geometric mean of a scale factor with distribution P (..., k) at levels; inf if P stays below 1."""
    logs = np.log(level)
    gained = np.diff(probability, axis=-1) * (0.5 * (logs[1:] + logs[:-1]))
    # Summed in sequence, so that further levels without a change of P do not change the result.
    mean = probability[..., 0] * logs[0] + np.cumsum(gained, axis=-1)[..., -1] + (1.0 - probability[..., -1]) * logs[-1]
    return np.where(probability[..., -1] > 1.0 - 1e-3, np.exp(mean), np.inf)


def lane_bells(log_factor: np.ndarray, weight: np.ndarray, log_level: np.ndarray, shift: Uncertainty) -> np.ndarray:
    """Return `weight` times the density of the shift at `log_factor` - `log_level`, (n, k) for n lanes and k levels."""
    bells = np.zeros((log_factor.size, log_level.size))
    _bells(log_factor, weight, log_level, *_skew(shift), bells)
    return bells


def _skew(shift: Uncertainty) -> tuple[float, float]:
    """Return the scale and the shape of the skew-normal shift of ln f."""
    return math.hypot(shift.factor, shift.geometry), shift.geometry / shift.factor


@njit(_nrt=False)
def _bell(at, scale, shape):
    # Skew-normal: twice the normal density times the normal distribution function at shape times the argument.
    return math.exp(-0.5 * at * at) * math.erfc(-math.sqrt(0.5) * shape * at) / (scale * math.sqrt(2.0 * math.pi))


@njit(_nrt=False)
def _bells(log_factor, weight, log_level, scale, shape, bells):
    for lane in range(log_factor.size):
        for level in range(log_level.size):
            at = (log_factor[lane] - log_level[level]) / scale
            if abs(at) < FARTHEST:
                bells[lane, level] = _bell(at, scale, shape) * weight[lane]


def lane_moments(
    log_factor: np.ndarray,
    weight: np.ndarray,
    reached: np.ndarray,
    states: int,
    ends: np.ndarray,
    log_level: np.ndarray,
    shift: Uncertainty,
) -> np.ndarray:
    """Return sums of the results of :func:`lane_bells` and of their squares, over the lanes before each of `ends`.

    Parameters
    ----------
    log_factor, weight : (n,) ndarray
        Lanes as in :func:`lane_bells`.
    reached : (n,) ndarray of int
        Number of limit states that each lane reaches, 0 to h.
    states : int
        Number of limit states h.
    ends : (b,) ndarray of int
        Numbers of lanes, ascending.
    log_level, shift
        As in :func:`lane_bells`; the levels ascend.

    Returns
    -------
    (b, 1 + h, 2, k) ndarray
        Sums of values and of squares, over all lanes before each end and over the lanes that reach each limit state.
    """
    sums = np.zeros((ends.size, 1 + states, 2, log_level.size))
    lanes = log_factor, weight, reached
    _add_moments(
        *lanes,
        ends,
        log_level,
        _skew(shift)[0],
        _bell_table(shift.factor, shift.geometry),
        np.zeros(sums.shape[1:]),
        sums,
    )
    return sums


@lru_cache(maxsize=8)
def _bell_table(factor: float, geometry: float) -> np.ndarray:
    """Return the density of the shift at equal steps from -FARTHEST to FARTHEST times its scale."""
    points = math.ceil(BELL_POINTS * max(1.0, 0.4 * geometry / factor))
    shift = Uncertainty(factor, geometry=geometry)
    return shift.density(_skew(shift)[0] * np.linspace(-FARTHEST, FARTHEST, round(2.0 * FARTHEST * points) + 1))


@njit(_nrt=False)
def _add_moments(log_factor, weight, reached, ends, log_level, scale, table, running, sums):
    lane, points = 0, (table.size - 1) / (2.0 * FARTHEST)
    reach = scale * (FARTHEST - 1.0 / points)
    for end in range(ends.size):
        while lane < ends[end]:
            first = np.searchsorted(log_level, log_factor[lane] - reach)
            for level in range(first, log_level.size):
                if log_level[level] > log_factor[lane] + reach:
                    break
                place = ((log_factor[lane] - log_level[level]) / scale + FARTHEST) * points
                point = int(place + 0.5)
                away, before, after = place - point, table[point - 1] - table[point], table[point + 1] - table[point]
                bell = weight[lane] * (table[point] + 0.5 * away * (after - before + away * (after + before)))
                for row in range(1 + reached[lane]):
                    running[row, 0, level] += bell
                    running[row, 1, level] += bell * bell
            lane += 1
        for row in range(running.shape[0]):
            for moment in range(2):
                for level in range(log_level.size):
                    sums[end, row, moment, level] = running[row, moment, level]


def lane_sums(counted: np.ndarray, bells: np.ndarray) -> np.ndarray:
    """Return the matrix product (r, k) of `counted` (r, n) and `bells` (n, k), identical for any number of threads."""
    sums, within = np.zeros((counted.shape[0], bells.shape[1])), np.zeros((bells.shape[0], 2), dtype=np.uint64)
    _add(np.ascontiguousarray(counted, dtype=np.float64), np.ascontiguousarray(bells), within, sums)
    return sums


@njit(_nrt=False)
def _add(counted, bells, within, sums):
    # `within` are the levels between which the bell of a lane is not zero: a third of them.
    for lane in range(bells.shape[0]):
        for level in range(bells.shape[1]):
            if bells[lane, level] != 0.0:
                if within[lane, 1] == 0:
                    within[lane, 0] = level
                within[lane, 1] = level + 1
    # A few rows at once, because the bells of all lanes do not fit into the fast memory.
    for first in range(0, counted.shape[0], 8):
        for lane in range(counted.shape[1]):
            for row in range(first, min(first + 8, counted.shape[0])):
                times = counted[row, lane]
                if times != 0.0:
                    for level in range(within[lane, 0], within[lane, 1]):
                        sums[row, level] += times * bells[lane, level]


def tail_masses(bottom: Any, top: Any, log_level: np.ndarray, shift: Uncertainty) -> tuple[np.ndarray, np.ndarray]:
    """Return probabilities (k,) that the shifted ln f is below `bottom`, and that it is above `top`."""
    return shift.below(bottom - log_level), 1.0 - shift.below(top - log_level)


def lane_probability(hit: np.ndarray, whole: np.ndarray, below: np.ndarray, above: np.ndarray) -> np.ndarray:
    """Return P (..., k) from the summed weights of overturning (`hit`) and all samples, and from the tail masses."""
    share = np.divide(hit, whole, out=np.zeros(np.shape(hit)), where=whole > NO_LANE)
    return (1.0 - below - above) * np.clip(share, 0.0, 1.0) + above
