"""Probability of overturning P(f) of any body under a record times f, from nonlinear responses of this body.

.. note:: The 90 % intervals are computed by resampling the lanes with replacement as if they were independent (Sobol
   points scatter less). If all n = (sum w)^2/sum w^2 effective lanes near the factor one have the same outcome,
   resampling gives no spread: the end of the interval is then the binomial bound for n equal outcomes, 1 - 0.05^(1/n).
"""

import math
from dataclasses import dataclass, fields
from functools import cache

import numpy as np

from rocking.arguments import ArrayLike, numbers, positive
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.pictures import short_repr
from rocking.spectrum.body_lanes import REACH, BodyLanes, LaneMarch, probability_lanes
from rocking.spectrum.overturning import OverturningFactors
from rocking.spectrum.probability import Uncertainty, factor_at, lane_probability, lane_sums, mean_capacity, rising

#: Levels are exp(LEVEL_STEP k) with integer k, including 1, the same for all bodies.
LEVEL_STEP = 0.04
#: Number of resamples for an interval, and the quantiles at its ends.
RESAMPLES, LOW, HIGH = 200, 0.05, 0.95
#: Names of the scale factors derived from P, and the probability of each.
SHARES = {"factor_10": 0.1, "factor_50": 0.5}
#: A lane is near a level if its weight is at least this share of the largest weight there.
NEAR = 0.01
#: Rounding tolerance: a largest factor this close to a level counts as that level, and a C this little above 1 as 1.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class LaneFactors:
    """Scale factors of one body with their 90 % intervals [-], and its probability of overturning P (k,)."""

    found: dict[str, float]
    first: int
    probability: np.ndarray

    def at(self, places: np.ndarray) -> np.ndarray:
        """Return P at the levels exp(LEVEL_STEP k) [-]; `places` are the numbers k."""
        own = np.clip(places - self.first, 0, self.probability.size - 1)
        return np.where(places < self.first, 0.0, self.probability[own])


def lane_factors(lanes: BodyLanes | None, shift: Uncertainty, reach: float, factor_max: float) -> LaneFactors:
    """Compute the scale factors of one body from its lanes; `lanes` is None for a body that does not lift."""
    if lanes is None:
        nothing = np.zeros(RESAMPLES + 1)
        found = _interval("at_one", nothing)
        for name in (*SHARES, "capacity_mean"):
            found |= _up_to(factor_max, _interval(name, nothing + np.inf))
        return LaneFactors(found, 0, np.zeros(1))
    first, last = _ends(lanes, reach)
    logs = LEVEL_STEP * np.arange(first, last + 1)
    bells, tails = lanes.sums(logs, shift)
    counts = _counts(lanes.over.size)
    probability = rising(lane_probability(lane_sums(counts * lanes.over, bells), lane_sums(counts, bells), *tails))
    level = np.exp(logs)
    found = _at_one(lanes, probability, first, shift)
    for name, share in SHARES.items():
        found |= _up_to(factor_max, _interval(name, factor_at(share, level, probability)))
    capacity = _interval("capacity_mean", mean_capacity(level, probability))
    if lanes.open:
        # P is unknown above the last level: a lower bound of the mean capacity is the area above P up to it.
        least = np.exp(logs[0] + np.trapezoid(1.0 - probability, logs, axis=-1))
        capacity = {**dict.fromkeys(capacity, np.inf), "capacity_mean_low": _interval("least", least)["least_low"]}
    return LaneFactors(found | _up_to(factor_max, capacity), first, probability[0])


def _ends(lanes: BodyLanes, reach: float) -> tuple[int, int]:
    """Return the first and the last level k: P is 0 below them and 1 above (unknown if lanes survive)."""
    lowest = np.min(lanes.log_factor, where=lanes.over, initial=lanes.top)
    highest = np.max(lanes.log_factor, where=~lanes.over, initial=lanes.bottom)
    end = lanes.top - reach if lanes.open else highest + reach
    first, last = math.floor((lowest - reach) / LEVEL_STEP), math.ceil(end / LEVEL_STEP)
    return min(first, last - 1), last


@cache
def _counts(size: int) -> np.ndarray:
    """Return how often each lane is counted: once in the first row, at random in the RESAMPLES other rows."""
    drawn = np.random.default_rng(size).multinomial(size, np.full(size, 1.0 / size), size=RESAMPLES)
    return np.vstack([np.ones(size), drawn])


def _interval(name: str, values: np.ndarray) -> dict[str, float]:
    """Return the first value, and the 5 % and 95 % quantiles of the other values as `_low` and `_high`."""
    low = np.quantile(values[1:], LOW, method="lower")
    high = np.quantile(values[1:], HIGH, method="higher")
    return {name: float(values[0]), f"{name}_low": float(low), f"{name}_high": float(high)}


def _up_to(factor_max: float, interval: dict[str, float]) -> dict[str, float]:
    """Set factors above `factor_max` to inf, and the lower end of the interval to at most `factor_max`."""
    return {
        name: min(value, factor_max) if name.endswith("_low") else value if value <= factor_max else math.inf
        for name, value in interval.items()
    }


