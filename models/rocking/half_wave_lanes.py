"""Lanes of an overturning spectrum from the half-waves of a record alone, marched as triangles.

.. note:: A half-wave is taken as the triangle that has its ends, its impulse and its centroid: two straight pieces. A
   slender block goes through them by the linear equation in closed form (:mod:`rocking.half_wave_kernel`), a step a
   piece, where the march over the samples (:mod:`rocking.spectrum_lanes`) takes one a sample. The lanes are placed and
   weighed in the same way, so that both make an :class:`rocking.OverturningSpectrum`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rocking.block import STANDARD_GRAVITY
from rocking.half_wave_kernel import march_pieces, weighted_impulse
from rocking.spectrum_lanes import (
    HIGHEST,
    LEAST_RESTITUTION,
    LEAST_SPAN,
    MOST_RESTITUTION,
    RATES,
    SpectrumLanes,
    fill_lanes,
    frequency_parameters,
)
from rocking.threads import split_lanes

__all__ = ["checked_half_waves", "half_wave_lanes", "triangles"]

#: Largest acceleration over gravity that is taken for a ground motion [-].
STRONGEST = 1e6

#: Shorter pieces are no pieces [s]: a triangle whose top stands at one of its ends has one only.
SHORTEST = 1e-12


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
    start: Any,
    centroid: Any,
    end: Any,
    impulse: Any,
    p: Any = RATES,
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
        For arrays that are not finite, not of one length or out of order, impulses that are all zero or no ground
        motion, or p that do not ascend.

    Examples
    --------
    >>> import numpy as np
    >>> from rocking import OverturningSpectrum
    >>> lanes = half_wave_lanes([0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.3], p=[1.8, 2.0])
    >>> OverturningSpectrum(lanes).spectrum([0.9]).round(2).tolist()  # m/s, at each p
    [[0.19], [0.19]]
    """
    rates = frequency_parameters(p)
    corners = triangles(*checked_half_waves(start, centroid, end, impulse))
    length = np.diff(corners[0])
    pieces = length > SHORTEST
    ground = np.ascontiguousarray(np.stack([corners[1, :-1], corners[1, 1:]], axis=1)[pieces])
    if not np.any(ground):
        raise ValueError("impulse: expected a ground motion, got nothing but zeros")
    left = np.append(np.maximum.accumulate(np.max(np.abs(ground), axis=1)[::-1])[::-1], 0.0)
    steps = np.outer(rates, length[pieces])
    growth = np.exp(steps)
    bottom = np.log(rates / left[0])
    strongest = [np.max(np.abs(weighted_impulse(*corners, rate))) for rate in rates]
    top = np.maximum(np.log(HIGHEST / np.array(strongest)), bottom + LEAST_SPAN)

    def march(log_x: np.ndarray, restitution: np.ndarray) -> np.ndarray:
        place = np.repeat(np.arange(rates.size), log_x.shape[1])
        strength = np.exp(log_x).reshape(-1) / rates[place]
        peak = np.empty(place.size)

        def some(first: int, last: int) -> None:
            march_pieces(first, last, place, strength, restitution.reshape(-1), steps, growth, ground, left, peak)

        split_lanes(some, place.size, threads)
        return peak.reshape(log_x.shape)

    return fill_lanes(rates, bottom, top, march, between)


def checked_half_waves(
    start: Any, centroid: Any, end: Any, impulse: Any
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
    strongest = np.max(np.abs(triangles(first, middle, last, impulses)[1]), initial=0.0) / STANDARD_GRAVITY
    if strongest > STRONGEST:
        raise ValueError(
            f"acceleration: expected half-waves of at most {STRONGEST:g} times gravity, got {strongest:g}; is the "
            "record in m/s2?"
        )
    return first, middle, last, impulses
