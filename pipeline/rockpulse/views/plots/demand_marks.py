"""The factors that the demands of a site ask of each record, as ticks in the rows of a picture of factors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.demand import stored_demands
from rockpulse.views.plots.style import BLACK
from rockpulse.views.plots.words import plain
from rockpulse.views.shared.terminal import shortened

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["demand_ticks", "factors_to_demands", "least", "tick_notes"]

#: Longest name of a demand in the legend.
_NAME = 24


def factors_to_demands(
    summary: xr.Dataset, records: Sequence[str], blocks: Sequence[str] | str, end: float
) -> dict[str, np.ndarray]:
    """Factors that bring the record of each row to each demand, for the body of the row or of all: (rows,) by demand.

    NaN stands for a factor beyond the end of the search. Empty where the results have no demand.
    """
    bodies = [blocks] * len(records) if isinstance(blocks, str) else list(blocks)
    places = list(zip(records, bodies, strict=True))
    found = {}
    for name in stored_demands(summary):
        stored = summary["demand_factor"].sel(demand=name)
        stored = stored.isel(case=0) if "case" in stored.dims else stored
        factor = np.array([float(stored.sel(record=one, block=body)) for one, body in places])
        found[name] = np.where(factor <= end, factor, np.nan)
    return found


def least(needed: dict[str, np.ndarray], otherwise: float) -> float:
    """The smallest of the factors of :func:`factors_to_demands` and of the number `otherwise`."""
    return min([otherwise, *(float(np.nanmin(factors, initial=otherwise)) for factors in needed.values())])


def demand_ticks(ax: Axes, needed: dict[str, np.ndarray]) -> None:
    """Draw the factors of :func:`factors_to_demands` as ticks in the rows 0, 1, ..., shorter with every demand."""
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
            label=f"to the demand: {plain(shortened(name, _NAME))}",
        )


def tick_notes(needed: dict[str, np.ndarray]) -> list[str]:
    """The meaning of the ticks, for the caption."""
    if not needed:
        return []
    words = ["Tick: brings the record to the demand; with its factor right of the tick the block stands there."]
    if any(np.isnan(factors).any() for factors in needed.values()):
        words.append("No tick: the demand lies beyond the search.")
    return words
