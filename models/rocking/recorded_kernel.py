"""Kernel of the response to a sampled accelerogram: lanes marched side by side in slots, each at its own sample.

.. note:: One turn of the loop takes one step in every slot (:func:`rocking.linear.linear_steps`,
   :func:`rocking.nonlinear.nonlinear_steps`), then looks closely at the slots that were marked
   (:mod:`rocking.recorded_event`). A slot whose lane has ended takes the next lane; a lane at rest goes to its
   next uplift at once, so that every step is one of a moving block.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rocking import slots as row
from rocking.advance import REMNANT, advance_steps, advance_vertical, keep_history
from rocking.finish import IMPACT, LOOK_CLOSER, OVER, finish_steps
from rocking.ground import LEFT
from rocking.linear import linear_after, linear_steps
from rocking.nonlinear import nonlinear_after, nonlinear_steps
from rocking.recorded_event import (
    CALM,
    FLYING,
    IMPACT_LIMITED,
    LINEAR,
    MOVING,
    OVERTURNED,
    RESTING,
    after_impact,
    begin_step,
    enter_sample,
    impacts_above_cutoff,
    resolve_step,
    wake,
)
from rocking.response import Outcome, Reason

__all__ = ["march_lanes"]

AT_REST, ROCKS, OVERTURNS, UNRESOLVED = (int(outcome) for outcome in Outcome)
NO_REASON, IMPACT_LIMIT, FREE_FLIGHT = int(Reason.NONE), int(Reason.IMPACT_LIMIT), int(Reason.FREE_FLIGHT)

#: How far above the threshold a block lifts, as a share of it: "strictly above" must not be decided by the last bit.
STRICTLY = 1e-14


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def build_up_left(sample, factor, levels, last):
    """Build-up of the ground from a sample on, see :mod:`rocking.demand`; inf where it is not known."""
    for k in range(levels.size - 1, -1, -1):
        if last[k] < sample:
            return levels[k] * factor
    return np.inf


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def calm_from(factor, levels, last, settled):
    """First sample from which on the verdict may be settled; inf if there is none."""
    for k in range(levels.size):
        if levels[k] * factor < settled:
            return last[k] + 1.0
    return np.inf


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def begin_lane(
    equation,
    f,
    i,
    j,
    acceleration,
    vertical,
    found,
    dt,
    factor,
    alpha,
    p,
    restitution,
    rotation,
    spin,
    longest,
    last_term,
    levels,
    above,
    settled,
):
    """Put a lane into slot j; returns how it stands at the first sample, as :func:`resolve_step` does."""
    length = p * dt
    f[row.ALPHA + j] = alpha
    f[row.RESTITUTION + j] = restitution
    f[row.P + j] = p
    f[row.FACTOR + j] = factor
    f[row.LENGTH + j] = length
    f[row.PER_SAMPLE + j] = 1.0 / length
    f[row.LIFT + j] = 1.0
    f[row.LIFT_SLOPE + j] = 0.0
    f[row.LONGEST + j] = length / math.ceil(length / longest * (1.0 - REMNANT))
    f[row.THRESHOLD + j] = (alpha if equation == LINEAR else math.tan(alpha)) * (1.0 + STRICTLY)
    f[row.TRUNCATION + j] = last_term
    f[row.TOP + j] = 0.5 * math.pi
    f[row.CALM_FROM + j] = np.inf
    if levels.size > 0:
        # Beyond this angle the ground cannot turn back a block that moves outward.
        f[row.TOP + j] = min(0.5 * math.pi, alpha + math.atan(found[LEFT, 0] * factor))
        f[row.CALM_FROM + j] = calm_from(factor, levels, above, settled)
    f[row.SIDE + j] = 1.0 if (rotation > 0.0 or (rotation == 0.0 and spin > 0.0)) else -1.0
    f[row.PHI + j] = abs(rotation)
    f[row.SPEED + j] = f[row.SIDE + j] * spin / p
    f[row.PEAK + j] = abs(rotation)
    f[row.SAMPLE_LIFT + j] = 1.0
    f[row.SAMPLE_LIFT_SLOPE + j] = 0.0
    resting = rotation == 0.0 and spin == 0.0
    f[row.SAMPLE + j] = 0.0
    f[row.IMPACTS + j] = 0.0
    i[row.MOVED + j] = 0 if resting else 1
    f[row.ACTIVE + j] = 0.0 if resting else 1.0
    i[row.ENDED + j] = -1
    i[row.FLIES + j] = 0
    i[row.SLOW + j] = 0
    still = found[LEFT, 0] * factor <= f[row.THRESHOLD + j]
    if resting and still and vertical.size == 0:
        return RESTING
    if not enter_sample(f, i, j, acceleration, vertical, found):
        return FLYING
    if resting:
        return wake(f, i, j, acceleration, vertical, found)
    if equation == LINEAR:
        growing = f[row.PHI + j] - alpha + f[row.SPEED + j]
        return OVERTURNED if growing > found[LEFT, 0] * factor else MOVING
    return OVERTURNED if f[row.PHI + j] >= 0.5 * math.pi else MOVING


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def empty_slot(f, i, j):
    """Leave slot j without a lane: its steps have no length."""
    i[row.LANE + j] = -1
    for name in (row.PHI, row.SPEED, row.STEP, row.PASSED, row.LENGTH, row.LONGEST, row.PER_SAMPLE, row.FACTOR):
        f[name + j] = 0.0


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def end_lane(equation, status, f, i, j, dt, samples):
    """What a lane that has ended answers, in the order of the arrays of :func:`march_lanes`."""
    impacts, active = int(f[row.IMPACTS + j]), int(f[row.ACTIVE + j])
    alpha, restitution, p = f[row.ALPHA + j], f[row.RESTITUTION + j], f[row.P + j]
    if status == OVERTURNED:
        time = f[row.SAMPLE + j] * dt + f[row.PASSED + j] / p
        return np.inf, OVERTURNS, NO_REASON, time, impacts + 1, impacts, active
    if status == IMPACT_LIMITED:
        return np.nan, UNRESOLVED, IMPACT_LIMIT, np.nan, -1, -1, active
    if status == FLYING:
        return np.nan, UNRESOLVED, FREE_FLIGHT, np.nan, -1, -1, active
    peak = f[row.PEAK + j]
    if status == RESTING:
        outcome = ROCKS if i[row.MOVED + j] == 1 else AT_REST
        return peak / alpha, outcome, NO_REASON, np.nan, -1, impacts, active
    if status == CALM:
        return peak / alpha, ROCKS, NO_REASON, np.nan, -1, -1, active
    phi, speed = f[row.PHI + j], f[row.SPEED + j]
    if equation == LINEAR:
        peak_after, wait, impacts_after, impact_speed = linear_after(phi, speed, alpha, restitution)
    else:
        peak_after, wait, impacts_after, impact_speed = nonlinear_after(phi, speed, alpha, restitution)
    if peak_after == np.inf:
        impacts += impacts_after
        time = (samples - 1) * dt + wait / p
        return np.inf, OVERTURNS, NO_REASON, time, impacts + 1, impacts, active
    decay = impacts_above_cutoff(impact_speed, restitution)
    return max(peak, peak_after) / alpha, ROCKS, NO_REASON, np.nan, -1, -1 if decay < 0 else impacts + decay, active


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def decide(equation, f, i, j, acceleration, vertical, found, far, levels, above, settled):
    """How a slot goes on that needs attention.

    Returns
    -------
    status : int
        MOVING, RESTING, OVERTURNED, IMPACT_LIMITED, FLYING, or CALM: it will not overturn.
    done : bool
        Whether the lane has come to its end.
    """
    if f[row.EVENT + j] == OVER:
        return OVERTURNED, True
    status = after_impact(equation, f, i, j, acceleration, found, far) if f[row.EVENT + j] == IMPACT else MOVING
    if f[row.SAMPLE + j] >= acceleration.size - 1:
        return status, True
    if i[row.FLIES + j] == 1:
        return FLYING, True
    if status == RESTING:
        i[row.ENDED + j] = int(f[row.SAMPLE + j])
        status = wake(f, i, j, acceleration, vertical, found)
        if status == MOVING:
            begin_step(f, j)
    elif f[row.EVENT + j] == IMPACT and f[row.SAMPLE + j] >= f[row.CALM_FROM + j]:
        left = build_up_left(f[row.SAMPLE + j], f[row.FACTOR + j], levels, above)
        speed = f[row.SPEED + j] / (2.0 * math.sin(0.5 * f[row.ALPHA + j]))
        if speed + left <= settled:
            return CALM, True
    return status, status != MOVING


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def march_lanes(
    equation,
    first,
    last,
    acceleration,
    vertical,
    found,
    dt,
    factors,
    gains,
    alpha,
    p,
    restitution,
    rotation,
    spin,
    longest,
    last_term,
    levels,
    above,
    settled,
    peak,
    outcome,
    reason,
    time,
    half_cycle,
    impacts,
    active,
    history,
    f,
    i,
    c,
):
    """March lanes first to last - 1 of the flat (q m,) lanes, the block running fastest, and write their answers.

    Parameters
    ----------
    equation : int
        LINEAR or NONLINEAR.
    first, last : int
        The lanes.
    acceleration, vertical : (n,) ndarray
        a_g and a_v at the samples [m/s2]; vertical may be empty.
    found : (4, b + 1) ndarray
        Extremes of the record, see :mod:`rocking.ground`.
    dt : float
        Sampling interval [s].
    factors : (q,) ndarray
        Factor on the record over gravity [s2/m].
    gains : (m,) ndarray
        Factor of each block on top of it [-].
    alpha, p, restitution, rotation, spin : (m,) ndarray
        alpha_c [rad], p [1/s], C [-], theta [rad] and theta' [rad/s] at the first sample.
    longest : float
        Longest step as p dt [-].
    last_term : float
        Largest last term of the series of a step over alpha_c [-].
    levels, above : (m, l) ndarray
        Where only the verdict is asked for (nonlinear equation, no vertical): levels of the build-up over the factor,
        descending, and the last sample above each. Else (m, 0).
    settled : float
        See :class:`rocking.demand.Demand`.
    peak, outcome, reason, time, half_cycle, impacts, active : (q m,) ndarray
        Receive the answers.
    history : (q m, n, 2) or (q m, 0, 2) ndarray
        Zeros that receive theta [rad] and theta' [rad/s] at the samples, NaN after the lane has ended before the
        record.
    """
    blocks = alpha.size
    coming = first
    width = row.GROUP * min(row.WIDTH // row.GROUP, (last - first + row.GROUP - 1) // row.GROUP)
    running = 0
    far = history.shape[1] == 0
    left = found[LEFT]
    fastest = 1.0 if equation == LINEAR else np.inf
    while running > 0 or coming < last:
        if equation == LINEAR:
            linear_steps(f, width)
        else:
            nonlinear_steps(f, width)
        finish_steps(f, width)
        for j in range(width):
            if f[row.EVENT + j] == LOOK_CLOSER and i[row.LANE + j] >= 0:
                resolve_step(equation, f, i, j, c, acceleration, found)
        advance_steps(f, width, acceleration, left, fastest)
        if vertical.size > 0:
            advance_vertical(f, i, width, vertical)
        if not far:
            keep_history(f, i, width, history)
        for j in range(width):
            lane = i[row.LANE + j]
            if f[row.ATTENTION + j] == 0.0 and (lane >= 0 or coming >= last):
                continue
            done = lane < 0
            status = MOVING
            if not done:
                status, done = decide(
                    equation,
                    f,
                    i,
                    j,
                    acceleration,
                    vertical,
                    found,
                    far,
                    levels[lane % blocks],
                    above[lane % blocks],
                    settled,
                )
            while done:
                if lane >= 0:
                    (
                        peak[lane],
                        outcome[lane],
                        reason[lane],
                        time[lane],
                        half_cycle[lane],
                        impacts[lane],
                        active[lane],
                    ) = end_lane(equation, status, f, i, j, dt, acceleration.size)
                    if status > RESTING:
                        history[lane, int(f[row.SAMPLE + j]) + 1 :] = np.nan
                    running -= 1
                if coming >= last:
                    empty_slot(f, i, j)
                    break
                lane = coming
                coming += 1
                running += 1
                i[row.LANE + j] = lane
                block = lane % blocks
                status = begin_lane(
                    equation,
                    f,
                    i,
                    j,
                    acceleration,
                    vertical,
                    found,
                    dt,
                    factors[lane // blocks] * gains[block],
                    alpha[block],
                    p[block],
                    restitution[block],
                    rotation[block],
                    spin[block],
                    longest,
                    last_term,
                    levels[block],
                    above[block],
                    settled,
                )
                if history.shape[1] > 0:
                    history[lane, 0, 0] = rotation[block]
                    history[lane, 0, 1] = spin[block]
                done = status != MOVING
                if not done:
                    begin_step(f, j)
        if coming >= last and 0 < running <= width - row.GROUP:
            width = row.close_ranks(f, i, width)
