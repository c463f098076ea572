"""A table of free bodies, as an inventory lists them."""

from __future__ import annotations

import io
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from rocking.block import Block
from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line
from rockpulse.input_file import read_text

__all__ = ["Inventory", "read_inventory"]

#: Degrees between which a place on the Earth is.
DEGREES = {"longitude": (-180.0, 360.0), "latitude": (-90.0, 90.0)}


class Inventory(NamedTuple):
    """Free bodies, and what the table says of the ground below each."""

    names: list[str]
    block: Block  #: (m,)
    sites: np.ndarray | None  #: (m, 2) longitude and latitude [degrees]; None without these columns
    soil_factor: np.ndarray | None  #: (m,) factor on the levels of the hazard [-]; None without this column


def read_inventory(path: str | Path) -> Inventory:
    """Free rectangular bodies from a CSV table with the columns name, width [m] and height [m].

    It may have restitution, longitude and latitude [degrees], soil factor, and others, which are passed over.

    Raises
    ------
    ConfigError
        For a file that is no such table, a name that is empty or twice, numbers that are not positive, half of a site
        or one that is none.
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
    positive = [*needed[1:], *(name for name in ("restitution", "soil factor") if name in table.columns)]
    values = table.apply(pd.to_numeric, errors="coerce")
    _check(path, table, names, positive, values[positive].gt(0.0) & np.isfinite(values[positive]), "positive numbers")
    given = [name for name in ("longitude", "latitude") if name in table.columns]
    if len(given) == 1:
        raise ConfigError(f"{path}: expected the columns longitude and latitude [degrees] or neither, found {given[0]}")
    if given:
        known = pd.DataFrame({name: values[name].between(*ends) for name, ends in DEGREES.items()})
        _check(path, table, names, given, known, "a longitude from -180 to 360 and a latitude from -90 to 90 degrees")
    restitution = values["restitution"].to_numpy(dtype=float) if "restitution" in table.columns else "housner"
    size = {name: values[f"{name} [m]"].to_numpy(dtype=float) for name in ("width", "height")}
    try:
        block = Block(**size, restitution=restitution, log=False)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    sites = values[given].to_numpy(dtype=float) if given else None
    soil_factor = values["soil factor"].to_numpy(dtype=float) if "soil factor" in table.columns else None
    return Inventory(names, block, sites, soil_factor)


def _check(
    path: str | Path, table: pd.DataFrame, names: list[str], columns: list[str], good: pd.DataFrame, expected: str
) -> None:
    """Raise ConfigError for the first body with a cell that is not good."""
    wrong = ~good.all(axis=1).to_numpy()
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ConfigError(f"{path}: {names[row]}: expected {expected}, found {table[columns].iloc[row].tolist()}")
