"""Probability of overturning P(f) of any body under a record times f, from nonlinear responses of this body.

.. note:: The 90 % intervals are computed by resampling the lanes (random samples of a body and a scale factor) with
   replacement as if they were independent (Sobol points scatter less). If all n = (sum w)^2/sum w^2 effective lanes
   near the scale factor 1 have the same outcome, resampling gives no spread: the end of the interval is then the
   binomial bound for n equal outcomes, 1 - 0.05^(1/n).
"""

import math
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from rocking.arguments import ArrayLike, positive
from rocking.body.block import Block
from rocking.lanes import spread
from rocking.march.recorded import recorded_response
from rocking.pictures import short_repr
from rocking.search.capacity import uplift_scale
from rocking.spectrum.body_lanes import REACH, BodyLanes, LaneMarch, probability_lanes
from rocking.spectrum.overturning import OverturningFactors, slender_bodies
from rocking.spectrum.probability import Uncertainty, factor_at, lane_probability, lane_sums, mean_capacity, rising
from rocking.spectrum.slender_lanes import body_piece_lanes

#: Levels are exp(LEVEL_STEP k) with integer k, including 1, the same for all bodies.
LEVEL_STEP = 0.04
#: Number of resamples for an interval, and the quantiles at its ends.
RESAMPLES, LOW, HIGH = 200, 0.05, 0.95
#: Names of the scale factors derived from P, and the probability of each.
SHARES = {"factor_10": 0.1, "factor_50": 0.5}
#: A lane is near a level if its weight is at least this share of the largest weight there.
NEAR = 0.01
#: Rounding tolerance: a largest factor this close to a level counts as that level.
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
    """Compute scale factors and probability of overturning of one body from its samples (None if it never lifts)."""
    if lanes is None:
        nothing = np.zeros(RESAMPLES + 1)
        found = _interval("at_one", nothing)
        for name in (*SHARES, "factor_mean"):
            found |= _up_to(factor_max, _interval(name, nothing + np.inf))
        return LaneFactors(found, 0, np.zeros(1))
    logs, probability = _curve(lanes, shift, reach, _counts(lanes.over.size))
    first = round(logs[0] / LEVEL_STEP)
    fitted = rising(probability)
    level = np.exp(logs)
    found = _at_one(lanes, probability, first, shift)
    for name, share in SHARES.items():
        found |= _up_to(factor_max, _interval(name, factor_at(share, level, fitted)))
    capacity = _interval("factor_mean", mean_capacity(level, probability))
    if lanes.open:
        # P is unknown above the last level: the area above P up to this level gives a lower bound of the mean of ln f.
        least = np.exp(logs[0] + np.trapezoid(1.0 - probability, logs, axis=-1))
        capacity = {**dict.fromkeys(capacity, np.inf), "factor_mean_low": _interval("least", least)["least_low"]}
    return LaneFactors(found | _up_to(factor_max, capacity), first, probability[0])


def lane_capacity(lanes: BodyLanes, shift: Uncertainty, reach: float) -> tuple[float, float]:
    """Return the geometric mean, and the value at P = 10 %, of the scale factor at which one body overturns."""
    logs, probability = _curve(lanes, shift, reach, np.ones((1, lanes.over.size)))
    level = np.exp(logs)
    return float(mean_capacity(level, probability)[0]), float(factor_at(0.1, level, rising(probability))[0])


