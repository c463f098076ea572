"""The numbers of a table: all at once where the rows are sound, else the row to blame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.fields import free_numbers
from rockpulse.readers.table_layout import LINE_LIMIT, NUMBER, Layout, split_row

__all__ = ["as_float", "check_decimals", "read_table"]

_AS_PYTHON = str.maketrans({",": ".", "d": "e", "D": "e"})
_SHOWN = 80
#: Rows that are read, and blamed, together.
_PART = 2000


def as_float(text: str) -> float:
    """The value of a field that is a `NUMBER`."""
    return float(text.translate(_AS_PYTHON))


def check_decimals(name: str, rows: Sequence[str], layout: Layout, first: int, named: bool) -> None:
    """Refuse commas that may be separators as well as decimal marks; blank rows are allowed.

    `rows[0]` is line `first` of the file `name`, from 1; `named` tells that there is a heading for each column, which
    shows that commas are separators.
    """
    points = any("." in row for row in rows)
    if layout.delimiter == "," and layout.width > 1 and not points and (layout.width == 2 or not named):
        raise RecordFormatError(
            f"{name}:{first}: expected to know whether a comma separates columns or marks decimals, found "
            f"{rows[0].strip()[:_SHOWN]!r} and no point in any row; write decimal points, or separate the columns "
            "with ';'"
        )
    if layout.decimal == "," and points:
        at = next(index for index, row in enumerate(rows) if "." in row)
        raise RecordFormatError(
            f"{name}:{first + at}: expected commas as decimal marks like in other rows, found a point in "
            f"{rows[at].strip()[:_SHOWN]!r}; write one decimal mark throughout"
        )


def read_table(name: str, rows: Sequence[str], layout: Layout, first: int) -> np.ndarray:
    """The numbers (n, columns) of the rows; blank rows and separators at the end of a row do no harm.

    Raises RecordFormatError with the line of the first row that is not `width` finite numbers.
    """
    table = _numbers(rows, layout)
    if table is not None:
        return table
    parts = [np.empty((0, layout.width))]
    for at in range(0, len(rows), _PART):
        part = rows[at : at + _PART]
        kept = [row for row in (_bare(row, layout) for row in part) if row]
        table = _numbers(kept, layout)
        if kept and table is None:
            raise _blamed(name, part, layout, first + at)
        parts += [] if table is None else [table]
    return np.concatenate(parts)


def _bare(row: str, layout: Layout) -> str:
    return row.strip().rstrip(layout.delimiter) if layout.delimiter else row.strip()


def _blamed(name: str, rows: Sequence[str], layout: Layout, first: int) -> RecordFormatError:
    """The error for the first row that is not `width` finite numbers."""
    other = {",": ".", ".": ","}[layout.decimal]
    for index, line in enumerate(rows):
        row = _bare(line, layout)
        fields = split_row(row, layout.delimiter) if len(row) <= LINE_LIMIT else []
        sound = all(NUMBER.fullmatch(field) and other not in field and np.isfinite(as_float(field)) for field in fields)
        if row and not (sound and len(fields) == layout.width):
            return RecordFormatError(
                f"{name}:{first + index}: expected {layout.width} finite numbers, found {row[:_SHOWN]!r}; "
                "repair the line or cut the record there"
            )
    return RecordFormatError(
        f"{name}:{first}: the rows cannot be read as {layout.width} columns of numbers; write them with one "
        "separator and one decimal mark"
    )


def _numbers(rows: Sequence[str], layout: Layout) -> np.ndarray | None:
    """All rows at once, (n, columns); None unless every row has its separators and its numbers."""
    if any(len(row) > LINE_LIMIT for row in rows):
        return None
    text = "\n".join(rows).replace('"', " ")
    if not text or text.endswith("\n") or not text.isascii():
        return None
    codes = np.frombuffer(text.encode(), dtype=np.uint8)
    starts = np.append(0, np.flatnonzero(codes == ord("\n")))  # a row with the break before it
    if layout.delimiter:
        separators = np.add.reduceat(codes == ord(layout.delimiter), starts, dtype=np.intp)
        if np.any(separators != layout.width - 1):
            return None
        text = text.replace(layout.delimiter, " ")
    filled = np.frombuffer(text.encode(), dtype=np.uint8) > ord(" ")
    begins = filled & ~np.append(False, filled[:-1])
    if np.any(np.add.reduceat(begins, starts, dtype=np.intp) != layout.width):
        return None
    try:
        return free_numbers([text.replace(",", ".") if layout.decimal == "," else text], 1, "").reshape(
            -1, layout.width
        )
    except RecordFormatError:
        return None
