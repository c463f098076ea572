"""Fragility curves by maximum likelihood: capacities that are known, above a level, or below one.

.. note:: The logarithm x of a capacity has the distribution F(a + b x), F normal or logistic. A capacity that is known
   adds log f(a + b x) + log b to the log-likelihood; one that is above x (the limit state was not reached there) adds
   log (1 - F), and one that is not above x adds log F. Incremental analysis, its truncated form and stripes are one
   likelihood. It is concave in (a, b) (Olsen 1978), so that Newton's method with halved steps finds its only maximum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import expit, log_expit, log_ndtr, ndtr

from rockpulse.studies.fragility.observations import ABOVE, EXACT, NOT_ABOVE

__all__ = ["FAMILIES", "Family", "has_maximum", "maximise", "scores"]

#: Most Newton steps, most halvings of one, and the step at which the search ends, in units of the standard error.
STEPS, HALVINGS, CLOSE = 60, 30, 1e-8

#: Rounding of a sum of logarithms, and the condition of the second derivatives beyond which they say nothing.
ROUNDING, LARGEST_CONDITION = 1e-12, 1e14


@dataclass(frozen=True)
class Family:
    """A symmetric distribution of the logarithm of capacity."""

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


#: Distributions by the word of ``[fragility] model``.
FAMILIES: dict[str, Family] = {
    "lognormal": Family(ndtr, _normal_density, _normal_cdf, 1.0),
    "logistic": Family(expit, _logistic_density, _logistic_cdf, float(np.pi / np.sqrt(3.0))),
}


def has_maximum(x: np.ndarray, kind: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Whether (q,) the likelihood has a maximum at finite a, b, that is, the data do not separate.

    `x` (n,) are logarithms of capacities or levels, `kind` (n,) is EXACT, ABOVE or NOT_ABOVE, and `weights` (q, n) tell
    how often each row counts, in q data sets. Without exact capacities both kinds of rows have to overlap (Albert &
    Anderson 1984). With some, b grows without limit only where they are all equal and no other row speaks against that
    value.
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
    """Log-likelihood of each row, and its first two derivatives by z (those of log b apart), each (q, n).

    `design` (n, k) has the columns 1, ln x and any covariates: z = design @ theta; `kind` (n,) is EXACT, ABOVE or
    NOT_ABOVE; `theta` (q, k) are the parameters (a, b, ...) of q data sets, b > 0 where a row is EXACT.
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
    """Parameters (q, k) of largest likelihood for q weightings (q, n) of the same rows; see :func:`scores`.

    The columns of the design but the first are centred, of the order of one. NaN where there is no maximum or the
    search did not find it.
    """
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
