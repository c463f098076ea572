"""Compiled kernel of the response to a record for bodies with two different corners, a wall or restraints."""

from typing import NamedTuple

import numpy as np

from rocking.kernel_cache import njit
from rocking.march import corner_event as more
from rocking.march import event, kernel, steps
from rocking.march import slots as row
from rocking.march.equations import linear_steps, nonlinear_steps
from rocking.march.restrained import begin_restraint, keep_peaks, rest_levels, restraint_after_impact
from rocking.march.restrained_event import finish_restrained, motion_after, restrained_steps
from rocking.march.slots import LEFT, Slots, empty_slots


class CornerLanes(NamedTuple):
    """The q m lanes of q scale factors on the record and m bodies: lane l is body l % m at scale factor l // m."""

    factors: np.ndarray  #: (q,) scale factor on the record over gravity [s2/m]
    gains: np.ndarray  #: (m,) additional factor of each body [-]
    alpha: np.ndarray  #: (2, m) angle of each corner [rad]
    p: np.ndarray  #: (2, m) frequency parameter of each corner [1/s]
    restitution: np.ndarray  #: (2, m) C of the impact that ends a rotation about each corner, or the rebound e [-]
    side: np.ndarray  #: (m,) 1.0 or -1.0 for a body beside a wall, 0.0 without a wall
    rotation: np.ndarray  #: (m,) theta at the first sample [rad]
    spin: np.ndarray  #: (m,) theta' at the first sample [rad/s]


def corner_slots() -> Slots:
    """Return empty slots that have rows for both corners."""
    return empty_slots(more.CORNER_ROWS, more.OTHER_ALPHA, row.P, more.OTHER_P)


