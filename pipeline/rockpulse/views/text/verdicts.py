"""The verdicts of all models as text: a line for every record and body, and what overturns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import verdicts
from rockpulse.failures import some
from rockpulse.views.shared.answer_cells import answer_cells, factor_cells, marks_of
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import figure, paragraph, ratio, restitution, several, shortened
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO, verdict_notes
from rockpulse.views.text.capacity import NAME_WIDTH, factor_notes

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["factor_table", "governing", "overturned", "verdict_table"]

#: Records that govern, and bodies that each of them governs, which are named.
NAMED = 3


def verdict_table(
    summary: xr.Dataset, records: Sequence[str] | None = None, blocks: Sequence[str] | None = None
) -> str:
    """The verdict of every model, one line per block under a heading per record, with footnotes.

    Of some records or blocks where these are given.
    """
    answers = _answers(summary, records, blocks)
    of_factors = factor_notes(answers)
    columns = {model: answer_cells(one) for model, one in answers.of_models.items()}
    marks = marks_of(cell for column in columns.values() for cells in column for cell in cells)
    if of_factors:
        columns["SF"] = factor_cells(answers, counted=False)
    notes = verdict_notes(answers, of_factors, marks)
    return "\n".join([*_lines(answers, columns), "", *(paragraph(note, "  ") for note in notes)])


def factor_table(summary: xr.Dataset) -> str:
    """The smallest factor on a model's input that overturns the block, laid out as the verdicts."""
    answers = Answers(summary)
    columns = {model: factor_cells(one) for model, one in answers.of_models.items()}
    marks = marks_of(cell for column in columns.values() for row in column for cell in row)
    notes = [
        "-: not computed for this model. (2): in two intervals of the factor; between them the block stands (group "
        "overturning_intervals)."
    ]
    if NONE_UP_TO in marks:
        notes.insert(0, NONE_UP_TO.note)
    elif any(np.isinf(one["safety_factor"]).any() for one in answers.of_models.values()):
        notes.insert(0, "none: not found up to the end of the search.")
    notes += ["!: a lower bound, from this factor on the model cannot answer."] if NO_ANSWER in marks else []
    return "\n".join([*_lines(answers, columns), "", *(paragraph(note, "  ") for note in notes)])


def overturned(answers: Answers, files: str = "") -> str:
    """The part of the overview on overturning: the records that overturn each block, by the fullest model in use.

    Before them stands what is to be known of the `files`, where not all are among these records. Below stand the counts
    of every model, and the pairs in which a block rocks under a record but is overturned by a weaker copy of it, which
    is no safer.
    """
    names = [cell.marked for cell in record_cells(answers.summary)]
    fallen = answers.by_block(np.logical_or, answers.overturned)
    smallest = answers.by_block(np.fmin, answers["safety_factor"])
    counts = [one.overturnings("block") for one in answers.of_models.values()]
    told = [f"What overturns (by the {answers.model} model):", *([paragraph(files, "    ", "  ! ")] if files else [])]
    rows, by_weaker = [], []
    for place, block in enumerate(answers.blocks):
        weaker = [
            f"{names[row]} ({figure(smallest[row, place])})"
            for row in np.flatnonzero(~fallen[:, place] & (smallest[:, place] < 1.0))
        ]
        nothing = "nothing as recorded does, but see below" if weaker else "nothing does"
        named = ", ".join(names[row] for row in np.flatnonzero(fallen[:, place]))
        told.append(paragraph(named or nothing, "      ", f"  {block}: "))
        by_weaker += [paragraph(", ".join(weaker), "      ", f"  {block}: ")] if weaker else []
        rows.append((Cell(block), *(Cell(f"{own[place]} of {len(names)}", float(own[place])) for own in counts)))
    headings = (Heading("records that overturn", width=NAME_WIDTH), *map(Heading, answers.models))
    told += ["", *("  " + line for line in lines(Table("", "", headings, tuple(rows))))]
    if by_weaker:
        told += ["", "What rocks, but a weaker copy of the record overturns it (SF in brackets): not safe", *by_weaker]
    return "\n".join(told)


def governing(answers: Answers) -> str:
    """The records that the verdicts rest on in words, with the bodies; empty where nothing is known of any.

    Of every body that is the record of its smallest safety factor or, without one, the first that overturns it.
    """
    ruled: dict[int, dict[str, None]] = {}
    for one in verdicts(answers):
        if one.governing >= 0:
            ruled.setdefault(one.governing, {})[one.body.block] = None
    told = []
    for row, blocks in sorted(ruled.items(), key=lambda item: -len(item[1]))[:NAMED]:
        if known := Known(answers.summary, record=answers.records[row]).described:
            of = some(list(blocks), NAMED)
            told.append(paragraph(f"{answers.records[row]}: {known} (for {of})", "      ", "  "))
    if not told:
        return ""
    others = [f"  and {several(len(ruled) - NAMED, 'other record')}"] if len(ruled) > NAMED else []
    what = "of the smallest safety factor" if answers.searched else "that overturns"
    return "\n".join([f"What governs (the record {what}, by the {answers.model} model):", *told, *others])


def _answers(summary: xr.Dataset, records: Sequence[str] | None, blocks: Sequence[str] | None) -> Answers:
    named = {"record": records, "block": blocks}
    return Answers(summary.sel({dim: list(labels) for dim, labels in named.items() if labels is not None}))


def _lines(answers: Answers, columns: dict[str, list[list[Cell]]]) -> list[str]:
    """A line for every body under a heading for every record."""
    demand = [answers["uplift_ratio"], answers["impulse_ratio"]]
    rows = [
        (
            Cell("  " + shortened(body.block, NAME_WIDTH)),
            number(body.restitution, restitution),
            *(number(float(table[row, lane]), ratio) for table in demand),
            *(column[row][lane] for column in columns.values()),
        )
        for row in range(len(answers.records))
        for lane, body in enumerate(answers.bodies)
    ]
    head, *laid = lines(Table("", "", tuple(map(Heading, ("", "C", "a/a_up", "I/I_1c", *columns))), tuple(rows)))
    found, size = [], len(answers.bodies)
    for place, cell in enumerate(record_cells(answers.summary)):
        found += ["", _heading(cell.marked, Known(answers.summary, record=cell.text)), head]
        found += laid[place * size : (place + 1) * size]
    return found[1:]


def _heading(name: str, record: Known) -> str:
    impulse = record.value("main_impulse")
    return "  ".join([name, *record.strength, *([] if math.isnan(impulse) else [f"I {figure(impulse, 'm/s')}"])])
