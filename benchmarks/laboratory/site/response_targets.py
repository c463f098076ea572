"""The targets of a fitted sequence: the peak rotations theta_max/alpha_c of a family of blocks, and its selection."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import qmc

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rocking.march.recorded import recorded_response
from rocking.response import Outcome, Response
from rockpulse.errors import ConfigError, RecordRefused, TooWeak
from rockpulse.record.record import Record

#: Peaks below this are known to be small, and no more [-]: just after uplift the size of a peak is decided by how far
#: the acceleration exceeds the threshold, of which a sequence knows nothing.
SMALL = 0.05
#: Fewest peaks that are numbers: four parameters and a spread, and one to spare.
FEWEST_NUMBERS = 6
#: Frequency parameters [1/s]: half-diagonals of 7.4 to 0.3 m. On smaller blocks a half-wave is no impulse.
FREQUENCIES = (1.0, 5.0)
#: Critical angles [rad]: slenderness 12.5 to 3.
ANGLES = (0.08, 0.32)
#: Restitutions over Housner's, which tell the parameters apart (docs/decisions/010). At 0.4 hardly more than the last
#: main impulse counts; no free block is that dull, but the equation that its peak comes from is the same.
RESTITUTIONS = (1.0, 0.8, 0.6, 0.4)
#: I_1c of a family over that of the edge. Blocks below the edge overturn and are bounds; at 3, the impulse that takes
#: a block of the edge to alpha_c takes one to 1 - sqrt(1 - 1/9) = 0.06 of it, just above what counts as a number.
ABOUT_EDGE = (0.8, 3.0)
#: Values of p and of alpha_c in the pool, blocks chosen for each restitution, and points they are chosen from.
POOL, CHOSEN, POINTS = 10, 25, 8192


@dataclass(frozen=True, eq=False)
class ResponseTargets:
    """Peaks and outcomes of a family of blocks under one motion; RecordRefused or TooWeak for too few that rock.

    A block at rest is no target: an impulse has no acceleration, so that a sequence sets every block in motion.
    """

    blocks: Block  # (m,)
    peaks: np.ndarray  # (m,) theta_max/alpha_c [-]; inf where overturned, 0 at rest
    outcomes: np.ndarray  # (m,) :class:`rocking.Outcome`
    smallest: float = SMALL  # peaks below this are known to be small only [-]

    def __post_init__(self) -> None:
        peaks, outcomes = np.array(self.peaks, dtype=float), np.array(self.outcomes, dtype=np.int64)
        if len(self.blocks.shape) != 1 or not self.blocks.shape == peaks.shape == outcomes.shape:
            raise ConfigError(
                "targets: expected (m,) blocks with a peak and an outcome each, got shapes "
                f"{self.blocks.shape}, {peaks.shape} and {outcomes.shape}"
            )
        rocks = outcomes == Outcome.ROCKS
        if not np.all(np.isfinite(peaks[rocks]) & (peaks[rocks] > 0.0)):
            raise ConfigError("targets: expected a positive, finite peak of every block that rocks")
        for array in (peaks, outcomes):
            array.setflags(write=False)
        object.__setattr__(self, "peaks", peaks)
        object.__setattr__(self, "outcomes", outcomes)
        if not 0.0 < self.smallest < 1.0:
            raise ConfigError(f"targets: smallest: expected a peak between 0 and 1, got {self.smallest!r}")
        found = np.count_nonzero(self.number)
        if found < FEWEST_NUMBERS:
            moved = peaks.size - np.count_nonzero((outcomes == Outcome.AT_REST) | self.small)
            raise (TooWeak if moved < FEWEST_NUMBERS <= peaks.size else RecordRefused)(
                f"{found} of {peaks.size} blocks rock to a peak of {self.smallest:g} or more without overturning "
                f"({np.count_nonzero(self.overturned)} overturn, {np.count_nonzero(self.silent)} stay at rest): "
                f"the response calibration needs at least {FEWEST_NUMBERS}; choose blocks that this motion sets rocking"
            )

    @property
    def number(self) -> np.ndarray:
        """(m,) bool: the peak is a number."""
        return (self.outcomes == Outcome.ROCKS) & (self.peaks >= self.smallest)

    @property
    def small(self) -> np.ndarray:
        """(m,) bool: known to be below `smallest` only."""
        return (self.outcomes == Outcome.ROCKS) & (self.peaks < self.smallest)

    @property
    def overturned(self) -> np.ndarray:
        """(m,) bool: known to be at least 1 only."""
        return self.outcomes == Outcome.OVERTURNS

    @property
    def silent(self) -> np.ndarray:
        """(m,) bool: nothing is known of the sequence's peak."""
        return ~(self.number | self.small | self.overturned)

    def reached(self, sequences: ImpulseSequence, threads: int | None = None) -> np.ndarray:
        """Peaks (q, m) of the blocks under q sequences, or (1, m) under one [-]."""
        response = sequence_response(self.blocks, sequences, table_rows=0, threads=threads)
        return np.atleast_2d(response.peak_rotation_ratio)

    def short_of(self, peaks: np.ndarray) -> np.ndarray:
        """Share (q,) of the moved blocks whose peak (q, m) [-], inf where overturned, is below the target: unsafe."""
        speaks = ~self.silent
        target = np.where(self.overturned, np.inf, self.peaks)[speaks]
        return np.asarray(np.mean(peaks[:, speaks] < target, axis=1))

    def residuals(self, peaks: np.ndarray) -> np.ndarray:
        """ln(target/peak) (q, m) [-], of censored ones the distance to the nearest value that agrees; NaN if silent."""
        least = np.log(np.maximum(np.minimum(peaks, 1.0), 1e-300))
        beyond = np.isinf(peaks)
        with np.errstate(divide="ignore", invalid="ignore"):
            number = np.log(self.peaks) - np.log(np.maximum(peaks, 1e-300))
            lenient = np.minimum(np.log(self.peaks), 0.0)
        residual = np.full(peaks.shape, np.nan)
        residual = np.where(self.number, np.where(beyond, lenient, number), residual)
        residual = np.where(self.overturned, np.where(beyond, 0.0, -least), residual)
        return np.where(self.small, np.minimum(np.log(self.smallest) - least, 0.0), residual)

    def misfit(self, peaks: np.ndarray) -> np.ndarray:
        """Root mean square of the residuals over all targets but silent ones: (q,) for (q, m) peaks [-]."""
        return np.asarray(np.sqrt(np.nanmean(self.residuals(peaks) ** 2, axis=1)))


