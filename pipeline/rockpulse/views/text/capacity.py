"""Capacities as text: every body, or every answer, against what the site asks for."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from rockpulse.assessment.answers import Answers, Margin
from rockpulse.views.shared.columns import (
    AT_MOST,
    COLUMNS,
    NAME_WIDTH,
    NO_ANSWER,
    NONE_UP_TO,
    factor_cell,
    margin_cells,
    marks_of,
)
from rockpulse.views.shared.notes import factor_name
from rockpulse.views.shared.table import Cell, Heading, Table, lines
from rockpulse.views.shared.terminal import ABSENT, paragraph

__all__ = ["capacities", "smallest_capacities"]


def smallest_capacities(answers: Answers, blocks: Collection[int] | None = None) -> str:
    """Of every body the smallest and the median capacity over each demand; empty without a demand or a motion.

    Only of the blocks at some places, where these are given.
    """
    motions = answers.motions
    if not answers.demands or not motions.names:
        return ""
    of_demands = [answers.margins(demand=name) for name in answers.demands]
    rows, every = [], []
    for body, *margins in zip(answers.bodies, *of_demands, strict=True):
        if blocks is None or body.place in blocks:
            rows.append((body.block, body.restitution, list(map(_both, margins))))
            every += margins
    each = "the pairs" if motions.kind == "pair" else "the records"
    of = f"{each}, each in its worst direction" if motions.kind == "pair" else each
    marks = marks_of(cell for margin in every for cell in margin_cells(margin))
    note = "Below 1: the record overturns the block before it is as strong as the demand."
    if answers.probable:
        note = "Below 1: brought to the demand, the record overturns the block with more than 10 % probability."
    if NONE_UP_TO in marks:
        note += f" {NONE_UP_TO.note}"
    elif any(math.isinf(margin.smallest) or math.isinf(margin.median) for margin in every):
        note += " none: no overturning found."
    if NO_ANSWER in marks:
        note += " !: a lower bound, from there on the model cannot answer."
    if unknown := max(margin.unknown for margin in every):
        note += f" -: not known; left out where others are ({unknown} of {each})."
    if partial := max(margin.partial for margin in every):
        note += f" {AT_MOST.note[:-1]} (up to {partial} of {each})."
    if weak := max(margin.weak for margin in every):
        note += f" Left out: those too weak for the search to reach the demand (up to {weak} of {each})."
    heading = f"Capacity ({_capacity(answers)}) over demand: smallest and median of {of}"
    return "\n".join([paragraph(heading), "", *_lines(answers, rows, NAME_WIDTH), "", paragraph(note, "  ")])


def capacities(answers: Answers, of: str) -> list[str]:
    """Lines with the capacity over each demand of every body, named by record or by block as `of` says."""
    if not answers.demands:
        return []
    of_demands = [(answers.ratios(name), answers.proven(name)) for name in answers.demands]
    rows = []
    for row, record in enumerate(answers.records):
        for lane, body in enumerate(answers.bodies):
            at, bound = (row, lane), bool(answers.bound[row, lane])
            cells = [factor_cell(float(ratio[at]), float(limit[at]), bound) for ratio, limit in of_demands]
            rows.append((record if of == "record" else body.block, body.restitution, cells))
    marks = marks_of(cell for *_, cells in rows for cell in cells)
    notes = [paragraph(NONE_UP_TO.note, "  ")] if NONE_UP_TO in marks else []
    table = _lines(answers, rows, None if of == "record" else NAME_WIDTH)
    return [f"Capacity ({_capacity(answers)}) over demand:", *table, *notes, ""]


def _capacity(answers: Answers) -> str:
    return f"{factor_name(answers.factor)} x strength, {answers.model} model"


def _lines(answers: Answers, rows: Sequence[tuple[str, float, list[Cell]]], width: int | None) -> list[str]:
    """A table with a column for every demand."""
    titles = [Heading(f"{name} ({demand.words})") for name, demand in answers.demands.items()]
    c = COLUMNS["restitution"]
    cells = tuple((Cell(name), c.cell(value), *more) for name, value, more in rows)
    return ["  " + line for line in lines(Table("", "", (Heading("", width=width), c.heading, *titles), cells))]


def _both(margin: Margin) -> Cell:
    """The smallest and the median in one cell."""
    if math.isnan(margin.smallest):
        return Cell(ABSENT, math.nan)
    return Cell(", ".join(cell.marked for cell in margin_cells(margin)), margin.smallest)
