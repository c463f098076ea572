"""A record as a strip: its accelerogram in a few kilobytes of SVG, by the extremes in each column of pixels."""

from __future__ import annotations

import numpy as np

from rocking.pictures import thinned
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.wording import Words

__all__ = ["strip"]

#: Size of the drawing in its own units, about the pixels that it is shown in.
WIDTH, HEIGHT = 700, 110

#: Room for the numbers below and beside it.
LEFT, BOTTOM, TOP = 52, 20, 8

_STRIP = """<svg viewBox="0 0 {width} {height}" class="strip" role="img" aria-label="{label}">
{shade}<path class="axis" d="M{left} {middle}H{width}"/><path class="trace" d="{path}"/>
<text x="{text}" y="{upper}" text-anchor="end">{peak}</text>
<text x="{text}" y="{lower}" text-anchor="end">−{peak}</text>
<text x="{left}" y="{foot}">0</text><text x="{width}" y="{foot}" text-anchor="end">{end}</text></svg>"""


def strip(words: Words, acceleration: np.ndarray, dt: float, intense: tuple[float, float]) -> str:
    """An element `<svg>` of the accelerogram [m/s2], the intense phase (start and end [s], or NaN) shaded.

    The vertical scale is that of the record's own PGA.
    """
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
    return _STRIP.format(
        width=WIDTH,
        height=HEIGHT,
        left=LEFT,
        text=LEFT - 6,
        shade=shade,
        middle=f"{middle:.1f}",
        upper=TOP + 9,
        lower=TOP + high,
        foot=HEIGHT - 4,
        path="M" + "L".join(points),
        peak=words.figure(peak / STANDARD_GRAVITY, "g"),
        end=words.figure(end, "s"),
        label=words("picture.label"),
    )
