"""Time steps of the linear and the nonlinear equation under a record, and the free motion after the record.

.. note:: With phi = s theta >= 0, tau = p t, lift = 1 + a_v/g and ground = s a_g/g, both linear in tau inside a sample,
   phi'' = phi - alpha - ground for a slender block (Housner 1963; Casapulla & Maione 2017, Eq. 1), and phi'' = -[lift
   sin(alpha - phi) + ground cos(alpha - phi)] for any block (Yim, Chopra & Penzien 1980).
"""

import math

import numpy as np

from rocking.kernel_cache import njit
from rocking.march import slots as row
from rocking.march.steps import speed_of, store_step, value_of

# Coefficients of cosh and sinh.
H2, H4, H6, H8, H10, H12 = (1.0 / math.factorial(k) for k in range(2, 14, 2))
H3, H5, H7, H9, H11, H13 = (1.0 / math.factorial(k) for k in range(3, 15, 2))


@njit(inline="always")
def hyperbolic(h):
    """Return cosh h - 1, sinh h and sinh h - h for h <= 0.3, from their series."""
    z = h * h
    excess = h * z * (H3 + z * (H5 + z * (H7 + z * (H9 + z * (H11 + z * H13)))))
    return z * (H2 + z * (H4 + z * (H6 + z * (H8 + z * (H10 + z * H12))))), h + excess, excess


