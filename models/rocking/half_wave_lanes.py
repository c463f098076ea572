"""Lanes of an overturning spectrum from the half-waves of a record alone.

.. note:: A half-wave is taken as the triangle that has its ends, its impulse and its centroid: two straight pieces,
   where a record has one from sample to sample (:mod:`rocking.spectrum_lanes`).
"""

from __future__ import annotations

import numpy as np

from rocking.quantities import ArrayLike
from rocking.spectrum_lanes import (
    LEAST_RESTITUTION,
    MOST_RESTITUTION,
    RATES,
    SpectrumLanes,
    check_strength,
    piece_lanes,
)

__all__ = ["checked_half_waves", "half_wave_lanes", "triangles"]


def triangles(start: np.ndarray, centroid: np.ndarray, end: np.ndarray, impulse: np.ndarray) -> np.ndarray:
    """Times [s] and ground accelerations [m/s2] of the corners of half-waves as triangles, (2, 3 k).

    A triangle from start to end has its centroid at (start + top + end)/3, in the middle third; a top that would lie
    outside goes to the nearer end.
    """
    top = np.clip(3.0 * centroid - start - end, start, end)
    length = end - start
    peak = np.divide(2.0 * impulse, length, out=np.zeros_like(impulse), where=length > 0.0)
    corners = np.stack([start, top, end], axis=1), np.stack([0.0 * peak, peak, 0.0 * peak], axis=1)
    return np.stack([values.reshape(-1) for values in corners])


def half_wave_lanes(
    start: ArrayLike,
    centroid: ArrayLike,
    end: ArrayLike,
    impulse: ArrayLike,
    p: ArrayLike = RATES,
    between: tuple[float, float] = (LEAST_RESTITUTION, MOST_RESTITUTION),
    threads: int | None = None,
) -> SpectrumLanes:
    """March the lanes of an overturning spectrum through half-waves.

    Parameters
    ----------
    start, centroid, end : (k,) array_like
        Times of the half-waves [s], in order, centroids inside.
    impulse : (k,) array_like
        Their signed impulses [m/s], not all zero.
    p : (a,) array_like
        Frequency parameters [1/s], ascending.
    between : (float, float)
        Least and most of the restitution of the lanes [-].
    threads : int, optional
        Threads that share the lanes; None for all available cores. The answer does not depend on it.

    Returns
    -------
    SpectrumLanes

    Raises
    ------
    ValueError
        For arrays that are not finite, not of one length or out of order, and as :func:`piece_lanes`.

    Examples
    --------
    >>> import numpy as np
    >>> from rocking import OverturningSpectrum
    >>> lanes = half_wave_lanes([0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.3], p=[1.8, 2.0])
    >>> OverturningSpectrum(lanes).spectrum([0.9]).round(2).tolist()  # m/s, at each p
    [[0.19], [0.19]]
    """
    times, ground = triangles(*checked_half_waves(start, centroid, end, impulse))
    return piece_lanes(times, ground, p, between, threads)


def checked_half_waves(
    start: ArrayLike, centroid: ArrayLike, end: ArrayLike, impulse: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The four arrays (k,) of half-waves, or ValueError."""
    arrays = tuple(np.atleast_1d(np.asarray(values, dtype=float)) for values in (start, centroid, end, impulse))
    if len({values.shape for values in arrays}) != 1 or arrays[0].ndim != 1:
        raise ValueError(
            "start, centroid, end, impulse: expected four (k,) arrays, got shapes "
            + ", ".join(str(values.shape) for values in arrays)
        )
    if not all(np.all(np.isfinite(values)) for values in arrays):
        raise ValueError("start, centroid, end, impulse: expected finite numbers")
    first, middle, last, impulses = arrays
    if np.any(middle < first) or np.any(last < middle) or np.any(first[1:] < last[:-1] - 1e-9):
        raise ValueError("half-waves: expected start <= centroid <= end, one after the other")
    check_strength(triangles(first, middle, last, impulses)[1])
    return first, middle, last, impulses
