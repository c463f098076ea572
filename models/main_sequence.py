"""The main sequence in closed form (Casapulla & Maione 2017, Eqs. 3-10): resonance with the block's own impacts.

.. note:: ERRATUM. Eqs. (5) and (9) are printed with the index shifted by one. The recurrence u_i = C u_{i-1} + u_1 is
   right and gives u_i = u_1 (1 - C^i)/(1 - C) and I_ic = I_1c (1 - C)/(1 - C^i), hence I_2c = I_1c/(1 + C). u =
   theta'/(p alpha_c), u_1 = I/I_1c.

Resonance is the input that suits the block worst, an upper bound and not a prediction.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numba import njit

from rockpulse.models.block import Block
from rockpulse.models.half_cycle import stays_bounded
from rockpulse.models.half_cycle_table import TABLE_ROWS, lanes, tabulated_response
from rockpulse.models.motion import CRITICAL_TOLERANCE, hop, impacts_above
from rockpulse.models.response import IMPACT_CUTOFF, Outcome, Reason, Response
from rockpulse.models.sequence_kernel import UNLIMITED

__all__ = ["critical_impulse_at", "overturning_half_cycle", "resonance", "resonance_safety"]

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
def _resonance_lanes(table, floats, integers, main, duration, p, restitution, main_count, cutoff):
    rows = table.shape[1]
    for lane in range(main.shape[0]):
        u1, c, rate = main[lane], restitution[lane], p[lane]
        critical = overturning_half_cycle(u1, c)
        outcome, reason, overturned, impacts, used = _AT_REST, 0, -1, 0, 0
        peak, overturning_time, start, velocity = 0.0, np.nan, 0.0, 0.0
        while u1 > 0.0 and start < duration[lane] and used < main_count:
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
                left = min(float(main_count - used), math.ceil(max((duration[lane] - start) * rate / time, 0.0)))
                impacts += int(min(left, 1e18)) * counted
                break
        if outcome == _ROCKS:
            later = impacts_above(c * velocity, c, cutoff)
            impacts = -1 if later < 0 else impacts + later
        floats[0, lane], floats[1, lane], floats[2, lane] = peak, overturning_time, np.inf
        integers[0, lane], integers[1, lane], integers[2, lane] = outcome, reason, overturned
        integers[3, lane], integers[4, lane] = impacts, used


def resonance(
    block: Block, impulse: Any, half_cycles: int | None, duration: Any = None, table_rows: int = TABLE_ROWS
) -> Response:
    """Response to equal impulses, each right after an impact.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    impulse : float or (q,) array_like
        I [m/s], finite, not negative.
    half_cycles : int or None
        Number of main impulses; None only with a finite `duration`.
    duration : float or (q,) array_like, optional
        Main impulses act only in half-cycles that start before this time [s].
    table_rows : int
        Largest number of half-cycles in the table; 0 for none.

    Returns
    -------
    Response
        Lanes (q, m), a scalar axis dropped. After the last main impulse the block decays freely to rest; the decay is
        in `impacts`, not in the table. The table ends before its last row where the velocity has reached its limit
        (Eq. 10). `overturning_time` is the start of the half-cycle that overturns: from its main impulse on nothing
        can save the block.

    Raises
    ------
    ValueError
        For an impulse, number or duration out of range.

    Notes
    -----
    Eq. (3) gives u_1 = I/I_1c, the erratum u_i, Eqs. (6) and (7) peak and duration of a half-cycle. u = 1 overturns.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> response = resonance(block, impulse=0.2 * block.critical_impulse, half_cycles=10)
    >>> response.overturning_half_cycle
    7
    """
    impulse = _impulse(impulse)
    count = _half_cycles(half_cycles, duration)
    shape, drop, flat = lanes((impulse, _duration(duration)), (block.p, block.restitution, block.critical_impulse))
    scaled, end, p, restitution, critical = flat
    arguments = (scaled / critical, end, p, restitution, count, IMPACT_CUTOFF)
    return tabulated_response(_resonance_lanes, arguments, shape, drop, table_rows)[0]


def critical_impulse_at(block: Block, half_cycle: int) -> Any:
    """The impulse that overturns the block in a given half-cycle (Eq. 9 with the erratum).

    Parameters
    ----------
    block : Block
        One block, or (m,).
    half_cycle : int
        i, at least 1.

    Returns
    -------
    impulse : float or (m,) ndarray
        I_ic = I_1c (1 - C)/(1 - C^i) [m/s].
    """
    half_cycle = _half_cycles(half_cycle, None)
    return critical_impulse_ratio(block.restitution, half_cycle) * block.critical_impulse


def critical_impulse_ratio(restitution: Any, half_cycle: int) -> Any:
    """I_ic/I_1c = (1 - C)/(1 - C^i) of Eq. 9 for C a float or an (m,) array [-]."""
    lanes_ = np.atleast_1d(np.asarray(restitution, dtype=float))
    ones = np.ones(lanes_.size)
    factors = _edges(ones, np.full(lanes_.size, np.inf), ones, lanes_, ones, half_cycle)
    return factors.item() if np.ndim(restitution) == 0 else factors


@njit(cache=True, nogil=True, error_model="numpy")
def _start_at_edge(restitution, half_cycle):
    """Start of half-cycle N times p, at the factor that makes u_N = 1: sum over j < N of 2 atanh(S_j/S_N)."""
    last = amplification(restitution, half_cycle)
    start = 0.0
    for earlier in range(1, half_cycle):
        start += hop(amplification(restitution, earlier) / last)[1]
    return start


@njit(cache=True, nogil=True, error_model="numpy")
def _last_half_cycle(restitution, end, main_count):
    """Largest N <= main_count whose start, at the lower edge of its band of factors, is before `end` (times p)."""
    low, high = 1, 2
    while high <= main_count and _start_at_edge(restitution, high) < end:
        low, high = high, 2 * high
    high = min(high, main_count + 1)
    while high - low > 1:
        middle = (low + high) // 2
        if _start_at_edge(restitution, middle) < end:
            low = middle
        else:
            high = middle
    return low


@njit(cache=True, nogil=True, error_model="numpy")
def _edges(impulse, end, p, restitution, critical, main_count):
    factors = np.empty(impulse.shape[0])
    for lane in range(impulse.shape[0]):
        c = restitution[lane]
        last = main_count if end[lane] == np.inf else _last_half_cycle(c, p[lane] * end[lane], main_count)
        factors[lane] = critical[lane] / (impulse[lane] * amplification(c, last))
        if last == UNLIMITED and c == 1.0:
            factors[lane] = np.inf if impulse[lane] == 0.0 else 0.0
    return factors


def resonance_safety(block: Block, impulse: Any, half_cycles: int | None = None, duration: Any = None) -> Any:
    """Smallest factor on the impulse at which :func:`resonance` overturns the block, in closed form.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    impulse : float or (q,) array_like
        I [m/s], finite, not negative.
    half_cycles : int, optional
        Number of main impulses; None for no limit.
    duration : float or (q,) array_like, optional
        Main impulses act only in half-cycles that start before this time [s].

    Returns
    -------
    factor : float or (q, m) ndarray
        I_Nc/I [-]; inf for no impulse. Without `half_cycles` and `duration` it is the infimum (1 - C) I_1c/I, which
        itself is safe.

    Notes
    -----
    Overturning in half-cycle N takes a factor from I_Nc/I to below I_(N-1)c/I, a band in which its start grows with
    the factor, so it is earliest at the lower edge: t_N = sum over j < N of 2 atanh(S_j/S_N)/p with S_j = (1 - C^j)/(1
    - C). t_N grows with N, so the answer is the edge of the largest N that the input reaches, t_N < duration. As
    S_j/S_N >= j/N and sum of 2 atanh(j/N) is about 2 N ln 2, N stays below p duration/1.38 + 2.
    """
    impulse = _impulse(impulse)
    ends = _duration(duration)
    count = UNLIMITED if half_cycles is None else _half_cycles(half_cycles, None)
    shape, drop, flat = lanes((impulse, ends), (block.p, block.restitution, block.critical_impulse))
    factors = _edges(*flat, count).reshape(shape)
    axes = tuple(axis for axis, dropped in enumerate(drop) if dropped)
    factors = factors.squeeze(axis=axes)
    return factors.item() if factors.ndim == 0 else factors


def _impulse(value: Any) -> np.ndarray:
    impulse = np.asarray(value, dtype=float)
    if impulse.ndim > 1 or not np.all(np.isfinite(impulse) & (impulse >= 0.0)):
        raise ValueError(f"impulse: expected a finite number or a (q,) array [m/s], not negative, got {value!r}")
    return impulse


def _duration(value: Any) -> np.ndarray:
    duration = np.asarray(np.inf if value is None else value, dtype=float)
    if duration.ndim > 1 or not np.all(duration > 0.0):
        raise ValueError(f"duration: expected a positive number or a (q,) array [s], got {value!r}")
    return duration


def _half_cycles(value: int | None, duration: Any) -> int:
    if value is None:
        if duration is None or not np.all(np.isfinite(np.asarray(duration, dtype=float))):
            raise ValueError(
                "half_cycles: expected a whole number; None needs a finite duration to end the main sequence"
            )
        return UNLIMITED
    try:
        count = operator.index(value)
    except TypeError:
        raise ValueError(f"half_cycles: expected a whole number, got {value!r}") from None
    if not 1 <= count < UNLIMITED:
        raise ValueError(f"half_cycles: expected at least 1, got {count}")
    return count
