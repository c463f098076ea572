"""The main sequence in closed form (Casapulla & Maione 2017, Eqs. 3-10): resonance with the impacts, an upper bound.

.. note:: ERRATUM. Eqs. (5) and (9) are printed with the index shifted by one. The recurrence u_i = C u_{i-1} + u_1
   gives u_i = u_1 (1 - C^i)/(1 - C) and I_ic = I_1c (1 - C)/(1 - C^i); u = theta'/(p alpha_c), u_1 = I/I_1c.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from rocking.arguments import UNLIMITED, ArrayLike, Floats, counts
from rocking.body.block import Block
from rocking.impulses.half_cycle import CRITICAL_TOLERANCE, hop, impacts_above, stays_bounded
from rocking.impulses.sequence_kernel import TABLE_ROWS, combined, repetitions, tabulated_response
from rocking.kernel_cache import njit
from rocking.response import IMPACT_CUTOFF, Outcome, Reason, Response

#: Number of bisections of the bracket around the upper edge of a band of scale factors.
HALVINGS = 60
#: Largest number of half-cycles whose durations are added up; a lane with more is UNRESOLVED.
_HALF_CYCLE_LIMIT = 10_000_000
_AT_REST, _ROCKS, _OVERTURNS, _UNRESOLVED = (int(outcome) for outcome in Outcome)
_HALF_CYCLE_LIMIT_REASON = int(Reason.HALF_CYCLE_LIMIT)


class MainSequenceLanes(NamedTuple):
    """Lanes for the kernels, each with one block under one main sequence."""

    impulse: np.ndarray  #: (lanes,) impulse I [m/s]
    duration: np.ndarray  #: (lanes,) end of the main sequence [s]
    main_count: np.ndarray  #: (lanes,) of int, largest number of main impulses
    p: np.ndarray  #: (lanes,) frequency parameter [1/s]
    restitution: np.ndarray  #: (lanes,) restitution C [-]
    critical: np.ndarray  #: (lanes,) critical impulse I_1c [m/s]


@njit()
def amplification(restitution, half_cycle):
    """Return u_i/u_1 = (1 - C^i)/(1 - C) = 1 + C + ... + C^(i-1), the bracket of Eq. (5) with the erratum [-]."""
    if restitution == 1.0:
        return float(half_cycle)
    if restitution == 0.0:
        return 1.0
    return -math.expm1(half_cycle * math.log(restitution)) / (1.0 - restitution)


@njit()
def overturning_half_cycle(main, restitution):
    """Return the half-cycle in which an endless main sequence overturns the block; -1 if it does not.

    The smallest i with u_i >= 1 is i = ceil(ln(1 - (1 - C)/u_1)/ln C), with u_1 = `main`; -1 for u_1 <= 1 - C. Both
    comparisons allow for rounding (`CRITICAL_TOLERANCE`), so that I = I_2c overturns in half-cycle 2.
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
    # Rounding of the logarithms may shift the result by one: the velocities correct it.
    if amplification(restitution, half_cycle - 1) >= needed:
        return half_cycle - 1
    return half_cycle if amplification(restitution, half_cycle) >= needed else half_cycle + 1


@njit(_nrt=False)
def resonance_lanes(first_lane, last_lane, lanes, results, table):
    """Compute lanes (a block under a sequence) first_lane to last_lane - 1; write results and the half-cycle table."""
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
                # The velocity approaches the critical one from below; rounding must not make it equal.
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
                # The velocity has reached its limit: the remaining half-cycles are only counted.
                impacts += repetitions(start, time / rate, end, most - used) * counted
                break
        if outcome == _ROCKS:
            later = impacts_above(c * velocity, c, IMPACT_CUTOFF)
            impacts = -1 if later < 0 else impacts + later
        results.peak_rotation_ratio[lane], results.overturning_time[lane] = peak, overturning_time
        results.outcome[lane], results.reason[lane] = outcome, reason
        results.overturning_half_cycle[lane], results.impacts[lane] = overturned, impacts
        table.lowest[lane], table.followed[lane] = np.inf, used


@njit()
def effective_amplification(restitution, ratio, half_cycle):
    """Return (u_i - sigma u_1/2)/u_1 of half-cycle i with infinitely many secondary impulses, sigma = I_s/I [-]."""
    return (1.0 - ratio) * amplification(restitution, half_cycle) + 0.5 * ratio


@njit()
def start_of_half_cycle(needed, restitution, ratio, half_cycle):
    """Return the start time (times p) of a half-cycle for u_1 = 1/`needed`; inf if the block has overturned before."""
    start = 0.0
    for earlier in range(1, half_cycle):
        start += hop(effective_amplification(restitution, ratio, earlier) / needed)[1]
    return start


@njit()
def last_half_cycle(restitution, ratio, end, main_count):
    """Return the last half-cycle, up to `main_count`, for which :func:`_start_at_edge` is before `end`."""
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


@njit()
def _start_at_edge(restitution, ratio, half_cycle):
    """Return p times the start of a half-cycle at the smallest scale factor at which the block overturns in it."""
    needed = effective_amplification(restitution, ratio, half_cycle)
    return start_of_half_cycle(needed, restitution, ratio, half_cycle)


