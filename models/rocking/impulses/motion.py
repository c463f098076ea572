"""Natural motion of a rocking block between impulses (Casapulla & Maione 2017, Eqs. 1-2, 6-7).

.. note:: Rotations are in units of alpha_c and times in units of 1/p, so that x = s theta/alpha_c (s the side the
   block rocks on) obeys x'' = x - 1 while x > 0. The velocity x' = s theta'/(p alpha_c) is positive away from the
   ground. The motion is the sum of a growing and a decaying mode, x = 1 + (y e^tau + z e^-tau)/2 with y = x - 1 + x'
   and z = x - 1 - x'; it comes back iff y < 0.

Every formula is written so that it keeps its digits for hops that are tiny (x' = 1e-9) and for motions next to
overturning.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = [
    "CRITICAL_TOLERANCE",
    "free_decay_time",
    "hop",
    "impact_speed",
    "impacts_above",
    "return_growth",
    "return_time",
    "rise_time",
    "state",
    "top",
]

#: A velocity within this of the critical one counts as critical [-]: some hundred rounding errors, far below any datum.
CRITICAL_TOLERANCE = 1e-13

#: exp of more than this overflows.
_LARGEST_EXPONENT = 700.0

#: Hops that `free_decay_time` adds one by one before it gives up.
_HOP_LIMIT = 100_000


@njit(cache=True, nogil=True, error_model="numpy")
def state(rotation, velocity, time):
    """x and x' after a time of natural motion, times p and not negative (Eq. 2).

    Exponents are cut off at 700, so that long waits cannot overflow.
    """
    if time < 1.0:
        half = math.sinh(0.5 * time)
        sinh, cosh_less_one = math.sinh(time), 2.0 * half * half
        return (
            rotation + velocity * sinh - (1.0 - rotation) * cosh_less_one,
            velocity + velocity * cosh_less_one - (1.0 - rotation) * sinh,
        )
    growing = 0.5 * (rotation - 1.0 + velocity) * math.exp(min(time, _LARGEST_EXPONENT))
    decaying = 0.5 * (rotation - 1.0 - velocity) * math.exp(-min(time, _LARGEST_EXPONENT))
    return 1.0 + growing + decaying, growing - decaying


@njit(cache=True, nogil=True, error_model="numpy")
def impact_speed(rotation, velocity):
    """Speed w = sqrt(x (2 - x) + x'^2) with which a motion that comes back meets the ground [-], by its energy."""
    return math.sqrt(max(rotation * (2.0 - rotation) + velocity * velocity, 0.0))


@njit(cache=True, nogil=True, error_model="numpy")
def return_growth(rotation, velocity, speed):
    """e^tau - 1 of the return time, without exp and log, given the speed of the impact; inf where there is no return.

    The waits of a motion that is followed from impact to impact can so be kept as growth factors, e^(t - tau) - 1 =
    (e^t - e^tau)/e^tau.
    """
    growing = rotation - 1.0 + velocity
    if growing >= 0.0:
        return np.inf
    gain = velocity + speed if velocity >= 0.0 else rotation * (2.0 - rotation) / (speed - velocity)
    return (rotation + gain) / -growing


@njit(cache=True, nogil=True, error_model="numpy")
def return_time(rotation, velocity):
    """Time times p until the block, at x >= 0 with x', meets the ground; inf where it does not come back (y >= 0).

    From rest at x0 it is Housner's quarter period acosh(1/(1 - x0)). x(tau) = 0 gives e^tau = (1 + w)/(1 - x - x'),
    hence tau = log1p((x + x' + w)/(1 - x - x')); on the way down x' + w cancels and is written as x (2 - x)/(w - x').
    """
    return math.log1p(return_growth(rotation, velocity, impact_speed(rotation, velocity)))


@njit(cache=True, nogil=True, error_model="numpy")
def rise_time(rotation, velocity):
    """Time to the top of the motion times p [-], atanh(x'/(1 - x)); inf where there is none ahead."""
    if velocity < 0.0 or rotation - 1.0 + velocity >= 0.0:
        return np.inf
    return 0.5 * math.log1p(2.0 * velocity / (1.0 - rotation - velocity))


@njit(cache=True, nogil=True, error_model="numpy")
def top(rotation, velocity):
    """Rotation at the top of the motion [-], 1 - sqrt((1 - x)^2 - x'^2), for abs(x') < 1 - x."""
    root = math.sqrt((1.0 - rotation - velocity) * (1.0 - rotation + velocity))
    return (rotation * (2.0 - rotation) + velocity * velocity) / (1.0 + root)


@njit(cache=True, nogil=True, error_model="numpy")
def hop(velocity):
    """Peak 1 - sqrt(1 - u^2) and duration 2 atanh(u) times p of the half-cycle that starts with u >= 0 (Eqs. 6, 7).

    Both are inf where the block does not come back (u >= 1).

    Examples
    --------
    >>> peak, duration = hop(0.75)
    >>> round(peak, 6), round(duration, 6)
    (0.338562, 1.94591)
    """
    if velocity >= 1.0:
        return np.inf, np.inf
    return top(0.0, velocity), math.log1p(2.0 * velocity / (1.0 - velocity))


@njit(cache=True, nogil=True, error_model="numpy")
def free_decay_time(velocity, restitution):
    """Time times p until a block comes to rest after infinitely many hops, the sum over k >= 0 of 2 atanh(C^k u).

    It is inf for u >= 1, for C = 1, and for C so near to one (above about 1 - 1e-5) that hops of more than half the
    critical energy number over 100 000. Below u = 0.8 the sum over the hops of each term of the series of atanh is
    geometric: 2 sum over odd j of u^j/(j (1 - C^j)).
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


@njit(cache=True, nogil=True, error_model="numpy")
def impacts_above(speed, restitution, cutoff):
    """Number of impacts of a free decay that are faster than a positive cut-off, the first one with `speed`.

    It is the number of k >= 0 with C^k speed > cutoff; -1 where they never end (C = 1).
    """
    if speed <= cutoff:
        return 0
    if restitution >= 1.0:
        return -1
    if restitution <= 0.0:
        return 1
    count = math.ceil(math.log(cutoff / speed) / math.log(restitution))
    # The logarithms may round across a whole number: the powers decide.
    if speed * restitution ** (count - 1) <= cutoff:
        return count - 1
    return count + 1 if speed * restitution**count > cutoff else count
