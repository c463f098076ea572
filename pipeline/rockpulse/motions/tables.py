"""The user's own tables of a site: which records are of one event, and what each record weighs."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rockpulse.errors import ConfigError

__all__ = ["read_event_table", "read_weight_table", "record_weights"]


def read_event_table(path: Path) -> dict[str, str]:
    """Event of each channel from a CSV table with the columns record, event; further columns are passed over.

    Raises ConfigError for a table without these columns, an empty cell, or a record that is in it twice; OSError where
    the file cannot be opened.
    """
    return _read(path, "event", "[records] events")


def read_weight_table(path: Path) -> dict[str, float]:
    """Weight of each record from a CSV table with the columns record, weight; further columns are passed over.

    Raises as :func:`read_event_table`, and for a weight that is no finite number from 0 up.
    """
    weights = {}
    for record, text in _read(path, "weight", "[calibration] weights").items():
        try:
            weight = float(text)
        except ValueError:
            weight = math.nan
        if not (math.isfinite(weight) and weight >= 0.0):
            raise ConfigError(
                f"[calibration] weights: {path}: record {record}: expected a number from 0 up, found {text!r}"
            )
        weights[record] = weight
    return weights


def record_weights(ids: Sequence[str], events: Sequence[str], rule: str, table: dict[str, float] | None) -> np.ndarray:
    """Weight (n,) of every record, of mean one.

    By the rule "equal" every record weighs the same, by "event" every event, shared by its records; any other rule is
    the name of the table of weights by id.

    Raises
    ------
    ConfigError
        For a record that is not in the table, or weights that are all zero.

    Examples
    --------
    >>> record_weights(["a", "b", "c"], ["Kobe", "Kobe", "Maule"], "event", None).tolist()
    [0.75, 0.75, 1.5]
    """
    if rule == "equal":
        weights = np.ones(len(ids))
    elif rule == "event":
        weights = np.array([1.0 / list(events).count(event) for event in events])
    else:
        table = table or {}
        if missing := [name for name in ids if name not in table]:
            raise ConfigError(
                f"[calibration] weights: {rule} has no weight for {len(missing)} of {len(ids)} records: "
                f"{', '.join(missing[:5])}; give every record one, 0 to leave it out"
            )
        weights = np.array([table[name] for name in ids])
        if not np.any(weights > 0.0):
            raise ConfigError(f"[calibration] weights: {rule}: the weights of all records are 0")
        weights = weights / weights.max()  # the sum of huge weights is no number
    return np.asarray(weights / weights.mean()) if weights.size else weights


def _read(path: Path, column: str, where: str) -> dict[str, str]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, skipinitialspace=True, strict=True)
            rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(map(str.strip, row))]
    except (csv.Error, UnicodeError) as error:
        raise ConfigError(f"{where}: {path}: expected a CSV table with the columns record, {column}: {error}") from None
    if not rows:
        raise ConfigError(f"{where}: {path}: expected a CSV table with the columns record, {column}; it is empty")
    header = rows[0][1]
    if missing := [name for name in ("record", column) if name not in header]:
        raise ConfigError(
            f"{where}: {path}: expected the columns record, {column}; "
            f"no column {' and '.join(missing)} among {', '.join(header)}"
        )
    found: dict[str, str] = {}
    for line, row in rows[1:]:
        if len(row) > len(header):
            raise ConfigError(
                f"{where}: {path}: row {line}: expected the {len(header)} cells of the header, found {len(row)}; "
                "a comma within a cell needs quotes"
            )
        cells = dict(zip(header, row, strict=False))
        name, value = cells.get("record", ""), cells.get(column, "")
        if not name or not value:
            raise ConfigError(f"{where}: {path}: row {line}: expected a record and its {column}, found an empty cell")
        if name in found:
            raise ConfigError(f"{where}: {path}: row {line}: more than one row for {name}")
        found[name] = value
    return found
