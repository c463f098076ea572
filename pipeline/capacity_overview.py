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

#: Stands behind a factor or a capacity at which the model cannot answer.
LOWER_BOUND = "!"

#: Variables of /summary that the notes on the safety factors are about.
FACTORS = ("safety_factor", "outcome", "interval_count", "search_step", "factor_resolved")


def factor_cell(factor: float | None, intervals: int | None = None, resolved: int | None = None) -> str:
    """A safety factor, marked where it is a lower bound, with the number of intervals of overturning if several.

    Parameters
    ----------
    factor : float or None
        Safety factor [-]; NaN or None where it is not known.
    intervals : int or None
        Number of intervals.
    resolved : int or None
        Flag `factor_resolved`: 0 where the model cannot answer at the factor.

    Examples
    --------
    >>> [factor_cell(factor, count) for factor, count in ((1.31, 1), (1.31, 3), (math.inf, 0), (math.nan, -1))]
    ['1.31', '1.31 (3)', 'none', '-']
    >>> factor_cell(1.31, 3, 0)
    '1.31! (3)'
    """
    shown = _number(factor) + (LOWER_BOUND if resolved == 0 else "")
    return f"{shown} ({intervals})" if intervals is not None and intervals > 1 else shown


def short_factor_cell(factor: float | None, intervals: int | None = None, resolved: int | None = None) -> str:
    """The same with a mark in place of the number of intervals, and room for two marks.

    Parameters
    ----------
    factor, intervals, resolved
        As for :func:`factor_cell`.

    Examples
    --------
    >>> short_factor_cell(1.31, 3, 0), short_factor_cell(1.31, 3), short_factor_cell(1.31)
    ('1.31!+', '1.31+ ', '1.31  ')
    """
    marks = (LOWER_BOUND if resolved == 0 else "") + ("+" if intervals is not None and intervals > 1 else "")
    return _number(factor) + marks.ljust(2)


