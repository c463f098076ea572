"""Safety factors: how much stronger the input of a model may get before the block overturns."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rockpulse.models.block import Block
from rockpulse.models.main_sequence import resonance_safety
from rockpulse.models.response import Outcome
from rockpulse.models.sequence import ImpulseSequence, scaled_outcomes

__all__ = ["first_overturning_factor", "first_overturning_factors", "resonance_safety_factor", "sequence_safety_factor"]

#: Relative width of the bracket that a search ends with.
EDGE_TOLERANCE = 1e-6

#: Where no bound is known the search starts here, as main impulse over I_1c.
SMALLEST_START = 1e-3

#: Factors tried at once when an edge is refined, and the most rounds of it.
REFINEMENT = 33
ROUNDS = 20

#: Blocks searched together, and factors tried at once for each of them: they bound the memory of a call.
BLOCKS_AT_ONCE = 256
SCANNED_AT_ONCE = 32


def first_overturning_factor(
    overturns: Callable[[np.ndarray], np.ndarray], start: float, factor_max: float, step: float
) -> float:
    """Smallest factor at which one block overturns: :func:`first_overturning_factors` for a single lane.

    Parameters
    ----------
    overturns : callable
        Takes factors (q,) and returns a (q,) array of bool. It need not be monotonic.
    start, factor_max, step : float
        As for :func:`first_overturning_factors`.

    Returns
    -------
    float
        Factor [-]; inf if nothing overturns up to `factor_max`.
    """

    def of_lanes(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        return np.asarray(overturns(factors[:, 0]))[:, np.newaxis]

    return float(first_overturning_factors(of_lanes, np.array([start]), factor_max, step)[0])


def first_overturning_factors(
    overturns: Callable[[np.ndarray, np.ndarray], np.ndarray], start: np.ndarray, factor_max: float, step: float
) -> np.ndarray:
    """Smallest factor at which each block overturns, by a scan on a log grid and refinement of the first edge.

    Parameters
    ----------
    overturns : callable
        Takes numbers of blocks (n,) and factors (q, n) with a column for each of them, and returns a (q, n) array of
        bool. It need not be monotonic in the factor.
    start : (m,) ndarray
        Below this no overturning is possible, > 0 [-].
    factor_max : float
        End of the search [-].
    step : float
        Ratio of neighbouring factors of the scan, > 1: a narrower band of overturning may be missed.

    Returns
    -------
    (m,) ndarray
        Upper end of the last bracket, which is narrower than 1e-6 of itself [-]; inf if nothing overturns up to
        `factor_max`.

    Notes
    -----
    The scan goes upwards in parts, and a block leaves it with its first edge: what lies above is not looked at. All
    blocks still in the search share each call.
    """
    found = np.full(start.size, np.inf)
    searching = np.flatnonzero(start <= factor_max)
    for first in range(0, searching.size, BLOCKS_AT_ONCE):
        lanes = searching[first : first + BLOCKS_AT_ONCE]
        found[lanes] = _first_edges(overturns, lanes, start[lanes], factor_max, step)
    return found


def _first_edges(
    overturns: Callable[[np.ndarray, np.ndarray], np.ndarray],
    lanes: np.ndarray,
    start: np.ndarray,
    factor_max: float,
    step: float,
) -> np.ndarray:
    counts = np.maximum(1 + np.ceil(np.log(factor_max / start) / np.log(step)).astype(np.int64), 2)
    scan = np.full((int(counts.max()), lanes.size), factor_max)
    for column, count in enumerate(counts):
        scan[:count, column] = np.geomspace(start[column], factor_max, count)
    low, high = start / step, np.full(lanes.size, np.inf)
    active = np.arange(lanes.size)
    for top in range(0, scan.shape[0], SCANNED_AT_ONCE):
        factors = scan[top : top + SCANNED_AT_ONCE, active]
        over = overturns(lanes[active], factors)
        edge, columns = np.argmax(over, axis=0), np.flatnonzero(np.any(over, axis=0))
        rows, reached = edge[columns], active[columns]
        high[reached] = factors[rows, columns]
        below = top + rows > 0
        low[reached[below]] = scan[top + rows[below] - 1, reached[below]]
        active = np.delete(active, columns)
        if active.size == 0:
            break
    # A round narrows the bracket REFINEMENT - 1 times; the last one is below any tolerance long before the limit.
    for _ in range(ROUNDS):
        active = np.flatnonzero(np.isfinite(high) & ~(high - low <= EDGE_TOLERANCE * high))
        if active.size == 0:
            break
        factors = np.linspace(low[active], high[active], REFINEMENT)[1:]
        over = overturns(lanes[active], factors)
        edge, columns = np.argmax(over, axis=0), np.arange(active.size)
        low[active] = np.where(edge > 0, factors[edge - 1, columns], low[active])
        high[active] = np.where(np.any(over, axis=0), factors[edge, columns], np.inf)
    return high


def resonance_safety_factor(block: Block, sequence: ImpulseSequence, factor_max: float) -> np.ndarray:
    """Smallest factor on the main impulse at which its resonance sequence overturns each block, in closed form.

    Parameters
    ----------
    block : Block
        (m,) lanes.
    sequence : ImpulseSequence
        Its main impulse, duration and main count are used; the secondary impulses are not.
    factor_max : float
        Larger factors are given as inf, as in a search.

    Returns
    -------
    (m,) ndarray
        Factor [-].
    """
    factor = np.asarray(resonance_safety(block, sequence.main, sequence.main_count, sequence.duration), dtype=float)
    return np.where(factor <= factor_max, factor, np.inf)


def sequence_safety_factor(
    block: Block, sequence: ImpulseSequence, factor_max: float, step: float, threads: int | None = None
) -> np.ndarray:
    """Smallest factor on the main impulse, I_s/I and main count kept, at which the sequence overturns each block.

    Parameters
    ----------
    block : Block
        (m,) lanes.
    sequence : ImpulseSequence
        The scene; its main and secondary impulse are scaled together.
    factor_max, step : float
        End of the search and ratio of neighbouring factors, as in :func:`first_overturning_factors`.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The factors do not depend on it.

    Returns
    -------
    (m,) ndarray
        Factor [-]; inf if there is none up to `factor_max`.

    Notes
    -----
    Secondary impulses only take speed away (F3: u_r <= u), so u_i never exceeds that of the resonance sequence and
    the search starts at the latter's critical factor without a limit of duration, (1 - C)/(1 - C^N) I_1c/I.
    """
    main = float(sequence.main)
    lanes = np.atleast_1d(block.p).size
    if main == 0.0:
        return np.full(lanes, np.inf)
    bound = np.maximum(
        resonance_safety(block, main, sequence.main_count), SMALLEST_START * np.asarray(block.critical_impulse) / main
    )

    def overturns(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        return scaled_outcomes(block, sequence, lanes, factors, threads) == Outcome.OVERTURNS

    return first_overturning_factors(overturns, np.atleast_1d(bound), factor_max, step)
