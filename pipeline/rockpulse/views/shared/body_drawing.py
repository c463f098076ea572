"""A body as a small drawing in SVG, made of the numbers of a results file: sizes, wall, pedestal, ties, loads, floor.

The drawing is to scale, seen along the base, theta > 0 to the right; a body is fitted into a square.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Shape", "drawing", "shape_of"]

#: Size of the drawing, and the room around the body for its sizes and for what holds it.
SIDE, MARGIN = 150.0, 28.0

#: Where the middle of the body is drawn: left of that of the drawing, for its height is written on its right.
MIDDLE = 66.0


@dataclass(frozen=True)
class Shape:
    """The outline of a body [m]: its corners `left` and `right` of the centre of mass, its height, what acts on it.

    The height is None for a body that is known by its numbers alone: a triangle from the corners to the centre of mass
    stands for it. `pedestals` are widths and heights from the foot of the body downwards, of which the first `joined`
    rock with it as one body. `ties`, `loads` and `thrusts` have the
    keys of :class:`rocking.Tie`, :class:`rocking.Load` and :class:`rocking.Thrust`.
    """

    left: float
    right: float
    centre: float
    height: float | None
    wall: bool = False
    floor: bool = False
    pedestals: Sequence[tuple[float, float]] = ()
    joined: int = 0
    ties: Sequence[Mapping[str, Any]] = ()
    loads: Sequence[Mapping[str, Any]] = ()
    thrusts: Sequence[Mapping[str, Any]] = ()


def shape_of(summary: xr.Dataset, block: str, pedestals: Sequence[tuple[float, float]] = (), joined: int = 0) -> Shape:
    """The shape of a block of the node /summary; on pedestals, which the node does not hold."""
    own = {str(name): one.item() for name, one in summary.sel(block=block).data_vars.items() if not one.dims}
    radius, alpha, height = own["radius"], own["alpha_c"], own["height"]
    held = json.loads(own.get("restraints") or "{}")
    return Shape(
        left=own.get("radius_2", radius) * math.sin(own.get("alpha_2", alpha)),
        right=radius * math.sin(alpha),
        centre=radius * math.cos(alpha),
        height=height if math.isfinite(height) else None,
        wall=bool(own.get("one_sided", 0)),
        floor=bool(own.get("floors", "")),
        pedestals=tuple(pedestals),
        joined=joined,
        **{name: held.get(name, ()) for name in ("ties", "loads", "thrusts")},
    )


def drawing(shape: Shape, label: str, length: Callable[[float], str]) -> str:
    """An element `<svg>` of a shape, with a label for those who do not see it; `length` words a length [m].

    The texts are without markup.
    """
    below = sum(height for _, height in shape.pedestals)
    top = shape.height or shape.centre
    width = max(shape.left + shape.right, *(one for one, _ in shape.pedestals), 0.25 * (top + below))
    scale = (SIDE - 2 * MARGIN) / max(width, top + below)
    middle = 0.5 * (shape.right - shape.left)

    def x(value: float) -> float:
        return round(MIDDLE + scale * (value - middle), 1)

    def y(value: float) -> float:
        return round(SIDE - MARGIN - scale * (value + below), 1)

    def box(low: float, high: float, foot: float, head: float, kind: str) -> str:
        return (
            f'<rect class="{kind}" x="{x(low)}" y="{y(head)}" width="{round(x(high) - x(low), 1)}" '
            f'height="{round(y(foot) - y(head), 1)}"/>'
        )

    parts, foot = [], 0.0
    for place, (wide, high) in enumerate(shape.pedestals):
        kind = "body" if place < shape.joined else "pedestal"
        parts.append(box(middle - wide / 2, middle + wide / 2, foot - high, foot, kind))
        foot -= high
    if shape.wall:
        wall = 8.0 / scale
        parts.append(box(-shape.left - wall, -shape.left, -below, top, "wall"))
    corners = f"{x(-shape.left)} {y(0)}L{x(shape.right)} {y(0)}"
    if shape.height is None:
        parts.append(f'<path class="body" d="M{corners}L{x(0)} {y(shape.centre)}Z"/>')
    else:
        parts.append(box(-shape.left, shape.right, 0.0, top, "body"))
    parts.append(f'<circle class="centre" cx="{x(0)}" cy="{y(shape.centre)}" r="2.5"/>')
    ground = y(-below)
    parts.append(f'<path class="{"floor" if shape.floor else "ground"}" d="M12 {ground}H{SIDE - 12:.0f}"/>')
    parts += [_tie(shape, one, x, y) for one in shape.ties]
    for one in shape.loads:
        behind = one.get("distance")
        at = x(shape.right - (0.5 * (shape.left + shape.right) if behind is None else behind))
        parts.append(_arrow(at, y(one["height"]) - 16, at, y(one["height"]), "load"))
    for one in shape.thrusts:
        end, level = x(shape.right - one.get("distance", 0.0)), y(one["height"])
        parts.append(_arrow(end - math.copysign(18, one["force"]), level, end, level, "thrust"))
    under = y(top) - 6 if shape.pedestals else ground + 15
    parts.append(f'<text x="{x(middle)}" y="{under}" text-anchor="middle">{length(shape.left + shape.right)}</text>')
    side = max([x(shape.right), *(x(middle + one / 2) for one, _ in shape.pedestals)]) + 5
    told = length(top) if shape.height else f"↕ {length(shape.centre)}"
    parts.append(f'<text x="{side}" y="{y(0.5 * top)}">{told}</text>')
    lines = "\n".join(parts)
    size = f"0 0 {SIDE:.0f} {SIDE:.0f}"
    return f'<svg viewBox="{size}" class="drawing" role="img" aria-label="{label}">\n{lines}\n</svg>'


def _tie(shape: Shape, tie: Mapping[str, Any], x: Any, y: Any) -> str:
    """The line of a tie from its attachment through the body to the other side, where it is anchored."""
    level, drawn = y(tie["height"]), []
    for side in (1.0, -1.0):
        if tie.get("side", "positive") in ("both", "positive" if side > 0 else "negative"):
            corner, other = (shape.right, -shape.left) if side > 0 else (-shape.left, shape.right)
            start, end = x(corner - side * tie.get("distance", 0.0)), x(other) - side * 20
            drawn.append(f'<path class="tie" d="M{start} {level}H{end}m0 -4v8M{start} {level - 4}v8"/>')
    return "".join(drawn)


def _arrow(x0: float, y0: float, x1: float, y1: float, kind: str) -> str:
    """An arrow whose head is at the second point."""
    length = math.hypot(x1 - x0, y1 - y0)
    along, across = ((x1 - x0) / length * 5, (y1 - y0) / length * 5), ((y0 - y1) / length * 3, (x1 - x0) / length * 3)
    ends = [(x1 - along[0] + sign * across[0], y1 - along[1] + sign * across[1]) for sign in (1, -1)]
    head = "L".join(f"{a:.1f} {b:.1f}" for a, b in (ends[0], (x1, y1), ends[1]))
    return f'<path class="{kind}" d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}M{head}"/>'
