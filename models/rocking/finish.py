"""The end of a step of every slot: nothing happened, an impact, or something that must be looked at closely."""

from __future__ import annotations

import math

from numba import njit

from rocking import slots as row

__all__ = ["HALVED", "IMPACT", "LOOK_CLOSER", "NOTHING", "OVER", "finish_steps", "keep_step", "speed_of", "value_of"]

# What happened in a step. From LOOK_CLOSER on the slot stays where it is: HALVED is to be tried again with half the
# step, OVER has overturned.
NOTHING, IMPACT, LOOK_CLOSER, HALVED, OVER = 0.0, 1.0, 2.0, 3.0, 4.0

#: The iteration for an impact is of third order: after a step below this share of the way, the rest is rounding.
CONVERGED = 3e-6


@njit(inline="always")
def value_of(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """phi(t) from the coefficients d_k = k c_k of its speed."""
    s = t * t
    low = d1 + t * ((1 / 2) * d2) + s * ((1 / 3) * d3 + t * ((1 / 4) * d4))
    high = ((1 / 5) * d5 + t * ((1 / 6) * d6)) + s * ((1 / 7) * d7 + t * ((1 / 8) * d8))
    high += (s * s) * ((1 / 9) * d9 + t * ((1 / 10) * d10))
    return c0 + t * (low + (s * s) * high)


@njit(inline="always")
def speed_of(t, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """phi'(t)."""
    s = t * t
    low = d1 + t * d2 + s * (d3 + t * d4)
    high = (d5 + t * d6) + s * (d7 + t * d8) + (s * s) * (d9 + t * d10)
    return low + (s * s) * high


@njit(inline="always")
def keep_step(f, j, end, end_speed, end_pull, strongest, marked, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Write what the step of slot j has found into the rows that :func:`finish_steps` reads."""
    f[row.RATE_2 + j] = d2
    f[row.RATE_3 + j] = d3
    f[row.RATE_4 + j] = d4
    f[row.RATE_5 + j] = d5
    f[row.RATE_6 + j] = d6
    f[row.RATE_7 + j] = d7
    f[row.RATE_8 + j] = d8
    f[row.RATE_9 + j] = d9
    f[row.RATE_10 + j] = d10
    f[row.END + j] = end
    f[row.END_SPEED + j] = end_speed
    f[row.END_PULL + j] = end_pull
    f[row.STRONGEST + j] = strongest
    f[row.MARKED + j] = 1.0 if marked else 0.0


@njit(inline="always")
def correction(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10):
    """Step of third order from t towards the root of phi: Newton's, bent by the curvature."""
    inverse = 1.0 / speed_of(t, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10)
    newton = value_of(t, c0, d1, d2, d3, d4, d5, d6, d7, d8, d9, d10) * inverse
    pull = d2 + t * (2.0 * d3 + t * (3.0 * d4))
    return newton * (1.0 + 0.5 * newton * inverse * pull)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"}, _nrt=False)
def finish_steps(f, width):
    """Write how the step of each of the first `width` slots ends: its state, EVENT, and ARRIVAL after an impact.

    A curve leaves its chord by at most h^2/8 max abs(phi''). Where phi'' < 0 all along, it lies above its chord and
    below its tangents: there is no impact if its end is above the ground, exactly one if it is below, and the
    crossing of the tangents is a roof over its top. That is what most impacts are. They are found from the first
    terms of a hop, or from the parabola through both ends of a fall; what this does not settle is left to
    :mod:`rocking.recorded_event`.
    """
    for j in range(width):
        phi = f[row.PHI + j]
        speed = f[row.SPEED + j]
        h = f[row.STEP + j]
        end = f[row.END + j]
        end_speed = f[row.END_SPEED + j]
        end_pull = f[row.END_PULL + j]
        d2 = f[row.RATE_2 + j]
        d3 = f[row.RATE_3 + j]
        d4 = f[row.RATE_4 + j]
        d5 = f[row.RATE_5 + j]
        d6 = f[row.RATE_6 + j]
        d7 = f[row.RATE_7 + j]
        d8 = f[row.RATE_8 + j]
        d9 = f[row.RATE_9 + j]
        d10 = f[row.RATE_10 + j]
        hop = phi == 0.0
        bend = (end - phi - speed * h) / (h * h)
        middle = 0.5 * d2 if hop else speed
        product = (4 / 3) * speed * d3 if hop else 4.0 * bend * phi
        way = 2.0 * (speed if hop else phi) / (math.sqrt(max(middle * middle - product, 0.0)) - middle)
        t = min(max(way, 0.0), h)
        t -= correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        t -= correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        last = correction(t, phi, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)
        t -= last
        arrival = -speed_of(t, speed, d2, d3, d4, d5, d6, d7, d8, d9, d10)

        peak = f[row.PEAK + j]
        strongest = f[row.STRONGEST + j]
        margin = 0.125 * h * h * strongest
        arched = (d2 < 0.0) & (end_pull < 0.0)
        down = end <= 0.0
        near = (min(phi, end) <= margin) & ~arched
        turns = (max(abs(speed), abs(end_speed)) < h * strongest) & (max(phi, end) + margin > peak)
        low = max(speed, 0.0) * (end - phi - end_speed * h) <= (peak - phi) * (speed - end_speed)
        found = (abs(last) <= CONVERGED * t) & (t <= h) & (arrival > 0.0) & low
        marked = f[row.MARKED + j] != 0.0
        impact = down & arched & found & ~marked
        closer = marked | near | (~down & turns) | (down & ~impact)

        f[row.ARRIVAL + j] = arrival
        f[row.EVENT + j] = LOOK_CLOSER if closer else (IMPACT if impact else NOTHING)
        f[row.PHI + j] = phi if closer else (0.0 if impact else end)
        f[row.SPEED + j] = speed if closer else (f[row.RESTITUTION + j] * arrival if impact else end_speed)
        f[row.SIDE + j] = -f[row.SIDE + j] if impact else f[row.SIDE + j]
        f[row.PASSED + j] += 0.0 if closer else (t if impact else h)
        f[row.PEAK + j] = peak if closer | impact else max(peak, end)
