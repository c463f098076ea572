"""Distributions of the sequence parameters of a site, with intervals that know of common earthquakes.

.. note:: Channels of one earthquake are no independent observations, so everything here is a function of sums over
   events, and a resample draws whole events. Values are natural logarithms of parameters; weights (n,) are not negative
   and need no norm; events (n,) are numbers from 0 to g - 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import beta, chi2, norm, t

#: Sums of weights are rounded: a share of 0.84 may come out as a bit less.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Lognormal:
    """Weighted lognormal fit of p parameters."""

    median: np.ndarray  # (p,) exp of the mean of the logarithms; NaN without a value
    dispersion: np.ndarray  # (p,) standard deviation of the logarithms; NaN with too few values
    median_interval: np.ndarray  # (2, p) lower and upper ends; NaN for a single event
    dispersion_interval: np.ndarray  # (2, p) lower and upper ends; NaN for a single event


def fit_lognormal(
    logarithms: np.ndarray, weights: np.ndarray, events: np.ndarray, draws: np.ndarray, confidence: float
) -> Lognormal:
    """Median and dispersion of lognormal parameters with event-clustered bootstrap intervals.

    `logarithms` (n, p) are NaN where a record does not have the parameter; `draws` (b, g) tell how often each event is
    in each resample (:func:`event_draws`).

    Notes
    -----
    The dispersion is that of records of different events, half the weighted mean of (x_i - x_j)^2 over pairs from
    different events: free of bias however the variance is split into that between and that within events, where the
    usual estimator is not. With one event it is that within it. The interval of the median is
    :func:`bootstrap_interval` of the logarithm, that of the dispersion chi-square with degrees of freedom taken from
    the resamples.
    """
    once = np.ones((1, draws.shape[1]), dtype=int)
    mean, spread = (values[0] for values in log_moments(logarithms, weights, events, once))
    means, spreads = log_moments(logarithms, weights, events, draws)
    known = np.isfinite(logarithms)
    sizes = np.zeros((draws.shape[1], mean.size))
    np.add.at(sizes, events, weights[:, np.newaxis] * known)
    most = np.count_nonzero(known, axis=0) - 1
    median, dispersion = np.empty((2, 2, mean.size))
    for one in range(mean.size):
        size = sizes[:, one]
        median[:, one] = bootstrap_interval(mean[one], means[:, one], size, confidence)
        dispersion[:, one] = _dispersion_interval(
            spread[one], spreads[:, one], means[:, one], size, most[one], confidence
        )
    return Lognormal(np.exp(mean), spread, np.exp(median), dispersion)


def log_moments(
    logarithms: np.ndarray, weights: np.ndarray, events: np.ndarray, draws: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and dispersion (b, p) of logarithms in resamples of events; arguments as of :func:`fit_lognormal`.

    A row of ones among the draws stands for the sample itself. NaN where a resample holds no value, or too few for a
    dispersion.
    """
    known = np.isfinite(logarithms)
    values, share = np.where(known, logarithms, 0.0), weights[:, np.newaxis] * known
    sums = np.stack([share, share * values, share * values**2], axis=1)
    alone = draws.shape[1] == 1  # then the pairs are those of different records
    groups = np.arange(weights.size) if alone else events
    by_group = np.zeros((weights.size if alone else draws.shape[1], *sums.shape[1:]))
    np.add.at(by_group, groups, sums)
    times = np.repeat(draws, weights.size, axis=1) if alone else draws
    weight, first, second = np.moveaxis(np.tensordot(times, by_group, axes=1), 1, 0)
    size, one, two = by_group[:, 0], by_group[:, 1], by_group[:, 2]
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = first / weight
        pairs = weight**2 - times @ size**2
        square = (weight * second - first**2) - times @ (size * two - one**2)
        # Rounding makes neither a variance of equal values nor a number of no pairs.
        variance = np.where(square > 1e-13 * weight * second, square, 0.0) / np.where(
            pairs > 1e-12 * weight**2, pairs, np.nan
        )
    return mean, np.sqrt(variance)


def bootstrap_interval(
    estimate: float, resampled: np.ndarray, sizes: np.ndarray, confidence: float
) -> tuple[float, float]:
    """Lower and upper end of the interval of an estimate, from its values (b,) in resamples of events.

    A value is NaN where a resample holds none, inf where it has no bound; `sizes` (g,) is the weight of the records of
    each event. NaN where the estimate is not finite, and with a single event. The upper end is inf where more resamples
    are than the interval leaves out above.

    Notes
    -----
    Estimate -+ t_f sqrt(c) times the standard deviation of the resamples. A bootstrap of g events finds the variance
    too small by (g - 1)/g and does not know that it is an estimate (Hesterberg 2015, sections 3.2 and 4.4,
    doi:10.1080/00031305.2015.1089789). For events of shares s_g, each of one value, the mean of the resampled variance
    of their mean is 1/c = 1 - 2 sum s^3/sum s^2 + sum s^2 of the true one, and f + 1 = 1/sum s^2 is their effective
    number, at least 2. For the mean of g normal values of one weight the interval is Student's.
    """
    correction, student = _few_events(sizes, confidence)
    known = resampled[np.isfinite(resampled)]
    if known.size < 2 or not np.isfinite(estimate):
        return float("nan"), float("nan")
    half = student * np.sqrt(correction) * float(np.std(known))
    unbounded = np.mean(np.isinf(resampled)) > 0.5 * (1.0 - confidence)
    return float(estimate - half), float("inf") if unbounded else float(estimate + half)


