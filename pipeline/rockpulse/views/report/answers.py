"""The answers of every model for every record and body, as cells; and how often each body overturns."""

from __future__ import annotations

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import Standing, standings, why_unknown
from rockpulse.model_table import UPPER_BOUND, is_upper_bound
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.answer_cells import (
    NAMES,
    TITLES,
    answer_cells,
    factor_cell,
    factor_cells,
    marks_of,
    unexplained,
)
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Mark, Table, number
from rockpulse.views.shared.terminal import ratio, restitution

__all__ = ["AnswerCells", "answer_table", "count_table", "model_column", "record_table"]

#: Demand of a record on a body.
DEMANDS = ("uplift_ratio", "velocity_ratio", "impulse_ratio")

#: The grade of the cell with the answer for a body under a record.
_GRADES = {
    Standing.STANDS: "fair",
    Standing.UNKNOWN: "unknown",
    Standing.WEAKER_OVERTURNS: "bad",
    Standing.OVERTURNS: "bad",
}


def model_column(words: Words, model: str) -> Heading:
    """The heading of a column of a model."""
    return Heading(words.shared(model), note=words.shared(UPPER_BOUND) if is_upper_bound(model) else "")


class AnswerCells:
    """Cells of every record and body, whose marks the notes of the page explain.

    ``names`` are the ids of the records, marked where their peak is doubtful.
    """

    def __init__(self, words: Words, answers: Answers) -> None:
        self.words, self.answers = words, answers
        self.standing = standings(answers)
        self._why = why_unknown(answers)
        self._of_models = {model: answer_cells(one) for model, one in answers.of_models.items()}
        self._factors = factor_cells(answers)
        self._capacities = [(answers.ratios(name), answers.proven(name)) for name in answers.demands]
        self.names = record_cells(answers.summary)

    @property
    def marks(self) -> set[Mark]:
        """The marks of the answers of all models, and of the factors of the one that is counted."""
        tables = (*self._of_models.values(), self._factors)
        return marks_of(cell for table in tables for row in table for cell in row)

    def record(self, record: int) -> Cell:
        """The id of a record, which leads to its part of the page."""
        return unexplained(self.names[record])._replace(link=f"record-{record}")

    def verdict(self, record: int, lane: int) -> Cell:
        """The probability of overturning under a record, which is a number; else the answer of the model in words.

        It is sorted from best to worst.
        """
        if self.answers.probable:
            return number(float(self.answers["overturning_probability"][record, lane]), ratio)
        kind = Standing(int(self.standing[record, lane]))
        resting = kind == Standing.STANDS and self.answers["outcome"][record, lane] == Outcome.AT_REST
        told = self.words(f"standing.{'at_rest' if resting else kind.name.lower()}")
        why = f": {self.words.shared(self._why[record, lane])}" if kind == Standing.UNKNOWN else ""
        return Cell(told + why, float(kind), grade=_GRADES[kind])

    def worst(self, record: int) -> int:
        """The place of the body for which a record is worst."""
        table = self.answers["overturning_probability"] if self.answers.probable else self.standing
        return int(np.argmax(np.nan_to_num(table[record])))

    @property
    def columns(self) -> tuple[Heading, ...]:
        """The headings of :meth:`of`."""
        peak = f"θ_max/α_c, {self.words.shared(self.answers.model)}"
        return (
            Heading("a/a_up", note=self.words("head.over_uplift")),
            Heading(self.words("head.peak"), note=peak),
            *self.headings,
        )

    def of(self, record: int, lane: int) -> tuple[Cell, ...]:
        """A body under a record in short: demand, peak, answer and factor."""
        demand, answer = self.demand("uplift_ratio", record, lane), self.answer(record, lane)
        return demand, answer, self.verdict(record, lane), self.factor(record, lane)

    @property
    def headings(self) -> tuple[Heading, Heading]:
        """Of the columns of :meth:`verdict` and :meth:`factor`."""
        words, probable, factor = self.words, self.answers.probable, self.answers.factor
        first = Heading("P", note=words("head.overturning"))
        if not probable:
            first = Heading(words("head.answer"), note=words.shared(self.answers.model))
        note = words("head.of_record") if probable else words.shared(NAMES[factor])
        return first, Heading(words.shared(TITLES[factor]), note=note)

    def factor(self, record: int, lane: int) -> Cell:
        """The factor, marked where it is a lower bound."""
        return unexplained(self._factors[record][lane])

    def capacities(self, record: int, lane: int) -> list[Cell]:
        """Capacity over every demand; none without a demand."""
        bound = bool(self.answers.bound[record, lane])
        at = record, lane
        found = (factor_cell(float(ratios[at]), float(proven[at]), bound) for ratios, proven in self._capacities)
        return [*map(unexplained, found)]

    def demand(self, name: str, record: int, lane: int) -> Cell:
        """One of :data:`DEMANDS`."""
        return number(float(self.answers[name][record, lane]), ratio)

    def answer(self, record: int, lane: int, model: str = "") -> Cell:
        """The answer of a model, the counted one unless named: the largest rotation over alpha_c, or a word."""
        return unexplained(self._of_models[model or self.answers.model][record][lane])._replace(grade="")


