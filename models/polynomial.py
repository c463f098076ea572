"""First impact and largest rotation of a motion given as a Taylor polynomial over one short step.

.. note:: phi = s theta >= 0 is the rotation away from the ground, s = sgn theta, and tau = p t. A step is so short (p
   dt <= 0.1) that phi'' changes its sign at most once in it: cut there, phi' is monotone on each piece and every root
   below is bracketed.
"""

from __future__ import annotations

from numba import njit

__all__ = ["ORDER", "falling_root", "first_impact", "value", "velocity"]

#: Degree of the polynomials: one sample of p dt = 0.04 in which the ground jumps by three thresholds is exact to 1e-14.
ORDER = 10

MAX_ITERATIONS = 100


@njit(cache=True, nogil=True, error_model="numpy")
def value(c, tau):
    """phi(tau) = sum c_k tau^k."""
    total = c[ORDER]
    for k in range(ORDER - 1, -1, -1):
        total = total * tau + c[k]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def velocity(c, tau):
    """phi'(tau)."""
    total = ORDER * c[ORDER]
    for k in range(ORDER - 1, 0, -1):
        total = total * tau + k * c[k]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def acceleration(c, tau):
    """phi''(tau)."""
    total = ORDER * (ORDER - 1) * c[ORDER]
    for k in range(ORDER - 1, 1, -1):
        total = total * tau + k * (k - 1) * c[k]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def derivative(c, order, tau):
    """phi, phi' or phi'' at tau, by its order."""
    if order == 0:
        return value(c, tau)
    if order == 1:
        return velocity(c, tau)
    return acceleration(c, tau)


@njit(cache=True, nogil=True, error_model="numpy")
def bracketed_root(c, order, shift, left, right, guess):
    """Root in [left, right] of the order-th derivative of phi less `shift`, of opposite signs at the two ends (order
    <= 1: monotone).

    Newton steps, replaced by bisection where they leave the bracket; the stop is relative to the distance from the
    start of the step, so that a hop of 1e-12 keeps its digits.
    """
    rising = derivative(c, order, right) - shift > 0.0
    tau = guess if left < guess < right else 0.5 * (left + right)
    for _ in range(MAX_ITERATIONS):
        residual = derivative(c, order, tau) - shift
        if residual == 0.0:
            return tau
        if (residual > 0.0) == rising:
            right = tau
        else:
            left = tau
        slope = derivative(c, order + 1, tau) if order < 2 else 0.0
        step = tau - residual / slope if slope != 0.0 else left
        if not left < step < right:
            step = 0.5 * (left + right)
        if abs(step - tau) <= 4e-16 * abs(tau) or step in (left, right):
            return step
        tau = step
    return tau


@njit(cache=True, nogil=True, error_model="numpy")
def falling_root(c, left, right):
    """Where phi falls through zero in [left, right]: phi > 0 before, phi(right) <= 0, phi' < 0 inside."""
    # From the top of a hop the fall takes as long as the rise did, to first order.
    return bracketed_root(c, 0, 0.0, left, right, 2.0 * left if left > 0.0 else -c[0] / c[1])


@njit(cache=True, nogil=True, error_model="numpy")
def first_impact(c, h):
    """First return of phi to zero in (0, h], and the largest phi before it (or before h).

    Parameters
    ----------
    c : (ORDER + 1,) ndarray
        Taylor coefficients of phi(tau) about the start of the step [rad]; c[0] >= 0, and c[0] = 0 only with a motion
        that leaves the ground.
    h : float
        Length of the step [-].

    Returns
    -------
    impact : float
        tau of the impact; -1 if there is none.
    largest : float
        Largest phi up to the impact or up to h [rad].
    """
    largest = c[0]
    cut = h
    if c[2] * acceleration(c, h) < 0.0:
        cut = bracketed_root(c, 2, 0.0, 0.0, h, 0.5 * h)
    left = 0.0
    speed_left = c[1]
    for piece in range(2):
        right = cut if piece == 0 else h
        if right <= left:
            continue
        speed_right = velocity(c, right)
        end = right
        if speed_left < 0.0 < speed_right:  # a low point inside: it is there that the ground may be touched
            end = bracketed_root(c, 1, 0.0, left, right, -1.0)
        start = left
        if speed_left > 0.0 > speed_right:
            start = bracketed_root(c, 1, 0.0, left, right, -0.5 * c[1] / c[2] if c[2] != 0.0 else -1.0)
            largest = max(largest, value(c, start))
        falls = speed_left < 0.0 or speed_right < 0.0
        if falls and value(c, end) <= 0.0:
            return falling_root(c, start, end), largest
        largest = max(largest, value(c, right))
        left = right
        speed_left = speed_right
    return -1.0, largest
