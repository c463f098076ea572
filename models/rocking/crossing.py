"""Factors read off a probability of overturning over the factor on a record: its crossings, and the mean capacity.

.. note:: The probability need not rise everywhere. The factor of a probability is the crossing of its isotonic fit
   (pool adjacent violators), linear in ln f between levels. The mean capacity exp(E ln f_c) needs no fit: P is the
   distribution of the capacity f_c, and what it gains between two levels lies on average half-way between their
   logarithms. That is the trapezoidal rule for ln f_1 + integral of (1 - P) d ln f, from f_1, where P is still 0.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import isotonic_regression

__all__ = ["factor_at", "mean_capacity", "rising"]

#: Falls of a probability that are rounding.
ROUNDING = 1e-12


def rising(probability: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    """The isotonic fit of probabilities along their last axis.

    Parameters
    ----------
    probability : (..., k) ndarray
        Probability at the levels, from the lowest level on [-].
    weights : (k,) ndarray, optional
        Weight of each level, positive; all alike without.

    Returns
    -------
    (..., k) ndarray
        The closest probabilities, by least squares, that never fall.

    Examples
    --------
    >>> rising(np.array([0.0, 0.4, 0.2, 1.0])).round(3).tolist()
    [0.0, 0.3, 0.3, 1.0]
    """
    fitted = np.array(probability, dtype=float)
    rows = fitted.reshape(-1, fitted.shape[-1])
    for row in np.flatnonzero(np.any(np.diff(rows, axis=1) < -ROUNDING, axis=1)):
        rows[row] = isotonic_regression(rows[row], weights=weights).x
    return np.maximum.accumulate(rows, axis=1).reshape(fitted.shape)


def factor_at(share: float, level: np.ndarray, probability: np.ndarray) -> np.ndarray:
    """The factor at which a probability that never falls reaches a share, linear in ln f between the levels.

    Parameters
    ----------
    share : float
        Probability that is to be reached [-], above 0.
    level : (k,) ndarray
        Factors, ascending and positive.
    probability : (..., k) ndarray
        Probability at the levels, never falling along the last axis (:func:`rising`) [-].

    Returns
    -------
    (...) ndarray
        Factor, in the unit of the levels: the lowest level where the share is reached there already, inf where it is
        reached nowhere.

    Examples
    --------
    >>> float(factor_at(0.5, np.array([1.0, 2.0, 8.0]), np.array([0.0, 0.25, 0.75])).round(3))
    4.0
    """
    reached = probability >= share
    after = np.argmax(reached, axis=-1)
    before = np.maximum(after - 1, 0)
    high = np.take_along_axis(probability, after[..., np.newaxis], axis=-1)[..., 0]
    low = np.take_along_axis(probability, before[..., np.newaxis], axis=-1)[..., 0]
    logs = np.log(level)
    part = np.divide(share - low, high - low, out=np.ones(np.shape(low)), where=high > low)
    return np.where(np.any(reached, axis=-1), np.exp(logs[before] + part * (logs[after] - logs[before])), np.inf)


def mean_capacity(level: np.ndarray, probability: np.ndarray) -> np.ndarray:
    """exp of the mean logarithm of the capacity, whose distribution the probability is.

    Parameters
    ----------
    level : (k,) ndarray
        Factors, ascending and positive, from one at which the probability is 0.
    probability : (..., k) ndarray
        Probability at the levels [-]; fitted or not.

    Returns
    -------
    (...) ndarray
        Capacity, in the unit of the levels; inf where the probability does not come to 1, within 1e-3, at the last one.

    Examples
    --------
    >>> float(mean_capacity(np.array([1.0, 2.0, 8.0]), np.array([0.0, 0.0, 1.0])).round(3))
    4.0
    """
    logs = np.log(level)
    gained = np.diff(probability, axis=-1) * (0.5 * (logs[1:] + logs[:-1]))
    # Added one after the other: levels of no gain before the first and after the last one do not change a bit.
    mean = probability[..., 0] * logs[0] + np.cumsum(gained, axis=-1)[..., -1] + (1.0 - probability[..., -1]) * logs[-1]
    return np.where(probability[..., -1] > 1.0 - 1e-3, np.exp(mean), np.inf)