def _few_events(sizes: np.ndarray, confidence: float) -> tuple[float, float]:
    """Factor on a bootstrap variance, and Student's t for the doubt about it; NaN for a single event."""
    shares = sizes[sizes > 0.0] / np.sum(sizes)
    if shares.size < 2:
        return float("nan"), float("nan")
    square = float(np.sum(shares**2))
    correction = 1.0 / (1.0 - 2.0 * float(np.sum(shares**3)) / square + square)
    return correction, float(t.ppf(0.5 * (1.0 + confidence), max(1.0 / square - 1.0, 1.0)))


def _dispersion_interval(
    dispersion: float, dispersions: np.ndarray, means: np.ndarray, sizes: np.ndarray, most: int, confidence: float
) -> tuple[float, float]:
    """Chi-square interval of a dispersion, its degrees of freedom from the resamples.

    The variance of the mean gives the effective number of independent records, s^2/var m, times (z/t)^2 for not
    knowing it, at least 1; the variance of the dispersion itself gives 2 s^4/var s^2, less where tails are heavy. The
    smaller of the two counts, and the number of records less one.
    """
    correction, student = _few_events(sizes, confidence)
    if not (np.isfinite(correction) and np.isfinite(dispersion) and dispersion > 0.0):
        return float("nan"), float("nan")
    level = 0.5 * (1.0 + confidence)
    of_mean = dispersion**2 / (np.nanvar(means) * correction) * (norm.ppf(level) / student) ** 2
    spread = np.nanvar(dispersions**2) * correction
    of_spread = 2.0 * dispersion**4 / spread if spread > 0.0 else np.inf
    freedom = min(max(of_mean, 1.0), of_spread, float(most))
    ends = np.sqrt(freedom / chi2.ppf([level, 1.0 - level], freedom))
    return float(dispersion * ends[0]), float(dispersion * ends[1])


def event_draws(events: int, resamples: int, seed: int) -> np.ndarray:
    """Counts of each of g events in each of b resamples: (b, g) whole numbers whose rows sum to g.

    The draws depend on the seed of the run and on g and b alone.
    """
    generator = np.random.default_rng(np.random.SeedSequence([seed, *b"site"]))
    return generator.multinomial(events, np.full(events, 1.0 / events), size=resamples)


def correlation(logarithms: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weighted correlation (p, p) of logarithms (n, p), over the records that have both parameters.

    The logarithms are NaN where a record does not have the parameter, the correlation where one of the two does not
    vary.

    Examples
    --------
    >>> correlation(np.log([[1.0, 2.0], [2.0, 4.0], [4.0, 8.0]]), np.ones(3)).round(6).tolist()
    [[1.0, 1.0], [1.0, 1.0]]
    """
    count = logarithms.shape[1]
    matrix = np.full((count, count), np.nan)
    for row in range(count):
        for column in range(row + 1):
            both = np.isfinite(logarithms[:, row]) & np.isfinite(logarithms[:, column]) & (weights > 0.0)
            if not np.any(both):
                continue
            pair = logarithms[both][:, [row, column]]
            if np.any(np.ptp(pair, axis=0) <= 1e-12 * (1.0 + np.abs(pair[0]))):
                continue
            pair = pair - np.average(pair, axis=0, weights=weights[both])
            covariance = pair.T @ (weights[both, np.newaxis] * pair)
            value = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
            matrix[row, column] = matrix[column, row] = np.clip(value, -1.0, 1.0)
    return matrix


def weighted_quantile(values: np.ndarray, level: float, weights: np.ndarray) -> float:
    """Smallest of the values (n,) with at least a share `level` of the weight at or below it; NaN without any.

    NaN values are left out.

    Examples
    --------
    >>> weighted_quantile(np.array([3.0, 1.0, 2.0]), 0.5, np.array([1.0, 1.0, 5.0]))
    2.0
    """
    known = np.isfinite(values) & (weights > 0.0)
    if not np.any(known):
        return float("nan")
    order = np.argsort(values[known])
    below = np.cumsum(weights[known][order])
    return float(values[known][order][np.searchsorted(below, (level - ROUNDING) * below[-1])])


def share_interval(
    hits: np.ndarray, weights: np.ndarray, events: np.ndarray, confidence: float
) -> tuple[float, float, float]:
    """A weighted share of hits (n,), from 0 to 1 each, with both ends of its event-clustered interval; n at least 1.

    The ends are NaN for a single event.

    Notes
    -----
    Korn and Graubard's interval (1998, Survey Methodology 24, 193-201): Clopper and Pearson's for the effective number
    of independent trials, s(1 - s)/var s with the variance of the ratio over events, times (z/t_(g-1))^2. Where all or
    nothing is covered the variance says nothing, and every event counts as one trial: no certainty from few events.
    """
    total = float(weights.sum())
    share = float(weights @ hits) / total
    names, place = np.unique(events, return_inverse=True)
    count = names.size
    if count < 2:
        return share, float("nan"), float("nan")
    residual = np.bincount(place, weights * (hits - share), count)
    variance = count / (count - 1.0) * float(residual @ residual) / total**2
    trials = share * (1.0 - share) / variance if variance > 1e-12 else float(count)
    level = 0.5 * (1.0 + confidence)
    trials *= float((norm.ppf(level) / t.ppf(level, count - 1)) ** 2)
    covered = share * trials
    lower = float(beta.ppf(1.0 - level, covered, trials - covered + 1.0)) if share > 1e-12 else 0.0
    upper = float(beta.ppf(level, covered + 1.0, trials - covered)) if share < 1.0 - 1e-12 else 1.0
    return share, lower, upper
