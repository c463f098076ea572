"""Response to a main and a secondary sequence of impulses, impulse train and steady state (Casapulla & Maione 2017).

.. note:: The first main impulse of :func:`impulse_train` is positive: the ground is pushed to the right and the block
   starts to rock about its left-hand corner (theta < 0); the main impulses alternate.
"""

import logging
from dataclasses import dataclass

import numpy as np

from rocking.arguments import UNLIMITED, Booleans, Floats
from rocking.body.block import Block
from rocking.impulses.half_cycle import hop, stays_bounded
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rocking.impulses.sequence_kernel import (
    HALF_CYCLE_LIMIT,
    TABLE_ROWS,
    SequenceLanes,
    combined,
    empty_table,
    sequence_lanes,
    tabulated_response,
)
from rocking.lanes import LaneValues, lane_field, split_lanes
from rocking.pictures import short_repr
from rocking.response import HalfCycles, Outcome, Reason, Response, empty_results

#: Shorter trial intervals, times p [-], cannot be distinguished from the continuous limit.
_SHORTEST_INTERVAL = 1e-4
#: Larger numbers of intermediate impulses cannot be distinguished from the continuous limit.
_LARGEST_COUNT = 1_000_000
#: Largest number of impulses in a train.
_TRAIN_LIMIT = 2_000_000
logger = logging.getLogger("rockpulse")


def sequence_response(
    block: Block,
    sequence: ImpulseSequence,
    table_rows: int = TABLE_ROWS,
    threads: int | None = None,
    paired: bool = False,
) -> Response:
    """Compute the response to a main and a secondary sequence of impulses, half-cycle by half-cycle in closed form.

    Parameters
    ----------
    block : Block
        One block, or an array of m blocks.
    sequence : ImpulseSequence
        One sequence, or q of them; see :meth:`ImpulseSequence.scaled`.
    table_rows : int
        Largest number of half-cycles in the table; 0 for no table, which halves the computing time.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.
    paired : bool
        Whether each of the m blocks is paired with one of m sequences.

    Returns
    -------
    Response
        Arrays (q, m), without the axis of a scalar argument; (m,) for pairs. The table contains the half-cycles that a
        main impulse starts, until the motion repeats itself; later half-cycles and the free decay are only included in
        `impacts`, which is -1 for an endless motion. `overturning_time` is the start of the overturning half-cycle.
        UNRESOLVED after 50 000 half-cycles without an end (HALF_CYCLE_LIMIT), or for an interval below 1e-4/p
        (SHORT_INTERVAL).

    Raises
    ------
    ValueError
        For unequal numbers of blocks and sequences in pairs, or more than a million intermediate impulses in a
        half-cycle (use spacing "continuous").

    Notes
    -----
    With u_1 = I/I_1c (Eq. 3) and a = u_1 I_s/I (Eq. 11), each half-cycle of start velocity u goes through the steps of
    section 3.2: find the first return T* with the trial dT, or T* of the limit n -> infinity if it does not return; n =
    max(2, 2 round(T*/(2 dT))); solve x(T) = 0 for the smallest T with the corrected interval dT = T/n (T/(n + 1) for
    "open"); if there is no root, the block overturns. The impact speed u_r gives u_{i+1} = C u_r + u_1. For "start"
    with I_s/I above 2/3 and "middle" above 6/7 the corrected motion may pass through the ground inside a half-cycle,
    which the closed form does not detect: this is logged as a warning.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> impulse = block.critical_impulse / 1.9
    >>> sequence = ImpulseSequence(impulse, 0.5 * impulse, np.nan, np.inf, spacing="continuous")
    >>> sequence_response(block, sequence).overturning_half_cycle
    4
    """
    shape, drop, flat = _combined(block, sequence, paired)
    lanes, short = _lanes(sequence, flat)
    response = _unresolved(tabulated_response(sequence_lanes, lanes, shape, drop, table_rows, threads), short)
    contact = np.asarray(response.ground_contact)
    through = np.count_nonzero(contact)
    if through:
        logger.warning(
            "sequence: for %d of %d pairs of block and sequence, the corrected solution with spacing %r passes "
            "through the ground within a half-cycle; only the state at the end of the half-cycle is exact",
            through,
            contact.size,
            sequence.spacing,
        )
    return response


