"""Safety factors and capacities as text: cells of the tables, and every body against what the site asks for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.views.shared.terminal import (
    ABSENT,
    aligned,
    figure,
    lower_bound,
    paragraph,
    ratio,
    restitution,
    shortened,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "BEYOND",
    "capacities",
    "factor_cell",
    "factor_notes",
    "passed_over",
    "search_limit",
    "short_factor_cell",
    "smallest_capacities",
    "thin_margin",
]

#: What a factor or a capacity behind ">" is; a search that found nothing has not shown that nothing overturns.
BEYOND = "none found up to there, where the search ends ([search] factor_max): on a weak record that says little"

#: Stands behind a factor or a capacity at which the model cannot answer.
LOWER_BOUND = "!"

#: A smallest factor below this is hardly a margin: on strong long records a search of the default fineness finds 6 % of
#: the factors more than a tenth too high (docs/decisions/011).
THIN_MARGIN = 1.1

#: So many steps of the search make the same margin where it is coarser: at the default fineness seven are a tenth.
THIN_STEPS = 7.0

#: Variables of /summary that the notes on the safety factors are about.
FACTORS = ("safety_factor", "safe_up_to", "outcome", "interval_count", "search_step", "factor_resolved")


def factor_cell(
    factor: float | None, intervals: int | None = None, resolved: int | None = None, limit: float | None = None
) -> str:
    """A safety factor, marked where it is a lower bound, with the number of intervals of overturning if several.

    Parameters
    ----------
    factor : float or None
        Safety factor, or capacity over demand [-]; NaN or None where it is not known, inf where none was found.
    intervals : int or None
        Number of intervals.
    resolved : int or None
        Flag `factor_resolved`: 0 where the model cannot answer at the factor.
    limit : float or None
        Up to where it was searched, which is shown where none was found; NaN or None where that is not known.

    Examples
    --------
    >>> [factor_cell(factor, count, None, 10.0) for factor, count in ((1.31, 1), (1.31, 3), (math.inf, 0))]
    ['1.31', '1.31 (3)', '>10']
    >>> factor_cell(1.31, 3, 0), factor_cell(math.nan), factor_cell(math.inf)
    ('1.31! (3)', '-', 'none')
    """
    shown = _number(factor, limit) + (LOWER_BOUND if resolved == 0 else "")
    return f"{shown} ({intervals})" if intervals is not None and intervals > 1 else shown


def short_factor_cell(
    factor: float | None, intervals: int | None = None, resolved: int | None = None, limit: float | None = None
) -> str:
    """The same with a mark in place of the number of intervals, and room for two marks.

    Parameters
    ----------
    factor, intervals, resolved, limit
        As for :func:`factor_cell`.

    Examples
    --------
    >>> short_factor_cell(1.31, 3, 0), short_factor_cell(1.31, 3), short_factor_cell(1.31)
    ('1.31!+', '1.31+ ', '1.31  ')
    """
    marks = (LOWER_BOUND if resolved == 0 else "") + ("+" if intervals is not None and intervals > 1 else "")
    return _number(factor, limit) + marks.ljust(2)


def search_limit(factor: np.ndarray, safe_up_to: np.ndarray | None) -> float:
    """Up to where nothing was found, where nothing was found; the smallest of several, NaN where that is not known.

    Parameters
    ----------
    factor : ndarray
        Safety factors [-].
    safe_up_to : ndarray or None
        Factors up to which the search found no overturning [-].

    Examples
    --------
    >>> search_limit(np.array([1.3, math.inf]), np.array([1.3, 10.0]))
    10.0
    """
    if safe_up_to is None:
        return math.nan
    return float(np.min(safe_up_to[np.isinf(factor)], initial=math.inf)) if np.isinf(factor).any() else math.nan


def thin_margin(search_step: np.ndarray) -> np.ndarray:
    """Below which factor there is hardly a margin, for a finer search may find a smaller one.

    Parameters
    ----------
    search_step : ndarray
        Ratio of neighbouring factors of the search [-]; NaN where there was none.

    Examples
    --------
    >>> thin_margin(np.array([1.0, 1.014, 1.06])).round(3).tolist()
    [1.1, 1.1, 1.42]
    """
    return np.fmax(THIN_MARGIN, 1.0 + THIN_STEPS * (np.asarray(search_step) - 1.0))


def passed_over(missed: float) -> str:
    """What the search for a safety factor may have missed, in words without a full stop.

    Parameters
    ----------
    missed : float
        Widest step of the search [-]: 0.015 for factors 1.5 % apart.
    """
    step = f"the step of the search (up to {missed:.1%})"
    return f"Bands narrower than {step} may lie below it: do not read it to two digits"


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
    notes = [f"SF: smallest factor on {of} at which the block overturns by the {model} model."]
    if np.isinf(factor).any():
        notes[0] += f" {_number(math.inf, search_limit(factor, found.get('safe_up_to')))}: {BEYOND}."
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
        notes[0] += f" {passed_over(missed)} ([search] {key})."
    bound = found["factor_resolved"] == 0 if "factor_resolved" in found else np.zeros(factor.shape, dtype=bool)
    if bounds := np.count_nonzero(bound):
        notes.append(
            f"{LOWER_BOUND}: from this factor on the model cannot answer, as in free flight ({bounds} of {bound.size}):"
            " a lower bound, below it no overturning was found."
        )
    rocks = (found["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        may = f", or may ({LOWER_BOUND})" if np.any(rocks & bound) else ""
        rock, them = ("that rocks", "it") if lucky == 1 else ("that rock", "them")
        notes.append(
            f"{lucky} with SF below 1 {rock}: a weaker record overturns {them}{may}; do not count {them} as safe."
        )
    margin = thin_margin(found["search_step"] if "search_step" in found else np.ones(factor.shape))
    if thin := np.count_nonzero((factor >= 1.0) & (factor < margin)):
        notes.append(
            f"{thin} with SF from 1 to {float(np.max(margin)):.2g}: hardly a margin, for a finer search may find a "
            "lower factor."
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
    rows, unknown, weak = [["", "C", *_titles(summary)]], 0, 0
    for name, c, *bounds in _bodies(summary, model):
        low, high, proven = bounds if directions is None else [_worst(each, directions) for each in bounds]
        # A search that ended below the demand has shown nothing of what lies between.
        little = np.isinf(low) & (proven < 1.0)
        unknown = max(unknown, int(np.count_nonzero(np.isnan(low[:, 0]))))
        weak = max(weak, int(np.count_nonzero(little, axis=0).max(initial=0)))
        told = ~np.isnan(low) & ~little
        rows.append([name, restitution(c), *map(_smallest, low.T, high.T, proven.T, told.T)])
    of = "the records" if directions is None else "the pairs, each in its worst direction"
    note = "Below 1: the record overturns the block before it is as strong as the demand."
    cells = [cell for row in rows[1:] for cell in row[2:]]
    if any(">" in cell for cell in cells):
        note += f" >: {BEYOND}."
    elif any("none" in cell for cell in cells):
        note += " none: no overturning found."
    if any(LOWER_BOUND in cell for cell in cells):
        note += f" {LOWER_BOUND}: a lower bound, from there on the model cannot answer."
    each, _, _ = of.partition(",")
    if unknown:
        note += f" -: not known; left out where others are ({unknown} of {each})."
    if weak:
        note += f" Left out: those too weak for the search to reach the demand (up to {weak} of {each})."
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
        for name, c, *bounds in _bodies(part, model):
            cells = map(_ratio, *(each[place] for each in bounds))
            rows.append([record if records is None else name, restitution(c), *cells])
    heading = f"Capacity (safety factor x PGA) over demand, by the {model} model:"
    lines = aligned(rows)
    note = [paragraph(f">: {BEYOND}.", "  ")] if any(">" in line for line in lines) else []
    return [heading, *("  " + line for line in lines), *note, ""]


def _titles(summary: xr.Dataset) -> list[str]:
    demands = summary["demand_acceleration"]
    return [f"{name} ({figure(float(demands.sel(demand=name)), 'm/s2')})" for name in demands["demand"].values]


def _bodies(summary: xr.Dataset, model: str) -> list[tuple[str, float, np.ndarray, np.ndarray, np.ndarray]]:
    """Name, C and ratios (record, demand) of every body and restitution case: at least, at most, and searched up to.

    Where the model cannot answer at the safety factor the ratio is a lower bound, and at most inf.
    """
    from rockpulse.views.text.overview import NAME_WIDTH, cases

    wanted = ("restitution", "capacity_ratio", "factor_resolved", "safe_up_to")
    names = [name for name in wanted if name in summary]
    found = []
    for block in (str(name) for name in summary["block"].values):
        body: Any = summary[names].sel(block=block, model=model)
        for case in cases(summary, block):
            one = body.isel(case=case) if "case" in body.dims else body
            low = one["capacity_ratio"].transpose("record", "demand").values
            high, proven = low.copy(), np.full(low.shape, np.nan)
            if "factor_resolved" in one:
                high[one["factor_resolved"].values == 0] = np.inf
            if "safe_up_to" in one:
                strength = one["safe_up_to"].values * summary["pga"].values
                proven = strength[:, np.newaxis] / summary["demand_acceleration"].values
            found.append((shortened(block, NAME_WIDTH), float(one["restitution"]), low, high, proven))
    return found


def _shown(summary: xr.Dataset, model: str, name: str) -> np.ndarray:
    """The values of one model in the rows of a table, which has one for restitution cases that are all the same."""
    from rockpulse.views.text.overview import cases

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
    """Smallest over direction, (pair, demand), of ratios (record, demand).

    NaN where a direction has none, unless another fails the demand: then the pair does, whatever the missing one says.
    """
    every = np.concatenate([ratios, np.full((1, ratios.shape[1]), np.nan)])[directions["record_index"].values]
    known = np.fmin.reduce(every, axis=1)
    return np.where(known < 1.0, known, every.min(axis=1))


def _number(factor: float | None, limit: float | None = None) -> str:
    if factor is None or math.isnan(factor):
        return ABSENT
    if not math.isinf(factor):
        return ratio(factor)
    if limit is None or math.isnan(limit):
        return "none"
    shown = lower_bound(limit)
    return shown.rstrip("0").rstrip(".") if "." in shown else shown


def _ratio(low: float, high: float, proven: float) -> str:
    return _number(low, proven) + (LOWER_BOUND if high > low else "")


def _smallest(low: np.ndarray, high: np.ndarray, proven: np.ndarray, told: np.ndarray) -> str:
    """The smallest and the median of what is told; without any, of what was searched."""
    known = told if told.any() else ~np.isnan(low)
    if not known.any():
        return ABSENT
    limit = search_limit(low[known], proven[known])
    middle, at_most = (float(np.median(bound[known])) for bound in (low, high))
    return f"{_ratio(np.min(low[known]), np.min(high[known]), limit)}, {_ratio(middle, at_most, limit)}"
