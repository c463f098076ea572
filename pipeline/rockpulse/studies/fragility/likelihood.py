"""Observations of capacities (exact, above or below a level), and maximum-likelihood fits of fragility curves.

.. note:: The logarithm x of a capacity has the distribution F(a + b x), F normal or logistic. A known capacity adds log
   f(a + b x) + log b to the log-likelihood, a capacity above x (the limit state was not reached at x) adds log (1 - F),
   and a capacity not above x adds log F. Incremental analysis, truncated or not, and stripes have the same likelihood.
   The likelihood is concave in (a, b) (Olsen 1978): Newton's method with halved steps finds its only maximum.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy.special import expit, log_expit, log_ndtr, ndtr

from rockpulse.errors import ConfigError

#: Kinds of observations: the capacity equals the level, is above it, or is not above it.
EXACT, ABOVE, NOT_ABOVE = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Observations:
    """Observed capacities in one intensity measure, sorted by level; each is exact, above its level or not above it."""

    level: np.ndarray  # (n,) the capacity, or the level with which it is compared; positive
    kind: np.ndarray  # (n,) EXACT, ABOVE or NOT_ABOVE
    cluster: np.ndarray  # (n,) index of the event of each row
    record: np.ndarray  # (n,) index of the record of each row
    events: tuple[str, ...]  # labels of the events, sorted
    qualities: np.ndarray  # (n, c) positive properties tested for an effect on capacity; NaN if unknown
    weight: np.ndarray  # (n,) weight of each row; the mean is one

    @classmethod
    def of(
        cls, level: Any, kind: Any, clusters: Any = None, records: Any = None, qualities: Any = None, weight: Any = None
    ) -> Self:
        """Return observations made from arrays; by default each row has weight one, its own event and its own record.

        Raises ConfigError for levels that are not positive and finite, or arrays of different lengths.
        """
        level, kind = np.asarray(level, dtype=float), np.asarray(kind, dtype=np.int64)
        if level.ndim != 1 or not np.all(np.isfinite(level) & (level > 0.0)):
            raise ConfigError(f"fragility: expected (n,) positive, finite levels, got {level!r:.80}")
        alone = [f"{number:09d}" for number in range(level.size)]
        rows = [np.asarray(alone if labels is None else labels, dtype=str) for labels in (clusters, records)]
        if {kind.shape, *(labels.shape for labels in rows)} != {level.shape}:
            raise ConfigError(
                f"fragility: expected one level, kind, event and record per row, got {level.size}, {kind.size}, "
                f"{rows[0].size} and {rows[1].size}"
            )
        (events, cluster), (_, record) = (np.unique(labels, return_inverse=True) for labels in rows)
        order = np.lexsort((record, cluster, kind, level))  # makes sums independent of the given order of the rows
        beside = np.empty((level.size, 0)) if qualities is None else np.asarray(qualities, dtype=float)
        counts = (
            np.ones(level.size)
            if weight is None or not level.size
            else np.asarray(weight, dtype=float) / np.mean(weight)
        )
        labels = tuple(map(str, events))
        return cls(level[order], kind[order], cluster[order], record[order], labels, beside[order], counts[order])

    @property
    def records(self) -> int:
        """Number of different records."""
        return int(np.unique(self.record).size)

    def only(self, kept: np.ndarray) -> "Observations":
        """Return the observations selected by a mask, with only the events that still occur among them."""
        clusters = np.array(self.events, dtype=str)[self.cluster]
        rows = (clusters, self.record.astype(str), self.qualities, self.weight)
        return Observations.of(self.level[kept], self.kind[kept], *(values[kept] for values in rows))

    def without_each_event(self) -> np.ndarray:
        """Return weights (1 + events, rows) of the rows: first for all events, then with each event left out."""
        left = self.cluster != np.arange(len(self.events))[:, None]
        return np.vstack([np.ones((1, self.level.size)), left]) * self.weight


#: Largest numbers of Newton steps and of halvings of a step, and step that ends the search, in standard errors.
STEPS, HALVINGS, CLOSE = 60, 30, 1e-8
#: Rounding error of a sum of logarithms, and largest usable condition number of the second derivatives.
ROUNDING, LARGEST_CONDITION = 1e-12, 1e14


@dataclass(frozen=True)
class Family:
    """A symmetric probability distribution for the logarithm of capacity."""

    cdf: Callable[[np.ndarray], np.ndarray]  # F(z)
    # z -> value and first two derivatives of log f
    log_density: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    # z -> value and first two derivatives of log F; log (1 - F(z)) = log F(-z)
    log_cdf: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    deviation: float  # standard deviation of z [-]


def _normal_density(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return -0.5 * z * z - 0.5 * np.log(2.0 * np.pi), -z, np.full_like(z, -1.0)


def _normal_cdf(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    value = log_ndtr(z)
    slope = np.exp(-0.5 * z * z - 0.5 * np.log(2.0 * np.pi) - value)
    return value, slope, -slope * (z + slope)


def _logistic_density(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    up, down = expit(z), expit(-z)
    return log_expit(z) + log_expit(-z), down - up, -2.0 * up * down


def _logistic_cdf(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    up, down = expit(z), expit(-z)
    return log_expit(z), down, -up * down


#: Distribution for each value of ``[fragility] model``.
FAMILIES: dict[str, Family] = {
    "lognormal": Family(ndtr, _normal_density, _normal_cdf, 1.0),
    "logistic": Family(expit, _logistic_density, _logistic_cdf, float(np.pi / np.sqrt(3.0))),
}


def has_maximum(x: np.ndarray, kind: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return a mask of the data sets whose likelihood has a maximum at finite a and b, so that a curve exists.

    `x` (n,) are the logarithms of levels and `kind` (n,) their kinds; each row of `weights` (q, n) is one data set.
    Without exact capacities, the levels reached and not reached must overlap (Albert & Anderson 1984). With exact
    capacities, there is no maximum only if these are all equal and no other observation contradicts their value.
    """

    def extremes(of: int) -> tuple[np.ndarray, np.ndarray]:
        active = (weights > 0.0) & (kind == of)
        return np.min(np.where(active, x, np.inf), axis=1), np.max(np.where(active, x, -np.inf), axis=1)

    (known_low, known_high), (above_low, above_high) = extremes(EXACT), extremes(ABOVE)
    below_low, below_high = extremes(NOT_ABOVE)
    overlap = (below_low < above_high) & (above_low < below_high)
    spread = (known_high > known_low) | (above_high > known_high) | (below_low < known_low)
    return np.where(np.isfinite(known_low), spread, overlap)


