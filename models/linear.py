"""The linear equation of a slender block under a sampled accelerogram (Housner 1963; Casapulla & Maione 2017, Eq. 1).

.. note:: theta'' = p^2 (theta - s alpha - a_g/g), s = sgn theta. With phi = s theta >= 0 and tau = p t: phi'' = phi -
   alpha - ground, ground = s a_g/g, linear in tau inside a sample.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rockpulse.models.polynomial import ORDER

__all__ = ["linear_after", "linear_series"]


@njit(cache=True, nogil=True, error_model="numpy")
def linear_series(c, phi, speed, alpha, ground, ground_slope):
    """Taylor coefficients of phi about the start of a step.

    Parameters
    ----------
    c : (ORDER + 1,) ndarray
        Filled with c_k of phi(tau) = sum c_k tau^k [rad].
    phi, speed : float
        phi [rad] and dphi/dtau [rad] at the start.
    alpha : float
        alpha_c [rad].
    ground, ground_slope : float
        s a_g/g [-] at the start and its slope per unit of tau.

    Notes
    -----
    (k+1)(k+2) c_{k+2} = c_k - [alpha + ground]_k. No difference of hyperbolic functions is taken, so the motion keeps
    its digits next to phi = 0.
    """
    c[0] = phi
    c[1] = speed
    c[2] = 0.5 * (phi - alpha - ground)
    c[3] = (speed - ground_slope) / 6.0
    for k in range(2, ORDER - 1):
        c[k + 2] = c[k] / ((k + 1.0) * (k + 2.0))


@njit(cache=True, nogil=True, error_model="numpy")
def linear_after(phi, speed, alpha, restitution):
    """Motion on the ground at rest, from a state to its end (Eqs. 2, 6, 8).

    Parameters
    ----------
    phi, speed : float
        State at the end of the input, phi >= 0 [rad] and dphi/dtau [rad].
    alpha, restitution : float
        alpha_c [rad] and C [-].

    Returns
    -------
    peak : float
        Largest phi from now on [rad]; inf if the block overturns.
    wait : float
        tau until overturning is certain; NaN if it does not overturn.
    impacts_before : int
        Impacts before overturning, 0 or 1.
    impact_speed : float
        Speed of the first impact over p alpha_c [-]; NaN if there is none.

    Notes
    -----
    With xi = phi/alpha, eta = xi' the growing mode is xi - 1 + eta: not negative, it takes the block over. Otherwise
    the block comes back with w^2 = xi (2 - xi) + eta^2 and leaves the ground with u = C w: u >= 1 overturns it on the
    other side.
    """
    xi = phi / alpha
    eta = speed / alpha
    if xi - 1.0 + eta >= 0.0:
        return np.inf, 0.0, 0, np.nan
    square = xi * (2.0 - xi) + eta * eta
    impact_speed = math.sqrt(square)
    rebound = restitution * impact_speed
    if eta < 0.0 and rebound >= 1.0:  # only a block driven towards the ground comes back faster than critical
        fall = xi * (2.0 - xi) / (impact_speed - eta)
        return np.inf, math.log1p((xi + fall) / (1.0 - xi - eta)), 1, impact_speed
    peak = rebound * rebound / (1.0 + math.sqrt(max(0.0, 1.0 - rebound * rebound)))
    if eta > 0.0:
        peak = max(peak, square / (1.0 + math.sqrt(max(0.0, 1.0 - square))))
    return alpha * max(peak, xi), np.nan, 0, impact_speed
