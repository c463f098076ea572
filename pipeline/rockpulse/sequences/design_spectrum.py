"""The design spectrum of a site (an overturning spectrum), and the equivalent impulse sequence of each body.

.. note:: S(p, C) [m/s] is the effective impulse on a slender block, which overturns if S >= g tan(alpha)/p. The
   sequence of a body has the I_s/I, dT and number N of main impulses of the site, and the main impulse I with which the
   sequence model has the scale factor of the spectrum, g tan(alpha)/(p S). With the first secondary impulse at dT and
   the last one at the impact (spacing "end") the start velocities are u_(i+1) = C (u_i - sigma u_1) + u_1, u_1 =
   I/I_1c. The block does not return to the ground if tanh t (1 - h tanh(p dT/2)) < u_N - h for all t, h = sigma u_1/2,
   so that

       I_c = I_1c/[(1 - sigma) S_N + (sigma/2) (1 + tanh(p dT/2))],  S_N = (1 - C^N)/(1 - C),

   for a half-cycle that contains a whole number of intervals. As the number n of secondary impulses must be even, I_c
   differs from this by up to 2 %; a search corrects I.
"""

from dataclasses import dataclass

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.main_sequence import critical_impulse_ratio
from rocking.pictures import short_repr
from rocking.search.capacity import sequence_critical_scale
from rocking.spectrum.overturning import LEAST_SLENDERNESS, slender_within

#: Range and step (as ratios) of the search for the critical main impulse about the value of the closed form.
MOST, STEP = 2.0, 1.002


@dataclass(frozen=True, eq=False)
class DesignSpectrum:
    """The design spectrum and the sequence parameters of a site, as :func:`rockpulse.load_design` reads them.

    Attributes
    ----------
    p : (a,) ndarray
        Frequency parameters, ascending [1/s].
    restitution : (c,) ndarray
        Restitutions C, ascending [-].
    spectrum : (a, c) ndarray
        S(p, C), positive [m/s].
    ratio, interval, main_count : float, float, int
        I_s/I [-], interval dT of the secondary impulses [s], and number N of main impulses.
    spacing : str
        Position of the secondary impulses in a half-cycle, see :class:`rocking.ImpulseSequence`.

    Examples
    --------
    >>> design = DesignSpectrum(
    ...     p=np.array([1.0, 4.0]), restitution=np.array([0.8, 1.0]), spectrum=np.full((2, 2), 0.6),
    ...     ratio=0.2, interval=0.2, main_count=5,
    ... )
    >>> block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9)
    >>> design.factor(block).round(4)  # (g tan(alpha)/p)/0.6
    array([0.82])
    >>> design.sequence(block).main.round(3)
    array([0.177])
    """

    __repr__ = short_repr

    p: np.ndarray
    restitution: np.ndarray
    spectrum: np.ndarray
    ratio: float
    interval: float
    main_count: int
    spacing: str = "end"

    def covers(self, block: Block) -> np.ndarray:
        """Return a mask (m,): True for free, symmetric blocks of slenderness 3.5 or more inside the spectrum."""
        return within(block.lanes(), self.p, self.restitution)

    def effective_impulse(self, block: Block) -> np.ndarray:
        """Return the effective impulse S (m,) [m/s] on each block; ValueError for a block outside the spectrum."""
        one = block.lanes()
        outside = np.flatnonzero(~self.covers(one))
        if outside.size:
            raise ValueError(
                f"block: the design spectrum covers slenderness {LEAST_SLENDERNESS:g} or more, p from "
                f"{self.p[0]:g} to {self.p[-1]:g} 1/s and C from {self.restitution[0]:g} to {self.restitution[-1]:g}, "
                f"but not {outside.size} of {one.shape[0]} blocks, the first at index {int(outside[0])}"
            )
        return np.exp(at_blocks(one, self.p, self.restitution, np.log(self.spectrum)))

    def factor(self, block: Block) -> np.ndarray:
        """Return the scale factor (m,) on the spectrum at which each block overturns; ValueError for blocks outside."""
        one = block.lanes()
        return np.asarray(one.gravity * np.tan(one.alpha_c) / one.p / self.effective_impulse(one))

    def sequence(self, block: Block) -> ImpulseSequence:
        """Return for each of (m,) blocks the sequence that overturns it at the scale factor :meth:`factor`.

        Use the sequences with ``sequence_response(..., paired=True)``. ValueError for a block outside the spectrum.
        """
        one, factor = block.lanes(), self.factor(block)
        critical = critical_main(one, self.ratio, self.interval, self.main_count)
        found = sequence_critical_scale(one, self._sequence(critical), MOST, STEP, paired=True).safety_factor
        return self._sequence(found * critical / factor)

    def _sequence(self, main: np.ndarray) -> ImpulseSequence:
        most = np.full(main.shape, self.main_count)
        return ImpulseSequence(main, self.ratio * main, self.interval, np.inf, most, spacing=self.spacing)


def critical_main(block: Block, ratio: ArrayLike, interval: float, main_count: int) -> np.ndarray:
    """Return the main impulse I_c (m,) [m/s] at which a sequence overturns each block, in closed form.

    >>> block = Block(1.0, 4.0, restitution=0.9)
    >>> one = critical_main(block, 0.0, 0.1, main_count=2)  # without secondary impulses: I_2c of Eq. 9
    >>> bool(np.isclose(one, rocking.critical_impulse(block, 2)))
    True
    """
    main = 1.0 / critical_impulse_ratio(block.restitution, main_count)
    gained = 0.5 * np.asarray(ratio) * (1.0 + np.tanh(0.5 * np.asarray(block.p) * interval))
    return np.asarray(block.critical_impulse / ((1.0 - np.asarray(ratio)) * main + gained))


def at_blocks(block: Block, p: np.ndarray, restitution: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Interpolate `values` (a, c, ...) on a grid of p and C at the p and C of m blocks; return an array (m, ...)."""
    from scipy.interpolate import RegularGridInterpolator  # imported late, as its import is slow

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
