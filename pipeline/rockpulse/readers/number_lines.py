"""Lines of one or two numbers between the header and the samples: their count and the interval."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rockpulse.readers.fields import check_count
from rockpulse.readers.table_layout import LINE_LIMIT, NUMBER, Layout, split_row
from rockpulse.readers.table_numbers import as_float

__all__ = ["Numbered", "number_lines"]

_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_STEP = re.compile(r"\d{0,3}[.,]\d{1,12}(?:[eE][+-]?\d{1,2})?", re.ASCII)
#: Rows that show how samples are written.
_LOOK_AT = 50


@dataclass(frozen=True)
class Numbered:
    """The statements of the lines of numbers in front of the samples."""

    start: int  # index of the first row of samples
    count: int = 0  # rows, or values of a series in rows; 0 where no line says so
    step: float | None = None  # sampling interval [s]
    line: int = 0  # number of the line with the count, from 1


def number_lines(name: str, lines: Sequence[str], layout: Layout, timed: bool) -> Numbered:
    """Read ``N dt`` on one line (the DEEPSOIL layout) or two, in either order, or ``N`` alone.

    With one or two columns such a line looks like data. Of one column, the first value is the count if as many rows
    follow; of two, it is a heading if the time would run backwards after it. If the first column is headed as time
    (`timed`), all rows are data. Raises RecordFormatError for a count above fewer samples.
    """
    row = layout.start
    if timed:
        return Numbered(row)
    if layout.width == 1:
        inside = _first_values(name, lines, layout)
        if inside:
            return inside
    if layout.width == 2 and row + 1 < len(lines):
        fields, following = (split_row(lines[index][:LINE_LIMIT], layout.delimiter) for index in (row, row + 1))
        two_numbers = len(following) == 2 and all(NUMBER.fullmatch(field) for field in following)
        if two_numbers and as_float(following[0]) <= as_float(fields[0]):
            count, step = _count_and_step(fields)
            if count and step:
                return Numbered(row + 1, count, step, row + 1)
    fields = []
    for line in [line for line in lines[:row] if line.strip()][:-3:-1]:
        found = [field for field in re.split(r"[\s,;]+", line[:LINE_LIMIT].strip(" \t#%")) if field]
        if not found or not all(NUMBER.fullmatch(field) for field in found):
            break
        fields = [*found, *fields]
    count, step = _count_and_step(fields)
    return Numbered(row, count, step, row) if count else Numbered(row)


def _count_and_step(fields: Sequence[str]) -> tuple[int, float | None]:
    """Count and interval from one or two fields, in either order; 0 and None where they are no such numbers."""
    counts = [field for field in fields if _COUNT.fullmatch(field)]
    steps = [field for field in fields if _STEP.fullmatch(field)]
    if len(counts) > 1 or len(steps) > 1 or len(counts) + len(steps) != len(fields):
        return 0, None
    return int(counts[0]) if counts else 0, as_float(steps[0]) if steps else None


def _first_values(name: str, lines: Sequence[str], layout: Layout) -> Numbered | None:
    """The count at the head of one column, with or without the interval."""
    rows = [index for index in range(layout.start, len(lines)) if lines[index].strip()]
    texts = [split_row(lines[index][:LINE_LIMIT], layout.delimiter)[0] for index in rows[:_LOOK_AT]]
    for used in (2, 1):
        count, step = _count_and_step(texts[:used])
        if count and count == len(rows) - used:
            return Numbered(rows[used], count, step, rows[0] + 1)
    count, _ = _count_and_step(texts[:1])
    if count >= len(rows) > 2 and all("." in text or "," in text for text in texts[1:]):
        check_count(f"{name}:{rows[0] + 1}", count, len(rows) - 1, "rows")
    return None
