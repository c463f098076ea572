"""Natural motion of a block between impulses (Casapulla & Maione 2017, Eqs. 1-2, 6-7), and half-cycles with impulses.

.. note:: Rotations are in units of alpha_c and times in units of 1/p: x = s theta/alpha_c (s the side of the rotation)
   obeys x'' = x - 1 while x > 0, and x' = s theta'/(p alpha_c) is positive away from the ground. The motion x = 1 + (y
   e^tau + z e^-tau)/2 has a growing mode y = x - 1 + x' and a decaying mode z = x - 1 - x'; it returns iff y < 0. All
   formulas stay accurate for small half-cycles (x' = 1e-9) and close to overturning.

A half-cycle with n (even) secondary impulses -a, +a, -a, ... of the velocity, a = u_1 I_s/I, starts on the ground with
the velocity u (section 3.2). With t = T/2, s = a/2 and v = u - s its duration T solves F(t) = target:

=========  ==================  ================================  ======
spacing    impulses            F(t)                              target
=========  ==================  ================================  ======
end        k dT, T = n dT      tanh t (1 - s tanh(t/n))          v
middle     (k - 1/2) dT        tanh t + s/cosh(t/n)              u
start      (k - 1) dT          tanh t (1 + s tanh(t/n))          v
open       k dT, T = (n+1) dT  tanh t - s tanh(t/(n+1))/tanh t   v
limit      n -> infinity       tanh t                            v
=========  ==================  ================================  ======
"""

import math

import numpy as np

from rocking.kernel_cache import njit

#: A velocity this close to the critical one counts as critical [-]; the tolerance is some hundred rounding errors.
CRITICAL_TOLERANCE = 1e-13
#: Limit of the argument of exp against overflow.
_LARGEST_EXPONENT = 700.0
#: Largest number of half-cycles that `free_decay_time` adds one by one.
_HOP_LIMIT = 100_000


@njit()
def arc(rotation, velocity, sinh, cosh_less_one):
    """Return x and x' after a time t of natural motion (Eq. 2), from sinh(p t) and cosh(p t) - 1."""
    return (
        rotation + velocity * sinh - (1.0 - rotation) * cosh_less_one,
        velocity + velocity * cosh_less_one - (1.0 - rotation) * sinh,
    )


@njit()
def state(rotation, velocity, time):
    """Return x and x' after a time (times p) of natural motion (Eq. 2); times above 700 count as 700."""
    if time < 1.0:
        half = math.sinh(0.5 * time)
        return arc(rotation, velocity, math.sinh(time), 2.0 * half * half)
    growing = 0.5 * (rotation - 1.0 + velocity) * math.exp(min(time, _LARGEST_EXPONENT))
    decaying = 0.5 * (rotation - 1.0 - velocity) * math.exp(-min(time, _LARGEST_EXPONENT))
    return 1.0 + growing + decaying, growing - decaying


@njit()
def impact_speed(rotation, velocity):
    """Return the impact speed w = sqrt(x (2 - x) + x'^2) of a returning motion [-], from conservation of energy."""
    return math.sqrt(max(rotation * (2.0 - rotation) + velocity * velocity, 0.0))


@njit()
def return_growth(rotation, velocity, speed):
    """Return e^tau - 1 for the time tau to the impact with this `speed`; inf if the block does not return."""
    growing = rotation - 1.0 + velocity
    if growing >= 0.0:
        return np.inf
    gain = velocity + speed if velocity >= 0.0 else rotation * (2.0 - rotation) / (speed - velocity)
    return (rotation + gain) / -growing


@njit()
def return_time(rotation, velocity):
    """Return the time (times p) until the block returns to the ground; inf if it does not return (y >= 0).

    tau = log1p((x + x' + w)/(1 - x - x')); on the way down x' + w cancels and is computed as x (2 - x)/(w - x').
    """
    return math.log1p(return_growth(rotation, velocity, impact_speed(rotation, velocity)))


@njit()
def rise_time(rotation, velocity):
    """Return the time (times p) to the largest rotation, atanh(x'/(1 - x)); inf if the block falls or overturns."""
    if velocity < 0.0 or rotation - 1.0 + velocity >= 0.0:
        return np.inf
    return 0.5 * math.log1p(2.0 * velocity / (1.0 - rotation - velocity))


@njit()
def top(rotation, velocity):
    """Return the largest rotation of the motion [-], 1 - sqrt((1 - x)^2 - x'^2), for abs(x') < 1 - x."""
    root = math.sqrt((1.0 - rotation - velocity) * (1.0 - rotation + velocity))
    return (rotation * (2.0 - rotation) + velocity * velocity) / (1.0 + root)


@njit()
def hop(velocity):
    """Return peak 1 - sqrt(1 - u^2) and duration (times p) of a half-cycle from x' = u (Eqs. 6, 7); inf for u >= 1."""
    if velocity >= 1.0:
        return np.inf, np.inf
    return top(0.0, velocity), math.log1p(2.0 * velocity / (1.0 - velocity))


