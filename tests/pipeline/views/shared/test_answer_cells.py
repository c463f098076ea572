"""Answers as cells: what bears which mark."""

import math

from report_cases import answers, motions, probable, summary_of

from rocking.response import Outcome
from rockpulse.views.shared.answer_cells import (
    AT_MOST,
    answer_cell,
    answer_cells,
    factor_cell,
    factor_columns,
    margin_cells,
    marks_of,
    safety_cells,
    unexplained,
)
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO, OUTSIDE


def test_words_bear_the_marks_of_the_answer_and_are_sorted_beside_the_figures():
    cell = answer_cell(Outcome.OVERTURNS, math.inf, applicable=0)
    assert (cell.text, cell.value, cell.grade) == ("overturns", math.inf, "bad")
    assert cell.marks == (OUTSIDE,)
    assert answer_cell(Outcome.AT_REST, 0.0, 1).value == 0.0
    assert math.isnan(answer_cell(Outcome.UNRESOLVED, math.nan, 1).value)
    assert answer_cell(-1, math.nan, 0).marked == "-"


def test_a_factor_that_was_not_found_names_how_far_was_searched():
    assert [factor_cell(math.inf, limit).marked for limit in (10.0, 12.37, 0.0, math.nan)] == [
        ">10",
        ">12.3",
        ">0",
        "none",
    ]
    assert marks_of([factor_cell(math.inf, 10.0), factor_cell(1.2, bound=True), factor_cell(math.nan, 1.0, True)]) == {
        NONE_UP_TO,
        NO_ANSWER,
    }


def test_several_intervals_are_counted():
    summary = summary_of([0.84, 2.0])
    summary["interval_count"] = summary["outcome"] * 0 + 3
    assert [row[0].marked for row in safety_cells(answers(summary))] == ["0.84 (3)", "2.00 (3)"]
    assert [row[0].text for row in answer_cells(answers(summary))] == ["overturns", "0.40"]


def test_columns_of_probability_stand_in_place_of_those_of_safety_factors():
    columns = factor_columns(answers(probable([0.0, 0.0004, 0.412], factor_10=[math.inf, 2.0, math.nan])))
    shown = {name: [row[0].marked for row in cells] for name, cells in columns.items()}
    assert shown == {"P": ["0", "<0.001", "0.41"], "factor of 10 %": [">10", "2.00", "-"]}
    assert list(factor_columns(answers(summary_of([2.0])))) == ["SF"]
    assert factor_columns(answers(summary_of([math.nan]))) == {}


def test_the_smallest_of_a_pair_with_a_lost_direction_is_at_most_that():
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    (margin,) = answers(summary_of([0.4, 0.9, 2.0, 3.0], resolved=[0, 1, 1, 1]), of).margins()
    smallest, median = margin_cells(margin)
    assert (smallest.marked, median.marked) == ("≤0.40!", "2.00")
    assert smallest.marks == (AT_MOST, NO_ANSWER)
    assert (unexplained(smallest).marked, {mark.note for mark in unexplained(smallest).marks}) == ("≤0.40!", {""})
    (margin,) = answers(summary_of([math.inf] * 4), of).margins()
    assert margin_cells(margin)[0].marked == ">10"
