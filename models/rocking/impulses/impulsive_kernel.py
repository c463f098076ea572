"""Compiled kernel of the natural motion between impulses of the ground, in the units of half_cycle.py.

.. note:: `side` is +1 for theta > 0 and -1 for theta < 0; an impulse I of the ground changes x' by -side gain I/(p
   alpha_c).
"""

import math
from typing import NamedTuple

import numpy as np

from rocking.impulses import half_cycle
from rocking.kernel_cache import njit
from rocking.response import IMPACT_CUTOFF, Outcome, Reason

PAPER, LINEAR, EXACT, TANGENT = range(4)
#: Largest number of impacts computed between two impulses; a lane with more is UNRESOLVED.
IMPACT_LIMIT = 100_000
#: An impulse within this time (times p) of an impact acts at the time of the impact. Times of some hundred seconds have
#: rounding errors of 1e-13 s, which the instability of the motion multiplies by up to 1e3; a shift of an impact by
#: 1e-9/p changes the motion by no more than 1e-9.
COINCIDENCE = 1e-9
_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_IMPACT_LIMIT_REASON = int(Reason.IMPACT_LIMIT)
#: Longest time between two impulses in one growth factor, times p [-]; exp of more than about 709 overflows.
_LONGEST_GROWTH = 700.0
#: A growth factor over a shorter time, times p [-], is extended by the remaining time until the next impulse.
_SHORTEST_GROWTH = 100.0


class Train(NamedTuple):
    """The impulses of the ground in chronological order."""

    times: np.ndarray  #: (k,) times [s], not decreasing
    impulses: np.ndarray  #: (k,) signed sizes [m/s]
    sizes: np.ndarray  #: (k,) absolute values of the impulses [m/s]
    left: np.ndarray  #: (k,) sum of the absolute values from each impulse on [m/s]


class ImpulsiveLanes(NamedTuple):
    """The q m lanes, one for each of q scale factors on the impulses and each of m blocks."""

    scale: np.ndarray  #: (q, m) scale factor on the impulses [-]
    alpha: np.ndarray  #: (m,) alpha_c [rad]
    p: np.ndarray  #: (m,) frequency parameter [1/s]
    restitution: np.ndarray  #: (m,) restitution C [-]
    gravity: float  #: gravity [m/s2]
    gain: int  #: code of the gain: PAPER, LINEAR, EXACT or TANGENT


class History(NamedTuple):
    """The motion of each block at each scale factor and at given times."""

    times: np.ndarray  #: (h,) times [s], ascending; (0,) for no history
    motion: np.ndarray  #: (q m, h, 2) zeros that receive theta [rad] and theta' [rad/s]; NaN once the block lies down


@njit(_nrt=False)
def _cannot_come_back(growing, time, first, train, gain, p):
    """Return whether the block must overturn, as later impulses cannot make its growing mode negative."""
    total = 0.0
    for i in range(first, train.times.size):
        weight = gain * math.exp(-p * (train.times[i] - time))
        if growing > total + weight * train.left[i]:  # greater than the sum of all later impulses
            return True
        total += weight * train.sizes[i]
        if total >= growing:
            return False
    return growing > total


@njit(_nrt=False)
def _sample(history, lane, first, begin, end, scale, p, rotation, velocity):
    """Write the motion at the times of the history in [begin, end); return the index of the next time to be written."""
    times, motion = history.times, history.motion[lane]
    while first < times.size and times[first] < begin:
        first += 1
    while first < times.size and times[first] < end:
        x, v = half_cycle.state(rotation, velocity, p * (times[first] - begin))
        motion[first, 0], motion[first, 1] = scale * x, scale * p * v
        # The block lies on the ground.
        if not abs(motion[first, 0]) < 0.5 * math.pi:
            motion[first] = np.nan
        first += 1
    return first


@njit()
def _decays(velocity, restitution, remaining):
    """Return whether a free decay, which lasts from 2 u/(1 - C) to 2 atanh(u)/(1 - C), ends within `remaining`."""
    loss = 1.0 - restitution
    if 2.0 * velocity > loss * remaining:
        return False
    if math.log1p(2.0 * velocity / (1.0 - velocity)) <= loss * remaining:
        return True
    return half_cycle.free_decay_time(velocity, restitution) <= remaining