@njit(fastmath={"contract"}, _nrt=False)
def linear_steps(f, width):
    """Take one exact step of the bodies in the first `width` slots; write the rows that :func:`finish_steps` reads.

    With r = phi - alpha - ground and the slope m of the ground, phi(h) = phi + r (cosh h - 1) + phi' sinh h - m (sinh h
    - h) and phi'(h) = phi' cosh h + r sinh h - m (cosh h - 1), without differences of large numbers near phi = 0. The
    largest abs(phi'') is at most 1/(1 - h^2/8) times its larger value at the two ends. A step is marked if the growing
    mode phi - alpha + phi' exceeds LIMIT.
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
        store_step(f, j, end, end_speed, end_pull, strongest, gone, r, d3, d4, d5, d6, d7, d8, d9, d10)


@njit(_nrt=False)
def linear_after(phi, speed, alpha, restitution):
    """Return peak [rad], tau, impacts before overturning and impact speed of a motion on still ground (Eqs. 2, 6, 8).

    If the block overturns, the peak is inf and tau is the time until then, else tau is NaN; the impact speed is divided
    by p alpha_c. With xi = phi/alpha, eta = xi' the block overturns if xi - 1 + eta >= 0; else it returns with w^2 = xi
    (2 - xi) + eta^2, leaves the ground with u = C w, and overturns on the other side if u >= 1.
    """
    xi = phi / alpha
    eta = speed / alpha
    if xi - 1.0 + eta >= 0.0:
        return np.inf, 0.0, 0, np.nan
    square = xi * (2.0 - xi) + eta * eta
    impact_speed = math.sqrt(square)
    rebound = restitution * impact_speed
    if eta < 0.0 and rebound >= 1.0:  # outward motions end below the critical speed
        fall = xi * (2.0 - xi) / (impact_speed - eta)
        return np.inf, math.log1p((xi + fall) / (1.0 - xi - eta)), 1, impact_speed
    peak = rebound * rebound / (1.0 + math.sqrt(max(0.0, 1.0 - rebound * rebound)))
    if eta > 0.0:
        peak = max(peak, square / (1.0 + math.sqrt(max(0.0, 1.0 - square))))
    return alpha * max(peak, xi), np.nan, 0, impact_speed


# Coefficients of sin and cos.
S3, S5, S7, S9, S11, S13, S15, S17, S19 = ((-1) ** k / math.factorial(2 * k + 1) for k in range(1, 10))
C2, C4, C6, C8, C10, C12, C14, C16, C18, C20 = ((-1) ** k / math.factorial(2 * k) for k in range(1, 11))
NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)


@njit(inline="always")
def sine_and_cosine(q):
    """Return sin q and cos q for abs(q) <= 1.7 from series, exact to rounding; loops that use it become vector code."""
    z = q * q
    sine = q + q * z * (S3 + z * (S5 + z * (S7 + z * (S9 + z * (S11 + z * (S13 + z * (S15 + z * (S17 + z * S19))))))))
    cosine = 1.0 + z * (
        C2 + z * (C4 + z * (C6 + z * (C8 + z * (C10 + z * (C12 + z * (C14 + z * (C16 + z * (C18 + z * C20))))))))
    )
    return sine, cosine


@njit(inline="always")
def nonlinear_rates(phi, speed, alpha, ground, ground_slope, lift, lift_slope):
    """Return the coefficients k c_k, k = 2 ... 10, of phi'(tau) = sum k c_k tau^(k-1), with phi(tau) = sum c_k tau^k.

    With the series s_k, z_k of sin(alpha - phi), cos(alpha - phi) and d_k = k c_k: k s_k = -sum d_j z_(k-j), k z_k =
    sum d_j s_(k-j), j = 1 ... k, and (k + 1) d_(k+2) = -[lift s + ground z]_k.
    """
    d1 = speed
    s0, z0 = sine_and_cosine(alpha - phi)
    d2 = -(lift * s0 + ground * z0)
    s1 = -d1 * z0
    z1 = d1 * s0
    d3 = (-1 / 2) * ((lift * s1 + lift_slope * s0) + (ground * z1 + ground_slope * z0))
    s2 = (-1 / 2) * (d1 * z1 + d2 * z0)
    z2 = (1 / 2) * (d1 * s1 + d2 * s0)
    d4 = (-1 / 3) * ((lift * s2 + lift_slope * s1) + (ground * z2 + ground_slope * z1))
    s3 = (-1 / 3) * (d1 * z2 + (d2 * z1 + d3 * z0))
    z3 = (1 / 3) * (d1 * s2 + (d2 * s1 + d3 * s0))
    d5 = (-1 / 4) * ((lift * s3 + lift_slope * s2) + (ground * z3 + ground_slope * z2))
    s4 = (-1 / 4) * ((d1 * z3 + d2 * z2) + (d3 * z1 + d4 * z0))
    z4 = (1 / 4) * ((d1 * s3 + d2 * s2) + (d3 * s1 + d4 * s0))
    d6 = (-1 / 5) * ((lift * s4 + lift_slope * s3) + (ground * z4 + ground_slope * z3))
    s5 = (-1 / 5) * ((d1 * z4 + d2 * z3) + (d3 * z2 + (d4 * z1 + d5 * z0)))
    z5 = (1 / 5) * ((d1 * s4 + d2 * s3) + (d3 * s2 + (d4 * s1 + d5 * s0)))
    d7 = (-1 / 6) * ((lift * s5 + lift_slope * s4) + (ground * z5 + ground_slope * z4))
    s6 = (-1 / 6) * ((d1 * z5 + d2 * z4) + (d3 * z3 + (d4 * z2 + (d5 * z1 + d6 * z0))))
    z6 = (1 / 6) * ((d1 * s5 + d2 * s4) + (d3 * s3 + (d4 * s2 + (d5 * s1 + d6 * s0))))
    d8 = (-1 / 7) * ((lift * s6 + lift_slope * s5) + (ground * z6 + ground_slope * z5))
    s7 = (-1 / 7) * ((d1 * z6 + d2 * z5) + (d3 * z4 + d4 * z3) + (d5 * z2 + (d6 * z1 + d7 * z0)))
    z7 = (1 / 7) * ((d1 * s6 + d2 * s5) + (d3 * s4 + d4 * s3) + (d5 * s2 + (d6 * s1 + d7 * s0)))
    d9 = (-1 / 8) * ((lift * s7 + lift_slope * s6) + (ground * z7 + ground_slope * z6))
    s8 = (-1 / 8) * ((d1 * z7 + d2 * z6) + (d3 * z5 + d4 * z4) + (d5 * z3 + d6 * z2) + (d7 * z1 + d8 * z0))
    z8 = (1 / 8) * ((d1 * s7 + d2 * s6) + (d3 * s5 + d4 * s4) + (d5 * s3 + d6 * s2) + (d7 * s1 + d8 * s0))
    d10 = (-1 / 9) * ((lift * s8 + lift_slope * s7) + (ground * z8 + ground_slope * z7))
    return d2, d3, d4, d5, d6, d7, d8, d9, d10


@njit(fastmath={"contract"}, _nrt=False)
def nonlinear_steps(f, width):
    """Take one Taylor step of the bodies in the first `width` slots; write the rows that :func:`finish_steps` reads.

    abs(phi'') is at most F = lift + abs(ground), and changes by at most h (F (abs(phi') + h F) + the slopes of lift and
    ground). A step is marked if phi may pass TOP or the last term of its series exceeds its bound TRUNCATION.
    """
    for j in range(width):
        phi = f[row.PHI + j]
        speed = f[row.SPEED + j]
        h = f[row.STEP + j]
        ground = f[row.GROUND + j]
        ground_slope = f[row.SLOPE + j]
        lift = f[row.LIFT + j]
        lift_slope = f[row.LIFT_SLOPE + j]
        d2, d3, d4, d5, d6, d7, d8, d9, d10 = nonlinear_rates(
            phi, speed, f[row.ALPHA + j], ground, ground_slope, lift, lift_slope
        )
        end = value_of(h, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        end_speed = speed_of(h, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        push = max(lift, lift + h * lift_slope) + max(abs(ground), abs(ground + h * ground_slope))
        change = push * (abs(speed) + h * push) + abs(ground_slope) + abs(lift_slope)
        strongest = min(push, abs(d2) + h * change)
        square = h * h
        last_term = abs(d10) * (square * square) * (square * square) * square
        short = last_term > f[row.TRUNCATION + j] * (f[row.ALPHA + j] + phi)
        fallen = max(phi, end) + 0.125 * square * strongest >= f[row.TOP + j]
        end_pull = d2 + h * (
            2 * d3
            + h * (3 * d4 + h * (4 * d5 + h * (5 * d6 + h * (6 * d7 + h * (7 * d8 + h * (8 * d9 + h * (9 * d10)))))))
        )
        store_step(f, j, end, end_speed, end_pull, strongest, short | fallen, d2, d3, d4, d5, d6, d7, d8, d9, d10)


@njit(_nrt=False)
def flight_time(excess, start, stop):
    """Return the time p t of the free motion from psi = `start` to `stop` (no turning point), psi = phi - alpha.

    `excess` = phi'^2/2 + cos(psi) - 1 is the energy above unstable equilibrium (psi = 0); if it is 0 and the motion
    passes psi = 0, the time is inf. With k^2 = abs(excess)/2 and sin(psi/2) = k sinh z (excess >= 0) or k cosh z
    (excess < 0) dtau = dz/cos(psi/2) is smooth: Gauss-Legendre panels of unit length in z are exact to rounding.
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


@njit(_nrt=False)
def nonlinear_after(phi, speed, alpha, restitution):
    """Return the results of :func:`linear_after` for the nonlinear equation, with overturning at phi = pi/2.

    The energy above unstable equilibrium (phi = alpha) is E = phi'^2/2 - 2 sin^2((alpha - phi)/2). With phi < alpha a
    block overturns if it moves outward with E >= 0; with phi > alpha it returns only if it moves inward with E > 0.
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


@njit(_nrt=False)
def top_rotation(speed, alpha):
    """Return the largest phi [rad] of a half-cycle on still ground that starts at phi = 0 with dphi/dtau = `speed`.

    Energy gives phi = alpha - 2 asin(r), r^2 = sin^2(alpha/2) - speed^2/4; the sine of the difference is expanded so
    that small motions stay accurate.
    """
    half_alpha = math.sin(0.5 * alpha)
    r = math.sqrt(max(0.0, half_alpha * half_alpha - 0.25 * speed * speed))
    numerator = 0.25 * speed * speed
    return 2.0 * math.asin(numerator / (half_alpha * math.sqrt(1.0 - r * r) + math.cos(0.5 * alpha) * r))
