"""What a terminal and a notebook show of blocks: their sizes and constants, and their outlines to one scale.

.. note:: A body is seen along its base, with theta > 0 to the right: its right-hand corner, about which it turns then,
   is b_1 = R sin(alpha) right of the centre of mass. A body whose height is not known is drawn as the triangle of its
   two corners and its centre of mass.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rocking.quantities import Floats, Integers
from rocking.svg_lines import BLUE, GREY, INK, ORANGE, RED, Picture, Shown, brief

if TYPE_CHECKING:
    from rocking.restraint import Restraints

__all__ = ["BlockPicture"]

#: Bodies of an array that are drawn, side by side.
DRAWN = 8

#: Height of the picture [px].
HEIGHT = 170.0


class BlockPicture(Shown):
    """What a block shows of itself."""

    half_width: Floats
    half_height: Floats
    radius: Floats
    radius_2: Floats
    alpha_c: Floats
    alpha_2: Floats
    p: Floats
    restitution: Floats
    side: Integers
    restraints: Restraints | np.ndarray | None

    @property
    def width(self) -> Floats:
        """Full width [m], 2b; NaN for a body given by p and alpha."""
        return 2.0 * self.half_width

    @property
    def height(self) -> Floats:
        """Full height [m], 2a; NaN for a body given by p and alpha."""
        return 2.0 * self.half_height

    def _facts(self) -> dict[str, str]:
        facts = {"of": f"{np.size(self.p)} bodies"} if np.ndim(self.p) else {}
        if not np.all(np.isnan(self.width)):
            facts["width"] = brief(self.width, "m")
        if not np.all(np.isnan(self.height)):
            facts["height"] = brief(self.height, "m")
        facts |= {"p": brief(self.p, "1/s"), "alpha_c": brief(self.alpha_c, "rad")}
        facts["rebound" if np.all(self.side) else "C"] = brief(self.restitution)
        if np.any(self.side):
            facts["wall"] = "behind it" if np.all(self.side) else "behind some"
        held = [one for one in np.ravel(np.array(self.restraints, dtype=object)) if one is not None]
        if held and np.ndim(self.p):
            return facts | {"held or pushed": f"{len(held)} of them"}
        counts = {name: len(getattr(one, name)) for one in held for name in ("ties", "loads", "thrusts")}
        return facts | {name: str(count) for name, count in counts.items() if count}

    def _picture(self) -> Picture:
        lanes = {
            name: np.ravel(getattr(self, name))[:DRAWN].tolist()
            for name in ("half_height", "radius", "radius_2", "alpha_c", "alpha_2", "side")
        }
        held = np.ravel(np.array(self.restraints, dtype=object))
        held = np.broadcast_to(held, np.size(self.p)) if held.size == 1 else held
        bodies = [_Body(*values) for values in zip(*lanes.values(), held.tolist()[:DRAWN], strict=True)]
        tallest = max(body.height for body in bodies)
        gap = 0.3 * tallest
        total = sum(body.first + body.second + gap for body in bodies) + gap
        picture = Picture((0.0, total), (-0.12 * tallest, 1.1 * tallest), height=HEIGHT, equal=True)
        picture.line([0.0, total], [0.0, 0.0], GREY)
        at = gap
        for body in bodies:
            body.draw(picture, at + body.second, gap)
            at += body.first + body.second + gap
        first = bodies[0]
        if len(bodies) == 1 and first.rectangle:
            width = first.first + first.second
            picture.words(f"{width:.4g} m", gap + 0.5 * width, -0.11 * tallest)
            picture.words(f"{first.height:.4g} m", gap + width + 0.03 * tallest, 0.5 * first.height, "start")
        return picture


class _Body:
    """One body of the picture, by the half height, R and alpha about both corners, the side of its wall, its ties."""

    def __init__(
        self,
        half_height: float,
        radius: float,
        radius_2: float,
        alpha: float,
        alpha_2: float,
        side: float,
        restraints: Restraints | None,
    ) -> None:
        self.first, self.second = radius * math.sin(alpha), radius_2 * math.sin(alpha_2)
        self.centre = radius * math.cos(alpha)
        self.rectangle = math.isfinite(half_height)
        self.height = 2.0 * half_height if self.rectangle else self.centre
        self.side, self.restraints = side, restraints

    def draw(self, picture: Picture, x: float, gap: float) -> None:
        """Draw the body with its centre of mass above x, a wall and what holds it within a gap on both sides."""
        left, right = x - self.second, x + self.first
        if self.rectangle:
            picture.polygon([left, right, right, left], [0.0, 0.0, self.height, self.height])
        else:
            picture.polygon([left, right, x], [0.0, 0.0, self.centre])
        picture.dot(x, self.centre, INK, 2.0)
        if self.side:
            wall = left if self.side > 0 else right
            picture.line([wall, wall], [0.0, 1.08 * self.height], GREY, 3.0)
        held = self.restraints
        for tie in held.ties if held else ():
            for sign in (1.0, -1.0):
                if tie.side in ("both", "positive" if sign > 0.0 else "negative"):
                    inside = right - tie.distance if sign > 0.0 else left + tie.distance
                    outside = left - 0.8 * gap if sign > 0.0 else right + 0.8 * gap
                    picture.line([inside, outside], [tie.height, tie.height], BLUE, 1.5)
                    picture.dot(outside, tie.height, BLUE)
        for load in held.loads if held else ():
            bearing = 0.5 * (left + right) if load.distance is None else right - load.distance
            picture.line([bearing, bearing], [load.height, load.height + 0.08 * self.height], ORANGE, 3.0)
        for thrust in held.thrusts if held else ():
            point, length = right - thrust.distance, math.copysign(0.6 * gap, thrust.force)
            picture.line([point - length, point], [thrust.height, thrust.height], RED, 1.5)
            picture.dot(point, thrust.height, RED)
