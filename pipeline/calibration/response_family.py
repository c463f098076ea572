"""Blocks that a motion sets rocking: the family on which a sequence is calibrated where no blocks are given.

.. note:: A block tells something about the impulses of a motion where its peak is a number: neither overturned nor
   next to nothing. Both are decided by the critical impulse I_1c = g alpha_c/(p cos alpha_c), so the family lies about
   the I_1c at which the motion begins to overturn blocks of each restitution. A trial run on a pool finds it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.models.block import STANDARD_GRAVITY, Block
from rockpulse.models.recorded import recorded_response
from rockpulse.models.response import Outcome, Response
from rockpulse.record import Record

__all__ = ["describe_family", "motion_family", "recorded_family"]

#: Frequency parameters [1/s]: half-diagonals of 7.4 m to 11 cm.
FREQUENCIES = (1.0, 8.0)

#: Critical angles [rad]: slenderness 20 to 3.
ANGLES = (0.05, 0.32)

#: Restitutions over Housner's: what tells the parameters apart (docs/decisions/013).
RESTITUTIONS = (1.0, 0.9, 0.75, 0.6)

#: I_1c of the family over that of the edge: blocks below it overturn and are bounds; at 3, the impulse that carries a
#: block of the edge to alpha_c leads to a peak of 1 - sqrt(1 - 1/9) = 0.06, just above what counts as a number.
ABOUT_EDGE = (0.8, 3.0)

#: Values of I_1c for each restitution, and of p for each I_1c.
IMPULSES, SIZES = 5, 5

#: Values of p and of alpha_c in the pool.
POOL = 10


def motion_family(answer: Callable[[Block], Response]) -> Block:
    """The family of blocks for a motion: 100 of engineering size.

    Parameters
    ----------
    answer : callable
        The :class:`rockpulse.models.Response` of (m,) blocks to the motion.

    Returns
    -------
    Block
        (100,) blocks: for each of four restitutions five I_1c in equal ratios, from 0.8 to 3 times the edge of
        overturning, and for each of them five p in equal ratios. p is within 1 to 8 1/s, the slenderness within 20 and
        that of the stockiest block which the motion moves, at most 3; where these limits allow, the edge is inside.

    Raises
    ------
    RecordRefused
        Where the motion moves no block of the pool.

    Notes
    -----
    The edge is the I_1c below which lie as many moved blocks of the pool as overturn: overturning ones above it and
    standing ones below it balance. Blocks are chosen by their parameters, never by their own outcome or peak, so the
    choice does not bend what is fitted to them. alpha_c = p I_1c/g leaves out cos alpha_c: I_1c is met to 5 %.

    Examples
    --------
    >>> from rockpulse.models import ImpulseSequence, sequence_response
    >>> sequence = ImpulseSequence(0.2, 0.1, 0.2, np.inf, main_count=3)
    >>> family = motion_family(lambda blocks: sequence_response(blocks, sequence, table_rows=0))
    >>> family.shape
    (100,)
    """
    axes = np.geomspace(*FREQUENCIES, POOL), np.geomspace(*ANGLES, POOL), RESTITUTIONS
    p, alpha, factor = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    pool = _blocks(p, alpha, factor)
    outcome = np.asarray(answer(pool).outcome)
    overturned = outcome == Outcome.OVERTURNS
    moved = overturned | (outcome == Outcome.ROCKS)
    if not np.any(moved):
        raise RecordRefused(
            f"the motion moves none of {pool.p.size} blocks of slenderness {1.0 / np.tan(ANGLES[1]):.3g} to "
            f"{1.0 / np.tan(ANGLES[0]):.3g}: there is nothing to calibrate on"
        )
    stockiest = alpha[moved].max()
    chosen = []
    for restitution in RESTITUTIONS:
        here = factor == restitution
        critical = np.sort(np.asarray(pool.critical_impulse)[here & moved])
        edge = critical[min(np.count_nonzero(overturned & here), critical.size - 1)]
        limits = STANDARD_GRAVITY * ANGLES[0] / FREQUENCIES[1], STANDARD_GRAVITY * stockiest / FREQUENCIES[0]
        for impulse in np.geomspace(*np.clip(edge * np.array(ABOUT_EDGE), *limits), IMPULSES):
            most = min(FREQUENCIES[1], STANDARD_GRAVITY * stockiest / impulse)
            least = max(FREQUENCIES[0], STANDARD_GRAVITY * ANGLES[0] / impulse)
            sizes = np.geomspace(least, most, SIZES)
            chosen.append((sizes, sizes * impulse / STANDARD_GRAVITY, np.full(SIZES, restitution)))
    return _blocks(*np.concatenate(chosen, axis=1))


def recorded_family(record: Record, threads: int | None = None) -> Block:
    """:func:`motion_family` of a conditioned record, under the nonlinear equation.

    Raises
    ------
    RecordRefused
        Where it moves no block of the pool, naming the record.
    """
    try:
        return motion_family(lambda blocks: recorded_response(blocks, record.acceleration, record.dt, threads=threads))
    except RecordRefused as error:
        raise RecordRefused(f"{record.id}: {error}") from None


def describe_family(blocks: Block) -> str:
    """What was chosen, in words, as a remark."""
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
