"""Probability at one, factors of 10 and 50 % and mean capacity, read off the lanes of a body, with intervals of 90 %.

.. note:: The intervals draw the lanes again, with replacement and as if they were independent (those of a Sobol set
   scatter less), and go from the 5th to the 95th percentile. Where all lanes near the factor one agree, drawing them
   again shows nothing: the end of its interval is that of n tosses that agree, 1 - 0.05^(1/n), with the effective
   number n of lanes there, (sum w)^2/sum w^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from rocking.crossing import factor_at, mean_capacity, rising
from rocking.lane_march import BodyLanes
from rocking.lane_probability import Shift, lane_probability, lane_sums

__all__ = ["LEVEL_STEP", "LaneFactors", "lane_factors"]

#: Levels are exp(LEVEL_STEP k), k whole: 1 is one of them, and all bodies have the same.
LEVEL_STEP = 0.04

#: Draws of the lanes for an interval, and the shares of them below its ends.
RESAMPLES, LOW, HIGH = 200, 0.05, 0.95

#: Factors that are read off P, and the probability at each.
SHARES = {"factor_10": 0.1, "factor_50": 0.5}

#: Share of the most that a lane counts at a level, from which on it is near it.
NEAR = 0.01


@dataclass(frozen=True, eq=False)
class LaneFactors:
    """What the lanes of one body tell.

    Attributes
    ----------
    found : dict
        `at_one`, `factor_10`, `factor_50` and `capacity_mean`, each with `_low` and `_high` [-].
    first : int
        The lowest level is exp(LEVEL_STEP first).
    probability : (k,) ndarray
        P from that level on, fitted so that it never falls [-]: 0 below, and above the same as at the last one.
    """

    found: dict[str, float]
    first: int
    probability: np.ndarray

    def at(self, places: np.ndarray) -> np.ndarray:
        """P at the levels exp(LEVEL_STEP k), k the given places [-]."""
        own = np.clip(places - self.first, 0, self.probability.size - 1)
        return np.where(places < self.first, 0.0, self.probability[own])


def lane_factors(lanes: BodyLanes | None, shift: Shift, reach: float, factor_max: float) -> LaneFactors:
    """Read the factors of one body off its lanes.

    Parameters
    ----------
    lanes : BodyLanes or None
        Of the body; None where no draw of it lifts off.
    shift : Shift
        Distribution of the shift of ln f.
    reach : float
        Shift of ln f beyond which there is no mass worth counting.
    factor_max : float
        Largest factor that is asked for [-]: what is above it is inf.
    """
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
        # P is not known above the last level: at least as far as it the capacity is the area over it.
        least = np.exp(logs[0] + np.trapezoid(1.0 - probability, logs, axis=-1))
        capacity = {**dict.fromkeys(capacity, np.inf), "capacity_mean_low": _interval("least", least)["least_low"]}
    return LaneFactors(found | _up_to(factor_max, capacity), first, probability[0])


def _ends(lanes: BodyLanes, reach: float) -> tuple[int, int]:
    """First and last k of the levels that show something: below them P is 0, above them 1 unless lanes are open."""
    lowest = np.min(lanes.log_factor, where=lanes.over, initial=lanes.top)
    highest = np.max(lanes.log_factor, where=~lanes.over, initial=lanes.bottom)
    end = lanes.top - reach if lanes.open else highest + reach
    first, last = math.floor((lowest - reach) / LEVEL_STEP), math.ceil(end / LEVEL_STEP)
    return min(first, last - 1), last


@cache
def _counts(size: int) -> np.ndarray:
    """How often each of the lanes is drawn: once each in the first row, then in each of the RESAMPLES."""
    drawn = np.random.default_rng(size).multinomial(size, np.full(size, 1.0 / size), size=RESAMPLES)
    return np.vstack([np.ones(size), drawn])


def _interval(name: str, values: np.ndarray) -> dict[str, float]:
    """The first of the values, and the ends of the interval of the others."""
    low = np.quantile(values[1:], LOW, method="lower")
    high = np.quantile(values[1:], HIGH, method="higher")
    return {name: float(values[0]), f"{name}_low": float(low), f"{name}_high": float(high)}


def _up_to(factor_max: float, interval: dict[str, float]) -> dict[str, float]:
    """Factors above the largest one are inf; the low end is no larger than that one."""
    return {
        name: min(value, factor_max) if name.endswith("_low") else value if value <= factor_max else math.inf
        for name, value in interval.items()
    }


def _at_one(lanes: BodyLanes, probability: np.ndarray, first: int, shift: Shift) -> dict[str, float]:
    """P at the factor one and its interval, from P (r, k) of the lanes and of all draws of them."""
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
