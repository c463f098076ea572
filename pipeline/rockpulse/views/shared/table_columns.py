"""The columns of all tables: each has a heading (section [column] of the texts), variables, and a cell function."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, Self

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Margin
from rockpulse.assessment.verdict import OVERTURNS, Finding, Grade
from rockpulse.readers.kit.channel import CREDIBLE_PEAK_G
from rockpulse.record.defects import DEFECTS
from rockpulse.record.measures import PGA, STORED, STORED_OF_BODIES, Measure
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.formatting import ABSENT, between, lower_bound, ratio, restitution, share, shortened
from rockpulse.views.shared.table import Cell, CellMark, Heading, Table, number_cell
from rockpulse.views.shared.words import say, translated
from rockpulse.warning_text import has_warning

#: Largest width of the id of a record and of the name of a body in a table [characters].
ID_WIDTH, NAME_WIDTH = 36, 29
#: Marks of a rotation, of a scale factor or a capacity, of a drifting baseline, and of a record with doubtful samples.
OUTSIDE, NO_ANSWER = CellMark("outside", "*"), CellMark("no_answer", "!")
NONE_UP_TO, AT_MOST = CellMark("none_up_to", ">", before=True), CellMark("at_most", "≤", before=True)
DRIFT = CellMark("drift", "~", before=True)
PEAK, CLIPPED, DEFECT = CellMark("peak"), CellMark("clipped"), CellMark("defect")
DOUBTS = PEAK, CLIPPED, DEFECT
#: Sort values of outcomes; overturned and unresolved bodies come after all rotations.
_SORTED = {Outcome.AT_REST: 0.0, Outcome.OVERTURNS: math.inf, Outcome.UNRESOLVED: math.nan}


class Rows(Protocol):
    """The values of a table: a mapping from the name of each variable to one value for each row."""

    def __getitem__(self, name: str, /) -> Sequence[Any]: ...


@dataclass(frozen=True)
class Column:
    """A column of a table: the names of its variables, and the function that makes a cell from their values."""

    name: str
    of: tuple[str, ...]
    cell: Callable[..., Cell]
    unit: str = ""
    width: int | None = None  # longer cells are shortened on the terminal
    title: str | None = None  # title instead of the declared one, such as the name of a model
    note: str = ""

    @property
    def heading(self) -> Heading:
        """Heading of the column, with its unit and small print."""
        title = (
            say(f"column.{self.name}.head")
            if self.title is None
            else translated(f"column.{self.name}.head", self.title)
        )
        note = say(f"column.{self.name}.note") if self.name in _NOTED else self.note
        return Heading(title, self.unit, note, self.width)


def titled(title: str, cell: Callable[..., Cell], *of: str, **options: Any) -> Column:
    """Return a column with the given title, for use in a single table."""
    return Column(title, of, cell, title=title, **options)


def tabulated(
    key: str, caption: str, selected: Sequence[Column], dataset: xr.Dataset, notes: tuple[str, ...] = ()
) -> Table:
    """Return a table of variables of a one-dimensional dataset, with a row for every element."""
    rows = {name: dataset[name].values.tolist() for column in selected for name in column.of}
    return Table(key, caption, headed(selected), tuple(filled(selected, rows)), notes)


#: Columns with small print below the heading.
_NOTED = frozenset({"restitution", "overturning_probability"})


def doubt(pga: float, codes: str) -> tuple[CellMark, ...]:
    """Return the marks of a doubtful record, from its PGA [m/s2] (NaN for a sequence) and its warning codes."""
    low, high = (STANDARD_GRAVITY * bound for bound in CREDIBLE_PEAK_G)
    peak = pga < low or pga > high or has_warning(codes, "header_peak")
    found = (peak, has_warning(codes, "clipped", "clipped_crests", "full_scale"), has_warning(codes, *DEFECTS))
    return tuple(mark for mark, marked in zip(DOUBTS, found, strict=True) if marked)


def record_cell(name: str, pga: float, codes: str) -> Cell:
    """Return a cell with the id of a record, and marks if the record is doubtful."""
    return Cell(str(name), marks=doubt(pga, str(codes)))


def record_cells(summary: xr.Dataset) -> list[Cell]:
    """Return, for every record of the group /summary, a cell with its id and marks."""
    return [*map(record_cell, *(summary[name].values.tolist() for name in _RECORD))]


def marked_record(summary: xr.Dataset) -> Callable[[int], Cell]:
    """Return a function that gives a cell from the row of a record; the text of the cell is the id and its marks."""
    cells = record_cells(summary)
    return lambda row: Cell(cells[row].marked)


def answer_cell(outcome: int, peak: float, applicable: int) -> Cell:
    """Return a cell with the largest rotation divided by alpha_c or, if the body overturns, the outcome as a word."""
    marks = (OUTSIDE,) if applicable == 0 else ()
    if outcome in _SORTED:
        kind = Outcome(outcome)
        grade = "bad" if kind == Outcome.OVERTURNS else ""
        return Cell(say(f"answer.{kind.name.lower()}"), _SORTED[kind], marks, grade)
    return Cell(ratio(peak), peak, marks) if outcome == Outcome.ROCKS else Cell(ABSENT, math.nan)


def factor_cell(factor: float, limit: float = math.nan, bound: bool = False, intervals: int = 1) -> Cell:
    """Return the cell of a scale factor; an infinite scale factor is printed as larger than `limit`."""
    marks = ([NO_ANSWER] if bound else []) + ([CellMark(sign=f" ({intervals})")] if intervals > 1 else [])
    if math.isnan(factor):
        return Cell(ABSENT, factor)
    if not math.isinf(factor):
        return Cell(ratio(factor), factor, tuple(marks))
    if math.isnan(limit):
        return Cell(say("answer.none"), factor, tuple(marks))
    whole, point, decimals = lower_bound(limit)[1:].partition(say("decimal"))
    return Cell((whole + point + decimals.rstrip("0")).rstrip(point or " "), factor, (NONE_UP_TO, *marks))


def margin_cells(margin: Margin) -> tuple[Cell, Cell]:
    """Return two cells: the smallest and the median scale factor of a body over the records."""
    values = zip((margin.smallest, margin.median), margin.bounds, strict=True)
    smallest, median = (factor_cell(value, margin.limit, bound) for value, bound in values)
    if margin.open and math.isfinite(margin.smallest):
        smallest = smallest._replace(marks=(AT_MOST, *smallest.marks))
    return smallest, median


def smallest_of(margin: Margin, names: Sequence[str], width: int) -> list[Cell]:
    """Return two cells: the smallest scale factor, and the name of its record, shortened to `width`."""
    if math.isinf(margin.smallest) and (margin.unknown or margin.partial):
        return [factor_cell(math.nan), Cell("")]
    named = shortened(names[margin.place], width) if math.isfinite(margin.smallest) else ""
    return [factor_cell(margin.smallest, margin.limit), Cell(named)]


def unexplained(cell: Cell) -> Cell:
    """Return the cell with marks that add no note below the table."""
    return cell._replace(marks=tuple(CellMark("", mark.text, mark.before) for mark in cell.marks))


def marks_of(cells: Iterable[Cell]) -> set[CellMark]:
    """Return the set of all marks in the cells."""
    return {mark for cell in cells for mark in cell.marks}


def doubt_notes(cells: Iterable[Cell]) -> list[str]:
    """Return the notes that explain the marks of doubtful records in the cells."""
    found = marks_of(cells)
    return [mark.note for mark in DOUBTS if mark in found]


#: Grade of a cell for each verdict.
GRADES = {
    Grade.AT_REST: "good",
    Grade.ROCKS: "good",
    Grade.MAY_OVERTURN: "fair",
    Grade.NO_VERDICT: "unknown",
    Grade.NOT_KNOWN: "unknown",
    Grade.SLIDES_FIRST: "unknown",
    Grade.OVERTURNS: "bad",
}


def grade_cell(found: Finding, before: str = "") -> Cell:
    """Return a cell with the text `before` and the verdict on a body; such cells are sorted from best to worst."""
    # No record overturns it, but half of such earthquakes might: not graded as good, nor as a worse verdict.
    unsure = found.grade == Grade.ROCKS and found.share.high >= OVERTURNS
    verdict = ABSENT if found.grade == Grade.NO_VERDICT else say(f"grade.{found.status}")
    grade = "fair" if found.status == "no_margin" else "" if unsure else GRADES[found.grade]
    return Cell(before + verdict, found.severity, grade=grade)


def _sliding(found: Finding) -> Cell:
    """Return a cell: "slides first", "no", or the largest share of a record's duration in which the body slides."""
    if found.slides_first:
        return Cell(say("slides_first"), 2.0)
    if found.sliding == 0.0:
        return Cell(say("no"), 0.0)
    return Cell(f"<{share(0.01)}" if found.sliding < 0.01 else share(found.sliding), found.sliding)


