"""The integral of fragility over hazard: the annual frequency of a limit state, and the levels that contribute.

.. note:: With a fragility F(A + B u) over u = ln x and a hazard H, lambda = integral of F(A + B u) (-dH/du) du. It is
   summed by Gauss-Legendre nodes on short pieces between the bends of the hazard, and in closed form beyond them: far
   above its median a fragility is 1, and what is left is H; far below it a logistic one is an exponential.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from rockpulse.studies.fragility.likelihood import Family
from rockpulse.studies.risk.hazard import Hazard

__all__ = ["Integral", "integrate", "power_law_frequency"]

#: Nodes of a piece, and its length over the shortest length on which anything changes.
NODES, SHARE = 8, 0.5

#: Logarithm of what the tails are cut off at, and standard units beyond which a distribution is 0 or 1 to rounding.
TAIL, NORMAL_REACH, LOGISTIC_REACH = 30.0, 9.0, 40.0

#: Logarithm of a level that no ground reaches: a fragility that counts below its inverse has no frequency.
FARTHEST = 300.0


class Integral(NamedTuple):
    """A frequency, with the contributions of levels to it."""

    frequency: float  #: [1/year]; inf where the fragility falls less towards low levels than the hazard rises
    log_level: np.ndarray  #: (n,) nodes
    contribution: np.ndarray  #: (n,) of each to the frequency [1/year]

    def between(self, low: float, high: float) -> float:
        """Share of the frequency from levels between two logarithms [-]."""
        inside = (self.log_level >= low) & (self.log_level <= high)
        return float(np.sum(self.contribution[inside]) / np.sum(self.contribution))


def power_law_frequency(k0: float, k: float, median: float, beta: float) -> float:
    """The frequency by a power law and a lognormal fragility in closed form, k0 median^-k exp(k^2 beta^2/2) [1/year].

    `k0` and `median` are for levels in one unit. Cornell, C. A., Jalayer, F., Hamburger, R. O., Foutch, D. A. (2002),
    J. Struct. Eng. 128(4), doi:10.1061/(ASCE)0733-9445(2002)128:4(526).

    Examples
    --------
    >>> round(power_law_frequency(1e-4, 2.5, 0.6, 0.4), 9)
    0.000591247
    """
    return float(k0 * median**-k * np.exp(0.5 * (k * beta) ** 2))


def integrate(
    family: Family,
    line: tuple[float, float],
    hazard: Hazard,
    breaks: tuple[float, ...] = (),
    floor: float = -math.inf,
) -> Integral:
    """Sum a fragility over a hazard.

    Parameters
    ----------
    family : Family
        Normal or logistic.
    line : (float, float)
        A and B of the fragility in ln of the level, B > 0.
    hazard : Hazard
        Of the same measure, levels in SI units.
    breaks : tuple of float
        Logarithms of levels between which contributions are asked for.
    floor : float
        Logarithm of the level below which the fragility is zero, whatever its curve says.
    """
    a, b = line
    lowest, highest, steepest = float(hazard.slopes[0]), float(hazard.slopes[-1]), float(np.max(hazard.slopes))
    logistic, middle = family.deviation != 1.0, -a / b
    if logistic and floor == -math.inf and b <= lowest:
        return Integral(math.inf, np.zeros(0), np.zeros(0))
    # Below the median the integrand falls at least as exp((k - b) t), or exp(k t - (b t)^2/2).
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

    # In logarithms: far out one of the two is beyond the range of numbers.
    parts = (0.5 * widths * weights).ravel() * np.exp(fragility(u) + hazard.log_density(u))
    tops = np.array([first, last])
    low, high = np.exp(fragility(tops) + np.stack([hazard.log_density(tops)[0], hazard.log_rate(tops)[1]]))
    low = low * _decay(b - lowest, first - floor) if logistic else 0.0
    u, parts = np.concatenate([[first], u, [last]]), np.concatenate([[low], parts, [high]])
    return Integral(float(np.sum(parts)), u, parts)


def _decay(rate: float, length: float) -> float:
    """The integral of exp(-rate t) over t from 0 to a length, which may be infinite where the rate is positive."""
    if rate == 0.0:
        return length
    return 1.0 / rate if length == math.inf else -math.expm1(-rate * length) / rate
