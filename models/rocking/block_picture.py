"""What a terminal and a notebook show of blocks: their sizes and constants, and their outlines to one scale."""

from __future__ import annotations

import math

import numpy as np

from rocking.block_lanes import BlockLanes
from rocking.outline import Outline
from rocking.svg_lines import BLUE, GREY, INK, ORANGE, RED, Picture, Shown, brief

__all__ = ["BlockPicture"]

#: Bodies of an array that are drawn, side by side.
DRAWN = 8

#: Height of the picture [px].
HEIGHT = 170.0


class BlockPicture(BlockLanes, Shown):
    """What a block shows of itself."""

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
        shown = [self.lane(lane) for lane in range(self.shape[0])[:DRAWN]] if self.shape else [self]
        bodies = [Outline.of(one) for one in shown]
        tallest = max(body.top for body in bodies)
        gap = 0.3 * tallest
        total = sum(body.width + gap for body in bodies) + gap
        picture = Picture((0.0, total), (-0.12 * tallest, 1.1 * tallest), height=HEIGHT, equal=True)
        picture.line([0.0, total], [0.0, 0.0], GREY)
        at = gap
        for body in bodies:
            _draw(picture, body, at + body.left, gap)
            at += body.width + gap
        first = bodies[0]
        if len(bodies) == 1 and math.isfinite(first.height):
            picture.words(f"{first.width:.4g} m", gap + 0.5 * first.width, -0.11 * tallest)
            picture.words(f"{first.height:.4g} m", gap + first.width + 0.03 * tallest, 0.5 * first.height, "start")
        return picture


def _draw(picture: Picture, body: Outline, x: float, gap: float) -> None:
    """Draw a body with its centre of mass above x, a wall and what holds it within a gap on both sides."""
    across, up = np.transpose(body.corners)
    picture.polygon(x + across, up)
    picture.dot(x, body.centre, INK, 2.0)
    if body.side:
        wall = x - body.left if body.side > 0 else x + body.right
        picture.line([wall, wall], [0.0, 1.08 * body.top], GREY, 3.0)
    for tie in body.ties:
        anchor = x + tie.edge + tie.outward * 0.8 * gap
        picture.line([x + tie.attached, anchor], [tie.height, tie.height], BLUE, 1.5)
        picture.dot(anchor, tie.height, BLUE)
    for at, height in body.loads:
        picture.line([x + at, x + at], [height, height + 0.08 * body.top], ORANGE, 3.0)
    for at, height, force in body.thrusts:
        picture.line([x + at - math.copysign(0.6 * gap, force), x + at], [height, height], RED, 1.5)
        picture.dot(x + at, height, RED)
