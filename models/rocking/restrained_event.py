"""The events inside a step of a body under ties, loads and thrusts, and its motion after the record."""

from __future__ import annotations

import math

from numba import njit

from rocking import corner_event as more
from rocking import slots as row
from rocking.finish import HALVED, IMPACT, LOOK_CLOSER, NOTHING, OVER, finish_steps
from rocking.polynomial import ORDER, PULL, SPEED, acceleration, bracketed_root, first_impact, value, velocity
from rocking.recorded_event import SHORTEST
from rocking.restrained import act, change, land
from rocking.restrained_steps import restrained_steps

__all__ = ["finish_held", "motion_after"]

#: Steps of the motion on the ground at rest that are taken before it counts as bounded.
MOST_STEPS = 2_000_000

#: Changes of what acts on a body that does not move, after which it is taken to be balanced for a step.
MOST_STALLS = 8.0

#: Turning points of a motion that never touches the ground again after which it counts as bounded.
MOST_TURNS = 4


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def first_turn(c, h, slides):
    """tau in [0, h] at which slides phi', positive at first, comes to zero; -1 if it does not."""
    low = h
    pull, end_pull = 2.0 * c[2] * slides, acceleration(c, h) * slides
    if c[1] * slides < 0.0 or (c[1] == 0.0 and pull < 0.0):
        return 0.0
    if pull < 0.0 < end_pull:  # the speed is least inside
        low = bracketed_root(c, PULL, 0.0, 0.0, h, -1.0)
    if velocity(c, low) * slides > 0.0:
        return -1.0
    return bracketed_root(c, SPEED, 0.0, 0.0, low, -1.0)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def resolve_held(f, j, c, block, lane, held):
    """As :func:`rocking.recorded_event.resolve_step`, up to the first impact or change of what acts on the body."""
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
        c[2] = max(c[2], 0.0)  # zero at the threshold itself: rounding must not press the block down
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
        # What is left below the ceiling falls to zero where phi reaches it.
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
        # Balanced to rounding where a tie begins to act: what the ground does next tips it.
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
        change(f, j, block, lane, held, 1.0 if up >= 0.0 else (-1.0 if down >= 0.0 else 0.0))


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def finish_held(f, i, width, c, lanes, held):
    """Finish the steps of the first `width` slots of restrained lanes, with impacts and changes of what acts on them.

    `lanes` is the number of blocks among the lanes.
    """
    finish_steps(f, width)
    for j in range(width):
        lane = i[row.LANE + j]
        if lane < 0:
            continue
        if f[row.EVENT + j] == LOOK_CLOSER:
            resolve_held(f, j, c, lane % lanes, lane, held)
        if f[row.EVENT + j] == IMPACT:
            more.turn_over(f, j)
            land(f, j, lane % lanes, lane, held)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def motion_after(f, i, j, c, lanes, held, g):
    """The motion of slot j on the ground at rest, as :func:`rocking.corner_event.free_motion` has it.

    It is marched in the work space `g` of one slot until each corner has seen a top from the ground, or until the body
    has turned back MOST_TURNS times without touching it: no tie or load adds energy, so what comes then is no larger.
    The impacts that follow are counted as if no tie yielded and no load slid any more.
    """
    block, lane = i[row.LANE + j] % lanes, i[row.LANE + j]
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
    act(w, 0, block, lane, held)
    peak, impacts, turns, tops = 0.0, 0, 0, 0
    arrival, p = math.nan, w[row.P]
    for _ in range(MOST_STEPS):
        speed, held_step = w[row.SPEED], False
        p = w[row.P]
        restrained_steps(w, 1)
        w[row.EVENT] = NOTHING
        finish_steps(w, 1)
        if w[row.EVENT] == LOOK_CLOSER:
            resolve_held(w, 0, c, block, lane, held)
        event = w[row.EVENT]
        time += w[row.PASSED] / p
        w[row.PASSED] = 0.0
        if event == OVER:
            return math.inf, time, impacts, 0
        peak = max(peak, w[row.PEAK] / w[row.ALPHA], w[more.OTHER_PEAK] / w[more.OTHER_ALPHA])
        held_step = event == HALVED
        if speed > 0.0 and w[row.SPEED] <= 0.0 and event != IMPACT and not held_step:
            turns += 1
        if event == IMPACT:
            # A hop that came back within one step has turned as well.
            tops += 1
            turns = 0
            last = w[row.ARRIVAL] / w[row.ALPHA]
            more.turn_over(w, 0)
            w[row.PASSED] = 0.0
            land(w, 0, block, lane, held)
            impacts += 1 if last >= more.IMPACT_CUTOFF else 0
            if tops >= 3 or w[row.SPEED] <= more.IMPACT_CUTOFF * w[row.ALPHA]:
                arrival = last
                break
        if turns >= MOST_TURNS:
            return peak, math.nan, 0, impacts
        if not held_step:
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
    odd, even = more.impacts_above_cutoff(first, own * other), more.impacts_above_cutoff(second, own * other)
    return peak, math.nan, 0, -1 if odd < 0 or even < 0 else impacts + odd + even
