"""Outline of a body and its restraints for drawings [m]: x from the centre of mass to the right, y up from the base."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np

from rocking.body.restraint import Restraints
from rocking.pictures import BLUE, GREY, INK, ORANGE, RED, Picture

#: Height of the picture of bodies [px].
HEIGHT = 170.0


class TieLine(NamedTuple):
    """The line of a tie in a drawing, from its attachment to its anchor beyond the edge of the body."""

    attached: float  # x of the attachment [m]
    edge: float  # x of the edge of the body that the tie crosses [m]
    outward: float  # -1 to the left, +1 to the right
    height: float  # y [m]


@dataclass(frozen=True)
class Outline:
    """The outline of one body for drawings; lengths in m."""

    left: float  #: horizontal distances of the corners from the centre of mass, both positive
    right: float
    centre: float  #: height of the centre of mass
    height: float = math.nan  #: height of the body; if NaN, the triangle of corners and centre of mass is drawn
    side: int = 0  #: 1 or -1 for a wall on its left or right
    ties: tuple[TieLine, ...] = ()  #: one line for each direction of rotation that a tie resists
    loads: tuple[tuple[float, float], ...] = ()  #: x and y of each bearing
    thrusts: tuple[tuple[float, float, float], ...] = ()  #: x and y of each point, and the force [N]

    @classmethod
    def of(cls, block: Any) -> Self:
        """Return the outline of a single block."""
        right = float(block.radius * math.sin(block.alpha_c) + block.hinge)
        left = float(block.radius_2 * math.sin(block.alpha_2) + block.hinge)
        given = block.restraints or Restraints()
        sides = ((1.0, right, left, "positive"), (-1.0, left, right, "negative"))
        ties = [
            TieLine(sign * (corner - tie.distance), -sign * far, -sign, tie.height)
            for tie in given.ties
            for sign, corner, far, name in sides
            if tie.side in ("both", name)
        ]
        bearings = [0.5 * (right - left) if load.distance is None else right - load.distance for load in given.loads]
        loads = zip(bearings, [load.height for load in given.loads], strict=True)
        thrusts = [(right - one.distance, one.height, one.force) for one in given.thrusts]
        centre = float(block.radius * math.cos(block.alpha_c))
        own = left, right, centre, float(block.height), int(block.side)
        return cls(*own, tuple(ties), tuple(loads), tuple(thrusts))

    @property
    def width(self) -> float:
        """Distance between the corners [m]."""
        return self.left + self.right

    @property
    def top(self) -> float:
        """Height of the drawn outline [m]."""
        return self.height if math.isfinite(self.height) else self.centre

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Corners (x, y) of the drawn polygon, the left-hand corner of the base first."""
        base = [(-self.left, 0.0), (self.right, 0.0)]
        if math.isfinite(self.height):
            return [*base, (self.right, self.height), (-self.left, self.height)]
        return [*base, (0.0, self.centre)]

    def draw(self, picture: Picture, x: float, gap: float) -> None:
        """Draw the body with its centre of mass above x, and its wall and restraints within `gap` on both sides."""
        across, up = np.transpose(self.corners)
        picture.polygon(x + across, up)
        picture.dot(x, self.centre, INK, 2.0)
        if self.side:
            wall = x - self.left if self.side > 0 else x + self.right
            picture.line([wall, wall], [0.0, 1.08 * self.top], GREY, 3.0)
        for tie in self.ties:
            anchor = x + tie.edge + tie.outward * 0.8 * gap
            picture.line([x + tie.attached, anchor], [tie.height, tie.height], BLUE, 1.5)
            picture.dot(anchor, tie.height, BLUE)
        for at, height in self.loads:
            picture.line([x + at, x + at], [height, height + 0.08 * self.top], ORANGE, 3.0)
        for at, height, force in self.thrusts:
            picture.line([x + at - math.copysign(0.6 * gap, force), x + at], [height, height], RED, 1.5)
            picture.dot(x + at, height, RED)


def side_by_side(bodies: Sequence[Outline]) -> Picture:
    """Draw bodies side by side at one scale; a single body is labelled with its sizes."""
    tallest = max(body.top for body in bodies)
    gap = 0.3 * tallest
    total = sum(body.width + gap for body in bodies) + gap
    picture = Picture((0.0, total), (-0.12 * tallest, 1.1 * tallest), height=HEIGHT, equal=True)
    picture.line([0.0, total], [0.0, 0.0], GREY)
    at = gap
    for body in bodies:
        body.draw(picture, at + body.left, gap)
        at += body.width + gap
    first = bodies[0]
    if len(bodies) == 1 and math.isfinite(first.height):
        picture.words(f"{first.width:.4g} m", gap + 0.5 * first.width, -0.11 * tallest)
        picture.words(f"{first.height:.4g} m", gap + first.width + 0.03 * tallest, 0.5 * first.height, "start")
    return picture
