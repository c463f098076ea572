"""Drawings of the bodies of a results file, made from their numbers: outline, wall, ties, loads, thrusts, floor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rocking.body.outline import Outline
from rockpulse.config.block_settings import floors_from_text
from rockpulse.views.plots.selection import block_of, one_name
from rockpulse.views.plots.style import BLACK, BLUE, GREY, ORANGE, PALE, RED, SMALL, figure_of
from rockpulse.views.plots.words import plain, wrapped

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Polygon

    from rocking.body.block import Block

__all__ = ["bodies", "outlines"]

#: Bodies in a picture, and in a row of it.
MOST, IN_ROW = 8, 4


def bodies(tree: xr.DataTree, block: str | None = None) -> Figure:
    """Draw bodies from the numbers that a results file holds of them.

    Parameters
    ----------
    tree : xarray.DataTree
        Of :func:`rockpulse.assess`.
    block : str, optional
        One body; the first eight without.

    Returns
    -------
    matplotlib.figure.Figure
        Seen along the base, theta > 0 to the right; each to a scale of its own.

    Raises
    ------
    ResultsError
        For a body that is not in the file.
    """
    summary = tree["summary"].to_dataset()
    names = [one_name(summary, "block", block)] if block else [str(name) for name in summary["block"].values[:MOST]]
    drawn = []
    for name in names:
        told = str(summary["floors"].sel(block=name).values)
        drawn.append((name, block_of(summary, name), [one.period for one in floors_from_text(told)]))
    return outlines(drawn)


def outlines(drawn: Sequence[tuple[str, Block, list[float]]]) -> Figure:
    """The first eight of some bodies, by their names, blocks and the periods of the floors that they stand on [s]."""
    drawn = drawn[:MOST]
    rows = math.ceil(len(drawn) / IN_ROW)
    figure = figure_of(height=3.2 * rows)
    panels = figure.subplots(rows, IN_ROW, squeeze=False)
    for ax, (name, body, periods) in zip(panels.flat, drawn, strict=False):
        _draw(ax, body, name, periods)
    for ax in panels.flat[len(drawn) :]:
        ax.set_visible(False)
    return figure


def _draw(ax: Axes, block: Block, name: str, periods: list[float]) -> None:
    body = Outline.of(block)
    height = body.height if math.isfinite(body.height) else 2.0 * body.centre
    middle = 0.5 * (body.right - body.left)
    ax.add_patch(_polygon(body.corners))
    if math.isfinite(body.height):
        ax.plot([body.right + 0.08 * height] * 2, [0.0, height], color=GREY, lw=0.6, marker="_", ms=4)
        ax.text(body.right + 0.11 * height, 0.5 * height, f"{height:g} m", fontsize=SMALL, va="center")
        words = f"{body.width:g} m"
    else:
        words = f"b₁ {body.right:.3g} m, b₂ {body.left:.3g} m\nh {body.centre:.3g} m"
    ax.text(middle, -0.045 * height, words, fontsize=SMALL, ha="center", va="top")
    ax.plot([0.0], [body.centre], "o", ms=3, color=BLACK)
    left = -body.left - 0.12 * height
    if body.side:
        ax.add_patch(_polygon([(left, 0), (-body.left, 0), (-body.left, height), (left, height)], hatch="////"))
    ground = -0.16 * height
    ax.plot([left - 0.1 * height, body.right + 0.35 * height], [0.0, 0.0], color=BLACK, lw=1.2)
    if periods:
        words = "on a floor, T = " + ", ".join(f"{period:g}" for period in periods) + " s"
        ax.text(middle, ground, words, fontsize=SMALL, ha="center", va="top", color=BLUE)
    for tie in body.ties:
        end = tie.edge + tie.outward * 0.3 * height
        ax.plot([tie.attached, end], [tie.height] * 2, color=BLUE, lw=1.4)
        ax.plot([end], [tie.height], "s", ms=4, color=BLUE)
    for at, up in body.loads:
        _arrow(ax, (at, up + 0.14 * height), (at, up), ORANGE)
    for at, up, force in body.thrusts:
        _arrow(ax, (at - math.copysign(0.25 * height, force), up), (at, up), RED)
    ax.set_aspect("equal")
    ax.set_xlim(left - 0.25 * height, body.right + 0.45 * height)
    ax.set_ylim(-0.28 * height, 1.2 * height)
    ax.axis("off")
    ax.set_title(wrapped(plain(name), 20), fontsize=SMALL)


def _polygon(points: list[tuple[float, float]], hatch: str = "") -> Polygon:
    from matplotlib.patches import Polygon

    colour = "white" if hatch else PALE
    return Polygon(
        np.array(points), closed=True, facecolor=colour, edgecolor=GREY if hatch else BLACK, lw=0.8, hatch=hatch
    )


def _arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    ax.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2})
