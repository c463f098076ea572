"""Blocks that a motion sets rocking: the family on which a sequence is calibrated where no blocks are given.

.. note:: A block tells something about the impulses of a motion where its peak is a number: neither overturned nor
   next to nothing. Both are decided by the critical impulse I_1c = g alpha_c/(p cos alpha_c), so the family lies about
   the I_1c at which the motion begins to overturn blocks of each restitution. A trial run on a pool finds it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.stats import qmc

from rocking.block import Block
from rocking.recorded import recorded_response
from rocking.response import Outcome, Response
from rockpulse.errors import TooWeak
from rockpulse.record.record import Record

__all__ = ["describe_family", "motion_family", "recorded_family"]

#: Frequency parameters [1/s]: half-diagonals of 7.4 to 0.3 m. On smaller blocks a half-wave is no impulse.
FREQUENCIES = (1.0, 5.0)

#: Critical angles [rad]: slenderness 12.5 to 3.
ANGLES = (0.08, 0.32)

#: Restitutions over Housner's, which tell the parameters apart (docs/decisions/010). At 0.4 hardly more than the last
#: main impulse counts; no free block is that dull, but the equation that its peak comes from is the same.
RESTITUTIONS = (1.0, 0.8, 0.6, 0.4)

#: I_1c of the family over that of the edge. Blocks below the edge overturn and are bounds; at 3, the impulse that takes
#: a block of the edge to alpha_c takes one to 1 - sqrt(1 - 1/9) = 0.06 of it, just above what counts as a number.
ABOUT_EDGE = (0.8, 3.0)

#: Values of p and of alpha_c in the pool, blocks chosen for each restitution, and points they are chosen from.
POOL, CHOSEN, POINTS = 10, 25, 8192


def motion_family(answer: Callable[[Block], Response]) -> Block:
    """The family of blocks for a motion: 100 of engineering size, 25 for each of four restitutions.

    They are evenly spread over (ln p, ln alpha_c) where I_1c is 0.8 to 3 times that of the edge of overturning, p 1 to
    5 1/s, and the slenderness at most 12.5 and at least 3 and that of the stockiest block which the motion moves.
    `answer` gives the :class:`rocking.Response` of (m,) blocks to the motion. Raises TooWeak where it moves no block of
    the pool.

    Notes
    -----
    The edge is the I_1c below which lie as many moved blocks of the pool as overturn: overturning ones above it and
    standing ones below it balance. A motion too weak or too strong for the pool has its edge at the end of it. Blocks
    are chosen by their parameters, never by their own peak, so the choice does not bend what is fitted to them.

    Examples
    --------
    >>> from rocking import ImpulseSequence, sequence_response
    >>> sequence = ImpulseSequence(0.2, 0.1, 0.2, np.inf, main_count=3)
    >>> motion_family(lambda blocks: sequence_response(blocks, sequence, table_rows=0)).shape
    (100,)
    """
    axes = np.geomspace(*FREQUENCIES, POOL), np.geomspace(*ANGLES, POOL), RESTITUTIONS
    p, alpha, factor = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    pool = _blocks(p, alpha, factor)
    outcome = np.asarray(answer(pool).outcome)
    overturned = outcome == Outcome.OVERTURNS
    moved = outcome != Outcome.AT_REST
    if not np.any(moved):
        raise TooWeak(
            f"the motion moves none of {p.size} blocks of slenderness {1.0 / np.tan(ANGLES[1]):.3g} to "
            f"{1.0 / np.tan(ANGLES[0]):.3g}: there is nothing to calibrate on"
        )
    spread = qmc.Halton(2, scramble=False).random(POINTS)
    p_, alpha_ = _between(spread[:, 0], *FREQUENCIES), _between(spread[:, 1], ANGLES[0], alpha[moved].max())
    impulses = np.asarray(_blocks(p_, alpha_, np.ones(POINTS)).critical_impulse)
    chosen = []
    for restitution in RESTITUTIONS:
        here = moved & (factor == restitution)
        critical = np.sort(np.asarray(pool.critical_impulse)[here])
        edge = critical[min(int(np.count_nonzero(overturned & here)), critical.size - 1)]
        about = (impulses >= ABOUT_EDGE[0] * edge) & (impulses <= ABOUT_EDGE[1] * edge)
        chosen += [(p_[one], alpha_[one], restitution) for one in np.flatnonzero(about)[:CHOSEN]]
    return _blocks(*np.array(chosen).T)


def recorded_family(record: Record, threads: int | None = None, vertical: Any = None) -> Block:
    """:func:`motion_family` of a conditioned record, under the nonlinear equation; TooWeak names the record.

    `vertical` is the vertical ground acceleration (n,) on its samples [m/s2], positive up.
    """

    def answer(blocks: Block) -> Response:
        return recorded_response(blocks, record.acceleration, record.dt, vertical=vertical, threads=threads)

    try:
        return motion_family(answer)
    except TooWeak as error:
        raise TooWeak(f"{record.id}: {error}") from None


def describe_family(blocks: Block) -> str:
    """A remark that names the ranges of the chosen blocks."""
    ranges = [
        (name, f"{np.min(values):.3g} to {np.max(values):.3g}{unit}")
        for name, values, unit in (
            ("I_1c", blocks.critical_impulse, " m/s"),
            ("p", blocks.p, " 1/s"),
            ("slenderness", blocks.slenderness, ""),
            ("C", blocks.restitution, ""),
        )
    ]
    said = ", ".join(f"{name} {values}" for name, values in ranges)
    return f"{np.size(blocks.p)} blocks chosen about the edge of overturning of this motion: {said}"


def _blocks(p: np.ndarray, alpha: np.ndarray, factor: np.ndarray) -> Block:
    return Block.from_parameters(p, alpha, factor * (1.0 - 1.5 * np.sin(alpha) ** 2))


def _between(share: np.ndarray, low: float, high: float) -> np.ndarray:
    return np.asarray(low * (high / low) ** share)
