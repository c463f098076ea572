"""Statistics over earthquakes: resampling, intervals and weighted quantiles.

.. note:: Records of one earthquake are not independent: resamples draw whole earthquakes, and a jackknife leaves out
one earthquake at a time. Weights (n,) are not negative; `events` (n,) are the indices of the earthquakes, from 0;
`draws` (b, g) give how often each resample contains each earthquake; `estimates` (1 + K, ...) contain first the
estimate from all data, then one estimate for each of K earthquakes, without that earthquake.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

#: Confidence level of the interval of a probability [-]; smallest number of earthquakes without a special warning.
CONFIDENCE = 0.9
FEWEST_EVENTS = 3
#: Weight of each of the two prior earthquakes in the interval of a mean probability, in earthquakes.
PRIOR = 0.5
#: Tolerance for rounding errors in sums of weights, which may make a share of 0.84 slightly smaller.
ROUNDING = 1e-9
#: Largest share of bootstrap-t samples that may be NaN.
LOST = 0.1


def members(events: Sequence[str] | np.ndarray) -> np.ndarray:
    """Return a mask (g, n) of the records that belong to each of g earthquakes, sorted by label."""
    names, place = np.unique(np.asarray(events), return_inverse=True)
    return np.asarray(place == np.arange(names.size)[:, np.newaxis])


def mean_weights(events: Sequence[str] | np.ndarray) -> np.ndarray:
    """Return weights (g, n) of n records in the means of each of g earthquakes."""
    own = members(events)
    return np.asarray(own / own.sum(axis=1, keepdims=True))


def draw_earthquakes(events: int, resamples: int, seed: int | Sequence[int]) -> np.ndarray:
    """Return how often each random resample contains each earthquake, (resamples, events)."""
    return np.random.default_rng(seed).multinomial(events, np.full(events, 1.0 / events), size=resamples)


def weighted_quantile(values: np.ndarray, level: float, weights: np.ndarray) -> float:
    """Return the weighted quantile at a level from 0 to 1; NaN if no value with a weight is finite."""
    known = np.isfinite(values) & (weights > 0.0)
    if not np.any(known):
        return math.nan
    order = np.argsort(values[known])
    below = np.cumsum(weights[known][order])
    return float(values[known][order][np.searchsorted(below, (level - ROUNDING) * below[-1])])


def probability_interval(values: Any, count: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of the interval of the mean of probabilities (g, ...) of g earthquakes; NaN if unknown.

    The Bayesian bootstrap (Rubin 1981, doi:10.1214/aos/1176345338) gives the earthquakes random weights, with two prior
    earthquakes of weight PRIOR, of probability 0 and 1, so that equal values do not give a certain mean. The ends are
    quantiles of the beta distribution with the mean and the variance of the weighted mean, which is exact for values of
    0 and 1. `count` is the number of earthquakes if it is not g.

    >>> [round(float(end), 3) for end in probability_interval(np.zeros(10))]
    [0.0, 0.171]
    """
    from scipy.special import betaincinv

    values, tail = np.asarray(values, dtype=float), 0.5 * (1.0 - CONFIDENCE)
    known = ~np.isnan(values)
    groups = known.sum(axis=0)
    number = groups if count is None else np.where(groups > 0, count, 0)
    total = number + 2.0 * PRIOR
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(known, values, 0.0).sum(axis=0) / groups
        centre = (number * mean + PRIOR) / total
        square = np.where(known, (values - centre) ** 2, 0.0).sum(axis=0) * number / groups
        variance = (square + PRIOR * (centre**2 + (1.0 - centre) ** 2)) / (total * (total + 1.0))
        size = centre * (1.0 - centre) / variance - 1.0
        low, high = (betaincinv(centre * size, (1.0 - centre) * size, end) for end in (tail, 1.0 - tail))
    return np.where(mean <= ROUNDING, 0.0, np.minimum(low, mean)), np.where(
        mean >= 1.0 - ROUNDING, 1.0, np.maximum(high, mean)
    )


def share_interval(
    hits: np.ndarray, weights: np.ndarray, events: np.ndarray, confidence: float
) -> tuple[float, float, float]:
    """Return the weighted mean of hits (n,) from 0 to 1, and its confidence limits (NaN for a single earthquake).

    Korn and Graubard's interval (1998, Survey Methodology 24, 193-201) is Clopper and Pearson's interval for the
    effective number of independent trials, s(1 - s)/var s times (z/t_(g-1))^2, with the variance of the share s over
    earthquakes. For s = 0 or 1 this variance is zero, and the number of trials is the number of earthquakes, so
    that few earthquakes give a wide interval.
    """
    from scipy.stats import beta, norm, t

    total = float(weights.sum())
    share = float(weights @ hits) / total
    names, place = np.unique(events, return_inverse=True)
    count = names.size
    if count < 2:
        return share, math.nan, math.nan
    residual = np.bincount(place, weights * (hits - share), count)
    variance = count / (count - 1.0) * float(residual @ residual) / total**2
    trials = share * (1.0 - share) / variance if variance > 1e-12 else float(count)
    level = 0.5 * (1.0 + confidence)
    trials *= float((norm.ppf(level) / t.ppf(level, count - 1)) ** 2)
    hit = share * trials
    lower = float(beta.ppf(1.0 - level, hit, trials - hit + 1.0)) if share > 1e-12 else 0.0
    upper = float(beta.ppf(level, hit + 1.0, trials - hit)) if share < 1.0 - 1e-12 else 1.0
    return share, lower, upper


