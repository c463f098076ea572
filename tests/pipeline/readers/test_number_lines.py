"""Lines with the number of samples and the interval, in front of the samples of plain columns."""

import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.table import Layout, Numbered, number_lines


def found(*lines, width, start=0, timed=False):
    return number_lines("record.txt", lines, Layout(start, None, ".", width), timed)


def test_the_head_of_one_column_is_its_count_with_or_without_the_interval():
    assert found("3", "0.1", "0.2", "0.3", width=1) == Numbered(1, 3, None, 1)
    assert found("", "3", "0.01", "0.1", "0.2", "0.3", width=1) == Numbered(3, 3, 0.01, 2)
    assert found("words", "0.01", "", "3", "0.1", "0.2", "0.3", width=1, start=1) == Numbered(4, 3, 0.01, 2)
    unstated = found("3", "0.01", "0.2", "0.3", width=1, timed=True)
    assert (unstated.start, unstated.count, unstated.step, unstated.line) == (0, 0, None, 0)


@pytest.mark.parametrize("count", [4, 5])
def test_a_count_above_fewer_values_is_a_truncation(count):
    with pytest.raises(RecordFormatError, match=rf"^record.txt:2: expected {count} rows \(header\), found 3;"):
        found("", str(count), "-0.1", "0,2", "0.3", width=1)
    with pytest.raises(RecordFormatError, match=r"found 2;"):
        found("3", "0.1", "0.2", width=1)


@pytest.mark.parametrize(
    "values",
    [
        ["2", "0.1"],  # too few to tell
        ["2", "-0.1", "0.2", "0.3"],  # fewer than follow
        ["5", "1", "0.2", "0.3"],  # a value without a point
        ["5", "0.1", "0.2", "3"],
        ["5", "0.1", "1 0.2", "0.3"],
        ["0.01", "0.1", "0.2"],
        ["60", *["0.1"] * 48, "7", "0.1"],  # the last of the fifty that are looked at
    ],
)
def test_a_first_value_that_may_be_a_sample_is_one(values):
    assert found(*values, width=1) == Numbered(0)


def test_fifty_values_tell_how_samples_are_written():
    with pytest.raises(RecordFormatError, match="expected 60 rows"):
        found("60", *["0.1"] * 49, "7", "0.1", width=1)


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        (["300 0.02"], (300, 0.02)),
        (["0.02;300"], (300, 0.02)),
        (["# 300, 2.0E-2 %"], (300, 0.02)),
        (["300"], (300, None)),
        (["300", "", "0.02", " "], (300, 0.02)),
        (["0.02", "300"], (300, 0.02)),
        (["300 0.02", "7"], None),
        (["7", "300", "0.02"], (300, 0.02)),  # no more than two lines
        (["300 0.02", "words"], None),
        (["300 0.02", "#"], None),
        (["300 0.02 0.05"], None),
        (["300 400 0.02"], None),
        (["300 -5"], None),
        (["0.02"], None),
        (["0 0.02"], None),
        ([], None),
    ],
)
@pytest.mark.parametrize("width", [1, 3])
def test_lines_of_numbers_right_above_the_samples(header, expected, width):
    lines = ["words", *header]
    row = " ".join(["0.5"] * width)
    start = len(lines)
    assert found(*lines, row, row, width=width, start=start) == (
        Numbered(start) if expected is None else Numbered(start, *expected, start)
    )


def test_two_numbers_above_times_that_would_run_backwards_are_count_and_interval():
    assert found("3 0.01", "0.00 1.5", "0.01 2.5", width=2) == Numbered(1, 3, 0.01, 1)
    assert found("words", "3 0.01", "1.00 4.5", width=2, start=1) == Numbered(2, 3, 0.01, 2)
    assert found("3 0.01", "3 1.5", "4 2.5", width=2) == Numbered(1, 3, 0.01, 1)
    assert found("0.01 3", "0.00 1.5", width=2) == Numbered(1, 3, 0.01, 1)


@pytest.mark.parametrize("rows", [["3 0.01", "3.5 1.5"], ["0 0.01", "0 1.5"], ["3 0.0", "1 2"], ["0.0 3", "0.0 2"]])
def test_two_numbers_that_are_no_count_and_interval_are_a_row(rows):
    assert found(*rows, width=2) == Numbered(0)


@pytest.mark.parametrize("behind", [[], ["0.5"], ["0.0 1.5 2.5"], ["0.0 x"]])
def test_two_numbers_that_no_row_of_two_follows_are_a_row(behind):
    assert found("3 0.01", *behind, width=2) == Numbered(0)
