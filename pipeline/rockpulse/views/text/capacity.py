"""Factors and capacities as text: what the columns mean, and every body against what the site asks for."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Margin, searched_up_to
from rockpulse.model_table import MODELS
from rockpulse.views.shared.answer_cells import AT_MOST, NAMES, TITLES, factor_cell, margin_cells, marks_of
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import ABSENT, paragraph, restitution
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO

__all__ = [
    "NAME_WIDTH",
    "capacities",
    "factor_notes",
    "restitutions",
    "smallest_capacities",
    "uncertainty_words",
]

#: Longest block name in a table.
NAME_WIDTH = 29


def restitutions(answers: Answers, place: int) -> Cell:
    """The restitution of a block, of several the smallest and the largest."""
    own = [body.restitution for body in answers.bodies if body.place == place]
    return Cell(" to ".join(dict.fromkeys(map(restitution, (min(own), max(own))))), min(own))


def uncertainty_words(answers: Answers) -> str:
    """The uncertainty that the probability of overturning is stated under, as the results tell it."""
    return str(answers.summary["overturning_probability"].attrs.get("comment", "nonlinear model"))


def factor_notes(answers: Answers, swept: bool = False) -> list[str]:
    """The meaning of the columns that tell how near to overturning a body is; nothing where that is not known.

    In the table of a sweep the factor is the smallest over direction.
    """
    if not answers.told:
        return []
    factor = answers[answers.factor]
    of = "the main impulse (with I_s/I kept)" if answers.motions.kind == "sequence" else "the record"
    of += ", over direction," if swept else ""
    found = factor_cell(math.inf, searched_up_to(factor, answers.proven())).marked
    none = f" {found}{NONE_UP_TO.note[1:]}" if np.isinf(factor).any() else ""
    if answers.probable:
        title = TITLES["factor_10"]
        own = "" if swept else "P: probability of overturning under the record as it is; "
        return [
            f"{own}{title}: {'smallest ' if swept else ''}factor on {of} at which P is 10 %; "
            f"{uncertainty_words(answers)}.{none}"
        ]
    notes = [f"SF: smallest factor on {of} at which the block overturns by the {answers.model} model.{none}"]
    # A step of one: in closed form, nothing is missed.
    missed = float(np.nanmax(answers["search_step"], initial=1.0)) - 1.0
    if missed > 0.0:
        notes[0] += (
            f" Bands narrower than the step of the search (up to {missed:.1%}) may lie below it: do not read it to two "
            f"digits ([search] {MODELS[answers.model].grid})."
        )
    if bounds := np.count_nonzero(answers.bound):
        notes.append(
            f"!: from this factor on the model cannot answer, as in free flight ({bounds} of {answers.bound.size}):"
            " a lower bound, below it no overturning was found."
        )
    rocks = (answers["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        may = ", or may (!)" if np.any(rocks & answers.bound) else ""
        rock, them = ("that rocks", "it") if lucky == 1 else ("that rock", "them")
        notes.append(f"{lucky} with SF below 1 {rock}: a weaker record overturns {them}{may}.")
    return notes


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
            rows.append([Cell(body.block), number(body.restitution, restitution), *map(_both, margins)])
            every += margins
    each = "the pairs" if motions.kind == "pair" else "the records"
    of = f"{each}, each in its worst direction" if motions.kind == "pair" else each
    cells = [cell for margin in every for cell in margin_cells(margin)]
    marks = marks_of(cells)
    note = _below(answers)
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
    table = ["  " + line for line in _lines("", answers, rows)]
    return "\n".join([paragraph(heading), "", *table, "", paragraph(note, "  ")])


def capacities(answers: Answers, of: str) -> list[str]:
    """Lines with the capacity over each demand of every body, named by record or by block as `of` says."""
    if not answers.demands:
        return []
    bound = answers.bound
    of_demands = [(answers.ratios(name), answers.proven(name)) for name in answers.demands]
    rows = []
    for row, record in enumerate(answers.records):
        for lane, body in enumerate(answers.bodies):
            at = row, lane
            cells = [factor_cell(float(one[at]), float(limit[at]), bool(bound[at])) for one, limit in of_demands]
            rows.append([Cell(record if of == "record" else body.block), number(body.restitution, restitution), *cells])
    heading = f"Capacity ({_capacity(answers)}) over demand:"
    notes = [NONE_UP_TO.note] if NONE_UP_TO in marks_of(cell for row in rows for cell in row) else []
    lines = ["  " + line for line in _lines(of, answers, rows)]
    return [heading, *lines, *(paragraph(note, "  ") for note in notes), ""]


def _below(answers: Answers) -> str:
    if answers.probable:
        return "Below 1: brought to the demand, the record overturns the block with more than 10 % probability."
    return "Below 1: the record overturns the block before it is as strong as the demand."


def _capacity(answers: Answers) -> str:
    return f"{NAMES[answers.factor]} x strength, {answers.model} model"


def _lines(of: str, answers: Answers, rows: list[list[Cell]]) -> list[str]:
    """A table with a column for every demand."""
    width = None if of == "record" else NAME_WIDTH
    titles = [f"{name} ({demand.words})" for name, demand in answers.demands.items()]
    headings = (Heading("", width=width), Heading("C"), *map(Heading, titles))
    return lines(Table("", "", headings, tuple(map(tuple, rows))))


def _both(margin: Margin) -> Cell:
    """The smallest and the median in one cell."""
    if math.isnan(margin.smallest):
        return Cell(ABSENT, math.nan)
    return Cell(", ".join(cell.marked for cell in margin_cells(margin)), margin.smallest)