def recorded_targets(
    record: Record,
    blocks: Block,
    smallest: float = SMALL,
    threads: int | None = None,
    vertical: ArrayLike | None = None,
) -> ResponseTargets:
    """The targets of a conditioned record on (m,) blocks, by the nonlinear equation; RecordRefused if too few rock."""
    response = recorded_response(blocks, record.acceleration, record.dt, vertical=vertical, threads=threads)
    try:
        return ResponseTargets(blocks, np.asarray(response.peak_rotation_ratio), np.asarray(response.outcome), smallest)
    except RecordRefused as error:
        raise type(error)(f"{record.id}: {error}") from None


def motion_family(answer: Callable[[Block], Response]) -> Block:
    """The family of blocks for a motion: 100 of engineering size, 25 for each of four restitutions.

    They are evenly spread over (ln p, ln alpha_c) where I_1c is 0.8 to 3 times that of the edge, below which lie as
    many moved blocks of the pool as overturn; chosen by their parameters, never by their own peak. TooWeak if none
    moves.
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
    p_ = FREQUENCIES[0] * (FREQUENCIES[1] / FREQUENCIES[0]) ** spread[:, 0]
    alpha_ = ANGLES[0] * (alpha[moved].max() / ANGLES[0]) ** spread[:, 1]
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
    """:func:`motion_family` of a conditioned record, under the nonlinear equation; TooWeak names the record."""

    def answer(blocks: Block) -> Response:
        return recorded_response(blocks, record.acceleration, record.dt, vertical=vertical, threads=threads)

    try:
        return motion_family(answer)
    except TooWeak as error:
        raise TooWeak(f"{record.id}: {error}") from None


def describe_family(blocks: Block) -> str:
    """A warning that names the ranges of the chosen blocks."""
    columns = (
        ("I_1c", blocks.critical_impulse, " m/s"),
        ("p", blocks.p, " 1/s"),
        ("slenderness", blocks.slenderness, ""),
        ("C", blocks.restitution, ""),
    )
    said = ", ".join(f"{name} {np.min(values):.3g} to {np.max(values):.3g}{unit}" for name, values, unit in columns)
    return f"{np.size(blocks.p)} blocks chosen about the edge of overturning of this motion: {said}"


def _blocks(p: np.ndarray, alpha: np.ndarray, factor: np.ndarray) -> Block:
    return Block.from_parameters(p, alpha, factor * (1.0 - 1.5 * np.sin(alpha) ** 2))
