"""Reads the user's tables of records: their earthquakes, scale factors and weights."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from rockpulse.config.configuration import Config, located
from rockpulse.errors import ConfigError
from rockpulse.files import column_numbers, read_table


def read_event_table(path: Path) -> dict[str, str]:
    """Read the earthquake of each channel from a CSV table with the columns record and event."""
    return _by_record(path, "event", "[records] events")


def read_weight_table(path: Path) -> dict[str, float]:
    """Read the weight of each record from a CSV table with the columns record and weight; weights are not negative."""
    weights = {}
    for record, text in _by_record(path, "weight", "[calibration] weights").items():
        try:
            weight = float(text)
        except ValueError:
            weight = math.nan
        if not 0.0 <= weight < math.inf:
            raise ConfigError(f"[calibration] weights: {path}: record {record}: expected a number >= 0, found {text!r}")
        weights[record] = weight
    return weights


def _by_record(path: Path, column: str, where: str) -> dict[str, str]:
    """Return the cell of a column for each record; raise ConfigError for an empty cell or a repeated record."""
    table = read_table(path, ("record", column), f"a CSV table with the columns record and {column}", where)
    found: dict[str, str] = {}
    for row, (name, value) in enumerate(zip(table["record"], table[column], strict=True), start=1):
        if not name or not value:
            raise ConfigError(f"{where}: {path}: row {row}: expected a record and its {column}, found an empty cell")
        if name in found:
            raise ConfigError(f"{where}: {path}: row {row}: more than one row for {name}; keep one")
        found[name] = value
    return found


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
    columns = "record and factor" + " (or level)" * where.startswith("[fragility]")
    table = read_table(path, ("record",), f"a CSV table with the columns {columns}", where)
    name = f"{where}: {path}"
    kinds = [kind for kind in ("factor", "level") if kind in table]
    if len(kinds) != 1:
        raise ConfigError(
            f"{name}: expected either a column factor or a column level, found {' and '.join(kinds) or 'neither'} "
            f"(columns: {', '.join(table.columns)})"
        )
    amounts = column_numbers(name, table, kinds[0], above=0.0).tolist()
    weights = column_numbers(name, table, "weight", above=0.0).tolist() if "weight" in table else [1.0] * len(table)
    found: dict[str, list[tuple[float, float]]] = {}
    for row, (record, amount, weight) in enumerate(zip(table["record"], amounts, weights, strict=True), start=1):
        if not record:
            raise ConfigError(f"{name}: row {row}: expected the id of a record, found an empty cell")
        own = found.setdefault(record, [])
        if amount in dict(own):
            raise ConfigError(f"{name}: row {row} repeats {kinds[0]} {amount:g} of {record}; remove it")
        own.append((amount, weight))
    if not found:
        raise ConfigError(f"{name}: expected a row for each record that was chosen, found none")
    return SelectedRecords(kinds[0] == "factor", {record: tuple(sorted(own)) for record, own in found.items()})


def selection_of(config: Config) -> SelectedRecords | None:
    """Return the records of the table ``[fragility] selection``; None if no table is given."""
    given = config.fragility.selection
    return None if given is None else read_selection_table(located(given, config.folder))


def demand_selections(config: Config) -> dict[str, dict[str, float]]:
    """Return the scale factor of each record id, for each demand that has a table of them, by the demand's name."""
    found = {}
    for demand in config.demands:
        if demand.selection is not None:
            path = located(demand.selection, config.folder)
            state = path.stat().st_mtime_ns if path.exists() else 0
            found[demand.name] = _factors(path, f"[[demand]] {demand.name}: selection", state)
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
