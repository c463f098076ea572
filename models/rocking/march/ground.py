"""Looking ahead in a sampled accelerogram: where it may lift a block next, and the most that is left of it.

Extremes are kept for blocks of BLOCK samples, so that rest is passed over quickly at 1/8 of the memory of the record.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = [
    "BLOCK",
    "BLOCK_BITS",
    "FALL",
    "LARGEST",
    "LEFT",
    "STEEPEST",
    "Accelerogram",
    "extremes",
    "largest_left",
    "next_exceedance",
]

#: Samples in a block, a power of two.
BLOCK_BITS = 5
BLOCK = 1 << BLOCK_BITS

# Rows of the extremes.
LARGEST = 0  #: largest abs(a_g) among the samples of the block and the first of the next one [m/s2]
STEEPEST = 1  #: largest step of a_g from one of its samples to the next [m/s2]
FALL = 2  #: smallest a_v among the same samples as LARGEST [m/s2]
LEFT = 3  #: largest abs(a_g) from its first sample to the end of the record [m/s2]


class Accelerogram(NamedTuple):
    """A sampled ground motion, linear between its samples, and its extremes."""

    acceleration: np.ndarray  #: (n,) a_g [m/s2]
    vertical: np.ndarray  #: (n,) a_v [m/s2], positive up; (0,) where there is none
    extremes: np.ndarray  #: (4, b + 1), see :func:`extremes`
    dt: float  #: sampling interval [s]


@njit(cache=True, nogil=True, error_model="numpy")
def extremes(acceleration, vertical):
    """Rows LARGEST, STEEPEST, FALL and LEFT of the b blocks of samples, then a column of zeros for the time after.

    `acceleration` is (n,), `vertical` (n,) or (0,) [m/s2].
    """
    n = acceleration.size
    blocks = (n + BLOCK - 1) // BLOCK
    found = np.zeros((4, blocks + 1))
    for b in range(blocks - 1, -1, -1):
        for k in range(b * BLOCK, min((b + 1) * BLOCK, n)):
            found[LEFT, b] = max(found[LEFT, b], abs(acceleration[k]))
        found[LARGEST, b] = found[LEFT, b]
        found[LEFT, b] = max(found[LEFT, b], found[LEFT, b + 1])
        for k in range(b * BLOCK, min((b + 1) * BLOCK, n - 1)):
            found[LARGEST, b] = max(found[LARGEST, b], abs(acceleration[k + 1]))
            found[STEEPEST, b] = max(found[STEEPEST, b], abs(acceleration[k + 1] - acceleration[k]))
        if vertical.size > 0:
            found[FALL, b] = np.inf
            for k in range(b * BLOCK, min((b + 1) * BLOCK + 1, n)):
                found[FALL, b] = min(found[FALL, b], vertical[k])
    return found


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def largest_left(k, record):
    """Largest abs(a_g) from sample k of an :class:`Accelerogram` to its end [m/s2]."""
    block = k // BLOCK + 1
    largest = record.extremes[LEFT, block] if block < record.extremes.shape[1] else 0.0
    for i in range(k, min(block * BLOCK, record.acceleration.size)):
        largest = max(largest, abs(record.acceleration[i]))
    return largest


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def next_exceedance(k, record, factor, threshold):
    """First sample from k on at which a resting block may lift or lose the ground; n if there is none.

    The block lifts at abs(a_g)/g above `threshold` where a_v = 0; `factor` is that on the record over gravity [s2/m].
    """
    n = record.acceleration.size
    up = record.vertical.size > 0
    while k < n:
        block = k // BLOCK
        lift = 1.0 + record.extremes[FALL, block] * factor
        if record.extremes[LARGEST, block] * factor <= lift * threshold and lift > 0.0:
            k = (block + 1) * BLOCK
            continue
        lift = 1.0 + record.vertical[k] * factor if up else 1.0
        if abs(record.acceleration[k]) * factor > lift * threshold or lift <= 0.0:
            return k
        k += 1
    return n
