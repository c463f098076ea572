"""The rigid block: geometry, restitution and the constants of its rocking motion (Casapulla & Maione 2017, section 3).

.. note:: A rectangle of half-width b and half-height a turns about its lower corners; R is the half-diagonal, alpha_c
   the angle between R and the vertical, and p = sqrt(3 g/(4 R)) the frequency parameter. A body that is no rectangle
   has p = sqrt(M g R/I_0).
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

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


@dataclass(frozen=True, eq=False)
class Block:
    """A free-standing rigid block, or an array of them.

    The fields broadcast to one shape (m,), or () for a single block.

    Parameters
    ----------
    half_width : float or (m,) array_like
        b, half the base in the plane of rocking [m].
    half_height : float or (m,) array_like
        a, half the height [m].
    restitution : "housner", float or (m,) array_like
        Velocity ratio C of an impact, C = theta'(after)/theta'(before) [-], 0 <= C <= 1. "housner" stands for
        1 - 1.5 sin^2(alpha_c), the bound of angular-momentum conservation (Housner's own r is its square).
    gravity : float
        Acceleration of gravity at the block [m/s2].

    Attributes
    ----------
    alpha_c : float or (m,) ndarray
        Angle of the diagonal with the vertical, the rotation of unstable equilibrium [rad].
    p : float or (m,) ndarray
        Frequency parameter [1/s].
    radius : float or (m,) ndarray
        R, half the diagonal [m]; for a body given by p the radius of the rectangle with the same p.
    slenderness : float or (m,) ndarray
        a/b = 1/tan(alpha_c) [-].
    critical_impulse : float or (m,) ndarray
        I_1c = g alpha_c/(p cos alpha_c), the impulse that overturns the resting block at once (Eq. 9 with i = 1) [m/s].
    warnings : tuple of str
        Remarks for the user: a restitution above Housner's bound, a slenderness below the paper's range.

    Raises
    ------
    ValueError
        For sizes or gravity that are not positive and finite, a restitution outside [0, 1], or "housner" for a block
        so squat that the formula turns negative (slenderness below 0.707).

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, doi:10.7712/120117.5612.17190.
    Housner, G. W. (1963), Bull. Seismol. Soc. Am. 53(2), 403-417.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.93649167, gravity=9.81)
    >>> round(float(block.p), 7), round(float(block.restitution), 5)
    (1.9180068, 0.90625)
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

    def __post_init__(self) -> None:
        width, height = _together(
            half_width=_positive("half_width", self.half_width, "m"),
            half_height=_positive("half_height", self.half_height, "m"),
        )
        gravity = float(_positive("gravity", self.gravity, "m/s2", lanes=False))
        radius = np.hypot(width, height)
        self._finish(
            half_width=width,
            half_height=height,
            gravity=gravity,
            alpha_c=np.arctan2(width, height),
            p=np.sqrt(3.0 * gravity / (4.0 * radius)),
            rectangle=True,
        )

    @classmethod
    def from_parameters(cls, p: Any, alpha: Any, restitution: Any, gravity: float = STANDARD_GRAVITY) -> Block:
        """A body that is no rectangle, by its frequency parameter and critical angle.

        Parameters
        ----------
        p : float or (m,) array_like
            Frequency parameter sqrt(M g R/I_0) [1/s].
        alpha : float or (m,) array_like
            Angle between the vertical and the line from the corner to the centre of mass [rad], below pi/2.
        restitution : float, (m,) array_like or "housner"
            As for :class:`Block`; "housner" is the value of the rectangle with the same alpha.
        gravity : float
            Acceleration of gravity [m/s2].

        Returns
        -------
        Block
            With `half_width` and `half_height` NaN: they are not known.
        """
        p_, alpha_ = _together(p=_positive("p", p, "1/s"), alpha=_positive("alpha", alpha, "rad"))
        if np.any(alpha_ >= np.pi / 2):
            raise ValueError(
                f"alpha: expected an angle below pi/2 rad, got {alpha!r}; it is given in radians, not degrees"
            )
        block = object.__new__(cls)
        object.__setattr__(block, "restitution", restitution)
        unknown = np.full(p_.shape, np.nan)
        block._finish(
            half_width=unknown,
            half_height=unknown,
            gravity=float(_positive("gravity", gravity, "m/s2", lanes=False)),
            alpha_c=alpha_,
            p=p_,
            rectangle=False,
        )
        return block

    def lane(self, index: int) -> Block:
        """One lane of an array of blocks as a block of its own."""
        return self._with(lambda values: values[index].item())

    def lanes(self, count: int) -> Block:
        """A block of shape (count,): a single block repeated, or itself where it has that shape already."""
        return self._with(lambda values: np.broadcast_to(values, (count,)))

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

    def _finish(self, *, rectangle: bool, **values: Any) -> None:
        alpha = values["alpha_c"]
        housner = 1.0 - 1.5 * np.sin(alpha) ** 2
        restitution = self._restitution(housner)
        values["restitution"] = restitution
        values["radius"] = 3.0 * values["gravity"] / (4.0 * values["p"] ** 2)
        values["slenderness"] = 1.0 / np.tan(alpha)
        values["critical_impulse"] = values["gravity"] * alpha / (values["p"] * np.cos(alpha))
        lanes = _together(size=alpha, restitution=restitution)[0].shape
        for name, value in values.items():
            if name != "gravity":
                value = np.array(np.broadcast_to(value, lanes), dtype=float)
                value.setflags(write=False)
                value = value.item() if value.ndim == 0 else value
            object.__setattr__(self, name, value)
        warnings = []
        above = restitution - housner
        if np.any(above > 1e-12):
            worst = np.unravel_index(np.argmax(above), above.shape)
            given, bound = (float(np.broadcast_to(values_, above.shape)[worst]) for values_ in (restitution, housner))
            shape = "" if rectangle else " of a rectangle with this alpha"
            warnings.append(
                f"restitution {given:.4g} is above Housner's {bound:.4g}{shape}: more energy is kept in an impact "
                "than conservation of angular momentum allows"
            )
        if not np.all(_slender(values["slenderness"])):
            warnings.append(
                f"slenderness {np.min(values['slenderness']):.3g} is below {SLENDERNESS_RANGE:g}: "
                "the models with linear motion (resonance, sequence, impulsive, linear) are outside their range"
            )
        object.__setattr__(self, "warnings", tuple(warnings))
        for warning in warnings:
            logger.warning("block: %s", warning)

    def _restitution(self, housner: np.ndarray) -> np.ndarray:
        given = self.restitution
        if isinstance(given, str):
            if given != "housner":
                raise ValueError(f"restitution: expected a number in [0, 1] or 'housner', got {given!r}")
            if np.any(housner < 0.0):
                raise ValueError(
                    "restitution: Housner's formula is negative below a slenderness of 0.707; give a number in [0, 1]"
                )
            return housner
        restitution = numbers("restitution", given, "the velocity ratio C in [0, 1] or 'housner'")
        if not np.all((restitution >= 0.0) & (restitution <= 1.0)):
            raise ValueError(f"restitution: expected the velocity ratio C in [0, 1] or 'housner', got {given!r}")
        return restitution

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


def numbers(name: str, value: Any, expected: str, lanes: bool = True) -> np.ndarray:
    """The value as a finite number, or as a one-dimensional array of them where `lanes` allows it.

    Anything else raises a ValueError with the name of the argument, what was expected and what was given.
    """
    shape = "or an array of them" if lanes else "not an array"
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected {expected}, got {value!r}") from None
    if array.ndim > int(lanes):
        raise ValueError(f"{name}: expected {expected}, {shape}, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: expected {expected}, finite, got {value!r}")
    return array


def _positive(name: str, value: Any, unit: str, lanes: bool = True) -> np.ndarray:
    array = numbers(name, value, f"a positive number in {unit}", lanes)
    if not np.all(array > 0.0):
        raise ValueError(f"{name}: expected a positive, finite number in {unit}, got {value!r}")
    return array


def _together(**values: np.ndarray) -> tuple[np.ndarray, ...]:
    try:
        return tuple(np.broadcast_arrays(*values.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        raise ValueError(f"{', '.join(values)}: expected single values or arrays of one length, got {shapes}") from None
