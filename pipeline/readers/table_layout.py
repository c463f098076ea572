"""How a table of numbers is written: where it begins, what separates the columns, what marks the decimals."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["NUMBER", "Layout", "find_layout", "row_width", "split_row"]

_HEADER_LIMIT = 60
_LOOK_AHEAD = 5
#: A field that is meant as a number, whether finite or not.
NUMBER = re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eEdD][+-]?\d+)?|nan|[+-]?inf", re.IGNORECASE | re.ASCII)


@dataclass(frozen=True)
class Layout:
    """Where the numbers begin and how they are separated.

    Attributes
    ----------
    start : int
        Index of the first row of numbers.
    delimiter : str or None
        Between the columns; None for blanks and tabs.
    decimal : {".", ","}
        Decimal mark.
    width : int
        Number of columns.
    names : tuple of str
        Column headings; empty where the line above the numbers is none.
    """

    start: int
    delimiter: str | None
    decimal: str
    width: int
    names: tuple[str, ...]


def split_row(line: str, delimiter: str | None) -> list[str]:
    """Fields of a row without quotes; empty ones at the end, from a trailing delimiter, are dropped."""
    fields = [field.strip().strip('"') for field in line.strip().split(delimiter)]
    while len(fields) > 1 and not fields[-1]:
        fields.pop()
    return fields


def _find_delimiter(line: str) -> str | None:
    if ";" in line:
        return ";"
    fields = line.split()
    comma_decimals = len(fields) > 1 and all(
        re.fullmatch(r"[+-]?\d*,\d+(?:[eEdD][+-]?\d+)?", field) for field in fields
    )
    return "," if "," in line and not comma_decimals else None


def row_width(line: str) -> int:
    """Number of columns if the line holds numbers only, else 0."""
    fields = split_row(line, _find_delimiter(line))
    return len(fields) if all(NUMBER.fullmatch(field) for field in fields) else 0


def find_layout(lines: Sequence[str]) -> Layout | None:
    """Find the first of the rows of numbers; the lines before it are the header."""
    for start in range(min(len(lines), _HEADER_LIMIT)):
        width = row_width(lines[start])
        ahead = [line for line in lines[start + 1 : start + 1 + _LOOK_AHEAD] if line.strip()]
        if not width or any(row_width(line) != width for line in ahead):
            continue
        delimiter = _find_delimiter(lines[start])
        rows = [lines[start], *ahead]
        decimal = "," if delimiter != "," and any("," in row for row in rows) else "."
        named = split_row(lines[start - 1].lstrip("#% "), delimiter) if start else []
        return Layout(start, delimiter, decimal, width, tuple(named) if len(named) == width else ())
    return None
