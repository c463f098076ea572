"""A table of free bodies, as an inventory lists them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pandas as pd

from rocking.block import Block
from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line
from rockpulse.input_file import read_text

__all__ = ["read_inventory"]


def read_inventory(path: str | Path) -> tuple[list[str], Block]:
    """Free rectangular bodies from a CSV table with the columns name, width [m], height [m], perhaps restitution.

    Raises
    ------
    ConfigError
        For a file that is no such table, a name that is empty or twice, or numbers that are not positive.
    """
    where = Path(path)
    if not where.exists() or where.is_dir():
        raise ConfigError(f"{path}: expected a table of bodies, found no file")
    text = read_text(where, what="a table of bodies")
    try:
        table = pd.read_csv(io.StringIO(text), comment="#", skipinitialspace=True, dtype={"name": str})
    except ValueError as error:
        raise ConfigError(f"{path}: cannot be read as a table of bodies: {first_line(error)}") from None
    needed = ["name", "width [m]", "height [m]"]
    if missing := [name for name in needed if name not in table.columns]:
        raise ConfigError(f"{path}: expected the columns {', '.join(needed)}; no column {' and '.join(missing)}")
    names = table["name"].fillna("").tolist()
    if not names or "" in names or len(set(names)) < len(names):
        raise ConfigError(f"{path}: expected a name for each body, no two alike")
    columns = [*needed[1:], *(["restitution"] if "restitution" in table.columns else [])]
    values = table[columns].apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    wrong = ~(np.isfinite(values) & (values > 0.0)).all(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ConfigError(f"{path}: {names[row]}: expected positive numbers, found {table[columns].iloc[row].tolist()}")
    restitution = values[:, 2] if len(columns) > 2 else "housner"
    try:
        return names, Block(width=values[:, 0], height=values[:, 1], restitution=restitution, log=False)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
