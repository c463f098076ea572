"""Tables of a study: printed in plain columns, and written as CSV."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd


def plain(frame: pd.DataFrame, formats: Mapping[str, Callable[[Any], str]] | None = None) -> str:
    """The columns of a table that have a format (all without), each value in its format and a missing one as "-"."""
    formats = {str(name): str for name in frame} if formats is None else formats
    shown = {
        name: ["-" if isinstance(value, float) and np.isnan(value) else show(value) for value in frame[name]]
        for name, show in formats.items()
    }
    return pd.DataFrame(shown, dtype=str).to_string(index=False)


def write_tables(folder: Path, tables: Mapping[str, pd.DataFrame]) -> None:
    """Write ``NAME.csv`` of each table into a folder, which is made where it does not exist."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, table in tables.items():
        table.to_csv(folder / f"{name}.csv", index=False)
