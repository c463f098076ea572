"""Compiled kernel of the half-cycles under a main and a secondary sequence, and the response from its results."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rocking.arguments import UNLIMITED
from rocking.impulses import half_cycle
from rocking.kernel_cache import njit
from rocking.lanes import split_lanes
from rocking.response import IMPACT_CUTOFF, HalfCycles, Outcome, Reason, Response, empty_results, response_of

#: Largest number of half-cycles computed in one lane; a lane with more is UNRESOLVED.
HALF_CYCLE_LIMIT = 50_000
#: The motion is periodic if a start velocity equals an earlier one within this relative tolerance.
CYCLE_TOLERANCE = 1e-13
#: Columns of the table, in the order of :class:`rocking.response.HalfCycles`: u_i, peak, duration, n_i, dT_i, u_r.
COLUMNS = 6
_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_HALF_CYCLE_LIMIT_REASON = int(Reason.HALF_CYCLE_LIMIT)


class SequenceLanes(NamedTuple):
    """Lanes for the kernel, each with one block under one sequence; all sequences have the same spacing."""

    main: np.ndarray  #: (lanes,) u_1 [-]
    secondary: np.ndarray  #: (lanes,) a = u_1 I_s/I [-]
    p: np.ndarray  #: (lanes,) frequency parameter [1/s]
    restitution: np.ndarray  #: (lanes,) restitution C [-]
    interval: np.ndarray  #: (lanes,) trial interval dT [s]
    duration: np.ndarray  #: (lanes,) end of the main sequence [s]
    main_count: np.ndarray  #: (lanes,) of int, largest number of main impulses
    intermediate: int  #: number n of intermediate impulses in a half-cycle; 0 to find it with the trial interval
    spacing: int  #: code of the spacing, see :mod:`rocking.impulses.half_cycle`


class HalfCycleTable(NamedTuple):
    """The table of half-cycles, which a kernel writes in addition to :class:`rocking.response.LaneResults`."""

    columns: np.ndarray  #: (COLUMNS, h, lanes) the first h half-cycles
    lowest: np.ndarray  #: (lanes,) smallest x inside a half-cycle [-]
    followed: np.ndarray  #: (lanes,) of int, number of half-cycles until the motion ends or repeats itself


@njit()
def _half_cycle(velocity, secondary, interval, fixed_count, spacing, bounded):
    """Return peak, duration (inf: overturns), number and interval of impulses, impact speed and lowest rotation."""
    if secondary == 0.0 or spacing == half_cycle.CONTINUOUS:
        count = 0 if secondary == 0.0 else -1
        effective = velocity - 0.5 * secondary
        if bounded:
            # A bounded motion approaches its limit velocity from below; rounding must not make it equal.
            effective = min(effective, 1.0 - 2.0**-53)
        elif effective >= 1.0 - half_cycle.CRITICAL_TOLERANCE:
            return np.inf, np.inf, count, np.nan, np.nan, np.inf
        peak, time = half_cycle.hop(effective)
        return peak, time, count, np.nan, max(velocity - secondary, 0.0), np.inf
    count = fixed_count
    if count == 0:
        trial = half_cycle.first_return(velocity, secondary, interval, spacing)
        if trial == np.inf:
            trial = half_cycle.corrected_duration(velocity, secondary, 0, half_cycle.CONTINUOUS)
            if trial == np.inf:
                return np.inf, np.inf, -1, np.nan, np.nan, np.inf
        count = max(2, 2 * math.floor(trial / (2.0 * interval) + 0.5))
    time = half_cycle.corrected_duration(velocity, secondary, count, spacing)
    if time == np.inf:
        return np.inf, np.inf, count, np.nan, np.nan, np.inf
    peak, lowest = half_cycle.peak_and_lowest(velocity, secondary, time, count, spacing)
    speed = half_cycle.impact_speed_after(velocity, secondary, time, count, spacing)
    return peak, time, count, time / (count + 1 if spacing == half_cycle.OPEN else count), speed, lowest


@njit()
def repetitions(start, time, duration, main_count):
    """Return how many equal half-cycles of length `time` start before the sequence ends; -1 for an endless sequence."""
    left = (duration - start) / time
    if left == np.inf:
        return -1 if main_count > UNLIMITED // 2 else main_count
    return min(main_count, math.ceil(min(left, 1e18)))


@njit(_nrt=False)
def sequence_lanes(first_lane, last_lane, lanes, results, table):
    """Compute lanes (a block under a sequence) first_lane to last_lane - 1; write results and the half-cycle table."""
    columns = table.columns
    rows = columns.shape[1]
    for lane in range(first_lane, last_lane):
        u1, a, c, rate = lanes.main[lane], lanes.secondary[lane], lanes.restitution[lane], lanes.p[lane]
        end, most = lanes.duration[lane], lanes.main_count[lane]
        outcome, reason, overturned, impacts = _AT_REST, 0, -1, 0
        peak, overturning_time, lowest = 0.0, np.nan, np.inf
        limited = u1 > 0.0 and (a == 0.0 or lanes.spacing == half_cycle.CONTINUOUS)
        bounded = limited and half_cycle.stays_bounded(u1, a / u1, c)
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
                    impacts = -1  # a cycle of several half-cycles, each of which was computed
                    break
                if abs(following - velocity) > 4e-16 * velocity:
                    velocity = following
                    if index == next_mark:
                        mark, next_mark = velocity, 2 * index
                    continue
                # The motion repeats itself: the remaining half-cycles are only counted.
                repeated = repetitions(start, time / rate, end, most - index)
                if repeated < 0:
                    impacts = -1 if counted else 0
                    break
                impacts += repeated * counted
                index += repeated
                start += repeated * time / rate
            # x(T) = 0 has a root only if the impact speed is below one, so a free decay does not overturn.
            peak = max(peak, half_cycle.hop(c * speed)[0])
            later = half_cycle.impacts_above(c * speed, c, IMPACT_CUTOFF)
            impacts = -1 if later < 0 else impacts + later
            break
        results.peak_rotation_ratio[lane], results.overturning_time[lane] = peak, overturning_time
        results.outcome[lane], results.reason[lane] = outcome, reason
        results.overturning_half_cycle[lane], results.impacts[lane] = overturned, impacts
        table.lowest[lane], table.followed[lane] = lowest, used


#: A negative rotation x larger than this is inside the ground [-]; a smaller one is a rounding error.
GROUND_TOLERANCE = 1e-12
#: Default number of half-cycles in a table.
TABLE_ROWS = 1000


def combined(
    by_input: tuple[Any, ...], by_block: tuple[Any, ...], paired: bool = False
) -> tuple[tuple[int, int], tuple[bool, bool], list[np.ndarray]]:
    """Combine q inputs with m blocks: every input with every block or, if `paired`, each input with one block.

    Returns the shape (q, m) of the result, whether the inputs and the blocks are scalars, and the flattened arrays.
    """
    inputs = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in by_input))
    blocks = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in by_block))
    if paired:
        if inputs[0].ndim and blocks[0].ndim and inputs[0].shape != blocks[0].shape:
            raise ValueError(
                f"paired: expected one sequence for each block, got {inputs[0].size} for {blocks[0].size} blocks"
            )
        pairs = np.broadcast_arrays(*inputs, *blocks)
        return (1, pairs[0].size), (True, pairs[0].ndim == 0), [np.array(value).reshape(-1) for value in pairs]
    shape = (inputs[0].size, blocks[0].size)
    flat = [np.repeat(value.reshape(-1), shape[1]) for value in inputs]
    flat += [np.tile(value.reshape(-1), shape[0]) for value in blocks]
    return shape, (inputs[0].ndim == 0, blocks[0].ndim == 0), flat


def empty_table(rows: int, lanes: int) -> HalfCycleTable:
    """Return an empty table with `rows` half-cycles for a kernel to fill."""
    table = HalfCycleTable(np.full((COLUMNS, rows, lanes), np.nan), np.empty(lanes), np.empty(lanes, dtype=np.int64))
    table.columns[3] = -1.0  # impulse_count
    return table


def tabulated_response(
    kernel: Callable[..., None],
    lanes: tuple[Any, ...],
    shape: tuple[int, int],
    drop: tuple[bool, bool],
    table_rows: int,
    threads: int | None = None,
) -> Response:
    """Run the kernel, and run it again if a table of up to `table_rows` half-cycles is needed; return the response."""
    if table_rows < 0:
        raise ValueError(f"table_rows: expected 0 (no table) or a number of half-cycles, got {table_rows}")
    size = shape[0] * shape[1]
    results = empty_results(size)

    def run(rows: int) -> HalfCycleTable:
        table = empty_table(rows, size)
        split_lanes(lambda first, last: kernel(first, last, lanes, results, table), size, threads)
        return table

    table = run(0)
    half_cycles = None
    if table_rows:
        rows = int(min(table_rows, table.followed.max(initial=0)))
        table = run(rows)
        columns = [column.reshape(rows, *shape) for column in table.columns]
        columns[3] = columns[3].astype(np.int64)
        half_cycles = HalfCycles(*columns)
    contact = table.lowest < -GROUND_TOLERANCE
    return response_of(results, shape, half_cycles=half_cycles, ground_contact=contact).squeezed(drop)
