"""The variables of the results that grow with the records: dimensions, type, unit, meaning (docs/schema.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.predictability import NOT_CHECKED
from rocking.response import Outcome, Reason
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.ladder import USED
from rockpulse.storage.variables import (
    ANSWER,
    CAPACITY_RATIO,
    DEMAND,
    HALF_CYCLE,
    OVERTURNING,
    RECORD,
    WAVES,
    Meaning,
    described,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["RECORD_ID", "Column", "growing_columns", "lane_dimensions", "sizes_of"]

RECORD_ID: Meaning = (str, "1", "record id")

#: Names of the values of flag variables, and the first value where that is not 0.
FLAGS: dict[str, tuple[Sequence[str], int]] = {
    "pgv_drift": (["reliable", "drift"], 0),
    "outcome": ([outcome.name.lower() for outcome in Outcome], 0),
    "reason": ([reason.name.lower() for reason in Reason], 0),
    "model_used": (USED, 0),
    "factor_resolved": (["not_computed", "no", "yes"], -1),
    "applicable": (["outside_range", "applicable"], 0),
    "predictable": (["not_checked", "no", "yes"], NOT_CHECKED),
    "open": (["no", "yes"], 0),
    "resolved": (["no", "yes"], 0),
}


@dataclass(frozen=True)
class Column:
    """A variable whose first dimension grows with the records.

    Attributes
    ----------
    dims : tuple of str
        Its dimensions.
    meaning : Meaning
        Type, unit, long name.
    attrs : mapping
        What else is stored with it.
    """

    dims: tuple[str, ...]
    meaning: Meaning
    attrs: Mapping[str, Any] = field(default_factory=dict)

    def values(self, values: Any) -> np.ndarray:
        """The values in the type of the variable."""
        return np.asarray(values, dtype=self.meaning[0])

    def empty(self, sizes: Mapping[str, int]) -> np.ndarray:
        """Its values without any record; `sizes` are those of the other dimensions."""
        return np.zeros((0, *(sizes[dim] for dim in self.dims[1:])), dtype=self.meaning[0])

    def variable(self, values: np.ndarray) -> xr.Variable:
        """The values with all that describes them."""
        variable = described(self.dims, values, self.meaning)
        variable.attrs.update(self.attrs)
        return variable


def lane_dimensions(bodies: Bodies) -> tuple[str, ...]:
    """Block and, where bodies have several restitutions, case."""
    return ("block", "case") if bodies.cases > 1 else ("block",)


def sizes_of(bodies: Bodies, config: Config) -> dict[str, int]:
    """Sizes of the dimensions that do not grow with the records."""
    return {
        "block": len(bodies.names),
        "case": bodies.cases,
        "model": len(config.models.answering),
        "demand": len(config.demands),
    }


def growing_columns(bodies: Bodies, config: Config) -> dict[str, Column]:
    """Every variable that grows with the records, by its path in the file.

    Parameters
    ----------
    bodies : Bodies
        The bodies that are assessed.
    config : Config
        Says which groups there are.
    """
    lanes = ("record", *lane_dimensions(bodies))
    groups: dict[str, dict[str, Column]] = {
        "/summary": {
            **_columns(("record",), {"record": RECORD_ID, **RECORD}),
            **_columns(lanes, DEMAND),
            **_columns((*lanes, "model"), ANSWER, _comments(config)),
        },
        "/half_cycles": _columns(("row",), HALF_CYCLE),
        "/overturning_intervals": _columns(("interval",), OVERTURNING),
    }
    if config.demands:
        groups["/summary"]["capacity_ratio"] = Column((*lanes, "model", "demand"), CAPACITY_RATIO)
    if config.records.store != "none":
        groups["/records"] = _record_columns(config)
    return {f"{group}/{name}": column for group, columns in groups.items() for name, column in columns.items()}


def _columns(
    dims: tuple[str, ...], meanings: Mapping[str, Meaning], comments: Mapping[str, str] | None = None
) -> dict[str, Column]:
    columns = {}
    for name, meaning in meanings.items():
        attrs: dict[str, Any] = {}
        if name in FLAGS:
            words, first = FLAGS[name]
            attrs["flag_values"] = np.arange(first, first + len(words), dtype=np.int8)
            attrs["flag_meanings"] = " ".join(words)
        if comments and name in comments:
            attrs["comment"] = comments[name]
        columns[name] = Column(dims, meaning, attrs)
    return columns


def _comments(config: Config) -> dict[str, str]:
    checked = f"relative changes of C and the record by 1e-9; peaks to {config.models.tolerance:g}"
    if config.models.output == "outcome":
        checked += "; of auto the outcome alone"
    return {
        "safety_factor": (
            f"searched up to a factor of {config.search.factor_max:g} in steps of search_step, edges to 1e-6; inf if "
            "none; a factor at which the model cannot answer counts as overturning (factor_resolved)"
        ),
        "predictable": checked,
    }


def _record_columns(config: Config) -> dict[str, Column]:
    """Ragged arrays: the values of all records one after the other, with the number of each."""
    columns = {
        "record": Column(("record",), RECORD_ID),
        "half_wave_row_size": _ragged("wave", "record", "half-waves of each record"),
        **{f"half_wave_{name}": Column(("wave",), meaning) for name, meaning in WAVES.items()},
    }
    if config.records.store == "all":
        columns["row_size"] = _ragged("sample", "record", "samples of each record")
        columns["acceleration"] = Column(("sample",), (float, "m s-2", "conditioned ground acceleration"))
    if config.models.histories:
        columns["history_row_size"] = _ragged("instant", "history", "instants of each history")
        for name, meaning in (
            ("record_index", "index into record"),
            ("lane_index", "index into block x case of /summary, case running faster"),
            ("model_index", "index into model of /summary"),
        ):
            columns[f"history_{name}"] = Column(("history",), (int, "1", meaning))
        columns["rotation"] = Column(("instant",), (float, "rad", "rotation at the record's samples"))
        columns["velocity"] = Column(("instant",), (float, "rad s-1", "its rate"))
    return columns


def _ragged(sample_dimension: str, dimension: str, long_name: str) -> Column:
    return Column((dimension,), (int, "1", long_name), {"sample_dimension": sample_dimension})
