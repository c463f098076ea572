"""Tables of bodies (CSV or XLSX): one row for each body, one column for each key, with units in the headings."""

import difflib
import math
import re
from collections.abc import Iterable
from dataclasses import fields
from decimal import Decimal, InvalidOperation
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import section_of, toml_key
from rockpulse.errors import ConfigError
from rockpulse.files import read_table, table_of

if TYPE_CHECKING:
    import pandas as pd

#: Columns that describe the site of a body, with their units (only the command `risk` uses them), and short spellings.
SITE = {"longitude": "degrees", "latitude": "degrees", "soil_factor": ""}
_SPELLINGS = {"lon": "longitude", "lat": "latitude"}
#: Units allowed in a heading for each unit of the configuration, and their factors.
_DEGREES = dict.fromkeys(("degrees", "deg", "°"), "1")
_UNITS: dict[str, dict[str, str]] = {
    "": {"": "1", "-": "1"},
    "m": {"m": "1", "cm": "0.01", "mm": "0.001", "ft": "0.3048", "in": "0.0254"},
    "kg": {"kg": "1", "t": "1000"},
    "N": {"N": "1", "kN": "1000"},
    "N/m": {"N/m": "1", "kN/m": "1000", "N/mm": "1000", "kN/mm": "1000000"},
    "Pa": {"Pa": "1", "kPa": "1000", "MPa": "1000000", "GPa": "1000000000"},
    "kg/m3": {"kg/m3": "1", "t/m3": "1000"},
    "degrees": {"": "1", **_DEGREES},
    "rad": {"rad": "1", **dict.fromkeys(_DEGREES, repr(math.pi / 180.0))},
}
#: Smallest similarity at which an unknown heading is a misspelt key rather than a column of the user's own.
_MISSPELT = 0.75
_WORDS = {"true": True, "yes": True, "false": False, "no": False}
_TEMPLATE = (
    "name,width [m],height [m],restitution,friction,mass [kg],azimuth [degrees]",
    "statue,0.5,1.8,housner,0.6,,",
    "cabinet,0.4,2,0.85,,,",
)


class BodyColumns(NamedTuple):
    """A table of bodies as text, in the units of the configuration, with keys as headings."""

    cells: "pd.DataFrame"
    unused: tuple[str, ...]  #: headings that are not keys


@cache
def _keys() -> dict[str, str]:
    """Return the unit of each known column: keys of [[block]] such as "width" and "tie.height", and keys of `SITE`."""
    found: dict[str, str] = {}
    for item in fields(BlockSettings):
        entry = item.metadata.get("entries")
        keys = {item.name: item}
        if entry is not None:  # a table within [[block]], such as [[block.tie]]
            keys = {f"{toml_key(item)}.{key.name}": key for key in fields(entry)}
        found |= {name: key.metadata["values"].unit for name, key in keys.items()}
    return found | SITE


def body_template() -> list[str]:
    """Return the lines of an example table with two bodies, with a comment that lists all other columns."""
    others = [f"{name} [{unit}]" if unit else name for name, unit in _keys().items()]
    others = [one for one in others if one not in _TEMPLATE[0].split(",")]
    return [
        "# Bodies of rockpulse assess RECORDS --bodies TABLE: one row for each body. Sizes are full sizes; an empty "
        "cell means the default.",
        f"# Further columns: {', '.join(others)}",
        *_TEMPLATE,
    ]


def read_body_columns(path: str | Path) -> BodyColumns:
    """Read a table of bodies, with numbers converted to the units of the configuration.

    Raises ConfigError if the table is missing, or if the heading of a column is a misspelt key, lacks the unit of the
    key, or has a wrong unit.
    """
    table = _table(Path(path))
    unused, taken = [], {}
    for heading in table.columns:
        name, unit = _parts(str(heading))
        if name not in _keys():
            if close := difflib.get_close_matches(name, _keys(), 1, _MISSPELT):
                raise ConfigError(f'{path}: column "{heading}": unknown key; did you mean "{close[0]}"?')
            unused.append(str(heading))
            continue
        allowed = _UNITS.get(_keys()[name], {_keys()[name]: "1"})
        if unit not in allowed:
            units, found = " or ".join(f"[{one}]" for one in allowed if one), f"[{unit}]" if unit else "no unit"
            raise ConfigError(f'{path}: column "{heading}": expected {units}, found {found}')
        if name in taken:
            raise ConfigError(f"{path}: expected one column of {name}, found two")
        factor = Decimal(allowed[unit])
        taken[name] = [_times(cell, factor) for cell in table[heading]]
    return BodyColumns(type(table)(taken, dtype=str), tuple(unused))


