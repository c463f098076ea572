"""The nonlinear equation of the rocking block under a sampled accelerogram (Housner 1963; Yim, Chopra & Penzien 1980).

.. note:: theta'' = -p^2 [(1 + a_v/g) sin(s alpha - theta) + (a_g/g) cos(s alpha - theta)], s = sgn theta, a_v
   positive up. With phi = s theta >= 0 and tau = p t: phi'' = -[lift sin(alpha - phi) + ground cos(alpha - phi)],
   lift = 1 + a_v/g, ground = s a_g/g, both linear in tau inside a sample.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rockpulse.models.polynomial import ORDER

__all__ = ["flight_time", "nonlinear_after", "nonlinear_series"]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)


@njit(cache=True, nogil=True, error_model="numpy")
def nonlinear_series(c, sine, cosine, phi, speed, alpha, ground, ground_slope, lift, lift_slope):
    """Taylor coefficients of phi about the start of a step, by the recurrences of sin and cos of a series.

    Parameters
    ----------
    c : (ORDER + 1,) ndarray
        Filled with c_k of phi(tau) = sum c_k tau^k [rad].
    sine, cosine : (ORDER + 1,) ndarray
        Work space: the series of sin(alpha - phi) and cos(alpha - phi).
    phi, speed : float
        phi [rad] and dphi/dtau [rad] at the start.
    alpha : float
        alpha_c [rad].
    ground, ground_slope, lift, lift_slope : float
        s a_g/g and 1 + a_v/g [-] at the start, and their slopes per unit of tau.
    """
    c[0] = phi
    c[1] = speed
    sine[0] = math.sin(alpha - phi)
    cosine[0] = math.cos(alpha - phi)
    c[2] = -0.5 * (lift * sine[0] + ground * cosine[0])
    for k in range(1, ORDER - 1):
        sine_k = 0.0
        cosine_k = 0.0
        for j in range(1, k + 1):
            sine_k -= j * c[j] * cosine[k - j]
            cosine_k += j * c[j] * sine[k - j]
        sine[k] = sine_k / k
        cosine[k] = cosine_k / k
        total = lift * sine[k] + lift_slope * sine[k - 1] + ground * cosine[k] + ground_slope * cosine[k - 1]
        c[k + 2] = -total / ((k + 1.0) * (k + 2.0))


@njit(cache=True, nogil=True, error_model="numpy")
def flight_time(excess, start, stop):
    """Time p t of the free motion from psi = `start` to psi = `stop`, psi = phi - alpha, without turning on the way.

    Parameters
    ----------
    excess : float
        Energy above that of rest at the top, phi'^2/2 + cos(psi) - 1 [-].
    start, stop : float
        Angles from the vertical equilibrium [rad]; with `excess` < 0 both of one sign and beyond the turning point.

    Returns
    -------
    float
        tau >= 0; inf where the top is reached with no energy to spare.

    Notes
    -----
    phi'^2 = 2 excess + 4 sin^2(psi/2). With k^2 = abs(excess)/2 and sin(psi/2) = k sinh z (over the top) or k cosh z
    (short of it), dtau = dz/cos(psi/2): smooth, so Gauss-Legendre panels of unit length in z are exact to rounding.
    """
    k = max(math.sqrt(0.5 * abs(excess)), 1e-150)
    low = math.sin(0.5 * min(start, stop)) / k
    high = math.sin(0.5 * max(start, stop)) / k
    if excess == 0.0 and low < 0.0 < high:
        return np.inf
    if excess >= 0.0:
        low, high = math.asinh(low), math.asinh(high)
    elif low < 0.0:
        low, high = math.acosh(max(1.0, -high)), math.acosh(max(1.0, -low))
    else:
        low, high = math.acosh(max(1.0, low)), math.acosh(max(1.0, high))
    panels = int(high - low) + 1
    width = (high - low) / panels
    total = 0.0
    for panel in range(panels):
        for i in range(NODES.size):
            z = low + width * (panel + 0.5 * (1.0 + NODES[i]))
            half_sine = k * (math.sinh(z) if excess >= 0.0 else math.cosh(z))
            total += 0.5 * width * WEIGHTS[i] / math.sqrt(1.0 - half_sine * half_sine)
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def nonlinear_after(phi, speed, alpha, restitution):
    """Motion on the ground at rest, from a state to its end, by conservation of energy.

    Parameters and returns as in :func:`rockpulse.models.linear.linear_after`; the wait is the time to phi = pi/2.

    Notes
    -----
    The energy above that of the top is phi'^2/2 - 2 sin^2((alpha - phi)/2). A block short of the top goes over it if
    it moves outward with an energy that is not negative; a block beyond the top comes back only if it moves inward
    with positive energy.
    """
    half_alpha = math.sin(0.5 * alpha)
    half = math.sin(0.5 * (alpha - phi))
    excess = 0.5 * speed * speed - 2.0 * half * half
    fall = 0.5 * math.pi - alpha
    over = speed > 0.0 and excess >= 0.0 if phi < alpha else speed >= 0.0 or excess <= 0.0
    if over:
        if speed >= 0.0:
            return np.inf, flight_time(excess, phi - alpha, fall), 0, np.nan
        top = 2.0 * math.asin(math.sqrt(-0.5 * excess))
        wait = flight_time(excess, top, phi - alpha) + flight_time(excess, top, fall)
        return np.inf, wait, 0, np.nan
    square = 2.0 * excess + 4.0 * half_alpha * half_alpha
    impact_speed = math.sqrt(square)
    rebound = restitution * impact_speed
    if speed < 0.0 and rebound >= 2.0 * half_alpha:
        again = 0.5 * rebound * rebound - 2.0 * half_alpha * half_alpha
        wait = flight_time(excess, -alpha, phi - alpha) + flight_time(again, -alpha, fall)
        return np.inf, wait, 1, impact_speed / alpha
    peak = top_rotation(rebound, alpha)
    if speed > 0.0:
        peak = max(peak, top_rotation(impact_speed, alpha))
    return max(peak, phi), np.nan, 0, impact_speed / alpha


@njit(cache=True, nogil=True, error_model="numpy")
def top_rotation(speed, alpha):
    """Largest phi of a free half-cycle that leaves the ground with dphi/dtau = speed [rad].

    Energy gives phi = alpha - 2 asin(r), r^2 = sin^2(alpha/2) - speed^2/4; the sine of the difference is multiplied
    out, so that small motions keep their digits.
    """
    half_alpha = math.sin(0.5 * alpha)
    r = math.sqrt(max(0.0, half_alpha * half_alpha - 0.25 * speed * speed))
    numerator = 0.25 * speed * speed
    return 2.0 * math.asin(numerator / (half_alpha * math.sqrt(1.0 - r * r) + math.cos(0.5 * alpha) * r))