def factor_notes(summary: xr.Dataset, model: str, swept: bool = False) -> list[str]:
    """What the column SF of a table means; nothing where the model was not searched.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary, or the part of it that is shown.
    model : str
        Whose factors are shown.
    swept : bool
        For the table of a sweep: the smallest over direction.
    """
    found = {name: _shown(summary, model, name) for name in FACTORS if name in summary}
    if "safety_factor" not in found or np.all(np.isnan(found["safety_factor"])):
        return []
    factor = found["safety_factor"]
    of = f"{_input(summary)}, over direction," if swept else _input(summary)
    notes = [f"SF: smallest factor on {of} at which the block overturns by the {model} model (none: not found)."]
    count = found.get("interval_count", np.zeros(0))
    if not swept and (several := np.count_nonzero(count > 1)):
        notes[0] += (
            f" +: not monotonic, beyond it the block stands again before it overturns again ({several} of {count.size},"
            f" up to {int(count.max())} intervals; group overturning_intervals)."
        )
    # A step of one: in closed form, nothing is missed.
    missed = float(np.nanmax(found["search_step"])) - 1.0 if "search_step" in found else 0.0
    if missed > 0.0:
        key = "step" if model == "sequence" else "points"
        notes[0] += (
            f" Bands narrower than the step of the search (up to {missed:.1%}) may lie below it: [search] {key}."
        )
    bound = found["factor_resolved"] == 0 if "factor_resolved" in found else np.zeros(factor.shape, dtype=bool)
    if bounds := np.count_nonzero(bound):
        notes.append(
            f"{LOWER_BOUND}: from this factor on the model cannot answer, as in free flight ({bounds} of {bound.size}):"
            " a lower bound, below it no overturning was found."
        )
    rocks = (found["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        may = f", or may ({LOWER_BOUND})" if np.any(rocks & bound) else ""
        notes.append(
            f"{lucky} with SF below 1 that rock: a weaker record overturns them{may}; do not count them as safe."
        )
    return notes


def smallest_capacities(summary: xr.Dataset, model: str, directions: xr.Dataset | None = None) -> str:
    """Per body and demand the smallest ratio of capacity and demand over the records; empty without a demand.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    model : str
        Whose capacities are shown.
    directions : xarray.Dataset, optional
        The node /directions of a sweep: every pair of channels counts once, in its worst direction.
    """
    if "capacity_ratio" not in summary or summary.sizes["record"] == 0:
        return ""
    rows, unknown = [["", "C", *_titles(summary)]], 0
    for name, c, low, high in _bodies(summary, model):
        if directions is not None:
            low, high = _worst(low, directions), _worst(high, directions)
        unknown = max(unknown, int(np.count_nonzero(np.isnan(low[:, 0]))))
        rows.append([name, restitution(c), *map(_smallest, low.T, high.T)])
    of = "the records" if directions is None else "the pairs, each in its worst direction"
    note = "Below 1: the record overturns the block before it is as strong as the demand. none: no overturning found."
    if any(LOWER_BOUND in cell for row in rows for cell in row[2:]):
        note += f" {LOWER_BOUND}: a lower bound, from there on the model cannot answer."
    if unknown:
        note += f" -: not known; left out where others are ({unknown} of {of.partition(',')[0]})."
    return "\n".join(
        [
            paragraph(f"Capacity (safety factor x PGA, {model} model) over demand: smallest and median of {of}"),
            "",
            *("  " + line for line in aligned(rows)),
            "",
            paragraph(note, "  "),
        ]
    )


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
        for name, c, low, high in _bodies(part, model):
            rows.append([record if records is None else name, restitution(c), *map(_ratio, low[place], high[place])])
    heading = f"Capacity (safety factor x PGA) over demand, by the {model} model:"
    return [heading, *("  " + line for line in aligned(rows)), ""]


def _titles(summary: xr.Dataset) -> list[str]:
    demands = summary["demand_acceleration"]
    return [f"{name} ({figure(float(demands.sel(demand=name)), 'm/s2')})" for name in demands["demand"].values]


def _bodies(summary: xr.Dataset, model: str) -> list[tuple[str, float, np.ndarray, np.ndarray]]:
    """Name, C and ratios (record, demand), at least and at most, of every body and restitution case.

    Where the model cannot answer at the safety factor the ratio is a lower bound, and at most inf.
    """
    from rockpulse.overview import NAME_WIDTH, cases

    found = []
    for block in (str(name) for name in summary["block"].values):
        names = [name for name in ("restitution", "capacity_ratio", "factor_resolved") if name in summary]
        body: Any = summary[names].sel(block=block, model=model)
        for case in cases(summary, block):
            one = body.isel(case=case) if "case" in body.dims else body
            low = one["capacity_ratio"].transpose("record", "demand").values
            high = low.copy()
            if "factor_resolved" in one:
                high[one["factor_resolved"].values == 0] = np.inf
            found.append((shortened(block, NAME_WIDTH), float(one["restitution"]), low, high))
    return found


def _shown(summary: xr.Dataset, model: str, name: str) -> np.ndarray:
    """The values of one model in the rows of a table, which has one for restitution cases that are all the same."""
    from rockpulse.overview import cases

    parts = []
    for block in summary["block"].values:
        body = summary[name].sel(block=block, model=model)
        parts.append((body.isel(case=list(cases(summary, block))) if "case" in body.dims else body).values.ravel())
    return np.concatenate(parts)


def _input(summary: xr.Dataset) -> str:
    """What the factor is on: a sequence that was given in place of a record has no samples."""
    given = "npts" in summary and bool(np.all(summary["npts"] < 0))
    return "the main impulse (with I_s/I kept)" if given else "the record"


def _worst(ratios: np.ndarray, directions: xr.Dataset) -> np.ndarray:
    """Smallest over direction, (pair, demand), of ratios (record, demand); NaN where a direction has none."""
    every = np.concatenate([ratios, np.full((1, ratios.shape[1]), np.nan)])
    return np.asarray(every[directions["record_index"].values].min(axis=1))


def _number(factor: float | None) -> str:
    if factor is None or math.isnan(factor):
        return ABSENT
    return "none" if math.isinf(factor) else ratio(factor)


def _ratio(low: float, high: float) -> str:
    return _number(low) + (LOWER_BOUND if high > low else "")


def _smallest(low: np.ndarray, high: np.ndarray) -> str:
    """The smallest and the median of what is known."""
    known = ~np.isnan(low)
    if not known.any():
        return ABSENT
    middle = [float(np.quantile(bound[known], 0.5, method="lower")) for bound in (low, high)]
    return f"{_ratio(np.min(low[known]), np.min(high[known]))}, {_ratio(*middle)}"
