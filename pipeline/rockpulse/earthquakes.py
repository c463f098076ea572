"""Statistics over earthquakes: resampling, intervals and weighted quantiles.

.. note:: Records of one earthquake are not independent: resamples draw whole earthquakes, and a jackknife leaves out
one earthquake at a time. `weights` (n,) of n records are not negative; `events` (n,) are the indices of their
earthquakes, from 0; `draws` (b, g) contain how often each of b resamples contains each of g earthquakes; `estimates`
(1 + K, ...) contain first the estimate from all data, then K estimates, each without one of K earthquakes.
"""

import math
from collections.abc import Sequence
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
    """Return a mask (g, n): row i is True for the records of earthquake i, in the order of the earthquakes' labels."""
    names, place = np.unique(np.asarray(events), return_inverse=True)
    return np.asarray(place == np.arange(names.size)[:, np.newaxis])


def mean_weights(events: Sequence[str] | np.ndarray) -> np.ndarray:
    """Return weights (g, n): row i averages the values of n records over the records of earthquake i."""
    own = members(events)
    return np.asarray(own / own.sum(axis=1, keepdims=True))


def draw_earthquakes(events: int, resamples: int, seed: int | Sequence[int]) -> np.ndarray:
    """Return how often each random resample contains each earthquake, (resamples, events)."""
    return np.random.default_rng(seed).multinomial(events, np.full(events, 1.0 / events), size=resamples)


def weighted_quantile(values: np.ndarray, level: float, weights: np.ndarray) -> float:
    """Return the weighted quantile at the probability `level`; NaN if no value with a weight is finite."""
    known = np.isfinite(values) & (weights > 0.0)
    if not np.any(known):
        return math.nan
    order = np.argsort(values[known])
    below = np.cumsum(weights[known][order])
    return float(values[known][order][np.searchsorted(below, (level - ROUNDING) * below[-1])])


