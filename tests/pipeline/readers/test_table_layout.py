"""Where the numbers of a table stop: at words, at the end of the file, at another section."""

from __future__ import annotations

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import columns, wrapped

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import read
from rockpulse.readers.kit.table import Layout, end_of_numbers, find_layout, row_width, split_row

VALUES = np.round(pulse(200, peak=3.0), 6)
TABLE = columns(np.column_stack([0.01 * np.arange(200), VALUES])).decode()


PEKNOLD = (
    "Data for El Centro 1940 North South Component (Peknold Version)\n"
    "{count} points at equal spacing of 0.02 sec\n"
    "Points are listed in the format of 8F10.5, i.e., 8 points across in a row with 5 decimal places\n"
    "The units are (g)\n\n*** Begin data ***\n"
)


def test_numbers_that_stop_at_a_line_of_words_are_read_to_the_stated_count(write):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    path = write((PEKNOLD.format(count=200) + rows + "*** End data ***\n").encode())
    (record,) = read(path, units="g")
    assert (record.npts, record.dt, record.warnings) == (200, 0.02, ())
    assert record.acceleration / record.unit_factor == pytest.approx(VALUES, abs=0.51e-5)
    with pytest.raises(UnitError, match="line 4 of its header speaks of"):
        read(path)
    with pytest.raises(UnitError, match="the header says"):
        read(path, units="cm/s2")
    with pytest.raises(RecordFormatError, match="intervals disagree"):
        read(path, units="g", dt=0.01)


@pytest.mark.parametrize("behind", ["", "\n  Units: g, PGA 0.31882\n12\n"])
def test_numbers_that_stop_where_no_count_is_stated_say_where(write, behind):
    path = write((TABLE + "End of record" + behind).encode())
    (record,) = read(path, units="g")
    assert record.npts == 200
    assert record.warnings == (
        "line 201: the numbers stop at 'End of record', and the header does not state how many there are; is the file "
        "whole?",
    )


def test_a_section_of_another_quantity_behind_the_numbers_is_left_out_and_told(write):
    path = write(f"200 0.01\n{TABLE}Velocity\n{TABLE}".encode())
    without_count = write(f"{TABLE}Velocity in m/s\n{TABLE}".encode(), "without.txt")
    for content, line in ((path, 202), (without_count, 201)):
        (record,) = read(content, units="m/s2")
        assert record.npts == 200
        assert record.warnings[0].startswith(f"line {line}: the numbers stop at 'Velocity")
        assert "200 rows of numbers behind it were left out" in record.warnings[0]


@pytest.mark.parametrize("words", ["PAGE 2", "Acceleration E-W", "Northridge, station 2", "missing"])
def test_numbers_that_go_on_behind_a_line_of_words_are_not_cut(write, words):
    lines = TABLE.split("\n")
    lines.insert(100, words)
    with pytest.raises(RecordFormatError, match=rf"record.txt:101: .* '{words}' and 100 rows of numbers behind it"):
        read(write("\n".join(lines).encode()), units="g")


def test_fewer_numbers_before_the_words_than_the_header_states(write):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    for used in (rows, rows + "   0.00100\n"):
        path = write((PEKNOLD.format(count=300) + used + "*** End data ***\n").encode())
        with pytest.raises(RecordFormatError, match="rows of 8"):
            read(path)
        (record,) = read(path, units="g")
        notes = " ".join(record.warnings)
        assert all(words in notes for words in ("the numbers stop at", "speaks of 300", "as one series"))


@pytest.mark.parametrize("number", ["0.02e-320", "0.02E+999"])
def test_an_interval_with_an_exponent_beyond_all_numbers_is_no_interval(write, number):
    rows = wrapped(VALUES, 8, field="{:10.5f}").decode()
    path = write(PEKNOLD.format(count=200).replace("0.02", number).encode() + rows.encode())
    with pytest.raises(RecordFormatError, match="option dt for the sampling interval"):
        read(path, units="g")


def test_empty_fields_at_the_end_of_a_row_are_none_but_an_empty_row_is_one():
    assert split_row("1, 2,,", ",") == ["1", "2"]
    assert split_row("", ",") == split_row(",", ",") == [""]


def test_a_table_begins_where_the_row_and_the_five_behind_it_have_one_width():
    assert find_layout(["1 2", *["1 2 3"] * 6]).start == 1
    assert find_layout([*["1 2"] * 5, "1 2 3"]).start == 5
    assert find_layout([*["1 2"] * 6, "1 2 3"]).start == 0


def test_a_line_of_more_than_ten_thousand_characters_is_no_row():
    assert (row_width("1" * 10_000, None), row_width("1" * 10_001, None)) == (1, 0)
    assert find_layout(["1" * 10_001, "1" * 10_000]).start == 1


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (["1,2", "3,4"], (",", ".", 2)),
        (["1, 2", "3, 4"], (",", ".", 2)),
        (["0,1 0,2", "0,3 0,4"], (None, ",", 2)),
        (["0,1 2", "3 4"], (None, ",", 2)),
        (["0,1 x", "3 4"], None),
        (["0,1;2", "3;4"], (";", ",", 2)),
        (["1 2", "3 4"], (None, ".", 2)),
        (["1.5;2", "3;4"], (";", ".", 2)),
        (["1"], (None, ".", 1)),
        ([""], None),
        ([], None),
    ],
)
def test_separator_and_decimal_mark(rows, expected):
    found = find_layout(["words", *rows])
    assert found == (None if expected is None else Layout(1, *expected)) or (rows[1:] == ["3 4"] and found.start == 2)


def test_the_numbers_begin_in_one_of_the_first_sixty_lines():
    assert find_layout(["words"] * 59 + ["1 2"]) == Layout(59, None, ".", 2)
    assert find_layout(["words"] * 60 + ["1 2"]) is None


def test_the_numbers_end_at_the_first_line_of_words_behind_their_begin():
    lines = ["ab", "1 2", "1x", "nan", "", "-- End", "of"]
    assert [end_of_numbers(lines, start) for start in (0, 1, 5, 6, 7)] == [0, 5, 5, 6, 7]
    assert end_of_numbers(lines[:5], 1) == 5


def test_numbers_that_are_not_finite_are_numbers_in_any_letters_and_digits_of_other_scripts_are_none():
    assert [row_width(row, None) for row in ("NaN -INF", "nan +inf 1D5", "\u0661 \u0662", "1 x")] == [2, 3, 0, 0]