def formatted(show: Callable[[float], str], scale: float = 1.0) -> Callable[[float], Cell]:
    """Return a function that makes a cell from a number, which is divided by `scale` and then formatted by `show`."""
    return lambda value: number_cell(value if scale == 1.0 else value / scale, show)


def _searched(factor: float, limit: float, resolved: int, intervals: int = 1) -> Cell:
    return factor_cell(factor, limit, resolved == 0, intervals)


def _probability(value: float, low: float, high: float) -> Cell:
    return Cell(ratio(value) if math.isnan(low) else f"{ratio(value)} ({between(low, high, ratio)})", value)


def _capacity(capacity: float, limit: float, pga: float) -> Cell:
    return factor_cell(capacity / STANDARD_GRAVITY, limit * pga / STANDARD_GRAVITY)


def _rotation(ratio_of_angles: float) -> Cell:
    over = math.isinf(ratio_of_angles)
    return Cell(say("answer.overturns") if over else ratio(ratio_of_angles), ratio_of_angles)


def count_of(count: int, total: int) -> Cell:
    """Return a cell with a count out of a total, such as "3 of 7"."""
    return Cell(say("count_of", count=count, total=total), count)


def _counted(codes: str) -> Cell:
    return Cell(str(len(codes.split()) or ""), float(len(codes.split())))


