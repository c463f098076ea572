"""The half-cycles of a main and a secondary sequence one after the other, lane by lane, on bare arrays."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from rocking.half_cycle import CONTINUOUS, OPEN, corrected_duration, impact_speed_after, stays_bounded
from rocking.march import first_return, peak_and_lowest
from rocking.motion import CRITICAL_TOLERANCE, hop, impacts_above
from rocking.response import IMPACT_CUTOFF, Outcome, Reason

__all__ = ["COLUMNS", "HALF_CYCLE_LIMIT", "UNLIMITED", "Lanes", "Table", "repetitions", "sequence_lanes"]

#: Half-cycles followed in one lane before it is UNRESOLVED.
HALF_CYCLE_LIMIT = 50_000

#: A half-cycle that starts with the velocity of an earlier one, to this share of it, closes a cycle.
CYCLE_TOLERANCE = 1e-13

#: A number of main impulses that is no limit.
UNLIMITED = 2**62

#: Columns of the table, in the order of :class:`rocking.response.HalfCycles`: u_i, peak, duration, n_i, dT_i, u_r.
COLUMNS = 6

_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_HALF_CYCLE_LIMIT_REASON = int(Reason.HALF_CYCLE_LIMIT)


class Lanes(NamedTuple):
    """The lanes: each a block under a sequence, all with one spacing."""

    main: np.ndarray  #: (lanes,) u_1 [-]
    secondary: np.ndarray  #: (lanes,) a = u_1 I_s/I [-]
    p: np.ndarray  #: (lanes,) [1/s]
    restitution: np.ndarray  #: (lanes,) C [-]
    interval: np.ndarray  #: (lanes,) trial dT [s]
    duration: np.ndarray  #: (lanes,) end of the main sequence [s]
    main_count: np.ndarray  #: (lanes,) of int, largest number of main impulses
    intermediate: int  #: number n of intermediate impulses in a half-cycle; 0 for that of the trial march
    spacing: int  #: code of the spacing, see :mod:`rocking.half_cycle`


class Table(NamedTuple):
    """The half-cycles that a kernel writes beside its :class:`rocking.response.LaneResults`."""

    columns: np.ndarray  #: (COLUMNS, h, lanes) the first h half-cycles
    lowest: np.ndarray  #: (lanes,) smallest x inside a half-cycle [-]
    followed: np.ndarray  #: (lanes,) of int, half-cycles before the motion ends or repeats itself


@njit(cache=True, nogil=True, error_model="numpy")
def _half_cycle(velocity, secondary, interval, fixed_count, spacing, bounded):
    """Peak, duration, n, dT, impact speed and lowest rotation of one half-cycle; duration inf where it overturns."""
    if secondary == 0.0 or spacing == CONTINUOUS:
        count = 0 if secondary == 0.0 else -1
        effective = velocity - 0.5 * secondary
        if bounded:
            # A bounded motion tends to its limit velocity from below; rounding must not let it arrive.
            effective = min(effective, 1.0 - 2.0**-53)
        elif effective >= 1.0 - CRITICAL_TOLERANCE:
            return np.inf, np.inf, count, np.nan, np.nan, np.inf
        peak, time = hop(effective)
        return peak, time, count, np.nan, max(velocity - secondary, 0.0), np.inf
    count = fixed_count
    if count == 0:
        trial = first_return(velocity, secondary, interval, spacing)
        if trial == np.inf:
            trial = corrected_duration(velocity, secondary, 0, CONTINUOUS)
            if trial == np.inf:
                return np.inf, np.inf, -1, np.nan, np.nan, np.inf
        count = max(2, 2 * math.floor(trial / (2.0 * interval) + 0.5))
    time = corrected_duration(velocity, secondary, count, spacing)
    if time == np.inf:
        return np.inf, np.inf, count, np.nan, np.nan, np.inf
    peak, lowest = peak_and_lowest(velocity, secondary, time, count, spacing)
    corrected = time / (count + 1 if spacing == OPEN else count)
    return peak, time, count, corrected, impact_speed_after(velocity, secondary, time, count, spacing), lowest


@njit(cache=True, nogil=True, error_model="numpy")
def repetitions(start, time, duration, main_count):
    """Number of half-cycles of one length that still start before the end of the main sequence; -1 without end."""
    left = (duration - start) / time
    if left == np.inf:
        return -1 if main_count > UNLIMITED // 2 else main_count
    return min(main_count, math.ceil(min(left, 1e18)))


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def sequence_lanes(first_lane, last_lane, lanes, results, table):
    """Write what the lanes first_lane:last_lane answer, and their half-cycles."""
    columns = table.columns
    rows = columns.shape[1]
    for lane in range(first_lane, last_lane):
        u1, a, c, rate = lanes.main[lane], lanes.secondary[lane], lanes.restitution[lane], lanes.p[lane]
        end, most = lanes.duration[lane], lanes.main_count[lane]
        outcome, reason, overturned, impacts = _AT_REST, 0, -1, 0
        peak, overturning_time, lowest = 0.0, np.nan, np.inf
        bounded = u1 > 0.0 and (a == 0.0 or lanes.spacing == CONTINUOUS) and stays_bounded(u1, a / u1, c)
        endless = end == np.inf and most > UNLIMITED // 2
        velocity, start, index, used = u1, 0.0, 0, 0
        mark, next_mark = np.nan, 1
        while u1 > 0.0:
            if index == HALF_CYCLE_LIMIT:
                outcome, reason, peak, impacts = _UNRESOLVED, _HALF_CYCLE_LIMIT_REASON, np.nan, -1
                break
            outcome = _ROCKS
            highest, time, count, corrected, speed, inside = _half_cycle(
                velocity, a, rate * lanes.interval[lane], lanes.intermediate, lanes.spacing, bounded
            )
            if index < rows:
                columns[0, index, lane], columns[1, index, lane], columns[2, index, lane] = (
                    velocity,
                    highest,
                    time / rate,
                )
                columns[3, index, lane], columns[4, index, lane], columns[5, index, lane] = (
                    count,
                    corrected / rate,
                    speed,
                )
            index += 1
            used = index
            peak, lowest = max(peak, highest), min(lowest, inside)
            if time == np.inf:
                outcome, overturned, overturning_time = _OVERTURNS, index, start
                break
            counted = 1 if speed > IMPACT_CUTOFF else 0
            impacts += counted
            start += time / rate
            following = c * speed + u1
            if start < end and index < most:
                if endless and abs(following - mark) <= CYCLE_TOLERANCE * mark:
                    impacts = -1  # a cycle of several half-cycles, all of which have been followed
                    break
                if abs(following - velocity) > 4e-16 * velocity:
                    velocity = following
                    if index == next_mark:
                        mark, next_mark = velocity, 2 * index
                    continue
                # The motion repeats itself: the half-cycles that are left are counted, not followed.
                repeated = repetitions(start, time / rate, end, most - index)
                if repeated < 0:
                    impacts = -1 if counted else 0
                    break
                impacts += repeated * counted
                index += repeated
                start += repeated * time / rate
            # An impact speed is below one (x(T) = 0 has a root only where it is), so a free decay does not overturn.
            peak = max(peak, hop(c * speed)[0])
            later = impacts_above(c * speed, c, IMPACT_CUTOFF)
            impacts = -1 if later < 0 else impacts + later
            break
        results.peak_rotation_ratio[lane], results.overturning_time[lane] = peak, overturning_time
        results.outcome[lane], results.reason[lane] = outcome, reason
        results.overturning_half_cycle[lane], results.impacts[lane] = overturned, impacts
        table.lowest[lane], table.followed[lane] = lowest, used