def bootstrap_interval(
    estimate: float, resampled: np.ndarray, sizes: np.ndarray, confidence: float
) -> tuple[float, float]:
    """Return the confidence limits of an estimate from its values in resamples; `sizes` are weights of earthquakes.

    The limits are the estimate +- t_f sqrt(c) times the standard deviation of the resamples. A bootstrap of g
    earthquakes gives a variance that is too small by the factor (g - 1)/g and neglects the uncertainty of this variance
    (Hesterberg 2015, sections 3.2 and 4.4, doi:10.1080/00031305.2015.1089789). For earthquakes with weights s_g and one
    value each, the bootstrap variance of their mean is on average 1/c = 1 - 2 sum s^3/sum s^2 + sum s^2 times the true
    variance, and f + 1 = 1/sum s^2 is their effective number, at least 2. The limits are NaN without finite values, and
    infinite if the share of infinite resamples exceeds the upper tail.
    """
    correction, student = _few_earthquakes(sizes, confidence)
    known = resampled[np.isfinite(resampled)]
    if known.size < 2 or not np.isfinite(estimate):
        return math.nan, math.nan
    half = student * np.sqrt(correction) * float(np.std(known))
    unbounded = np.mean(np.isinf(resampled)) > 0.5 * (1.0 - confidence)
    return float(estimate - half), math.inf if unbounded else float(estimate + half)


def _few_earthquakes(sizes: np.ndarray, confidence: float) -> tuple[float, float]:
    """Return the factor c that corrects a bootstrap variance, and Student's t; both are NaN for a single earthquake."""
    from scipy.stats import t

    shares = sizes[sizes > 0.0] / np.sum(sizes)
    if shares.size < 2:
        return math.nan, math.nan
    square = float(np.sum(shares**2))
    correction = 1.0 / (1.0 - 2.0 * float(np.sum(shares**3)) / square + square)
    return correction, float(t.ppf(0.5 * (1.0 + confidence), max(1.0 / square - 1.0, 1.0)))


class Quantiles(NamedTuple):
    """One quantile of each of k quantities over records, with confidence limits (NaN for a single earthquake)."""

    value: np.ndarray  # (k,)
    lower: np.ndarray  # (k,)
    upper: np.ndarray  # (k,)


def record_quantiles(
    values: np.ndarray,
    levels: list[float],
    logarithmic: bool,
    *,
    weights: np.ndarray,
    events: np.ndarray,
    draws: np.ndarray,
    confidence: float,
) -> list[Quantiles]:
    """Return the weighted quantiles of n records at each level; `logarithmic` computes their limits from logarithms."""
    flat = values.reshape(values.shape[0], -1)
    found = np.empty((len(levels), 3, flat.shape[1]))
    sizes = np.bincount(events, weights)
    drawn = draws[:, events] * weights
    for column in range(flat.shape[1]):
        order = np.argsort(flat[:, column], kind="stable")
        ordered = flat[order, column]
        below, of_draws = np.cumsum(weights[order]), np.cumsum(drawn[:, order], axis=1)
        for row, level in enumerate(levels):
            share = level - ROUNDING
            value = ordered[np.searchsorted(below, share * below[-1])]
            # The number of cumulative weights below the share is the number of records below the quantile.
            resampled = ordered[np.sum(of_draws < share * of_draws[:, -1:], axis=1)]
            if logarithmic:
                ends = np.exp(bootstrap_interval(np.log(value), np.log(resampled), sizes, confidence))
            else:
                ends = np.array(bootstrap_interval(float(value), resampled, sizes, confidence))
            found[row, :, column] = value, *ends
    return [Quantiles(*one) for one in found.reshape(len(levels), 3, *values.shape[1:])]


class Limits(NamedTuple):
    """Confidence limits from the bootstrap-t (NaN if too many samples are NaN), and the share of NaN samples."""

    low: float
    high: float
    lost: float


