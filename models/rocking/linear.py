"""The linear equation of a slender block under a sampled accelerogram (Housner 1963; Casapulla & Maione 2017, Eq. 1).

.. note:: theta'' = p^2 (theta - s alpha - a_g/g), s = sgn theta. With phi = s theta >= 0 and tau = p t: phi'' = phi -
   alpha - ground, ground = s a_g/g, linear in tau inside a sample.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rocking import slots as row
from rocking.finish import keep_step

__all__ = ["hyperbolic", "linear_after", "linear_steps"]

# Coefficients of cosh and sinh.
H2, H4, H6, H8, H10, H12 = (1.0 / math.factorial(k) for k in range(2, 14, 2))
H3, H5, H7, H9, H11, H13 = (1.0 / math.factorial(k) for k in range(3, 15, 2))


@njit(inline="always")
def hyperbolic(h):
    """cosh h - 1, sinh h and sinh h - h for h <= 0.3, by their series."""
    z = h * h
    excess = h * z * (H3 + z * (H5 + z * (H7 + z * (H9 + z * (H11 + z * H13)))))
    return z * (H2 + z * (H4 + z * (H6 + z * (H8 + z * (H10 + z * H12))))), h + excess, excess


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False)
def linear_steps(f, width):
    """Take one step of the first `width` slots by the exact map; :func:`rocking.finish.finish_steps` reads its rows.

    With r = phi - alpha - ground and the slope m of the ground, phi(h) = phi + r (cosh h - 1) + phi' sinh h - m (sinh h
    - h) and phi'(h) = phi' cosh h + r sinh h - m (cosh h - 1): no difference of large numbers next to phi = 0. phi''
    has its largest size at an end but for a factor 1/(1 - h^2/8). The series serves to find what happens inside. A
    step is marked where the growing mode exceeds a bound of what is left of the record.
    """
    for j in range(width):
        phi = f[row.PHI + j]
        speed = f[row.SPEED + j]
        h = f[row.STEP + j]
        alpha = f[row.ALPHA + j]
        ground = f[row.GROUND + j]
        slope = f[row.SLOPE + j]
        cosh_1, sinh, sinh_h = hyperbolic(h)
        r = phi - alpha - ground
        end = phi + (r * cosh_1 + (speed * sinh - slope * sinh_h))
        end_speed = speed + (speed * cosh_1 + r * sinh - slope * cosh_1)
        end_pull = end - alpha - ground - slope * h
        strongest = 1.1 * max(abs(r), abs(end_pull))
        gone = end - alpha + end_speed > f[row.LIMIT + j]
        # The series: d_(k+2) = d_k/(k (k + 1)) from the third on.
        d3 = (1 / 2) * (speed - slope)
        d4 = (1 / 6) * r
        d5 = (1 / 12) * d3
        d6 = (1 / 20) * d4
        d7 = (1 / 30) * d5
        d8 = (1 / 42) * d6
        d9 = (1 / 56) * d7
        d10 = (1 / 72) * d8
        keep_step(f, j, end, end_speed, end_pull, strongest, gone, r, d3, d4, d5, d6, d7, d8, d9, d10)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def linear_after(phi, speed, alpha, restitution):
    """Motion on the ground at rest, from a state phi >= 0 and dphi/dtau [rad] to its end (Eqs. 2, 6, 8).

    The answer is the largest phi from now on [rad], inf if the block overturns; tau until that is certain, NaN if it
    does not; the impacts before it, 0 or 1; and the speed of the first impact over p alpha_c, NaN if there is none.

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
