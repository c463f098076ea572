"""Quality of a demand as predictor of capacity: bias, scatter, coefficient and predicted outcomes.

.. note:: For a perfect demand ln(demand x capacity) is 0 in every case. Cases of one earthquake are not independent.
   All earthquakes therefore have the same weight, each with all its cases, and intervals come from resampling
   earthquakes. A capacity that was not reached by the largest scale factor is known only from below (censored). `error`
   (n,) is this logarithm, `weight` (n,) the weight, `events` (n,) the label of the earthquake and `bodies` (n,) that of
   the body of each case.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize
from scipy.stats import norm

#: Resamples of the bootstrap.
RESAMPLES = 1000
#: Confidence of the intervals [-].
CONFIDENCE = 0.95


def alike(events: np.ndarray) -> np.ndarray:
    """Weights (n,) with which earthquakes weigh alike, of mean one.

    Examples
    --------
    >>> alike(np.array(["a", "b", "b"])).tolist()
    [1.5, 0.75, 0.75]
    """
    _, place, count = np.unique(events, return_inverse=True, return_counts=True)
    weight = 1.0 / count[place]
    return np.asarray(weight / np.mean(weight)) if weight.size else weight


def coefficient(error: np.ndarray, open_ended: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Centre and standard deviation of normal errors (n,), of which some are known from below only.

    They are the most likely ones, each case with its weight; an `open_ended` case counts by the probability of an error
    above the given one.

    Examples
    --------
    >>> centre, spread = coefficient(np.array([0.1, 0.3]), np.array([False, False]), np.ones(2))
    >>> round(centre, 4), round(spread, 4)
    (0.2, 0.1)
    """
    known = ~open_ended
    start = float(np.average(error[known], weights=weight[known]))
    scatter = float(np.sqrt(np.average((error[known] - start) ** 2, weights=weight[known])))
    if np.all(known) or scatter == 0.0:
        return start, scatter

    def unlikeliness(at: np.ndarray) -> float:
        score = (error - at[0]) / np.exp(at[1])
        return -float(np.sum(weight * np.where(open_ended, norm.logsf(score), norm.logpdf(score) - at[1])))

    found = minimize(unlikeliness, np.array([start, np.log(scatter)]), method="L-BFGS-B").x
    return float(found[0]), float(np.exp(found[1]))


def weighted_median(values: np.ndarray, weight: np.ndarray) -> float:
    """The value with half the weight below it.

    Examples
    --------
    >>> weighted_median(np.array([1.0, 2.0, 9.0]), np.array([1.0, 1.0, 1.0]))
    2.0
    """
    order = np.argsort(values)
    half = np.searchsorted(np.cumsum(weight[order]), 0.5 * np.sum(weight))
    return float(values[order][min(half, values.size - 1)])


def dispersion(error: np.ndarray, weight: np.ndarray, bodies: np.ndarray | None = None) -> float:
    """Standard deviation of errors [-]; with `bodies` about the mean of each body.

    Examples
    --------
    >>> errors, bodies = np.array([0.1, 0.3, 1.1, 1.3]), np.array([0, 0, 1, 1])
    >>> round(dispersion(errors, np.ones(4)), 3), round(dispersion(errors, np.ones(4), bodies), 3)
    (0.589, 0.141)
    """
    labels = np.zeros(error.size, dtype=int) if bodies is None else np.unique(bodies, return_inverse=True)[1]
    whole = np.bincount(labels, weight)
    centre = np.bincount(labels, weight * error) / whole
    left = error.size - whole.size
    if left < 1:
        return float("nan")
    share = np.sum(weight * (error - centre[labels]) ** 2) / np.sum(weight)
    return float(np.sqrt(share * error.size / left))


def missed_and_false(alarm: np.ndarray, over: np.ndarray) -> tuple[float, float]:
    """Share of the overturnings without an alarm, and of the survivors with one [-]; NaN where there are none."""
    missed = float(np.mean(~alarm[over])) if np.any(over) else float("nan")
    return missed, float(np.mean(alarm[~over])) if np.any(~over) else float("nan")


def false_at(scores: np.ndarray, over: np.ndarray, share: float) -> float:
    """False alarms [-] at the highest limit that misses no more than a share of the overturnings [-].

    Examples
    --------
    >>> false_at(np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, False, True]), 0.0)
    0.5
    """
    fallen = np.sort(scores[over])
    if not fallen.size or np.all(over):
        return float("nan")
    limit = fallen[int(share * fallen.size * (1.0 + 1e-12))]
    return float(np.mean(scores[~over] >= limit))


def resampled(
    events: np.ndarray, statistic: Callable[[np.ndarray], float], seed: int = 0, resamples: int = RESAMPLES
) -> np.ndarray:
    """A statistic (b,) over resamples of the earthquakes, each with all its cases.

    `statistic` takes the indices of the cases drawn, (k,) int. All calls with one seed see the same resamples.
    """
    labels = np.unique(events)
    members = [np.flatnonzero(events == label) for label in labels]
    random = np.random.default_rng(np.random.SeedSequence([seed, *b"rule"]))
    drawn = random.integers(labels.size, size=(resamples, labels.size))
    return np.array([statistic(np.concatenate([members[event] for event in draw])) for draw in drawn])


def between(values: np.ndarray) -> tuple[float, float]:
    """Both ends of the percentile interval of 95 %; NaN where fewer than half of the resamples have a value."""
    known = values[np.isfinite(values)]
    if known.size < 0.5 * max(values.size, 1):
        return float("nan"), float("nan")
    low, high = np.quantile(known, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE])
    return float(low), float(high)
