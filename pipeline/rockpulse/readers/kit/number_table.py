"""Reads tables of numbers: their layout, the count and interval above them, and series that are wrapped into rows."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.kit.text import check_count, free_numbers, unexpected

#: Length of the longest row of a table [characters]; a longer line is not a row.
LINE_LIMIT = 10_000
_HEADER_LIMIT = 60
_LOOK_AHEAD = 5
#: Pattern of a field that represents a number, finite or not. Its quantifiers are possessive, for linear time.
NUMBER = re.compile(r"[+-]?(?:\d++(?:[.,]\d*+)?|[.,]\d++)(?:[eEdD][+-]?\d++)?|nan|[+-]?inf", re.IGNORECASE | re.ASCII)
#: Pattern of a line of words after numbers; a line that begins with a number, or with nan, is a damaged row.
_WORDS = re.compile(r"[\s\"'*#%!/=<>(\[;,:_~-]*+(?!(?:nan|inf)(?![a-z]))[^\W\d_]{2}", re.IGNORECASE)
_COMMA_DECIMAL = re.compile(r"[+-]?\d++(?:,\d++)?(?:[eEdD][+-]?\d++)?", re.ASCII)
_AS_PYTHON = str.maketrans({",": ".", "d": "e", "D": "e"})
_SHOWN = 80
_OF_RSPMATCH = 3  # number of numbers in the line above the samples in files of RSPMatch
_PART = 2**14  # number of rows that are read together
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_STEP = re.compile(r"\d{0,3}[.,]\d{1,12}(?:[eE][+-]?\d{1,2})?", re.ASCII)
#: Number of rows from which the layout of samples is recognised, and smallest number of rows of a series in rows.
_LOOK_AT, FEWEST_ROWS = 50, 20
#: For a series wrapped into rows: largest ratio of the mean square of the steps between values in a row to the mean
#: square of the steps from row to row in a column. For independent channels the ratio exceeds 1.
SMOOTHER = 0.5
#: For a series wrapped into rows: largest ratio, in either sense, of the mean squares of the steps from the end of a
#: row to the start of the next and of the steps within rows. For channels that move together the former are larger.
ALIKE = 1.8


@dataclass(frozen=True)
class Layout:
    """The first row of a table, its separators and its number of columns."""

    start: int  # index of the first row of numbers
    delimiter: str | None  # between the columns; None for blanks and tabs
    decimal: str  # decimal mark, "." or ","
    width: int  # number of columns


def split_row(line: str, delimiter: str | None) -> list[str]:
    """Return the fields of a row without quotes, and without empty fields after a trailing delimiter."""
    fields = [field.strip().strip('"') for field in line.strip().split(delimiter)]
    while len(fields) > 1 and not fields[-1]:
        fields.pop()
    return fields


def _find_delimiter(rows: Sequence[str]) -> str | None:
    """Return the delimiter of rows of numbers; None if blanks separate them, even if commas mark decimals."""
    if any(";" in row for row in rows):
        return ";"
    split = (split_row(row, None) for row in rows if "," in row)
    decimals = (len(fields) > 1 and all(map(_COMMA_DECIMAL.fullmatch, fields)) for fields in split)
    return None if all(decimals) else ","


def row_width(line: str, delimiter: str | None) -> int:
    """Return the number of columns of a row; 0 if it does not consist of numbers only."""
    if len(line) > LINE_LIMIT:
        return 0
    fields = split_row(line, delimiter)
    return len(fields) if all(NUMBER.fullmatch(field) for field in fields) else 0


def find_layout(lines: Sequence[str]) -> Layout | None:
    """Return the layout of the first table of numbers in the lines; None if there is no table."""
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
    """Return the index of the first line of words after the numbers, or the number of lines if no words follow."""
    return next((at for at in range(start, len(lines)) if _WORDS.match(lines[at])), len(lines))


def as_float(text: str) -> float:
    """Return the value of a field that matches `NUMBER`."""
    return float(text.translate(_AS_PYTHON))


def check_decimals(name: str, rows: Sequence[str], layout: Layout, first: int, named: bool) -> None:
    """Raise an error if it is unclear whether commas in the rows separate columns or mark decimals."""
    points = any("." in row for row in rows)
    if layout.delimiter == "," and layout.width > 1 and not points and (layout.width == 2 or not named):
        raise RecordFormatError(
            f"{name}:{first}: cannot tell whether the comma separates columns or marks decimals: "
            f"{rows[0].strip()[:_SHOWN]!r}, and no row contains a decimal point; write decimal points, or separate the "
            "columns with ';'"
        )
    if layout.decimal == "," and points:
        at = next(index for index, row in enumerate(rows) if "." in row)
        expected, found = "decimal commas, as in other rows", f"a point in {rows[at].strip()[:_SHOWN]!r}"
        raise unexpected(f"{name}:{first + at}", expected, found, "use one decimal mark in the whole file")


def read_table(name: str, rows: Sequence[str], layout: Layout, first: int) -> np.ndarray:
    """Return the numbers of the rows as an array (rows, columns); blank rows are ignored."""
    parts = [np.empty((0, layout.width))]
    for at in range(0, len(rows), _PART):
        part = rows[at : at + _PART]
        table = _numbers(part, layout)
        if table is None:
            kept = [row for row in (_bare(row, layout) for row in part) if row]
            table = _numbers(kept, layout)
            if kept and table is None:
                raise _blamed(name, part, layout, first + at)
        parts += [] if table is None else [table]
    return np.concatenate(parts)


def _bare(row: str, layout: Layout) -> str:
    return row.strip().rstrip(layout.delimiter) if layout.delimiter else row.strip()


def _blamed(name: str, rows: Sequence[str], layout: Layout, first: int) -> RecordFormatError:
    """Return the error for the first row that does not have a finite number in every column."""
    other = {",": ".", ".": ","}[layout.decimal]
    for index, line in enumerate(rows):
        row = _bare(line, layout)
        fields = split_row(row, layout.delimiter) if len(row) <= LINE_LIMIT else []
        sound = all(NUMBER.fullmatch(field) and other not in field and np.isfinite(as_float(field)) for field in fields)
        if row and not (sound and len(fields) == layout.width):
            advice = "repair the line, or end the record before it"
            return unexpected(f"{name}:{first + index}", f"{layout.width} finite numbers", repr(row[:_SHOWN]), advice)
    return RecordFormatError(
        f"{name}:{first}: the rows cannot be read as {layout.width} columns of numbers; write them with one "
        "separator and one decimal mark"
    )


def _numbers(rows: Sequence[str], layout: Layout) -> np.ndarray | None:
    """Return the numbers of all rows as an array (rows, columns); None if any row is damaged."""
    if any(len(row) > LINE_LIMIT for row in rows):
        return None
    text = "\n".join(rows).replace('"', " ")
    if not text or not text.isascii():
        return None
    codes = np.frombuffer(text.encode(), dtype=np.uint8)
    starts = np.append(0, np.flatnonzero(codes == ord("\n")))  # a row includes the line break before it
    if layout.delimiter:
        separators = np.add.reduceat(codes == ord(layout.delimiter), starts, dtype=np.intp)
        if np.any(separators != layout.width - 1):
            return None
        text = text.replace(layout.delimiter, " ")
    filled = np.frombuffer(text.encode(), dtype=np.uint8) > ord(" ")
    begins = filled & ~np.append(False, filled[:-1])
    if np.any(np.add.reduceat(begins, starts, dtype=np.intp) != layout.width):
        return None
    text = text.replace(",", ".") if layout.decimal == "," else text
    try:
        return free_numbers([text], 1, "").reshape(-1, layout.width)
    except RecordFormatError:
        return None


@dataclass(frozen=True)
class Numbered:
    """The index of the first row of samples, and the count and interval stated above it."""

    start: int
    count: int = 0  # number of rows, or of values of a wrapped series; 0 if not stated
    step: float | None = None  # sampling interval [s]


def number_lines(name: str, lines: Sequence[str], layout: Layout, timed: bool) -> Numbered:
    """Return the count and interval that lines of numbers state above the samples, such as ``N dt`` (DEEPSOIL)."""
    # In a single column, the first value is the count if as many rows follow. In two columns, the first row states the
    # count and interval if the times would decrease after it.
    row = layout.start
    if timed:
        return Numbered(row)
    if layout.width == 1 and (inside := _first_values(name, lines, layout)):
        return inside
    if layout.width == 2 and row + 1 < len(lines):
        fields, following = (split_row(lines[index][:LINE_LIMIT], layout.delimiter) for index in (row, row + 1))
        two_numbers = len(following) == 2 and all(NUMBER.fullmatch(field) for field in following)
        if two_numbers and as_float(following[0]) <= as_float(fields[0]):
            count, step = _count_and_step(fields)
            if count and step:
                return Numbered(row + 1, count, step)
    fields, rows = [], 0
    for line in [line for line in lines[:row] if line.strip()][:-3:-1]:
        found = [field for field in re.split(r"[\s,;]+", line[:LINE_LIMIT].strip(" \t#%")) if field]
        if not found or not all(NUMBER.fullmatch(field) for field in found):
            break
        fields, rows = [*found, *fields], rows + 1
    if rows == 1 and len(fields) == _OF_RSPMATCH and all("." not in text for text in fields[::2]):
        filled = [line for line in lines[row:] if line.strip()]
        values = (len(filled) - 1) * layout.width + len(split_row(filled[-1], layout.delimiter))
        fields = fields[:2] if fields[0] == str(values) else fields
    count, step = _count_and_step(fields)
    return Numbered(row, count, step) if count else Numbered(row)


def _count_and_step(fields: Sequence[str]) -> tuple[int, float | None]:
    """Return the count and the interval in one or two fields, in either order; 0 and None for other fields."""
    counts = [field for field in fields if _COUNT.fullmatch(field)]
    steps = [field for field in fields if _STEP.fullmatch(field)]
    if len(counts) > 1 or len(steps) > 1 or len(counts) + len(steps) != len(fields):
        return 0, None
    return int(counts[0]) if counts else 0, as_float(steps[0]) if steps else None


def _first_values(name: str, lines: Sequence[str], layout: Layout) -> Numbered | None:
    """Return the count and, if stated, the interval at the top of a single column; None if there is no count."""
    rows = [index for index in range(layout.start, len(lines)) if lines[index].strip()]
    texts = [split_row(lines[index][:LINE_LIMIT], layout.delimiter)[0] for index in rows[:_LOOK_AT]]
    for used in (2, 1):
        count, step = _count_and_step(texts[:used])
        if count and count == len(rows) - used:
            return Numbered(rows[used], count, step)
    count, _ = _count_and_step(texts[:1])
    if count >= len(rows) > 2 and all("." in text or "," in text for text in texts[1:]):
        check_count(f"{name}:{rows[0] + 1}", count, len(rows) - 1, "rows")
    return None


def runs_on(table: np.ndarray) -> bool:
    """Return whether the rows (n, columns) are one series wrapped into rows, rather than channels in columns.

    True if both criteria `SMOOTHER` and `ALIKE` are met. Channels cannot meet both: if m channels contain a common
    motion and independent noise, and x is the ratio of the mean squares of the steps of motion and noise, the ratio of
    `SMOOTHER` is (m + x)/(m (1 + x)), below 1/2 only for x > m/(m - 2), and the ratio of `ALIKE` is 1 + x.
    """
    if table.shape[0] < FEWEST_ROWS or table.shape[1] < 2:
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        inside = np.mean(np.diff(table, axis=1) ** 2, axis=0)
        behind = float(np.mean((table[1:, 0] - table[:-1, -1]) ** 2))
        down = float(np.mean(np.diff(table, axis=0) ** 2))
    across, usual = float(np.mean([*inside, behind])), float(np.median(inside))
    return across < SMOOTHER * down and usual < ALIKE * behind and behind < ALIKE * usual
