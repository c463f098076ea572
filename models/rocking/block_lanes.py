"""Lanes of blocks: some of an array of them, several stacked, seen from behind, with other angles.

.. note:: The lane fields of a block are scalars for one body and arrays (m,) for several. What acts on a body beside
   its weight is an object, and an array of objects for several bodies one of which has it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from rocking.quantities import ArrayLike, Booleans, Floats, Integers

if TYPE_CHECKING:
    from rocking.restraint import Restraints

__all__ = ["FEATURES", "LANE_FIELDS", "SLENDERNESS_RANGE", "BlockLanes"]

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
    "alpha_2",
    "p_2",
    "radius_2",
    "restitution_2",
    "side",
    "mass",
)


class BlockLanes:
    """What a block can do with its lanes."""

    gravity: float
    warnings: tuple[str, ...]
    half_width: Floats
    half_height: Floats
    restitution: Floats
    alpha_c: Floats
    p: Floats
    radius: Floats
    slenderness: Floats
    critical_impulse: Floats
    alpha_2: Floats
    p_2: Floats
    radius_2: Floats
    restitution_2: Floats
    side: Integers
    mass: Floats
    restraints: Restraints | np.ndarray | None

    @property
    def width(self) -> Floats:
        """Full width [m], 2b; NaN for a body given by p and alpha."""
        return 2.0 * self.half_width

    @property
    def height(self) -> Floats:
        """Full height [m], 2a; NaN for a body given by p and alpha."""
        return 2.0 * self.half_height

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the lanes: () for one block, (m,) for several."""
        return np.shape(self.p)

    def lane(self, index: int) -> Self:
        """One lane of an array of blocks as a block of its own."""
        return self._with(lambda values: values[index] if values.dtype == object else values[index].item())

    def lanes(self, count: int) -> Self:
        """A block of shape (count,): a single block repeated, or itself where it has that shape already."""
        return self._with(lambda values: np.broadcast_to(values, (count,)))

    def chosen(self, places: Any) -> Self:
        """Some lanes of an array of blocks: by their places, a mask or a slice."""
        return self._with(lambda values: np.ascontiguousarray(values[places]))

    @classmethod
    def stack(cls, blocks: Sequence[Self]) -> Self:
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
        held = any(block.restraints is not None for block in blocks)
        every = [np.broadcast_to(np.array(block.restraints, dtype=object), np.shape(block.p) or 1) for block in blocks]
        object.__setattr__(stacked, "restraints", np.concatenate(every) if held else None)
        return stacked

    @classmethod
    def restored(cls, gravity: float, restraints: Any = None, **values: float) -> Self:
        """One body from its lane fields, but for those that follow from the others."""
        block = object.__new__(cls)
        alpha, p = values["alpha_c"], values["p"]
        follow = {
            "slenderness": 1.0 / np.tan(alpha),
            "critical_impulse": gravity * alpha / (p * np.cos(alpha)),
            "gravity": gravity,
            "restraints": restraints,
            "warnings": (),
        }
        for name, value in (values | follow).items():
            object.__setattr__(block, name, value)
        return block

    def ratio(self, rotation: np.ndarray) -> np.ndarray:
        """theta/alpha [-] of rotations [rad] of one body, alpha that of the corner that it turns about."""
        other = (rotation < 0.0) & (self.side == 0)
        return np.asarray(rotation / np.where(other, self.alpha_2, self.alpha_c))

    def mirrored(self) -> Self:
        """The same body seen from behind: its corners change places, and a wall stands on its other side."""
        other = self._with(lambda values: values)
        pairs = {"alpha_c": "alpha_2", "p": "p_2", "radius": "radius_2", "restitution": "restitution_2"}
        for name, opposite in (pairs | {opposite: name for name, opposite in pairs.items()}).items():
            object.__setattr__(other, name, getattr(self, opposite))
        object.__setattr__(other, "side", -self.side)
        if self.restraints is not None:
            base = np.asarray(self.radius * np.sin(self.alpha_c) + self.radius_2 * np.sin(self.alpha_2))
            held = np.array(self.restraints, dtype=object)
            seen = np.empty(held.shape, dtype=object)
            for place, own in np.ndenumerate(held):
                seen[place] = None if own is None else own.mirrored(float(base[place]))
            object.__setattr__(other, "restraints", seen if self.shape else seen[()])
        return other

    def varied(self, loss: ArrayLike, restitution: ArrayLike) -> Self:
        """(m,) bodies with angles exp(-loss) times theirs, at their R and p, and other restitutions or rebounds.

        `restitution` is that of the right-hand corner; that of the other one has the same share of its own.
        """
        share = np.divide(restitution, self.restitution, out=np.ones(self.shape), where=self.restitution > 0.0)
        ratio = np.broadcast_to(np.asarray(restitution, dtype=float), self.shape)
        alike = self.restitution_2 == self.restitution
        new = {
            "restitution": ratio,
            "restitution_2": np.where(alike, ratio, np.minimum(self.restitution_2 * share, 1.0)),
        }
        new |= {name: getattr(self, name) * np.exp(-np.asarray(loss)) for name in ("alpha_c", "alpha_2")}
        new["slenderness"] = 1.0 / np.tan(new["alpha_c"])
        new["critical_impulse"] = self.gravity * new["alpha_c"] / (self.p * np.cos(new["alpha_c"]))
        other = self._with(lambda values: values)
        for name, values in new.items():
            object.__setattr__(other, name, np.broadcast_to(values, self.shape))
        return other

    def _with(self, choose: Callable[[np.ndarray], Any]) -> Self:
        other = object.__new__(type(self))
        object.__setattr__(other, "gravity", self.gravity)
        object.__setattr__(other, "warnings", self.warnings)
        values = {name: choose(np.asarray(getattr(self, name))) for name in LANE_FIELDS}
        held = None if self.restraints is None else choose(np.array(self.restraints, dtype=object))
        values["restraints"] = None if isinstance(held, np.ndarray) and not held.any() else held
        for name, value in values.items():
            object.__setattr__(other, name, value.item() if np.shape(value) == () and hasattr(value, "item") else value)
        return other

    @property
    def symmetric(self) -> Booleans:
        """True where both corners are alike, whatever holds the body."""
        return (self.alpha_c == self.alpha_2) & (self.p == self.p_2) & (self.restitution == self.restitution_2)

    @property
    def restrained(self) -> np.ndarray:
        """True where something acts on the body beside its weight."""
        if self.restraints is None:
            return np.zeros(self.shape, dtype=bool)
        held = np.ravel(np.array(self.restraints, dtype=object))
        return np.array([own is not None for own in held]).reshape(self.shape)

    @property
    def free(self) -> Booleans:
        """True for a free-standing symmetric body, which every model knows."""
        return self.known_to(())

    def known_to(self, features: Collection[str]) -> Booleans:
        """True where a body has none of :data:`FEATURES` but those that a model knows."""
        known = np.ones(self.shape, dtype=bool)
        for name, has in FEATURES.items():
            if name not in features:
                known = known & ~np.asarray(has(self))
        return known

    @property
    def weaker(self) -> Self:
        """The bodies with both corners as the one of the smaller angle, of those that they turn about."""
        second = (np.asarray(self.side) < 0) | ((np.asarray(self.side) == 0) & (self.alpha_2 < self.alpha_c))
        if not np.any(second):
            return self
        other, mirror = self._with(lambda values: values), self.mirrored()
        for name in ("alpha_c", "p", "radius", "restitution"):
            weaker = np.where(second, getattr(mirror, name), getattr(self, name))
            object.__setattr__(other, name, weaker[()])
        object.__setattr__(other, "slenderness", 1.0 / np.tan(other.alpha_c))
        object.__setattr__(other, "critical_impulse", self.gravity * other.alpha_c / (other.p * np.cos(other.alpha_c)))
        return other

    @property
    def slender(self) -> Booleans:
        """True where the slenderness is within the range of the models with linear natural motion."""
        # A block of exactly 3 comes back from its angle as 3 less a bit.
        return self.slenderness >= SLENDERNESS_RANGE * (1.0 - 1e-12)


#: What a body may have beside being free-standing and symmetric, and where it has it: a model names what it knows.
FEATURES: dict[str, Callable[[BlockLanes], Booleans]] = {
    "corners": lambda block: ~np.asarray(block.symmetric),
    "wall": lambda block: np.asarray(block.side) != 0,
    "restraints": lambda block: block.restrained,
}
