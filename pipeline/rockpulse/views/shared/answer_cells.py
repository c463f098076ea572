"""Answers as cells of a table: what a model says of a body under a record, its probability of overturning, a factor."""

from __future__ import annotations

import math
from collections.abc import Iterable

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Margin
from rockpulse.views.shared.table import Cell, Mark, number
from rockpulse.views.shared.terminal import ABSENT, lower_bound, ratio
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO, OUTSIDE

__all__ = [
    "AT_MOST",
    "NAMES",
    "TITLES",
    "answer_cell",
    "answer_cells",
    "factor_cell",
    "factor_cells",
    "factor_columns",
    "margin_cells",
    "marks_of",
    "safety_cells",
    "unexplained",
]

#: What the factors are called in a sentence, and in the heading of a column.
NAMES = {"safety_factor": "safety factor", "factor_10": "factor of 10 %"}
TITLES = {
    "safety_factor": "SF",
    "factor_10": "factor of 10 %",
    "factor_50": "of 50 %",
    "capacity_mean": "mean capacity",
}

#: Before a smallest factor that may be smaller.
AT_MOST = Mark("≤", "≤: may be less, for a direction has no answer; left out of the median.", before=True)

_WORDS = {Outcome.AT_REST: "at rest", Outcome.OVERTURNS: "overturns", Outcome.UNRESOLVED: "unresolved"}

#: Larger than any rotation: overturned sorts above it, unresolved at the end.
_SORTED = {Outcome.AT_REST: 0.0, Outcome.OVERTURNS: math.inf, Outcome.UNRESOLVED: math.nan}


def answer_cell(outcome: int, peak: float, applicable: int) -> Cell:
    """The answer of a model: the largest rotation over alpha_c, or a word, with its marks.

    Examples
    --------
    >>> answer_cell(1, 0.4123, applicable=1).marked, answer_cell(2, 0.4, 0).marked
    ('0.41', 'overturns*')
    """
    marks = (OUTSIDE,) if applicable == 0 else ()
    if outcome in _WORDS:
        kind = Outcome(outcome)
        return Cell(_WORDS[kind], _SORTED[kind], marks, grade="bad" if kind == Outcome.OVERTURNS else "")
    if outcome != Outcome.ROCKS:
        return Cell(ABSENT, math.nan)
    return Cell(ratio(peak), peak, marks)


def answer_cells(answers: Answers) -> list[list[Cell]]:
    """Of every record the cells of all bodies, by the model of the answers."""
    tables = [answers[name].tolist() for name in ("outcome", "peak_rotation_ratio", "applicable")]
    return [[answer_cell(*each) for each in zip(*rows, strict=True)] for rows in zip(*tables, strict=True)]


def factor_cells(answers: Answers, name: str = "") -> list[list[Cell]]:
    """Of every record the factors on all bodies: those that the answers tell their margins by, or others by name."""
    name = name or answers.factor
    limits = answers.proven() if name == answers.factor else answers[f"{name}_low"]
    tables = (answers[name], limits, answers.bound)
    return [
        [factor_cell(*one) for one in zip(*rows, strict=True)]
        for rows in zip(*(table.tolist() for table in tables), strict=True)
    ]


def safety_cells(answers: Answers) -> list[list[Cell]]:
    """Of every record the safety factors on all bodies; where intervals of overturning are several, their number."""
    names = ("safety_factor", "safe_up_to", "factor_resolved", "interval_count")
    return [
        [
            factor_cell(factor, limit, resolved == 0, (Mark(f" ({count})", ""),) if count > 1 else ())
            for factor, limit, resolved, count in zip(*rows, strict=True)
        ]
        for rows in zip(*(answers[name].tolist() for name in names), strict=True)
    ]


def factor_columns(answers: Answers) -> dict[str, list[list[Cell]]]:
    """The columns of a table that tell how near to overturning a body is; none where that is not known."""
    if not answers.told:
        return {}
    if not answers.probable:
        return {TITLES["safety_factor"]: factor_cells(answers)}
    probability = [[number(one, ratio) for one in row] for row in answers["overturning_probability"].tolist()]
    return {"P": probability, TITLES["factor_10"]: factor_cells(answers)}


def factor_cell(factor: float, limit: float = math.nan, bound: bool = False, more: tuple[Mark, ...] = ()) -> Cell:
    """A factor, or a capacity over demand: marked where it is a lower bound, and with more marks.

    `limit` says how far was searched where none was found.

    Examples
    --------
    >>> [factor_cell(factor, 10.0).marked for factor in (1.31, math.inf)]
    ['1.31', '>10']
    >>> factor_cell(1.31, bound=True).marked, factor_cell(math.nan).marked, factor_cell(math.inf).marked
    ('1.31!', '-', 'none')
    """
    marks = ([NO_ANSWER] if bound else []) + [*more]
    if math.isnan(factor):
        return Cell(ABSENT, factor)
    if not math.isinf(factor):
        return Cell(ratio(factor), factor, tuple(marks))
    if math.isnan(limit):
        return Cell("none", factor, tuple(marks))
    shown = lower_bound(limit).removeprefix(NONE_UP_TO.sign)
    return Cell(shown.rstrip("0").rstrip(".") if "." in shown else shown, factor, (NONE_UP_TO, *marks))


def margin_cells(margin: Margin) -> tuple[Cell, Cell]:
    """The smallest and the median of a margin."""
    smallest, median = (
        factor_cell(value, margin.limit, bound)
        for value, bound in zip((margin.smallest, margin.median), margin.bounds, strict=True)
    )
    if margin.open and math.isfinite(margin.smallest):
        smallest = smallest._replace(marks=(AT_MOST, *smallest.marks))
    return smallest, median


def unexplained(cell: Cell) -> Cell:
    """The cell with marks whose meaning is told elsewhere than below its table."""
    return cell._replace(marks=tuple(mark._replace(note="") for mark in cell.marks))


def marks_of(cells: Iterable[Cell]) -> set[Mark]:
    """The marks that some cells bear."""
    return {mark for cell in cells for mark in cell.marks}
