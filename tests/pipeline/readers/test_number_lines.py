"""Lines with the number of samples and the interval, in front of the samples of plain columns."""

import pytest

from rockpulse.readers.number_lines import Numbered, number_lines
from rockpulse.readers.table_layout import Layout


def found(*lines, width):
    return number_lines("record.txt", lines, Layout(0, None, ".", width), timed=False)


def test_the_head_of_one_column_is_its_count_with_or_without_the_interval():
    assert found("3", "0.1", "0.2", "0.3", width=1) == Numbered(1, 3, None, 1)
    assert found("", "3", "0.01", "0.1", "0.2", "0.3", width=1) == Numbered(3, 3, 0.01, 2)


def test_two_numbers_above_times_that_would_run_backwards_are_count_and_interval():
    assert found("3 0.01", "0.00 1.5", "0.01 2.5", width=2) == Numbered(1, 3, 0.01, 1)


@pytest.mark.parametrize("behind", [[], ["0.5"], ["0.0 1.5 2.5"], ["0.0 x"]])
def test_two_numbers_that_no_row_of_two_follows_are_a_row(behind):
    assert found("3 0.01", *behind, width=2) == Numbered(0)
