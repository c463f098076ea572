"""The motion of a slender block within a piece of the ground motion, over which a_g is linear in tau = p t.

.. note:: u'' = u - 1 - s f a_g changes its sign once at most. From u, u', `bend` = u'' and `twist` = u''' at a point,

   u(t) = u + u' t + bend (cosh t - 1) + twist (sinh t - t),

   which has no cancellation for small motions: the error of an impact is relative to the motion since the last impact.
"""

import math

from rocking.kernel_cache import njit

#: Largest length of a piece in tau, for which `hyperbolic` is exact to rounding.
LONGEST = 0.125
#: Largest number of steps in a bracketed search, and the relative accuracy at which it ends.
STEPS, ACCURACY = 60, 1e-15


@njit(inline="always", _nrt=False)
def hyperbolic(tau):
    """Return cosh(tau) - 1 and sinh(tau) - tau, for abs(tau) up to `LONGEST`."""
    z = tau * tau
    even = 0.5 * z * (1.0 + z * (1.0 / 12.0) * (1.0 + z * (1.0 / 30.0) * (1.0 + z * (1.0 / 56.0) * (1.0 + z / 90.0))))
    odd = 1.0 + z * (1.0 / 20.0) * (1.0 + z * (1.0 / 42.0) * (1.0 + z * (1.0 / 72.0) * (1.0 + z / 110.0)))
    return even, tau * z * (1.0 / 6.0) * odd


@njit(_nrt=False)
def motion_at(tau, u, v, bend, twist):
    """Return u and u' at tau after a point with u, u', u'' = `bend` and u''' = `twist`."""
    even, odd = hyperbolic(tau)
    return u + v * tau + bend * even + twist * odd, v + bend * (tau + odd) + twist * even


@njit(inline="always", _nrt=False)
def first_root(constant, linear, square):
    """Return the first positive root of `constant` + `linear` t + `square` t^2, `constant` >= 0; else any number."""
    under = linear * linear - 4.0 * constant * square
    root = math.sqrt(under if under > 0.0 else 0.0)
    top = linear + root if linear > 0.0 else 2.0 * constant
    return top / (-2.0 * square if linear > 0.0 else root - linear)


@njit(inline="always", _nrt=False)
def halley_step(tau, u, v, bend, twist, left):
    """Return a step of Halley's method for u = 0, and tau after this step, limited to the piece."""
    even, odd = hyperbolic(tau)
    value = u + v * tau + bend * even + twist * odd
    slope = v + bend * (tau + odd) + twist * even
    curve = bend * (1.0 + even) + twist * (tau + odd)
    step = 2.0 * value * slope / (2.0 * slope * slope - value * curve)
    reached = tau - step
    reached = reached if reached > 0.0 else 0.0
    return step, reached if reached < left else left


@njit(_nrt=False)
def _sign_change(low, high, u, v, bend, twist, order):
    """Return tau from `low` to `high` at which u (`order` 0) or u' (1) changes sign, by bracketed Newton steps."""
    sign = 1.0 if (motion_at(high, u, v, bend, twist)[order] > 0.0) else -1.0
    tau = high
    for _ in range(STEPS):
        value, slope = motion_at(tau, u, v, bend, twist)
        if order == 1:
            even, odd = hyperbolic(tau)
            value, slope = slope, bend * (1.0 + even) + twist * (tau + odd)
        if (value > 0.0) == (sign > 0.0):
            high = tau
        else:
            low = tau
        step = value / slope
        tau -= step
        if not low < tau < high:
            tau = 0.5 * (low + high)
        elif abs(step) < ACCURACY * tau:
            break
    return tau


@njit(_nrt=False)
def first_impact(u, v, bend, twist, left):
    """Return the first tau up to `left` at which u falls to zero; -1 if it does not."""
    if u <= 0.0 and (v < 0.0 or (v == 0.0 and bend < 0.0)):
        return 0.0
    # u' is monotonic on both sides of the point at which u'' = 0, and u between its extremes.
    turn = left
    if abs(bend) < abs(twist):
        turn = min(max(math.atanh(-bend / twist), 0.0), left)
    last = 0.0
    for low, high in ((0.0, turn), (turn, left)):
        if low >= high:
            continue
        middle = high
        # At the start of a hop u' may be 0.
        rises = motion_at(low, u, v, bend, twist)[1] > 0.0 or (low == 0.0 and v == 0.0 and (bend > 0.0 or twist > 0.0))
        if rises != (motion_at(high, u, v, bend, twist)[1] > 0.0):
            middle = _sign_change(low, high, u, v, bend, twist, 1)
        for end in (middle, high):
            if end > last and motion_at(end, u, v, bend, twist)[0] <= 0.0 and (last > 0.0 or u > 0.0):
                return _sign_change(last, end, u, v, bend, twist, 0)
            last = max(last, end)
    return -1.0


@njit(_nrt=False)
def peak_on_still_ground(u, v, restitution):
    """Return the largest peak still to come on still ground after u and u' = `v`; inf if the block overturns."""
    # (1 - u)^2 - u'^2 is constant: its value is (1 - u)^2 at the top, 1 - u'^2 at the impact.
    kept = (1.0 - u) ** 2 - v * v
    after = restitution * math.sqrt(max(1.0 - kept, 0.0))
    if after > 1.0 or u - 1.0 + v > 0.0:
        return math.inf
    top = max(kept, 0.0) if v > 0.0 else 1.0
    return 1.0 - math.sqrt(min(top, 1.0 - after * after))