@njit()
def bands_of(main, ratio, restitution, end, main_count, factor_max):
    """Return lower and upper scale factors (2, k) of ranges in which a block overturns; `end` is in units of 1/p."""
    if end == np.inf:
        # Every half-cycle up to the last one is reached: one interval; for endless sequences its edge is the infimum.
        edge = 1.0 / (main * effective_amplification(restitution, ratio, main_count))
        if main_count == UNLIMITED and restitution == 1.0 and ratio < 1.0:
            edge = 0.0 if main > 0.0 else np.inf
        bands = np.empty((2, 1 if edge <= factor_max else 0))
        if edge <= factor_max:
            bands[0, 0], bands[1, 0] = edge, factor_max
        return bands
    last = last_half_cycle(restitution, ratio, end, main_count)
    bands = np.empty((2, last))
    used = 0
    for half_cycle in range(last, 0, -1):
        low = 1.0 / (main * effective_amplification(restitution, ratio, half_cycle))
        if not low <= factor_max:
            break
        high = factor_max
        if half_cycle > 1:
            high, late = low, 1.0 / (main * effective_amplification(restitution, ratio, half_cycle - 1))
            for _ in range(HALVINGS):
                middle = 0.5 * (high + late)
                if start_of_half_cycle(1.0 / (main * middle), restitution, ratio, half_cycle) < end:
                    high = middle
                else:
                    late = middle
        bands[0, used], bands[1, used] = low, min(high, factor_max)
        used += 1
    return bands[:, :used].copy()


def resonance(
    block: Block,
    impulse: ArrayLike,
    half_cycles: ArrayLike | None,
    duration: ArrayLike | None = None,
    table_rows: int = TABLE_ROWS,
    threads: int | None = None,
) -> Response:
    """Compute the response to equal impulses, each right after an impact (Eqs. 3, 5 with the erratum, 6, 7).

    Parameters
    ----------
    block : Block
        One block, or an array of m blocks.
    impulse : float or (q,) array_like
        I [m/s], finite, not negative.
    half_cycles : int, (q,) array_like of int, or None
        Number of main impulses; None only with a finite `duration`.
    duration : float or (q,) array_like, optional
        Main impulses act only in half-cycles that start before this time [s].
    table_rows : int
        Largest number of half-cycles in the table; 0 for none.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    Response
        Arrays (q, m), without the axis of a scalar argument. The free decay after the last main impulse is included in
        `impacts`, but not in the table, which ends early if the velocity has reached its limit (Eq. 10).
        `overturning_time` is the start of the half-cycle in which the block overturns; u = 1 overturns it.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> response = resonance(block, impulse=0.2 * block.critical_impulse, half_cycles=10)
    >>> response.overturning_half_cycle
    7
    """
    sizes, ends = np.asarray(impulse, dtype=float), np.asarray(np.inf if duration is None else duration, dtype=float)
    if sizes.ndim > 1 or not np.all(np.isfinite(sizes) & (sizes >= 0.0)):
        raise ValueError(f"impulse: expected a finite number or a (q,) array [m/s], not negative, got {impulse!r}")
    if half_cycles is None and not np.all(np.isfinite(ends)):
        raise ValueError("half_cycles: expected a whole number; None needs a finite duration to end the main sequence")
    if ends.ndim > 1 or not np.all(ends > 0.0):
        raise ValueError(f"duration: expected a positive number or a (q,) array [s], got {duration!r}")
    most = UNLIMITED if half_cycles is None else counts("half_cycles", half_cycles, least=1)
    shape, drop, flat = combined((sizes, ends, most), (block.p, block.restitution, block.critical_impulse))
    flat[2] = flat[2].astype(np.int64)
    return tabulated_response(resonance_lanes, MainSequenceLanes(*flat), shape, drop, table_rows, threads)


def critical_impulse(block: Block, half_cycle: int = 1) -> Floats:
    """Return the critical impulse I_ic, the size of equal impulses at resonance that overturn in half-cycle i (Eq. 9).

    Parameters
    ----------
    block : Block
        One block, or an array of m blocks, with restitution C.
    half_cycle : int
        i >= 1; 1 is a single impulse, 2 the critical double impulse.

    Returns
    -------
    impulse : float or (m,) ndarray
        I_ic = I_1c (1 - C)/(1 - C^i) [m/s], with I_1c = g alpha_c/(p cos alpha_c) and the erratum of Eq. 9.

    Raises
    ------
    ValueError
        For a half-cycle that is not a whole number of at least 1.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, Eqs. (3), (5), (9).

    Examples
    --------
    >>> block = Block(width=1.0, height=3.872983, restitution=0.9, gravity=9.81)
    >>> [round(float(critical_impulse(block, half_cycle=i)), 3) for i in (1, 2, 3)]
    [1.335, 0.703, 0.493]
    """
    half_cycle = counts("half_cycle", half_cycle, least=1, lanes=False)
    return critical_impulse_ratio(block.restitution, half_cycle) * block.critical_impulse


def critical_impulse_ratio(restitution: ArrayLike, half_cycle: int) -> Any:
    """Return I_ic/I_1c = (1 - C)/(1 - C^i) of Eq. 9 [-], for one restitution C or an array (m,)."""
    return 1.0 / np.vectorize(amplification, otypes=[float])(restitution, half_cycle)
