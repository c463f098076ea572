"""Bars in the rows of a picture of factors: up to where a body overturns, and with which probability beyond."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.views.plots.style import BLACK, BLUE, GREEN, RED, SMALL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["HALF", "bar", "none_up_to", "probability_bars", "whiskers"]

#: Half the height of a bar.
HALF = 0.33

#: Words of the bars of a probability of overturning, from its lower end on, and how they look.
_LEVELS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("P below 10 %", {"fc": "#E8F3EF", "ec": GREEN, "lw": 0.4}),
    ("10 to 50 %", {"fc": "#BBDDF3", "ec": BLUE, "lw": 0.4}),
    ("above 50 %", {"fc": RED, "ec": RED, "lw": 0.4}),
)


def probability_bars(ax: Axes, place: int, factors: Sequence[float], begin: float, end: float, at_end: bool) -> None:
    """Bars up to the factor of 10 %, from there to that of 50 %, and beyond, as far as they are within the search."""
    edges = [begin, *np.clip(factors, begin, end), end]
    for low, high, (words, style) in zip(edges[:-1], edges[1:], _LEVELS, strict=True):
        if high > low:
            bar(ax, place, low, high, words, **style)
    if np.isinf(factors[0]):
        none_up_to(ax, place, end, at_end)


def whiskers(ax: Axes, low: np.ndarray, high: np.ndarray) -> None:
    """A line in every row for the interval of a factor."""
    ax.hlines(np.arange(low.size), low, high, color=BLACK, lw=0.9, zorder=2.5)


def none_up_to(ax: Axes, place: int, end: float, at_end: bool) -> None:
    """The words in a row without a factor, at the end of the search or beside the line at 1."""
    words, (where, side) = f"  none up to {end:g}  ", (end, "right") if at_end else (1.0, "left")
    ax.text(where, place, words, fontsize=SMALL - 0.5, color=BLACK, ha=side, va="center")


def bar(ax: Axes, place: int, low: float, high: float, words: str, **style: Any) -> None:
    """A bar in a row, between two factors."""
    ax.barh(place, high - low, left=low, height=2.0 * HALF, label=words, **style)
