"""What of the changes between two assessments decides: answers on the other side of a limit, and the margin of a body.

The verdict is that of the fullest model; its changes come first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome
from rockpulse.views.diff.row_matching import Matched
from rockpulse.views.text.capacity import factor_cell, search_limit
from rockpulse.views.text.overview import fullest_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Changes", "Flip", "body_changes", "leading_model"]

#: Variables that the margin of a body is told by.
MARGIN = ("outcome", "safety_factor", "factor_resolved", "safe_up_to", "capacity_ratio")


@dataclass(frozen=True)
class Flip:
    """A verdict that changed, or a ratio that crossed one.

    Attributes
    ----------
    place : tuple of str
        Record, block and model, and demand where there is one.
    before, after : str
        Outcomes, or ratios.
    """

    place: tuple[str, ...]
    before: str
    after: str


@dataclass
class Changes:
    """Answers of one variable that changed sides.

    Attributes
    ----------
    listed : int
        Most that are named.
    compared, count : int
        Answers of all models, and how many of them changed sides.
    compared_by_model, count_by_model : int
        The same of the fullest model.
    """

    listed: int = 0
    compared: int = 0
    count: int = 0
    compared_by_model: int = 0
    count_by_model: int = 0
    _first: list[Flip] = field(default_factory=list)
    _others: list[Flip] = field(default_factory=list)

    @property
    def named(self) -> list[Flip]:
        """The first of them, those of the fullest model before all others."""
        return [*self._first, *self._others][: self.listed]

    def add(self, places: np.ndarray, leading: np.ndarray, named: Callable[[int], Flip]) -> None:
        """Count and name further ones.

        Parameters
        ----------
        places : (n,) ndarray of int
            Where they are.
        leading : (n,) ndarray of bool
            Which of them are of the fullest model.
        named : callable
            What a place holds.
        """
        self.count += places.size
        self.count_by_model += int(leading.sum())
        for told, some in ((self._first, places[leading]), (self._others, places[~leading])):
            told.extend(named(int(at)) for at in some[: self.listed - len(told)])


def leading_model(one: xr.Dataset, other: xr.Dataset) -> str:
    """The fullest of the models that two summaries have; empty without one.

    Parameters
    ----------
    one, other : xarray.Dataset
        The node /summary of both files.
    """
    if "model" not in one.coords or "model" not in other.coords:
        return ""
    common = one.sel(model=np.isin(one["model"].values, other["model"].values))
    return fullest_model(common) if common.sizes["model"] else ""


def body_changes(
    one: xr.Dataset, other: xr.Dataset, named: Mapping[str, Matched], model: str, ignore: Sequence[str] = ()
) -> list[str]:
    """A line for every body whose margin changed: smallest safety factor, smallest capacity over demand, overturnings.

    Only records that both files have are counted, and where these are not all of both the line says so. A body with
    several restitutions counts with the worst of them.

    Parameters
    ----------
    one, other : xarray.Dataset
        The node /summary of both files.
    named : mapping of str to Matched
        The rows of both along record and block.
    model : str
        Whose answers are told.
    ignore : sequence of str
        Variables that are left out.
    """
    records, blocks = named["record"], named["block"]
    parts = []
    for dataset, other_one, side in ((one, other, "first"), (other, one, "second")):
        names = [
            name
            for name in MARGIN
            if name in dataset and name in other_one and not {name, f"/summary/{name}"} & set(ignore)
        ]
        whole = dataset[[*names, "pga", *(["demand_acceleration"] if "capacity_ratio" in names else [])]]
        part = whole.isel(model=whole["model"].values.tolist().index(model)).load()
        parts.append(part.isel(record=getattr(records, side), block=getattr(blocks, side)))
    size = records.first.size
    all_ = size == one.sizes["record"] == other.sizes["record"]
    of = f" of {size} records" if all_ else f" of the {size} records in both"
    lines = []
    for place in range(blocks.first.size) if size else ():
        old, new = (_margin(part.isel(block=place)) for part in parts)
        common = [what for what in old if what in new]
        if any(old[what] != new[what] for what in common):
            told = [f"{what} {old[what]}" + (f" -> {new[what]}" if new[what] != old[what] else "") for what in common]
            lines.append(f"{blocks.names(place)[0]}: {', '.join(told)}{of}")
    return lines


def _margin(body: xr.Dataset) -> dict[str, str]:
    """Of one body: what, and how much of it."""
    told = {}
    searched = body.get("safe_up_to")
    bound = body["factor_resolved"] == 0 if "factor_resolved" in body else None
    if "safety_factor" in body:
        told["smallest SF"] = _smallest(body["safety_factor"], searched, bound)
    for demand in body["demand"].values if "capacity_ratio" in body else ():
        ratio = body["capacity_ratio"].sel(demand=demand)
        asked = body["demand_acceleration"].sel(demand=demand)
        proven = None if searched is None else searched * body["pga"] / asked
        told[f"smallest capacity/demand {demand}"] = _smallest(ratio, proven, bound)
    if "outcome" in body:
        falls = body["outcome"] == Outcome.OVERTURNS
        told["overturned"] = str(int((falls.any("case") if "case" in falls.dims else falls).sum()))
    return told


def _smallest(ratio: xr.DataArray, searched: xr.DataArray | None, bound: xr.DataArray | None) -> str:
    """The smallest of some ratios: marked where it is a lower bound, without a finite one up to where it was sought."""
    low = ratio.values.ravel()
    proven = np.full(low.shape, np.nan) if searched is None else searched.transpose(*ratio.dims).values.ravel()
    known = ~np.isnan(low)
    told = known & ~(np.isinf(low) & (proven < 1.0))  # a search that ended before has shown nothing
    known = told if told.any() else known
    if not known.any():
        return factor_cell(None)
    at = int(np.argmin(low[known]))
    resolved = None if bound is None else int(not bound.transpose(*ratio.dims).values.ravel()[known][at])
    return factor_cell(float(low[known][at]), None, resolved, search_limit(low[known], proven[known]))
