"""Factors on a sequence of impulses at which a block overturns: in closed form, or by a search.

.. note:: u = theta'/(p alpha_c), u_1 = I/I_1c, sigma = I_s/I. The factor is on both impulses: sigma and counts stay.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numba import njit

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.main import effective_amplification, last_half_cycle, resonance_safety, start_of_half_cycle
from rocking.impulses.sequence import scaled_outcomes
from rocking.impulses.sequence_kernel import UNLIMITED
from rocking.response import Outcome
from rocking.search.factors import ScaleIntervals, exceedance_intervals

__all__ = ["STEP", "resonance_critical_scale", "sequence_critical_scale"]

#: Ratio of neighbouring factors where a search is needed.
STEP = 1.005

#: Where no bound is known the search starts here, as main impulse over I_1c.
SMALLEST_START = 1e-3

#: A gap between two bands that is narrower than this share of the factor is none, as in a search.
EDGE_TOLERANCE = 1e-6

#: Halvings of the bracket of an upper edge.
HALVINGS = 60


def resonance_critical_scale(block: Block, sequence: ImpulseSequence, factor_max: float = 10.0) -> ScaleIntervals:
    """Factors on the main impulse at which its resonance sequence overturns each block, in closed form.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    sequence : ImpulseSequence
        One sequence; the secondary impulses are left out.
    factor_max : float
        Larger factors are left out, as in a search [-].

    Returns
    -------
    ScaleIntervals
        Of (m,) lanes; see :func:`sequence_critical_scale`.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> sequence = ImpulseSequence(0.5 * block.critical_impulse, 0.0, np.nan, np.inf, 2, spacing="continuous")
    >>> resonance_critical_scale(block, sequence).safety_factor.round(6)  # I_2c/I = 2/(1 + C)
    array([1.052632])
    """
    _check(sequence, factor_max)
    return _bands(block if block.shape else block.lanes(1), replace(sequence, secondary=0.0), factor_max)


def sequence_critical_scale(
    block: Block,
    sequence: ImpulseSequence,
    factor_max: float = 10.0,
    step: float = STEP,
    threads: int | None = None,
    paired: bool = False,
) -> ScaleIntervals:
    """Factors on the main impulse, I_s/I and main count kept, at which a sequence overturns each block.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    sequence : ImpulseSequence
        One sequence; (m,) for pairs.
    factor_max : float
        End of the search [-].
    step : float
        Largest ratio of neighbouring factors, above 1, where a search is needed: for every spacing but "continuous",
        because the number of secondary impulses in a half-cycle comes from the march.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The factors do not depend on it.
    paired : bool
        Every block has a sequence of its own, of spacing "continuous" and with a `main_count`.

    Returns
    -------
    ScaleIntervals
        Of (m,) lanes. In closed form `safe_up_to` and `safety_factor` are the same number.

    Raises
    ------
    ValueError
        For several sequences that are no pairs with the blocks in closed form, or a step that is not above 1.

    Notes
    -----
    Closed form (spacing "continuous", or no secondary impulses). u_(i+1) = C (u_i - sigma u_1) + u_1 (F4) is linear in
    u_1, as an impact speed u_i - sigma u_1 is never negative: v_i = u_i - sigma u_1/2 = u_1 [(1 - sigma) S_i +
    sigma/2], S_i = (1 - C^i)/(1 - C). Half-cycle N overturns iff v_N >= 1 > v_(N-1), a band of factors from I_Nc/I to
    below I_(N-1)c/I with

        I_Nc = I_1c/[(1 - sigma) S_N + sigma/2],

    which is Eq. 9 for sigma = 0. It does so if it is reached: N <= main_count, and its start, the sum over j < N of 2
    atanh(v_j)/p, before `duration`. The start grows with the factor within a band, without bound at its upper end,
    so a band is cut there: above I_Nc the block may be safe again. At the lower edges the start grows with N, so the
    smallest factor is that of the largest N that is reached.

    Else a scan and refined edges. Secondary impulses only take speed away (F3: u_r <= u), so u_i never exceeds that of
    the resonance sequence, whose critical factor without a limit of duration is where the search begins. A factor at
    which the model cannot answer (UNRESOLVED) counts as overturning.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, sections 3.1 and 3.2, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> impulse = 0.5 * block.critical_impulse
    >>> sequence = ImpulseSequence(impulse, 0.4 * impulse, np.nan, np.inf, 2, spacing="continuous")
    >>> sequence_critical_scale(block, sequence).safety_factor.round(6)  # 2/((1 - 0.4) (1 + C) + 0.4/2)
    array([1.492537])
    """
    blocks = block if block.shape else block.lanes(1)
    _check(sequence, factor_max, blocks.shape if paired else ())
    if not (math.isfinite(step) and step > 1.0):
        raise ValueError(f"step: expected a ratio above 1, got {step!r}")
    if sequence.spacing == "continuous" or np.all(sequence.secondary == 0.0):
        return _bands(blocks, sequence, factor_max)
    main = float(sequence.main)
    start = np.maximum(
        resonance_safety(blocks, main, sequence.main_count), SMALLEST_START * np.asarray(blocks.critical_impulse) / main
    )
    points = 1 + np.ceil(np.log(np.maximum(factor_max / start, step)) / np.log(step)).astype(np.int64)

    def overturns(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        return scaled_outcomes(blocks, sequence, lanes, factors, threads) >= Outcome.OVERTURNS  # or UNRESOLVED

    found = exceedance_intervals(overturns, start, factor_max, points)
    answer = scaled_outcomes(blocks, sequence, found.lane, found.lower[np.newaxis], threads)[0]
    return replace(found, resolved=answer != Outcome.UNRESOLVED)


def _check(sequence: ImpulseSequence, factor_max: float, pairs: tuple[int, ...] = ()) -> None:
    if sequence.shape != pairs:
        expected = f"one for each of {pairs[0]} blocks" if pairs else "one sequence"
        raise ValueError(f"sequence: expected {expected}, got shape {sequence.shape}")
    if pairs and (sequence.spacing != "continuous" or sequence.main_count is None):
        raise ValueError('sequence: of pairs expected spacing "continuous" and a main_count')
    if not (math.isfinite(factor_max) and factor_max > 0.0):
        raise ValueError(f"factor_max: expected a positive number, got {factor_max}")


def _bands(block: Block, sequence: ImpulseSequence, factor_max: float) -> ScaleIntervals:
    """The bands of all half-cycles that are reached, those that touch put together."""
    count = block.shape[0]
    most = UNLIMITED if sequence.main_count is None else sequence.main_count
    of_sequence = (sequence.main, sequence.secondary, sequence.duration, most)
    inputs = zip(
        *(np.broadcast_to(values, count) for values in of_sequence),
        *(np.broadcast_to(values, count) for values in (block.critical_impulse, block.restitution, block.p)),
        strict=True,
    )
    parts = [
        _bands_of(main / critical, secondary / main if main > 0.0 else 0.0, c, p * duration, int(last), factor_max)
        for main, secondary, duration, last, critical, c, p in inputs
    ]
    lane = np.repeat(np.arange(count), [part.shape[1] for part in parts])
    lower, upper = np.concatenate(parts, axis=1) if parts else np.empty((2, 0))
    begins = np.ones(lane.size, dtype=bool)
    begins[1:] = (lane[1:] != lane[:-1]) | (upper[:-1] < lower[1:] * (1.0 - EDGE_TOLERANCE))
    ends = np.append(begins[1:], True)[: lane.size]
    lane, lower, upper = lane[begins], lower[begins], upper[ends]
    safety = np.full(count, np.inf)
    lowest = np.flatnonzero(np.diff(lane, prepend=-1))
    safety[lane[lowest]] = lower[lowest]
    opened = upper >= factor_max
    resolved = np.ones(lane.size, dtype=bool)
    return ScaleIntervals(safety, np.minimum(safety, factor_max), lane, lower, upper, opened, np.ones(count), resolved)


@njit(cache=True, nogil=True, error_model="numpy")
def _bands_of(
    main: float, ratio: float, restitution: float, end: float, main_count: int, factor_max: float
) -> np.ndarray:
    """Lower and upper factors (2, k) of the bands of one lane, ascending, up to `factor_max`.

    `main` is u_1, `ratio` sigma, and `end` the end of the main sequence times p.
    """
    if end == np.inf:
        # Every half-cycle up to the last one is reached: one interval. Without a last one its edge is the infimum.
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
