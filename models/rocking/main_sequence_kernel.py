"""Kernels of the main sequence in closed form: velocities, half-cycle of overturning, response and safety."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from rocking.half_cycle import stays_bounded
from rocking.motion import CRITICAL_TOLERANCE, hop, impacts_above
from rocking.response import IMPACT_CUTOFF, Outcome, Reason
from rocking.sequence_kernel import UNLIMITED, repetitions

__all__ = [
    "Lanes",
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


class Lanes(NamedTuple):
    """The lanes: each a block under a main sequence."""

    impulse: np.ndarray  #: (lanes,) I [m/s]
    duration: np.ndarray  #: (lanes,) end of the main sequence [s]
    main_count: np.ndarray  #: (lanes,) of int, largest number of main impulses
    p: np.ndarray  #: (lanes,) [1/s]
    restitution: np.ndarray  #: (lanes,) C [-]
    critical: np.ndarray  #: (lanes,) I_1c [m/s]


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
    """Half-cycle in which an endless main sequence, u_1 = I/I_1c >= 0, overturns the block.

    It is the smallest i with u_i >= 1, ceil(ln(1 - (1 - C)/u_1)/ln C); -1 where there is none (u_1 <= 1 - C). u = 1
    overturns. Both comparisons allow for rounding (`CRITICAL_TOLERANCE`): I_2c/I_1c must overturn in half-cycle 2, and
    0.1 is 1 - 0.9 although their floating-point numbers differ.

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


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def resonance_lanes(first_lane, last_lane, lanes, results, table):
    """Write what the lanes first_lane:last_lane answer, and their :class:`rocking.sequence_kernel.Table`."""
    columns = table.columns
    rows = columns.shape[1]
    for lane in range(first_lane, last_lane):
        u1, c, rate = lanes.impulse[lane] / lanes.critical[lane], lanes.restitution[lane], lanes.p[lane]
        end, most = lanes.duration[lane], lanes.main_count[lane]
        critical = overturning_half_cycle(u1, c)
        outcome, reason, overturned, impacts, used = _AT_REST, 0, -1, 0, 0
        peak, overturning_time, start, velocity = 0.0, np.nan, 0.0, 0.0
        while u1 > 0.0 and start < end and used < most:
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
                columns[0, used, lane], columns[1, used, lane], columns[2, used, lane] = velocity, peak, time / rate
                columns[3, used, lane] = 0.0
                columns[5, used, lane] = np.nan if overturns else velocity
            used += 1
            if overturns:
                outcome, overturned, overturning_time = _OVERTURNS, used, start
                break
            start += time / rate
            counted = 1 if velocity > IMPACT_CUTOFF else 0
            impacts += counted
            if velocity == previous and critical < 0:
                # The velocity has reached its limit: the half-cycles that are left are counted, not followed.
                impacts += repetitions(start, time / rate, end, most - used) * counted
                break
        if outcome == _ROCKS:
            later = impacts_above(c * velocity, c, IMPACT_CUTOFF)
            impacts = -1 if later < 0 else impacts + later
        results.peak_rotation_ratio[lane], results.overturning_time[lane] = peak, overturning_time
        results.outcome[lane], results.reason[lane] = outcome, reason
        results.overturning_half_cycle[lane], results.impacts[lane] = overturned, impacts
        table.lowest[lane], table.followed[lane] = np.inf, used


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


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def safety_lanes(first_lane, last_lane, lanes, factors):
    """Smallest factor on the impulse that overturns: I_Nc/I of the last half-cycle that the input reaches.

    `factors` (lanes,) receives them [-]; inf for no impulse.
    """
    for lane in range(first_lane, last_lane):
        c, end, last = lanes.restitution[lane], lanes.duration[lane], lanes.main_count[lane]
        if end != np.inf:
            last = last_half_cycle(c, 0.0, lanes.p[lane] * end, last)
        factors[lane] = lanes.critical[lane] / (lanes.impulse[lane] * amplification(c, last))
        if last == UNLIMITED and c == 1.0:
            factors[lane] = np.inf if lanes.impulse[lane] == 0.0 else 0.0
