"""Safety factors: how much stronger the input of a model may get before the block overturns."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rockpulse.models.block import Block
from rockpulse.models.main_sequence import resonance_safety
from rockpulse.models.response import Outcome
from rockpulse.models.sequence import ImpulseSequence, sequence_response

__all__ = ["first_overturning_factor", "resonance_safety_factor", "sequence_safety_factor"]

#: Relative width of the bracket that a search ends with.
EDGE_TOLERANCE = 1e-6

#: Where no bound is known the search starts here, as main impulse over I_1c.
SMALLEST_START = 1e-3

#: Factors tried at once when an edge is refined, and the most rounds of it.
REFINEMENT = 33
ROUNDS = 20


def first_overturning_factor(
    overturns: Callable[[np.ndarray], np.ndarray], start: float, factor_max: float, step: float
) -> float:
    """Smallest factor at which a block overturns, by a scan on a log grid and refinement of the first edge.

    Parameters
    ----------
    overturns : callable
        Takes factors (q,) and returns a (q,) array of bool. It need not be monotonic.
    start : float
        Below this no overturning is possible, > 0 [-].
    factor_max : float
        End of the search [-].
    step : float
        Ratio of neighbouring factors of the scan, > 1: a narrower band of overturning may be missed.

    Returns
    -------
    float
        Upper end of the last bracket, which is narrower than 1e-6 of itself; inf if nothing overturns up to
        `factor_max`.
    """
    if start > factor_max:
        return np.inf
    count = 1 + int(np.ceil(np.log(factor_max / start) / np.log(step)))
    factors = np.geomspace(start, factor_max, max(count, 2))
    low = start / step
    # A round narrows the bracket REFINEMENT - 1 times; the last one is below any tolerance long before the limit.
    for _ in range(ROUNDS):
        over = np.flatnonzero(overturns(factors))
        if over.size == 0:
            return np.inf
        first = int(over[0])
        high = float(factors[first])
        low = float(factors[first - 1]) if first else low
        if high - low <= EDGE_TOLERANCE * high:
            break
        factors = np.linspace(low, high, REFINEMENT)[1:]
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


def sequence_safety_factor(block: Block, sequence: ImpulseSequence, factor_max: float, step: float) -> np.ndarray:
    """Smallest factor on the main impulse, I_s/I and main count kept, at which the sequence overturns each block.

    Parameters
    ----------
    block : Block
        (m,) lanes.
    sequence : ImpulseSequence
        The scene; its main and secondary impulse are scaled together.
    factor_max, step : float
        End of the search and ratio of neighbouring factors, as in :func:`first_overturning_factor`.

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

    def search(lane: int) -> float:
        one = block.lane(lane)

        def overturns(factors: np.ndarray) -> np.ndarray:
            return sequence_response(one, sequence.scaled(factors), table_rows=0).outcome == Outcome.OVERTURNS

        return first_overturning_factor(overturns, float(bound[lane]), factor_max, step)

    return np.array([search(lane) for lane in range(lanes)])