def _restitutions(values: Sequence[float]) -> Cell:
    low, high = restitution(min(values)), restitution(max(values))
    return Cell(low if low == high else say("between", low=low, high=high), min(values))


def _of_measure(row: Measure) -> Column:
    title, unit, scale = row.column
    of = (row.name, f"{row.name}_drift") if row.drifts else (row.name,)

    def cell(value: float, drift: bool = False) -> Cell:
        return number_cell(value / scale, ratio, (DRIFT,) if drift else ())

    return Column(row.name, of, cell, unit, title=title)


_RECORD = ("record", PGA, "warning_codes")
_SEARCHED = ("safety_factor", "safe_up_to", "factor_resolved")
_PROBABILITY = tuple(f"overturning_probability{end}" for end in ("", "_low", "_high"))
#: All columns by name; a column of a single variable has the name of the variable.
COLUMNS = {
    column.name: column
    for column in (
        # a result: a body under a record
        Column("record", _RECORD, lambda *one: record_cell(shortened(one[0], ID_WIDTH), *one[1:])),
        Column("block", ("block",), Cell, width=NAME_WIDTH),
        Column("model", ("model",), lambda name: Cell(say(f"models.{name}"))),
        Column("restitution", ("restitution",), formatted(restitution)),
        *map(_of_measure, STORED_OF_BODIES),
        Column("impulse_ratio", ("impulse_ratio",), formatted(ratio)),
        Column("answer", ("outcome", "peak_rotation_ratio", "applicable"), answer_cell),
        Column("overturning_probability", ("overturning_probability",), formatted(ratio)),
        Column("probability_interval", _PROBABILITY, _probability),
        Column("factor_10", ("factor_10", "factor_10_low"), factor_cell),
        Column("factor_50", ("factor_50", "factor_50_low"), factor_cell),
        Column("factor_mean", ("factor_mean", "factor_mean_low"), factor_cell),
        Column("source", ("source",), lambda word: Cell(word.replace("_", " "))),
        Column("safety_factor", _SEARCHED, _searched),
        Column("safety_intervals", (*_SEARCHED, "interval_count"), _searched),
        Column("capacity_pga", ("capacity_pga", "safe_up_to", PGA), _capacity, "g"),
        # a record
        *map(_of_measure, STORED),
        Column("main_impulse", ("main_impulse",), formatted(ratio), "m/s"),
        Column("magnitude", ("magnitude",), number_cell),
        Column("epicentral_distance", ("epicentral_distance",), lambda distance: number_cell(distance / 1000.0), "km"),
        Column("warnings", ("warning_codes",), _counted),
        Column("overturns", ("fallen", "total"), count_of),
        # a block
        Column("width", ("width",), formatted(ratio), "m"),
        Column("height", ("height",), formatted(ratio), "m"),
        Column("alpha_c", ("alpha_c",), formatted(ratio), "rad"),
        Column("p", ("p",), formatted(ratio), "1/s"),
        Column("critical_impulse", ("critical_impulse",), formatted(ratio), "m/s"),
        Column("restitutions", ("restitutions",), _restitutions),
        Column("overturned_by", ("fallen", "total"), count_of),
        # the verdict on a body over all records, and the worst body of a record
        Column("at_demand", ("demand",), Cell),
        Column("verdict", ("found",), grade_cell),
        Column("probability", ("value",), formatted(ratio)),
        Column("share", ("value",), formatted(ratio)),
        Column("probability_upper", ("high",), formatted(ratio)),
        Column("capacity", ("margin",), lambda margin: unexplained(margin_cells(margin)[0])),
        Column("smallest_factor_10", ("margin",), lambda margin: unexplained(margin_cells(margin)[0])),
        Column("smallest_safety_factor", ("margin",), lambda margin: unexplained(margin_cells(margin)[0])),
        Column("median_rotation", ("median",), _rotation, "θ/α_c"),
        Column("others_rotation", ("others",), formatted(ratio), "θ/α_c"),
        Column("top_displacement", ("top",), formatted(ratio), "cm"),
        Column("sliding", ("found",), _sliding),
        Column("uplift", ("uplift",), formatted(ratio, STANDARD_GRAVITY), "g"),
        Column("governing", ("governing",), lambda cell: cell),
        Column("worst_for", ("worst_for",), Cell),
    )
}


