"""The user's own tables of a site: which records are of one event, and what each record weighs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from rockpulse.errors import ConfigError

__all__ = ["read_event_table", "read_weight_table", "record_weights"]


def read_event_table(path: Path) -> dict[str, str]:
    """Event of each channel from a CSV table with the columns record, event.

    Parameters
    ----------
    path : Path
        The table; further columns are passed over.

    Raises
    ------
    ConfigError
        For a table without these columns, an empty cell, or a record that is in it twice.
    OSError
        Where the file cannot be opened.
    """
    return _read(path, "event", "[records] events")


def read_weight_table(path: Path) -> dict[str, float]:
    """Weight of each record from a CSV table with the columns record, weight.

    Parameters
    ----------
    path : Path
        The table; further columns are passed over.

    Raises
    ------
    ConfigError
        As in :func:`read_event_table`, and for a weight that is no finite number from 0 up.
    OSError
        Where the file cannot be opened.
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
    """Weight of every record, of mean one.

    Parameters
    ----------
    ids, events : sequence of str, length n
        Id and event of each record.
    rule : {"equal", "event"} or str
        Every record the same; every event the same, shared by its records; else the name of the table.
    table : dict of str to float or None
        Weight by id, where the rule is a table.

    Returns
    -------
    (n,) ndarray

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
    return np.asarray(weights / weights.mean()) if weights.size else weights


def _read(path: Path, column: str, where: str) -> dict[str, str]:
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False, skipinitialspace=True, encoding="utf-8-sig")
    except (ValueError, UnicodeError) as error:  # the parser's own errors are ValueErrors
        raise ConfigError(f"{where}: {path}: expected a CSV table with the columns record, {column}: {error}") from None
    table.columns = table.columns.str.strip()
    if missing := [name for name in ("record", column) if name not in table.columns]:
        raise ConfigError(
            f"{where}: {path}: expected the columns record, {column}; "
            f"no column {' and '.join(missing)} among {', '.join(map(str, table.columns))}"
        )
    names, values = table["record"].str.strip().tolist(), table[column].str.strip().tolist()
    for line, (name, value) in enumerate(zip(names, values, strict=True), start=2):
        if not name or not value:
            raise ConfigError(f"{where}: {path}: row {line}: expected a record and its {column}, found an empty cell")
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"{where}: {path}: more than one row for {', '.join(twice[:5])}")
    return dict(zip(names, values, strict=True))