def scaled_outcomes(
    block: Block, sequence: ImpulseSequence, chosen: np.ndarray, factors: np.ndarray, threads: int | None = None
) -> np.ndarray:
    """Return outcomes (q, n) of blocks with indices `chosen` (n,) under their sequences scaled by `factors` (q, n)."""
    _, _, flat = _combined(block, sequence, paired=sequence.shape != ())
    flat = [np.tile(value[chosen], factors.shape[0]) for value in flat]
    flat[0], flat[1] = factors.reshape(-1) * flat[0], factors.reshape(-1) * flat[1]
    lanes, short = _lanes(sequence, flat)
    results, table = empty_results(short.size), empty_table(0, short.size)
    split_lanes(lambda first, last: sequence_lanes(first, last, lanes, results, table), short.size, threads)
    return np.where(short, int(Outcome.UNRESOLVED), results.outcome).reshape(factors.shape)


def _combined(
    block: Block, sequence: ImpulseSequence, paired: bool = False
) -> tuple[tuple[int, int], tuple[bool, bool], list[np.ndarray]]:
    most = UNLIMITED if sequence.main_count is None else sequence.main_count
    inputs = (sequence.main, sequence.secondary, sequence.interval, sequence.duration, most)
    return combined(inputs, (block.p, block.restitution, block.critical_impulse), paired)


def _lanes(sequence: ImpulseSequence, flat: list[np.ndarray]) -> tuple[SequenceLanes, np.ndarray]:
    """Return the arrays for the kernel, and a mask of entries whose secondary impulses are too close together."""
    main, secondary, interval, duration, main_count, p, restitution, critical = flat
    count = sequence.intermediate_count or 0
    if count > _LARGEST_COUNT:
        raise ValueError(
            f"intermediate_count: expected at most {_LARGEST_COUNT}, got {count}; use spacing='continuous'"
        )
    short = (secondary > 0.0) & (sequence.spacing != "continuous") & (count == 0) & (p * interval < _SHORTEST_INTERVAL)
    scaled, most = np.where(short, 0.0, main / critical), main_count.astype(np.int64)
    spacing = SPACINGS[sequence.spacing]
    return SequenceLanes(scaled, secondary / critical, p, restitution, interval, duration, most, count, spacing), short


def _unresolved(response: Response, short: np.ndarray) -> Response:
    """Return the response with the outcome UNRESOLVED if secondary impulses are too close together (`short`)."""
    short = short.reshape(np.shape(response.outcome))
    marks = {"peak_rotation_ratio": np.nan, "outcome": int(Outcome.UNRESOLVED), "impacts": -1}
    found = {
        name: np.where(short, mark, getattr(response, name))
        for name, mark in (marks | {"reason": int(Reason.SHORT_INTERVAL)}).items()
    }
    found = {name: values.item() if values.ndim == 0 else values for name, values in found.items()}
    return response.changed(**found) if np.any(short) else response


