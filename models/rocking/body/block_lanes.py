"""The fields of one block or an array of (m,) blocks, and the methods that select, join or change blocks."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from rocking.arguments import ArrayLike, Booleans, Floats, Integers
from rocking.body.outline import Outline, side_by_side
from rocking.body.restraint import Restraints
from rocking.lanes import LaneValues, lane_field
from rocking.pictures import Picture, Shown, brief

STANDARD_GRAVITY = 9.80665
#: Smallest slenderness for which the linear, resonance and sequence models are valid (Casapulla & Maione 2017, sec. 3).
SLENDERNESS_RANGE = 3.0
#: Largest number of bodies of an array that are drawn side by side.
DRAWN = 8
#: The fields that exist for both corners, by the names for the right-hand corner.
OPPOSITE = {"alpha_c": "alpha_2", "p": "p_2", "radius": "radius_2", "restitution": "restitution_2"}


@dataclass(frozen=True, eq=False, init=False, repr=False)
class BlockLanes(LaneValues, Shown):
    """The fields of :class:`rocking.Block`, and the methods that select, join or change blocks of an array."""

    half_width: Floats = lane_field()
    half_height: Floats = lane_field()
    restitution: Floats = lane_field()
    gravity: float = STANDARD_GRAVITY
    alpha_c: Floats = lane_field(init=False)
    p: Floats = lane_field(init=False)
    radius: Floats = lane_field(init=False)
    slenderness: Floats = lane_field(init=False)
    critical_impulse: Floats = lane_field(init=False)
    alpha_2: Floats = lane_field(init=False)
    p_2: Floats = lane_field(init=False)
    radius_2: Floats = lane_field(init=False)
    restitution_2: Floats = lane_field(init=False)
    side: Integers = lane_field(0, init=False)
    mass: Floats = lane_field(init=False)
    hinge: Floats = lane_field(0.0, init=False)
    restraints: Restraints | np.ndarray | None = lane_field(None, init=False)
    warnings: tuple[str, ...] = field(init=False)

    @property
    def width(self) -> Floats:
        """Full width 2b [m]; NaN for a body given by p and alpha."""
        return 2.0 * self.half_width

    @property
    def height(self) -> Floats:
        """Full height 2a [m]; NaN for a body given by p and alpha."""
        return 2.0 * self.half_height

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the fields: () for one block, (m,) for an array of m blocks."""
        return np.shape(self.p)

    def lane(self, index: int) -> Self:
        """Return one block of an array of blocks."""
        return self._each(lambda values: values[index])

    def lanes(self, count: int | None = None) -> Self:
        """Return an array of blocks; a single block is repeated `count` times, by default once."""
        if count is None:
            return self if self.shape else self.lanes(1)
        return self._each(lambda values: np.broadcast_to(values, (count,)))

    def take(self, places: Any) -> Self:
        """Select blocks of an array by indices, a mask or a slice."""
        some = super().take(places)
        return some if some.restraints is None or np.asarray(some.restraints).any() else some.changed(restraints=None)

    @classmethod
    def stack(cls, blocks: Sequence[Self]) -> Self:
        """Join several blocks with the same gravity into one array of blocks, in the given order."""
        gravities = {block.gravity for block in blocks}
        if len(gravities) != 1:
            raise ValueError(f"blocks: expected one gravity for all blocks of a stack, found {sorted(gravities)}")
        parts = [block.lanes() for block in blocks]
        if any(block.restraints is not None for block in blocks):
            parts = [
                part if part.restraints is not None else part.changed(restraints=np.full(part.shape, None))
                for part in parts
            ]
        edges = np.cumsum([part.shape[0] for part in parts])
        stacked = cls.join(parts, np.split(np.arange(edges[-1]), edges[:-1]), int(edges[-1]))
        return stacked.changed(warnings=tuple(dict.fromkeys(word for block in blocks for word in block.warnings)))

    @classmethod
    def restored(cls, gravity: float, restraints: Any = None, **values: float) -> Self:
        """Rebuild one body from its stored fields, and compute the fields that follow from them."""
        block = object.__new__(cls)
        vars(block).update(values | {"gravity": gravity, "restraints": restraints, "warnings": ()})
        return block._with_angle()

    def ratio(self, rotation: np.ndarray) -> np.ndarray:
        """Return rotations theta [rad] of one body divided by alpha of the corner about which it turns [-]."""
        other = (rotation < 0.0) & (self.side == 0)
        return np.asarray(rotation / np.where(other, self.alpha_2, self.alpha_c))

    def mirrored(self) -> Self:
        """Return the mirror image of the body: its corners are exchanged, and its wall is on the other side."""
        pairs = OPPOSITE | {other: name for name, other in OPPOSITE.items()}
        other = self.changed(side=-self.side, **{name: getattr(self, opposite) for name, opposite in pairs.items()})
        if self.restraints is None:
            return other
        base = np.asarray(self.radius * np.sin(self.alpha_c) + self.radius_2 * np.sin(self.alpha_2))
        restraints = np.array(self.restraints, dtype=object)
        mirrored = np.empty(restraints.shape, dtype=object)
        for place, own in np.ndenumerate(restraints):
            mirrored[place] = None if own is None else own.mirrored(float(base[place]))
        return other.changed(restraints=mirrored if self.shape else mirrored[()])

    def varied(self, loss: ArrayLike, restitution: ArrayLike) -> Self:
        """Return a copy with angles times exp(-loss) and C = `restitution` (right corner; the left C in proportion)."""
        share = np.divide(restitution, self.restitution, out=np.ones(self.shape), where=self.restitution > 0.0)
        ratio = np.broadcast_to(np.asarray(restitution, dtype=float), self.shape)
        alike = self.restitution_2 == self.restitution
        kept = np.exp(-np.asarray(loss))
        new = {
            "restitution": ratio,
            "restitution_2": np.where(alike, ratio, np.minimum(self.restitution_2 * share, 1.0)),
            "alpha_c": self.alpha_c * kept,
            "alpha_2": self.alpha_2 * kept,
        }
        other = self.changed(**{name: np.broadcast_to(values, self.shape) for name, values in new.items()})
        return other._with_angle()

    @property
    def weaker(self) -> Self:
        """Return a copy whose right-hand corner is the one with the smaller angle, or the only one beside a wall."""
        second = (np.asarray(self.side) < 0) | ((np.asarray(self.side) == 0) & (self.alpha_2 < self.alpha_c))
        if not np.any(second):
            return self
        pairs = {name: (getattr(self, other), getattr(self, name)) for name, other in OPPOSITE.items()}
        return self.changed(**{name: np.where(second, *pair)[()] for name, pair in pairs.items()})._with_angle()

    @property
    def symmetric(self) -> Booleans:
        """True for bodies with equal corners, with or without restraints."""
        return (self.alpha_c == self.alpha_2) & (self.p == self.p_2) & (self.restitution == self.restitution_2)

    @property
    def restrained(self) -> np.ndarray:
        """True for bodies with restraints: ties, loads or thrusts."""
        if self.restraints is None:
            return np.zeros(self.shape, dtype=bool)
        return np.array([own is not None for own in self.acting()]).reshape(self.shape)

    def acting(self) -> list[Restraints | None]:
        """Return the restraints of each body, None for a body without restraints."""
        return list(np.ravel(np.array(self.restraints, dtype=object)))

    @property
    def free(self) -> Booleans:
        """True for free-standing symmetric bodies, to which every model applies."""
        return self.known_to(())

    def known_to(self, features: Collection[str]) -> Booleans:
        """Return True for each body whose :data:`FEATURES` are all among the `features` that a model can treat."""
        known = np.ones(self.shape, dtype=bool)
        for name, has in FEATURES.items():
            if name not in features:
                known = known & ~np.asarray(has(self))
        return known

    @property
    def slender(self) -> Booleans:
        """True for bodies whose slenderness is in the range of the models that use the linear equation."""
        # A slenderness of exactly 3 is rounded to just below 3 when it is computed from the angle.
        return self.slenderness >= SLENDERNESS_RANGE * (1.0 - 1e-12)

    def _each(self, choose: Callable[[np.ndarray], Any]) -> Self:
        arrays = {name: np.asarray(value) for name in self.lane_fields() if (value := getattr(self, name)) is not None}
        chosen = {name: choose(values) for name, values in arrays.items()}
        numbers = {name: one.item() for name, one in chosen.items() if isinstance(one, np.generic)}
        return self.changed(**chosen | numbers)

    def _with_angle(self) -> Self:
        """Return a copy with the slenderness and the critical impulse computed from the right-hand corner."""
        impulse = self.gravity * self.alpha_c / (self.p * np.cos(self.alpha_c))
        return self.changed(slenderness=1.0 / np.tan(self.alpha_c), critical_impulse=impulse)

    def _facts(self) -> dict[str, str]:
        facts = {"of": f"{np.size(self.p)} bodies"} if self.shape else {}
        sizes = {"width": self.width, "height": self.height}
        facts |= {name: brief(size, "m") for name, size in sizes.items() if not np.all(np.isnan(size))}
        facts |= {"p": brief(self.p, "1/s"), "alpha_c": brief(self.alpha_c, "rad")}
        facts |= {"crushed edge": brief(self.hinge, "m")} if np.any(self.hinge) else {}
        facts["rebound" if np.all(self.side) else "C"] = brief(self.restitution)
        if np.any(self.side):
            facts["wall"] = "behind it" if np.all(self.side) else "behind some"
        restraints = [one for one in self.acting() if one is not None]
        if restraints and self.shape:
            return facts | {"restrained": f"{len(restraints)} of them"}
        counts = {name: len(getattr(one, name)) for one in restraints for name in ("ties", "loads", "thrusts")}
        return facts | {name: str(count) for name, count in counts.items() if count}

    def _picture(self) -> Picture:
        shown = [self.lane(lane) for lane in range(self.shape[0])[:DRAWN]] if self.shape else [self]
        return side_by_side([Outline.of(one) for one in shown])


#: Features that a free-standing symmetric body does not have, with a test for each feature.
FEATURES: dict[str, Callable[[BlockLanes], Booleans]] = {
    "corners": lambda block: ~np.asarray(block.symmetric),
    "wall": lambda block: np.asarray(block.side) != 0,
    "restraints": lambda block: block.restrained,
}
