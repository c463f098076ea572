"""Lists for the terminal: the cases, records or blocks of an assessment that a selection names, in its order."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Margin, bodies_of, fullest_model
from rockpulse.record.measures import PGA, STORED
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.export.selection import Selection, rows
from rockpulse.storage.hdf5.netcdf4 import flag_words, pointwise, worded
from rockpulse.views.shared.answer_cells import NAMES, TITLES, answer_cell, factor_cell, marks_of
from rockpulse.views.shared.record_marks import doubt, doubt_notes
from rockpulse.views.shared.table import Cell, Heading, Mark, Table, lines, number
from rockpulse.views.shared.terminal import paragraph, ratio, restitution, several, shortened
from rockpulse.views.shared.verdict_notes import BEYOND_CRITICAL, NO_ANSWER, NONE_UP_TO, OUTSIDE
from rockpulse.views.text.capacity import NAME_WIDTH, restitutions

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["block_list", "case_list", "record_list", "worst_first"]

#: Before the PGV of a record whose baseline drifts.
DRIFT = Mark("~", "~: the baseline of the record drifts, PGV may be off by as much.", before=True)

#: Longest record id in a list.
ID_WIDTH = 36

#: Variables of /summary that a verdict is told by, all that a list of cases has columns for, and what else these need.
VERDICT = ("outcome", "peak_rotation_ratio", "applicable")
SHOWN = (*VERDICT, PGA, "uplift_ratio", "impulse_ratio", "restitution")
BESIDE = ("warning_codes",)

#: The same of a factor, with how far was searched where none was found, and whether the model answers there.
OF_FACTOR = {
    "factor_10": ("overturning_probability", "factor_10", "factor_10_low"),
    "safety_factor": ("safety_factor", "safe_up_to", "factor_resolved", "capacity_pga"),
}

#: Columns of what the files state, shown where one of them does: title, variable, and SI units in one of the title.
STATED = (("M", "magnitude", 1.0), ("distance km", "epicentral_distance", 1000.0))


def worst_first(answers: Answers, selection: Selection) -> Selection:
    """A selection in the order of the factor, or of the rotation where none is known."""
    if answers.told:
        return replace(selection, sort=answers.factor, descending=False)
    return replace(selection, sort="peak_rotation_ratio", descending=True)


def case_list(summary: xr.Dataset, selection: Selection) -> str:
    """The answers that a selection names, one a line; those of the fullest model where it names none.

    Raises ResultsError for a name or variable that is not there.
    """
    if not selection.names.get("model"):
        selection = replace(selection, names={**selection.names, "model": (fullest_model(summary),)})
    dims = [dim for dim in ("record", "block", "case", "model") if dim in summary["outcome"].dims]
    places, found = rows(summary, dims, selection, [(("block", "case"), _distinct(summary))] if "case" in dims else [])
    count = places["record"].size
    heading = _heading(selection, count, found)
    if not count:
        return heading
    records, blocks, models = (summary[dim].values[places[dim]].tolist() for dim in ("record", "block", "model"))
    with_model = len(set(models)) > 1
    shown = (*SHOWN, *(name for of in OF_FACTOR.values() for name in of))
    get = _values(summary, (*shown, *BESIDE), places)
    told = [factor for factor, of in OF_FACTOR.items() if not np.isnan(get[of[0]]).all()]
    more = [name for name in _of_interest(selection) if name not in shown]
    extra = [_shown(summary, name, places) for name in more]
    headings = [Heading("record"), Heading("block", width=NAME_WIDTH), *([Heading("model")] if with_model else [])]
    title = "verdict" if with_model else models[0]
    headings += map(Heading, ("C", "PGA/g", "a/a_up", "I/I_1c", title))
    of_factor = {"factor_10": ("P", TITLES["factor_10"]), "safety_factor": ("SF", "SF PGA/g")}
    headings += [Heading(one) for factor in told for one in of_factor[factor]] + [Heading(name) for name in more]
    table = []
    for k in range(count):
        one = {name: values[k] for name, values in get.items()}
        pga = one[PGA] / STANDARD_GRAVITY
        table.append(
            (
                Cell(shortened(records[k], ID_WIDTH), marks=doubt(one[PGA], one["warning_codes"])),
                Cell(blocks[k]),
                *([Cell(models[k])] if with_model else []),
                number(one["restitution"], restitution),
                *(number(value, ratio) for value in (pga, one["uplift_ratio"], one["impulse_ratio"])),
                answer_cell(*(one[name] for name in VERDICT)),
                *(cell for factor in told for cell in _OF_FACTOR[factor](one, pga)),
                *(cells[k] for cells in extra),
            )
        )
    rocking = zip(get["outcome"], get["peak_rotation_ratio"], strict=True)
    beyond = any(outcome == Outcome.ROCKS and peak > 1.0 for outcome, peak in rocking)
    return _listed(heading, headings, table, _notes(table, beyond, told))


def record_list(summary: xr.Dataset, selection: Selection) -> str:
    """The records that a selection names: strength, and what they do to the blocks.

    A condition on an answer has to hold for one of the blocks. Raises ResultsError for a name or variable that is not
    there.
    """
    answers, selection = _selected(summary, selection)
    places, found = rows(answers.summary, ["record"], selection)
    drifts = [f"{one.name}_drift" for one in STORED if one.drifts]
    names = (*(one.name for one in STORED), *drifts, "main_impulse", "warning_codes")
    get = _values(answers.summary, names, places)
    stated = [column for column in STATED if _known(answers.summary, column[1])]
    shown = (*names, *(name for _, name, _ in stated))
    more = [name for name in _of_interest(selection) if answers.summary[name].dims == ("record",) and name not in shown]
    extra = [_shown(answers.summary, name, places) for name in more]
    of_files = _values(answers.summary, tuple(name for _, name, _ in stated), places)
    fallen, margins = answers.overturnings("motion"), answers.margins("motion")
    table = []
    for k, row in enumerate(places["record"].tolist()):
        codes = get["warning_codes"][k]
        table.append(
            (
                Cell(shortened(answers.records[row], ID_WIDTH), marks=doubt(get[PGA][k], codes)),
                *(
                    number(
                        get[one.name][k] / one.column[2],
                        ratio,
                        (DRIFT,) if one.drifts and get[f"{one.name}_drift"][k] else (),
                    )
                    for one in STORED
                ),
                number(get["main_impulse"][k], ratio),
                *(number(of_files[name][k] / scale) for _, name, scale in stated),
                Cell(str(len(codes.split()) or ""), float(len(codes.split()))),
                *(cells[k] for cells in extra),
                Cell(f"{fallen[row]} of {len(answers.blocks)}", float(fallen[row])),
                *_smallest(margins[row], answers.blocks, NAME_WIDTH),
            )
        )
    strengths = (f"{heading}{'/' if unit == 'g' else ' '}{unit}" for heading, unit, _ in (one.column for one in STORED))
    of_record = ("record", *strengths, "I m/s", *(title for title, _, _ in stated), "warnings")
    titles = (*of_record, *more, "overturns", TITLES[answers.factor], "of")
    notes = [
        f"overturns: blocks that do, by the {answers.model} model; {TITLES[answers.factor]}: smallest known "
        f"{NAMES[answers.factor]}, and of which block.",
        *_marked(table),
        *doubt_notes(row[0] for row in table),
    ]
    return _listed(_counted("record", len(table), found, selection), map(Heading, titles), table, notes)


def block_list(summary: xr.Dataset, selection: Selection) -> str:
    """The blocks that a selection names: size, and what the records do to them.

    A condition on an answer has to hold for one of the records. Raises ResultsError for a name or variable that is not
    there.
    """
    answers, selection = _selected(summary, selection)
    places, found = rows(answers.summary, ["block"], selection)
    get = _values(answers.summary, ("width", "height", "alpha_c", "p", "critical_impulse"), places)
    fallen, margins = answers.overturnings("block"), answers.margins("block")
    table = []
    for k, place in enumerate(places["block"].tolist()):
        table.append(
            (
                Cell(shortened(answers.blocks[place], NAME_WIDTH)),
                *(number(values[k], ratio) for values in get.values()),
                restitutions(answers, place),
                Cell(f"{fallen[place]} of {len(answers.records)}", float(fallen[place])),
                *_smallest(margins[place], answers.records, ID_WIDTH),
            )
        )
    titles = (
        "block",
        "b m",
        "h m",
        "alpha_c rad",
        "p 1/s",
        "I_1c m/s",
        "C",
        "overturned by",
        TITLES[answers.factor],
        "under",
    )
    notes = [
        f"overturned by: records that do, by the {answers.model} model; {TITLES[answers.factor]}: smallest known "
        f"{NAMES[answers.factor]}, and under which record.",
        *_marked(table),
    ]
    return _listed(_counted("block", len(table), found, selection), map(Heading, titles), table, notes)


def _selected(summary: xr.Dataset, selection: Selection) -> tuple[Answers, Selection]:
    """The answers of the fullest model that the selection names, and the selection with that model alone."""
    part = summary[["model"]]
    if patterns := selection.names.get("model", ()):
        places, _ = rows(part, ["model"], Selection({"model": patterns}))
        part = part.isel(model=places["model"])
    model = fullest_model(part)
    return Answers(summary, model=model), replace(selection, names={**selection.names, "model": (model,)})


def _smallest(margin: Margin, names: list[str], width: int) -> list[Cell]:
    """The smallest factor and what it is of; where none was found and not all are known it is not known."""
    if math.isinf(margin.smallest) and (margin.unknown or margin.partial):
        return [factor_cell(math.nan), Cell("")]
    named = shortened(names[margin.place], width) if math.isfinite(margin.smallest) else ""
    return [factor_cell(margin.smallest, margin.limit), Cell(named)]


def _distinct(summary: xr.Dataset) -> np.ndarray:
    """(block, case) which restitutions are shown: one of a block that has the same in all cases."""
    shown = np.zeros((summary.sizes["block"], summary.sizes["case"]), dtype=bool)
    for body in bodies_of(summary):
        shown[body.place, body.case] = True
    return shown


def _of_interest(selection: Selection) -> list[str]:
    """Variables that a selection is about."""
    names = [item.name for item in selection.conditions] + ([selection.sort] if selection.sort else [])
    return list(dict.fromkeys(names))


def _probable_cells(one: dict[str, Any], pga: float) -> list[Cell]:
    return [number(one["overturning_probability"], ratio), factor_cell(one["factor_10"], one["factor_10_low"])]


def _searched_cells(one: dict[str, Any], pga: float) -> list[Cell]:
    limit = one["safe_up_to"]
    capacity = factor_cell(one["capacity_pga"] / STANDARD_GRAVITY, limit * pga)
    return [factor_cell(one["safety_factor"], limit, one["factor_resolved"] == 0), capacity]


_OF_FACTOR = {"factor_10": _probable_cells, "safety_factor": _searched_cells}

#: What the columns of these are.
_MEANING = {
    "factor_10": "P: probability of overturning under the record as it is; factor of 10 %: factor on the record at "
    "which it is 10 %; both by the nonlinear model.",
    "safety_factor": "SF: smallest factor on the model's input that overturns; SF PGA: the capacity.",
}


def _values(summary: xr.Dataset, names: tuple[str, ...], places: dict[str, np.ndarray]) -> dict[str, list[Any]]:
    return {name: pointwise(summary[name].variable, places).tolist() for name in names}


def _known(summary: xr.Dataset, name: str) -> bool:
    """Whether a variable has a value for one of the records."""
    return name in summary and bool(summary[name].notnull().any())


def _shown(summary: xr.Dataset, name: str, places: dict[str, np.ndarray]) -> list[Cell]:
    """The cells of a variable that has no column of its own."""
    variable = summary[name].variable
    found = pointwise(variable, places)
    if words := flag_words(variable):
        return [Cell(str(word)) for word in worded(found, words)]
    if found.dtype.kind == "f":
        return [number(one) for one in found.tolist()]
    return [Cell(shortened(str(one), NAME_WIDTH)) for one in found.tolist()]


def _heading(selection: Selection, count: int, found: int) -> str:
    told = "; ".join(replace(selection, sort=None, limit=None).words)
    shown = "" if count == found else f"; {count} shown (--limit shows more)"
    return paragraph(f"{several(found, 'case')} with {told}{_order(selection)}{shown}")


def _order(selection: Selection) -> str:
    return f", {'largest' if selection.descending else 'smallest'} {selection.sort} first" if selection.sort else ""


def _counted(noun: str, count: int, found: int, selection: Selection) -> str:
    shown = f"{count} of " if count < found else ""
    return f"{shown}{several(found, noun)}{_order(selection)}"


def _listed(heading: str, headings: Iterable[Heading], table: list[tuple[Cell, ...]], notes: list[str]) -> str:
    laid = lines(Table("", "", tuple(headings), tuple(table)))
    return "\n".join([heading, "", *("  " + line for line in laid), "", *(paragraph(note, "  ") for note in notes)])


def _marked(table: list[tuple[Cell, ...]]) -> list[str]:
    """The meaning of the marks in a list of records or blocks."""
    marks = marks_of(cell for row in table for cell in row)
    return [mark.note for mark in (DRIFT, NONE_UP_TO) if mark in marks]


def _notes(table: list[tuple[Cell, ...]], beyond: bool, told: list[str]) -> list[str]:
    """The meaning of the columns and the marks in a list of cases."""
    marks = marks_of(cell for row in table for cell in row)
    meanings = {
        OUTSIDE: "*: outside the range of this model.",
        NO_ANSWER: "!: a lower bound, from this factor on the model cannot answer.",
    }
    return [
        "Figures: theta_max/alpha_c. a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one "
        "that overturns alone.",
        *(_MEANING[factor] for factor in told),
        *([BEYOND_CRITICAL] if beyond else []),
        *([NONE_UP_TO.note] if NONE_UP_TO in marks else []),
        *doubt_notes(row[0] for row in table),
        *(note for mark, note in meanings.items() if mark in marks),
    ]
