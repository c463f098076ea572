"""Compiled kernel of the response to a record: it computes many lanes (one body under one scale factor) together.

Each lane is in a slot (slots.py), at its own sample. One pass of the loop takes a step in every slot, then treats the
events. When a lane has ended, the next one takes its slot; a body at rest advances to its next uplift at once.
"""

import math
from typing import NamedTuple

import numpy as np

from rocking.kernel_cache import njit
from rocking.march import corner_event, event, steps
from rocking.march import slots as row
from rocking.march.equations import linear_after, linear_steps, nonlinear_after, nonlinear_steps
from rocking.march.slots import LEFT
from rocking.response import Outcome, Reason

AT_REST, ROCKS, OVERTURNS, UNRESOLVED = (int(outcome) for outcome in Outcome)
NO_REASON, IMPACT_LIMIT, FREE_FLIGHT = int(Reason.NONE), int(Reason.IMPACT_LIMIT), int(Reason.FREE_FLIGHT)
#: Relative excess over the threshold at which a block lifts, so that rounding errors cannot lift it.
STRICTLY = 1e-14


class MarchLanes(NamedTuple):
    """The q m lanes of q scale factors on the record and m blocks: lane l is block l % m at scale factor l // m."""

    factors: np.ndarray  #: (q,) scale factor on the record over gravity [s2/m]
    gains: np.ndarray  #: (m,) additional factor of each block [-]
    alpha: np.ndarray  #: (m,) alpha_c [rad]
    p: np.ndarray  #: (m,) frequency parameter [1/s]
    restitution: np.ndarray  #: (m,) restitution C [-]
    rotation: np.ndarray  #: (m,) theta at the first sample [rad]
    spin: np.ndarray  #: (m,) theta' at the first sample [rad/s]
    levels: np.ndarray  #: (m, l) levels of the remaining build-up times gravity, descending [m/s2]; (m, 0) if unused
    above: np.ndarray  #: (m, l) of int, last sample with a build-up above each level, see :class:`.demand.Demand`


class Options(NamedTuple):
    """Options of the computation of a response: the equation, and the limits of the steps."""

    equation: int  #: LINEAR or NONLINEAR
    longest: float  #: longest step as p dt [-]
    last_term: float  #: largest last term of the series of a step, divided by alpha_c [-]
    settled: float  #: see :class:`rocking.march.demand.Demand`


@njit(_nrt=False)
def build_up_left(sample, factor, levels, last):
    """Return an upper bound of the build-up of speed (demand.py) after a sample; inf if it may exceed all `levels`."""
    for k in range(levels.size - 1, -1, -1):
        if last[k] < sample:
            return levels[k] * factor
    return np.inf


@njit(_nrt=False)
def first_safe_sample(factor, levels, last, settled):
    """Return the sample from which the build-up of speed stays below `settled`; inf if all `levels` are above it."""
    for k in range(levels.size):
        if levels[k] * factor < settled:
            return last[k] + 1.0
    return np.inf


@njit(_nrt=False)
def take_corner(f, j, alpha, p, restitution, dt, options):
    """Write into slot j the properties of the corner about which its body turns."""
    length = p * dt
    f[row.ALPHA + j] = alpha
    f[row.RESTITUTION + j] = restitution
    f[row.P + j] = p
    f[row.LENGTH + j] = length
    f[row.PER_SAMPLE + j] = 1.0 / length
    f[row.LONGEST + j] = length / math.ceil(length / options.longest * (1.0 - steps.REMNANT))
    f[row.THRESHOLD + j] = (alpha if options.equation == event.LINEAR else math.tan(alpha)) * (1.0 + STRICTLY)


@njit(_nrt=False)
def take_state(f, i, j, lane, factor, side, rotation, spin, last_term):
    """Write the initial state of a body into slot j; return whether the body is at rest."""
    resting = rotation == 0.0 and spin == 0.0
    i[row.LANE + j] = lane
    f[row.FACTOR + j] = factor
    f[row.SIDE + j] = side
    f[row.PHI + j] = f[row.PEAK + j] = abs(rotation)
    f[row.SPEED + j] = side * spin / f[row.P + j]
    f[row.LIFT + j] = f[row.SAMPLE_LIFT + j] = 1.0
    f[row.LIFT_SLOPE + j] = f[row.SAMPLE_LIFT_SLOPE + j] = 0.0
    f[row.TRUNCATION + j] = last_term
    f[row.TOP + j] = 0.5 * math.pi
    f[row.CALM_FROM + j] = np.inf
    f[row.SAMPLE + j] = f[row.IMPACTS + j] = 0.0
    i[row.MOVED + j] = 0 if resting else 1
    f[row.ACTIVE + j] = 0.0 if resting else 1.0
    i[row.ENDED + j] = -1
    i[row.FLIES + j] = i[row.SLOW + j] = 0
    return resting


