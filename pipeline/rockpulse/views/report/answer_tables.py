"""Makes the tables of results by model, record and body, and the table of numbers of overturning records."""

from collections.abc import Sequence

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import BodyVerdict, Standing, reasons_unknown, standings
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.model_table import is_upper_bound
from rockpulse.views.report.record_tables import record_label
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import ratio, share
from rockpulse.views.shared.table import Cell, CellMark, Heading, Table
from rockpulse.views.shared.verdict_table import beyond_critical, factor_name, missed_step, none_found
from rockpulse.views.shared.words import body_name, numerals, say

#: Grade of a cell for each result of a body under a record.
_GRADES = {
    Standing.STANDS: "good",
    Standing.UNKNOWN: "unknown",
    Standing.WEAKER_OVERTURNS: "bad",
    Standing.OVERTURNS: "bad",
}


def model_heading(model: str) -> Heading:
    """Return the heading of a column with the results of a model."""
    return Heading(say(f"models.{model}"), note=say("upper_bound") if is_upper_bound(model) else "")


class AnswerCells:
    """Makes table cells for a record or body, given by its index; ``names`` are the cells with record ids."""

    def __init__(self, answers: Answers) -> None:
        self.answers = answers
        self.standing = standings(answers)
        self._why = reasons_unknown(answers)
        self.every = col.AnswerRows.every(answers)
        self.of_models = col.answer_columns(answers)
        self.shown = [
            name
            for name, one in answers.of_models.items()
            if name == answers.model or np.any(one["outcome"] != Outcome.UNRESOLVED)
        ]
        factors = col.columns("factor_10" if answers.probable else "safety_factor")
        self._factors = [row[0] for row in col.filled(factors, self.every)]
        names = col.record_cells(answers.summary)
        self.names = [cell._replace(text=record_label(cell.text)) for cell in names]
        peak = f"θ_max/α_c, {say(f'models.{answers.model}')}"
        self._peak = Heading(say("head.peak"), note=peak)

    @property
    def marks(self) -> set[CellMark]:
        """Marks that appear in the results of the shown models or in the scale factors."""
        tables = (*(self.of_models[name] for name in self.shown), self._factors)
        return col.marks_of(cell for table in tables for cell in table)

    def record(self, record: int) -> Cell:
        """Return a cell with the id of a record and a link to its section."""
        return col.unexplained(self.names[record])._replace(link=f"record-{record}")

    def body(self, lane: int) -> Cell:
        """Return a cell with the name of a body and a link to its section."""
        body = self.answers.bodies[lane]
        return Cell(body.block, link=f"body-{body.place}")

    def verdict(self, record: int, lane: int) -> Cell:
        """Return a cell with the probability of overturning or, if it was not computed, the result as a word."""
        if self.answers.probable:
            (cell,) = self.cells(col.columns("overturning_probability"), [record], [lane])[0]
            return cell
        kind = Standing(int(self.standing[record, lane]))
        resting = kind == Standing.STANDS and self.answers["outcome"][record, lane] == Outcome.AT_REST
        result = say(f"standing.{'at_rest' if resting else kind.name.lower()}")
        why = f": {say(f'unknown.{self._why[record, lane]}')}" if kind == Standing.UNKNOWN else ""
        return Cell(result + why, float(kind), grade=_GRADES[kind])

    def worst(self, record: int) -> int:
        """Return the index of the body that a record is most likely to overturn."""
        table = self.answers["overturning_probability"] if self.answers.probable else self.standing
        return int(np.argmax(np.nan_to_num(table[record])))

    def cells(self, of: Sequence[col.Column], records: Sequence[int], lanes: Sequence[int]) -> list[tuple[Cell, ...]]:
        """Return a row of cells for each record `records[k]` and body `lanes[k]`; `of` are the columns."""
        places = (np.array(one, dtype=int) for one in (records, lanes))
        return col.filled(of, col.AnswerRows(self.answers, *places))

    @property
    def short(self) -> tuple[Heading, ...]:
        """Headings of the cells that :meth:`of` returns."""
        return (*col.headed(col.columns("uplift_ratio")), self._peak, *self.decisive)

    def of(self, record: int, lane: int) -> tuple[Cell, ...]:
        """Return four cells for a body under a record: uplift ratio, largest rotation, result and scale factor."""
        (demand,) = self.cells(col.columns("uplift_ratio"), [record], [lane])[0]
        return demand, self.answer(record, lane), self.verdict(record, lane), self.factor(record, lane)

    @property
    def decisive(self) -> tuple[Heading, Heading]:
        """Headings of the cells that :meth:`verdict` and :meth:`factor` return."""
        probable, factor = self.answers.probable, self.answers.factor
        (last,) = col.headed(col.columns(factor))
        if probable:
            return col.headed(col.columns("overturning_probability"))[0], last._replace(note=say("head.of_record"))
        first = Heading(say("head.answer"), note=say("model.name", name=say(f"models.{self.answers.model}")))
        return first, last._replace(note=factor_name(factor))

    def factor(self, record: int, lane: int) -> Cell:
        """Return a cell with the scale factor at which a record overturns a body."""
        return col.unexplained(self._factors[record * len(self.answers.bodies) + lane])

    def answer(self, record: int, lane: int, model: str = "") -> Cell:
        """Return a cell with the largest rotation divided by alpha_c, or with the outcome, in a model."""
        own = self.of_models[model or self.answers.model]
        return col.unexplained(own[record * len(self.answers.bodies) + lane])._replace(grade="")


