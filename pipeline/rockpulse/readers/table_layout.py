"""The layout of a table of numbers: where it begins, how columns are separated, and the decimal mark."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["LINE_LIMIT", "NUMBER", "Layout", "end_of_numbers", "find_layout", "row_width", "split_row"]

#: Characters of the longest row of a table; a line beyond is none, whatever it holds.
LINE_LIMIT = 10_000
_HEADER_LIMIT = 60
_LOOK_AHEAD = 5
#: A field that is meant as a number, whether finite or not. Possessive: no field takes longer than its length.
NUMBER = re.compile(r"[+-]?(?:\d++(?:[.,]\d*+)?|[.,]\d++)(?:[eEdD][+-]?\d++)?|nan|[+-]?inf", re.IGNORECASE | re.ASCII)
#: A line of words, as it stands behind numbers; one that begins with a number, or with nan, is a damaged row.
_WORDS = re.compile(r"[\s\"'*#%!/=<>(\[;,:_~-]*+(?!(?:nan|inf)(?![a-z]))[^\W\d_]{2}", re.IGNORECASE)
_COMMA_DECIMAL = re.compile(r"[+-]?\d++(?:,\d++)?(?:[eEdD][+-]?\d++)?", re.ASCII)


@dataclass(frozen=True)
class Layout:
    """The beginning of the numbers and their separators."""

    start: int  # index of the first row of numbers
    delimiter: str | None  # between the columns; None for blanks and tabs
    decimal: str  # mark, "." or ","
    width: int  # number of columns


def split_row(line: str, delimiter: str | None) -> list[str]:
    """Fields of a row without quotes; empty ones at the end, from a trailing delimiter, are dropped."""
    fields = [field.strip().strip('"') for field in line.strip().split(delimiter)]
    while len(fields) > 1 and not fields[-1]:
        fields.pop()
    return fields


def _find_delimiter(rows: Sequence[str]) -> str | None:
    """The separator of the columns in rows of numbers; commas are decimal marks if blanks separate whole fields."""
    if any(";" in row for row in rows):
        return ";"
    return "," if any("," in row and not _comma_decimals(row) for row in rows) else None


def _comma_decimals(row: str) -> bool:
    fields = split_row(row, None)
    return len(fields) > 1 and all(_COMMA_DECIMAL.fullmatch(field) for field in fields)


def row_width(line: str, delimiter: str | None) -> int:
    """Number of columns if the line holds numbers only, else 0."""
    if len(line) > LINE_LIMIT:
        return 0
    fields = split_row(line, delimiter)
    return len(fields) if all(NUMBER.fullmatch(field) for field in fields) else 0


def find_layout(lines: Sequence[str]) -> Layout | None:
    """Find the first of the rows of numbers; the lines before it are the header."""
    for start in range(min(len(lines), _HEADER_LIMIT)):
        ahead = [line for line in lines[start + 1 : start + 1 + _LOOK_AHEAD] if line.strip()]
        rows = [lines[start], *ahead]
        if any(len(row) > LINE_LIMIT for row in rows):
            continue
        delimiter = _find_delimiter(rows)
        width = row_width(lines[start], delimiter)
        if width and all(row_width(row, delimiter) == width for row in ahead):
            decimal = "," if delimiter != "," and any("," in row for row in rows) else "."
            return Layout(start, delimiter, decimal, width)
    return None


def end_of_numbers(lines: Sequence[str], start: int) -> int:
    """Index of the first line of words behind the numbers, which begin at `start`; the number of lines if none is."""
    return next((at for at in range(start, len(lines)) if _WORDS.match(lines[at])), len(lines))