@njit()
def free_decay_time(velocity, restitution):
    """Return the duration of a free decay (times p), the sum over k >= 0 of 2 atanh(C^k u); inf for u or C >= 1.

    Below u = 0.8 the series 2 sum over odd j of u^j/(j (1 - C^j)) is used; more than 100 000 terms above it give inf.
    """
    if velocity >= 1.0 or restitution >= 1.0:
        return np.inf
    total = 0.0
    hops = 0
    while velocity > 0.8:
        if hops == _HOP_LIMIT:
            return np.inf
        total += math.log1p(2.0 * velocity / (1.0 - velocity))
        velocity *= restitution
        hops += 1
    power, restitution_power = velocity, restitution
    for order in range(1, 200, 2):
        term = 2.0 * power / (order * (1.0 - restitution_power))
        total += term
        if term <= 1e-17 * total:
            break
        power *= velocity * velocity
        restitution_power *= restitution * restitution
    return total


@njit()
def impacts_above(speed, restitution, cutoff):
    """Return the number of impacts of a free decay that are faster than `cutoff`; -1 if they never end (C = 1)."""
    if speed <= cutoff:
        return 0
    if restitution >= 1.0:
        return -1
    if restitution <= 0.0:
        return 1
    count = math.ceil(math.log(cutoff / speed) / math.log(restitution))
    # Rounding of the logarithms may shift the result by one: the powers correct it.
    if speed * restitution ** (count - 1) <= cutoff:
        return count - 1
    return count + 1 if speed * restitution**count > cutoff else count


END, MIDDLE, START, OPEN, CONTINUOUS = range(5)
_NEWTON_LIMIT = 200


@njit()
def _condition(half, count, spacing, s):
    """Return F(t), the function in the table of the module docstring, and its derivative."""
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


@njit()
def corrected_duration(velocity, secondary, count, spacing):
    """Return the duration T of a half-cycle (times p), the smallest T with x(T) = 0; inf if the block overturns.

    T is 2 t, where t is the root of F(t) = target (module docstring). For "end", "middle" and "open" the root atanh(v)
    of the continuous limit is a lower bound of t; for v >= 1 there is no root. F is concave with one maximum: Newton's
    iteration from the lower bound rises up to the smaller root, or passes the maximum (F' <= 0) if there is no root.
    For "start" F increases to 1 + s: its root is bracketed.
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


@njit()
def _bracketed(target, count, s):
    """Return half the duration for the spacing "start", by Newton's iteration in a shrinking bracket."""
    if target >= 1.0 + s - CRITICAL_TOLERANCE:
        return np.inf
    low = 0.0
    if target < 1.0:
        high = 0.5 * math.log1p(2.0 * target / (1.0 - target))
    else:
        high = 1.0
        while _condition(high, count, START, s)[0] < target:
            # tanh rounds to one for every factor: no representable velocity reaches the root.
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


@njit()
def impact_speed_after(velocity, secondary, time, count, spacing):
    """Return the speed u_r right before the impact that ends the half-cycle, after the last secondary impulse [-]."""
    if spacing == MIDDLE and secondary > 0.0:
        return max(velocity - secondary / math.cosh(0.5 * time / count), 0.0)
    if spacing == OPEN and secondary > 0.0:
        return max(velocity - secondary * (1.0 - math.tanh(0.5 * time / (count + 1)) / math.tanh(0.5 * time)), 0.0)
    return max(velocity - secondary, 0.0)


@njit()
def stays_bounded(main, ratio, restitution):
    """Return whether a block survives an endless main sequence, u_1 = `main`, with continuous secondary impulses.

    The block survives if v* = u_1 (1 - (1 + C) I_s/(2 I))/(1 - C) <= 1, with `ratio` I_s/I. It survives at v* = 1,
    because v* is never reached. A tolerance allows for the rounding of u_1 and 1 - C.
    """
    if main * (1.0 - 0.5 * ratio) >= 1.0 - CRITICAL_TOLERANCE:
        return False
    limit = main * (1.0 - 0.5 * ratio * (1.0 + restitution))
    if restitution == 1.0:
        return limit <= 0.0
    return limit * (1.0 - CRITICAL_TOLERANCE) <= 1.0 - restitution + 2.3e-16


#: Largest number of steps dT to the first return: p dT is at least 1e-4, and no half-cycle is longer than about 40/p.
_TRIAL_LIMIT = 1_000_000


@njit()
def _first_wait(spacing, interval):
    """Return the time from the main impulse to the first secondary impulse."""
    if spacing == START:
        return 0.0
    return 0.5 * interval if spacing == MIDDLE else interval


@njit()
def first_return(velocity, secondary, interval, spacing):
    """Return the time T* (times p) of the first return with the trial `interval` dT; inf if the block does not return.

    With the growing mode y = x - 1 + x' and a = `secondary`: if y >= 0 after an impulse towards the ground, the next
    one, away from the ground, makes y at least a, and y exp(dT) - a is never negative after that: there is no return.
    """
    rotation, elapsed, push, wait = 0.0, 0.0, -secondary, _first_wait(spacing, interval)
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


@njit()
def peak_and_lowest(velocity, secondary, time, count, spacing):
    """Return the largest x in a half-cycle of duration `time`, and the smallest x at its impulses (may be below 0)."""
    interval = time / (count + 1 if spacing == OPEN else count)
    wait, rotation, push, peak, lowest = _first_wait(spacing, interval), 0.0, -secondary, 0.0, np.inf
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