def columns(*names: str, **titles: str) -> tuple[Column, ...]:
    """Return the columns with the given names; `titles` replaces the titles of some of them."""
    return tuple(replace(COLUMNS[name], title=titles.get(name) or COLUMNS[name].title) for name in names)


def headed(selected: Iterable[Column]) -> tuple[Heading, ...]:
    """Return the headings of the columns."""
    return tuple(column.heading for column in selected)


def filled(selected: Iterable[Column], rows: Rows) -> list[tuple[Cell, ...]]:
    """Return the cells of the columns, one tuple for each row."""
    made = [[column.cell(*one) for one in zip(*(rows[name] for name in column.of), strict=True)] for column in selected]
    return list(zip(*made, strict=True))


class AnswerRows:
    """The results of one model as rows of a table; a row is given by the indices of a record and a body."""

    def __init__(self, answers: Answers, records: np.ndarray, lanes: np.ndarray) -> None:
        self.answers, self.records, self.lanes = answers, records, lanes

    @classmethod
    def every(cls, answers: Answers) -> Self:
        """Return the rows of all bodies under the first record, then under the second, and so on."""
        records, lanes = np.indices((len(answers.records), len(answers.bodies)))
        return cls(answers, records.ravel(), lanes.ravel())

    def __getitem__(self, name: str) -> Sequence[Any]:
        answers = self.answers
        if name == "restitution":
            return [answers.bodies[lane].restitution for lane in self.lanes]
        if name == "block":
            return [answers.bodies[lane].block for lane in self.lanes]
        if name == "record":
            return [answers.records[record] for record in self.records]
        table = answers.source if name == "source" else answers[name]
        found: list[Any] = (table[self.records] if table.ndim == 1 else table[self.records, self.lanes]).tolist()
        return found


def answer_columns(answers: Answers) -> dict[str, list[Cell]]:
    """Return, for each model, the cells with its results, in the order of :meth:`AnswerRows.every`."""
    own, models = [COLUMNS["answer"]], answers.of_models.items()
    return {name: [row[0] for row in filled(own, AnswerRows.every(one))] for name, one in models}


def factor_columns(answers: Answers) -> tuple[Column, ...]:
    """Return the columns of probability and scale factor of overturning; empty if the results have none."""
    if not answers.has_factor:
        return ()
    return columns("overturning_probability", "factor_10") if answers.probable else columns("safety_factor")
