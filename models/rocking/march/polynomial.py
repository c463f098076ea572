"""First impact and largest rotation of a motion given as a Taylor polynomial phi(tau) over one short step.

In a step (p dt <= 0.3) phi'' changes its sign at most once: on each side of that point phi' is monotonic, which
brackets every root below.
"""

import numpy as np

from rocking.kernel_cache import njit

#: Degree of the polynomials.
ORDER = 10
#: Orders of derivative, as numpy integers: with Python integers the functions below would be compiled for each value.
ROTATION, SPEED, PULL = np.int64(0), np.int64(1), np.int64(2)
MAX_ITERATIONS = 100
#: A Newton step smaller than this share of tau is the last one: the error after it is the square of this.
CONVERGED = 1e-9


@njit(_nrt=False)
def value(c, tau):
    """Return phi(tau) = sum c_k tau^k."""
    total = c[ORDER]
    for k in range(ORDER - 1, -1, -1):
        total = total * tau + c[k]
    return total


@njit(_nrt=False)
def velocity(c, tau):
    """Return phi'(tau)."""
    total = ORDER * c[ORDER]
    for k in range(ORDER - 1, 0, -1):
        total = total * tau + k * c[k]
    return total


@njit(_nrt=False)
def acceleration(c, tau):
    """Return phi''(tau) of the polynomial with coefficients `c`."""
    total = ORDER * (ORDER - 1) * c[ORDER]
    for k in range(ORDER - 1, 1, -1):
        total = total * tau + k * (k - 1) * c[k]
    return total


@njit(_nrt=False)
def with_slope(c, order, tau):
    """Return the derivative of phi of order 0, 1 or 2 at tau, and the derivative of the next order."""
    total = 0.0
    slope = 0.0
    for k in range(ORDER, order - 1, -1):
        factor = 1.0
        if order > 0:
            factor *= k
        if order > 1:
            factor *= k - 1
        slope = slope * tau + total
        total = total * tau + factor * c[k]
    return total, slope


@njit(_nrt=False)
def bracketed_root(c, order, shift, left, right, guess):
    """Return tau in [left, right] at which the derivative of this order equals `shift`, by bracketed Newton steps.

    The tolerance is relative to tau, so that the result is accurate even for tau = 1e-12.
    """
    rising = with_slope(c, order, right)[0] - shift > 0.0
    tau = guess if left < guess < right else 0.5 * (left + right)
    for _ in range(MAX_ITERATIONS):
        residual, slope = with_slope(c, order, tau)
        residual -= shift
        if residual == 0.0:
            return tau
        if (residual > 0.0) == rising:
            right = tau
        else:
            left = tau
        step = tau - residual / slope if slope != 0.0 else left
        if left < step < right:
            if abs(step - tau) <= CONVERGED * tau:
                return step
        else:
            step = 0.5 * (left + right)
            if step in (left, right):
                return step
        tau = step
    return tau


@njit(_nrt=False)
def falling_root(c, left, right):
    """Return the root of phi in [left, right], in which phi falls from a positive value to zero or below."""
    # First guess: a motion that starts at phi = 0 falls as long as it rises.
    return bracketed_root(c, ROTATION, 0.0, left, right, 2.0 * left if left > 0.0 else -c[0] / c[1])


@njit(_nrt=False)
def hop_root(c, h):
    """Return tau of the impact of a motion that starts at phi = 0, with phi'' < 0 in [0, h] and phi(h) <= 0."""
    left = 0.0
    right = h
    tau = min(-c[1] / c[2], h)
    for _ in range(MAX_ITERATIONS):
        mean = c[ORDER]
        slope = 0.0
        for k in range(ORDER - 1, 0, -1):
            slope = slope * tau + mean
            mean = mean * tau + c[k]
        if mean > 0.0:
            left = tau
        else:
            right = tau
        step = tau - mean / slope
        if left < step < right:
            if abs(step - tau) <= CONVERGED * tau:
                return step
        else:
            step = 0.5 * (left + right)
            if mean == 0.0 or step in (left, right):
                return tau
        tau = step
    return tau


@njit(_nrt=False)
def first_impact(c, h, peak):
    """Return tau of the first impact (phi = 0) in (0, h] or -1, and the largest phi before it, exact above `peak`."""
    start_pull, end_pull = 2.0 * c[2], acceleration(c, h)
    if start_pull < 0.0 and end_pull < 0.0:
        end, end_speed = value(c, h), velocity(c, h)
        top = 0.0
        largest = c[0]
        if c[1] > 0.0 > end_speed:
            # The curve lies below its tangents at both ends, so their intersection is an upper bound.
            roof = c[0] + c[1] * (end - c[0] - end_speed * h) / (c[1] - end_speed)
            if roof > peak or c[0] > 0.0 >= end:
                top = bracketed_root(c, SPEED, 0.0, 0.0, h, h * c[1] / (c[1] - end_speed))
                largest = value(c, top)
        if end > 0.0:
            return -1.0, max(largest, end)
        return (hop_root(c, h) if c[0] == 0.0 else falling_root(c, top, h)), largest
    largest = c[0]
    cut = h
    if start_pull * end_pull < 0.0:
        cut = bracketed_root(c, PULL, 0.0, 0.0, h, h * start_pull / (start_pull - end_pull))
    left = 0.0
    speed_left = c[1]
    for piece in range(2):
        right = cut if piece == 0 else h
        if right <= left:
            continue
        speed_right = velocity(c, right)
        end = right
        if speed_left < 0.0 < speed_right:  # a minimum inside the step, at which the block may touch the ground
            end = bracketed_root(c, SPEED, 0.0, left, right, -1.0)
        start = left
        if speed_left > 0.0 > speed_right:
            start = bracketed_root(c, SPEED, 0.0, left, right, -0.5 * c[1] / c[2] if c[2] != 0.0 else -1.0)
            largest = max(largest, value(c, start))
        falls = speed_left < 0.0 or speed_right < 0.0
        if falls and value(c, end) <= 0.0:
            return falling_root(c, start, end), largest
        largest = max(largest, value(c, right))
        left = right
        speed_left = speed_right
    return -1.0, largest