def _table(path: Path) -> "pd.DataFrame":
    what = "a table of bodies (CSV or XLSX)"
    if not path.is_file() or path.suffix.lower() not in (".xlsx", ".xlsm"):
        return read_table(path, (), what)
    from rockpulse.readers.arrays import sheet_texts

    try:
        sheets = sheet_texts(path.read_bytes())
    except ImportError:
        raise ConfigError(
            f"{path}: reading a workbook needs openpyxl: pip install openpyxl, or save the table as CSV"
        ) from None
    except Exception as fault:  # openpyxl may raise any error for a damaged part
        raise ConfigError(f"{path}: cannot be read as a workbook ({fault}); save it as CSV") from fault
    return table_of(str(path), sheets[0], quoted=False)


def _parts(heading: str) -> tuple[str, str]:
    """Return the key and the unit of a heading, such as "Yield force [kN]"."""
    name, _, unit = heading.replace("(", "[").partition("[")
    name = re.sub(r"\s+", "_", name.strip().lower())
    return _SPELLINGS.get(name, name), unit.rstrip(")] ").strip()


def _times(cell: str, factor: Decimal) -> str:
    """Return a cell with its numbers multiplied by a factor; other text is unchanged."""
    try:
        return cell if factor == 1 else " ".join(str(Decimal(word) * factor) for word in cell.split())
    except InvalidOperation:
        return cell


def _value(name: str, cell: str) -> Any:
    """Return the value of a cell: the text of a name, a number, several numbers, true or false, or a word."""
    if name == "name":
        return cell
    try:
        numbers = [float(word) for word in cell.split()]
    except ValueError:
        return _WORDS.get(cell.lower(), cell)
    return numbers[0] if len(numbers) == 1 else numbers


def unused_columns(path: str | Path, names: Iterable[str]) -> str:
    """Return a sentence on the columns of a table that are not used; empty if there are none."""
    return f"{path}: columns not used: {', '.join(names)}" if names else ""


def read_bodies(path: str | Path) -> tuple[tuple[BlockSettings, ...], tuple[str, ...]]:
    """Return the bodies of a table and the columns that are not used; raise the errors of :func:`load_bodies`."""
    cells, unused = read_body_columns(path)
    bodies = []
    for number, row in enumerate(cells.to_dict("records"), start=1):
        values: dict[str, Any] = {}
        for name, cell in row.items():
            section, _, key = str(name).rpartition(".")
            if cell and name not in SITE:
                (values.setdefault(section, [{}])[0] if section else values)[key] = _value(key, cell)
        try:
            bodies.append(section_of(BlockSettings, values))
        except ConfigError as error:
            raise ConfigError(f"{path}: row {number}: {error}") from None
    if not bodies:
        raise ConfigError(f"{path}: expected a row for each body below the headings, found none")
    return tuple(bodies), (*unused, *(name for name in cells.columns if name in SITE))


def load_bodies(path: str | Path) -> tuple[BlockSettings, ...]:
    """Read a table of bodies: a row for each body, a column for each key of ``[[block]]``.

    Parameters
    ----------
    path : str or Path
        A CSV file or the first sheet of a workbook (XLSX). Headings are keys with their unit in brackets, such as
        ``width [cm]``; a key without a unit has none. Columns such as ``tie.height [m]`` describe one tie, load,
        thrust, floor or pedestal of the body. An empty cell means the default of the key. Columns whose headings are
        not keys are ignored.

    Returns
    -------
    tuple of BlockSettings

    Raises
    ------
    ConfigError
        For a missing file, a heading without its unit, with a wrong unit or a misspelt key, or a value that the key
        does not allow.

    Examples
    --------
    >>> rp.load_bodies("bodies.csv")[1].block()
    <Block width 0.4 m, height 2 m, p 2.686 1/s, alpha_c 0.1974 rad, C 0.85>
    """
    return read_bodies(path)[0]
