"""One half-cycle with intermediate impulses in closed form (Casapulla & Maione 2017, section 3.2).

.. note:: Units of alpha_c and 1/p as in :mod:`rocking.impulses.motion`. The half-cycle starts on the ground with the
   velocity u. The secondary impulses change the velocity by -a, +a, -a, ... with a = u_1 I_s/I, n of them, n even.

With t = T/2, s = a/2 and v = u - s the condition x(T) = 0 for a half-cycle of duration T is F(t) = target:

=========  ==================  ================================  ======
spacing    impulses            F(t)                              target
=========  ==================  ================================  ======
end        k dT, T = n dT      tanh t (1 - s tanh(t/n))          v
middle     (k - 1/2) dT        tanh t + s/cosh(t/n)              u
start      (k - 1) dT          tanh t (1 + s tanh(t/n))          v
open       k dT, T = (n+1) dT  tanh t - s tanh(t/(n+1))/tanh t   v
limit      n -> infinity       tanh t                            v
=========  ==================  ================================  ======

The two marches through a half-cycle with intermediate impulses (Casapulla & Maione 2017, steps 3, 4 and 6).

.. note:: Units of alpha_c and 1/p; the velocity changes by -a, +a, -a, ... as in :mod:`rocking.impulses.half_cycle`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rocking.impulses.motion import CRITICAL_TOLERANCE, return_time, rise_time, state, top

__all__ = [
    "CONTINUOUS",
    "END",
    "MIDDLE",
    "OPEN",
    "START",
    "corrected_duration",
    "first_return",
    "impact_speed_after",
    "peak_and_lowest",
    "stays_bounded",
]

END, MIDDLE, START, OPEN, CONTINUOUS = range(5)

_NEWTON_LIMIT = 200


@njit(cache=True, nogil=True, error_model="numpy")
def _condition(half, count, spacing, s):
    """F(t) of the table above, and its derivative."""
    tanh = math.tanh(half)
    slope = (1.0 - tanh) * (1.0 + tanh)
    divisor = count + 1 if spacing == OPEN else count
    inner = math.tanh(half / divisor)
    inner_slope = (1.0 - inner) * (1.0 + inner) / divisor
    if spacing == MIDDLE:
        sech = 1.0 / math.cosh(min(half / divisor, 700.0))
        return tanh + s * sech, slope - s * sech * inner / divisor
    if spacing == OPEN:
        ratio = inner / tanh
        return tanh - s * ratio, slope - s * (inner_slope - ratio * slope) / tanh
    sign = -1.0 if spacing == END else 1.0
    return tanh * (1.0 + sign * s * inner), slope * (1.0 + sign * s * inner) + sign * s * tanh * inner_slope


@njit(cache=True, nogil=True, error_model="numpy")
def corrected_duration(velocity, secondary, count, spacing):
    """Smallest T times p with x(T) = 0 for u, a secondary impulse 0 <= a <= u and n of them; inf: the block overturns.

    The root of the continuous limit, atanh(v), is a lower bound for "end", "middle" and "open", so none of them has a
    root without it. Their F rises, concave, to one maximum and falls after it: Newton's iteration from the lower bound
    climbs monotonically to the smaller root and steps over the maximum, where F' <= 0, iff there is none. For "start"
    F rises for ever, to 1 + s; there the root is bracketed.
    """
    s = 0.5 * secondary
    target = velocity - s
    if target <= 0.0:
        return 0.0
    if spacing == START and secondary > 0.0:
        return 2.0 * _bracketed(target, count, s)
    if target >= 1.0 - CRITICAL_TOLERANCE:
        return np.inf
    half = 0.5 * math.log1p(2.0 * target / (1.0 - target))
    if spacing == CONTINUOUS or secondary == 0.0:
        return 2.0 * half
    if spacing == MIDDLE:
        target = velocity
    for _ in range(_NEWTON_LIMIT):
        value, slope = _condition(half, count, spacing, s)
        if slope <= 0.0:
            return np.inf
        step = (target - value) / slope
        half += step
        if step <= 1e-16 * half:
            return 2.0 * half
    return 2.0 * half


@njit(cache=True, nogil=True, error_model="numpy")
def _bracketed(target, count, s):
    """Half the duration for "start": Newton's iteration inside a bracket that each step tightens."""
    if target >= 1.0 + s - CRITICAL_TOLERANCE:
        return np.inf
    low = 0.0
    if target < 1.0:
        high = 0.5 * math.log1p(2.0 * target / (1.0 - target))
    else:
        high = 1.0
        while _condition(high, count, START, s)[0] < target:
            # tanh has reached one in floating point for every factor: the root lies beyond representable velocities.
            if high > 40.0 * count:
                return np.inf
            low, high = high, 2.0 * high
    half = high
    for _ in range(_NEWTON_LIMIT):
        value, slope = _condition(half, count, START, s)
        if value >= target:
            high = half
        else:
            low = half
        step = (target - value) / slope if slope > 0.0 else np.inf
        trial = half + step
        if not low <= trial <= high:
            trial = 0.5 * (low + high)
        if abs(trial - half) <= 1e-16 * half:
            return trial
        half = trial
    return half


@njit(cache=True, nogil=True, error_model="numpy")
def impact_speed_after(velocity, secondary, time, count, spacing):
    """Speed u_r right before the impact that ends the half-cycle [-], last secondary impulse included."""
    if spacing == MIDDLE and secondary > 0.0:
        return max(velocity - secondary / math.cosh(0.5 * time / count), 0.0)
    if spacing == OPEN and secondary > 0.0:
        return max(velocity - secondary * (1.0 - math.tanh(0.5 * time / (count + 1)) / math.tanh(0.5 * time)), 0.0)
    return max(velocity - secondary, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def stays_bounded(main, ratio, restitution):
    """Whether a main sequence u_1 without end and a continuous secondary one (`ratio` = I_s/I) never overturn a block.

    v* = u_1 (1 - (1 + C) I_s/(2 I))/(1 - C) <= 1 (F2, F4). Equality is bounded, because the limit is not reached; the
    rounding of u_1 and of C, which moves 1 - C, must not decide it.
    """
    if main * (1.0 - 0.5 * ratio) >= 1.0 - CRITICAL_TOLERANCE:
        return False
    limit = main * (1.0 - 0.5 * ratio * (1.0 + restitution))
    if restitution == 1.0:
        return limit <= 0.0
    return limit * (1.0 - CRITICAL_TOLERANCE) <= 1.0 - restitution + 2.3e-16


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
