"""The rigid block: geometry, restitution and the constants of its rocking motion (Casapulla & Maione 2017, section 3).

.. note:: A rectangle of half-width b and half-height a turns about its lower corners; R is the half-diagonal, alpha_c
   the angle between R and the vertical, and p = sqrt(3 g/(4 R)) the frequency parameter. A body that is no rectangle
   has p = sqrt(M g R/I_0), with R from the corner to the centre of mass.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rocking.arguments import positive, together
from rocking.block_limits import (
    most_restitution,
    radius_of_rectangle,
    restitution_of,
    restitution_remark,
    size_remark,
)

__all__ = ["SLENDERNESS_RANGE", "STANDARD_GRAVITY", "Block"]

STANDARD_GRAVITY = 9.80665

#: The linear, resonance and sequence models are stated for slenderness of at least this (section 3).
SLENDERNESS_RANGE = 3.0

LANE_FIELDS = (
    "half_width",
    "half_height",
    "restitution",
    "alpha_c",
    "p",
    "radius",
    "slenderness",
    "critical_impulse",
)

logger = logging.getLogger("rockpulse")


@dataclass(frozen=True, eq=False, init=False)
class Block:
    """A free-standing rigid block, or an array of them, by its half sizes or by its full ones.

    The fields broadcast to one shape (m,), or () for a single block.

    Parameters
    ----------
    half_width : float or (m,) array_like
        b, half the base in the plane of rocking [m].
    half_height : float or (m,) array_like
        a, half the height [m].
    width : float or (m,) array_like
        2b, the full base in the plane of rocking [m]; with `height`, in place of the two halves.
    height : float or (m,) array_like
        2a, the full height [m].
    restitution : "housner", float or (m,) array_like
        Velocity ratio C of an impact, C = theta'(after)/theta'(before) [-], 0 <= C <= 1. "housner" stands for
        1 - 1.5 sin^2(alpha_c), the bound of angular-momentum conservation (Housner's own r is its square).
    gravity : float
        Acceleration of gravity at the block [m/s2].
    log : bool
        Whether the warnings are logged too, by the logger "rockpulse".

    Attributes
    ----------
    alpha_c : float or (m,) ndarray
        Angle of the diagonal with the vertical, the rotation of unstable equilibrium [rad].
    p : float or (m,) ndarray
        Frequency parameter [1/s].
    radius : float or (m,) ndarray
        R, from the corner to the centre of mass [m]: half the diagonal of a rectangle; for a body given by p and alpha
        the radius that was given with them, else that of the rectangle with the same p.
    slenderness : float or (m,) ndarray
        a/b = 1/tan(alpha_c) [-].
    critical_impulse : float or (m,) ndarray
        I_1c = g alpha_c/(p cos alpha_c), the impulse that overturns the resting block at once (Eq. 9 with i = 1) [m/s].
    warnings : tuple of str
        Remarks for the user: a restitution above what angular momentum allows, a slenderness below the paper's range, a
        size that is doubted (larger than 30 m, less than 5 cm high or 1 mm wide, wider than high).

    Raises
    ------
    ValueError
        For sizes or gravity that are not positive and finite, for one size alone or a half size beside a full one, a
        restitution outside [0, 1], or "housner" for a block so squat that the formula turns negative (slenderness below
        0.707).

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, doi:10.7712/120117.5612.17190.
    Housner, G. W. (1963), Bull. Seismol. Soc. Am. 53(2), 403-417.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.93649167, gravity=9.81)
    >>> round(float(block.p), 7), round(float(block.restitution), 5)
    (1.9180068, 0.90625)

    The same by its full sizes:

    >>> wall = Block(width=0.25, height=2.2)
    >>> wall.half_width, wall.half_height, wall.width, wall.height
    (0.125, 1.1, 0.25, 2.2)
    """

    half_width: Any
    half_height: Any
    restitution: Any = "housner"
    gravity: float = STANDARD_GRAVITY

    alpha_c: Any = field(init=False)
    p: Any = field(init=False)
    radius: Any = field(init=False)
    slenderness: Any = field(init=False)
    critical_impulse: Any = field(init=False)
    warnings: tuple[str, ...] = field(init=False)

    def __init__(
        self,
        half_width: Any = None,
        half_height: Any = None,
        restitution: Any = "housner",
        gravity: float = STANDARD_GRAVITY,
        *,
        width: Any = None,
        height: Any = None,
        log: bool = True,
    ) -> None:
        sizes = {"half_width": half_width, "half_height": half_height, "width": width, "height": height}
        given = {name: positive(name, value, "m") for name, value in sizes.items() if value is not None}
        if set(given) not in ({"half_width", "half_height"}, {"width", "height"}):
            found = " and ".join(given) or "no size"
            raise ValueError(f"block: expected half_width and half_height, or width and height, in m; got {found}")
        base, rise = together(**given)
        if "width" in given:
            base, rise = base / 2.0, rise / 2.0
        gravity = float(positive("gravity", gravity, "m/s2", lanes=False))
        radius = np.hypot(base, rise)
        self._finish(
            half_width=base,
            half_height=rise,
            restitution=restitution,
            gravity=gravity,
            alpha_c=np.arctan2(base, rise),
            p=np.sqrt(3.0 * gravity / (4.0 * radius)),
            log=log,
        )

    @classmethod
    def from_parameters(
        cls,
        p: Any,
        alpha: Any,
        restitution: Any,
        gravity: float = STANDARD_GRAVITY,
        *,
        radius: Any = None,
        log: bool = True,
    ) -> Block:
        """A body that is no rectangle, by its frequency parameter and critical angle.

        Parameters
        ----------
        p : float or (m,) array_like
            Frequency parameter sqrt(M g R/I_0) [1/s].
        alpha : float or (m,) array_like
            Angle between the vertical and the line from the corner to the centre of mass [rad], below pi/2.
        restitution : float, (m,) array_like or "housner"
            As for :class:`Block`. "housner" stands for the most that conservation of angular momentum allows: with
            `radius` 1 - 2 (p^2 R/g) sin^2(alpha), the bound of this (symmetric) body; without it 1 - 1.5 sin^2(alpha),
            that of the rectangle with the same alpha.
        gravity : float
            Acceleration of gravity [m/s2].
        radius : float or (m,) array_like, optional
            R, the distance from the corner to the centre of mass [m]. It changes no motion, which depends on p, alpha
            and C: it tells which restitution the body can have.
        log : bool
            Whether the warnings are logged too, by the logger "rockpulse".

        Returns
        -------
        Block
            With `half_width`, `half_height`, `width` and `height` NaN: they are not known.

        Raises
        ------
        ValueError
            For p, alpha, radius or gravity that are not positive and finite, an alpha of pi/2 or more, a restitution
            outside [0, 1], "housner" where the bound is negative, or a radius that no body of this p has: p^2 R/g is
            M R^2/I_0, and I_0 = I_G + M R^2.

        Examples
        --------
        A solid cylinder 0.5 m thick and 2 m high, on a line across its base: I_0 = M (r^2/4 + H^2/12 + R^2).

        >>> radius, inertia = np.hypot(0.25, 1.0), 0.25**2 / 4 + 2.0**2 / 12 + 0.25**2 + 1.0**2
        >>> p = np.sqrt(STANDARD_GRAVITY * radius / inertia)
        >>> column = Block.from_parameters(p, np.arctan(0.25), "housner", radius=radius)
        >>> round(column.restitution, 4), round(Block(0.25, 1.0).restitution, 4)
        (0.9114, 0.9118)
        """
        given = {"p": positive("p", p, "1/s"), "alpha": positive("alpha", alpha, "rad")}
        if radius is not None:
            given["radius"] = positive("radius", radius, "m")
        p_, alpha_, *own = together(**given)
        if np.any(alpha_ >= np.pi / 2):
            raise ValueError(
                f"alpha: expected an angle below pi/2 rad, got {alpha!r}; it is given in radians, not degrees"
            )
        block = object.__new__(cls)
        unknown = np.full(p_.shape, np.nan)
        block._finish(
            half_width=unknown,
            half_height=unknown,
            restitution=restitution,
            gravity=float(positive("gravity", gravity, "m/s2", lanes=False)),
            alpha_c=alpha_,
            p=p_,
            radius=own[0] if own else None,
            log=log,
        )
        return block

    def lane(self, index: int) -> Block:
        """One lane of an array of blocks as a block of its own."""
        return self._with(lambda values: values[index].item())

    def lanes(self, count: int) -> Block:
        """A block of shape (count,): a single block repeated, or itself where it has that shape already."""
        return self._with(lambda values: np.broadcast_to(values, (count,)))

    def chosen(self, places: Any) -> Block:
        """Some lanes of an array of blocks: by their places, a mask or a slice."""
        return self._with(lambda values: np.ascontiguousarray(values[places]))

    @classmethod
    def stack(cls, blocks: Sequence[Block]) -> Block:
        """Several blocks in the same gravity as the lanes of one, in their order.

        Raises
        ------
        ValueError
            Without any block, or in different gravity.
        """
        gravities = {block.gravity for block in blocks}
        if len(gravities) != 1:
            raise ValueError(f"blocks: expected one gravity for all blocks of a stack, found {sorted(gravities)}")
        stacked = object.__new__(cls)
        object.__setattr__(stacked, "gravity", gravities.pop())
        object.__setattr__(stacked, "warnings", tuple(dict.fromkeys(w for block in blocks for w in block.warnings)))
        for name in LANE_FIELDS:
            object.__setattr__(stacked, name, np.concatenate([np.atleast_1d(getattr(block, name)) for block in blocks]))
        return stacked

    def _with(self, choose: Callable[[np.ndarray], Any]) -> Block:
        other = object.__new__(type(self))
        object.__setattr__(other, "gravity", self.gravity)
        object.__setattr__(other, "warnings", self.warnings)
        for name in LANE_FIELDS:
            object.__setattr__(other, name, choose(np.asarray(getattr(self, name))))
        return other

    def _finish(
        self,
        *,
        half_width: np.ndarray,
        half_height: np.ndarray,
        restitution: Any,
        gravity: float,
        alpha_c: np.ndarray,
        p: np.ndarray,
        radius: np.ndarray | None = None,
        log: bool,
    ) -> None:
        most = most_restitution(p, alpha_c, radius, gravity)
        ratios = restitution_of(restitution, most, own=radius is not None)
        values = {
            "half_width": half_width,
            "half_height": half_height,
            "restitution": ratios,
            "alpha_c": alpha_c,
            "p": p,
            "radius": radius_of_rectangle(p, gravity) if radius is None else radius,
            "slenderness": 1.0 / np.tan(alpha_c),
            "critical_impulse": gravity * alpha_c / (p * np.cos(alpha_c)),
        }
        lanes = together(size=alpha_c, restitution=ratios)[0].shape
        for name, value in values.items():
            value = np.array(np.broadcast_to(value, lanes), dtype=float)
            value.setflags(write=False)
            object.__setattr__(self, name, value.item() if value.ndim == 0 else value)
        object.__setattr__(self, "gravity", gravity)
        shape = "unknown" if radius is None else "own"
        sizes = (2.0 * values["radius"] * np.sin(alpha_c), 2.0 * values["radius"] * np.cos(alpha_c))
        if not np.any(np.isnan(half_width)):
            shape, sizes = "rectangle", (2.0 * half_width, 2.0 * half_height)
        remarks = [size_remark(*sizes, shape), restitution_remark(ratios, most, shape)]
        if not np.all(self.slender):
            remarks.append(
                f"slenderness {np.min(values['slenderness']):.3g} is below {SLENDERNESS_RANGE:g}: "
                "the models with linear motion (resonance, sequence, impulsive, linear) are outside their range"
            )
        object.__setattr__(self, "warnings", tuple(remark for remark in remarks if remark))
        if log:
            for warning in self.warnings:
                logger.warning("block: %s", warning)

    @property
    def width(self) -> Any:
        """Full width [m], 2b; NaN for a body given by p and alpha."""
        return 2.0 * self.half_width

    @property
    def height(self) -> Any:
        """Full height [m], 2a; NaN for a body given by p and alpha."""
        return 2.0 * self.half_height

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the lanes: () for one block, (m,) for several."""
        return np.shape(self.p)

    @property
    def slender(self) -> Any:
        """True where the slenderness is within the range of the models with linear natural motion."""
        return _slender(self.slenderness)


def _slender(slenderness: Any) -> Any:
    # A block of exactly 3 comes back from its angle as 3 less a bit.
    return slenderness >= SLENDERNESS_RANGE * (1.0 - 1e-12)
