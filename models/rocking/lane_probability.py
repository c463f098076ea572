"""The probability of overturning over the factor on a record, from lanes that each took one factor and one verdict.

.. note:: Lane i was marched at ln f_i and tells v_i, 1 where it overturned. A block under the factor f meets f exp(Z),
   Z a shift of known density h, so that P(f) is the verdict smoothed by it,

   P(f) = integral of h(t - ln f) v(t) dt,  estimated inside by sum_i w_i h(t_i - ln f) v_i/sum_i w_i h(t_i - ln f)

   where w_i = 1/(density of the lanes per unit of ln f) and the sum below the line is near 1: dividing by it takes out
   what unequal spacing adds. Nothing overturns below `bottom`, everything above `top`; the mass of the shift that falls
   there is known and is not estimated.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numba import njit

from rocking.quantities import ArrayLike

__all__ = ["Shift", "lane_bells", "lane_probability", "lane_sums", "tail_masses"]

#: Sum of weights below which no lane is near a level.
NO_LANE = 1e-9


class Shift(Protocol):
    """Distribution of a shift of ln f, such as :class:`rocking.uncertainty.Uncertainty`."""

    def density(self, shift: ArrayLike) -> np.ndarray:
        """Probability density per unit of ln f [-]."""

    def below(self, shift: ArrayLike) -> np.ndarray:
        """Probability that the shift is no larger than the given one [-]."""


def lane_bells(log_factor: np.ndarray, weight: np.ndarray, log_level: np.ndarray, shift: Shift) -> np.ndarray:
    """What each lane counts at each level.

    Parameters
    ----------
    log_factor : (n,) ndarray
        ln of the factor that each lane took.
    weight : (n,) ndarray
        Stretch of ln f that each lane stands for [-]: 1 over the density of the lanes there.
    log_level : (k,) ndarray
        ln of the levels.
    shift : Shift
        Distribution of the shift of ln f.

    Returns
    -------
    (n, k) ndarray
        w_i h(t_i - ln f) [-].
    """
    return shift.density(log_factor[:, np.newaxis] - log_level) * weight[:, np.newaxis]


def lane_sums(counted: np.ndarray, bells: np.ndarray) -> np.ndarray:
    """Sums over the lanes, the same to the last bit on any number of threads, as those of a matrix product are not.

    Parameters
    ----------
    counted : (r, n) ndarray
        How often each lane counts in each of the sums [-].
    bells : (n, k) ndarray
        What each lane counts at each level (:func:`lane_bells`) [-].

    Returns
    -------
    (r, k) ndarray
        The sums [-].
    """
    sums = np.zeros((counted.shape[0], bells.shape[1]))
    _add(np.ascontiguousarray(counted, dtype=np.float64), np.ascontiguousarray(bells), sums)
    return sums


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _add(counted: np.ndarray, bells: np.ndarray, sums: np.ndarray) -> None:
    for row in range(counted.shape[0]):
        for lane in range(counted.shape[1]):
            times = counted[row, lane]
            if times != 0.0:
                for level in range(bells.shape[1]):
                    sums[row, level] += times * bells[lane, level]


def tail_masses(bottom: Any, top: Any, log_level: np.ndarray, shift: Shift) -> tuple[np.ndarray, np.ndarray]:
    """Probability that a block meets a factor below `bottom`, and above `top` (both as ln f), at (k,) levels."""
    return shift.below(bottom - log_level), 1.0 - shift.below(top - log_level)


def lane_probability(hit: np.ndarray, whole: np.ndarray, below: np.ndarray, above: np.ndarray) -> np.ndarray:
    """P at the levels, from sums over the lanes.

    Parameters
    ----------
    hit, whole : (..., k) ndarray
        Sums of :func:`lane_bells` over the lanes that overturn, and over all of them [-].
    below, above : (k,) ndarray
        Mass of the shift outside the lanes (:func:`tail_masses`) [-].

    Returns
    -------
    (..., k) ndarray
        Probability of overturning [-], not yet fitted; where no lane is near a level only `above` counts.

    Examples
    --------
    Lanes 0.01 apart that overturn from ln f = 0 on: P is the distribution of a normal shift of 10 %.

    >>> from rocking.uncertainty import Uncertainty
    >>> lanes, levels, shift = np.arange(-0.795, 0.8, 0.01), np.array([-0.1, 0.0, 0.1]), Uncertainty(geometry=0.0)
    >>> bell = lane_bells(lanes, np.full(lanes.size, 0.01), levels, shift)
    >>> tails = tail_masses(-0.8, 0.8, levels, shift)
    >>> lane_probability(bell[lanes > 0.0].sum(axis=0), bell.sum(axis=0), *tails).round(3).tolist()
    [0.159, 0.5, 0.841]
    """
    share = np.divide(hit, whole, out=np.zeros(np.shape(hit)), where=whole > NO_LANE)
    return (1.0 - below - above) * np.clip(share, 0.0, 1.0) + above
