"""What is not known of a body and of the strength of its motion, and how it spreads over the factor on a record.

.. note:: In a draw the factor f on the record becomes f F with ln F normal, C a share of the nominal one, and alpha
   becomes alpha exp(-g abs(N)), N standard normal, at the R and p and with the C of the nominal body. One draw holds
   for all contacts of a body. A slender body sees f p/(g tan alpha) alone (:mod:`rocking.overturning_spectrum`), so
   there factor and geometry are one shift of its logarithm: Z = s N_1 + g abs(N_2), skew-normal with the scale
   hypot(s, g) and the shape g/s (Azzalini 1985, Scand. J. Stat. 12(2), 171-178).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, owens_t

from rocking.arguments import numbers
from rocking.quantities import ArrayLike

__all__ = ["Uncertainty"]

#: Least spread of the factor on the record [-]: lanes on a finite number of levels cannot show a narrower one.
LEAST_SPREAD = 0.02

#: Largest spreads that are taken for uncertainties and not for slips of the unit [-].
LARGEST_SPREAD = 1.0

#: Scales of the shift beyond which its density counts as 0: it is 1e-14 of the highest there.
FARTHEST = 8.0


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty under which a probability of overturning is stated.

    Attributes
    ----------
    factor : float
        Standard deviation of the logarithm of the factor on the record [-], 0.02 to 1.
    restitution : (float, float)
        Least and most of the restitution over the nominal C [-], between which it is uniform; above 0, at most 1.
    geometry : float
        Loss of the angle alpha [-]: alpha exp(-geometry abs(N)), N standard normal, at fixed R and p; 0 to 1.

    Raises
    ------
    ValueError
        For a value outside its range.

    Examples
    --------
    >>> known = Uncertainty(geometry=0.0)
    >>> float(known.density(0.0).round(6))                        # 1/(0.1 sqrt(2 pi))
    3.989423
    """

    factor: float = 0.10
    restitution: tuple[float, float] = (0.9, 1.0)
    geometry: float = 0.05

    def __post_init__(self) -> None:
        expected = f"a standard deviation of {LEAST_SPREAD:g} to {LARGEST_SPREAD:g}"
        if not LEAST_SPREAD <= numbers("factor", self.factor, expected, lanes=False) <= LARGEST_SPREAD:
            raise ValueError(f"factor: expected {expected}, got {self.factor!r}")
        expected = "the least and the most of C over the nominal one, above 0 and at most 1"
        shares = numbers("restitution", self.restitution, expected)
        if shares.shape != (2,) or not 0.0 < shares[0] <= shares[1] <= 1.0:
            raise ValueError(f"restitution: expected {expected}, got {self.restitution!r}")
        expected = f"a share from 0 to {LARGEST_SPREAD:g}"
        if not 0.0 <= numbers("geometry", self.geometry, expected, lanes=False) <= LARGEST_SPREAD:
            raise ValueError(f"geometry: expected {expected}, got {self.geometry!r}")

    @property
    def spread(self) -> float:
        """Standard deviation of the shift of the logarithm of the factor by factor and geometry together [-]."""
        return math.sqrt(self.factor**2 + (1.0 - 2.0 / math.pi) * self.geometry**2)

    def density(self, shift: ArrayLike) -> np.ndarray:
        """Probability density of the shift Z of the logarithm of the factor, by factor and geometry together [-]."""
        scale = math.hypot(self.factor, self.geometry)
        at = np.asarray(shift, dtype=float) / scale
        near = np.abs(at) < FARTHEST
        inside, found = at[near], np.zeros(at.shape)
        bell = np.exp(-0.5 * inside * inside) * (2.0 / (scale * math.sqrt(2.0 * math.pi)))
        found[near] = bell * ndtr(self.geometry / self.factor * inside)
        return found

    def below(self, shift: ArrayLike) -> np.ndarray:
        """Probability that the shift Z of :meth:`density` is no larger than the given one [-]."""
        at = np.asarray(shift, dtype=float) / math.hypot(self.factor, self.geometry)
        return ndtr(at) - 2.0 * owens_t(at, self.geometry / self.factor)