def answer_table(cells: AnswerCells) -> Table:
    """Return a table of the results of every model, with one row for each record and body."""
    answers = cells.answers
    first, last = col.columns("restitution"), col.columns("uplift_ratio", "velocity_ratio", "impulse_ratio")
    headings = (
        *(Heading(say(f"head.{name}")) for name in ("record", "body")),
        *(heading._replace(note="") for heading in col.headed(first)),
        *cells.decisive,
        *(Heading(say("head.capacity"), note=name) for name in answers.demands),
        *col.headed(last),
        *map(model_heading, cells.shown),
    )
    capacities = [(answers.ratios(name), answers.proven(name)) for name in answers.demands]
    places = zip(cells.every.records.tolist(), cells.every.lanes.tolist(), strict=True)
    rows = []
    for at, own, asked in zip(places, col.filled(first, cells.every), col.filled(last, cells.every), strict=True):
        bound = bool(answers.bound[at])
        over = (col.factor_cell(float(values[at]), float(proven[at]), bound) for values, proven in capacities)
        of_models = (cells.answer(*at, model) for model in cells.shown)
        decisive = (cells.verdict(*at), cells.factor(*at))
        names = (cells.record(at[0]), cells.body(at[1]))
        rows.append((*names, *own, *decisive, *map(col.unexplained, over), *asked, *of_models))
    return Table("answers", say("caption.answers"), headings, tuple(rows), searched=0)


def count_table(cells: AnswerCells) -> Table:
    """Return a table with the number of unscaled records that overturn each body in each model."""
    answers = cells.answers
    total = len(answers.motions.names)
    counts = [(one.overturnings(), one.unresolved) for one in (answers.of_models[name] for name in cells.shown)]
    rows = []
    for k, body in enumerate(answers.bodies):
        counted = (_count(fallen[k], total, silent[k]) for fallen, silent in counts)
        rows.append((Cell(body_name(body.name), link=f"body-{body.place}"), *counted))
    headings = (Heading(say("head.body")), *map(model_heading, cells.shown))
    names = ", ".join(say(f"models.{name}") for name in answers.models if name not in cells.shown)
    notes = (say("note.without_result", models=names),) if names else ()
    return Table("counts", say("caption.counts"), headings, tuple(rows), notes)


def _count(fallen: int, total: int, silent: int) -> Cell:
    unresolved = say("unresolved", count=silent) if silent else ""
    return Cell(say("count_of", count=fallen, total=total) + unresolved, float(fallen))


def record_table(cells: AnswerCells, record: int) -> Table:
    """Return a table of all bodies under one record, given by its row in /summary."""
    lanes, c = range(len(cells.answers.bodies)), col.columns("restitution")
    own = cells.cells(c, [record] * len(lanes), lanes)
    rows = tuple((cells.body(lane), *own[lane], *cells.of(record, lane)) for lane in lanes)
    headings = (Heading(say("head.body")), *col.headed(c), *cells.short)
    return Table(f"record-{record}-bodies", say("caption.of_record"), headings, rows)


def table_notes(cells: AnswerCells, found: Sequence[BodyVerdict], uncertainty: UncertaintySettings) -> list[str]:
    """Return the notes below the tables, which explain columns, marks and words."""
    answers = cells.answers
    notes = [say("note.figures"), *([say("note.beyond_critical")] if beyond_critical(answers) else [])]
    notes += [*_of_factors(answers, uncertainty), *col.doubt_notes(cells.names)]
    bounds = (name for name in answers.models if is_upper_bound(name))
    notes += [say("note.upper_bound", model=say(f"models.{name}")) for name in bounds]
    margins = [row.margin for one in found for row in one.findings]
    marks = cells.marks | col.marks_of(col.margin_cells(margin)[0] for margin in margins)
    explained = [mark.note for mark in (col.OUTSIDE, col.AT_MOST, col.NO_ANSWER) if mark in marks]
    notes += dict.fromkeys(explained)
    if answers.motions.kind == "pair":
        notes.append(say("note.pair_mean" if answers.motions.any_azimuth else "note.pair_worst"))
    return notes


def _of_factors(answers: Answers, uncertainty: UncertaintySettings) -> list[str]:
    """Return the notes on the scale factors; empty if the results have none."""
    if not answers.has_factor:
        return []
    if answers.probable:
        low, high = map(ratio, (min(uncertainty.restitution), max(uncertainty.restitution)))
        spread, geometry = share(uncertainty.factor), share(uncertainty.geometry)
        stated = say("note.uncertainty", factor=spread, low=low, high=high, geometry=geometry)
        return [f"{say('note.factor_10')} {stated}{none_found(answers)}"]
    of = say("note.of_sequence" if answers.motions.kind == "sequence" else "note.of_record")
    notes = [say("note.factor", of=of, model=say(f"models.{answers.model}")) + none_found(answers)]
    if missed := missed_step(answers):
        notes.append(say("note.step", step=numerals(f"{missed:.1%}")))
    rocks = (answers["outcome"] == Outcome.ROCKS) & (answers[answers.factor] < 1.0)
    if lucky := np.count_nonzero(rocks):
        notes.append(say("note.lucky", count=lucky))
    return notes
