"""Natural motion of a block between impulses of the ground, lane by lane, on bare arrays (units of motion.py).

.. note:: `side` is +1 while the block rocks about its right-hand corner (theta > 0) and -1 on the left; x and x' are
   positive away from the ground. An impulse I of the ground changes theta'/(p alpha_c) by -gain I/(p alpha_c), that is
   x' by -side gain I/(p alpha_c).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rockpulse.models.motion import (
    CRITICAL_TOLERANCE,
    free_decay_time,
    hop,
    impact_speed,
    impacts_above,
    return_time,
    rise_time,
    state,
    top,
)
from rockpulse.models.response import Outcome, Reason

__all__ = ["COINCIDENCE", "EXACT", "IMPACT_LIMIT", "LINEAR", "PAPER", "impulsive_lanes"]

PAPER, LINEAR, EXACT = range(3)

#: Impacts followed between two impulses before a lane is UNRESOLVED.
IMPACT_LIMIT = 100_000

#: An impulse this close to an impact, as time times p, acts together with it. Times of some hundred seconds are
#: rounded by 1e-13 s and the instability of the motion multiplies that by up to 1e3; moving an impact by 1e-9/p moves
#: the motion by no more than 1e-9.
COINCIDENCE = 1e-9

_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_IMPACT_LIMIT_REASON = int(Reason.IMPACT_LIMIT)


@njit(cache=True, nogil=True, error_model="numpy")
def _later_pushes(times, pushes, p, later):
    """Sum over the impulses after each one of abs(dy_j) exp(-p (t_j - t_i)): what they may take from y."""
    last = times.shape[0] - 1
    later[last] = 0.0
    for i in range(last - 1, -1, -1):
        later[i] = math.exp(-p * (times[i + 1] - times[i])) * (pushes[i + 1] + later[i + 1])


@njit(cache=True, nogil=True, error_model="numpy")
def _gone(growing, later, last):
    """The no-return rule y(t) > sum over later impulses of abs(dy) exp(-p (t_i - t)); y >= 0 after the last one."""
    return growing >= -CRITICAL_TOLERANCE if last else growing > later


@njit(cache=True, nogil=True, error_model="numpy")
def _sample(grid, first, begin, end, scale, p, rotation, velocity, theta, theta_dot):
    """History of one arc at the grid times in [begin, end); returns the first index that is left."""
    while first < grid.shape[0] and grid[first] < begin:
        first += 1
    while first < grid.shape[0] and grid[first] < end:
        x, v = state(rotation, velocity, p * (grid[first] - begin))
        theta[first], theta_dot[first] = scale * x, scale * p * v
        # The block lies on the ground.
        if not abs(theta[first]) < 0.5 * math.pi:
            theta[first], theta_dot[first] = np.nan, np.nan
        first += 1
    return first


@njit(cache=True, nogil=True, error_model="numpy")
def _arc_peak(rotation, velocity, time):
    """Largest rotation of an arc of natural motion at a top inside it [-]; its start rotation where there is none."""
    return top(rotation, velocity) if rise_time(rotation, velocity) <= time else rotation


@njit(cache=True, nogil=True, error_model="numpy")
def impulsive_lanes(
    floats, integers, theta, theta_dot, times, impulses, scale, alpha, p, restitution, gravity, gain, cutoff, grid
):
    """Response of every lane; writes into the first four arrays.

    Parameters
    ----------
    floats : (2, n) ndarray
        Receives peak [-] and time of overturning [s].
    integers : (4, n) ndarray of int
        Receives outcome, reason, half-cycle of overturning, impacts.
    theta, theta_dot : (n, h) ndarray
        Receive rotation [rad] and velocity [rad/s] at the times of `grid`; given as zeros.
    times, impulses : (k,) ndarray
        Times [s], not decreasing, and impulses of the ground [m/s]; k at least 1.
    scale, alpha, p, restitution : (n,) ndarray
        Factor on the impulses [-], alpha_c [rad], frequency parameter [1/s], C [-] of each lane.
    gravity : float
        [m/s2].
    gain : int
        Code of the gain.
    cutoff : float
        Speed above which an impact is counted [-].
    grid : (h,) ndarray
        Times of the history [s]; empty for none.
    """
    total = times.shape[0]
    pushes, later = np.empty(total), np.empty(total)
    history = grid.shape[0]
    for lane in range(scale.shape[0]):
        rate, c, angle = p[lane], restitution[lane], alpha[lane]
        linear_gain = rate / (gravity * angle)
        lane_gain = linear_gain * math.cos(angle) if gain == PAPER else linear_gain
        for i in range(total):
            pushes[i] = lane_gain * abs(scale[lane] * impulses[i])
        _later_pushes(times, pushes, rate, later)
        outcome, reason, overturned, impacts = _AT_REST, 0, -1, 0
        peak, overturning_time = 0.0, np.nan
        rotation, velocity, side, moving, contact = 0.0, 0.0, 1.0, False, False
        bounces, sampled = 0, 0
        for i in range(total):
            last = i == total - 1
            push = -lane_gain * scale[lane] * impulses[i]
            if gain == EXACT:
                push *= math.cos(angle * (1.0 - rotation))
            if push != 0.0:
                if not moving:
                    outcome = max(outcome, _ROCKS)
                    moving, side, rotation, velocity = True, math.copysign(1.0, push), 0.0, 0.0
                elif contact and side * push < 0.0:
                    # The impulse drives the block into the ground that it has just reached: the impact comes first.
                    impacts += 1 if abs(velocity) > cutoff else 0
                    bounces += 1
                    velocity, side = c * abs(velocity), -side
                velocity += side * push
            remaining = np.inf if last else rate * (times[i + 1] - times[i])
            begin = times[i]
            contact = False
            for bounce in range(IMPACT_LIMIT + 1):
                if not moving:
                    break
                ahead = 0.0 if last else math.exp(-remaining) * (pushes[i + 1] + later[i + 1])
                if outcome != _OVERTURNS and _gone(rotation - 1.0 + velocity, ahead, last):
                    outcome, overturned, overturning_time, peak = _OVERTURNS, bounces + 1, begin, np.inf
                if outcome == _OVERTURNS and sampled >= history:
                    break
                if bounce == IMPACT_LIMIT:
                    outcome, reason, peak, impacts = _UNRESOLVED, _IMPACT_LIMIT_REASON, np.nan, -1
                    break
                # A free decay that ends before the next impulse ends in rest; its hops matter to a history only.
                on_ground = rotation == 0.0 and 0.0 <= velocity < 1.0
                unseen = sampled >= history or velocity <= cutoff or bounce >= IMPACT_LIMIT - 1
                if bounce > 0 and on_ground and unseen and outcome != _OVERTURNS:
                    if c < 1.0 and 2.0 * velocity <= (1.0 - c) * (remaining - COINCIDENCE):
                        if last or free_decay_time(velocity, c) <= remaining - COINCIDENCE:
                            count = impacts_above(velocity, c, cutoff)
                            impacts += count
                            bounces += count
                            peak = max(peak, hop(velocity)[0])
                            rotation, velocity, moving = 0.0, 0.0, False
                            break
                    elif last:
                        peak = max(peak, hop(velocity)[0])
                        impacts = -1 if velocity > cutoff else impacts
                        moving = False
                        break
                back = return_time(rotation, velocity)
                span = min(back, remaining)
                if history > 0:
                    sampled = _sample(
                        grid,
                        sampled,
                        begin,
                        begin + span / rate,
                        side * angle,
                        rate,
                        rotation,
                        velocity,
                        theta[lane],
                        theta_dot[lane],
                    )
                if outcome == _OVERTURNS and last:
                    break
                peak = max(peak, _arc_peak(rotation, velocity, span))
                if back > remaining + COINCIDENCE:
                    rotation, velocity = state(rotation, velocity, remaining)
                    rotation = max(rotation, 0.0)
                    peak = max(peak, rotation)
                    break
                if back >= remaining - COINCIDENCE:
                    # The impact is moved to the impulse by less than the tolerance, keeping the decaying mode
                    # (z = x - 1 - x'): that drops the rounding errors which the growing mode has multiplied and which
                    # would drive a resonant train off its impacts.
                    rotation, velocity = state(rotation, velocity, remaining)
                    rotation, velocity, contact = 0.0, -max(rotation - velocity, 0.0), True
                    break
                speed = impact_speed(rotation, velocity)
                impacts += 1 if speed > cutoff else 0
                bounces += 1
                remaining -= back
                begin += back / rate
                rotation, velocity, side = 0.0, c * speed, -side
                moving = velocity > 0.0
            if outcome == _UNRESOLVED or (outcome == _OVERTURNS and sampled >= history):
                break
            if outcome == _OVERTURNS and angle * rotation > 0.5 * math.pi:
                # The block lies on the ground.
                theta[lane, sampled:], theta_dot[lane, sampled:] = np.nan, np.nan
                break
        floats[0, lane], floats[1, lane] = peak, overturning_time
        integers[0, lane], integers[1, lane], integers[2, lane], integers[3, lane] = (
            outcome,
            reason,
            overturned,
            impacts,
        )
