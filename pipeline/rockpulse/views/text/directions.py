"""A sweep over direction as text: a table for every pair of channels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.ladder import cautions
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.record_marks import doubt, doubt_notes
from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, ratio, restitution, shortened
from rockpulse.views.text.capacity import factor_notes, short_factor_cell
from rockpulse.views.text.overview import NAME_WIDTH, cases, fullest_model, value

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["direction_table"]


def direction_table(summary: xr.Dataset, directions: xr.Dataset) -> str:
    """Rotations and smallest safety factor over direction by the fullest model; by every model, how many overturn.

    Parameters
    ----------
    summary, directions : xarray.Dataset
        The nodes /summary and /directions.
    """
    fullest = fullest_model(summary)
    models = [str(model) for model in directions["model"].values]
    count = directions.sizes["direction"]
    of_factors = factor_notes(summary, fullest, swept=True) if "smallest_safety_factor" in directions else []
    titles = ["SF  ", "at"] if of_factors else []
    headings, rows = [], [["", "C", "median", "largest", "at", *titles, *models]]
    for pair in (str(name) for name in directions["pair"].values):
        headings.append((len(rows), _heading(summary, directions, pair)))
        for block in (str(name) for name in directions["block"].values):
            for case in cases(summary, block):
                where: dict[str, Any] = {"pair": pair, "block": block, "case": case}
                fallen = [_fallen(directions, count, {**where, "model": model}) for model in models]
                rows.append(
                    [
                        "  " + shortened(block, NAME_WIDTH),
                        restitution(value(summary, "restitution", block=block, case=case)),
                        *(
                            _peak(value(directions, f"{which}_rotation_ratio", **where, model=fullest))
                            for which in ("median", "largest")
                        ),
                        _degrees(_largest_at(directions, {**where, "model": fullest})),
                        *(_smallest_factor(summary, directions, {**where, "model": fullest}) if titles else ()),
                        *fallen,
                    ]
                )
    lines = aligned(rows)
    # Over the columns of the models, what their figures are.
    over = f"directions of {count} that overturn".rjust(len(lines[0]))
    for place, heading in reversed(headings):
        lines[place:place] = ["", heading, over, lines[0]]
    smallest = " Smallest SF, and its azimuth." if of_factors else ""
    notes = [
        f"Median and largest over {count} directions of theta_max/alpha_c by the {fullest} model, and the azimuth of "
        f"the largest (where several overturn: of the one that does so first).{smallest} Then, by model, how many "
        "directions overturn; +1?: one more has no answer. -: not known without it.",
        *of_factors,
        *doubt_notes(heading for _, heading in headings),
        "The directions are records: rockpulse inspect RESULTS --record ID shows one, --block NAME all of them.",
    ]
    notes += cautions(models)
    return "\n".join([*lines[2:], "", *(paragraph(note, "  ") for note in notes)])


def _heading(summary: xr.Dataset, directions: xr.Dataset, pair: str) -> str:
    parts = [pair + _doubt(summary, directions, pair)]
    for title, name, unit, scale in (("PGA", "pga", "g", STANDARD_GRAVITY), ("I", "main_impulse", "m/s", 1.0)):
        median, largest, azimuth = (
            value(directions, f"{name}_{what}", pair=pair) for what in ("median", "largest", "azimuth")
        )
        if not math.isnan(largest):
            shown = f"{figure(median / scale)} (median), {figure(largest / scale, unit)} (at {_degrees(azimuth)})"
            parts.append(f"{title} {shown}")
    return "  ".join(parts)


def _doubt(summary: xr.Dataset, directions: xr.Dataset, pair: str) -> str:
    """The marks of the records that a pair is turned to."""
    index = directions["record_index"].sel(pair=pair).values
    codes = summary["warning_codes"].values[index[index >= 0]]
    return doubt(value(directions, "pga_largest", pair=pair), " ".join(map(str, codes)))


def _largest_at(directions: xr.Dataset, where: dict[str, Any]) -> float:
    """Azimuth of the largest rotation; none for a block that stays at rest in all directions."""
    moved = value(directions, "largest_rotation_ratio", **where) != 0.0
    return float(value(directions, "largest_azimuth", **where)) if moved else math.nan


def _smallest_factor(summary: xr.Dataset, directions: xr.Dataset, where: dict[str, Any]) -> tuple[str, str]:
    """Smallest safety factor over direction, marked where the model cannot answer there, and its azimuth."""
    factor, azimuth = (value(directions, name, **where) for name in ("smallest_safety_factor", "safety_factor_azimuth"))
    of = {name: where[name] for name in ("block", "case", "model")}
    index = directions["record_index"].sel(pair=where["pair"]).values
    if not math.isnan(azimuth):
        row = int(index[directions["direction_azimuth"].values == azimuth][0])
        resolved = value(summary, "factor_resolved", record=str(summary["record"].values[row]), **of)
        return short_factor_cell(factor, None, resolved), _degrees(azimuth)
    names = [str(name) for name in summary["record"].values[index[index >= 0]]]
    limits = [value(summary, "safe_up_to", record=name, **of) for name in names]
    # Without an answer in one direction it is not known how far all are safe.
    limit = None if None in limits else float(np.min(limits, initial=math.inf))
    return short_factor_cell(factor, limit=limit), _degrees(azimuth)


def _peak(peak: float) -> str:
    return Outcome.OVERTURNS.name if math.isinf(peak) else ratio(peak)


def _degrees(azimuth: float) -> str:
    return ABSENT if math.isnan(azimuth) else f"{azimuth:g}°"


def _fallen(directions: xr.Dataset, count: int, where: dict[str, Any]) -> str:
    unanswered = value(directions, "unanswered_count", **where)
    known = str(round(value(directions, "overturning_share", **where) * count))
    return f"{known} +{unanswered}?" if unanswered else known
