"""Taylor steps of a body under ties, loads and thrusts; see :mod:`rocking.restrained`."""

from __future__ import annotations

from numba import njit

from rocking import corner_event as more
from rocking import slots as row
from rocking.finish import keep_step, speed_of, value_of
from rocking.nonlinear import sine_and_cosine

__all__ = ["restrained_steps"]


@njit(inline="always")
def restrained_rates(phi, speed, flat, flat_slope, steep, steep_slope, sine_2, cosine_2):
    """As :func:`rocking.nonlinear.nonlinear_rates`, for -phi'' = flat cos(phi) + steep sin(phi) + those of 2 phi.

    With s_k, z_k the series of sin(phi) and cos(phi) and w = steep + 2 sine_2 cos(phi) - 2 cosine_2 sin(phi): (k + 1)
    d_(k+2) = -[flat z + s w + cosine_2]_k.
    """
    d1 = speed
    s0, z0 = sine_and_cosine(phi)
    two_sine, two_cosine = 2.0 * sine_2, 2.0 * cosine_2
    w0 = steep + (two_sine * z0 - two_cosine * s0)
    d2 = -((flat * z0 + s0 * w0) + cosine_2)
    s1 = d1 * z0
    z1 = -d1 * s0
    w1 = steep_slope + (two_sine * z1 - two_cosine * s1)
    d3 = (-1 / 2) * ((flat * z1 + flat_slope * z0) + (s0 * w1 + s1 * w0))
    s2 = (1 / 2) * (d1 * z1 + d2 * z0)
    z2 = (-1 / 2) * (d1 * s1 + d2 * s0)
    w2 = two_sine * z2 - two_cosine * s2
    d4 = (-1 / 3) * ((flat * z2 + flat_slope * z1) + ((s0 * w2 + s1 * w1) + s2 * w0))
    s3 = (1 / 3) * ((d1 * z2 + d2 * z1) + d3 * z0)
    z3 = (-1 / 3) * ((d1 * s2 + d2 * s1) + d3 * s0)
    w3 = two_sine * z3 - two_cosine * s3
    d5 = (-1 / 4) * ((flat * z3 + flat_slope * z2) + ((s0 * w3 + s1 * w2) + (s2 * w1 + s3 * w0)))
    s4 = (1 / 4) * ((d1 * z3 + d2 * z2) + (d3 * z1 + d4 * z0))
    z4 = (-1 / 4) * ((d1 * s3 + d2 * s2) + (d3 * s1 + d4 * s0))
    w4 = two_sine * z4 - two_cosine * s4
    d6 = (-1 / 5) * ((flat * z4 + flat_slope * z3) + (((s0 * w4 + s1 * w3) + (s2 * w2 + s3 * w1)) + s4 * w0))
    s5 = (1 / 5) * (((d1 * z4 + d2 * z3) + (d3 * z2 + d4 * z1)) + d5 * z0)
    z5 = (-1 / 5) * (((d1 * s4 + d2 * s3) + (d3 * s2 + d4 * s1)) + d5 * s0)
    w5 = two_sine * z5 - two_cosine * s5
    d7 = (-1 / 6) * (
        (flat * z5 + flat_slope * z4) + (((s0 * w5 + s1 * w4) + (s2 * w3 + s3 * w2)) + (s4 * w1 + s5 * w0))
    )
    s6 = (1 / 6) * (((d1 * z5 + d2 * z4) + (d3 * z3 + d4 * z2)) + (d5 * z1 + d6 * z0))
    z6 = (-1 / 6) * (((d1 * s5 + d2 * s4) + (d3 * s3 + d4 * s2)) + (d5 * s1 + d6 * s0))
    w6 = two_sine * z6 - two_cosine * s6
    d8 = (-1 / 7) * (
        (flat * z6 + flat_slope * z5) + (((s0 * w6 + s1 * w5) + (s2 * w4 + s3 * w3)) + ((s4 * w2 + s5 * w1) + s6 * w0))
    )
    s7 = (1 / 7) * (((d1 * z6 + d2 * z5) + (d3 * z4 + d4 * z3)) + ((d5 * z2 + d6 * z1) + d7 * z0))
    z7 = (-1 / 7) * (((d1 * s6 + d2 * s5) + (d3 * s4 + d4 * s3)) + ((d5 * s2 + d6 * s1) + d7 * s0))
    w7 = two_sine * z7 - two_cosine * s7
    d9 = (-1 / 8) * (
        (flat * z7 + flat_slope * z6)
        + (((s0 * w7 + s1 * w6) + (s2 * w5 + s3 * w4)) + ((s4 * w3 + s5 * w2) + (s6 * w1 + s7 * w0)))
    )
    s8 = (1 / 8) * (((d1 * z7 + d2 * z6) + (d3 * z5 + d4 * z4)) + ((d5 * z3 + d6 * z2) + (d7 * z1 + d8 * z0)))
    z8 = (-1 / 8) * (((d1 * s7 + d2 * s6) + (d3 * s5 + d4 * s4)) + ((d5 * s3 + d6 * s2) + (d7 * s1 + d8 * s0)))
    w8 = two_sine * z8 - two_cosine * s8
    d10 = (-1 / 9) * (
        (flat * z8 + flat_slope * z7)
        + ((((s0 * w8 + s1 * w7) + (s2 * w6 + s3 * w5)) + ((s4 * w4 + s5 * w3) + (s6 * w2 + s7 * w1))) + s8 * w0)
    )
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
        ground, ground_slope = f[row.GROUND + j], f[row.SLOPE + j]
        lift, lift_slope = f[row.LIFT + j], f[row.LIFT_SLOPE + j]
        sine, cosine = f[more.SINE_ALPHA + j], f[more.COSINE_ALPHA + j]
        d2, d3, d4, d5, d6, d7, d8, d9, d10 = restrained_rates(
            phi,
            speed,
            (lift * sine + ground * cosine) + f[more.COSINE + j],
            lift_slope * sine + ground_slope * cosine,
            (ground * sine - lift * cosine) + f[more.SINE + j],
            ground_slope * sine - lift_slope * cosine,
            f[more.SINE_2 + j],
            f[more.COSINE_2 + j],
        )
        end = value_of(h, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        end_speed = speed_of(h, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        # Gravity and ground; the restraints by their stiffness.
        push = max(lift, lift + h * lift_slope) + max(abs(ground), abs(ground + h * ground_slope))
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
