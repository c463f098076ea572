"""The targets of a calibrated sequence: the peak rotations of a family of blocks, and which of them are numbers.

.. note:: A peak is theta_max/alpha_c. Four kinds of target:

   ==========  ==================================  =========================================================
   kind        the block                           what it says of the sequence's peak
   ==========  ==================================  =========================================================
   number      rocks, peak of at least SMALL       the peak itself, with a lognormal error
   overturned  overturns                           at least 1 (right-censored)
   small       rocks, peak below SMALL             below SMALL (left-censored)
   silent      stays at rest, or is unresolved     nothing
   ==========  ==================================  =========================================================

   A block at rest is silent because an impulse has no acceleration: rest says that the PGA is below g tan(alpha_c),
   however large the impulses of the record are, while the impulses of a sequence set every block in motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rocking.quantities import ArrayLike
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.errors import ConfigError, RecordRefused, TooWeak
from rockpulse.record.record import Record

__all__ = ["SMALL", "ResponseTargets", "block_family", "recorded_targets"]

#: Peaks below this are known to be small, and no more [-]: just after uplift the size of a peak is decided by how far
#: the acceleration exceeds the threshold, of which a sequence knows nothing.
SMALL = 0.05

#: Fewest peaks that are numbers: four parameters and a spread, and one to spare.
FEWEST_NUMBERS = 6


@dataclass(frozen=True, eq=False)
class ResponseTargets:
    """Peaks and outcomes of a family of blocks under one motion.

    Raises ConfigError for arrays of other lengths, or a block that rocks without a positive, finite peak; RecordRefused
    with fewer than 6 blocks whose peak is a number; TooWeak where no 6 of enough blocks move, be it to overturn.
    """

    blocks: Block  # (m,) blocks
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

    def short_of(self, peaks: np.ndarray) -> np.ndarray:
        """Share (q,) of the moved blocks whose peak (q, m) [-] is below the target: the unsafe side.

        Peaks are inf where overturned; an overturned target is reached by overturning only.
        """
        speaks = ~self.silent
        target = np.where(self.overturned, np.inf, self.peaks)[speaks]
        return np.asarray(np.mean(peaks[:, speaks] < target, axis=1))

    def residuals(self, peaks: np.ndarray) -> np.ndarray:
        """ln(target/peak) (q, m) [-], or its distance to the nearest value that agrees where one is censored.

        NaN for silent targets. A sequence that overturns a block (peak inf) is known to reach at least 1 there.
        """
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


def block_family() -> Block:
    """The default family: 100 blocks of engineering size.

    p of 1 to 5 1/s (half-diagonals of 7.4 to 0.3 m), slenderness 12.5 to 3, five of each in equal ratios, and Housner's
    restitution times 1, 0.9, 0.75 and 0.6. The restitution is what tells the parameters apart (docs/decisions/010): a
    block answers the N-th main impulse with the velocity I [1 - sigma/2 + (1 - sigma) (C + ... + C^(N-1))]/I_1c, in
    which I, sigma = I_s/I and N act differently at different C only. Measured restitutions are 0.95 to 0.97 of
    Housner's on concrete and 0.67 on rubber (ElGawady).

    Examples
    --------
    >>> family = block_family()
    >>> family.shape, round(float(family.radius.max()), 2), round(float(family.slenderness.max()), 1)
    ((100,), 7.35, 12.5)
    """
    p, alpha, factor = np.meshgrid(
        np.geomspace(1.0, 5.0, 5), np.geomspace(0.08, 0.32, 5), [1.0, 0.9, 0.75, 0.6], indexing="ij"
    )
    housner = 1.0 - 1.5 * np.sin(alpha.ravel()) ** 2
    return Block.from_parameters(p.ravel(), alpha.ravel(), factor.ravel() * housner)


def recorded_targets(
    record: Record,
    blocks: Block,
    smallest: float = SMALL,
    threads: int | None = None,
    vertical: ArrayLike | None = None,
) -> ResponseTargets:
    """The targets of a conditioned record: peaks of (m,) blocks under the nonlinear equation.

    Peaks below `smallest` are known to be small only [-]; `vertical` (n,) is the vertical ground acceleration on the
    samples of the record [m/s2], positive up. Raises RecordRefused, naming the record, where too few blocks rock.
    """
    response = recorded_response(blocks, record.acceleration, record.dt, vertical=vertical, threads=threads)
    try:
        return ResponseTargets(blocks, np.asarray(response.peak_rotation_ratio), np.asarray(response.outcome), smallest)
    except RecordRefused as error:
        raise type(error)(f"{record.id}: {error}") from None
