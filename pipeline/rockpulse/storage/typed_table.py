"""A long table as a workbook (.xlsx) or as Parquet, by the libraries that pandas takes for them."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.errors import ResultsError
from rockpulse.foreign_text import escaped
from rockpulse.storage.long_table import LongTable

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["TYPED", "check_library", "write_typed"]

#: Rows of a sheet, the headings among them.
SHEET_ROWS = 1_048_576

#: The library that writes each kind of file, in the extra "tables".
TYPED = {".xlsx": "openpyxl", ".parquet": "pyarrow"}


def check_library(path: Path) -> None:
    """Raise a ResultsError where the library for a table of this suffix is not installed."""
    library = TYPED[path.suffix]
    if find_spec(library) is None:
        raise ResultsError(
            f"{path}: a table of this kind is written by {library}, which is not installed: "
            "pip install 'rockpulse[tables]', or choose a name that ends in .csv"
        )


def write_typed(table: LongTable, part: Path, kind: str, seen: Callable[[pd.DataFrame], None]) -> None:
    """Write all rows to the file `part`, of the `kind` that a suffix names; `seen` is called with every frame.

    A text stays a text: a workbook takes none for a formula, and shows control characters as escapes. A ResultsError
    for more rows than a sheet has.
    """
    import pandas as pd

    if kind == ".parquet":
        frame = table.frame()
        seen(frame)
        frame.to_parquet(part, index=False, engine="pyarrow")
        return
    if len(table) >= SHEET_ROWS:
        raise ResultsError(
            f"{len(table)} rows, and a sheet holds {SHEET_ROWS - 1}: choose fewer (--where, --limit), or a name that "
            "ends in .csv or .parquet"
        )
    with part.open("wb") as file, pd.ExcelWriter(file, engine="openpyxl") as writer:
        written = 0
        for frame in table.frames():
            seen(frame)
            shown = frame.map(lambda value: escaped(value) if isinstance(value, str) else value)
            shown.to_excel(writer, sheet_name=table.group[:31], index=False, header=not written, startrow=written)
            written += len(frame) + (not written)
        for cells in writer.sheets[table.group[:31]].iter_rows():
            for cell in cells:
                if cell.data_type == "f":
                    cell.data_type = "s"