def impulse_train(block: Block, sequence: ImpulseSequence) -> tuple[np.ndarray, np.ndarray]:
    """Return the limit accelerogram of one block (Figures 1 and 2 of the paper): times and signed impulses.

    Parameters
    ----------
    block, sequence : Block, ImpulseSequence
        One block, and one sequence that is finite (a finite duration, a main count, or a motion that overturns).

    Returns
    -------
    times, impulses : (k,) ndarray
        Times [s], not decreasing, the first main impulse at 0, and impulses of the ground [m/s], the first one
        positive. Simultaneous impulses are listed in their order of action: the last secondary impulse (spacing "end")
        before the impact, the main impulse, the first secondary impulse (spacing "start").

    Raises
    ------
    ValueError
        For arrays of blocks or sequences, a sequence without end, or one that the model cannot resolve.

    Notes
    -----
    With this train and the paper's gain :func:`~rocking.impulses.impulsive.impulsive_response` gives the response of
    :func:`sequence_response`. An overturning half-cycle ends the train with its main impulse. The limit of infinitely
    many secondary impulses is a jump of I_s/2 against the main impulse at the start of the half-cycle and a jump of
    I_s/2 along it at the end.

    Examples
    --------
    >>> sequence = ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=2)
    >>> times, impulses = impulse_train(pier, sequence)
    >>> times.round(2)[:4], impulses[:4]
    (array([0.  , 0.1 , 0.19, 0.29]), array([ 0.5, -0.1,  0.1, -0.1]))
    """
    if block.shape or sequence.shape:
        raise ValueError(f"expected one block and one sequence, got shapes {block.shape} and {sequence.shape}")
    response = sequence_response(block, sequence, table_rows=HALF_CYCLE_LIMIT)
    if response.reason == Reason.SHORT_INTERVAL:
        raise ValueError(
            f"interval: expected at least {_SHORTEST_INTERVAL:g}/p = {_SHORTEST_INTERVAL / block.p:.3g} s, "
            f"got {sequence.interval:.3g} s; for a shorter interval use spacing='continuous' (infinitely many "
            "secondary impulses)"
        )
    if response.outcome == Outcome.UNRESOLVED:
        raise ValueError(
            f"the sequence has no end within {HALF_CYCLE_LIMIT} half-cycles; give a duration or a main_count"
        )
    if sequence.main == 0.0:
        return np.zeros(0), np.zeros(0)
    assert response.half_cycles is not None
    starts, rows = _half_cycle_starts(response, sequence)
    table = response.half_cycles
    times, impulses = [], []
    for number, row in enumerate(rows):
        sign = -1.0 if number % 2 else 1.0
        times.append(np.array([starts[number]]))
        impulses.append(np.array([sign * sequence.main]))
        if np.isfinite(table.duration[row]) and sequence.secondary > 0.0:
            offsets, signs = _secondary(sequence, table, row)
            times.append(np.minimum(starts[number] + offsets, starts[number + 1]))
            impulses.append(-sign * sequence.secondary * signs)
    return np.concatenate(times), np.concatenate(impulses)


def main_impulses_given(response: Response, sequence: ImpulseSequence) -> float:
    """Return the number of main impulses until the sequence ends or the block overturns; inf if neither happens."""
    assert response.half_cycles is not None
    durations = response.half_cycles.duration
    if durations.size == 0:
        return 0.0
    if response.outcome == Outcome.OVERTURNS:
        return float(response.overturning_half_cycle)
    # The last half-cycle of a table that ends early repeats itself.
    left = max(np.ceil((sequence.duration - float(np.sum(durations))) / durations[-1]), 0.0)
    return float(min(durations.size + left, np.inf if sequence.main_count is None else sequence.main_count))


def _half_cycle_starts(response: Response, sequence: ImpulseSequence) -> tuple[np.ndarray, np.ndarray]:
    """Return the starts of the half-cycles, followed by the end of the last one, and their rows in the table."""
    assert response.half_cycles is not None
    durations, count = response.half_cycles.duration, main_impulses_given(response, sequence)
    if (count - durations.size) * (1 + response.half_cycles.impulse_count[-1]) > _TRAIN_LIMIT:
        raise ValueError(f"the sequence has more than {_TRAIN_LIMIT} impulses; give a shorter duration or a main_count")
    rows = np.minimum(np.arange(int(count)), durations.size - 1)
    return np.concatenate([[0.0], np.cumsum(durations[rows])]), rows


