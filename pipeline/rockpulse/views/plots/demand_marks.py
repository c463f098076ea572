"""The factors that the demands of a site ask of each record, as ticks in the rows of a picture of factors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockpulse.views.plots.style import BLACK
from rockpulse.views.plots.words import plain
from rockpulse.views.shared.terminal import shortened

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["demand_ticks", "demands_over_pga", "least", "tick_notes"]

#: Longest name of a demand in the legend.
_NAME = 24


def demands_over_pga(summary: xr.Dataset, pga: np.ndarray, end: float) -> dict[str, np.ndarray]:
    """Factors that bring the records of the rows, with these PGAs (rows,) [m/s2], to each demand: (rows,) by demand.

    NaN stands for a factor beyond the end of the search. Empty where the results have no demand.
    """
    if "demand_acceleration" not in summary:
        return {}
    every = zip(summary["demand"].values, summary["demand_acceleration"].values, strict=True)
    return {str(name): np.where(demand <= end * pga, demand / pga, np.nan) for name, demand in every}


def least(needed: dict[str, np.ndarray], otherwise: float) -> float:
    """The smallest of the factors of :func:`demands_over_pga` and of the number `otherwise`."""
    return min([otherwise, *(float(np.nanmin(factors, initial=otherwise)) for factors in needed.values())])


def demand_ticks(ax: Axes, needed: dict[str, np.ndarray]) -> None:
    """Draw the factors of :func:`demands_over_pga` as ticks in the rows 0, 1, ..., shorter with every demand."""
    for place, (name, factors) in enumerate(needed.items()):
        ax.plot(
            factors,
            np.arange(factors.size),
            ls="none",
            marker="|",
            ms=9 - 2 * min(place, 2),
            mew=1.6,
            color=BLACK,
            zorder=4,
            label=f"demand over PGA: {plain(shortened(name, _NAME))}",
        )


def tick_notes(needed: dict[str, np.ndarray]) -> list[str]:
    """The meaning of the ticks, for the caption."""
    if not needed:
        return []
    words = ["Tick: demand over PGA; with its factor right of the tick the block stands at the demand."]
    if any(np.isnan(factors).any() for factors in needed.values()):
        words.append("No tick: the demand lies beyond the search.")
    return words
