"""Searches for a set of spectra with a mean close to a target, by greedy choice from several starts and by exchange.

.. note:: The scale factor of each spectrum makes the mean over the periods of its ratio to the target equal to 1, so
   that all members are about as strong as the target. The search minimises max/min over the periods of the mean
   ratio of the set. Finally all scale factors are multiplied by a common factor, which centres the deviations.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

#: Largest number of spectra from which a search begins: the spectra with the shapes nearest to the target.
STARTS = 40


class SpectrumSet(NamedTuple):
    """A set of spectra: their indices in ascending order, their scale factors, and their mean."""

    members: np.ndarray  #: (n,) indices
    factors: np.ndarray  #: (n,) scale factors [-]
    ratio: np.ndarray  #: (k,) mean of the scaled spectra divided by the target [-]


def own_factors(ratios: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """Return the scale factor with which the mean of each row of `ratios` becomes 1; NaN outside the bounds."""
    with np.errstate(divide="ignore"):
        factors = 1.0 / ratios.mean(axis=1)
    return np.where((factors >= bounds[0]) & (factors <= bounds[1]), factors, np.nan)


def fitting_set(
    ratios: np.ndarray,
    events: Sequence[str],
    count: int,
    bounds: tuple[float, float],
    per_event: int = 1,
    tolerance: tuple[float, float] = (0.1, 0.3),
) -> SpectrumSet:
    """Return the set of `count` spectra whose mean is nearest to the target.

    Parameters
    ----------
    ratios : (m, k) ndarray
        Spectra divided by the target at k periods [-].
    events : sequence of str
        Earthquake of each spectrum.
    count : int
        Number of members; the earthquakes must have enough spectra with a scale factor within the bounds.
    bounds : (2,) tuple of float
        Smallest and largest scale factor [-].
    per_event : int
        Largest number of members of one earthquake.
    tolerance : (2,) tuple of float
        Allowed deviations of the mean below and above the target [-]. If the common factor that centres the deviations
        does not keep them within these limits, another common factor is used if one does.
    """
    own = own_factors(ratios, bounds)
    usable = np.flatnonzero(np.isfinite(own))
    shapes, codes = ratios[usable] * own[usable, None], np.unique(np.asarray(events)[usable], return_inverse=True)[1]
    starts = np.argsort(_spread(shapes), kind="stable")[:STARTS].tolist()
    found = [_exchanged(shapes, codes, _greedy(shapes, codes, start, count, per_event), per_event) for start in starts]
    members = np.sort(min(found, key=lambda one: float(_spread(shapes[one].sum(axis=0)))))
    ratio, factors = shapes[members].mean(axis=0), own[usable[members]]
    low, high = float(ratio.min()), float(ratio.max())
    common, least, most = 2.0 / (low + high), (1.0 - tolerance[0]) / low, (1.0 + tolerance[1]) / high
    if least <= most:
        common = min(max(common, least), most)
    common = min(max(common, bounds[0] / factors.min()), bounds[1] / factors.max())
    return SpectrumSet(usable[members], common * factors, common * ratio)


def _spread(ratios: np.ndarray) -> np.ndarray:
    """Return the largest value divided by the smallest value, over the last axis."""
    return np.asarray(ratios.max(axis=-1) / ratios.min(axis=-1))


def _best(shapes: np.ndarray, codes: np.ndarray, others: list[int], per_event: int) -> tuple[float, int]:
    """Find the spectrum that gives the smallest spread if added to the others; return this spread and its index."""
    taken = np.bincount(codes[others], minlength=codes.max() + 1)[codes] >= per_event
    taken[others] = True
    spread = np.where(taken, np.inf, _spread(shapes[others].sum(axis=0) + shapes))
    place = int(np.argmin(spread))
    return float(spread[place]), place


def _greedy(shapes: np.ndarray, codes: np.ndarray, start: int, count: int, per_event: int) -> list[int]:
    members = [start]
    while len(members) < count:
        members.append(_best(shapes, codes, members, per_event)[1])
    return members


def _exchanged(shapes: np.ndarray, codes: np.ndarray, members: list[int], per_event: int) -> list[int]:
    """Repeat the exchange of one member that reduces the spread most, while there is one; return the members."""
    spread = float(_spread(shapes[members].sum(axis=0)))
    while True:
        others = [members[:place] + members[place + 1 :] for place in range(len(members))]
        found = [(*_best(shapes, codes, rest, per_event), rest) for rest in others if rest]
        best = min(found, key=lambda one: one[0], default=(np.inf, 0, []))
        if not best[0] < spread * (1.0 - 1e-12):
            return members
        spread, members = best[0], [*best[2], best[1]]
