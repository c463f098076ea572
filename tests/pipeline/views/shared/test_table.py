import math

import pytest

from rockpulse.views.shared.formatting import ratio
from rockpulse.views.shared.table import Cell, CellMark, Heading, Table, lines, number_cell, table_text

FAR, LEAST, ODD = CellMark("beyond", "!"), CellMark("none_up_to", ">", before=True), CellMark("peak")
HEADINGS = (Heading("wall", width=9), Heading("median", "m/s"), Heading("verdict"))


def table(*rows, **more):
    return Table("walls", "Every wall", HEADINGS, rows, **more)


def test_numbers_are_flush_right_with_hanging_marks_and_words_flush_left():
    made = table(
        (Cell("a wall of a long name", marks=(ODD,)), number_cell(0.412, ratio, (FAR,)), Cell("stands")),
        (Cell("b"), number_cell(24.6, ratio, (LEAST,)), Cell("overturns", 1.0, grade="bad")),
    )
    assert lines(made) == [
        "                   median",
        "wall                [m/s]     verdict",
        "a wa…name (peak?)    0.41!     stands",
        "b                   >24.6   OVERTURNS",
    ]


def test_only_marks_that_occur_are_explained_and_each_once_behind_the_footnotes():
    rows = (
        (Cell("a"), number_cell(0.4, ratio, (FAR,)), Cell("")),
        (Cell("b", marks=(ODD,)), number_cell(0.5, ratio, (FAR,)), Cell("")),
    )
    made = table(*rows, footnotes=("Of the wall.",))
    assert made.notes == ("Of the wall.", FAR.note, ODD.note)
    assert table_text(made).splitlines()[0] == "Every wall"
    assert table_text(made).splitlines()[5:7] == ["  Of the wall.", f"  {FAR.note}"]


def test_an_absent_number_bears_no_mark_and_is_sorted_last():
    absent = number_cell(None, ratio, (FAR,))
    assert (absent.text, absent.marks) == ("-", ())
    assert math.isnan(absent.value)
    made = table((Cell("a"), number_cell(1.0), Cell("safe", 0.0, grade="good")))
    assert made.numeric == (False, True, True)
    assert made.flush_right == (False, True, False)


def test_a_table_without_rows_shows_its_headings():
    assert lines(table()) == ["      median", "wall  [m/s]   verdict"]
    with pytest.raises(ValueError, match="table walls: row 1: expected 3 cells"):
        table((Cell("a"), Cell("b"), Cell("c")), (Cell("a"),))
