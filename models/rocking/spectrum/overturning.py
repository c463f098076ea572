"""The overturning spectrum of a ground motion: the scale factors that overturn slender free-standing blocks.

.. note:: A block under the record times the scale factor f has x = f p/(g tan alpha) [s/m]. S(p, C) = exp(-mean ln x_c)
   [m/s], with x_c the random x at which the block overturns; under the unscaled record a block overturns if S exceeds
   g tan(alpha)/p. Uncertain scale factor and geometry shift ln x by a random Z of density h (:class:`Uncertainty`), so
   P(x) is a weighted mean of the outcomes v_i (1 if lane i overturns) of the lanes (sampled blocks, each with the
   weight w_i) whose C is in the range of the block:

   P(x) = sum_i w_i h(ln x_i - ln x) v_i/sum_i w_i h(ln x_i - ln x)

   (:mod:`rocking.spectrum.probability`). Between two frequency parameters P is linear in ln p.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.lanes import spread
from rocking.pictures import short_repr
from rocking.spectrum.probability import (
    NO_LANE,
    Uncertainty,
    factor_at,
    lane_moments,
    lane_probability,
    lane_sums,
    mean_capacity,
    rising,
    tail_masses,
)
from rocking.spectrum.slender_lanes import BEYOND, LEAST_RESTITUTION, RATES, SpectrumLanes

#: Levels of x are exp(LEVEL_STEP k) with integer k, the same numbers for all records.
LEVEL_STEP = 0.05
#: Truncation of the shift, in standard deviations.
REACH = 6.0
#: Standard normal quantile for 90 % intervals.
TWO_SIDED = 1.6448536269514722
#: Model error (similarity, interpolation in ln p) as a standard deviation of ln f, included in every interval
#: (docs/decisions/018).
INTERPOLATION = 0.02
#: Narrowest range of C that can be evaluated, divided by the range of C of the lanes [-].
LEAST_SHARE = 0.09
#: Smallest slenderness of a block for which the spectrum is valid (docs/decisions/018).
LEAST_SLENDERNESS = 3.5


@dataclass(frozen=True, eq=False)
class OverturningFactors:
    """Probability of overturning of (m,) blocks under a record, and scale factors at given probabilities.

    `_low` and `_high` are the ends of 90 % intervals. A scale factor above the end of the search is inf, and its `_low`
    is the end of the search.

    Attributes
    ----------
    at_one : (m,) ndarray
        Probability of overturning under the unscaled record [-].
    factor_10, factor_50 : (m,) ndarray
        Scale factor on the record at which the probability is 0.1, 0.5 [-].
    factor_mean : (m,) ndarray
        Geometric mean of the scale factor f at which the block overturns: exp of the mean of ln f, with P as the
        distribution function of ln f [-].

    Examples
    --------
    >>> factors = rocking.overturning_probability(pier, record.acceleration, record.dt)
    >>> factors.factor_10.round(1), factors.factor_50.round(1)
    (array([1.3]), array([2.3]))
    """

    __repr__ = short_repr

    at_one: np.ndarray
    at_one_low: np.ndarray
    at_one_high: np.ndarray
    factor_10: np.ndarray
    factor_10_low: np.ndarray
    factor_10_high: np.ndarray
    factor_50: np.ndarray
    factor_50_low: np.ndarray
    factor_50_high: np.ndarray
    factor_mean: np.ndarray
    factor_mean_low: np.ndarray
    factor_mean_high: np.ndarray

    def up_to(self, factor_max: float) -> Self:
        """Return a copy with scale factors above `factor_max` set to inf, and each `_low` limited to `factor_max`."""
        found: dict[str, np.ndarray] = {}
        for name in ("factor_10", "factor_50", "factor_mean"):
            for one in (name, f"{name}_high"):
                values = getattr(self, one)
                found[one] = np.where(values > factor_max, np.inf, values)
            found[f"{name}_low"] = np.minimum(getattr(self, f"{name}_low"), factor_max)
        return replace(self, **found)


def slender_bodies(block: Block) -> np.ndarray:
    """Return a mask (m,) of unrestrained bodies of slenderness 3.5 or more that are symmetric or beside a wall."""
    alone = ~np.asarray(block.restrained) & (np.asarray(block.symmetric) | (np.asarray(block.side) != 0))
    return alone & (np.asarray(block.weaker.slenderness) >= LEAST_SLENDERNESS * (1.0 - 1e-9))


def covered(
    block: Block,
    uncertainty: Uncertainty,
    p: np.ndarray = RATES,
    between: tuple[float, float] = (LEAST_RESTITUTION, 1.0),
    side: int = 0,
) -> np.ndarray:
    """Return a mask (m,) of slender bodies to which a spectrum of free blocks, or of blocks beside a wall, applies.

    Their p and their random restitutions must lie within the ranges of the sampled blocks of the spectrum; a range of C
    narrower than LEAST_SHARE of the covered range contains too few samples.
    """
    alone = slender_bodies(block) & (np.asarray(block.side) == side)
    return alone & slender_within(block.weaker, p) & covered_range(block.restitution, uncertainty, between)


def slender_within(block: Block, p: np.ndarray) -> np.ndarray:
    """Return a mask (m,) of blocks with slenderness of at least 3.5 and p in the range of ascending `p` (a,) [1/s]."""
    slender = np.asarray(block.slenderness) >= LEAST_SLENDERNESS * (1.0 - 1e-9)
    return slender & (np.asarray(block.p) >= p[0] * (1.0 - 1e-9)) & (np.asarray(block.p) <= p[-1] * (1.0 + 1e-9))


def covered_range(
    restitution: ArrayLike, uncertainty: Uncertainty, between: tuple[float, float] = (LEAST_RESTITUTION, 1.0)
) -> np.ndarray:
    """Return a mask (m,) of nominal C around which a spectrum with samples in `between` has enough samples.

    False for every C if the uncertainty lists measured values in place of the two limits of a uniform distribution.
    Restitutions above 1 count as 1.
    """
    nominal = np.atleast_1d(np.asarray(restitution, dtype=float))
    if len(uncertainty.restitution) != 2:
        return np.zeros(nominal.shape, dtype=bool)
    least, most = (share * nominal for share in uncertainty.restitution)
    wide = most - least >= LEAST_SHARE * (between[1] - between[0]) * (1.0 - 1e-9)
    most = np.minimum(most, 1.0)
    return wide & (least < most) & (least >= between[0] * (1.0 - 1e-9)) & (most <= between[1] * (1.0 + 1e-9))


class OverturningSpectrum:
    """The overturning spectrum of one record for a given uncertainty, from responses of slender blocks (lanes).

    Parameters
    ----------
    lanes, uncertainty : SpectrumLanes, Uncertainty
        Lanes of the record (:func:`rocking.spectrum_lanes`); each block has its own range of restitution.
    interpolation : float
        Model error that intervals include, as a standard deviation of ln f [-].
    threads : int, optional
        Number of threads that read it; None for all available cores. The results do not depend on it.

    Attributes
    ----------
    p, level : (a,) ndarray, (k,) ndarray
        Frequency parameters [1/s], and levels of x = f p/(g tan alpha) [s/m].

    Examples
    --------
    >>> spectrum = OverturningSpectrum(rocking.spectrum_lanes(record.acceleration, record.dt, [1.8, 2.2]))
    >>> spectrum.factors(rocking.Block([1.0], [4.0])).factor_10.round(1)
    array([1.3])
    """

    def __init__(
        self,
        lanes: SpectrumLanes,
        uncertainty: Uncertainty | None = None,
        interpolation: float = INTERPOLATION,
        threads: int | None = None,
    ) -> None:
        self.lanes, self.threads = lanes, threads
        self.interpolation = interpolation
        self.uncertainty: Uncertainty = uncertainty or Uncertainty()
        self.p: np.ndarray = lanes.p
        reach = REACH * self.uncertainty.spread
        self._first = int(np.floor((np.min(lanes.bottom) - reach) / LEVEL_STEP))
        last = int(np.ceil((np.max(lanes.top) + reach) / LEVEL_STEP))
        self._logs = LEVEL_STEP * np.arange(self._first, last + 1)
        self.level: np.ndarray = np.exp(self._logs)
        apart = self._logs[:, np.newaxis] - self._logs
        # Errors of P at two levels are correlated as far as they come from the same lanes.
        self._alike = np.exp(-((0.5 * apart / self.uncertainty.spread) ** 2))

    def probability(self, restitution: ArrayLike, rotation: ArrayLike = np.inf) -> np.ndarray:
        """Return the probability that abs(theta)/alpha exceeds `rotation`, shape (..., a, c, k) for p, C and x.

        `restitution` (c,) are nominal C, and the uncertainty gives their ranges; `rotation` (...) is ascending, and inf
        means overturning.
        Raises ValueError for a C whose range is not covered, for rotations that are not positive and ascending, and for
        a finite rotation if the lanes contain only outcomes.
        """
        states = np.asarray(rotation, dtype=float)
        if not np.all(np.diff(np.atleast_1d(states), prepend=0.0) > 0.0):
            raise ValueError(
                f"rotation: expected positive theta/alpha in ascending order (inf: overturning), got {rotation!r}"
            )
        if np.any(np.isfinite(states)) and np.any(np.isnan(self.lanes.peak)):
            raise ValueError(
                f"rotation: expected inf, because the spectrum was computed without rotations, got {rotation!r}"
            )
        parts = self._parts(restitution)
        least, most = (np.concatenate(ends) for ends in list(zip(*parts, strict=True))[1:])
        found = np.zeros((states.size, self.p.size, np.size(restitution), self.level.size))
        for place in range(self.p.size):
            of_parts = np.split(self._at(place, least, most, states.ravel())[0], len(parts), axis=1)
            found[:, place] = sum(part[0] * own for part, own in zip(parts, of_parts, strict=True))
        return found.reshape(*states.shape, *found.shape[1:])

    def spectrum(self, restitution: ArrayLike, rotation: ArrayLike = np.inf) -> np.ndarray:
        """Return the overturning spectrum S [m/s] (..., a, c) at each p, for nominal C (c,) and ascending rotations."""
        return 1.0 / mean_capacity(self.level, self.probability(restitution, rotation))

    def covers(self, block: Block) -> np.ndarray:
        """Return a mask (m,) of the blocks to which this spectrum applies (:func:`covered`)."""
        return covered(block, self.uncertainty, self.p, self.lanes.between, self.lanes.side)

    def factors(self, block: Block, factor_max: float = np.inf) -> OverturningFactors:
        """Compute P of (m,) covered blocks under the record, and scale factors up to `factor_max` (:meth:`read`)."""
        return self.read(block).factors(factor_max)

    def overturning(self, block: Block, factor: ArrayLike) -> np.ndarray:
        """Compute P of (m,) covered blocks under the record times factors (m, d) [-] (:meth:`read`)."""
        return self.read(block).overturning(factor)

    def read(self, block: Block) -> "SpectrumReading":
        """Read the probability of overturning of (m,) blocks from the spectrum.

        Raises ValueError for a block that the spectrum does not cover (:meth:`covers`).
        """
        outside = np.flatnonzero(~self.covers(block))
        block = block.weaker  # the corner about which a block beside a wall turns
        if outside.size:
            raise ValueError(
                f"block: the spectrum applies to free blocks of slenderness {LEAST_SLENDERNESS:g} or more, p from "
                f"{self.p[0]:g} to {self.p[-1]:g} 1/s and a range of C from {self.lanes.between[0]:g} to "
                f"{self.lanes.between[1]:g}, but not to {outside.size} of {np.size(block.p)} blocks, the first at "
                f"index {int(outside[0])}"
            )
        speed = np.asarray(block.gravity * np.tan(block.alpha_c) / block.p)
        own = self._between(np.asarray(block.p), np.asarray(block.restitution, dtype=float))
        return SpectrumReading(self._first, self.level, *own, speed, self._alike, self.interpolation)

    def _parts(self, restitution: ArrayLike) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return one or two parts of the random C, each as its share (r, 1) and the limits (r,) of C of the samples.

        Restitutions above 1 count as 1, which the samples up to BEYOND represent.
        """
        nominal = np.atleast_1d(np.asarray(restitution, dtype=float))
        lowest, highest = self.lanes.between
        if not np.all(covered_range(nominal, self.uncertainty, self.lanes.between)):
            raise ValueError(
                f"restitution: expected a nominal C whose random values, {self.uncertainty.restitution} times it, are "
                f"from {lowest:g} to {highest:g} and at least {LEAST_SHARE * (highest - lowest):.2g} apart, got "
                f"{restitution!r:.80}"
            )
        least, most = (share * nominal for share in self.uncertainty.restitution)
        over = np.clip((most - 1.0) / (most - least), 0.0, 1.0)[:, np.newaxis]
        inside = 1.0 - over, least, np.minimum(most, 1.0)
        one = np.ones(nominal.shape)
        return [inside, (over, one, BEYOND * one)] if np.any(over) else [inside]

    def _between(self, p: np.ndarray, restitution: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return P (m, k) of blocks, linear in ln p between the frequency parameters, and its standard error."""
        above = np.minimum(np.searchsorted(self.p, p), self.p.size - 1)
        below = above - 1  # for the first one this is the last, which has zero weight
        step = np.log(self.p[above] / self.p[below])
        share = np.clip(np.divide(np.log(p / self.p[below]), step, out=np.ones(p.size), where=step > 0.0), 0.0, 1.0)
        parts = self._parts(restitution)

        def at_rate(place: int, _: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            weight = np.where(below == place, 1.0 - share, 0.0) + np.where(above == place, share, 0.0)
            here = np.flatnonzero(weight)
            least, most = (np.concatenate([part[end][here] for part in parts]) for end in (1, 2))
            found = [np.split(one[0], len(parts)) for one in self._at(place, least, most, np.array([np.inf]))]
            weights = [weight[here, np.newaxis] * part[here] for part, _, _ in parts]
            own = sum(one * values for one, values in zip(weights, found[0], strict=True))
            return here, np.asarray(own), np.asarray(sum(one**2 * v for one, v in zip(weights, found[1], strict=True)))

        probability, variance = np.zeros((p.size, self.level.size)), np.zeros((p.size, self.level.size))
        places = np.union1d(above[share > 0.0], below[share < 1.0]).tolist()
        for here, own, spread_here in spread(at_rate, places, self.threads):
            probability[here] += own
            variance[here] += spread_here
        return probability, np.sqrt(variance)

    def _at(
        self, place: int, least: np.ndarray, most: np.ndarray, rotation: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return probabilities (h, r, k) of reaching h rotations at one p, for r ranges of C, and their variances."""
        lanes, reach = self.lanes, REACH * self.uncertainty.spread
        bottom, top, restitution = lanes.bottom[place], lanes.top[place], lanes.restitution[place]
        span = slice(*np.searchsorted(self._logs, [bottom - reach, top + reach]))
        own = self._logs[span]
        sides = np.searchsorted(restitution, least, "left"), np.searchsorted(restitution, most, "right")
        ends, places = np.unique(np.concatenate(sides), return_inverse=True)
        reached = np.sum(lanes.peak[place] >= rotation[:, np.newaxis], axis=0)
        lanes_here = lanes.log_x[place], lanes.weight[place], reached
        sums = lane_moments(*lanes_here, rotation.size, ends, own, self.uncertainty)
        inside = np.moveaxis(sums[places[least.size :]] - sums[places[: least.size]], 0, 2)
        (weight, square), hit, hit_square = inside[0], inside[1:, 0], inside[1:, 1]
        below, above = tail_masses(bottom, top, own, self.uncertainty)
        probability, variance = np.zeros((2, rotation.size, least.size, self._logs.size))
        probability[..., span], probability[..., span.stop :] = lane_probability(hit, weight, below, above), 1.0
        between = 1.0 - below - above
        part = np.divide(probability[..., span] - above, between, out=np.zeros(hit.shape), where=between > 0.0)
        spread = np.maximum(hit_square * (1.0 - 2.0 * part) + part**2 * square, 0.0)
        spread = np.divide(spread, weight**2, out=np.zeros(hit.shape), where=weight > NO_LANE)
        variance[..., span] = between**2 * spread
        return probability, variance


@dataclass(frozen=True, eq=False)
class SpectrumReading:
    """The probability of overturning of (m,) blocks as a function of x (:meth:`OverturningSpectrum.read`).

    Attributes
    ----------
    first, level : int, (k,) ndarray
        Number of the first level, and the levels x = exp(LEVEL_STEP (first + i)) [s/m].
    probability, error : (m, k) ndarray
        P, and its standard error [-].
    speed : (m,) ndarray
        g tan(alpha)/p of the blocks [m/s]; the scale factor is x times this speed.
    alike : (k, k) ndarray
        Correlation of the errors of P at two levels [-].
    interpolation : float
        Model error as a standard deviation of ln f [-].
    """

    __repr__ = short_repr

    first: int
    level: np.ndarray
    probability: np.ndarray
    error: np.ndarray
    speed: np.ndarray
    alike: np.ndarray
    interpolation: float

    def factors(self, factor_max: float = np.inf) -> OverturningFactors:
        """Return P under the record, and scale factors at given probabilities, inf above `factor_max`."""
        probability, error, speed = self.probability, self.error, self.speed
        # A higher probability means a lower factor; an interval ends at the outermost intersection of its band.
        upper = np.maximum.accumulate(np.minimum(probability + TWO_SIDED * error, 1.0), axis=1)
        lower = np.minimum.accumulate(np.maximum(probability - TWO_SIDED * error, 0.0)[:, ::-1], axis=1)[:, ::-1]
        at_one = -np.log(speed)[:, np.newaxis]
        middle, high, low = (
            (_read(self.first, own, at_one).ravel(), *(factor_at(at, self.level, rows) * speed for at in (0.1, 0.5)))
            for own, rows in ((probability, rising(probability)), (upper, upper), (lower, lower))
        )
        found = {"at_one": middle[0], "at_one_low": low[0], "at_one_high": high[0]}
        capacity = mean_capacity(self.level, probability) * speed
        # Summed in sequence, as in mean_capacity.
        of_mean = np.sqrt(np.cumsum(lane_sums(error, self.alike) * error, axis=1)[:, -1]) * LEVEL_STEP
        widths = [np.abs(np.log(end / value)) for end, value in zip(high[1:] + low[1:], middle[1:] * 2, strict=True)]
        for name, value, below, above in (
            ("factor_10", middle[1], widths[0], widths[2]),
            ("factor_50", middle[2], widths[1], widths[3]),
            ("factor_mean", capacity, TWO_SIDED * of_mean, TWO_SIDED * of_mean),
        ):
            found[name] = value
            found[f"{name}_low"] = value * np.exp(-np.hypot(below, TWO_SIDED * self.interpolation))
            found[f"{name}_high"] = value * np.exp(np.hypot(above, TWO_SIDED * self.interpolation))
        return OverturningFactors(**found).up_to(factor_max)

    def overturning(self, factor: ArrayLike) -> np.ndarray:
        """Return the probability that the blocks overturn under the record times factors (m, d) [-]."""
        at = np.log(np.asarray(factor, dtype=float) / self.speed[:, np.newaxis])
        return _read(self.first, self.probability, at)


def _read(first: int, probability: np.ndarray, log_x: np.ndarray) -> np.ndarray:
    """Interpolate the rows of P (m, k) at ln x (m, d); the first column of P is at the level exp(LEVEL_STEP first)."""
    place = log_x / LEVEL_STEP
    whole = np.clip(np.floor(place), first, first + probability.shape[1] - 2)
    share, below = np.clip(place - whole, 0.0, 1.0), whole.astype(int) - first
    rows = np.arange(log_x.shape[0])[:, np.newaxis]
    return np.asarray((1.0 - share) * probability[rows, below] + share * probability[rows, below + 1])
