"""Safety factors and capacities as text: cells of the tables, and every body against what the site asks for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.models.response import Outcome
from rockpulse.terminal import ABSENT, aligned, figure, paragraph, ratio, restitution, shortened

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["capacities", "factor_cell", "factor_notes", "short_factor_cell", "smallest_capacities"]


def factor_cell(factor: float | None, intervals: int | None) -> str:
    """A safety factor, with the number of intervals of overturning where there are several.

    Parameters
    ----------
    factor : float or None
        Safety factor [-]; NaN or None where it is not known.
    intervals : int or None
        Number of intervals.

    Examples
    --------
    >>> [factor_cell(factor, count) for factor, count in ((1.31, 1), (1.31, 3), (math.inf, 0), (math.nan, -1))]
    ['1.31', '1.31 (3)', 'none', '-']
    """
    shown = short_factor_cell(factor, None)
    return f"{shown} ({intervals})" if intervals is not None and intervals > 1 else shown


def short_factor_cell(factor: float | None, intervals: int | None) -> str:
    """The same with a mark in place of the number: 1.31+.

    Parameters
    ----------
    factor, intervals
        As for :func:`factor_cell`.
    """
    if factor is None or math.isnan(factor):
        return ABSENT
    mark = "+" if intervals is not None and intervals > 1 else ""
    return ("none" if math.isinf(factor) else ratio(factor)) + mark


def factor_notes(summary: xr.Dataset, model: str) -> list[str]:
    """What the column SF of the verdicts means; nothing where the model was not searched.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    model : str
        Whose factors are shown.
    """
    if "safety_factor" not in summary or np.all(np.isnan(summary["safety_factor"].sel(model=model))):
        return []
    answers = summary.sel(model=model)
    notes = [f"SF: smallest factor on the record at which the block overturns by the {model} model (none: not found)."]
    if "interval_count" in summary and (several := int(np.count_nonzero(answers["interval_count"] > 1))):
        notes[0] += (
            f" +: not monotonic, beyond it the block stands again before it overturns again ({several} of "
            f"{answers['interval_count'].size}, up to {int(answers['interval_count'].max())} intervals; group "
            "overturning_intervals)."
        )
    if "search_step" in summary and not np.all(np.isnan(answers["search_step"])):
        missed = float(np.nanmax(answers["search_step"])) - 1.0
        notes[0] += (
            f" Bands narrower than the step of the search (up to {missed:.1%}) may lie below it: [search] points."
        )
    lucky = int(np.count_nonzero((answers["outcome"] == Outcome.ROCKS) & (answers["safety_factor"] < 1.0)))
    if lucky:
        notes.append(f"{lucky} with SF below 1 that rock: a weaker record overturns them; do not count them as safe.")
    return notes


def smallest_capacities(summary: xr.Dataset, model: str) -> str:
    """Per body and demand the smallest ratio of capacity and demand over the records; empty without a demand.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    model : str
        Whose capacities are shown.
    """
    if "capacity_ratio" not in summary or summary.sizes["record"] == 0:
        return ""
    lines = [f"Capacity (safety factor x PGA, {model} model) over demand: smallest and median of the records"]
    rows = [["", "C", *_titles(summary)]]
    for name, c, ratios in _bodies(summary, model):
        rows.append([name, restitution(c), *(_smallest(column) for column in ratios.T)])
    note = (
        "Below 1: the record overturns the block before it is as strong as the demand. none: no overturning found. -: "
        "not computed."
    )
    return "\n".join([*lines, "", *("  " + line for line in aligned(rows)), "", paragraph(note, "  ")])


def capacities(
    summary: xr.Dataset, model: str, records: Sequence[str] | None = None, blocks: Sequence[str] | None = None
) -> list[str]:
    """Lines with the ratio of capacity and demand for every body under a record, or every record on a body.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    model : str
        Whose capacities are shown.
    records, blocks : sequence of str, optional
        Which to show; all by default.
    """
    if "capacity_ratio" not in summary:
        return []
    part = summary.sel(
        record=list(summary["record"].values if records is None else records),
        block=list(summary["block"].values if blocks is None else blocks),
    )
    rows = [["", "C", *_titles(summary)]]
    for place, record in enumerate(str(label) for label in part["record"].values):
        for name, c, ratios in _bodies(part, model):
            rows.append([record if records is None else name, restitution(c), *map(_ratio, ratios[place])])
    heading = f"Capacity (safety factor x PGA) over demand, by the {model} model:"
    return [heading, *("  " + line for line in aligned(rows)), ""]


def _titles(summary: xr.Dataset) -> list[str]:
    demands = summary["demand_acceleration"]
    return [f"{name} ({figure(float(demands.sel(demand=name)), 'm/s2')})" for name in demands["demand"].values]


def _bodies(summary: xr.Dataset, model: str) -> list[tuple[str, float, np.ndarray]]:
    """Name, C and ratios (record, demand) of every body and restitution case; one where all cases are the same."""
    from rockpulse.overview import NAME_WIDTH, cases

    found = []
    for block in (str(name) for name in summary["block"].values):
        body: Any = summary[["restitution", "capacity_ratio"]].sel(block=block, model=model)
        for case in cases(summary, block):
            one = body.isel(case=case) if "case" in body.dims else body
            ratios = one["capacity_ratio"].transpose("record", "demand").values
            found.append((shortened(block, NAME_WIDTH), float(one["restitution"]), ratios))
    return found


def _ratio(value: float) -> str:
    return "none" if math.isinf(value) else ratio(value)


def _smallest(ratios: np.ndarray) -> str:
    """The smallest and the median of what is known."""
    known = ratios[~np.isnan(ratios)]
    if known.size == 0:
        return ABSENT
    median = float(np.quantile(known, 0.5, method="lower"))
    return f"{_ratio(float(np.min(known)))}, {_ratio(median)}"