def _at_one(lanes: BodyLanes, probability: np.ndarray, first: int, shift: Uncertainty) -> dict[str, float]:
    """Return P at the scale factor one and its interval; `probability` (r, k) has one row for each resample."""
    if first > 0:
        return _interval("at_one", np.zeros(RESAMPLES + 1))
    place = min(-first, probability.shape[1] - 1)
    found = _interval("at_one", probability[:, place])
    bells, tails = lanes.sums(np.zeros(1), shift)
    bells, (below, above) = bells.ravel(), (float(mass.item()) for mass in tails)
    inside = 1.0 - below - above
    if np.sum(bells) > 0.0:
        least = LOW ** (np.sum(bells**2) / np.sum(bells) ** 2)
        near = lanes.over[bells > NEAR * np.max(bells)]
        if not near.any():
            found["at_one_high"] = max(found["at_one_high"], inside * (1.0 - least) + above)
        if near.all():
            found["at_one_low"] = min(found["at_one_low"], inside * least + above)
    return found


@dataclass(frozen=True, eq=False)
class OverturningProbability(OverturningFactors):
    """Probability of overturning of (m,) bodies as a function of the factor on a record, computed for each body.

    Attributes
    ----------
    level : (k,) ndarray
        Factors on the record, ascending, from the lowest one that can lift a body; they include 1.
    probability : (m, k) ndarray
        Probability of overturning at the levels, fitted so that it never falls [-].
    unresolved : (m,) ndarray
        Share of the lanes that are UNRESOLVED (free flight) [-]; they count as overturning.

    Examples
    --------
    >>> found = rocking.overturning_probability(pier, record.acceleration, record.dt)
    >>> found.overturning([[1.0, 3.0]]).round(1)
    array([[0. , 0.9]])
    """

    __repr__ = short_repr

    level: np.ndarray
    probability: np.ndarray
    unresolved: np.ndarray

    def overturning(self, factor: ArrayLike) -> np.ndarray:
        """Return the probability of overturning at factors (m, d), interpolated in ln f between the levels [-]."""
        rows = zip(np.log(np.asarray(factor, dtype=float)), self.probability, strict=True)
        return np.array([np.interp(one, np.log(self.level), own) for one, own in rows])


def overturning_probability(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    uncertainty: Uncertainty | None = None,
    vertical: ArrayLike | None = None,
    factor_max: float = 10.0,
    *,
    least: ArrayLike | None = None,
    most: ArrayLike | None = None,
    guess: ArrayLike | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> OverturningProbability:
    """Compute the probability that bodies overturn under a record times a factor, with the nonlinear equation.

    Parameters
    ----------
    block : Block
        One nominal body, with results of shape (1,), or an array of m bodies.
    acceleration, dt, vertical
        As for :func:`~rocking.recorded_response`; the factor multiplies both accelerations.
    uncertainty : Uncertainty, optional
        Uncertainty of factor, restitution and geometry; by default ``Uncertainty()``.
    factor_max : float
        Largest factor that is searched [-].
    least, most : (m,) array_like, optional
        Limits of the uniform distribution of C [-]; by default shares of the nominal C (`uncertainty`), at most 0.999.
    guess : (m,) array_like, optional
        Estimate of the factor at which a body overturns [-]. A good estimate saves computing time.
    seed : int
        Seed of the random numbers, not negative.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    OverturningProbability
        For (m,) bodies. A factor above `factor_max` is inf, and its `_low` is `factor_max` (for `capacity_mean`, its
        lower bound).

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> found = overturning_probability(block, sine, 0.01)
    >>> found.factor_10.round(1).tolist(), found.factor_50.round(1).tolist()  # the exact block overturns from 3.21 on
    ([2.7], [3.1])
    """
    uncertainty = uncertainty or Uncertainty()
    blocks = block.lanes()
    # A run at factor zero checks the arguments before they are used.
    recorded_response(blocks, acceleration, dt, scale=0.0, vertical=vertical, threads=threads)
    ground = np.ascontiguousarray(acceleration, dtype=float)
    up = None if vertical is None else np.ascontiguousarray(vertical, dtype=float)
    limit = float(positive("factor_max", factor_max, "of the record", lanes=False))
    nominal = np.asarray(blocks.restitution)
    low, high = (
        np.broadcast_to(share * nominal if given is None else numbers(name, given, "a C from 0 to 1"), nominal.shape)
        for name, given, share in zip(("least", "most"), (least, most), uncertainty.restitution, strict=True)
    )
    if not (np.all(low >= 0.0) and np.all(low <= high) and np.all(high <= 1.0 + ROUNDING)):
        raise ValueError(f"least, most: expected 0 <= least <= most <= 1, got {least!r:.80} and {most!r:.80}")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed: expected a whole number of at least 0, got {seed!r}")
    near = None if guess is None else np.broadcast_to(positive("guess", guess, "of the record"), nominal.shape)
    # P at the largest factor, and at 1, needs lanes up to the largest random shift above it.
    log_max = max(math.log(limit), 0.0)
    reach = REACH * uncertainty.factor
    march = LaneMarch(blocks, ground, float(dt), up, uncertainty, low, high, int(seed), threads)
    bottom, lanes = probability_lanes(march, log_max + reach, near)
    shift = Uncertainty(factor=uncertainty.factor, geometry=0.0)
    rows = [lane_factors(one, shift, reach, limit) for one in lanes]
    highest = min(max((one.top + reach for one in lanes if one is not None), default=0.0), log_max)
    first = math.floor(min(float(np.min(bottom)) - reach, 0.0) / LEVEL_STEP)
    places = np.arange(first, max(math.floor(highest / LEVEL_STEP + ROUNDING), 0) + 1)
    return OverturningProbability(
        **{one.name: np.array([row.found[one.name] for row in rows]) for one in fields(OverturningFactors)},
        level=np.exp(LEVEL_STEP * places),
        probability=np.array([row.at(places) for row in rows]),
        unresolved=np.array([0.0 if one is None else float(np.mean(one.unresolved)) for one in lanes]),
    )
