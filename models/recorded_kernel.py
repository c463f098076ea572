"""Kernel of the response to a sampled accelerogram: one lane after the other through the record and beyond.

.. note:: Inside a sample the motion is a Taylor polynomial (see :mod:`rockpulse.models.polynomial`), from which
   impacts, peaks and overturning are located exactly; uplift is the exact crossing of the piecewise-linear record with
   the threshold. phi = s theta >= 0 and tau = p t, as in :mod:`rockpulse.models.linear` and
   :mod:`rockpulse.models.nonlinear`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rockpulse.models.linear import linear_after, linear_series
from rockpulse.models.nonlinear import nonlinear_after, nonlinear_series
from rockpulse.models.polynomial import ORDER, bracketed_root, first_impact, value, velocity
from rockpulse.models.response import IMPACT_CUTOFF, Outcome, Reason

__all__ = ["LINEAR", "NONLINEAR", "march_lanes"]

LINEAR, NONLINEAR = 0, 1
AT_REST, ROCKS, OVERTURNS, UNRESOLVED = (int(outcome) for outcome in Outcome)
NO_REASON, IMPACT_LIMIT, FREE_FLIGHT = int(Reason.NONE), int(Reason.IMPACT_LIMIT), int(Reason.FREE_FLIGHT)

#: How far above the threshold a block lifts, as a share of it: "strictly above" must not be decided by the last bit.
STRICTLY = 1e-14

#: Longest step of the Taylor polynomials as p dt [-]; a sample is divided where its own p dt is larger.
LONGEST_STEP = 0.04

#: Impacts followed inside one sample before the lane is given up (only a restitution next to one gets there).
IMPACTS_PER_SAMPLE = 100_000

#: A chatter is cut short only where its hops are below this share of the peak so far.
CHATTER_SHARE = 1e-3


@njit(cache=True, nogil=True, error_model="numpy")
def uplift_time(ground, slope, threshold, threshold_slope, remaining):
    """Time until abs(ground) exceeds the threshold, both linear in tau; -1 if it does not in the time that remains."""
    if abs(ground) > threshold:
        return 0.0
    end = ground + slope * remaining
    side = 1.0 if end > 0.0 else -1.0
    start_gap = threshold - side * ground
    end_gap = threshold + threshold_slope * remaining - side * end
    if end_gap >= 0.0:
        return -1.0
    return remaining * start_gap / (start_gap - end_gap)


@njit(cache=True, nogil=True, error_model="numpy")
def chatter_ends(speed, demand, demand_end, demand_slope, restitution, remaining, peak):
    """Whether the hops after an impact die out before the ground can lift the block again.

    Parameters
    ----------
    speed : float
        dphi/dtau right after an impact over the restoring acceleration of the resting block [-].
    demand, demand_end : float
        abs(a_g)/threshold at the impact and at the end of the sample [-].
    demand_slope : float
        Bound of the slope of abs(a_g)/threshold per unit of tau.
    restitution : float
        C [-].
    remaining : float
        Time tau to the end of the sample [-].
    peak : float
        Largest rotation so far, in the unit of `speed`.

    Notes
    -----
    Look no further than to where half the margin 1 - A is used up, or to the end of the sample. There the restoring
    acceleration stays above d = (1 - A) - w^2/(1 - A), so the first hop lasts less than T = 2 w/d, and the next ones
    shrink at least by q = C (1 + m T/(2 (1 - A))): all of them together last less than T/(1 - q). The motion after that
    instant is the same whether the hops are followed or not.
    """
    if demand >= 1.0:
        return False
    largest = max(demand, demand_end)
    window = remaining
    halfway = 0.5 * (1.0 + demand)
    if largest > halfway:
        largest = halfway
        window = min(remaining, (halfway - demand) / demand_slope)
    margin = 1.0 - largest
    floor = margin - speed * speed / margin
    if floor <= 0.0:
        return False
    hop = 2.0 * speed / floor
    ratio = restitution * (1.0 + 0.5 * demand_slope * hop / margin)
    return ratio < 1.0 and hop < window * (1.0 - ratio) and 0.5 * speed * speed / floor < CHATTER_SHARE * peak


@njit(cache=True, nogil=True, error_model="numpy")
def impacts_above_cutoff(speed, restitution):
    """Impacts of the free decay that are faster than the cut-off, the first one at `speed`; -1 if they never end."""
    if not speed >= IMPACT_CUTOFF:
        return 0
    if restitution >= 1.0:
        return -1
    if restitution <= 0.0:
        return 1
    return 1 + math.floor(math.log(IMPACT_CUTOFF / speed) / math.log(restitution))


@njit(cache=True, nogil=True, error_model="numpy")
def march(
    equation, acceleration, vertical, largest_left, dt, factor, alpha, p, restitution, gravity, rotation, spin, history
):
    """Follow one lane through the record and after it.

    Parameters
    ----------
    equation : int
        LINEAR or NONLINEAR.
    acceleration, vertical : (n,) ndarray
        a_g and a_v at the samples [m/s2].
    largest_left : (n,) ndarray
        Largest abs(a_g) from each sample on [m/s2].
    dt, factor, alpha, p, restitution, gravity : float
        Sampling interval [s], factor on the record [-], and the block.
    rotation, spin : float
        theta [rad] and theta' [rad/s] at the first sample.
    history : (n, 2) or (0, 2) ndarray
        Filled with theta [rad] and theta' [rad/s] at the samples.

    Returns
    -------
    tuple
        peak over alpha, outcome, reason, overturning time [s], impacts before overturning, impacts.
    """
    c = np.zeros(ORDER + 1)
    sine = np.zeros(ORDER + 1)
    cosine = np.zeros(ORDER + 1)
    length = p * dt
    steps = math.ceil(length / LONGEST_STEP)
    longest = length / steps
    g_factor = factor / gravity
    # Rest: abs(a_g)/g against (1 + a_v/g) x this; restoring: phi'' of the resting block on a still ground.
    threshold = (alpha if equation == LINEAR else math.tan(alpha)) * (1.0 + STRICTLY)
    restoring = alpha if equation == LINEAR else math.sin(alpha)
    cutoff = IMPACT_CUTOFF * alpha

    side = 1.0 if (rotation > 0.0 or (rotation == 0.0 and spin > 0.0)) else -1.0
    phi = abs(rotation)
    speed = side * spin / p
    resting = rotation == 0.0 and spin == 0.0
    moved = not resting
    peak = phi
    impacts = 0
    n = acceleration.size
    keep = history.shape[0] > 0
    if keep:
        history[0, 0] = rotation
        history[0, 1] = spin
    if equation == LINEAR:
        over = not resting and phi - alpha + speed > largest_left[0] * g_factor
    else:
        over = phi >= 0.5 * math.pi
    if over:
        return np.inf, OVERTURNS, NO_REASON, 0.0, impacts, impacts

    for k in range(n - 1):
        ground_start = acceleration[k] * g_factor
        ground_slope = (acceleration[k + 1] * g_factor - ground_start) / length
        lift_start = 1.0 + vertical[k] * g_factor
        lift_end = 1.0 + vertical[k + 1] * g_factor
        lift_slope = (lift_end - lift_start) / length
        if lift_start <= 0.0 or lift_end <= 0.0:
            return np.nan, UNRESOLVED, FREE_FLIGHT, np.nan, impacts, -1
        remaining = length
        hits = 0
        while remaining > 0.0:
            passed = length - remaining
            ground = ground_start + ground_slope * passed
            lift = lift_start + lift_slope * passed
            lifting = False
            if resting:
                wait = uplift_time(ground, ground_slope, lift * threshold, lift_slope * threshold, remaining)
                if wait < 0.0:
                    break
                remaining -= wait
                ground += ground_slope * wait
                lift += lift_slope * wait
                side = -1.0 if ground > 0.0 else 1.0
                phi = 0.0
                speed = 0.0
                resting = False
                moved = True
                lifting = True
                if remaining <= 0.0:
                    break
            h = min(longest, remaining)
            if remaining - h < 1e-9 * longest:
                h = remaining
            if equation == LINEAR:
                linear_series(c, phi, speed, alpha, side * ground, side * ground_slope)
            else:
                nonlinear_series(
                    c, sine, cosine, phi, speed, alpha, side * ground, side * ground_slope, lift, lift_slope
                )
            if lifting:
                c[2] = max(c[2], 0.0)  # zero at the threshold itself: rounding must not press the block down
            impact, largest = first_impact(c, h)
            if equation == NONLINEAR and largest >= 0.5 * math.pi:
                wait = h
                if value(c, h) > 0.5 * math.pi:
                    wait = bracketed_root(c, 0, 0.5 * math.pi, 0.0, h, -1.0)
                time = k * dt + (length - remaining + wait) / p
                return np.inf, OVERTURNS, NO_REASON, time, impacts, impacts
            peak = max(peak, largest)
            if impact < 0.0:
                phi = value(c, h)
                speed = velocity(c, h)
                remaining -= h
            else:
                arrival = -velocity(c, impact)
                remaining -= impact
                if arrival >= cutoff:
                    impacts += 1
                side = -side
                phi = 0.0
                speed = restitution * max(arrival, 0.0)
                hits += 1
                if hits > IMPACTS_PER_SAMPLE:
                    return np.nan, UNRESOLVED, IMPACT_LIMIT, np.nan, impacts, -1
                passed = length - remaining
                ground = ground_start + ground_slope * passed
                lift = lift_start + lift_slope * passed
                weakest = min(lift, lift_end)
                demand = abs(ground) / (lift * threshold)
                demand_end = abs(ground_start + ground_slope * length) / (lift_end * threshold)
                demand_slope = (abs(ground_slope) + abs(lift_slope) * threshold) / (weakest * threshold)
                scale = weakest * restoring
                resting = speed == 0.0
                if 0.0 < speed < cutoff:  # faster impacts are counted, so they are followed
                    resting = chatter_ends(
                        speed / scale, demand, demand_end, demand_slope, restitution, remaining, peak / scale
                    )
            if equation == LINEAR and not resting:
                ground = abs(ground_start + ground_slope * (length - remaining))
                left = max(ground, largest_left[k + 1] * g_factor)
                if phi - alpha + speed > left:
                    time = k * dt + (length - remaining) / p
                    return np.inf, OVERTURNS, NO_REASON, time, impacts, impacts
        if keep:
            history[k + 1, 0] = 0.0 if resting else side * phi
            history[k + 1, 1] = 0.0 if resting else side * speed * p

    if resting:
        return peak / alpha, (ROCKS if moved else AT_REST), NO_REASON, np.nan, impacts, impacts
    if equation == LINEAR:
        peak_after, wait, impacts_after, impact_speed = linear_after(phi, speed, alpha, restitution)
    else:
        peak_after, wait, impacts_after, impact_speed = nonlinear_after(phi, speed, alpha, restitution)
    if peak_after == np.inf:
        impacts += impacts_after
        return np.inf, OVERTURNS, NO_REASON, (n - 1) * dt + wait / p, impacts, impacts
    decay = impacts_above_cutoff(impact_speed, restitution)
    return max(peak, peak_after) / alpha, ROCKS, NO_REASON, np.nan, impacts, (-1 if decay < 0 else impacts + decay)


@njit(cache=True, nogil=True, error_model="numpy")
def march_lanes(
    equation,
    acceleration,
    vertical,
    largest_left,
    dt,
    gravity,
    factors,
    alpha,
    p,
    restitution,
    rotation,
    spin,
    peak,
    outcome,
    reason,
    time,
    half_cycle,
    impacts,
    history,
):
    """Every (factor, block) lane; results are written into the (q, m) arrays, histories into (q, m, n or 0, 2)."""
    for i in range(factors.size):
        for j in range(alpha.size):
            peak[i, j], outcome[i, j], reason[i, j], time[i, j], before, impacts[i, j] = march(
                equation,
                acceleration,
                vertical,
                largest_left,
                dt,
                factors[i],
                alpha[j],
                p[j],
                restitution[j],
                gravity,
                rotation[j],
                spin[j],
                history[i, j],
            )
            half_cycle[i, j] = before + 1 if outcome[i, j] == OVERTURNS else -1
