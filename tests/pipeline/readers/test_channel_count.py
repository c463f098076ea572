"""Channels that a file should hold, and those that it holds."""

from __future__ import annotations

import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.checks import Counted, completeness


def channels(numbers: str, counted: int, recorder: str = "A") -> list[Counted]:
    return [Counted(line, recorder, number, counted) for line, number in enumerate(numbers, start=1)]


@pytest.mark.parametrize(
    ("numbers", "counted", "closed", "warned"),
    [
        ("12", 3, True, True),
        ("1", 3, False, True),
        ("1", 3, True, False),
        ("123", 3, False, False),
        ("1234", 3, False, False),
        ("1", 0, False, False),
        ("12", 0, False, False),
    ],
)
def test_fewer_channels_than_are_counted(numbers, counted, closed, warned):
    notes = completeness("a.V1", channels(numbers, counted), closed=closed)
    words = f"the header counts 3 channels of this recorder, the file holds {len(numbers)}; it may be truncated"
    assert notes == ((words,) if warned else ())


def test_recorders_are_counted_apart():
    both = [*channels("123", 3), *channels("12", 3, "B")]
    assert len(completeness("a.V1", both)) == 1
    assert len(completeness("a.V1", both, closed=True)) == 1
    assert completeness("a.V1", [*both, Counted(6, "B", "3", 3)]) == ()


def test_a_channel_may_come_once():
    with pytest.raises(
        RecordFormatError, match=r"a.V1:3: expected another channel, found that of line 1 a second time"
    ):
        completeness("a.V1", channels("121", 3))


def test_channels_without_a_number_and_of_another_kind_are_others():
    assert completeness("a.V1", [Counted(1, "A", "", 2), Counted(9, "A", "", 2)]) == ()
    both = [Counted(1, "A", "1", 1, "acceleration"), Counted(9, "A", "1", 1, "velocity")]
    assert completeness("a.V1", both) == ()


def test_the_largest_count_of_a_recorder_holds():
    uneven = [Counted(1, "A", "1", 2), Counted(5, "A", "2", 4), Counted(9, "A", "3", 2)]
    assert completeness("a.V1", uneven, "its numbers tell of") == (
        "its numbers tell of 4 channels of this recorder, the file holds 3; it may be truncated",
    )


def test_a_file_is_not_closed_unless_that_is_said():
    assert len(completeness("a.V1", channels("1", 3))) == 1