def _curve(lanes: BodyLanes, shift: Uncertainty, reach: float, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ln f (k,) at levels at which P of a body may be between 0 and 1, and P (r, k) there for r resamples."""
    first, last = _ends(lanes, reach)
    logs = LEVEL_STEP * np.arange(first, last + 1)
    bells, tails = lanes.sums(logs, shift)
    over, rest = (lane_sums(counts[:, own], bells[own]) for own in (lanes.over, ~lanes.over))
    return logs, lane_probability(over, over + rest, *tails)


def _ends(lanes: BodyLanes, reach: float) -> tuple[int, int]:
    """Return the numbers k of two levels: P is 0 below the first one, and 1 above the last one unless `lanes.open`."""
    lowest = np.min(lanes.log_factor, where=lanes.over, initial=lanes.top)
    highest = np.max(lanes.log_factor, where=~lanes.over, initial=lanes.bottom)
    end = lanes.top - reach if lanes.open else highest + reach
    first, last = math.floor((lowest - reach) / LEVEL_STEP), math.ceil(end / LEVEL_STEP)
    return min(first, last - 1), last


@lru_cache(maxsize=32)
def _counts(size: int) -> np.ndarray:
    """Return how often each sample is counted: once in the first row, at random in the RESAMPLES other rows."""
    drawn = np.random.default_rng(size).integers(size, size=(RESAMPLES, size))
    return np.array([np.ones(size), *(np.bincount(row, minlength=size) for row in drawn)], dtype=np.uint8)


def _interval(name: str, values: np.ndarray) -> dict[str, float]:
    """Return the first value, and the 5 % and 95 % quantiles of the other values as `_low` and `_high`."""
    low = np.quantile(values[1:], LOW, method="lower")
    high = np.quantile(values[1:], HIGH, method="higher")
    return {name: float(values[0]), f"{name}_low": float(low), f"{name}_high": float(high)}


def _up_to(factor_max: float, interval: dict[str, float]) -> dict[str, float]:
    """Set scale factors above `factor_max` to inf, and limit the lower end of the interval to `factor_max`."""
    return {
        name: min(value, factor_max) if name.endswith("_low") else value if value <= factor_max else math.inf
        for name, value in interval.items()
    }


def _at_one(lanes: BodyLanes, probability: np.ndarray, first: int, shift: Uncertainty) -> dict[str, float]:
    """Return P at the scale factor 1 and its interval; `probability` (r, k) has one row for each resample."""
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
    """Probability of overturning of (m,) bodies as a function of the scale factor on a record, computed for each body.

    Attributes
    ----------
    level : (k,) ndarray
        Scale factors on the record, ascending, from the lowest one that can lift a body; they include 1.
    probability : (m, k) ndarray
        Probability of overturning at the levels [-]: a weighted share of samples, which need not rise with the level.
    slender : (m,) ndarray of bool
        Whether a body was computed in the limit of slender blocks.
    unresolved : (m,) ndarray
        Share of the lanes that are UNRESOLVED (free flight) [-]; they count as overturning.

    Examples
    --------
    >>> found = rocking.overturning_probability(pier, record.acceleration, record.dt)
    >>> found.overturning([[1.0, 3.0]]).round(1)
    array([[0., 1.]])
    """

    __repr__ = short_repr

    level: np.ndarray
    probability: np.ndarray
    slender: np.ndarray
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
    slender_limit: bool = True,
    guess: ArrayLike | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> OverturningProbability:
    """Compute the probability that bodies overturn under a record times a scale factor, with the nonlinear equation.

    Parameters
    ----------
    block : Block
        One nominal body, with results of shape (1,), or an array of m bodies.
    acceleration, dt, vertical
        As for :func:`~rocking.recorded_response`; the scale factor multiplies both accelerations.
    uncertainty : Uncertainty, optional
        Uncertainty of scale factor, restitution and geometry; by default ``Uncertainty()``.
    factor_max : float
        Largest scale factor that is searched [-].
    slender_limit : bool
        Whether bodies of slenderness 3.5 or more without ties, loads or vertical acceleration are computed as slender
        blocks (linear equation), which gives more lanes at the same cost (docs/decisions/018); False for the nonlinear
        equation throughout.
    guess : (m,) array_like, optional
        Estimate of the scale factor at which a body overturns [-]. A good estimate saves computing time.
    seed : int
        Seed of the random numbers, not negative.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    OverturningProbability
        For (m,) bodies. A factor above `factor_max` is inf, and its `_low` is `factor_max` (for `factor_mean`, its
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
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed: expected a whole number of at least 0, got {seed!r}")
    near = None if guess is None else np.broadcast_to(positive("guess", guess, "of the record"), nominal.shape)
    # P at the largest factor, and at 1, needs lanes up to the largest random shift above it.
    log_max = max(math.log(limit), 0.0)
    reach = REACH * uncertainty.factor
    slender = slender_bodies(blocks) if slender_limit and up is None else np.zeros(nominal.shape, dtype=bool)
    bottom = np.log(uplift_scale(blocks.varied(REACH * uncertainty.geometry, nominal), ground, vertical=up))
    lanes: list[BodyLanes | None] = [None] * nominal.size
    reach = REACH * math.hypot(uncertainty.factor, uncertainty.geometry)
    for side in (0, 1, -1):
        here = np.flatnonzero(slender & (np.asarray(blocks.side) == side) & (bottom < log_max + reach))
        if here.size:
            bodies = blocks.take(here).weaker
            found = body_piece_lanes(
                float(dt) * np.arange(ground.size), ground, bodies, uncertainty, threads, side=side
            )
            for place, own in zip(here.tolist(), found, strict=True):
                lanes[place] = own
    if not slender.all():
        others = np.flatnonzero(~slender)
        march = LaneMarch(blocks.take(others), ground, float(dt), up, uncertainty, int(seed), threads)
        marched = probability_lanes(march, log_max + reach, None if near is None else near[others])
        for place, marched_lanes in zip(others.tolist(), marched, strict=True):
            lanes[place] = marched_lanes
    # The lanes of the nonlinear equation have random angles already.
    alone = Uncertainty(factor=uncertainty.factor, geometry=0.0)
    shifts = [uncertainty if limit_lanes else alone for limit_lanes in slender.tolist()]
    places = range(nominal.size)
    rows = list(spread(lambda place, _: lane_factors(lanes[place], shifts[place], reach, limit), places, threads))
    highest = min(max((one.top + reach for one in lanes if one is not None), default=0.0), log_max)
    first = math.floor(min(float(np.min(bottom)) - reach, 0.0) / LEVEL_STEP)
    levels = np.arange(first, max(math.floor(highest / LEVEL_STEP + ROUNDING), 0) + 1)
    return OverturningProbability(
        **{one.name: np.array([row.found[one.name] for row in rows]) for one in fields(OverturningFactors)},
        level=np.exp(LEVEL_STEP * levels),
        probability=np.array([row.at(levels) for row in rows]),
        slender=slender,
        unresolved=np.array([0.0 if one is None else float(np.mean(one.unresolved)) for one in lanes]),
    )
