"""Scale factors at which a body overturns in each model, from a search or in closed form."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from rocking.arguments import UNLIMITED, ArrayLike, numbers
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.impulsive import impulsive_response
from rocking.impulses.main_sequence import amplification, bands_of
from rocking.impulses.sequence import scaled_outcomes
from rocking.march.corner_response import uplift_additions
from rocking.march.recorded import recorded_response
from rocking.response import Outcome, Response
from rocking.search.factors import TOLERANCE, ScaleIntervals, exceedance_intervals

#: Number of factors in the scan of one block.
POINTS = 64
#: The largest number below one: the peak measure of a block that passes alpha_c and returns.
BELOW = float(np.nextafter(1.0, 0.0))
#: The search starts this share below the factor that lifts the block, to allow for rounding.
ROUNDING = 1e-12
#: Ratio of neighbouring factors in a search.
STEP = 1.005
#: Start of a search without a known lower bound, as main impulse divided by I_1c.
SMALLEST_START = 1e-3


def critical_scale(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    equation: Literal["nonlinear", "linear"] = "nonlinear",
    vertical: ArrayLike | None = None,
    level: float | None = None,
    factor_max: float = 10.0,
    points: int = POINTS,
    threads: int | None = None,
) -> ScaleIntervals:
    """Find the scale factors at which a record overturns a block, or makes it exceed a rotation.

    Parameters
    ----------
    block : Block
        One block, with results of shape (1,), or an array of m blocks.
    acceleration, dt, equation, vertical
        As for :func:`~rocking.recorded_response`; the scale factor multiplies both accelerations.
    level : float, optional
        Rotation theta_max/alpha_c to reach or exceed [-], positive; None for overturning.
    factor_max : float
        End of the search [-].
    points : int
        Number of scale factors in the scan of each block, at least 2.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    ScaleIntervals
        Intervals of m blocks.

    Raises
    ------
    ValueError
        For a level that is not positive, and for arguments that :func:`~rocking.recorded_response` rejects.

    Notes
    -----
    The scan of a block starts at the scale factor that lifts it: g alpha/max|a_g| (linear), or the smallest f with
    f |a_g| = (g + f a_v) tan(alpha), at a sample because both records are linear between samples. A scale factor with
    an UNRESOLVED outcome (free flight, endless impacts) counts as exceeding the limit.

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> found = critical_scale(block, sine, 0.01)
    >>> found.safety_factor.round(4), found.lower.round(2), found.upper.round(2)  # safe again from 7.35 to 7.52
    (array([3.2132]), array([3.21, 7.52]), array([ 7.35, 10.  ]))
    """
    if level is not None and not float(numbers("level", level, "a positive theta_max/alpha_c", lanes=False)) > 0.0:
        raise ValueError(f"level: expected a positive theta_max/alpha_c, got {level!r}")
    blocks = block.lanes()
    # A run at factor zero checks the arguments before they are used.
    recorded_response(blocks, acceleration, dt, equation, scale=0.0, vertical=vertical, threads=threads)
    ground = np.ascontiguousarray(acceleration, dtype=float)
    up = None if vertical is None else np.ascontiguousarray(vertical, dtype=float)

    def respond(part: Block, factors: np.ndarray) -> Response:
        return recorded_response(part, ground, dt, equation, vertical=up, block_scale=factors, threads=threads)

    start = uplift_scale(blocks, ground, equation, up) * (1.0 - ROUNDING)
    return _search(blocks, respond, start, level, factor_max, points)


def impulsive_critical_scale(
    block: Block,
    times: ArrayLike,
    impulses: ArrayLike,
    gain: str = "paper",
    factor_max: float = 10.0,
    points: int = POINTS,
    threads: int | None = None,
) -> ScaleIntervals:
    """Find the scale factors at which an impulse train, such as the half-waves of a record, overturns a block.

    Parameters
    ----------
    block, factor_max, points, threads
        As for :func:`critical_scale`.
    times, impulses, gain
        As for :func:`~rocking.impulsive_response`.

    Returns
    -------
    ScaleIntervals
        Intervals of m blocks.

    Notes
    -----
    The scan starts at a lower bound, g alpha_c/(p sum |I_i|). Let u be the speed of the motion at x = 0, extrapolated
    back in time if necessary. An impulse dx' at the rotation 0 <= x <= 2 raises u to at most u + |dx'|, as x'^2 =
    u^2 - 1 + (1 - x)^2 <= u^2 there, and an impact lowers u. Overturning needs u >= 1, with dx' <= p I/(g alpha_c).

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> found = impulsive_critical_scale(block, [0.0], [0.5 * block.critical_impulse])
    >>> found.safety_factor.round(5)
    array([2.])
    """
    blocks = block.lanes()
    impulsive_response(blocks, times, impulses, gain=gain, scale=0.0, threads=threads)
    total = float(np.sum(np.abs(impulses)))
    if total == 0.0:
        start = np.full(blocks.shape, np.inf)
    else:
        start = np.asarray(blocks.gravity * blocks.alpha_c / (blocks.p * total) * (1.0 - ROUNDING))

    def respond(part: Block, factors: np.ndarray) -> Response:
        return impulsive_response(part, times, impulses, gain=gain, block_scale=factors, threads=threads)

    return _search(blocks, respond, start, None, factor_max, points)


def uplift_scale(
    block: Block, acceleration: np.ndarray, equation: str = "nonlinear", vertical: np.ndarray | None = None
) -> np.ndarray:
    """Return the scale factors f at which a record lifts blocks; unrestrained: f abs(a_g) = (g + f a_v) tan(alpha)."""
    found = np.full(np.shape(block.p), np.inf)
    more = uplift_additions(block)
    for side, alpha, extra in ((1, block.alpha_c, more[0]), (-1, block.alpha_2, more[1])):
        threshold = np.asarray(alpha if equation == "linear" else np.tan(alpha))
        strongest = np.full(threshold.shape, np.max(-side * acceleration))
        if vertical is not None:
            strongest = np.array([np.max(-side * acceleration - slope * vertical) for slope in threshold])
        lifted = (strongest > 0.0) & (np.asarray(block.side) != -side)
        level = block.gravity * (threshold + extra)
        found = np.minimum(found, np.divide(level, strongest, out=np.full(threshold.shape, np.inf), where=lifted))
    return found


def _search(
    blocks: Block,
    respond: Callable[..., Response],
    start: np.ndarray,
    level: float | None,
    factor_max: float,
    points: int,
) -> ScaleIntervals:
    unresolved = False

    def exceeds(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        nonlocal unresolved
        # The factors of one block are adjacent, because the impulsive kernel uses one table for neighbours of equal p.
        response = respond(blocks.take(np.repeat(lanes, factors.shape[0])), factors.T.reshape(-1))
        reach = np.asarray(response.peak_rotation_ratio)  # NaN for UNRESOLVED lanes, which count as exceeding
        if level is None:
            reach = np.where(response.outcome >= Outcome.OVERTURNS, np.inf, np.minimum(reach, BELOW))
        else:
            reach = reach / level
        unresolved |= bool(np.any(response.outcome == Outcome.UNRESOLVED))
        return reach.reshape(factors.shape[1], factors.shape[0]).T

    found = exceedance_intervals(exceeds, start, factor_max, points)
    if not unresolved:
        return found
    answers = respond(blocks.take(found.lane), found.lower)
    return found.changed(resolved=np.asarray(answers.outcome) != Outcome.UNRESOLVED)


def resonance_critical_scale(block: Block, sequence: ImpulseSequence, factor_max: float = 10.0) -> ScaleIntervals:
    """Return the scale factors at which the resonance sequence of a main impulse overturns each block, in closed form.

    Parameters
    ----------
    block, sequence, factor_max
        As for :func:`sequence_critical_scale`, with one sequence; its secondary impulses are ignored.

    Returns
    -------
    ScaleIntervals
        Intervals of m blocks.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> sequence = ImpulseSequence(0.5 * block.critical_impulse, 0.0, np.nan, np.inf, 2, spacing="continuous")
    >>> resonance_critical_scale(block, sequence).safety_factor.round(6)  # I_2c/I = 2/(1 + C)
    array([1.052632])
    """
    _check(sequence, factor_max)
    return _bands(block.lanes(), replace(sequence, secondary=0.0), factor_max)


def sequence_critical_scale(
    block: Block,
    sequence: ImpulseSequence,
    factor_max: float = 10.0,
    step: float = STEP,
    threads: int | None = None,
    paired: bool = False,
) -> ScaleIntervals:
    """Find the scale factors at which a sequence overturns each block, with constant I_s/I and number of main impulses.

    Parameters
    ----------
    block : Block
        One block, with results of shape (1,), or an array of m blocks.
    sequence : ImpulseSequence
        One sequence; (m,) for pairs.
    factor_max : float
        Largest scale factor that is considered [-].
    step : float
        Largest ratio of neighbouring scale factors in a search, above 1; every spacing except "continuous" needs a
        search, because the number of secondary impulses in a half-cycle is a result of the computation.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.
    paired : bool
        Whether each block is paired with one sequence that has a `main_count`.

    Returns
    -------
    ScaleIntervals
        Intervals of m blocks. In closed form `safe_up_to` and `safety_factor` are the same number.

    Raises
    ------
    ValueError
        For several sequences that are not paired with the blocks, or a step that is not above 1.

    Notes
    -----
    Closed form (spacing "continuous", or no secondary impulses). u_(i+1) = C (u_i - sigma u_1) + u_1 is linear in
    u_1: v_i = u_i - sigma u_1/2 = u_1 [(1 - sigma) S_i + sigma/2], S_i = (1 - C^i)/(1 - C). Half-cycle N overturns iff
    v_N >= 1 > v_(N-1), a band of scale factors from I_Nc/I to below I_(N-1)c/I with

        I_Nc = I_1c/[(1 - sigma) S_N + sigma/2],

    which is Eq. 9 for sigma = 0. A band exists if its half-cycle is reached: N <= main_count, and the start of N, the
    sum over j < N of 2 atanh(v_j)/p, is before `duration`. This start grows without bound towards the upper end of the
    band, which therefore ends where the start reaches `duration`: above I_Nc the block may be safe again. At the lower
    ends the start grows with N, so the smallest scale factor is that of the largest N that is reached.

    Otherwise a scan with refined edges starts at the smallest scale factor of the resonance sequence, as secondary
    impulses only reduce the speed (u_r <= u). A scale factor with an UNRESOLVED outcome counts as overturning.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> impulse = 0.5 * block.critical_impulse
    >>> sequence = ImpulseSequence(impulse, 0.4 * impulse, np.nan, np.inf, 2, spacing="continuous")
    >>> sequence_critical_scale(block, sequence).safety_factor.round(6)  # 2/((1 - 0.4) (1 + C) + 0.4/2)
    array([1.492537])
    """
    blocks = block.lanes()
    _check(sequence, factor_max, blocks.shape if paired else ())
    if not (math.isfinite(step) and step > 1.0):
        raise ValueError(f"step: expected a ratio above 1, got {step!r}")
    if sequence.spacing == "continuous" or np.all(sequence.secondary == 0.0):
        return _bands(blocks, sequence, factor_max)
    lowest = SMALLEST_START * np.asarray(blocks.critical_impulse) / sequence.main
    most = UNLIMITED if sequence.main_count is None else sequence.main_count
    reached = np.vectorize(amplification, otypes=[float])(blocks.restitution, most)
    start = np.maximum(np.asarray(blocks.critical_impulse) / (sequence.main * reached), lowest)
    points = 1 + np.ceil(np.log(np.maximum(factor_max / start, step)) / np.log(step)).astype(np.int64)

    def overturns(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        return scaled_outcomes(blocks, sequence, lanes, factors, threads) >= Outcome.OVERTURNS  # or is UNRESOLVED

    found = exceedance_intervals(overturns, start, factor_max, points)
    answer = scaled_outcomes(blocks, sequence, found.lane, found.lower[np.newaxis], threads)[0]
    return found.changed(resolved=answer != Outcome.UNRESOLVED)


def _check(sequence: ImpulseSequence, factor_max: float, pairs: tuple[int, ...] = ()) -> None:
    if sequence.shape != pairs:
        expected = f"one for each of {pairs[0]} blocks" if pairs else "one sequence"
        raise ValueError(f"sequence: expected {expected}, got shape {sequence.shape}")
    if pairs and sequence.main_count is None:
        raise ValueError("sequence: main_count is needed if paired is True")
    if not (math.isfinite(factor_max) and factor_max > 0.0):
        raise ValueError(f"factor_max: expected a positive number, got {factor_max}")


def _bands(block: Block, sequence: ImpulseSequence, factor_max: float) -> ScaleIntervals:
    """Return the scale factor intervals in which blocks overturn, in closed form; adjacent intervals are joined."""
    count = block.shape[0]
    most = UNLIMITED if sequence.main_count is None else sequence.main_count
    of_sequence = (sequence.main, sequence.secondary, sequence.duration, most)
    of_block = (block.critical_impulse, block.restitution, block.p)
    inputs = zip(*(np.broadcast_to(values, count) for values in (*of_sequence, *of_block)), strict=True)
    parts = [
        bands_of(main / critical, secondary / main if main > 0.0 else 0.0, c, p * duration, int(last), factor_max)
        for main, secondary, duration, last, critical, c, p in inputs
    ]
    lane = np.repeat(np.arange(count), [part.shape[1] for part in parts])
    lower, upper = np.concatenate(parts, axis=1) if parts else np.empty((2, 0))
    begins = np.ones(lane.size, dtype=bool)
    begins[1:] = (lane[1:] != lane[:-1]) | (upper[:-1] < lower[1:] * (1.0 - TOLERANCE))
    ends = np.append(begins[1:], True)[: lane.size]
    lane, lower, upper = lane[begins], lower[begins], upper[ends]
    safety = np.full(count, np.inf)
    lowest = np.flatnonzero(np.diff(lane, prepend=-1))
    safety[lane[lowest]] = lower[lowest]
    opened = upper >= factor_max
    resolved = np.ones(lane.size, dtype=bool)
    return ScaleIntervals(safety, np.minimum(safety, factor_max), lane, lower, upper, opened, np.ones(count), resolved)
