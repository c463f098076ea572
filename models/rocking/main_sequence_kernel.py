"""Kernels of the main sequence in closed form: velocities, half-cycle of overturning, response and safety."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from rocking.half_cycle import stays_bounded
from rocking.motion import CRITICAL_TOLERANCE, hop, impacts_above
from rocking.response import Outcome, Reason
from rocking.sequence_kernel import UNLIMITED, repetitions

__all__ = [
    "amplification",
    "effective_amplification",
    "last_half_cycle",
    "overturning_half_cycle",
    "resonance_lanes",
    "safety_lanes",
    "start_of_half_cycle",
]

#: Half-cycles whose durations are added up before a lane is UNRESOLVED.
_HALF_CYCLE_LIMIT = 10_000_000

_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_HALF_CYCLE_LIMIT_REASON = int(Reason.HALF_CYCLE_LIMIT)


@njit(cache=True, nogil=True, error_model="numpy")
def amplification(restitution, half_cycle):
    """u_i/u_1 = (1 - C^i)/(1 - C) = 1 + C + ... + C^(i-1), the bracket of Eq. (5) with the erratum [-]."""
    if restitution == 1.0:
        return float(half_cycle)
    if restitution == 0.0:
        return 1.0
    return -math.expm1(half_cycle * math.log(restitution)) / (1.0 - restitution)


@njit(cache=True, nogil=True, error_model="numpy")
def overturning_half_cycle(main, restitution):
    """Half-cycle in which an endless main sequence overturns the block.

    Parameters
    ----------
    main : float
        u_1 = I/I_1c [-], not negative.
    restitution : float
        C [-].

    Returns
    -------
    half_cycle : int
        Smallest i with u_i >= 1, ceil(ln(1 - (1 - C)/u_1)/ln C); -1 where there is none (u_1 <= 1 - C).

    Notes
    -----
    u = 1 overturns. Both comparisons allow for rounding (`CRITICAL_TOLERANCE`): I_2c/I_1c must overturn in half-cycle
    2, and 0.1 is 1 - 0.9 although their floating-point numbers differ.

    Examples
    --------
    >>> overturning_half_cycle(0.2, 0.9), overturning_half_cycle(0.1, 0.9)
    (7, -1)
    """
    if main <= 0.0 or stays_bounded(main, 0.0, restitution):
        return -1
    needed = (1.0 - CRITICAL_TOLERANCE) / main
    if needed <= 1.0:
        return 1
    if restitution == 1.0:
        half_cycle = math.ceil(min(needed, 9e18))
    else:
        half_cycle = math.ceil(min(math.log1p(-(1.0 - restitution) * needed) / math.log(restitution), 9e18))
    # The logarithms may round across a whole number: the velocities decide.
    if amplification(restitution, half_cycle - 1) >= needed:
        return half_cycle - 1
    return half_cycle if amplification(restitution, half_cycle) >= needed else half_cycle + 1


@njit(cache=True, nogil=True, error_model="numpy")
def resonance_lanes(first_lane, last_lane, table, floats, integers, main, duration, p, restitution, main_count, cutoff):
    """Response of the lanes first_lane:last_lane to the main sequence; writes into the three arrays after them.

    Parameters
    ----------
    first_lane, last_lane : int
        Lanes to work on.
    table, floats, integers : ndarray
        As for :func:`~rocking.sequence_kernel.sequence_lanes`.
    main, duration : (n,) ndarray
        u_1 [-] and end of the main sequence [s] of each lane.
    p, restitution : (n,) ndarray
        Frequency parameter [1/s] and C [-].
    main_count : (n,) ndarray of int
        Largest number of main impulses.
    cutoff : float
        Speed above which an impact is counted [-].
    """
    rows = table.shape[1]
    for lane in range(first_lane, last_lane):
        u1, c, rate, most = main[lane], restitution[lane], p[lane], main_count[lane]
        critical = overturning_half_cycle(u1, c)
        outcome, reason, overturned, impacts, used = _AT_REST, 0, -1, 0, 0
        peak, overturning_time, start, velocity = 0.0, np.nan, 0.0, 0.0
        while u1 > 0.0 and start < duration[lane] and used < most:
            if used == _HALF_CYCLE_LIMIT:
                outcome, reason, peak, impacts = _UNRESOLVED, _HALF_CYCLE_LIMIT_REASON, np.nan, -1
                break
            outcome = _ROCKS
            previous = velocity
            velocity = u1 * amplification(c, used + 1)
            overturns = used + 1 == critical
            if overturns:
                peak, time = np.inf, np.inf
            else:
                # The critical velocity is the limit of the sequence at most, and rounding must not let it arrive.
                peak, time = hop(min(velocity, 1.0 - 2.0**-53))
            if used < rows:
                table[0, used, lane], table[1, used, lane], table[2, used, lane] = velocity, peak, time / rate
                table[3, used, lane] = 0.0
                table[5, used, lane] = np.nan if overturns else velocity
            used += 1
            if overturns:
                outcome, overturned, overturning_time = _OVERTURNS, used, start
                break
            start += time / rate
            counted = 1 if velocity > cutoff else 0
            impacts += counted
            if velocity == previous and critical < 0:
                # The velocity has reached its limit: the half-cycles that are left are counted, not followed.
                impacts += repetitions(start, time / rate, duration[lane], most - used) * counted
                break
        if outcome == _ROCKS:
            later = impacts_above(c * velocity, c, cutoff)
            impacts = -1 if later < 0 else impacts + later
        floats[0, lane], floats[1, lane], floats[2, lane] = peak, overturning_time, np.inf
        integers[0, lane], integers[1, lane], integers[2, lane] = outcome, reason, overturned
        integers[3, lane], integers[4, lane] = impacts, used


@njit(cache=True, nogil=True, error_model="numpy")
def effective_amplification(restitution, ratio, half_cycle):
    """v_i/u_1 = (1 - sigma) S_i + sigma/2 [-]: what decides on half-cycle i in the limit n -> infinity (F4).

    With u_(i+1) = C (u_i - sigma u_1) + u_1 the start velocity is u_i = u_1 [S_i - sigma (S_i - 1)], and the half-cycle
    is that of a start with v_i = u_i - sigma u_1/2. sigma = 0 is the main sequence alone.
    """
    return (1.0 - ratio) * amplification(restitution, half_cycle) + 0.5 * ratio


@njit(cache=True, nogil=True, error_model="numpy")
def start_of_half_cycle(needed, restitution, ratio, half_cycle):
    """Start of half-cycle N times p, needed = 1/u_1: sum over j < N of 2 atanh(v_j); inf where one overturns."""
    start = 0.0
    for earlier in range(1, half_cycle):
        start += hop(effective_amplification(restitution, ratio, earlier) / needed)[1]
    return start


@njit(cache=True, nogil=True, error_model="numpy")
def last_half_cycle(restitution, ratio, end, main_count):
    """Largest N <= main_count whose start, at the lower edge of its band of factors, is before `end` (times p)."""
    low, high = 1, 2
    while high <= main_count and _start_at_edge(restitution, ratio, high) < end:
        low, high = high, 2 * high
    high = min(high, main_count + 1)
    while high - low > 1:
        middle = (low + high) // 2
        if _start_at_edge(restitution, ratio, middle) < end:
            low = middle
        else:
            high = middle
    return low


@njit(cache=True, nogil=True, error_model="numpy")
def _start_at_edge(restitution, ratio, half_cycle):
    """Start of half-cycle N times p, at the factor that makes v_N = 1."""
    needed = effective_amplification(restitution, ratio, half_cycle)
    return start_of_half_cycle(needed, restitution, ratio, half_cycle)


@njit(cache=True, nogil=True, error_model="numpy")
def safety_lanes(first_lane, last_lane, factors, impulse, end, p, restitution, critical, main_count):
    """Smallest factor on the impulse that overturns: I_Nc/I of the last half-cycle that the input reaches.

    Parameters
    ----------
    first_lane, last_lane : int
        Lanes to work on.
    factors : (n,) ndarray
        Receives the factors [-]; inf for no impulse.
    impulse, end : (n,) ndarray
        I [m/s] and end of the main sequence [s].
    p, restitution, critical : (n,) ndarray
        Frequency parameter [1/s], C [-] and I_1c [m/s].
    main_count : (n,) ndarray of int
        Largest number of main impulses.
    """
    for lane in range(first_lane, last_lane):
        c, last = restitution[lane], main_count[lane]
        if end[lane] != np.inf:
            last = last_half_cycle(c, 0.0, p[lane] * end[lane], last)
        factors[lane] = critical[lane] / (impulse[lane] * amplification(c, last))
        if last == UNLIMITED and c == 1.0:
            factors[lane] = np.inf if impulse[lane] == 0.0 else 0.0
