"""Half-waves as impulses, each split where the block lifts off or lands inside it, lane by lane, on bare arrays.

.. note:: Units of :mod:`rocking.impulses.motion`: rotations over alpha_c, times p, x and x' positive away from the
   ground. A stretch of ground motion of impulse I whose centroid lies r before its end adds J sinh(p r) to x and J
   cosh(p r) to x' at the end, J = -side gain I/(p alpha_c). I and r of any stretch come from the ground velocity and
   displacement at its ends: I = v_2 - v_1, I r = d_2 - d_1 - v_1 (t_2 - t_1) (VALIDATION F10).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from rocking.impulses.motion import CRITICAL_TOLERANCE, hop, impact_speed, impacts_above, top
from rocking.response import IMPACT_CUTOFF, Outcome, Reason

__all__ = ["IMPACT_LIMIT", "GroundMotion", "Lanes", "Waves", "effective_lanes"]

#: Impacts followed inside one half-wave before a lane is UNRESOLVED.
IMPACT_LIMIT = 10_000

#: A block that leaves the ground slower than this is at rest [-]: it rises by less than 1e-12 of alpha_c.
SLOWEST = 1e-6

#: Hops that stay below this share of the peak so far may be ended together.
SMALL_HOP = 1e-3

#: The last step to a landing, times p [-], and the most steps; Newton's iteration then errs by less than a hundredth.
LANDING_TOLERANCE, LANDING_STEPS = 1e-8, 60

_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_IMPACT_LIMIT_REASON = int(Reason.IMPACT_LIMIT)


class GroundMotion(NamedTuple):
    """The ground motion at the samples of a record, its acceleration linear between them."""

    acceleration: np.ndarray  #: (n,) [m/s2]
    velocity: np.ndarray  #: (n,) [m/s]
    displacement: np.ndarray  #: (n,) [m]
    dt: float  #: [s]


class Waves(NamedTuple):
    """The half-waves of the record, one after the other."""

    bounds: np.ndarray  #: (k + 1,) their ends [s], increasing
    peaks: np.ndarray  #: (k,) largest abs(a_g) in each of them [m/s2]
    later: np.ndarray  #: (k,) largest abs(a_g) after each of them [m/s2]


class Lanes(NamedTuple):
    """The blocks, each under its own factor."""

    force: np.ndarray  #: (lanes,) reciprocal of the acceleration that lifts the block [s2/m]
    p: np.ndarray  #: (lanes,) [1/s]
    restitution: np.ndarray  #: (lanes,) C [-]


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _at(ground, time):
    """Ground acceleration between two samples."""
    acceleration = ground.acceleration
    index = min(int(time / ground.dt), acceleration.size - 2)
    share = time / ground.dt - index
    return acceleration[index] + share * (acceleration[index + 1] - acceleration[index])


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _moved(ground, time):
    """Ground velocity and displacement between two samples."""
    acceleration, dt = ground.acceleration, ground.dt
    index = min(int(time / dt), acceleration.size - 2)
    s = time - index * dt
    a, slope = acceleration[index], (acceleration[index + 1] - acceleration[index]) / dt
    velocity = ground.velocity[index]
    return (
        velocity + s * (a + 0.5 * s * slope),
        ground.displacement[index] + s * (velocity + s * (0.5 * a + s * slope / 6.0)),
    )


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _part(v1, d1, v2, d2, length):
    """Impulse of a stretch of ground motion, and how long before its end the centroid lies."""
    impulse = v2 - v1
    if impulse == 0.0:
        return 0.0, 0.0
    return impulse, min(max((d2 - d1 - v1 * length) / impulse, 0.0), length)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _flight(rotation, speed, push, lever, span):
    """State at the end of a stretch; the span and the lever are times p."""
    grown = math.exp(span)
    kick = math.exp(lever)
    y = (rotation - 1.0 + speed) * grown + push * kick
    z = (rotation - 1.0 - speed) / grown - push / kick
    return 1.0 + 0.5 * (y + z), 0.5 * (y - z)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _crossing(ground, begin, end, level, sign):
    """First time in [begin, end) at which abs(a_g), or sign a_g where sign is not 0, exceeds a level; inf if none."""
    acceleration, dt = ground.acceleration, ground.dt
    value = _at(ground, begin)
    if (abs(value) if sign == 0.0 else sign * value) > level:
        return begin
    for index in range(int(begin / dt) + 1, min(int(end / dt) + 2, acceleration.size)):
        value = abs(acceleration[index]) if sign == 0.0 else sign * acceleration[index]
        if value > level:
            before = acceleration[index - 1] if sign == 0.0 else sign * acceleration[index - 1]
            if sign == 0.0:
                before *= math.copysign(1.0, acceleration[index])
            time = max(begin, dt * (index - 1 + (level - before) / (value - before)))
            return time if time < end else np.inf
    return np.inf


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _highest(rotation, speed, end_rotation, end_speed, span):
    """Top of the cubic through both ends of a stretch in which the block rises and sinks."""
    mean = (end_rotation - rotation) / span
    cubic = speed + end_speed - 2.0 * mean
    square = mean - speed - cubic
    s = speed / (math.sqrt(max(square * square - 3.0 * cubic * speed, 0.0)) - square)
    return rotation + span * s * (speed + s * (square + s * cubic))


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _landing(ground, begin, low, high, rotation, speed, force, p):
    """Time and speed of the touch-down between two times, in flight at the first and below the ground at the other.

    Newton's iteration inside a bracket that each step tightens. It starts from the other end, or from the length of a
    hop under the push of the moment, 2 v/(1 - a): a short one would be reached from the end by halving alone.
    """
    v1, d1 = _moved(ground, begin)
    time, sinking = high, 0.0
    push = force * _at(ground, begin) / p
    if rotation == 0.0 and low == begin and push < 1.0:
        time = min(high, begin + 2.0 * speed / ((1.0 - push) * p))
    for _ in range(LANDING_STEPS):
        v2, d2 = _moved(ground, time)
        impulse, lever = _part(v1, d1, v2, d2, time - begin)
        x, v = _flight(rotation, speed, force * impulse, p * lever, p * (time - begin))
        sinking = max(-v, 0.0)
        if x > 0.0:
            low = time
        else:
            high = time
        step = -x / (v * p) if v < 0.0 else np.inf
        if p * abs(step) <= LANDING_TOLERANCE or p * (high - low) <= LANDING_TOLERANCE:
            break
        time = time + step if low < time + step < high else 0.5 * (low + high)
    return time, sinking


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _settles(ground, begin, end, speed, restitution, force, p, peak):
    """Whether a block that has just landed comes to rest, by ever smaller hops, before the half-wave ends.

    With the push at most a (in units of the threshold) a hop lasts 2 v/(1 - a), and all of them 2 v/((1 - a)(1 - C)).
    """
    strongest = force * _at(ground, begin)
    for _ in range(2):
        if not (strongest < 1.0 and restitution < 1.0):
            return False
        rest = begin + 2.0 * speed / ((1.0 - strongest) * (1.0 - restitution) * p)
        if rest >= end:
            return False
        strongest = max(strongest, force * _at(ground, rest))
    if speed * speed >= 2.0 * (1.0 - strongest) * SMALL_HOP * peak:
        return False
    return _crossing(ground, begin, rest, 1.0 / abs(force), 0.0) == np.inf


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def effective_lanes(first_lane, last_lane, ground, waves, lanes, longest, results):
    """Write what the lanes first_lane:last_lane answer; `longest` is the longest stretch taken as one impulse [1/p]."""
    dt = ground.dt
    bounds, peaks, later = waves
    for lane in range(first_lane, last_lane):
        f, rate, c = lanes.force[lane], lanes.p[lane], lanes.restitution[lane]
        level = np.inf if f == 0.0 else 1.0 / f
        outcome, reason, overturned, impacts = _AT_REST, 0, -1, 0
        peak, overturning_time = 0.0, np.nan
        x, v, side, moving = 0.0, 0.0, 1.0, False
        for wave in range(peaks.size):
            if not moving and not peaks[wave] > level:
                continue
            time, end, landings = bounds[wave], bounds[wave + 1], 0
            while time < end:
                sure = time
                if not moving:
                    if not peaks[wave] > level:
                        break
                    time = _crossing(ground, time, end, level, 0.0)
                    if time == np.inf:
                        break
                    following = dt * (math.floor(time / dt) + 1.0)
                    inside = 0.5 * (time + min(end, following if following > time else following + dt))
                    side = -math.copysign(1.0, _at(ground, inside))
                    x, v, moving, outcome = 0.0, 0.0, True, _ROCKS
                    # The block cannot land before the push has fallen below the threshold again.
                    sure = min(end, _crossing(ground, inside, end, -level, side))
                target = min(end, time + longest / rate)
                if x == 0.0 and sure == time and -side * f * _at(ground, time) < 1.0:
                    # Near the ground the push before it exceeds the threshold must not be lumped with that after it.
                    lifting = _crossing(ground, time, end, level, -side)
                    target = lifting if time < lifting < target else target
                push = -side * f * rate
                v1, d1 = _moved(ground, time)
                v2, d2 = _moved(ground, target)
                impulse, lever = _part(v1, d1, v2, d2, target - time)
                span = rate * (target - time)
                end_x, end_v = _flight(x, v, push * impulse, rate * lever, span)
                if end_x > 0.0 or sure >= target:
                    end_x = max(end_x, 0.0)
                    if v > 0.0 and end_v < 0.0:
                        peak = max(peak, _highest(x, v, end_x, end_v, span))
                    peak = max(peak, end_x)
                    x, v, time = end_x, end_v, target
                    continue
                time, speed = _landing(ground, time, sure, target, x, v, push, rate)
                impacts += 1 if speed > IMPACT_CUTOFF else 0
                landings += 1
                x, v, side = 0.0, c * speed, -side
                if landings == IMPACT_LIMIT:
                    outcome, reason = _UNRESOLVED, _IMPACT_LIMIT_REASON
                    break
                if v <= SLOWEST:
                    moving = False
                elif v - 1.0 > f * max(peaks[wave], later[wave]):
                    break
                elif _settles(ground, time, end, v, c, -side * f, rate, peak):
                    impacts += impacts_above(v, c, IMPACT_CUTOFF)
                    moving = False
            if outcome == _UNRESOLVED:
                break
            if moving and x - 1.0 + v > f * later[wave]:
                outcome, overturned, overturning_time = _OVERTURNS, 1 + impacts, min(time, end)
                break
        if moving and outcome == _ROCKS:
            # The ground is at rest.
            if x - 1.0 + v < -CRITICAL_TOLERANCE:
                if x > 0.0:
                    peak = max(peak, top(x, v) if v > 0.0 else x)
                    speed = impact_speed(x, v)
                    impacts += 1 if speed > IMPACT_CUTOFF else 0
                    x, v = 0.0, c * speed
                    overturning_time = bounds[-1]
                peak = max(peak, hop(v)[0])
            if x - 1.0 + v >= -CRITICAL_TOLERANCE:
                outcome, overturned, overturning_time = _OVERTURNS, 1 + impacts, bounds[-1]
            else:
                more = impacts_above(v, c, IMPACT_CUTOFF)
                impacts = -1 if more < 0 else impacts + more
        if outcome == _OVERTURNS:
            peak = np.inf
        elif outcome == _UNRESOLVED:
            peak, impacts = np.nan, -1
        results.peak_rotation_ratio[lane] = peak
        results.overturning_time[lane] = overturning_time if outcome == _OVERTURNS else np.nan
        results.outcome[lane], results.reason[lane] = outcome, reason
        results.overturning_half_cycle[lane], results.impacts[lane] = overturned, impacts
