"""Draws a body with its restraints, and a small accelerogram, as SVG without matplotlib."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rocking.body.outline import Outline, TieLine
from rocking.pictures import thinned
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import say

#: Size of the drawing, and margins around the body for its dimensions and restraints.
SIDE, MARGIN = 150.0, 28.0
#: Horizontal position of the middle of the body, left of centre as the height is written on the right.
MIDDLE = 66.0
#: Width and height of a strip in its own units, which are about a pixel.
WIDTH, HEIGHT = 700, 110
#: Margins of a strip for the numbers beside and below it.
LEFT, BOTTOM, TOP = 52, 20, 8


@dataclass(frozen=True)
class Support:
    """The floor and the pedestals [m], from the top, below a body; the first `joined` pedestals rock with the body."""

    floor: bool = False
    pedestals: Sequence[tuple[float, float]] = ()
    joined: int = 0


def body_drawing(body: Outline, support: Support, label: str, length: Callable[[float], str]) -> str:
    """Return an `<svg>` element of a body with its restraints and sizes; `length` converts a length [m] to text."""
    below, top = sum(height for _, height in support.pedestals), body.top
    width = max(body.width, *(one for one, _ in support.pedestals), 0.25 * (top + below))
    scale = (SIDE - 2 * MARGIN) / max(width, top + below)
    middle = 0.5 * (body.right - body.left)

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
    for place, (wide, high) in enumerate(support.pedestals):
        kind = "body" if place < support.joined else "pedestal"
        parts.append(box(middle - wide / 2, middle + wide / 2, foot - high, foot, kind))
        foot -= high
    if body.side:
        wall, face = 8.0 / scale, -body.left if body.side > 0 else body.right
        parts.append(box(min(face, face - body.side * wall), max(face, face - body.side * wall), -below, top, "wall"))
    outline = "L".join(f"{x(across)} {y(up)}" for across, up in body.corners)
    parts.append(f'<path class="body" d="M{outline}Z"/>')
    parts.append(f'<circle class="centre" cx="{x(0)}" cy="{y(body.centre)}" r="2.5"/>')
    ground = y(-below)
    parts.append(f'<path class="{"floor" if support.floor else "ground"}" d="M12 {ground}H{SIDE - 12:.0f}"/>')
    parts += [_tie(one, x, y) for one in body.ties]
    parts += [_arrow(x(at), y(height) - 16, x(at), y(height), "load") for at, height in body.loads]
    for at, height, force in body.thrusts:
        parts.append(_arrow(x(at) - math.copysign(18, force), y(height), x(at), y(height), "thrust"))
    under = y(top) - 6 if support.pedestals else ground + 15
    parts.append(f'<text x="{x(middle)}" y="{under}" text-anchor="middle">{length(body.width)}</text>')
    side = max([x(body.right), *(x(middle + one / 2) for one, _ in support.pedestals)]) + 5
    height_label = length(top) if math.isfinite(body.height) else f"↕ {length(body.centre)}"
    parts.append(f'<text x="{side}" y="{y(0.5 * top)}">{height_label}</text>')
    lines = "\n".join(parts)
    size = f"0 0 {SIDE:.0f} {SIDE:.0f}"
    return f'<svg viewBox="{size}" class="drawing" role="img" aria-label="{label}">\n{lines}\n</svg>'


def _tie(tie: TieLine, x: Any, y: Any) -> str:
    start, end, level = x(tie.attached), x(tie.edge) + tie.outward * 20, y(tie.height)
    return f'<path class="tie" d="M{start} {level}H{end}m0 -4v8M{start} {level - 4}v8"/>'


def _arrow(x0: float, y0: float, x1: float, y1: float, kind: str) -> str:
    length = math.hypot(x1 - x0, y1 - y0)
    along, across = ((x1 - x0) / length * 5, (y1 - y0) / length * 5), ((y0 - y1) / length * 3, (x1 - x0) / length * 3)
    ends = [(x1 - along[0] + sign * across[0], y1 - along[1] + sign * across[1]) for sign in (1, -1)]
    head = "L".join(f"{a:.1f} {b:.1f}" for a, b in (ends[0], (x1, y1), ends[1]))
    return f'<path class="{kind}" d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}M{head}"/>'


def strip(acceleration: np.ndarray, dt: float, intense: tuple[float, float]) -> str:
    """Return an `<svg>` element of an accelerogram [m/s2]; the intense phase, from start to end [s], is shaded."""
    peak = float(np.max(np.abs(acceleration)))
    end = dt * (acceleration.size - 1)
    span, high = WIDTH - LEFT, HEIGHT - BOTTOM - TOP
    middle = TOP + high / 2
    x, y = thinned(np.linspace(0.0, span, acceleration.size), acceleration, span)
    down = middle - y / (peak or 1.0) * high / 2
    points = [f"{LEFT + place:.0f} {level:.1f}" for place, level in zip(x, down, strict=True)]
    shade = ""
    if np.all(np.isfinite(intense)):
        start, stop = (LEFT + span * min(max(instant / end, 0.0), 1.0) for instant in intense)
        shade = f'<rect class="intense" x="{start:.1f}" y="{TOP}" width="{stop - start:.1f}" height="{high}"/>\n'
    pga, length = three_digits(peak / STANDARD_GRAVITY, "g"), three_digits(end, "s")
    return f"""<svg viewBox="0 0 {WIDTH} {HEIGHT}" class="strip" role="img" aria-label="{say("picture.label")}">
{shade}<path class="axis" d="M{LEFT} {middle:.1f}H{WIDTH}"/><path class="trace" d="M{"L".join(points)}"/>
<text x="{LEFT - 6}" y="{TOP + 9}" text-anchor="end">{pga}</text>
<text x="{LEFT - 6}" y="{TOP + high}" text-anchor="end">−{pga}</text>
<text x="{LEFT}" y="{HEIGHT - 4}">0</text><text x="{WIDTH}" y="{HEIGHT - 4}" text-anchor="end">{length}</text></svg>"""
