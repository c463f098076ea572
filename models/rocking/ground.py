"""Looking ahead in a sampled accelerogram: where it may lift a block next, and the most that is left of it.

Extremes are kept for blocks of BLOCK samples, so that rest is passed over quickly at 1/8 of the memory of the record.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["BLOCK", "BLOCK_BITS", "FALL", "LARGEST", "LEFT", "STEEPEST", "extremes", "largest_left", "next_exceedance"]

#: Samples in a block, a power of two.
BLOCK_BITS = 5
BLOCK = 1 << BLOCK_BITS

# Rows of the extremes.
LARGEST = 0  #: largest abs(a_g) among the samples of the block and the first of the next one [m/s2]
STEEPEST = 1  #: largest step of a_g from one of its samples to the next [m/s2]
FALL = 2  #: smallest a_v among the same samples as LARGEST [m/s2]
LEFT = 3  #: largest abs(a_g) from its first sample to the end of the record [m/s2]


@njit(cache=True, nogil=True, error_model="numpy")
def extremes(acceleration, vertical):
    """Extremes of every block of samples.

    Parameters
    ----------
    acceleration : (n,) ndarray
        a_g [m/s2].
    vertical : (n,) or (0,) ndarray
        a_v [m/s2], or nothing.

    Returns
    -------
    (4, b + 1) ndarray
        Rows LARGEST, STEEPEST, FALL, LEFT; a last column of zeros stands for the ground after the record.
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
def largest_left(k, acceleration, found):
    """Largest abs(a_g) from sample k to the end [m/s2]."""
    block = k // BLOCK + 1
    largest = found[LEFT, block] if block < found.shape[1] else 0.0
    for i in range(k, min(block * BLOCK, acceleration.size)):
        largest = max(largest, abs(acceleration[i]))
    return largest


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def next_exceedance(k, acceleration, vertical, found, factor, threshold):
    """First sample from k on at which a resting block may lift or lose the ground; n if there is none.

    Parameters
    ----------
    k : int
        Sample to begin with.
    acceleration, vertical : (n,) ndarray
        a_g and a_v [m/s2]; vertical may be empty.
    found : (4, b + 1) ndarray
        What :func:`extremes` gives.
    factor : float
        Factor on the record over gravity [s2/m].
    threshold : float
        abs(a_g)/g above which the block lifts where a_v = 0 [-].
    """
    n = acceleration.size
    up = vertical.size > 0
    while k < n:
        block = k // BLOCK
        lift = 1.0 + found[FALL, block] * factor
        if found[LARGEST, block] * factor <= lift * threshold and lift > 0.0:
            k = (block + 1) * BLOCK
            continue
        lift = 1.0 + vertical[k] * factor if up else 1.0
        if abs(acceleration[k]) * factor > lift * threshold or lift <= 0.0:
            return k
        k += 1
    return n