@njit(_nrt=False)
def first_status(f, j, equation, strongest):
    """Return MOVING or OVERTURNED for body j in motion at the first sample; `strongest` is the largest abs(a_g)/g."""
    if equation == event.LINEAR:
        over = f[row.PHI + j] - f[row.ALPHA + j] + f[row.SPEED + j] > strongest
    else:
        over = f[row.PHI + j] >= 0.5 * math.pi
    return event.OVERTURNED if over else event.MOVING


# begin_lane, end_lane and decide have one caller each and are inlined: a call would copy their NamedTuples.
@njit(forceinline=True, _nrt=False)
def begin_lane(f, i, j, lane, record, lanes, options):
    """Start the computation of a lane in slot j; return MOVING, or its final state if it ends at the first sample."""
    block = lane % lanes.alpha.size
    factor = lanes.factors[lane // lanes.alpha.size] * lanes.gains[block]
    alpha, rotation, spin = lanes.alpha[block], lanes.rotation[block], lanes.spin[block]
    strongest = record.extremes[LEFT, 0] * factor
    side = 1.0 if (rotation > 0.0 or (rotation == 0.0 and spin > 0.0)) else -1.0
    take_corner(f, j, alpha, lanes.p[block], lanes.restitution[block], record.dt, options)
    resting = take_state(f, i, j, lane, factor, side, rotation, spin, options.last_term)
    if lanes.levels.size > 0:
        # Beyond this angle the ground motion cannot stop a block that moves outward.
        f[row.TOP + j] = min(0.5 * math.pi, alpha + math.atan(strongest))
        f[row.CALM_FROM + j] = first_safe_sample(factor, lanes.levels[block], lanes.above[block], options.settled)
    if resting and strongest <= f[row.THRESHOLD + j] and record.vertical.size == 0:
        return event.RESTING
    if not event.enter_sample(f, j, record):
        return event.FLYING
    return event.wake(f, i, j, record) if resting else first_status(f, j, options.equation, strongest)


@njit(_nrt=False)
def empty_slot(f, i, j):
    """Mark slot j as empty and set its steps to zero length."""
    i[row.LANE + j] = -1
    for name in (row.PHI, row.SPEED, row.STEP, row.PASSED, row.LENGTH, row.LONGEST, row.PER_SAMPLE, row.FACTOR):
        f[name + j] = 0.0


@njit(forceinline=True, _nrt=False)
def end_lane(f, i, j, status, record, equation):
    """Return the results of the computation in slot j, in the order of :class:`rocking.response.LaneResults`."""
    impacts = int(f[row.IMPACTS + j])
    alpha, restitution, p = f[row.ALPHA + j], f[row.RESTITUTION + j], f[row.P + j]
    if status == event.OVERTURNED:
        time = f[row.SAMPLE + j] * record.dt + f[row.PASSED + j] / p
        return np.inf, OVERTURNS, NO_REASON, time, impacts + 1, impacts
    if status == event.IMPACT_LIMITED:
        return np.nan, UNRESOLVED, IMPACT_LIMIT, np.nan, -1, -1
    if status == event.FLYING:
        return np.nan, UNRESOLVED, FREE_FLIGHT, np.nan, -1, -1
    peak = f[row.PEAK + j]
    if status == event.RESTING:
        outcome = ROCKS if i[row.MOVED + j] == 1 else AT_REST
        return peak / alpha, outcome, NO_REASON, np.nan, -1, impacts
    if status == event.CALM:
        return peak / alpha, ROCKS, NO_REASON, np.nan, -1, -1
    phi, speed = f[row.PHI + j], f[row.SPEED + j]
    if equation == event.LINEAR:
        peak_after, wait, impacts_after, impact_speed = linear_after(phi, speed, alpha, restitution)
    else:
        peak_after, wait, impacts_after, impact_speed = nonlinear_after(phi, speed, alpha, restitution)
    if peak_after == np.inf:
        impacts += impacts_after
        time = (record.acceleration.size - 1) * record.dt + wait / p
        return np.inf, OVERTURNS, NO_REASON, time, impacts + 1, impacts
    decay = event.impacts_above_cutoff(impact_speed, restitution)
    return max(peak, peak_after) / alpha, ROCKS, NO_REASON, np.nan, -1, -1 if decay < 0 else impacts + decay


@njit(forceinline=True, _nrt=False)
def store_results(results, lane, peak, outcome, reason, time, half_cycle, impacts):
    """Write the results for one body and scale factor into the arrays `results`."""
    results.peak_rotation_ratio[lane], results.overturning_time[lane] = peak, time
    results.outcome[lane], results.reason[lane] = outcome, reason
    results.overturning_half_cycle[lane], results.impacts[lane] = half_cycle, impacts


@njit(forceinline=True, _nrt=False)
def decide(f, i, j, record, lanes, options, far):
    """Return the state of body j after a step marked ATTENTION, and whether its computation has ended."""
    if f[row.EVENT + j] == steps.OVER:
        return event.OVERTURNED, True
    status = event.MOVING
    if f[row.EVENT + j] == steps.IMPACT:
        status = corner_event.after_impact(f, i, j, record, options.equation, far, None)
    if f[row.SAMPLE + j] >= record.acceleration.size - 1:
        return status, True
    if i[row.FLIES + j] == 1:
        return event.FLYING, True
    if status == event.RESTING:
        i[row.ENDED + j] = int(f[row.SAMPLE + j])
        status = event.wake(f, i, j, record)
        if status == event.MOVING:
            event.begin_step(f, j)
    elif f[row.EVENT + j] == steps.IMPACT and f[row.SAMPLE + j] >= f[row.CALM_FROM + j]:
        block = i[row.LANE + j] % lanes.alpha.size
        left = build_up_left(f[row.SAMPLE + j], f[row.FACTOR + j], lanes.levels[block], lanes.above[block])
        speed = f[row.SPEED + j] / (2.0 * math.sin(0.5 * f[row.ALPHA + j]))
        if speed + left <= options.settled:
            return event.CALM, True
    return status, status != event.MOVING


@njit(_nrt=False)
def march_lanes(first, last, record, lanes, options, slots, results, active, history):
    """Compute lanes (a body at a scale factor) first to last - 1; write results, `active` samples and `history`."""
    f, i, c = slots
    coming = first
    width = row.GROUP * min(row.WIDTH // row.GROUP, (last - first + row.GROUP - 1) // row.GROUP)
    running = 0
    far = history.shape[1] == 0
    linear = options.equation == event.LINEAR
    left = record.extremes[LEFT]
    fastest = 1.0 if linear else np.inf
    while running > 0 or coming < last:
        if linear:
            linear_steps(f, width)
        else:
            nonlinear_steps(f, width)
        steps.finish_steps(f, width)
        for j in range(width):
            if f[row.EVENT + j] == steps.LOOK_CLOSER and i[row.LANE + j] >= 0:
                event.resolve_step(f, j, c, record, options.equation)
        steps.advance_steps(f, width, record.acceleration, left, fastest)
        if record.vertical.size > 0:
            steps.advance_vertical(f, i, width, record.vertical)
        if not far:
            steps.keep_history(f, i, width, history)
        for j in range(width):
            lane = i[row.LANE + j]
            if f[row.ATTENTION + j] == 0.0 and (lane >= 0 or coming >= last):
                continue
            status, done = event.MOVING, lane < 0
            if not done:
                status, done = decide(f, i, j, record, lanes, options, far)
            while done:
                if lane >= 0:
                    active[lane] = int(f[row.ACTIVE + j])
                    store_results(results, lane, *end_lane(f, i, j, status, record, options.equation))
                    if status > event.RESTING:
                        history[lane, int(f[row.SAMPLE + j]) + 1 :] = np.nan
                    running -= 1
                if coming >= last:
                    empty_slot(f, i, j)
                    break
                lane = coming
                coming += 1
                running += 1
                status = begin_lane(f, i, j, lane, record, lanes, options)
                if not far:
                    block = lane % lanes.alpha.size
                    history[lane, 0, 0], history[lane, 0, 1] = lanes.rotation[block], lanes.spin[block]
                done = status != event.MOVING
                if not done:
                    event.begin_step(f, j)
        if coming >= last and 0 < running <= width - row.GROUP:
            width = row.compact_slots(f, i, width)
