"""Restraints of a rocking body: ties, loads that rest on it, thrusts.

.. note:: A point at the height z and the distance xi inwards from the corner moves outward by x = z sin(phi) + xi (1 -
   cos(phi)) at the rotation phi; a horizontal force there has the arm dx/dphi = z cos(phi) + xi sin(phi).
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Literal, NamedTuple, Self

import numpy as np

from rocking.arguments import numbers
from rocking.pictures import short_repr

#: Displacement at which the friction of a load is fully mobilised [m]; below it the load acts as a spring.
SLIP = 1e-3


def _checked(what: str, values: Any, limits: dict[str, tuple[float, bool, str]]) -> None:
    """Raise ValueError if a field is below its minimum; `limits` is (minimum, whether it is allowed, unit) by field."""
    for name, (least, equal, unit) in limits.items():
        given = getattr(values, name)
        expected = f"a number {'of at least' if equal else 'above'} {least:g} {unit}".rstrip()
        infinite = name in ("yield_force", "ultimate") and given == math.inf
        value = math.inf if infinite else float(numbers(f"{what} {name}", given, expected, lanes=False))
        if value < least or (value == least and not equal):
            raise ValueError(f"{what} {name}: expected {expected}, got {given!r}")
        object.__setattr__(values, name, value)


@dataclass(frozen=True)
class Tie:
    """A tie or restrainer that resists the rotation of a body beyond a gap.

    Attributes
    ----------
    height, distance : float
        Height z of its attachment above the base, and distance xi of the attachment inwards from the corner of rotation
        [m]: 0 for a plate on the outer face, the width of the body for a plate on the inner face.
    stiffness : float
        K, force divided by elongation [N/m].
    gap : float
        Outward displacement of the attachment at which the tie begins to act [m].
    yield_force, ultimate : float
        Force [N] at which it yields, and elongation at which it breaks [m]; inf if there is no such limit.
    side : {"positive", "negative", "both"}
        Rotations that the tie resists: theta > 0, theta < 0, or both (one tie for each direction).

    Examples
    --------
    A steel bar of 20 mm and 10 m, 200 GPa and 235 MPa:

    >>> area = math.pi * 0.01**2
    >>> bar = Tie(height=8.0, stiffness=200e9 * area / 10.0, yield_force=235e6 * area)
    >>> round(bar.stiffness / 1e6, 2), round(bar.yield_force / 1e3, 1)                  # MN/m, kN
    (6.28, 73.8)
    """

    __repr__ = short_repr

    height: float
    stiffness: float
    gap: float = 0.0
    yield_force: float = math.inf
    ultimate: float = math.inf
    side: Literal["positive", "negative", "both"] = "positive"
    distance: float = 0.0

    def __post_init__(self) -> None:
        limits = {"height": (0.0, False, "m"), "stiffness": (0.0, False, "N/m"), "gap": (0.0, True, "m")}
        limits |= {"yield_force": (0.0, False, "N"), "ultimate": (0.0, False, "m"), "distance": (0.0, True, "m")}
        _checked("tie", self, limits)
        if self.side not in ("positive", "negative", "both"):
            raise ValueError(f"tie side: expected 'positive', 'negative' or 'both', got {self.side!r}")


@dataclass(frozen=True)
class Load:
    """A roof or a floor that rests on a body.

    Attributes
    ----------
    weight : float
        Vertical force on the body [N].
    height, distance : float, float or None
        Height z of its bearing above the base, and distance of the bearing from the right-hand corner (theta > 0),
        measured inwards [m]; None for the middle of the base.
    friction : float or None
        Friction coefficient between load and body [-]: the load stays with the building and restrains the body, in both
        directions, by at most friction times weight. None: the mass of the load moves with the body.

    Examples
    --------
    >>> Load(weight=20e3, height=3.0, friction=0.4)
    Load(weight=20000.0, height=3.0, friction=0.4)
    """

    __repr__ = short_repr

    weight: float
    height: float
    friction: float | None = None
    distance: float | None = None

    def __post_init__(self) -> None:
        limits = {"weight": (0.0, False, "N"), "height": (0.0, False, "m")}
        limits |= {} if self.friction is None else {"friction": (0.0, False, "")}
        limits |= {} if self.distance is None else {"distance": (0.0, True, "m")}
        _checked("load", self, limits)


@dataclass(frozen=True)
class Thrust:
    """A constant horizontal force on a body, such as the thrust of an arch or a rafter.

    Attributes
    ----------
    force : float
        Force [N], positive towards theta > 0.
    height, distance : float
        Height z of its point of application above the base, and its distance xi inwards from the right-hand corner [m].

    Examples
    --------
    >>> Thrust(force=5e3, height=-2.5)
    Traceback (most recent call last):
    ValueError: thrust height: expected a number above 0 m, got -2.5
    """

    __repr__ = short_repr

    force: float
    height: float
    distance: float = 0.0

    def __post_init__(self) -> None:
        _checked("thrust", self, {"height": (0.0, False, "m"), "distance": (0.0, True, "m")})
        object.__setattr__(self, "force", float(numbers("thrust force", self.force, "a force in N", lanes=False)))


# Columns of the table of elements that the kernel reads.
(
    KIND,  # FRICTION for the friction of a load, else a tie
    SIDE,  # for a tie, the sign of theta that it resists
    HEIGHT,
    NEAR,  # distance inwards from the right-hand corner; for a tie, from the corner of rotation
    FAR,  # distance inwards from the left-hand corner
    STIFFNESS,
    GAP,
    YIELD_FORCE,
    ULTIMATE,
) = range(9)
COLUMNS = 9
TIE, FRICTION = 0.0, 1.0


class TieState(IntEnum):
    """Effect of a motion on a tie, in order of severity."""

    SLACK = 0  #: the displacement of its attachment never exceeds its gap
    ELASTIC = 1  #: it acts and does not yield
    YIELDED = 2
    BROKEN = 3


class TieDemand(NamedTuple):
    """The demand of a motion on t ties, from the largest rotations of the body.

    Attributes
    ----------
    elongation : (t, ...) ndarray
        Largest elongation [m], also after a break; inf if the body overturns in the direction that the tie resists.
    force : (t, ...) ndarray
        Largest force [N]: stiffness times elongation, at most the yield force or the force at which it breaks.
    state : (t, ...) ndarray of int
        :class:`TieState`; -1 if the rotation is NaN.
    """

    elongation: np.ndarray
    force: np.ndarray
    state: np.ndarray


@dataclass(frozen=True)
class Restraints:
    """All restraints of one body; a load that moves with the body is part of the body and is not listed here.

    `hinge` is the distance of the corners of rotation from the faces of the body [m]; the distances of ties, loads and
    thrusts are measured from the faces.
    """

    ties: tuple[Tie, ...] = ()
    loads: tuple[Load, ...] = ()
    thrusts: tuple[Thrust, ...] = ()
    hinge: float = 0.0

    def __bool__(self) -> bool:
        return bool(self.ties or self.loads or self.thrusts)

    @property
    def highest(self) -> float:
        """Height of the highest restraint [m]."""
        return max(one.height for part in (self.ties, self.loads, self.thrusts) for one in part)

    def as_text(self) -> str:
        """Return the restraints as JSON text."""
        parts = {name: [vars(part) for part in getattr(self, name)] for name in ("ties", "loads", "thrusts")}
        return json.dumps(parts | ({"hinge": self.hinge} if self.hinge else {}))

    @classmethod
    def from_text(cls, text: str) -> Self | None:
        """Read restraints from the JSON of :meth:`as_text`; return None for an empty string."""
        if not text:
            return None
        parts, makers = json.loads(text), {"ties": Tie, "loads": Load, "thrusts": Thrust}
        made = {name: tuple(make(**one) for one in parts[name]) for name, make in makers.items()}
        return cls(**made, hinge=parts.get("hinge", 0.0))

    def mirrored(self, base: float) -> Self:
        """Return the restraints of the mirror image of a body with `base` [m] between the corners of rotation."""
        other = {"positive": "negative", "negative": "positive", "both": "both"}
        width = base + 2.0 * self.hinge
        return type(self)(
            tuple(Tie(**{**vars(tie), "side": other[tie.side]}) for tie in self.ties),
            tuple(Load(**{**vars(one), "distance": width - self.bearing(one, base)}) for one in self.loads),
            tuple(Thrust(-one.force, one.height, width - one.distance) for one in self.thrusts),
            self.hinge,
        )

    def bearing(self, load: Load, base: float) -> float:
        """Return the distance of the bearing of a load from the right-hand face, measured inwards [m]."""
        return 0.5 * base + self.hinge if load.distance is None else load.distance

    def tie_demand(self, rotation: np.ndarray) -> TieDemand:
        """Return the demand on the ties, in their order, from the largest rotations of the body.

        Parameters
        ----------
        rotation : (2, ...) array_like
            Largest rotations about the right-hand and the left-hand corner [rad]; inf if the body overturns.

        Examples
        --------
        >>> held = Restraints((Tie(height=8.0, stiffness=6e6, yield_force=74e3, ultimate=0.2),))
        >>> demand = held.tie_demand([0.005, 0.0])
        >>> round(float(demand.elongation[0]), 4), float(demand.force[0]), TieState(demand.state[0])
        (0.04, 74000.0, <TieState.YIELDED: 2>)
        """
        turned = np.asarray(rotation, dtype=float)
        falls = np.isposinf(turned)
        turned = np.where(falls, 0.0, turned)
        elongation = np.zeros((len(self.ties), *turned.shape[1:]))
        force, state = elongation.copy(), np.zeros(elongation.shape, dtype=np.int64)
        for place, tie in enumerate(self.ties):
            moved = tie.height * np.sin(turned) + (tie.distance - self.hinge) * (1.0 - np.cos(turned)) - tie.gap
            moved = np.where(falls, np.inf, np.maximum(moved, 0.0))
            sides = [side for side, name in enumerate(("positive", "negative")) if tie.side in (name, "both")]
            elongation[place] = most = np.max(moved[sides], axis=0)
            limit = min(tie.yield_force, tie.stiffness * tie.ultimate)
            force[place] = np.minimum(tie.stiffness * most, limit)
            acts, yields = most > 0.0, (most * tie.stiffness > tie.yield_force) & (tie.yield_force <= limit)
            state[place] = np.where(yields, TieState.YIELDED, np.where(acts, TieState.ELASTIC, TieState.SLACK))
            breaks = (most >= tie.ultimate) & math.isfinite(tie.ultimate)
            state[place] = np.where(breaks, TieState.BROKEN, state[place])
            state[place] = np.where(np.isnan(most), -1, state[place])
        return TieDemand(elongation, force, state)

    def elements(self, base: float) -> np.ndarray:
        """Return a table (e, 9) of ties and frictional loads, which kernels read; its columns are KIND to ULTIMATE."""
        rows = []
        for tie in self.ties:
            for name, side in (("positive", 1.0), ("negative", -1.0)):
                if tie.side in (name, "both"):
                    inwards = tie.distance - self.hinge
                    at = (tie.height, inwards, inwards)
                    rows.append((TIE, side, *at, tie.stiffness, tie.gap, tie.yield_force, tie.ultimate))
        for load in self.loads:
            if load.friction is not None:
                force, near = load.friction * load.weight, self.bearing(load, base) - self.hinge
                at = (load.height, near, base - near)
                rows.append((FRICTION, 0.0, *at, force / SLIP, 0.0, force, math.inf))
        return np.array(rows, dtype=float).reshape(len(rows), COLUMNS)

    def constant(self, base: float) -> np.ndarray:
        """Return coefficients (2, 2) of cos(phi) and sin(phi) in the moment of loads and thrusts by corner [N m]."""
        found = np.zeros((2, 2))
        for load in self.loads:
            near = self.bearing(load, base) - self.hinge
            found += load.weight * np.array([[near, -load.height], [base - near, -load.height]])
        for one in self.thrusts:
            near = one.distance - self.hinge
            found[0] -= one.force * np.array([one.height, near])
            found[1] += one.force * np.array([one.height, base - near])
        return found


def carried(loads: Sequence[Load]) -> tuple[list[Load], list[Load]]:
    """Split loads into those that move with the body and those that stay with the building."""
    return [one for one in loads if one.friction is None], [one for one in loads if one.friction is not None]
