"""Taylor steps of a restrained body, their events, and the motion after the record."""

import math

from rocking.kernel_cache import njit
from rocking.march import corner_event as more
from rocking.march import slots as row
from rocking.march.equations import sine_and_cosine
from rocking.march.event import SHORTEST, impacts_above_cutoff
from rocking.march.polynomial import ORDER, PULL, SPEED, acceleration, bracketed_root, first_impact, value, velocity
from rocking.march.restrained import change_elements, restraint_after_impact, set_restraint
from rocking.march.steps import HALVED, IMPACT, LOOK_CLOSER, NOTHING, OVER, finish_steps, speed_of, store_step, value_of
from rocking.response import IMPACT_CUTOFF


@njit(inline="always")
def restrained_rates(phi, speed, flat, flat_slope, steep, steep_slope, sine_2, cosine_2):
    """Return the coefficients d_2 to d_10 of the series of phi' (equations.nonlinear_rates) for a restrained body.

    -phi'' = flat cos(phi) + steep sin(phi) + cosine_2 cos(2 phi) + sine_2 sin(2 phi). With series s, z of sin(phi),
    cos(phi) and w = steep + 2 sine_2 cos(phi) - 2 cosine_2 sin(phi): (k + 1) d_(k+2) = -[flat z + s w + cosine_2]_k.
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


@njit(fastmath={"contract"}, _nrt=False)
def restrained_steps(f, width):
    """Take Taylor steps as :func:`nonlinear_steps` does; also mark a step if phi may leave (FLOOR, CEILING)."""
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
        # Bounds from gravity and ground, and from the stiffness of the restraints.
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
        store_step(f, j, end, end_speed, end_pull, strongest, marked, d2, d3, d4, d5, d6, d7, d8, d9, d10)


#: Largest number of steps computed after the record; a longer motion counts as bounded.
MOST_STEPS = 2_000_000
#: Number of consecutive changes of a restraint without motion after which the body is kept in balance for one step.
MOST_STALLS = 8.0
#: Number of outward motions that reverse without an impact, after which a motion counts as bounded.
MOST_TURNS = 4


@njit(_nrt=False)
def first_turn(c, h, slides):
    """Return the first tau in [0, h] at which the speed, whose sign is `slides`, becomes zero; -1 if it does not."""
    low = h
    pull, end_pull = 2.0 * c[2] * slides, acceleration(c, h) * slides
    if c[1] * slides < 0.0 or (c[1] == 0.0 and pull < 0.0):
        return 0.0
    if pull < 0.0 < end_pull:  # the smallest speed is inside the step
        low = bracketed_root(c, PULL, 0.0, 0.0, h, -1.0)
    if velocity(c, low) * slides > 0.0:
        return -1.0
    return bracketed_root(c, SPEED, 0.0, 0.0, low, -1.0)


@njit(_nrt=False)
def resolve_restrained(f, j, c, block, lane, restraints):
    """Complete a step as event.resolve_step does, up to the first impact or change of a restraint."""
    phi, speed, h, alpha = f[row.PHI + j], f[row.SPEED + j], f[row.STEP + j], f[row.ALPHA + j]
    push = abs(f[row.LIFT + j]) + abs(f[row.GROUND + j]) + h * (abs(f[row.SLOPE + j]) + abs(f[row.LIFT_SLOPE + j]))
    too_long = abs(f[row.RATE_10 + j]) * h**10 > f[row.TRUNCATION + j] * (alpha + phi)
    too_long = too_long or h * h * (push + f[more.STIFFEST + j]) > 0.75
    if too_long and h > SHORTEST * f[row.LONGEST + j]:
        f[row.STEP + j] = 0.5 * h
        f[row.EVENT + j] = HALVED
        return
    floor, ceiling = f[more.FLOOR + j], f[more.CEILING + j]
    c[0] = max(phi - floor, 0.0)
    c[1] = speed
    for k in range(2, ORDER + 1):
        c[k] = f[row.RATE_2 + (k - 2) * row.WIDTH + j] / k
    inward = speed < 0.0 or (speed == 0.0 and c[2] < 0.0)
    if floor == 0.0 and phi == 0.0 and speed == 0.0:
        c[2] = max(c[2], 0.0)  # zero at uplift; rounding could make it negative
        inward = False
    if c[0] == 0.0 and inward:
        down, largest = 0.0, 0.0
    else:
        down, largest = first_impact(c, h, -1.0)
    until = h if down < 0.0 else down
    turn = first_turn(c, until, f[more.SLIDES + j]) if f[more.SLIDES + j] != 0.0 else -1.0
    if turn >= 0.0:
        until, down = turn, -1.0
    up = -1.0
    if largest + floor >= ceiling or value(c, until) + floor >= ceiling:
        # The remaining distance to the ceiling is zero when phi reaches it.
        for k in range(1, ORDER + 1):
            c[k] = -c[k]
        c[0] = max(ceiling - phi, 0.0)
        up = 0.0
        if c[0] > 0.0 or c[1] > 0.0 or (c[1] == 0.0 and c[2] > 0.0):
            up, _ = first_impact(c, until, -1.0)
        for k in range(1, ORDER + 1):
            c[k] = -c[k]
        c[0] = max(phi - floor, 0.0)
        if up >= 0.0:
            until, down, turn = up, -1.0, -1.0
    f[more.STALLS + j] = f[more.STALLS + j] + 1.0 if until == 0.0 and speed == 0.0 else 0.0
    if f[more.STALLS + j] > MOST_STALLS:
        # The body is in equilibrium, except for rounding, as a tie begins to act: it is kept there for this step.
        f[more.STALLS + j] = 0.0
        f[row.PASSED + j] += h
        f[row.EVENT + j] = NOTHING
        return
    if up >= 0.0 and ceiling >= f[row.TOP + j]:
        f[row.PASSED + j] += until
        f[row.EVENT + j] = OVER
        return
    f[row.PASSED + j] += until
    end, end_speed = value(c, until) + floor, velocity(c, until)
    f[row.PEAK + j] = max(f[row.PEAK + j], end, largest + floor if down >= 0.0 or (until == h and up < 0.0) else end)
    if down >= 0.0 and floor == 0.0:
        f[row.ARRIVAL + j] = max(-end_speed, 0.0)
        f[row.PHI + j] = 0.0
        f[row.SPEED + j] = f[row.RESTITUTION + j] * f[row.ARRIVAL + j]
        f[row.SIDE + j] = -f[row.SIDE + j]
        f[row.EVENT + j] = IMPACT
        return
    f[row.EVENT + j] = NOTHING
    if down >= 0.0:
        end, end_speed = floor, min(end_speed, 0.0)
    elif up >= 0.0:
        end, end_speed = ceiling, max(end_speed, 0.0)
    elif turn >= 0.0:
        end_speed = 0.0
    f[row.PHI + j], f[row.SPEED + j] = end, end_speed
    if down >= 0.0 or up >= 0.0 or turn >= 0.0:
        change_elements(f, j, block, lane, restraints, 1.0 if up >= 0.0 else (-1.0 if down >= 0.0 else 0.0))


@njit(_nrt=False)
def finish_restrained(f, i, width, c, bodies, restraints):
    """Complete the steps of the restrained bodies in the first `width` slots; `bodies` is the number of all bodies."""
    finish_steps(f, width)
    for j in range(width):
        lane = i[row.LANE + j]
        if lane < 0:
            continue
        if f[row.EVENT + j] == LOOK_CLOSER:
            resolve_restrained(f, j, c, lane % bodies, lane, restraints)
        if f[row.EVENT + j] == IMPACT:
            more.turn_over(f, j)
            restraint_after_impact(f, j, lane % bodies, lane, restraints)


@njit(_nrt=False)
def motion_after(f, i, j, c, bodies, restraints, g):
    """Compute the motion after the record in the working memory `g`; return the results of corner_event.free_motion.

    The computation ends after one half-cycle about each corner, or after MOST_TURNS reversals without an impact:
    restraints add no energy, so later rotations are no larger. Later impacts are counted as if no tie yielded and no
    load slid.
    """
    block, lane = i[row.LANE + j] % bodies, i[row.LANE + j]
    for k in range(more.CORNER_ROWS):
        g.f[k * row.WIDTH] = f[k * row.WIDTH + j]
    g.i[row.LANE] = lane
    w = g.f
    w[row.GROUND] = w[row.SLOPE] = w[row.LIFT_SLOPE] = 0.0
    w[row.LIFT] = 1.0
    w[row.PASSED] = time = 0.0
    w[row.PEAK] = w[row.PHI]
    w[more.OTHER_PEAK] = 0.0
    w[row.STEP] = w[row.LONGEST]
    set_restraint(w, 0, block, lane, restraints)
    peak, impacts, turns, tops = 0.0, 0, 0, 0
    arrival, p = math.nan, w[row.P]
    for _ in range(MOST_STEPS):
        speed, halved = w[row.SPEED], False
        p = w[row.P]
        restrained_steps(w, 1)
        w[row.EVENT] = NOTHING
        finish_steps(w, 1)
        if w[row.EVENT] == LOOK_CLOSER:
            resolve_restrained(w, 0, c, block, lane, restraints)
        event = w[row.EVENT]
        time += w[row.PASSED] / p
        w[row.PASSED] = 0.0
        if event == OVER:
            return math.inf, time, impacts, 0
        peak = max(peak, w[row.PEAK] / w[row.ALPHA], w[more.OTHER_PEAK] / w[more.OTHER_ALPHA])
        halved = event == HALVED
        if speed > 0.0 and w[row.SPEED] <= 0.0 and event != IMPACT and not halved:
            turns += 1
        if event == IMPACT:
            # Each impact ends a half-cycle, even if this lies within one step.
            tops += 1
            turns = 0
            last = w[row.ARRIVAL] / w[row.ALPHA]
            more.turn_over(w, 0)
            w[row.PASSED] = 0.0
            restraint_after_impact(w, 0, block, lane, restraints)
            impacts += 1 if last >= IMPACT_CUTOFF else 0
            if tops >= 3 or w[row.SPEED] <= IMPACT_CUTOFF * w[row.ALPHA]:
                arrival = last
                break
        if turns >= MOST_TURNS:
            return peak, math.nan, 0, impacts
        if not halved:
            w[row.STEP] = w[row.LONGEST]
    if math.isnan(arrival):
        return peak, math.nan, 0, impacts
    own, other = w[row.RESTITUTION], w[more.OTHER_RESTITUTION]
    if w[more.ONE_SIDED] == 1.0:
        other = own
    first = w[row.SPEED] / w[row.ALPHA]
    second = w[row.SPEED] * own * w[row.P] / (w[more.OTHER_P] * w[more.OTHER_ALPHA])
    if w[more.ONE_SIDED] == 1.0:
        second = own * first
    odd, even = impacts_above_cutoff(first, own * other), impacts_above_cutoff(second, own * other)
    return peak, math.nan, 0, -1 if odd < 0 or even < 0 else impacts + odd + even
