"""Lists of selected results, records or bodies for the terminal, in the order of the selection."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Of, bodies_of, fullest_model
from rockpulse.record.measures import PGA, STORED
from rockpulse.storage.export.row_selection import RowSelection, rows
from rockpulse.storage.hdf5.netcdf4 import flag_words, pointwise
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import paragraph, several, shortened
from rockpulse.views.shared.table import Cell, Table, lines, number_cell
from rockpulse.views.shared.verdict_table import factor_heading, factor_name
from rockpulse.views.shared.words import say

#: Columns of a list of results; for each scale factor that may be known, its columns and their notes.
CASE = ("record", "block", "model", "restitution", PGA, "uplift_ratio", "impulse_ratio", "answer")
OF_FACTOR = {"factor_10": ("overturning_probability", "factor_10"), "safety_factor": ("safety_factor", "capacity_pga")}
_MEANING = {
    "factor_10": "P: probability of overturning under the record as recorded, by the nonlinear model.",
    "safety_factor": "SF: smallest scale factor on the input of the model at which the body overturns; SF x PGA: the "
    "PGA of the record scaled by it.",
}

#: Name of the variable of the smallest capacity/demand over the demands, and its meaning.
CAPACITY = "capacity/demand"
_OF_DEMAND = "capacity/demand: scale factor over the scale factor of the demand, smallest over the demands."
#: Columns of a list of records, with facts stated by at least one file, and columns of a list of bodies.
STRENGTH = (*(one.name for one in STORED), "main_impulse")
RECORD = ("record", *STRENGTH, "magnitude", "epicentral_distance", "warnings")
STATED = frozenset({"magnitude", "epicentral_distance"})
BLOCK = ("block", "width", "height", "alpha_c", "p", "critical_impulse", "restitutions", "overturned_by")


class _Points:
    """The values of variables at the selected positions of /summary; a variable is read when it is first needed."""

    def __init__(self, summary: xr.Dataset, places: dict[str, np.ndarray], **beside: Sequence[Any]) -> None:
        self._summary, self._places, self._found = summary, places, dict(beside)

    def __getitem__(self, name: str) -> Sequence[Any]:
        if name not in self._found:
            if name in self._summary.dims:
                self._found[name] = self._summary[name].values[self._places[name]].tolist()
            else:
                self._found[name] = pointwise(self._summary[name].variable, self._places).tolist()
        return self._found[name]


def worst_cases(answers: Answers, selection: RowSelection) -> str:
    """List the selected results, sorted by capacity/demand or, without a demand, by scale factor, else by rotation."""
    summary, sort = answers.summary, answers.factor
    if not answers.has_factor:
        return case_list(summary, replace(selection, sort="peak_rotation_ratio", descending=True))
    if answers.demands:
        sort, like = CAPACITY, summary["outcome"].isel(model=0, drop=True)
        least = xr.full_like(like, np.nan, dtype=float).drop_attrs()
        smallest = np.fmin.reduce([answers.ratios(name) for name in answers.demands])
        for lane, body in enumerate(answers.bodies):
            least[{"block": body.place} | ({"case": body.case} if "case" in like.dims else {})] = smallest[:, lane]
        summary = summary.assign({CAPACITY: least})
    return case_list(summary, replace(selection, sort=sort, descending=False))


def case_list(summary: xr.Dataset, selection: RowSelection) -> str:
    """List the selected results, one on each line; by default those of the most complete model."""
    if not selection.names.get("model"):
        selection = replace(selection, names={**selection.names, "model": (fullest_model(summary),)})
    dims = [dim for dim in ("record", "block", "case", "model") if dim in summary["outcome"].dims]
    places, found = rows(summary, dims, selection, [(("block", "case"), _distinct(summary))] if "case" in dims else [])
    count = places["record"].size
    conditions = "; ".join(replace(selection, sort=None, limit=None).words)
    limited = "" if count == found else f"; {count} shown (--limit N for more)"
    heading = paragraph(f"{several(found, 'case')} with {conditions}{_order(selection)}{limited}")
    if not count:
        return heading
    points = _Points(summary, places)
    models = points["model"]
    single = len(set(models)) == 1
    factors = [factor for factor, of in OF_FACTOR.items() if not np.isnan(points[of[factor == "factor_10"]]).all()]
    names = [name for name in CASE if name != "model" or not single]
    names += [name for factor in factors for name in OF_FACTOR[factor]]
    selected = col.columns(*names, answer=say(f"models.{models[0]}") if single else "")
    selected += _of_interest(summary, selection, selected)
    table = col.filled(selected, points)
    rotations = zip(points["outcome"], points["peak_rotation_ratio"], strict=True)
    beyond = any(outcome == Outcome.ROCKS and peak > 1.0 for outcome, peak in rotations)
    marks = col.marks_of(cell for row in table for cell in row)
    notes = [
        "Model column: largest rotation over the critical angle (theta_max/alpha_c). Uplift ratio: PGA "
        "over the PGA that lifts the body. I/I_1c: main impulse over the single impulse that overturns the body.",
        *(_MEANING[factor] for factor in factors),
        *([_OF_DEMAND] if CAPACITY in summary else []),
        *([say("note.beyond_critical")] if beyond else []),
        *([col.NONE_UP_TO.note] if col.NONE_UP_TO in marks else []),
        *col.doubt_notes(row[0] for row in table),
        *(["*: outside the range of this model."] if col.OUTSIDE in marks else []),
        *(["!: a lower bound; from this scale factor on the model gives no result."] if col.NO_ANSWER in marks else []),
    ]
    return _listed(heading, selected, table, notes)


def record_list(summary: xr.Dataset, selection: RowSelection) -> str:
    """List the selected records; a condition on results must be met for at least one body."""
    answers, selection = _selected(summary, selection)
    summary = answers.summary
    names = [name for name in RECORD if name not in STATED or (name in summary and summary[name].notnull().any())]
    return _of_motions(answers, selection, "record", names)


def block_list(summary: xr.Dataset, selection: RowSelection) -> str:
    """List the selected bodies; a condition on results must be met for at least one record."""
    return _of_motions(*_selected(summary, selection), "block", BLOCK)


def _of_motions(answers: Answers, selection: RowSelection, dim: str, names: Sequence[str]) -> str:
    """List records or bodies, each with its number of overturnings and its smallest scale factor."""
    summary, of_records = answers.summary, dim == "record"
    places, found = rows(summary, [dim], selection)
    at = places[dim].tolist()
    of: Of = "motion" if of_records else "block"
    fallen, margins = answers.overturnings(of), answers.margins(of)
    opposite = answers.blocks if of_records else answers.records
    own = [[body.restitution for body in answers.bodies if body.place == place] for place in range(len(answers.blocks))]
    width = col.NAME_WIDTH if of_records else col.ID_WIDTH
    smallest = [col.smallest_of(margins[place], opposite, width) for place in at]
    points = _Points(
        summary,
        places,
        fallen=[fallen[place] for place in at],
        total=[len(opposite)] * len(at),
        restitutions=[] if of_records else [own[place] for place in at],
        smallest=[cell for cell, _ in smallest],
        where=[cell for _, cell in smallest],
    )
    selected = col.columns(*names)
    if of_records:
        selected += _of_interest(summary, selection, selected, "record") + col.columns("overturns")
    selected += (
        col.titled(factor_heading(answers.factor), lambda cell: cell, "smallest"),
        col.titled("of" if of_records else "under", lambda cell: cell, "where"),
    )
    table = col.filled(selected, points)
    marks = col.marks_of(cell for row in table for cell in row)
    what = ("Bodies overturned", "for which body") if of_records else ("Records that overturn", "under which record")
    notes = [
        f"{what[0]}: by the {answers.model} model. {factor_heading(answers.factor)}: smallest known "
        f"{factor_name(answers.factor)}, and {what[1]}.",
        *(mark.note for mark in (col.DRIFT, col.NONE_UP_TO) if mark in marks),
        *(col.doubt_notes(row[0] for row in table) if of_records else ()),
    ]
    limited = f"{len(table)} of " if len(table) < found else ""
    heading = f"{limited}{several(found, 'body' if dim == 'block' else dim)}{_order(selection)}"
    return _listed(heading, selected, table, notes)


def _selected(summary: xr.Dataset, selection: RowSelection) -> tuple[Answers, RowSelection]:
    """Return the results of the most complete selected model, and the selection limited to this model."""
    part = summary[["model"]]
    if patterns := selection.names.get("model", ()):
        places, _ = rows(part, ["model"], RowSelection({"model": patterns}))
        part = part.isel(model=places["model"])
    model = fullest_model(part)
    return Answers(summary, model=model), replace(selection, names={**selection.names, "model": (model,)})


def _distinct(summary: xr.Dataset) -> np.ndarray:
    """Return a mask (block, case) of all restitutions of each body or, if they are equal, of the first one only."""
    distinct = np.zeros((summary.sizes["block"], summary.sizes["case"]), dtype=bool)
    for body in bodies_of(summary):
        distinct[body.place, body.case] = True
    return distinct


def _of_interest(
    summary: xr.Dataset, selection: RowSelection, selected: Sequence[col.Column], dim: str = ""
) -> tuple[col.Column, ...]:
    """Return additional columns for variables that appear in the conditions of a selection but not in its columns."""
    present = {name for column in selected for name in column.of} | {"factor_resolved"}
    names = [item.name for item in selection.conditions] + ([selection.sort] if selection.sort else [])
    return tuple(
        col.Column(name, (name,), _plain(summary[name].variable), title=name)
        for name in dict.fromkeys(names)
        if name not in present and (not dim or summary[name].dims == (dim,))
    )


def _plain(variable: xr.Variable) -> Any:
    """Return the function that makes a cell from a value of a variable without a predefined column."""
    if words := flag_words(variable):
        return lambda code: Cell(words[code])
    return number_cell if variable.dtype.kind == "f" else lambda one: Cell(shortened(str(one), col.NAME_WIDTH))


def _order(selection: RowSelection) -> str:
    return f", {'largest' if selection.descending else 'smallest'} {selection.sort} first" if selection.sort else ""


def _listed(heading: str, selected: Sequence[col.Column], table: Sequence[tuple[Cell, ...]], notes: list[str]) -> str:
    laid = lines(Table("", "", col.headed(selected), tuple(table)), "  ")
    return "\n".join([heading, "", *laid, "", *(paragraph(note, "  ") for note in notes)])
