"""The two marches through a half-cycle with intermediate impulses (Casapulla & Maione 2017, steps 3, 4 and 6).

.. note:: Units of alpha_c and 1/p; the velocity changes by -a, +a, -a, ... as in :mod:`rocking.half_cycle`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rocking.half_cycle import END, MIDDLE, OPEN, START
from rocking.motion import return_time, rise_time, state, top

__all__ = ["first_return", "peak_and_lowest"]

#: Steps of the trial march: p dT >= 1e-4 is demanded of a sequence and no half-cycle lasts longer than about 40/p.
_TRIAL_LIMIT = 1_000_000


@njit(cache=True, nogil=True, error_model="numpy")
def first_return(velocity, secondary, interval, spacing):
    """First return T* times p of the march with the trial `interval` dT times p; inf where it does not come back.

    Steps 3 and 4, for u, a and any spacing but the continuous one. If y >= 0 after an impulse towards the ground, the
    next one away from it makes y at least a, and y exp(delta) - a stays non-negative from then on: no return.
    """
    rotation, elapsed, push = 0.0, 0.0, -secondary
    if spacing == START:
        wait = 0.0
    elif spacing == MIDDLE:
        wait = 0.5 * interval
    else:
        wait = interval
    for _ in range(_TRIAL_LIMIT):
        growing = rotation - 1.0 + velocity
        if growing >= (secondary * math.exp(-wait) if push < 0.0 else 0.0):
            return np.inf
        back = return_time(rotation, velocity)
        if back <= wait:
            return elapsed + back
        rotation, velocity = state(rotation, velocity, wait)
        elapsed += wait
        velocity += push
        push, wait = -push, interval
    return np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def peak_and_lowest(velocity, secondary, time, count, spacing):
    """Largest x of the corrected march, at a top or an impulse, and smallest x at the impulses inside it (step 6).

    The half-cycle has u, a, n impulses and the finite `time` T times p; its spacing is not the continuous one. Below
    zero the march has passed through the ground: the closed form knows the end of the half-cycle only.
    """
    interval = time / (count + 1 if spacing == OPEN else count)
    if spacing == START:
        wait = 0.0
    elif spacing == MIDDLE:
        wait = 0.5 * interval
    else:
        wait = interval
    rotation, push, peak, lowest = 0.0, -secondary, 0.0, np.inf
    for impulse in range(count + 1):
        if impulse == count:
            wait = 0.0 if spacing == END else (0.5 * interval if spacing == MIDDLE else interval)
        if rise_time(rotation, velocity) <= wait:
            peak = max(peak, top(rotation, velocity))
        rotation, velocity = state(rotation, velocity, wait)
        peak = max(peak, rotation)
        inside = impulse < count - 1 if spacing == END else impulse < count
        if inside and not (spacing == START and impulse == 0):
            lowest = min(lowest, rotation)
        velocity += push
        push, wait = -push, interval
    return peak, lowest
