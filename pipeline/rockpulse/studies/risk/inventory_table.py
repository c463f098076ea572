"""A table of free bodies, as an inventory lists them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rocking.body.block import Block
from rockpulse.errors import ConfigError
from rockpulse.input_file import read_text
from rockpulse.input_table import numbers, table_of

__all__ = ["Inventory", "read_inventory"]

#: Columns that a table has to have, and others that are read where they are there.
NEEDED, OPTIONAL = ("name", "width [m]", "height [m]"), ("restitution", "longitude", "latitude", "soil_factor")

#: Degrees between which a place on the Earth is.
DEGREES = {"longitude": (-180.0, 360.0), "latitude": (-90.0, 90.0)}


class Inventory(NamedTuple):
    """Free bodies, and what the table says of the ground below each."""

    names: list[str]
    block: Block  #: (m,)
    sites: np.ndarray | None  #: (m, 2) longitude and latitude [degrees]; None without these columns
    soil_factor: np.ndarray | None  #: (m,) factor on the levels of the hazard [-]; None without this column
    passed_over: tuple[str, ...]  #: other columns


def read_inventory(path: str | Path) -> Inventory:
    """Free rectangular bodies from a CSV table with the columns name, width [m] and height [m].

    It may have restitution, longitude and latitude [degrees] (or lon, lat) and soil_factor; others are passed over.

    Raises
    ------
    ConfigError
        For a file that is no such table, a name that is empty or twice, numbers that are not positive, half of a site
        or one that is none.
    """
    where = Path(path)
    if not where.exists() or where.is_dir():
        raise ConfigError(f"{path}: expected a table of bodies, found no file")
    table = table_of(str(path), read_text(where, what="a table of bodies"))
    table.columns = [_known(str(name)) for name in table.columns]
    if missing := [name for name in NEEDED if name not in table.columns]:
        raise ConfigError(f"{path}: expected the columns {', '.join(NEEDED)}; no column {' and '.join(missing)}")
    names = table["name"].tolist()
    if not names or "" in names or len(set(names)) < len(names):
        raise ConfigError(f"{path}: expected a name for each body, no two alike")
    known = {name: numbers(str(path), table, name) for name in (*NEEDED[1:], *OPTIONAL) if name in table.columns}
    for name, values in known.items():
        low, high = DEGREES.get(name, (0.0, np.inf))
        wrong = ~((low <= values) & (values <= high)) if name in DEGREES else values <= low
        if wrong.any():
            row = int(np.argmax(wrong))
            expected = f"degrees from {low:g} to {high:g}" if name in DEGREES else "a positive number"
            raise ConfigError(f"{path}: {names[row]}: {name}: expected {expected}, found {table[name].iloc[row]}")
    given = [name for name in DEGREES if name in known]
    if len(given) == 1:
        raise ConfigError(f"{path}: expected the columns longitude and latitude [degrees] or neither, found {given[0]}")
    width, height, restitution = known["width [m]"], known["height [m]"], known.get("restitution", "housner")
    try:
        block = Block(width=width, height=height, restitution=restitution, log=False)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    sites = np.stack([known[name] for name in DEGREES], axis=1) if given else None
    passed_over = tuple(name for name in table.columns if name not in (*NEEDED, *OPTIONAL))
    return Inventory(names, block, sites, known.get("soil_factor"), passed_over)


def _known(name: str) -> str:
    """The name of a column as it is known here, where it is only spelt in another way."""
    plain = re.sub(r"\s*\[(deg|degrees|°|-)\]$", "", name.lower()).replace(" ", "_")
    plain = {"lon": "longitude", "lat": "latitude"}.get(plain, plain)
    if plain in OPTIONAL:
        return plain
    return name.lower() if name.lower() in NEEDED else name
