"""What every model answers for every record and body, as cells; and how often each overturns."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome
from rockpulse.ladder import UPPER_BOUND
from rockpulse.views.report.motions import Motions
from rockpulse.views.report.standing import GRADES, WORDS, Body, Standing, lanes, standings, why_unknown
from rockpulse.views.shared.record_marks import doubts
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, ratio, restitution
from rockpulse.views.shared.verdict_notes import MARKED
from rockpulse.views.text.capacity import factor_cell

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Answers", "answer_table", "count_table", "model_column", "record_table"]

#: Demand of a record on a body.
DEMANDS = ("uplift_ratio", "velocity_ratio", "impulse_ratio")

_WORDS = {Outcome.AT_REST: "at rest", Outcome.OVERTURNS: "overturns", Outcome.UNRESOLVED: "unresolved"}

#: Larger than any rotation: overturned sorts above it, unresolved at the end.
_SORTED = {Outcome.AT_REST: 0.0, Outcome.OVERTURNS: math.inf, Outcome.UNRESOLVED: math.nan}


def model_column(model: str) -> Heading:
    """The heading of a column of a model.

    Parameters
    ----------
    model : str
        Its name.
    """
    return Heading(model, note=UPPER_BOUND if model == "resonance" else "")


class Answers:
    """Cells of every record and body.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    bodies : list of Body
        Which.
    model : str
        Whose answers are counted in the verdict.

    Attributes
    ----------
    names : list of str
        Ids of the records, with the marks of those whose peak is doubtful.
    """

    def __init__(self, summary: xr.Dataset, bodies: list[Body], model: str) -> None:
        self.summary, self.bodies, self.model = summary, bodies, model
        self.models = [str(name) for name in summary["model"].values]
        self.standing = standings(summary, bodies, model)
        self._why = why_unknown(summary, bodies, model)
        self._of_model = {name: self._answers_of(name) for name in self.models}
        self._factor = lanes(summary, "safety_factor", bodies, model)
        self._count = lanes(summary, "interval_count", bodies, model)
        self._resolved = lanes(summary, "factor_resolved", bodies, model)
        self._limit = lanes(summary, "safe_up_to", bodies, model)
        self._capacity = lanes(summary, "capacity_ratio", bodies, model)
        marks = doubts(summary)
        self.names = [str(name) + marks[str(name)] for name in summary["record"].values]
        self._demand = {name: lanes(summary, name, bodies) for name in DEMANDS}

    def verdict(self, record: int, lane: int) -> Cell:
        """How a body stands under a record, sorted from best to worst."""
        kind = Standing(int(self.standing[record, lane]))
        why = f": {self._why[record, lane]}" if kind == Standing.UNKNOWN else ""
        if kind == Standing.STANDS and self.outcomes(self.model)[record, lane] == Outcome.AT_REST:
            why = ", not lifted"  # says little of a stronger record
        return Cell(WORDS[kind] + why, float(kind), grade=GRADES[kind])

    def factor(self, record: int, lane: int) -> Cell:
        """The safety factor, marked where it is a lower bound, with the number of intervals that overturn."""
        if self._factor is None:
            return Cell(ABSENT, math.nan)
        count = None if self._count is None else int(self._count[record, lane])
        resolved = None if self._resolved is None else int(self._resolved[record, lane])
        value = float(self._factor[record, lane])
        limit = None if self._limit is None else float(self._limit[record, lane])
        return Cell(factor_cell(value, count, resolved, limit), value)

    def capacities(self, record: int, lane: int) -> list[Cell]:
        """Capacity over every demand; none without a demand."""
        if self._capacity is None:
            return []
        resolved = None if self._resolved is None else int(self._resolved[record, lane])
        limits = np.full(self._capacity.shape[2], np.nan)
        if self._limit is not None:
            strength = self._limit[record, lane] * self.summary["pga"].values[record]
            limits = strength / self.summary["demand_acceleration"].values
        values = zip(self._capacity[record, lane].tolist(), limits.tolist(), strict=True)
        return [Cell(factor_cell(value, None, resolved, limit), value) for value, limit in values]

    def demand(self, name: str, record: int, lane: int) -> Cell:
        """One of :data:`DEMANDS`."""
        table = self._demand[name]
        return number(None if table is None else float(table[record, lane]), ratio)

    def answer(self, model: str, record: int, lane: int) -> Cell:
        """What a model answers: the largest rotation over alpha_c, or a word."""
        outcome, peak, used, predictable, applicable = (table[record, lane] for table in self._of_model[model])
        shown = MARKED.get(str(used), ratio) if model == "auto" else ratio
        words = _WORDS.get(Outcome(int(outcome)), "") or shown(float(peak))
        marks = ("?" if predictable == 0 else "") + ("*" if applicable == 0 else "")
        return Cell(words + marks, _SORTED.get(Outcome(int(outcome)), float(peak)))

    def outcomes(self, model: str) -> np.ndarray:
        """(records, bodies) :class:`~rocking.response.Outcome` by a model."""
        return self._of_model[model][0]

    def marked(self) -> set[str]:
        """Which marks occur in the cells: `?`, `*`, `~`, `!`."""
        found = set()
        for _, _, _, predictable, applicable in self._of_model.values():
            found |= {"?"} if np.any(predictable == 0) else set()
            found |= {"*"} if np.any(applicable == 0) else set()
        if "auto" in self._of_model:
            outcome, _, used, _, _ = self._of_model["auto"]
            found |= {"~"} if np.any(np.isin(used, list(MARKED)) & (outcome == Outcome.ROCKS)) else set()
        return found | ({"!"} if self._resolved is not None and np.any(self._resolved == 0) else set())

    def _answers_of(self, model: str) -> tuple[np.ndarray, ...]:
        outcome, peak = (lanes(self.summary, name, self.bodies, model) for name in ("outcome", "peak_rotation_ratio"))
        assert outcome is not None
        assert peak is not None
        flags = [lanes(self.summary, name, self.bodies, model) for name in ("predictable", "applicable")]
        marks = [np.ones(outcome.shape, dtype=int) if flag is None else flag for flag in flags]
        return (outcome, peak, self._used(model, outcome.shape), *marks)

    def _used(self, model: str, shape: tuple[int, ...]) -> np.ndarray:
        codes = lanes(self.summary, "model_used", self.bodies, model)
        if codes is None:
            return np.full(shape, model, dtype=object)
        attributes = self.summary["model_used"].attrs
        names = dict(zip(attributes["flag_values"].tolist(), attributes["flag_meanings"].split(), strict=True))
        return np.array([names[code] for code in codes.ravel().tolist()], dtype=object).reshape(shape)


def answer_table(answers: Answers) -> Table:
    """Every record, body and model in one table.

    Parameters
    ----------
    answers : Answers
        The cells.
    """
    demands = [str(name) for name in answers.summary["demand"].values] if "demand" in answers.summary.dims else []
    headings = (
        Heading("record"),
        Heading("body"),
        Heading("C"),
        Heading("verdict", note=answers.model),
        Heading("SF", note="safety factor"),
        *(Heading("capacity/ demand", note=name) for name in demands),
        Heading("a/a_up", note="PGA over uplift"),
        Heading("p PGV/ (g tan α)"),
        Heading("I/I_1c"),
        *(model_column(model) for model in answers.models),
    )
    rows = []
    for record, name in enumerate(answers.names):
        for lane, body in enumerate(answers.bodies):
            rows.append(
                (
                    Cell(name, link=f"record-{record}"),
                    Cell(body.block, link=f"body-{body.place}"),
                    Cell(restitution(body.restitution), body.restitution),
                    answers.verdict(record, lane),
                    answers.factor(record, lane),
                    *answers.capacities(record, lane),
                    *(answers.demand(key, record, lane) for key in DEMANDS),
                    *(answers.answer(model, record, lane) for model in answers.models),
                )
            )
    caption = "Every record on every body: largest rotation over the critical angle, by model"
    return Table("answers", caption, headings, tuple(rows), searched=0)


def count_table(answers: Answers, motions: Motions) -> Table:
    """How many motions overturn every body, by every model, as they are.

    Parameters
    ----------
    answers : Answers
        The cells.
    motions : Motions
        What is counted: a motion overturns where one of its directions does.
    """
    headings = (Heading("body"), *map(model_column, answers.models))
    total = len(motions.names)
    rows = []
    for lane, body in enumerate(answers.bodies):
        cells = [Cell(body.name, link=f"body-{body.place}")]
        for model in answers.models:
            outcome = answers.outcomes(model)[:, lane]
            fallen = sum(bool(np.any(outcome[rows_of] == Outcome.OVERTURNS)) for rows_of in motions.rows)
            silent = sum(bool(np.any(outcome[rows_of] == Outcome.UNRESOLVED)) for rows_of in motions.rows)
            more = f", {silent} unresolved" if silent else ""
            cells.append(Cell(f"{fallen} of {total}{more}", float(fallen)))
        rows.append(tuple(cells))
    caption = "How many overturn the body as they are, by each model"
    return Table("counts", caption, headings, tuple(rows))


def record_table(answers: Answers, record: int) -> Table:
    """Every body under one record, by the model that is counted.

    Parameters
    ----------
    answers : Answers
        The cells.
    record : int
        Row of /summary.
    """
    headings = (
        Heading("body"),
        Heading("C", note="restitution"),
        Heading("a/a_up", note="PGA over uplift"),
        Heading("peak", note=f"θ_max/α_c, {answers.model}"),
        Heading("SF", note="safety factor"),
        Heading("verdict", note=answers.model),
    )
    rows = tuple(
        (
            Cell(body.block, link=f"body-{body.place}"),
            Cell(restitution(body.restitution), body.restitution),
            answers.demand("uplift_ratio", record, lane),
            answers.answer(answers.model, record, lane),
            answers.factor(record, lane),
            answers.verdict(record, lane),
        )
        for lane, body in enumerate(answers.bodies)
    )
    return Table(f"record-{record}-bodies", "The bodies under this record", headings, rows)
