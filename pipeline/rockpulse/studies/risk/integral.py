"""The annual frequency of a limit state as the integral of fragility and hazard, and its band over earthquakes.

.. note:: With a fragility F(A + B u) over u = ln x and a hazard H, lambda = integral of F(A + B u) (-dH/du) du. It is
   computed by Gauss-Legendre quadrature on short pieces between the changes of slope of the hazard, and in closed form
   beyond them: far above its median the fragility is 1, so that only H remains; far below it a logistic fragility is an
   exponential.

The band is a bootstrap-t over earthquakes, since records of one earthquake are not independent. Each bootstrap sample
has a frequency and, from leaving out each of its earthquakes in turn, a standard error; the quantiles of (ln lambda of
the sample - estimate)/standard error over the samples give the band of the estimate, without errors of the hazard.
Efron, B., Tibshirani, R. (1993), An Introduction to the Bootstrap, chapter 12.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp

from rockpulse.earthquakes import Limits, bootstrap_t_limits, draw_earthquakes, jackknife_error
from rockpulse.studies.fragility.curves import standardised
from rockpulse.studies.fragility.likelihood import Family, Observations, maximise
from rockpulse.studies.risk.hazard import Hazard

#: Number of nodes in each piece, and its length multiplied by the steepest slope of the fragility or the hazard.
NODES, SHARE = 8, 0.5
#: Logarithm at which tails are truncated, and arguments beyond which the distributions round to 0 or 1.
TAIL, NORMAL_REACH, LOGISTIC_REACH = 30.0, 9.0, 40.0
#: Logarithm of the largest level; if levels below its reciprocal contribute, the frequency is undetermined.
FARTHEST = 300.0
#: Smallest number of earthquakes for a band with correct coverage, and for any band.
LEAST_EVENTS, FEWEST_EVENTS = 14, 4
#: Arguments of the fragility at which the integral for bootstrap samples is summed, and their step.
STEP = 0.1
CAPACITY = np.arange(-60.0, 40.0, STEP)


class Integral(NamedTuple):
    """An annual frequency, and the contribution of each level to this frequency."""

    frequency: float  #: [1/year]; inf if the integral diverges at low levels
    log_level: np.ndarray  #: (n,) logarithms of the levels
    contribution: np.ndarray  #: (n,) contribution of each level to the frequency [1/year]

    def between(self, low: float, high: float) -> float:
        """Return the share of the frequency from levels whose logarithms are between `low` and `high`."""
        inside = (self.log_level >= low) & (self.log_level <= high)
        return float(np.sum(self.contribution[inside]) / np.sum(self.contribution))


def integrate(
    family: Family, line: tuple[float, float], hazard: Hazard, breaks: tuple[float, ...] = (), floor: float = -math.inf
) -> Integral:
    """Integrate the fragility F(A + B ln x) over a hazard; `line` is (A, B), and F is 0 for x below exp(`floor`)."""
    a, b = line
    lowest, highest, steepest = float(hazard.slopes[0]), float(hazard.slopes[-1]), float(np.max(hazard.slopes))
    logistic, middle = family.deviation != 1.0, -a / b
    if logistic and floor == -math.inf and b <= lowest:
        return Integral(math.inf, np.zeros(0), np.zeros(0))
    # At t below the median the integrand is at most exp((k - b) t), or exp(k t - (b t)^2/2).
    below = LOGISTIC_REACH / b if logistic else (lowest + math.sqrt(lowest**2 + 2.0 * TAIL * b**2)) / b**2
    above = (LOGISTIC_REACH if logistic else NORMAL_REACH) / b
    outer = [middle, *hazard.knots[:1], *hazard.knots[-1:], *(cut for cut in breaks if math.isfinite(cut))]
    first = max(min(*outer, middle - below), floor)
    if first < -FARTHEST:
        return Integral(math.inf, np.zeros(0), np.zeros(0))
    last = min(max(*outer, first) + min(above, TAIL / highest), FARTHEST)
    cuts = np.array([*hazard.knots, *breaks, middle - below, middle + above])
    cuts = np.unique([first, last, *cuts[(cuts > first) & (cuts < last)]])
    ends = [np.array([first])]
    for low, high in itertools.pairwise(cuts.tolist()):
        near = low >= middle - below and high <= middle + above
        step = SHARE / max(steepest, 1.0, b if near else 0.0)
        ends.append(np.linspace(low, high, math.ceil((high - low) / step) + 1)[1:])
    edges = np.concatenate(ends)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    widths = np.diff(edges)[:, np.newaxis]
    u = (edges[:-1, np.newaxis] + widths * (0.5 + 0.5 * nodes)).ravel()

    def fragility(at: np.ndarray) -> np.ndarray:
        return family.log_cdf(a + b * at)[0]

    # The sum is in logarithms, as one of the two factors is outside the range of floats in the tails.
    parts = (0.5 * widths * weights).ravel() * np.exp(fragility(u) + hazard.log_density(u))
    tops = np.array([first, last])
    low, high = np.exp(fragility(tops) + np.stack([hazard.log_density(tops)[0], hazard.log_rate(tops)[1]]))
    low = low * _decay(b - lowest, first - floor) if logistic else 0.0
    u, parts = np.concatenate([[first], u, [last]]), np.concatenate([[low], parts, [high]])
    return Integral(float(np.sum(parts)), u, parts)


def _decay(rate: float, length: float) -> float:
    """Return the integral of exp(-rate t) from 0 to `length`; `length` may be inf if the rate is positive."""
    if rate == 0.0:
        return length
    return 1.0 / rate if length == math.inf else -math.expm1(-rate * length) / rate


def fitted_lines(rows: Observations, family: Family) -> np.ndarray:
    """Return A and B of F(A + B ln x) as rows: fitted to all data, then with each earthquake left out in turn."""
    events = len(rows.events)
    return _lines(rows, family, np.vstack([np.ones(events), 1.0 - np.eye(events)]))


def _lines(rows: Observations, family: Family, weights: np.ndarray) -> np.ndarray:
    """Return A and B (q, 2) of F(A + B ln x), fitted with each row of `weights` (q, events); NaN if a fit fails."""
    u, centre, spread = standardised(np.log(rows.level))
    theta = maximise(family, np.stack([np.ones(u.size), u], axis=1), rows.kind, weights[:, rows.cluster] * rows.weight)
    return np.stack([theta[:, 0] - theta[:, 1] * centre / spread, theta[:, 1] / spread], axis=1)


def _frequencies(family: Family, lines: np.ndarray, hazard: Hazard, floor: float) -> np.ndarray:
    """Return ln of the frequencies for q fitted lines (A, B), accurate to 1e-4; NaN for B <= 0."""
    found = np.full(lines.shape[0], np.nan)
    rising = np.flatnonzero(lines[:, 1] > 0.0)
    density = family.log_density(CAPACITY)[0] + math.log(STEP)
    for part in np.array_split(rising, max(1, rising.size // 500)):
        a, b = lines[part, :1], lines[part, 1:]
        found[part] = logsumexp(hazard.log_rate(np.maximum((CAPACITY - a) / b, floor)) + density, axis=1)
    return found


def band_of(
    rows: Observations,
    family: Family,
    hazard: Hazard,
    lines: np.ndarray,
    estimate: float,
    confidence: float,
    resamples: int,
    seed: int,
    floor: float = -math.inf,
) -> Limits:
    """Return the bootstrap limits of the frequency exp(`estimate`); `lines` come from :func:`fitted_lines`."""
    events = len(rows.events)
    error = jackknife_error(_frequencies(family, lines, hazard, floor)[:, np.newaxis])[0]
    counts = draw_earthquakes(events, resamples, seed)
    fewer = np.maximum(counts[:, np.newaxis] - np.eye(events, dtype=int), 0)
    weights = np.concatenate([counts[:, np.newaxis], fewer], axis=1).reshape(-1, events)
    drawn = _frequencies(family, _lines(rows, family, weights), hazard, floor).reshape(resamples, -1)
    # Earthquakes that are not in a sample have no effect on its error.
    moved = np.where(counts > 0, drawn[:, 1:] - drawn[:, :1], 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.sqrt((events - 1) / events * np.sum(counts * moved**2, axis=1))
        return bootstrap_t_limits((drawn[:, 0] - estimate) / spread, estimate, error, confidence)
