"""Taylor steps of a body under ties, loads and thrusts; see :mod:`rocking.restrained`."""

from __future__ import annotations

from numba import njit

from rocking import corner_event as more
from rocking import slots as row
from rocking.finish import keep_step, speed_of, value_of
from rocking.nonlinear import sine_and_cosine

__all__ = ["restrained_steps"]


@njit(inline="always")
def restrained_rates(phi, speed, alpha, ground, ground_slope, lift, lift_slope, sine_2, cosine_2):
    """As :func:`rocking.nonlinear.nonlinear_rates`, with sine_2 sin(2 phi) + cosine_2 cos(2 phi) in -phi'' beside.

    a_k and b_k are the series of sin(2 phi) and cos(2 phi): k a_k = sum 2 d_j b_(k-j), k b_k = -sum 2 d_j a_(k-j).
    """
    d1 = speed
    s0, z0 = sine_and_cosine(alpha - phi)
    a0, b0 = sine_and_cosine(phi)
    a0, b0 = 2.0 * a0 * b0, 1.0 - 2.0 * a0 * a0
    d2 = -(lift * s0 + ground * z0) - (sine_2 * a0 + cosine_2 * b0)
    s1 = -d1 * z0
    z1 = d1 * s0
    a1 = 2.0 * d1 * b0
    b1 = -2.0 * d1 * a0
    d3 = (-1 / 2) * ((lift * s1 + lift_slope * s0) + (ground * z1 + ground_slope * z0) + (sine_2 * a1 + cosine_2 * b1))
    s2 = (-1 / 2) * (d1 * z1 + d2 * z0)
    z2 = (1 / 2) * (d1 * s1 + d2 * s0)
    a2 = d1 * b1 + d2 * b0
    b2 = -(d1 * a1 + d2 * a0)
    d4 = (-1 / 3) * ((lift * s2 + lift_slope * s1) + (ground * z2 + ground_slope * z1) + (sine_2 * a2 + cosine_2 * b2))
    s3 = (-1 / 3) * (d1 * z2 + (d2 * z1 + d3 * z0))
    z3 = (1 / 3) * (d1 * s2 + (d2 * s1 + d3 * s0))
    a3 = (2 / 3) * (d1 * b2 + (d2 * b1 + d3 * b0))
    b3 = (-2 / 3) * (d1 * a2 + (d2 * a1 + d3 * a0))
    d5 = (-1 / 4) * ((lift * s3 + lift_slope * s2) + (ground * z3 + ground_slope * z2) + (sine_2 * a3 + cosine_2 * b3))
    s4 = (-1 / 4) * ((d1 * z3 + d2 * z2) + (d3 * z1 + d4 * z0))
    z4 = (1 / 4) * ((d1 * s3 + d2 * s2) + (d3 * s1 + d4 * s0))
    a4 = (2 / 4) * ((d1 * b3 + d2 * b2) + (d3 * b1 + d4 * b0))
    b4 = (-2 / 4) * ((d1 * a3 + d2 * a2) + (d3 * a1 + d4 * a0))
    d6 = (-1 / 5) * ((lift * s4 + lift_slope * s3) + (ground * z4 + ground_slope * z3) + (sine_2 * a4 + cosine_2 * b4))
    s5 = (-1 / 5) * ((d1 * z4 + d2 * z3) + (d3 * z2 + (d4 * z1 + d5 * z0)))
    z5 = (1 / 5) * ((d1 * s4 + d2 * s3) + (d3 * s2 + (d4 * s1 + d5 * s0)))
    a5 = (2 / 5) * ((d1 * b4 + d2 * b3) + (d3 * b2 + (d4 * b1 + d5 * b0)))
    b5 = (-2 / 5) * ((d1 * a4 + d2 * a3) + (d3 * a2 + (d4 * a1 + d5 * a0)))
    d7 = (-1 / 6) * ((lift * s5 + lift_slope * s4) + (ground * z5 + ground_slope * z4) + (sine_2 * a5 + cosine_2 * b5))
    s6 = (-1 / 6) * ((d1 * z5 + d2 * z4) + (d3 * z3 + (d4 * z2 + (d5 * z1 + d6 * z0))))
    z6 = (1 / 6) * ((d1 * s5 + d2 * s4) + (d3 * s3 + (d4 * s2 + (d5 * s1 + d6 * s0))))
    a6 = (2 / 6) * ((d1 * b5 + d2 * b4) + (d3 * b3 + (d4 * b2 + (d5 * b1 + d6 * b0))))
    b6 = (-2 / 6) * ((d1 * a5 + d2 * a4) + (d3 * a3 + (d4 * a2 + (d5 * a1 + d6 * a0))))
    d8 = (-1 / 7) * ((lift * s6 + lift_slope * s5) + (ground * z6 + ground_slope * z5) + (sine_2 * a6 + cosine_2 * b6))
    s7 = (-1 / 7) * ((d1 * z6 + d2 * z5) + (d3 * z4 + d4 * z3) + (d5 * z2 + (d6 * z1 + d7 * z0)))
    z7 = (1 / 7) * ((d1 * s6 + d2 * s5) + (d3 * s4 + d4 * s3) + (d5 * s2 + (d6 * s1 + d7 * s0)))
    a7 = (2 / 7) * ((d1 * b6 + d2 * b5) + (d3 * b4 + d4 * b3) + (d5 * b2 + (d6 * b1 + d7 * b0)))
    b7 = (-2 / 7) * ((d1 * a6 + d2 * a5) + (d3 * a4 + d4 * a3) + (d5 * a2 + (d6 * a1 + d7 * a0)))
    d9 = (-1 / 8) * ((lift * s7 + lift_slope * s6) + (ground * z7 + ground_slope * z6) + (sine_2 * a7 + cosine_2 * b7))
    s8 = (-1 / 8) * ((d1 * z7 + d2 * z6) + (d3 * z5 + d4 * z4) + (d5 * z3 + d6 * z2) + (d7 * z1 + d8 * z0))
    z8 = (1 / 8) * ((d1 * s7 + d2 * s6) + (d3 * s5 + d4 * s4) + (d5 * s3 + d6 * s2) + (d7 * s1 + d8 * s0))
    a8 = (2 / 8) * ((d1 * b7 + d2 * b6) + (d3 * b5 + d4 * b4) + (d5 * b3 + d6 * b2) + (d7 * b1 + d8 * b0))
    b8 = (-2 / 8) * ((d1 * a7 + d2 * a6) + (d3 * a5 + d4 * a4) + (d5 * a3 + d6 * a2) + (d7 * a1 + d8 * a0))
    d10 = (-1 / 9) * ((lift * s8 + lift_slope * s7) + (ground * z8 + ground_slope * z7) + (sine_2 * a8 + cosine_2 * b8))
    return d2, d3, d4, d5, d6, d7, d8, d9, d10


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False)
def restrained_steps(f, width):
    """Take one Taylor step of the first `width` slots; :func:`rocking.finish.finish_steps` reads its rows.

    phi'' changes at most by h times a bound J of its derivative, and the speed by h times that of phi''. A step is
    marked, beside the reasons of :func:`rocking.nonlinear.nonlinear_steps`, where it may leave the range of its moment.
    """
    for j in range(width):
        phi = f[row.PHI + j]
        speed = f[row.SPEED + j]
        h = f[row.STEP + j]
        ground = f[row.GROUND + j] + f[more.COSINE + j]
        ground_slope = f[row.SLOPE + j]
        lift = f[row.LIFT + j] + f[more.SINE + j]
        lift_slope = f[row.LIFT_SLOPE + j]
        sine_2, cosine_2 = f[more.SINE_2 + j], f[more.COSINE_2 + j]
        d2, d3, d4, d5, d6, d7, d8, d9, d10 = restrained_rates(
            phi, speed, f[row.ALPHA + j], ground, ground_slope, lift, lift_slope, sine_2, cosine_2
        )
        end = value_of(h, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        end_speed = speed_of(h, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        # Gravity and ground; the restraints by their stiffness.
        own_lift, own_ground = f[row.LIFT + j], f[row.GROUND + j]
        push = max(own_lift, own_lift + h * lift_slope) + max(abs(own_ground), abs(own_ground + h * ground_slope))
        stiff = push + f[more.STIFFEST + j]
        slopes = abs(ground_slope) + abs(lift_slope)
        square = h * h
        share = square * stiff
        strongest = (abs(d2) + h * (stiff * abs(speed) + slopes)) / max(1.0 - share, 0.25)
        last_term = abs(d10) * (square * square) * (square * square) * square
        short = (last_term > f[row.TRUNCATION + j] * (f[row.ALPHA + j] + phi)) | (share > 0.75)
        margin = 0.125 * square * strongest
        out = max(phi, end) + margin >= f[more.CEILING + j]
        floor = f[more.FLOOR + j]
        back = (min(phi, end) - margin <= floor) & (floor > 0.0)
        slides = f[more.SLIDES + j]
        turns = (slides != 0.0) & (min(slides * speed, slides * end_speed) - h * strongest <= 0.0)
        end_pull = d2 + h * (
            2 * d3
            + h * (3 * d4 + h * (4 * d5 + h * (5 * d6 + h * (6 * d7 + h * (7 * d8 + h * (8 * d9 + h * (9 * d10)))))))
        )
        marked = short | out | back | turns
        keep_step(f, j, end, end_speed, end_pull, strongest, marked, d2, d3, d4, d5, d6, d7, d8, d9, d10)
