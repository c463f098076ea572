"""The numbers of a table: what is read, and which row is blamed for what cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.table import Layout, as_float, check_decimals, read_table


def layout(delimiter=None, decimal=".", width=2):
    return Layout(0, delimiter, decimal, width)


@pytest.mark.parametrize(
    ("rows", "as_written"),
    [
        (["1 -2.5", "3e1 4D-1"], layout()),
        (["1 -2.5", "", "3e1 4D-1"], layout()),
        (["1 -2.5", "3e1 4D-1", ""], layout()),
        (["1,-2.5", "30, 0.4"], layout(",")),
        (["1,-2.5,", "30, 0.4"], layout(",")),
        (['"1" "-2.5"', "30 0.4"], layout()),
        (["1;-2,5", "30;0,4"], layout(";", ",")),
        (["1 -2,5 ", "\t30 0,4"], layout(None, ",")),
    ],
)
def test_rows_as_they_are_written(rows, as_written):
    assert read_table("x.txt", rows, as_written, 7).tolist() == [[1.0, -2.5], [30.0, 0.4]]
    assert as_float("-1,5D+1") == -15.0


@pytest.mark.parametrize("blank", [0, 1, 4500])
def test_a_long_table_with_and_without_blank_rows(blank):
    numbers = np.arange(9000.0).reshape(-1, 2)
    rows = [f"{one} {other}" for one, other in numbers]
    assert np.array_equal(read_table("x.txt", [*rows[:2500], *[""] * blank, *rows[2500:]], layout(), 1), numbers)
    assert read_table("x.txt", [""] * blank, layout(), 1).shape == (0, 2)


@pytest.mark.parametrize(
    ("row", "as_written"),
    [
        ("1,5 2", layout()),
        ("1 2 3", layout()),
        ("1", layout()),
        ("1 x", layout()),
        ("1 nan", layout()),
        ("1 1e999", layout()),
        ("1,,2", layout(",")),
        ("1,", layout(",")),
        ("1 2", layout(",")),
        ("0" * 9999 + " 1", layout()),  # a character more than a line may have
    ],
)
@pytest.mark.parametrize("at", [0, 3, 2100, 4999])
def test_the_first_row_that_is_no_row_of_the_table_is_blamed(row, as_written, at):
    rows = [f"1{as_written.delimiter or ' '}2"] * 5000
    rows[at] = row
    rows[1] = ""
    with pytest.raises(
        RecordFormatError, match=rf"^x.txt:{at + 7}: expected 2 finite numbers, found '{row.rstrip(',')[:80]}'; rep"
    ):
        read_table("x.txt", [*rows, "words"], as_written, 7)


def test_a_row_of_ten_thousand_characters_is_read_and_is_not_to_blame():
    longest = "0" * 9999 + "1"
    assert read_table("x.txt", [longest, "2"], layout(width=1), 7).tolist() == [[1.0], [2.0]]
    with pytest.raises(RecordFormatError, match=r"^x.txt:8: expected 1 finite numbers, found 'x'"):
        read_table("x.txt", [longest, "x"], layout(width=1), 7)


def test_of_a_table_that_cannot_be_read_a_row_of_the_other_decimal_mark_is_to_blame():
    with pytest.raises(RecordFormatError, match=r"^x.txt:8: expected 2 finite numbers, found '1.5 2'"):
        read_table("x.txt", ["1,5 2", "1.5 2", "x 2"], layout(None, ","), 7)


def test_rows_that_are_sound_one_by_one_only_are_refused_too():
    with pytest.raises(RecordFormatError, match=r"^x.txt:7: the rows cannot be read as 2 columns of numbers"):
        read_table("x.txt", ["1 2", "3\u00a04"], layout(), 7)


@pytest.mark.parametrize(
    ("rows", "as_written", "named", "line"),
    [
        (["0,12", "1,34"], layout(","), True, 7),
        (["0,12", "1,34"], layout(","), False, 7),
        (["0,1,2", "1,3,4"], layout(",", width=3), False, 7),
        (["0,1,2", "1,3,4"], layout(",", width=3), True, None),
        (["0,1.2", "1,3"], layout(","), False, None),
        (["0,", "1,"], layout(",", width=1), False, None),
        (["0;1", "1;3"], layout(";"), False, None),
        (["0,5;1", "", "0.5;1", "0.5;1"], layout(";", ","), False, 9),
        (["0,5;1", "0,5;1"], layout(";", ","), False, None),
    ],
)
def test_a_comma_has_one_meaning(rows, as_written, named, line):
    if line is None:
        check_decimals("x.txt", rows, as_written, 7, named)
        return
    with pytest.raises(RecordFormatError, match=rf"^x.txt:{line}: expected"):
        check_decimals("x.txt", rows, as_written, 7, named)
