"""Reads the user's tables of records: their earthquakes, scale factors and weights."""

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from rockpulse.config.configuration import Config, located
from rockpulse.errors import ConfigError
from rockpulse.files import read_text


def read_event_table(path: Path) -> dict[str, str]:
    """Read the earthquake of each channel from a CSV table with the columns record and event."""
    return _read(path, "event", "[records] events")


def read_weight_table(path: Path) -> dict[str, float]:
    """Read the weight of each record from a CSV table with the columns record and weight; weights are not negative."""
    weights = {}
    for record, text in _read(path, "weight", "[calibration] weights").items():
        weight = _number(text)
        if not weight >= 0.0:
            raise ConfigError(f"[calibration] weights: {path}: record {record}: expected a number >= 0, found {text!r}")
        weights[record] = weight
    return weights


def record_weights(ids: Sequence[str], events: Sequence[str], rule: str, table: dict[str, float] | None) -> np.ndarray:
    """Return the weights (n,) of records, with mean 1: equal, equal for each earthquake ("event"), or from a table."""
    if rule == "equal":
        weights = np.ones(len(ids))
    elif rule == "event":
        weights = np.array([1.0 / list(events).count(event) for event in events])
    else:
        table = table or {}
        if missing := [name for name in ids if name not in table]:
            raise ConfigError(
                f"[calibration] weights: {rule} has no weight for {len(missing)} of {len(ids)} records: "
                f"{', '.join(missing[:5])}; give every record a weight (0 leaves it out)"
            )
        weights = np.array([table[name] for name in ids])
        if not np.any(weights > 0.0):
            raise ConfigError(f"[calibration] weights: {rule}: the weights of all records are 0; give one above 0")
        weights = weights / weights.max()  # the sum of very large weights would overflow
    return np.asarray(weights / weights.mean()) if weights.size else weights


@dataclass(frozen=True)
class SelectedRecords:
    """The records that the user has selected for a fragility analysis, with scale factors or intensities."""

    by_factor: bool  # whether amounts are scale factors; otherwise they are values of the intensity measure
    rows: dict[str, tuple[tuple[float, float], ...]]  # amount and weight of each row, by record id

    @property
    def most(self) -> int:
        """Largest number of rows of any record."""
        return max(map(len, self.rows.values()))


def read_selection_table(path: Path, where: str = "[fragility] selection") -> SelectedRecords:
    """Read selected records from a CSV table with the columns record, factor (or level) and optionally weight."""
    header, lines = _rows(path, ("record",), where)
    kinds = [name for name in ("factor", "level") if name in header]
    if len(kinds) != 1:
        raise ConfigError(
            f"{where}: {path}: expected either a column factor or a column level, found "
            f"{' and '.join(kinds) or 'neither'} (columns: {', '.join(header)})"
        )
    found: dict[str, list[tuple[float, float]]] = {}
    for line, cells in lines:
        values = []
        for name in (kinds[0], *(("weight",) if "weight" in header else ())):
            text = cells.get(name, "")
            value = _number(text)
            if not value > 0.0:
                raise ConfigError(f"{where}: {path}: row {line}: {name}: expected a number above 0, found {text!r}")
            values.append(value)
        record = cells.get("record", "")
        if not record:
            raise ConfigError(f"{where}: {path}: row {line}: expected the id of a record, found an empty cell")
        own = found.setdefault(record, [])
        if any(amount == values[0] for amount, _ in own):
            raise ConfigError(f"{where}: {path}: row {line} repeats {kinds[0]} {values[0]:g} of {record}; remove it")
        own.append((values[0], values[1] if len(values) > 1 else 1.0))
    if not found:
        raise ConfigError(f"{where}: {path}: expected a row for each record that was chosen, found none")
    return SelectedRecords(kinds[0] == "factor", {record: tuple(sorted(own)) for record, own in found.items()})


def selection_of(config: Config) -> SelectedRecords | None:
    """Return the records of the table ``[fragility] selection``; None if no table is given."""
    given, columns = config.fragility.selection, "record, factor or level, and perhaps weight"
    return None if given is None else read_selection_table(given_table(given, config, "[fragility] selection", columns))


def demand_selections(config: Config) -> dict[str, dict[str, float]]:
    """Return the scale factor of each record id, for each demand that has a table of them, by the demand's name."""
    found = {}
    for demand in config.demands:
        if demand.selection is not None:
            where = f"[[demand]] {demand.name}: selection"
            path = given_table(demand.selection, config, where, "record and factor")
            found[demand.name] = _factors(path, where, path.stat().st_mtime_ns)
    return found


@lru_cache(maxsize=16)
def _factors(path: Path, where: str, state: int) -> dict[str, float]:
    """Return the scale factor of each record id in a table; the result is cached for the other records of a run."""
    table = read_selection_table(path, where)
    if not table.by_factor:
        raise ConfigError(f"{where}: {path}: expected the column factor (scale factor of each record), found level")
    if several := [record for record, rows in table.rows.items() if len(rows) > 1]:
        raise ConfigError(
            f"{where}: {path}: expected one row for each record, found {len(table.rows[several[0]])} for {several[0]}"
        )
    return {record: rows[0][0] for record, rows in table.rows.items()}


def given_table(given: str, config: Config, where: str, columns: str) -> Path:
    """Return the path of a table that the configuration names; raise ConfigError if the file does not exist."""
    path = located(given, config.folder)
    if not path.exists():
        raise ConfigError(f"{where}: {path}: no such file; expected a CSV table with the columns {columns}")
    return path


def _number(text: str) -> float:
    """Convert a text to a finite number; return NaN for other text."""
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def _read(path: Path, column: str, where: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for line, cells in _rows(path, ("record", column), where)[1]:
        name, value = cells.get("record", ""), cells.get(column, "")
        if not name or not value:
            raise ConfigError(f"{where}: {path}: row {line}: expected a record and its {column}, found an empty cell")
        if name in found:
            raise ConfigError(f"{where}: {path}: row {line}: more than one row for {name}; keep one")
        found[name] = value
    return found


def _rows(path: Path, columns: Sequence[str], where: str) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return the header of a CSV table, and each row as line number and cells; ConfigError if a column is missing."""
    named = " and ".join(columns) if columns[1:] else f"{columns[0]} and factor (or level)"
    expected = f"a CSV table with the columns {named}"
    text = read_text(path, what=expected)
    try:
        reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True, strict=True)
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(map(str.strip, row))]
    except csv.Error as error:
        raise ConfigError(f"{where}: {path}: expected {expected}: {error}") from None
    if not rows:
        raise ConfigError(f"{where}: {path}: expected {expected}; it is empty")
    header = rows[0][1]
    if missing := [name for name in columns if name not in header]:
        raise ConfigError(
            f"{where}: {path}: expected the columns {named}; missing: {', '.join(missing)}; found: {', '.join(header)}"
        )
    found = []
    for line, row in rows[1:]:
        if len(row) > len(header):
            raise ConfigError(
                f"{where}: {path}: row {line}: expected the {len(header)} cells of the header, found {len(row)}; "
                "a comma within a cell needs quotes"
            )
        found.append((line, dict(zip(header, row, strict=False))))
    return header, found