def answer_table(cells: AnswerCells) -> Table:
    """Every record, body and model in one table."""
    words, answers = cells.words, cells.answers
    headings = (
        Heading(words("head.record")),
        Heading(words("head.body")),
        Heading("C"),
        *cells.headings,
        *(Heading(words("head.capacity"), note=name) for name in answers.demands),
        Heading("a/a_up", note=words("head.over_uplift")),
        Heading("p PGV/ (g tan α)"),
        Heading("I/I_1c"),
        *(model_column(words, model) for model in answers.models),
    )
    rows = tuple(
        (
            cells.record(record),
            Cell(body.block, link=f"body-{body.place}"),
            number(body.restitution, restitution),
            cells.verdict(record, lane),
            cells.factor(record, lane),
            *cells.capacities(record, lane),
            *(cells.demand(key, record, lane) for key in DEMANDS),
            *(cells.answer(record, lane, model) for model in answers.models),
        )
        for record in range(len(cells.names))
        for lane, body in enumerate(answers.bodies)
    )
    return Table("answers", words("caption.answers"), headings, rows, searched=0)


def count_table(words: Words, answers: Answers) -> Table:
    """Numbers of motions that overturn every body, by every model, as they are, in one of their directions."""
    total = len(answers.motions.names)
    counts = [(one.overturnings(), one.unresolved) for one in answers.of_models.values()]
    rows = tuple(
        (
            Cell(body.name, link=f"body-{body.place}"),
            *(_count(words, fallen[k], total, silent[k]) for fallen, silent in counts),
        )
        for k, body in enumerate(answers.bodies)
    )
    headings = (Heading(words("head.body")), *(model_column(words, model) for model in answers.models))
    return Table("counts", words("caption.counts"), headings, rows)


def record_table(cells: AnswerCells, record: int) -> Table:
    """Every body under one record, a row of /summary, by the model that is counted."""
    words = cells.words
    headings = (
        Heading(words("head.body")),
        Heading("C", note=words("head.restitution")),
        *cells.columns,
    )
    rows = tuple(
        (
            Cell(body.block, link=f"body-{body.place}"),
            number(body.restitution, restitution),
            *cells.of(record, lane),
        )
        for lane, body in enumerate(cells.answers.bodies)
    )
    return Table(f"record-{record}-bodies", words("caption.of_record"), headings, rows)


def _count(words: Words, fallen: int, total: int, silent: int) -> Cell:
    unresolved = words("unresolved", count=silent) if silent else ""
    return Cell(words("count_of", count=fallen, total=total) + unresolved, float(fallen))
