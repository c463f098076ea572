"""The profile and interval of each parameter of the sequence, and the parameters of which the targets tell nothing.

.. note:: The profile of a parameter is the smallest deviance 2 (ln L_max - ln L) among all candidates that share its
   value, about; a parameter is flat where its profile stays below the threshold of the confidence level over all that
   was searched. Intervals are of the posterior (:mod:`rockpulse.calibration.response_posterior`). `share` is the factor
   on ln of the likelihood [-].
"""

from __future__ import annotations

import math

import numpy as np
from scipy import stats

from rockpulse.calibration.response_posterior import Posterior
from rockpulse.calibration.response_search import INTERVAL, MAIN_COUNT, RATIO, Explored, SearchSpace

__all__ = [
    "PARAMETERS",
    "correlations",
    "deviance_threshold",
    "flat_ends",
    "intervals",
    "likeliest_counts",
    "main_counts",
    "parameter_values",
    "profiles",
]

#: Names, units and words of the parameters.
PARAMETERS = {
    "main": ("m/s", "main impulse"),
    "ratio": ("", "I_s/I"),
    "interval": ("s", "interval dT of the secondary impulses"),
    "main_count": ("", "number of main impulses"),
}

#: Parts into which the range of a profile is divided.
PARTS = 24

#: Candidates beyond this deviance are not shown in a profile.
SHOWN = 20.0


def parameter_values(space: SearchSpace, points: np.ndarray) -> dict[str, np.ndarray]:
    """(q,) values of each parameter of (q, 4) points; dT is NaN where the spacing has none."""
    interval = np.exp(points[:, INTERVAL]) if space.spacing != "continuous" else np.full(len(points), np.nan)
    return {
        "main": space.main(points),
        "ratio": points[:, RATIO],
        "interval": interval,
        "main_count": np.rint(points[:, MAIN_COUNT]),
    }


def deviance_threshold(count: int, confidence: float) -> float:
    """Deviance within which one parameter is believed, for n peaks that are numbers and a confidence level [-].

    It is n ln(1 + t^2/(n - 4)) with the two-sided t of n - 4 degrees of freedom: exact for a linear model of four
    parameters with an estimated spread, the quantile of chi-squared with one degree of freedom for many blocks.

    Examples
    --------
    >>> round(deviance_threshold(20, 0.9), 3), round(deviance_threshold(100_000, 0.9), 3)
    (3.488, 2.706)
    """
    free = count - len(PARAMETERS)
    return float(count * math.log1p(stats.t.ppf(0.5 * (1.0 + confidence), free) ** 2 / free))


def profiles(explored: Explored, share: float = 1.0) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The profile of each parameter: values (k,), rising, and the smallest deviance (k,) found there [-].

    Each deviance is that of a candidate: the true profile lies at or below it.
    """
    points, likelihood = explored.points, explored.likelihood
    deviance = 2.0 * share * (likelihood.max() - likelihood)
    near = deviance <= SHOWN
    found = {}
    for name, values in parameter_values(explored.space, points[near]).items():
        if np.any(np.isnan(values)):
            found[name] = (np.empty(0), np.empty(0))
            continue
        scale = np.log(values) if name in ("main", "interval") else values
        whole = name == "main_count"
        width = 1.0 if whole else max(np.ptp(scale) / PARTS, 1e-12)
        part = np.floor((scale - scale.min()) / width)
        order = np.lexsort((deviance[near], part))
        _, firsts = np.unique(part[order], return_index=True)
        best = order[firsts]
        found[name] = (values[best], deviance[near][best])
    return found


def intervals(space: SearchSpace, posterior: Posterior, confidence: float) -> dict[str, tuple[float, float]]:
    """Central posterior interval (low, high) of each parameter; NaN without dT.

    For the main count it is that of :func:`likeliest_counts`.
    """
    levels = np.array([0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)])
    found = {}
    for name, values in parameter_values(space, posterior.points).items():
        low, high = posterior.quantiles(values, levels)
        found[name] = (float(low), float(high))
    return {**found, "main_count": likeliest_counts(main_counts(posterior), confidence)}


def likeliest_counts(shares: dict[int, float], confidence: float) -> tuple[float, float]:
    """Lowest and highest of the likeliest numbers of main impulses whose joint probability is nearest to a level.

    `shares` is the probability of each number [-]. No set of whole numbers holds just the level. Quantiles hold at
    least that, mostly far more, and cover too often.

    Examples
    --------
    >>> likeliest_counts({3: 0.05, 4: 0.70, 5: 0.23, 6: 0.02}, 0.9), likeliest_counts({8: 0.14, 9: 0.86}, 0.9)
    ((4.0, 5.0), (9.0, 9.0))
    """
    numbers, probabilities = np.array(list(shares)), np.array(list(shares.values()))
    order = np.argsort(-probabilities, kind="stable")
    nearest = np.argmin(np.abs(np.cumsum(probabilities[order]) - confidence))
    inside = numbers[order[: nearest + 1]]
    return float(inside.min()), float(inside.max())


def main_counts(posterior: Posterior) -> dict[int, float]:
    """Posterior probability of each number of main impulses that was sampled, the number rising."""
    numbers = np.rint(posterior.points[:, MAIN_COUNT]).astype(np.int64)
    shares = np.bincount(numbers, weights=posterior.weights)
    return {int(number): float(shares[number]) for number in np.unique(numbers)}


def flat_ends(explored: Explored, threshold: float, share: float = 1.0) -> dict[str, tuple[bool, bool]]:
    """Whether the likely values of I_s/I, dT and the main count reach the lower and the upper limit of the search."""
    space, points = explored.space, explored.points
    likely = points[2.0 * share * (explored.likelihood.max() - explored.likelihood) <= threshold]
    ends = {}
    for name, column in (("ratio", RATIO), ("interval", INTERVAL), ("main_count", MAIN_COUNT)):
        margin = 0.0 if column == MAIN_COUNT else (space.high[column] - space.low[column]) / PARTS
        low, high = space.low[column] + margin, space.high[column] - margin
        ends[name] = (bool(likely[:, column].min() <= low), bool(likely[:, column].max() >= high))
    return ends


def correlations(space: SearchSpace, posterior: Posterior) -> dict[tuple[str, str], float]:
    """Correlation of every two parameters in the posterior, of the logarithms of I and dT [-]."""
    values = parameter_values(space, posterior.points)
    columns = {
        name: np.log(value) if name in ("main", "interval") else value
        for name, value in values.items()
        if not np.any(np.isnan(value))
    }
    names = list(columns)
    matrix = np.cov(np.array([columns[name] for name in names]), aweights=posterior.weights)
    deviation = np.sqrt(np.diag(matrix))
    found = {}
    for i, one in enumerate(names):
        for j in range(i):
            scale = deviation[i] * deviation[j]
            found[names[j], one] = float(matrix[i, j] / scale) if scale > 0.0 else 0.0
    return found
