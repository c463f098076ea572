"""The integral of fragility over hazard: the annual frequency of a limit state, and the levels that contribute.

.. note:: With a fragility F(A + B u) over u = ln x and a hazard H, lambda = integral of F(A + B u) (-dH/du) du. It is
   summed by Gauss-Legendre nodes on short pieces, between the slopes of the hazard, as far out as the tails matter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rockpulse.studies.fragility.likelihood import Family
from rockpulse.studies.risk.hazard import Hazard

__all__ = ["Integral", "integrate", "power_law_frequency"]

#: Nodes of a piece, its length over the shortest length on which anything changes, and most pieces.
NODES, SHARE, MOST_PIECES = 8, 0.5, 20_000

#: Logarithm of what the tails are cut off at.
TAIL = 30.0


class Integral(NamedTuple):
    """Frequencies of q fragilities, with the contributions of levels to the first of them."""

    frequency: np.ndarray  #: (q,) [1/year]; inf where the tail of the fragility is heavier than the hazard is steep
    log_level: np.ndarray  #: (n,) nodes
    contribution: np.ndarray  #: (n,) of each to the first frequency [1/year]

    def between(self, low: float, high: float) -> float:
        """Share of the first frequency from levels between two [-]."""
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
    family: Family, line: np.ndarray, hazard: Hazard, breaks: tuple[float, ...] = (), floor: float = -math.inf
) -> Integral:
    """Sum fragilities over a hazard.

    Parameters
    ----------
    family : Family
        Normal or logistic.
    line : (q, 2) ndarray
        A and B of each fragility in ln of the level, B > 0.
    hazard : Hazard
        Of the same measure, levels in SI units.
    breaks : tuple of float
        Logarithms of levels between which contributions are asked for.
    floor : float
        Logarithm of the level below which the fragility is zero, whatever its curve says.
    """
    a, b = line.T
    lowest, highest = hazard.slopes()
    middle = -a / b
    logistic = family.deviation != 1.0
    light = b > lowest if logistic and floor == -math.inf else np.ones(b.size, dtype=bool)
    if not np.any(light):
        return Integral(np.full(b.size, np.inf), np.zeros(0), np.zeros(0))
    kept = b[light]
    # Below the median F falls at least as exp(b t), or exp(-(b t)^2/2), and the hazard's density rises as exp(k t).
    steep = np.maximum(kept - lowest, 1e-3) if floor > -math.inf else kept - lowest
    below = TAIL / steep if logistic else (lowest + np.sqrt(lowest**2 + 2.0 * TAIL * kept**2)) / kept**2
    first = max(float(np.min([*(middle[light] - below), *hazard.knots[:1]])), floor)
    last = max(float(np.max([*middle[light], *hazard.knots[-1:]])), first) + TAIL / highest
    step = SHARE / max(float(np.max(kept)), lowest, highest, 1.0)
    cuts = np.unique([first, last, *(cut for cut in (*hazard.knots.tolist(), *breaks) if first < cut < last)])
    counts = np.ceil(np.diff(cuts) / step).astype(int)
    if counts.sum() > MOST_PIECES:  # nearly steps: pieces that follow their edges and no more
        counts = np.maximum(1, counts * MOST_PIECES // counts.sum())
    ends = np.concatenate(
        [np.linspace(low, high, n + 1)[:-1] for low, high, n in zip(cuts[:-1], cuts[1:], counts, strict=True)]
    )
    widths = np.diff([*ends, last])
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    u = (ends[:, np.newaxis] + widths[:, np.newaxis] * (0.5 + 0.5 * nodes)).ravel()
    share, density = (0.5 * widths[:, np.newaxis] * weights).ravel(), hazard.log_density(u)

    def parts(place: int) -> np.ndarray:
        # In logarithms: far out one of the two is beyond the range of numbers.
        return np.asarray(share * np.exp(family.log_cdf(a[place] + b[place] * u)[0] + density))

    frequency = np.array([np.sum(parts(place)) if light[place] else np.inf for place in range(b.size)])
    return Integral(frequency, u, parts(0) if light[0] else np.zeros(u.size))