def scores(
    family: Family, design: np.ndarray, kind: np.ndarray, theta: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the log-likelihood of each row, and its first two derivatives in z without the term log b, as (q, n).

    `design` (n, k) has the columns 1, ln x and any covariates; z = design @ theta. `theta` (q, k) are the parameters
    (a, b, ...) of q data sets; b must be positive if a row is EXACT.
    """
    z = theta @ design.T
    value, slope, bend = np.empty_like(z), np.empty_like(z), np.empty_like(z)
    exact, above, below = (np.flatnonzero(kind == of) for of in (EXACT, ABOVE, NOT_ABOVE))
    if exact.size:
        value[:, exact], slope[:, exact], bend[:, exact] = family.log_density(z[:, exact])
        value[:, exact] += np.log(np.maximum(theta[:, 1:2], np.finfo(float).tiny))
    value[:, above], slope[:, above], bend[:, above] = family.log_cdf(-z[:, above])
    slope[:, above] *= -1.0
    value[:, below], slope[:, below], bend[:, below] = family.log_cdf(z[:, below])
    return value, slope, bend


def maximise(family: Family, design: np.ndarray, kind: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return maximum-likelihood parameters (q, k) of q data sets, the rows of `weights` (q, n); NaN if none exist."""
    theta = np.zeros((weights.shape[0], design.shape[1]))
    theta[:, 1] = 1.0
    exact = np.where(kind == EXACT, 1.0, 0.0)
    found = np.zeros(theta.shape[0], dtype=bool)
    left = np.flatnonzero(has_maximum(design[:, 1], kind, weights))
    for _ in range(STEPS):
        if left.size == 0:
            break
        w, at = weights[left], theta[left]
        known = w @ exact
        value, slope, bend = scores(family, design, kind, at)
        total = np.sum(w * value, axis=1)
        gradient = (w * slope) @ design
        gradient[:, 1] += known / at[:, 1]
        information = np.einsum("qn,ni,nj->qij", -w * bend, design, design, optimize=True)
        information[:, 1, 1] += known / at[:, 1] ** 2
        regular = np.linalg.cond(information) < LARGEST_CONDITION
        left, w, at, known, total = (part[regular] for part in (left, w, at, known, total))
        gradient, information = gradient[regular], information[regular]
        step = np.linalg.solve(information, gradient[:, :, None])[:, :, 0]
        near = np.einsum("qi,qi->q", step, gradient) <= CLOSE**2
        found[left[near]] = True
        left, w, at, known, total, step = (part[~near] for part in (left, w, at, known, total, step))
        share = np.ones(left.size)
        for _ in range(HALVINGS):
            to = at + share[:, None] * step
            inside = (known == 0.0) | (to[:, 1] > 0.0)
            to[~inside, 1] = 1.0
            better = inside & (np.sum(w * scores(family, design, kind, to)[0], axis=1) >= total - ROUNDING * abs(total))
            if np.all(better):
                break
            share[~better] *= 0.5
        theta[left] = at + share[:, None] * step
    theta[~found] = np.nan
    return theta
