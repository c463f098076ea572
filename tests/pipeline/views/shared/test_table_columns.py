"""Columns: each is declared once, shows its values alike everywhere, and marks what is not as it seems."""

import math
import re
from pathlib import Path

import numpy as np
from report_cases import answers, motions, summary_of

import rockpulse
from rocking.response import Outcome
from rockpulse.readers.kit.channel import build_record
from rockpulse.readers.source import SourceFile
from rockpulse.storage.export.row_selection import SHOWN
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.table import Cell, CellMark
from rockpulse.warning_text import with_codes


def shown(of, *names):
    """The cells of some columns, as text with their marks, of every answer."""
    return [[cell.marked for cell in row] for row in col.filled(col.columns(*names), col.AnswerRows.every(of))]


def test_no_column_is_declared_twice():
    """Nor is one made beside the table: a function or a variable of it makes every Column."""
    source = Path(rockpulse.__file__).parent / "views" / "shared" / "table_columns.py"
    declared = re.findall(r'\bColumn\(\s*"(\w+)"', source.read_text(encoding="utf-8"))
    assert len(declared) == len(set(declared)) > 20
    assert set(declared) <= set(col.COLUMNS)
    declared = {column.name: (column.heading.label, column.of) for column in col.COLUMNS.values()}
    assert len(set(declared.values())) == len(declared)


def test_a_condition_knows_a_column_by_its_heading():
    stored = [column for column in col.COLUMNS.values() if column.name in SHOWN.values()]
    assert len(stored) > 8
    known = {column.name: SHOWN.get(column.heading.title, column.name) for column in stored}
    assert {name: of for name, of in known.items() if name != of} == {}


def test_words_bear_the_marks_of_the_answer_and_are_sorted_beside_the_figures():
    cell = col.answer_cell(Outcome.OVERTURNS, math.inf, applicable=0)
    assert (cell.text, cell.value, cell.grade) == ("overturns", math.inf, "bad")
    assert cell.marks == (col.OUTSIDE,)
    assert col.answer_cell(Outcome.AT_REST, 0.0, 1).value == 0.0
    assert math.isnan(col.answer_cell(Outcome.UNRESOLVED, math.nan, 1).value)
    assert col.answer_cell(-1, math.nan, 0).marked == "-"


def test_a_factor_names_how_far_was_searched_and_several_intervals_are_counted():
    found = [col.factor_cell(math.inf, limit).marked for limit in (10.0, 12.37, 0.0, math.nan)]
    assert found == [">10", ">12.3", ">0", "none"]
    cells = [col.factor_cell(math.inf, 10.0), col.factor_cell(1.2, bound=True), col.factor_cell(math.nan, 1.0, True)]
    assert col.marks_of(cells) == {col.NONE_UP_TO, col.NO_ANSWER}
    summary = summary_of([0.84, 2.0])
    summary["interval_count"] = summary["outcome"] * 0 + 3
    assert shown(answers(summary), "safety_intervals", "answer") == [["0.84 (3)", "overturns"], ["2.00 (3)", "0.40"]]


def test_the_smallest_of_a_pair_with_a_lost_direction_is_at_most_that():
    of = motions(4, rows=[[0, 1], [2, 3]], missing=[True, False], kind="pair")
    (margin,) = answers(summary_of([0.4, 0.9, 2.0, 3.0], resolved=[0, 1, 1, 1]), of).margins()
    smallest, median = col.margin_cells(margin)
    assert (smallest.marked, median.marked) == ("≤0.40!", "2.00")
    assert smallest.marks == (col.AT_MOST, col.NO_ANSWER)
    plain = col.unexplained(smallest)
    assert (plain.marked, {mark.note for mark in plain.marks}) == ("≤0.40!", {""})
    (margin,) = answers(summary_of([math.inf] * 4), of).margins()
    assert col.margin_cells(margin)[0].marked == ">10"


def signs(pga, codes):
    return Cell("", marks=col.doubt(pga, codes)).marked


def test_the_warnings_of_the_readers_are_marked():
    wave = 0.3 * np.round(1000.0 * np.sin(0.2 * np.arange(100))) / 1000.0
    for samples, header, expected in (
        (wave, {}, ""),
        (wave, {"header_peak": (0.4 * 9.80665, 0.0)}, ""),
        (wave, {"header_peak": (0.5 * 9.80665, 0.0)}, " (peak?)"),
        (np.minimum(wave, 0.21), {}, " (clipped?)"),
        (1000.0 * wave, {}, " (peak?)"),
        (1e-7 * wave, {}, " (peak?)"),
    ):
        source = SourceFile("a.txt", b"x", lambda: b"x")
        record = build_record(source, samples, 0.01, "g", format="test", peak_factor=1.0, processed=False, **header)
        assert signs(record.pga, with_codes(record.warnings)[1]) == expected, record.warnings


def test_peaks_out_of_all_bounds_are_marked_and_explained_once():
    found = [signs(pga, "") for pga in (0.0, 5e-6, 2e-5, 49.0, 49.1, np.nan)]
    assert found == [" (peak?)", " (peak?)", "", "", " (peak?)", ""]
    assert signs(60.0, "plain clipped") == " (peak?) (clipped?)"
    assert signs(6.0, "of_vertical/full_scale of_channel/header_peak") == " (peak?) (clipped?)"
    doubtful = [Cell(name, marks=col.doubt(60.0, "")) for name in "ab"]
    assert [note[:8] for note in col.doubt_notes(doubtful)] == ["(peak?):"]
    assert col.doubt_notes([Cell("a"), Cell("b (peak?)", marks=(CellMark("outside", "?"),))]) == []
