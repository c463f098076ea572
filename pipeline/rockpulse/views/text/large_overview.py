"""The overview of an assessment that is too large to be shown whole: counts, the worst, and how to see the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome
from rockpulse.ladder import cautions
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.selection import Selection
from rockpulse.views.shared.record_marks import doubt_notes, doubts
from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, restitution, shortened
from rockpulse.views.text.capacity import BEYOND, FACTORS, factor_cell, search_limit, smallest_capacities
from rockpulse.views.text.lists import answers, case_list, distinct, worst_first
from rockpulse.views.text.overview import NAME_WIDTH, fullest_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["hints", "is_large", "large_overview"]

#: Most verdicts of a model that are shown one by one.
WHOLE = 200

#: Worst cases and blocks that are shown, and worst pairs of channels of a sweep.
WORST, PAIRS = 12, 3


def is_large(summary: xr.Dataset) -> bool:
    """Whether an assessment has too many answers for a table of all.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    """
    return summary.sizes["record"] * int(distinct(summary).sum()) > WHOLE


def large_overview(tree: xr.DataTree) -> str:
    """Strength of the records, verdicts by model, the worst blocks and cases.

    Parameters
    ----------
    tree : xarray.DataTree
        The results; values that are not yet read are read as far as they are shown.
    """
    summary = tree["summary"].to_dataset()
    model = fullest_model(summary)
    shown = worst_first(summary, model, Selection(limit=WORST))
    parts = [_strength(summary), _verdicts(summary), _blocks(summary, model)]
    directions = tree["directions"].to_dataset() if "directions" in tree.children else None
    parts.append(case_list(summary, shown) if directions is None else _pairs(summary, directions, model))
    parts.append(_capacities(summary, model, directions))
    return "\n\n".join(part for part in parts if part)


def _strength(summary: xr.Dataset) -> str:
    """How strong the records are."""
    rows = [["", "smallest", "median", "largest", ""]]
    for title, name, scale, unit in (
        ("PGA", "pga", STANDARD_GRAVITY, "g"),
        ("PGV", "pgv", 1.0, "m/s"),
        ("Arias intensity", "arias_intensity", 1.0, "m/s"),
        ("main impulse I", "main_impulse", 1.0, "m/s"),
    ):
        values = summary.variables[name].values / scale
        known = values[~np.isnan(values)]
        if known.size:
            rows.append([title, *(figure(float(at)) for at in np.quantile(known, (0.0, 0.5, 1.0))), unit])
    lines = ["The records:", *("  " + line.rstrip() for line in aligned(rows))]
    drifting = int(np.count_nonzero(summary["pgv_drift"].values)) if "pgv_drift" in summary else 0
    if drifting:
        of = (
            "1 record may be off: its baseline drifts"
            if drifting == 1
            else f"{drifting} records may be off: their baseline drifts"
        )
        lines.append(f"  PGV of {of} (--where 'pgv_drift = drift').")
    found = [marks for marks in doubts(summary).values() if marks]
    if found:
        lines.append(paragraph(f"{len(found)} with a doubtful peak, marked wherever they are named.", "  "))
        lines += [paragraph(note, "  ") for note in doubt_notes(found)]
    return "\n".join(lines)


def _verdicts(summary: xr.Dataset) -> str:
    """How many verdicts of each kind every model gives."""
    shown = distinct(summary)
    total = summary.sizes["record"] * int(shown.sum())
    rows = [["", "at rest", "rocks", "OVERTURNS", "", "unresolved", "SF < 1", "not predictable"]]
    for model in (str(label) for label in summary["model"].values):
        outcome = answers(summary, "outcome", model)
        assert outcome is not None
        counts = np.bincount(outcome[:, shown].ravel().clip(0), minlength=len(Outcome))
        factor, predictable = (answers(summary, name, model) for name in ("safety_factor", "predictable"))
        weak = None if factor is None or np.isnan(factor).all() else int(np.count_nonzero(factor[:, shown] < 1.0))
        unsure = (
            None if predictable is None or not (predictable >= 0).any() else int((predictable[:, shown] == 0).sum())
        )
        rest, rocks, over, unresolved = (int(counts[outcome]) for outcome in Outcome)
        share = f"{over / total:.1%}"
        more = [ABSENT if count is None else str(count) for count in (weak, unsure)]
        rows.append([model, str(rest), str(rocks), str(over), share, str(unresolved), *more])
    if all(row[-1] == ABSENT for row in rows[1:]):
        rows = [row[:-1] for row in rows]
    notes = ["SF < 1: overturns under the record, or under a weaker copy of it (rocking is not monotonic)."]
    notes += cautions(summary["model"].values)
    return "\n".join(
        [
            f"Verdicts, {total} by each model:",
            *("  " + line for line in aligned(rows)),
            *(paragraph(n, "  ") for n in notes),
        ]
    )


def _blocks(summary: xr.Dataset, model: str) -> str:
    """The blocks that most records overturn."""
    names = ("outcome", "safety_factor", "safe_up_to")
    outcome, factor, searched = (answers(summary, name, model) for name in names)
    assert outcome is not None
    fallen = (outcome == Outcome.OVERTURNS).any(axis=2).sum(axis=0)
    order = np.argsort(-fallen, kind="stable")[:WORST]
    c = summary.variables["restitution"].values.reshape(summary.sizes["block"], -1)
    median = np.full(fallen.size, np.nan)
    if factor is not None:
        smallest = factor.min(axis=2)
        known = ~np.isnan(smallest).all(axis=0)
        median[known] = np.nanmedian(smallest[:, known], axis=0)
    records = summary.sizes["record"]
    rows = [["", "C", "records that overturn it", "", "median SF"]]
    for k in order.tolist():
        between = " to ".join(dict.fromkeys(restitution(value) for value in (c[k].min(), c[k].max())))
        limit = None if factor is None or searched is None else search_limit(factor[:, k], searched[:, k])
        cell = factor_cell(float(median[k]), limit=limit)
        name = shortened(str(summary["block"].values[k]), NAME_WIDTH)
        rows.append([name, between, f"{fallen[k]} of {records}", f"{fallen[k] / records:.1%}", cell])
    which = f"the {len(order)} that most records overturn, of {fallen.size}" if len(order) < fallen.size else "all"
    note = [paragraph(f">: {BEYOND}.", "  ")] if any(">" in row[-1] for row in rows) else []
    return "\n".join([f"The blocks by the {model} model, {which}:", *("  " + line for line in aligned(rows)), *note])


def _pairs(summary: xr.Dataset, directions: xr.Dataset, model: str) -> str:
    """The pairs of channels of a sweep that are worst in some direction."""
    from rockpulse.views.text.directions import direction_table

    at = [str(label) for label in directions["model"].values].index(model)
    key = directions["smallest_safety_factor"].isel(model=at)
    if bool(np.isnan(key.values).all()):  # not searched
        key = -directions["largest_rotation_ratio"].isel(model=at)
    order, blocks = (
        np.sort(np.argsort(key.min([other for other in key.dims if other != dim]).values, kind="stable")[:most])
        for dim, most in (("pair", PAIRS), ("block", WORST))
    )
    part = directions.isel(pair=order, block=blocks).load()
    names = dict.fromkeys(("restitution", "npts", "warning_codes", *FACTORS))
    few = summary[[name for name in names if name in summary]].isel(block=blocks).load()
    heading = f"The {order.size} worst of {directions.sizes['pair']} pairs of channels"
    if blocks.size < directions.sizes["block"]:
        heading += f", the {blocks.size} worst of {directions.sizes['block']} blocks"
    return f"{heading}:\n\n{direction_table(few, part)}"


def _capacities(summary: xr.Dataset, model: str, directions: xr.Dataset | None) -> str:
    """Capacity over demand of the worst blocks; of a sweep over direction, every pair in its worst direction."""
    if "capacity_ratio" not in summary:
        return ""
    factor = answers(summary, "safety_factor", model)
    assert factor is not None
    order = np.argsort(np.nanmin(np.where(np.isnan(factor), np.inf, factor), axis=(0, 2)), kind="stable")[:WORST]
    at = [str(label) for label in summary["model"].values].index(model)
    wanted = ("capacity_ratio", "factor_resolved", "safe_up_to", "pga", "restitution", "demand_acceleration")
    part = summary[[name for name in wanted if name in summary]].isel(model=[at], block=np.sort(order)).load()
    return smallest_capacities(part, model, directions)


def hints() -> str:
    """How to see more of large results."""
    return "\n".join(
        [
            "More of it: rockpulse inspect RESULTS",
            "  --records, --blocks                     all records, all blocks; --sort VARIABLE, --limit N",
            "  --record ID, --block NAME               one in detail",
            "  --outcome overturns --model linear      the cases that are so; also --where 'safety_factor < 1'",
            "  and rockpulse export RESULTS -o table.csv with the same options.",
        ]
    )
