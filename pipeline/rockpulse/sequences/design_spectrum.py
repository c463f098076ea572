"""The design of a site as an overturning spectrum, and the equivalent impulse sequence of each body.

.. note:: S(p, C) [m/s] is the effective impulse on a slender block, which overturns if S >= g tan(alpha)/p. A sequence
   of continuous spacing overturns it if I_eff = I [(1 - sigma) S_N + sigma/2] >= I_1c = g alpha/(p cos alpha)
   (:meth:`rocking.ImpulseSequence.effective_impulse`). So any sequence with I_eff/I_1c = S p/(g tan alpha) gives the
   same outcome and scale factor as the spectrum. The sigma and N of the half-waves select one such sequence.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.pictures import short_repr
from rocking.spectrum.overturning import LEAST_SLENDERNESS, slender_within


@dataclass(frozen=True, eq=False)
class DesignSpectrum:
    """The design of a site as an overturning spectrum, as :func:`rockpulse.load_design` reads it.

    Attributes
    ----------
    p : (a,) ndarray
        Frequency parameters, ascending [1/s].
    restitution : (c,) ndarray
        Restitutions C, ascending [-].
    spectrum : (a, c) ndarray
        S(p, C), positive [m/s].
    ratio : (a,) ndarray
        I_s/I for a block of each p [-].
    main_count : (a,) ndarray of int
        Number of main impulses for a block of each p.

    Examples
    --------
    >>> design = DesignSpectrum(
    ...     p=np.array([1.0, 4.0]), restitution=np.array([0.8, 1.0]), spectrum=np.full((2, 2), 0.6),
    ...     ratio=np.array([0.2, 0.2]), main_count=np.array([2, 5]),
    ... )
    >>> design.factor(Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9)).round(4)  # (g tan(alpha)/p)/0.6
    array([0.82])
    """

    __repr__ = short_repr

    p: np.ndarray
    restitution: np.ndarray
    spectrum: np.ndarray
    ratio: np.ndarray
    main_count: np.ndarray

    def covers(self, block: Block) -> np.ndarray:
        """Return a mask (m,): True for free, symmetric blocks of slenderness 3.5 or more in the ranges of p and C."""
        return within(block.lanes(), self.p, self.restitution)

    def effective_impulse(self, block: Block) -> np.ndarray:
        """Return S (m,) [m/s] of each block, interpolated in the spectrum; raise ValueError outside the spectrum."""
        one = block.lanes()
        outside = np.flatnonzero(~self.covers(one))
        if outside.size:
            raise ValueError(
                f"block: the design spectrum covers slenderness {LEAST_SLENDERNESS:g} and more, p from "
                f"{self.p[0]:g} to {self.p[-1]:g} 1/s and C from {self.restitution[0]:g} to {self.restitution[-1]:g}, "
                f"but not {outside.size} of {one.shape[0]} blocks, the first at index {int(outside[0])}"
            )
        return np.exp(at_blocks(one, self.p, self.restitution, np.log(self.spectrum)))

    def factor(self, block: Block) -> np.ndarray:
        """Return the scale factor (m,) on the design at which each block overturns; ValueError outside the spectrum."""
        one = block.lanes()
        return np.asarray(one.gravity * np.tan(one.alpha_c) / one.p / self.effective_impulse(one))

    def nearest(self, block: Block) -> np.ndarray:
        """Return the index (m,) of the frequency parameter of the design that is nearest to the p of each block."""
        return np.asarray(np.argmin(np.abs(np.log(np.divide.outer(np.atleast_1d(block.p), self.p))), axis=1))

    def sequence(self, block: Block) -> ImpulseSequence:
        """Return for each of (m,) blocks a sequence with the effect of the design; ValueError outside the spectrum.

        I_s/I and the number of main impulses are taken at the nearest p; the spacing is "continuous". Use the sequences
        with ``sequence_response(..., paired=True)``.
        """
        one, nearest = block.lanes(), self.nearest(block)
        demand = 1.0 / self.factor(one)
        ratio, count = self.ratio[nearest], self.main_count[nearest]
        unit = ImpulseSequence(1.0, ratio, np.nan, np.inf, main_count=count, spacing="continuous")
        main = demand * one.critical_impulse / unit.effective_impulse(one.restitution)
        return ImpulseSequence(main, ratio * main, np.nan, np.inf, main_count=count, spacing="continuous")


def at_blocks(block: Block, p: np.ndarray, restitution: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values (m, ...) at the p and C of blocks, interpolated in `values` (a, c, ...) over ln p and C."""
    places = []
    for at, axis in ((np.log(block.p), np.log(p)), (block.restitution, restitution)):
        places.append(np.clip(np.broadcast_to(at, block.shape), axis[0], axis[-1]))
    # An axis with a single value needs no interpolation.
    axes = [np.append(axis, axis[-1] + 1.0) if axis.size == 1 else axis for axis in (np.log(p), restitution)]
    grid = np.pad(
        values, [(0, int(axis.size == 1)) for axis in (p, restitution)] + [(0, 0)] * (values.ndim - 2), "edge"
    )
    return np.asarray(RegularGridInterpolator(axes, grid)(np.column_stack(places)))


def within(block: Block, p: np.ndarray, restitution: np.ndarray) -> np.ndarray:
    """Return a mask (m,) of the free, slender blocks whose p [1/s] and C are inside the given ascending ranges."""
    found = np.asarray(block.restitution)
    above, below = found >= restitution[0] * (1.0 - 1e-9), found <= restitution[-1] * (1.0 + 1e-9)
    return np.asarray(slender_within(block, p) & above & below & block.free)