def _secondary(sequence: ImpulseSequence, table: HalfCycles, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Return times and sizes/I_s of the secondary impulses after a main impulse; positive sizes oppose the main one."""
    if sequence.spacing == "continuous":
        return np.array([0.0, table.duration[row]]), np.array([0.5, -0.5])
    order = np.arange(1, table.impulse_count[row] + 1)
    phase = {"end": 0.0, "middle": 0.5, "start": 1.0, "open": 0.0}[sequence.spacing]
    offsets = (order - phase) * table.interval[row]
    if sequence.spacing == "end":
        offsets[-1] = table.duration[row]
    return offsets, np.where(order % 2, 1.0, -1.0)


@dataclass(frozen=True, eq=False)
class SteadyState(LaneValues):
    """The steady state under an endless sequence; arrays (q, m), or scalars for one block and one sequence.

    Attributes
    ----------
    start_velocity, effective_velocity : float or ndarray
        u* = u_1 (1 - C I_s/I)/(1 - C), theta'/(p alpha_c) right after the main impulse [-], inf if the motion grows
        without limit; v* = u* - u_1 I_s/(2 I).
    peak, half_period : float or ndarray
        x* = 1 - sqrt(1 - v*^2), largest theta/alpha_c [-], and 2 atanh(v*)/p [s]; inf if the motion does not stabilise.
    stable : bool or ndarray
        Whether the motion stabilises, v* <= 1 (at v* = 1 the limit is never reached).

    Examples
    --------
    >>> sequence = ImpulseSequence(0.3, 0.0, np.nan, np.inf, spacing="continuous")
    >>> steady = steady_state(Block(1.0, 3.0, restitution=0.6), sequence)
    >>> steady.stable, round(steady.peak, 3)
    (True, 0.126)
    """

    __repr__ = short_repr

    start_velocity: Floats = lane_field()
    effective_velocity: Floats = lane_field()
    peak: Floats = lane_field()
    half_period: Floats = lane_field()
    stable: Booleans = lane_field()


def steady_state(block: Block, sequence: ImpulseSequence) -> SteadyState:
    """Return the steady state under an endless main sequence, without secondary impulses or with continuous ones.

    Parameters
    ----------
    block, sequence : Block, ImpulseSequence
        One block or m blocks, and one sequence or q sequences of spacing "continuous" or without secondary impulses;
        the duration and the main count are ignored.

    Returns
    -------
    SteadyState
        Arrays (q, m), without the axis of a scalar argument: the fixed point u* of u_{i+1} = C (u_i - u_1 I_s/I) + u_1,
        which is Eq. (10) without secondary impulses.

    Raises
    ------
    ValueError
        For another spacing with secondary impulses, whose number may change from one half-cycle to the next.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.6, gravity=9.81)
    >>> impulse = 0.3 * block.critical_impulse
    >>> steady = steady_state(block, ImpulseSequence(impulse, 0.0, np.nan, np.inf, spacing="continuous"))
    >>> round(steady.start_velocity, 6), round(steady.peak, 6)
    (0.75, 0.338562)
    """
    if sequence.spacing != "continuous" and np.any(np.asarray(sequence.secondary) > 0.0):
        raise ValueError(f"spacing: expected 'continuous' (or no secondary impulses), got {sequence.spacing!r}")
    blocks = (block.p, block.restitution, block.critical_impulse)
    shape, drop, flat = combined((sequence.main, sequence.secondary), blocks)
    main, secondary, p, restitution, critical = flat
    u1, a = main / critical, secondary / critical
    ratio = np.divide(a, u1, out=np.zeros_like(a), where=u1 > 0.0)
    growth, loss = u1 - restitution * a, 1.0 - restitution
    # Without losses and without gain every velocity is a fixed point: the motion keeps its first velocity.
    limit = np.divide(growth, loss, out=np.where(growth > 0.0, np.inf, u1), where=loss > 0.0)
    effective = limit - 0.5 * a
    stable = np.array([stays_bounded(*lane) for lane in zip(u1, ratio, restitution, strict=True)], dtype=bool)
    hops = np.array([hop(velocity) for velocity in np.where(stable, np.minimum(effective, 1.0), np.inf)]).reshape(-1, 2)
    peak = np.where(stable & (effective >= 1.0), 1.0, hops[:, 0])
    values = (limit, effective, peak, hops[:, 1] / p, stable)
    return SteadyState(*(value.reshape(shape) for value in values)).squeezed(drop)
