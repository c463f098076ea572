"""Tables that the user gives, as texts: a heading, rows of as many cells, and numbers with points or commas."""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["numbers", "separator", "table_of"]

#: A number with a decimal comma, as it may stand between semicolons or tabs.
DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)")


def separator(text: str) -> str:
    """What stands between the cells of the first line of a table."""
    head = text.lstrip("\n").partition("\n")[0]
    return next((mark for mark in (";", "\t") if mark in head), ",")


def table_of(path: str, text: str) -> pd.DataFrame:
    """The cells of a table as texts without blanks around them; lines that are empty or begin with # are passed over.

    Where semicolons or tabs stand between the cells, numbers may have decimal commas. Cells that are missing at the end
    of a row are empty.

    Raises
    ------
    ConfigError
        For no heading, a column that stands twice, or a row of more cells than the heading has.
    """
    import pandas as pd

    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    between = separator("\n".join(lines[:1]))
    try:
        rows = [
            [cell.strip() for cell in row]
            for row in csv.reader(io.StringIO("\n".join(lines)), delimiter=between, skipinitialspace=True)
        ]
    except csv.Error as error:
        raise ConfigError(f"{path}: cannot be read as a table: {first_line(error)}") from None
    heads, *cells = [_without_empty_end(row) for row in rows] or [[]]
    if twice := [name for name in dict.fromkeys(heads) if heads.count(name) > 1]:
        raise ConfigError(f"{path}: expected each column once, found {twice[0]!r} {heads.count(twice[0])} times")
    for number, row in enumerate(cells, start=1):
        if len(row) > len(heads):
            raise ConfigError(
                f"{path}: row {number}: expected {len(heads)} cells, as the heading has, found {len(row)}: {row}"
            )
    if between != ",":
        cells = [
            [DECIMAL_COMMA.sub(r"\1.\2", cell) if DECIMAL_COMMA.fullmatch(cell) else cell for cell in row]
            for row in cells
        ]
    return pd.DataFrame([row + [""] * (len(heads) - len(row)) for row in cells], columns=heads, dtype=str)


def numbers(path: str, table: pd.DataFrame, column: str) -> np.ndarray:
    """A column (n,) of finite numbers; ConfigError where a cell is none."""
    import pandas as pd

    found = pd.to_numeric(table[column], errors="coerce").to_numpy(dtype=float)
    wrong = ~np.isfinite(found)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ConfigError(
            f"{path}: row {row + 1} of column {column!r}: expected a number, found {table[column].iloc[row]!r}"
        )
    return found


def _without_empty_end(row: list[str]) -> list[str]:
    """The cells without the empty ones behind the last that is none, as spreadsheets write them."""
    count = max((place for place, cell in enumerate(row, start=1) if cell), default=0)
    return row[:count]