def bootstrap_t_limits(scores: np.ndarray, estimate: float, error: float, confidence: float) -> Limits:
    """Return limits of exp(estimate); a score is (sample - estimate)/(standard error of the bootstrap sample)."""
    known = scores[np.isfinite(scores)]
    lost = 1.0 - known.size / scores.size
    if lost > LOST or not (np.isfinite(error) and error > 0.0):
        return Limits(math.nan, math.nan, lost)
    high, low = np.quantile(known, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
    return Limits(math.exp(estimate - low * error), math.exp(estimate - high * error), lost)


def jackknife_error(estimates: np.ndarray) -> np.ndarray:
    """Return the jackknife standard error of each quantity; row 0 is from all data, other rows omit an earthquake."""
    events = estimates.shape[0] - 1
    return np.asarray(np.sqrt((events - 1) / events * np.sum((estimates[1:] - estimates[0]) ** 2, axis=0)))


def jackknife_half_width(estimates: np.ndarray, confidence: float) -> np.ndarray:
    """Return half the width of the confidence interval of each quantity: Student's t times the jackknife error."""
    from scipy.special import stdtrit

    return np.asarray(stdtrit(estimates.shape[0] - 2, 0.5 + 0.5 * confidence) * jackknife_error(estimates))


def lognormal_mean_half_width(values: np.ndarray, confidence: float) -> np.ndarray:
    """Return half the width (m,) of the confidence interval of ln(mean) of m lognormal quantities over k earthquakes.

    With s^2 the variance of the logarithms, the variance of ln of the mean is s^2/k + s^4/(2 (k - 1)) (Cox, in Land
    1972, Technometrics 14(1), 145-158); its square root is multiplied by Student's t with k - 1 degrees of freedom.
    """
    from scipy.special import stdtrit

    count = values.shape[1]
    variance = np.var(np.log(values), axis=1, ddof=1)
    error = np.sqrt(variance / count + variance**2 / (2.0 * (count - 1)))
    return np.asarray(stdtrit(count - 1, 0.5 + 0.5 * confidence) * error)


@dataclass(frozen=True, eq=False)
class Lognormal:
    """Weighted lognormal fit of p parameters: medians, dispersions and confidence limits."""

    median: np.ndarray  # (p,) exp of the mean of the logarithms; NaN without a value
    dispersion: np.ndarray  # (p,) standard deviation of the logarithms; NaN with too few values
    median_interval: np.ndarray  # (2, p) lower and upper ends; NaN for a single earthquake
    dispersion_interval: np.ndarray  # (2, p) lower and upper ends; NaN for a single earthquake


def fit_lognormal(
    logarithms: np.ndarray, weights: np.ndarray, events: np.ndarray, draws: np.ndarray, confidence: float
) -> Lognormal:
    """Fit median and dispersion of lognormal parameters from their logarithms (n, p), NaN for missing values.

    The squared dispersion is half the weighted mean of (x_i - x_j)^2 over pairs of records of different earthquakes:
    unlike the usual estimator it is unbiased for any split of the variance between and within earthquakes. For a single
    earthquake, its own pairs of records are used. The interval of the median is the :func:`bootstrap_interval` of the
    logarithm; the interval of the dispersion is chi-square with degrees of freedom from the resamples.
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
    """Return the means and standard deviations (b, p) of logarithms in b resamples; NaN if too few values are known."""
    known = np.isfinite(logarithms)
    values, share = np.where(known, logarithms, 0.0), weights[:, np.newaxis] * known
    sums = np.stack([share, share * values, share * values**2], axis=1)
    alone = draws.shape[1] == 1  # a single earthquake: use pairs of its records
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
        # Rounding errors must not give a variance to equal values, nor a result without pairs.
        variance = np.where(square > 1e-13 * weight * second, square, 0.0) / np.where(
            pairs > 1e-12 * weight**2, pairs, np.nan
        )
    return mean, np.sqrt(variance)


def _dispersion_interval(
    dispersion: float, dispersions: np.ndarray, means: np.ndarray, sizes: np.ndarray, most: int, confidence: float
) -> tuple[float, float]:
    """Return the chi-square interval of a dispersion, with degrees of freedom from the resamples.

    The variance of the mean gives the effective number of records, s^2/var m, times (z/t)^2, at least 1; the variance
    of s^2 gives 2 s^4/var s^2, which is smaller for heavy tails. The degrees of freedom are the smaller of the two, and
    at most the number of records minus one.
    """
    from scipy.stats import chi2, norm

    correction, student = _few_earthquakes(sizes, confidence)
    if not (np.isfinite(correction) and np.isfinite(dispersion) and dispersion > 0.0):
        return math.nan, math.nan
    level = 0.5 * (1.0 + confidence)
    of_mean = dispersion**2 / (np.nanvar(means) * correction) * (norm.ppf(level) / student) ** 2
    spread = np.nanvar(dispersions**2) * correction
    of_spread = 2.0 * dispersion**4 / spread if spread > 0.0 else np.inf
    freedom = min(max(of_mean, 1.0), of_spread, float(most))
    ends = np.sqrt(freedom / chi2.ppf([level, 1.0 - level], freedom))
    return float(dispersion * ends[0]), float(dispersion * ends[1])