@njit(_nrt=False)
def begin_corner_lane(f, i, j, lane, record, lanes, options, restraints):
    """Start the computation of a lane in slot j; return MOVING, or its final state if it ends at the first sample."""
    block = lane % lanes.side.size
    rotation, spin, side = lanes.rotation[block], lanes.spin[block], lanes.side[block]
    f[more.ONE_SIDED + j] = 1.0 if side != 0.0 else 0.0
    if side == 0.0:
        side = 1.0 if (rotation > 0.0 or (rotation == 0.0 and spin > 0.0)) else -1.0
    own = 0 if side > 0.0 else 1
    factor = lanes.factors[lane // lanes.side.size] * lanes.gains[block]
    f[more.EXTRA + j] = f[row.PEAK + j] = f[more.STALLS + j] = 0.0
    # First the other corner, whose values are then copied to the rows OTHER_..., and then the current corner.
    for turn in range(2):
        if turn == 1:
            for here, there in more.PAIRS:
                f[there + j] = f[here + j]
        corner = own if turn == 1 else 1 - own
        alpha, p, restitution = lanes.alpha[corner, block], lanes.p[corner, block], lanes.restitution[corner, block]
        kernel.take_corner(f, j, alpha, p, restitution, record.dt, options)
        f[more.FREE_LONGEST + j] = f[row.LONGEST + j]
    if f[more.ONE_SIDED + j] == 1.0:
        f[more.OTHER_THRESHOLD + j] = np.inf
    resting = kernel.take_state(f, i, j, lane, factor, side, rotation, spin, options.last_term)
    if restraints is not None:
        begin_restraint(f, j, block, lane, restraints)
        if resting:
            rest_levels(f, j, block, lane, restraints, True)
    if not event.enter_sample(f, j, record):
        return event.FLYING
    if not resting:
        return kernel.first_status(f, j, options.equation, record.extremes[LEFT, 0] * factor)
    status = more.wake_corner(f, i, j, record)
    if restraints is not None and status == event.MOVING:
        restraint_after_impact(f, j, block, lane, restraints)
    return status


@njit(_nrt=False)
def end_corner_lane(f, i, j, c, status, record, equation, count, restraints, work):
    """Return the results of the computation in slot j, in the order of :class:`rocking.response.LaneResults`."""
    impacts = int(f[row.IMPACTS + j])
    if restraints is not None:
        keep_peaks(f, j, i[row.LANE + j], restraints, status == event.OVERTURNED)
    if status == event.OVERTURNED:
        time = f[row.SAMPLE + j] * record.dt + f[row.PASSED + j] / f[row.P + j]
        return np.inf, kernel.OVERTURNS, kernel.NO_REASON, time, impacts + 1, impacts
    if status == event.IMPACT_LIMITED:
        return np.nan, kernel.UNRESOLVED, kernel.IMPACT_LIMIT, np.nan, -1, -1
    if status == event.FLYING:
        return np.nan, kernel.UNRESOLVED, kernel.FREE_FLIGHT, np.nan, -1, -1
    peak = max(f[row.PEAK + j] / f[row.ALPHA + j], f[more.OTHER_PEAK + j] / f[more.OTHER_ALPHA + j])
    if status == event.RESTING:
        outcome = kernel.ROCKS if i[row.MOVED + j] == 1 else kernel.AT_REST
        return peak, outcome, kernel.NO_REASON, np.nan, -1, impacts
    if restraints is None:
        after, wait, before, decay = more.free_motion(f, j, equation == event.LINEAR)
    else:
        after, wait, before, decay = motion_after(f, i, j, c, count, restraints, work)
        keep_peaks(work.f, 0, i[row.LANE + j], restraints, after == np.inf)
    if after == np.inf:
        impacts += before
        time = (record.acceleration.size - 1) * record.dt + wait
        return np.inf, kernel.OVERTURNS, kernel.NO_REASON, time, impacts + 1, impacts
    return max(peak, after), kernel.ROCKS, kernel.NO_REASON, np.nan, -1, -1 if decay < 0 else impacts + decay


@njit(_nrt=False)
def decide_corner(f, i, j, record, equation, far, count, restraints):
    """Return the state of body j after a step marked ATTENTION, and whether its computation has ended."""
    if f[row.EVENT + j] == steps.OVER:
        return event.OVERTURNED, True
    block, lane = i[row.LANE + j] % count, i[row.LANE + j]
    status = event.MOVING
    if f[row.EVENT + j] == steps.IMPACT:
        most = 0.0 if restraints is None else rest_levels(f, j, block, lane, restraints, False)
        status = more.after_impact(f, i, j, record, equation, far, most)
    if f[row.SAMPLE + j] >= record.acceleration.size - 1:
        return status, True
    if i[row.FLIES + j] == 1:
        return event.FLYING, True
    if status == event.RESTING:
        i[row.ENDED + j] = int(f[row.SAMPLE + j])
        if restraints is not None:
            rest_levels(f, j, block, lane, restraints, True)
        status = more.wake_corner(f, i, j, record)
        if status == event.MOVING:
            if restraints is not None:
                restraint_after_impact(f, j, block, lane, restraints)
            event.begin_step(f, j)
    return status, status != event.MOVING


@njit(_nrt=False)
def march_corners(first, last, record, lanes, options, slots, results, active, history, restraints, work):
    """Compute lanes as kernel.march_lanes does; `restraints` and `work` are None for bodies without restraints."""
    f, i, c = slots
    coming = first
    width = row.GROUP * min(row.WIDTH // row.GROUP, (last - first + row.GROUP - 1) // row.GROUP)
    running = 0
    far = history.shape[1] == 0
    equation = options.equation
    linear = equation == event.LINEAR
    left = record.extremes[LEFT]
    fastest = 1.0 if linear else np.inf
    count = lanes.side.size
    while running > 0 or coming < last:
        if restraints is not None:
            restrained_steps(f, width)
            finish_restrained(f, i, width, c, count, restraints)
        else:
            if linear:
                linear_steps(f, width)
            else:
                nonlinear_steps(f, width)
            steps.finish_steps(f, width)
            for j in range(width):
                if f[row.EVENT + j] == steps.LOOK_CLOSER and i[row.LANE + j] >= 0:
                    event.resolve_step(f, j, c, record, equation)
                if f[row.EVENT + j] == steps.IMPACT and i[row.LANE + j] >= 0:
                    more.turn_over(f, j)
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
                status, done = decide_corner(f, i, j, record, equation, far, count, restraints)
            while done:
                if lane >= 0:
                    active[lane] = int(f[row.ACTIVE + j])
                    ended = end_corner_lane(f, i, j, c, status, record, equation, count, restraints, work)
                    kernel.store_results(results, lane, *ended)
                    if status > event.RESTING:
                        history[lane, int(f[row.SAMPLE + j]) + 1 :] = np.nan
                    running -= 1
                if coming >= last:
                    kernel.empty_slot(f, i, j)
                    break
                lane = coming
                coming += 1
                running += 1
                status = begin_corner_lane(f, i, j, lane, record, lanes, options, restraints)
                if not far:
                    history[lane, 0, 0] = lanes.rotation[lane % count]
                    history[lane, 0, 1] = lanes.spin[lane % count]
                done = status != event.MOVING
                if not done:
                    event.begin_step(f, j)
        if coming >= last and 0 < running <= width - row.GROUP:
            width = row.compact_slots(f, i, width)