@njit(_nrt=False)
def _tabulate(waits, times, p):
    """Fill `waits` (3, k) with exp(p dt) - 1, sinh(p dt), cosh(p dt) - 1 for the times dt between impulses."""
    waits[:] = np.inf
    for i in range(times.size - 1):
        grown = math.expm1(min(p * (times[i + 1] - times[i]), _LONGEST_GROWTH))
        shrunk = grown / (1.0 + grown)
        waits[0, i], waits[1, i], waits[2, i] = grown, 0.5 * (grown + shrunk), 0.5 * grown * shrunk


@njit(_nrt=False)
def impulsive_lanes(first_lane, last_lane, train, lanes, waits, results, history):
    """Compute lanes first_lane to last_lane - 1 and write their results; `waits` (3, k) is working memory.

    Lane l is block l // q at the scale factor l % q, so that neighbouring lanes have the same p and the same `waits`.
    No logarithms are needed between events, because exp(p t) at an impact is an algebraic function of x and x'.
    """
    times, impulses = train.times, train.impulses
    total, factors, blocks = times.size, lanes.scale.shape[0], lanes.alpha.size
    growth, sinh, cosh_less_one = waits[0], waits[1], waits[2]
    samples = history.times.size
    tabulated = np.nan
    for lane in range(first_lane, last_lane):
        block, factor = lane // factors, lane % factors
        place = factor * blocks + block
        rate, c, angle = lanes.p[block], lanes.restitution[block], lanes.alpha[block]
        if rate != tabulated:
            _tabulate(waits, times, rate)
            tabulated = rate
        lane_gain = lanes.scale[factor, block] * rate / (lanes.gravity * angle)
        if lanes.gain == PAPER:
            lane_gain *= math.cos(angle)
        elif lanes.gain == TANGENT:
            lane_gain *= angle / math.tan(angle)
        outcome, reason, overturned, impacts = _AT_REST, 0, -1, 0
        # The peak is stored as its energy E = x (2 - x) + x'^2 and as 1 - E, which avoids cancellation.
        peak, energy, left, overturning_time = 0.0, 0.0, 1.0, np.nan
        rotation, velocity, side, moving, contact = 0.0, 0.0, 1.0, False, False
        bounces, sampled = 0, 0
        for i in range(total):
            last = i == total - 1
            push = -lane_gain * impulses[i]
            if lanes.gain == EXACT:
                push *= math.cos(angle * (1.0 - rotation))
            if push != 0.0:
                if not moving:
                    outcome = max(outcome, _ROCKS)
                    moving, side, rotation, velocity = True, math.copysign(1.0, push), 0.0, 0.0
                elif contact and side * push < 0.0:
                    # The impulse drives the block into the ground that it has just reached: the impact comes first.
                    impacts += 1 if abs(velocity) > IMPACT_CUTOFF else 0
                    bounces += 1
                    velocity, side = c * abs(velocity), -side
                velocity += side * push
            contact = False
            if not moving:
                continue
            ahead = growth[i]
            reserve = 0.0 if last else max(rate * (times[i + 1] - times[i]) - _LONGEST_GROWTH, 0.0)
            begin, bounce = times[i], 0
            # Upper bound of the time until the next impulse, which avoids most logarithms in the test for rest.
            longest = np.inf if last else rate * (times[i + 1] - times[i])
            while moving:
                if samples == 0 and not last and reserve == 0.0 and bounce > 0:
                    first = bounce
                    while rotation == 0.0 and bounce < IMPACT_LIMIT and 2.0 * velocity > (1.0 - c) * longest:
                        back = 2.0 * velocity / (1.0 - velocity)
                        if velocity >= 1.0 or not back < ahead - COINCIDENCE * (1.0 + ahead):
                            break
                        if bounce == first and velocity * velocity > energy:
                            energy, left = velocity * velocity, (1.0 - velocity) * (1.0 + velocity)
                        impacts += 1 if velocity > IMPACT_CUTOFF else 0
                        ahead = (ahead - back) / (1.0 + back)
                        longest -= 2.0 * velocity
                        velocity, side = c * velocity, -side
                        bounce += 1
                    bounces += bounce - first
                growing = rotation - 1.0 + velocity
                if bounce > 0 and not last and (samples > 0 or growing >= 0.0):
                    begin = times[i + 1] - (math.log1p(ahead) + reserve) / rate
                if (
                    outcome != _OVERTURNS
                    and growing >= (-half_cycle.CRITICAL_TOLERANCE if last else 0.0)
                    and (last or _cannot_come_back(growing, begin, i + 1, train, abs(lane_gain), rate))
                ):
                    outcome, overturned, overturning_time = _OVERTURNS, bounces + 1, begin
                if outcome == _OVERTURNS and sampled >= samples:
                    break
                if bounce == IMPACT_LIMIT:
                    outcome, reason = _UNRESOLVED, _IMPACT_LIMIT_REASON
                    break
                # A free decay that ends before the next impulse ends in rest; its hops only matter for the history.
                on_ground = rotation == 0.0 and 0.0 <= velocity < 1.0
                unseen = sampled >= samples or velocity <= IMPACT_CUTOFF or bounce >= IMPACT_LIMIT - 1
                if (bounce > 0 or not last) and on_ground and unseen and outcome != _OVERTURNS:
                    if c < 1.0 and 2.0 * velocity <= (1.0 - c) * longest:
                        longest = np.inf if last else math.log1p(ahead) + reserve
                        if _decays(velocity, c, longest - COINCIDENCE):
                            count = half_cycle.impacts_above(velocity, c, IMPACT_CUTOFF)
                            impacts += count
                            bounces += max(count, 1) if bounce == 0 else count
                            if velocity * velocity > energy:
                                energy, left = velocity * velocity, (1.0 - velocity) * (1.0 + velocity)
                            rotation, velocity, moving = 0.0, 0.0, False
                            break
                    elif last:
                        if velocity * velocity > energy:
                            energy, left = velocity * velocity, (1.0 - velocity) * (1.0 + velocity)
                        impacts = -1 if velocity > IMPACT_CUTOFF else impacts
                        moving = False
                        break
                speed = half_cycle.impact_speed(rotation, velocity)
                back = half_cycle.return_growth(rotation, velocity, speed)
                if samples > 0:
                    end = begin + min(math.log1p(back), math.log1p(ahead) + reserve) / rate
                    sampled = _sample(history, place, sampled, begin, end, side * angle, rate, rotation, velocity)
                if outcome == _OVERTURNS and last:
                    break
                window = COINCIDENCE * (1.0 + ahead)
                if last or back < ahead - window:
                    if velocity >= 0.0 and speed * speed > energy:
                        energy, left = speed * speed, (1.0 - rotation - velocity) * (1.0 - rotation + velocity)
                    peak = max(peak, rotation)
                    impacts += 1 if speed > IMPACT_CUTOFF else 0
                    bounces += 1
                    if last:
                        begin += math.log1p(back) / rate
                    else:
                        ahead = (ahead - back) / (1.0 + back)
                        if reserve > 0.0 and math.log1p(ahead) < _SHORTEST_GROWTH:
                            reserve += math.log1p(ahead)
                            ahead = math.expm1(min(reserve, _LONGEST_GROWTH))
                            reserve = max(reserve - _LONGEST_GROWTH, 0.0)
                    rotation, velocity, side = 0.0, c * speed, -side
                    moving = velocity > 0.0
                    bounce += 1
                    continue
                if bounce == 0:
                    sine, cosine = sinh[i], cosh_less_one[i]
                else:
                    shrunk = ahead / (1.0 + ahead)
                    sine, cosine = 0.5 * (ahead + shrunk), 0.5 * ahead * shrunk
                end_rotation, end_velocity = half_cycle.arc(rotation, velocity, sine, cosine)
                if velocity >= 0.0 and end_velocity <= 0.0 and growing < 0.0 and speed * speed > energy:
                    energy, left = speed * speed, (1.0 - rotation - velocity) * (1.0 - rotation + velocity)
                peak = max(peak, rotation)
                rotation, velocity = end_rotation, end_velocity
                if back <= ahead + window:
                    # The impact is moved to the impulse by less than the tolerance, keeping the decaying mode
                    # (z = x - 1 - x'): this removes the rounding errors that the growing mode has multiplied and that
                    # would shift a resonant train away from its impacts.
                    rotation, velocity, contact = 0.0, -max(rotation - velocity, 0.0), True
                else:
                    rotation = max(rotation, 0.0)
                    peak = max(peak, rotation)
                break
            if outcome == _UNRESOLVED or (outcome == _OVERTURNS and sampled >= samples):
                break
            if outcome == _OVERTURNS and angle * rotation > 0.5 * math.pi:
                # The block lies on the ground.
                history.motion[place, sampled:] = np.nan
                break
        peak = max(peak, energy / (1.0 + math.sqrt(left)))
        if outcome == _OVERTURNS:
            peak = np.inf
        elif outcome == _UNRESOLVED:
            peak, impacts = np.nan, -1
        results.peak_rotation_ratio[place], results.overturning_time[place] = peak, overturning_time
        results.outcome[place], results.reason[place] = outcome, reason
        results.overturning_half_cycle[place], results.impacts[place] = overturned, impacts