def probability_interval(values: Any, count: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of the 90 % interval of the mean of probabilities (g, ...) over g earthquakes; NaN is ignored.

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


def bootstrap_interval(
    estimate: float, resampled: np.ndarray, sizes: np.ndarray, confidence: float
) -> tuple[float, float]:
    """Return the confidence limits of an estimate from its values in resamples; `sizes` (g,) are earthquake weights.

    The limits are the estimate +- t_f sqrt(c) times the standard deviation of the resamples. A bootstrap of g
    earthquakes gives a variance that is too small by the factor (g - 1)/g and neglects the uncertainty of this variance
    (Hesterberg 2015, sections 3.2 and 4.4, doi:10.1080/00031305.2015.1089789). For earthquakes with weights s_g and one
    value each, the bootstrap variance of their mean is on average 1/c = 1 - 2 sum s^3/sum s^2 + sum s^2 times the true
    variance, and f + 1 = 1/sum s^2 is their effective number, at least 2. The limits are NaN without finite values or
    for a single earthquake, and infinite if the share of infinite resamples exceeds the upper tail.
    """
    from scipy.stats import t

    shares, known = sizes[sizes > 0.0] / np.sum(sizes), resampled[np.isfinite(resampled)]
    if shares.size < 2 or known.size < 2 or not np.isfinite(estimate):
        return math.nan, math.nan
    square = float(np.sum(shares**2))
    correction = 1.0 / (1.0 - 2.0 * float(np.sum(shares**3)) / square + square)
    student = float(t.ppf(0.5 * (1.0 + confidence), max(1.0 / square - 1.0, 1.0)))
    half = student * np.sqrt(correction) * float(np.std(known))
    unbounded = np.mean(np.isinf(resampled)) > 0.5 * (1.0 - confidence)
    return float(estimate - half), math.inf if unbounded else float(estimate + half)


class Quantiles(NamedTuple):
    """A quantile of each of k quantities over records, with confidence limits (NaN for a single earthquake)."""

    value: np.ndarray  # (k,)
    lower: np.ndarray  # (k,)
    upper: np.ndarray  # (k,)


def record_quantiles(
    values: np.ndarray,
    levels: list[float],
    predictive: bool,
    *,
    weights: np.ndarray,
    events: np.ndarray,
    draws: np.ndarray,
    confidence: float,
) -> list[Quantiles]:
    """Return quantiles of values (n, ...) of n records, at each probability in `levels`, with confidence limits.

    Predictive quantiles (`predictive`) allow for the small number of earthquakes, and need positive values.

    The q-quantile of the values of g earthquakes is exceeded by another earthquake with a probability above 1 - q.
    The i-th smallest of g independent values is exceeded with the probability 1 - i/(g + 1) (Gumbel 1958, section
    1.2.7). With cumulative weights W in earthquakes the probability of a value of weight w is (W - w/2 + 1/2)/(g +
    1); logarithms are interpolated linearly between values, and limits computed from logarithms. g is the effective
    number of earthquakes, (sum s)^2/sum s^2 for earthquakes of weight s.
    """
    flat = values.reshape(values.shape[0], -1)
    flat = np.log(flat) if predictive else flat
    found = np.empty((len(levels), 3, flat.shape[1]))
    sizes = np.bincount(events, weights)
    once = np.ones((1, draws.shape[1]))
    drawn = np.concatenate([once, draws])[:, events] * weights
    count = np.sum(sizes) ** 2 / np.sum(sizes**2)
    for column in range(flat.shape[1]):
        order = np.argsort(flat[:, column], kind="stable")
        ordered, below = flat[order, column], np.cumsum(np.take(drawn, order, axis=1), axis=1)
        for row, level in enumerate(levels):
            # The number of cumulative weights below the share is the number of records below the quantile.
            if predictive:
                each = _interpolated(ordered, below, (level * (count + 1.0) - 0.5) / count)
            else:
                each = ordered[np.count_nonzero(below < (level - ROUNDING) * below[:, -1:], axis=1)]
            found[row, :, column] = each[0], *bootstrap_interval(float(each[0]), each[1:], sizes, confidence)
    found = np.exp(found) if predictive else found
    return [Quantiles(*one) for one in found.reshape(len(levels), 3, *values.shape[1:])]


def _interpolated(ordered: np.ndarray, below: np.ndarray, level: float) -> np.ndarray:
    """Return the quantile at probability `level` of ascending values (n,) in b resamples, given cumulative weights."""
    rows, most = np.arange(below.shape[0]), below.shape[1] - 1

    def start(place: np.ndarray) -> np.ndarray:
        return np.where(place > 0, below[rows, place - 1], 0.0)

    def middle(place: np.ndarray) -> np.ndarray:
        return np.asarray(0.5 * (start(place) + below[rows, place]))

    def first_above(weight: np.ndarray) -> np.ndarray:
        return np.asarray(np.count_nonzero(below < weight[:, np.newaxis], axis=1))

    target = level * below[:, -1]
    at = np.minimum(first_above(target), most)
    # Previous and next drawn record; a record that is not drawn leaves the cumulative weight unchanged.
    before = np.where(start(at) > 0.0, first_above(start(at) * (1.0 - ROUNDING)), at)
    after = first_above(below[rows, at] * (1.0 + ROUNDING))
    after = np.where(after <= most, after, at)
    early = middle(at) >= target
    low, high = np.where(early, before, at), np.where(early, at, after)
    width = middle(high) - middle(low)
    part = np.divide(target - middle(low), width, out=np.zeros(rows.size), where=width > 0.0)
    return np.asarray(ordered[low] + part * (ordered[high] - ordered[low]))


class Limits(NamedTuple):
    """Confidence limits from the bootstrap-t (NaN if too many samples are NaN), and the share of NaN samples."""

    low: float
    high: float
    lost: float


def bootstrap_t_limits(scores: np.ndarray, estimate: float, error: float, confidence: float) -> Limits:
    """Return confidence limits of exp(estimate) from scores, (sample - estimate)/(standard error of the sample)."""
    known = scores[np.isfinite(scores)]
    lost = 1.0 - known.size / scores.size
    if lost > LOST or not (np.isfinite(error) and error > 0.0):
        return Limits(math.nan, math.nan, lost)
    high, low = np.quantile(known, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
    return Limits(math.exp(estimate - low * error), math.exp(estimate - high * error), lost)


def jackknife_error(estimates: np.ndarray) -> np.ndarray:
    """Return the jackknife standard error of each quantity; `estimates` are described in the note of this module."""
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
