"""Blocks of (time, acceleration) pairs: how many, how wide, and what stands behind them."""

from __future__ import annotations

import re

import numpy as np
import pytest

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers.kit.spacing import declared_points, pair_block, pair_unit, surplus

TIMES = 1.5 + 0.02 * np.arange(7)
VALUES = np.array([0.125, -0.5, 3.25, -4.5, 2.75, 1.0, -0.25])


def rows(times=TIMES, values=VALUES, margin=""):
    """Five pairs in a row, in fields of eight characters."""
    fields = [f"{time:8.3f}{value:8.3f}" for time, value in zip(times, values, strict=True)]
    return [margin + "".join(fields[at : at + 5]) for at in range(0, len(fields), 5)]


def block(lines, count=7, unit="g", end=None):
    return pair_block("x.v1", ["A TITLE", "another", *lines], 2, 2 + len(lines) if end is None else end, count, unit)


@pytest.mark.parametrize("count", [3, 5, 7])
@pytest.mark.parametrize("margin", ["", " "])
def test_the_declared_pairs_are_read(count, margin):
    found = block(rows(TIMES[:count], VALUES[:count], margin), count)
    assert found.samples.tolist() == found.values.tolist() == VALUES[:count].tolist()
    assert found.times == pytest.approx(TIMES[:count], abs=1e-12)
    assert (found.dt, found.unit, found.warnings) == (0.02, "g", ())
    assert found.peak == (3.25 if count == 3 else 4.5)
    assert found.duration == pytest.approx(0.02 * count)
    assert found.noting("a", "b").noting("c").warnings == ("a", "b", "c")


@pytest.mark.parametrize("margin", ["", " "])
def test_what_stands_behind_the_declared_pairs_is_told(margin):
    first, last = rows(margin=margin)
    numbers, further = ("line 4: numbers beyond the declared count were left out",), "beyond the declared count were"
    assert block([first, last + "7"]).warnings == numbers
    assert block([first, last + "  "]).warnings == ()
    assert block([first, last + "7", "", "8 9", "10"]).warnings == (*numbers, f"line 5: 2 rows {further} left out")
    assert block([first, last], 5).warnings == (f"line 4: 1 rows {further} left out",)
    assert block([first, last, "of the next"], end=4).warnings == ()


def test_uneven_times_are_resampled_and_told_in_g():
    times = np.array([0.0, 0.02, 0.04, 0.05, 0.07])
    found = block(rows(times, VALUES[:5]), 5, "g/10")
    assert found.samples == pytest.approx([0.125, -0.5, 3.25, -0.875], abs=1e-12)
    assert found.times == pytest.approx(times, abs=1e-12)
    assert found.warnings[0].endswith("the peak goes from 0.45 to 0.325 g")


def test_a_block_that_is_cut_or_damaged_is_named_by_its_line():
    first, last = rows()
    for end in (1, 2):
        with pytest.raises(RecordFormatError, match=rf"^x.v1:{end}: expected 3 pairs \(header\), found 0;"):
            block([first, last], 3, end=end)
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: expected 7 pairs \(header\), found 5;"):
        block([first])
    with pytest.raises(RecordFormatError, match=r"^x.v1:4: expected a finite number, found '1.x00'"):
        block([first, last.replace("1.000", "1.x00")])
    with pytest.raises(RecordFormatError, match=r"^x.v1:4: expected increasing times, .* \(pair 7\)"):
        block(rows(np.append(TIMES[:6], 1.0)))
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: expected 10 fields of 1 characters, found a row of 3 "):
        block(["1 2", last])
    with pytest.raises(RecordFormatError, match=r"^x.v1:3: "):
        block([f"1{first}", f" {last}"])  # one character more, and no carriage control


def test_rows_behind_the_channel_of_a_file_of_one():
    lines = ["TITLE", "1 2", "", "3 4", " \t", "5 6"]
    assert surplus(lines, 2, 6) == ("line 3: 2 rows beyond the declared count were left out",)
    assert surplus(lines, 2, 5) == ("line 3: 1 rows beyond the declared count were left out",)
    assert surplus(lines, 2, 3) == surplus(lines, 6, 6) == ()
    assert surplus(lines, 4, 4, used=1) == ("line 4: numbers beyond the declared count were left out",)
    assert surplus(lines, 4, 4, used=3) == surplus(lines, 4, 4) == ()
    assert surplus(lines, 1, 6, "x.v1", re.compile("TIT")) == (
        "line 2: 3 rows beyond the declared count were left out",
    )
    with pytest.raises(RecordFormatError, match=r"^x.v1:4: expected the end of the file, found '3 4'"):
        surplus(lines, 2, 6, "x.v1", re.compile("3"))


def test_count_and_unit_in_the_words_of_a_header():
    assert declared_points("  No. of Points = 11999", "x.v1:7") == declared_points("NO. OF POINTS=11999", "") == 11999
    with pytest.raises(RecordFormatError, match=r"^x.v1:7: expected 'No. of Points = N', found 'Points: 3'"):
        declared_points(" Points: 3 ", "x.v1:7")
    assert pair_unit("Units are sec and g/10.", "x.v1:7") == pair_unit(" g/10 ", "") == "g/10"
    with pytest.raises(UnitError, match=r"^x.v1:7: unknown unit of acceleration 'furlong'"):
        pair_unit("Units are sec and furlong", "x.v1:7")
