"""The tree of results, put together from the assessed records (docs/schema.md).

The rows that one record adds are a part (:func:`record_part`); the tree is the parts one after the other, with the
earthquakes, which all records together tell, and the variables that do not depend on the records.
"""

from __future__ import annotations

import base64
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rockpulse.assessment.direction_statistics import direction_statistics
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.study_settings import logo_bytes
from rockpulse.errors import Failure
from rockpulse.motions.directions import sweep_azimuths
from rockpulse.storage.variables import StoredVariable, failure_table
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS, GROWING
from rockpulse.storage.variables.probability import AXIS_SIZES

if TYPE_CHECKING:
    from rockpulse.assessment.record_assessment import RecordAssessment


#: The one variable that grows with the records and is in no part: a record alone does not tell it.
EVENT = "/summary/event"

#: Ends the name of every variable that counts records; in a part it is 0.
RECORD_INDEX = "record_index"


def build_tree(
    parts: Sequence[Mapping[str, np.ndarray]],
    bodies: Bodies,
    config: Config,
    failures: Sequence[Failure],
    swept: Mapping[str, Sequence[str]] | None = None,
) -> xr.DataTree:
    """The results of all records as one tree.

    The parts are what each record adds (:func:`record_part`) and its earthquake, in the order of the rows; `swept` has
    the name of each pair of channels that was swept over direction, and the ids of its directions.
    """
    variables = _variables(config)
    arrays = joined_parts([nothing(bodies, config), *parts])
    groups: dict[str, dict[str, xr.Variable]] = defaultdict(dict)
    for path, variable in variables.items():
        group, _, name = path.rpartition("/")
        if path not in arrays:
            arrays[path] = _in_dims(variable, np.asarray(_take(variable)(bodies, config)), bodies)
        groups[group][name] = variable.variable(arrays[path], _dims(variable, bodies), config)
    nodes = {group: xr.Dataset(groups[group]) for group in ("/summary", "/half_cycles", "/overturning_intervals")}
    nodes["/failures"] = failure_table(failures)
    if swept is not None:
        azimuths = sweep_azimuths(config.records.azimuth_step)
        nodes["/directions"] = direction_statistics(nodes["/summary"], azimuths, swept, config.uncertainty.azimuth)
    nodes |= {group: xr.Dataset(groups[group]) for group in ("/spectra", "/records") if group in groups}
    tree = xr.DataTree.from_dict(nodes)
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to recorded ground motions"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    if logo := logo_bytes(config.report, config.folder):
        tree.attrs["report_logo"] = base64.b64encode(logo).decode("ascii")
    return tree


def template(bodies: Bodies, config: Config) -> xr.DataTree:
    """The tree without a record: what does not depend on the records, and every other variable empty."""
    return build_tree([], bodies, config, [], {} if config.records.components == "sweep" else None)


def nothing(bodies: Bodies, config: Config) -> dict[str, np.ndarray]:
    """Every variable that grows with the records, without a row, by its path."""
    growing = {path: one for path, one in _variables(config).items() if one.dims[0] in GROWING}
    return {path: _absent(one, 0, bodies, config) for path, one in growing.items()}


def dimension_of(path: str) -> str:
    """The first dimension of a variable."""
    group, _, name = path.rpartition("/")
    return ASSESSMENT_GROUPS[group][name].dims[0]


def joined_parts(parts: Sequence[Mapping[str, np.ndarray]], records_before: int = 0) -> dict[str, np.ndarray]:
    """Parts one after the other, with the variables that count records counted on.

    All parts have the same variables, and in each the first record has number 0; in the first of them it gets the
    number `records_before`.
    """
    first = records_before + np.cumsum([0, *(len(part["/summary/record"]) for part in parts[:-1])])
    return {
        path: np.concatenate(
            [part[path] + start for part, start in zip(parts, first, strict=True)]
            if path.endswith(RECORD_INDEX)
            else [part[path] for part in parts]
        )
        for path in parts[0]
    }


def record_part(one: RecordAssessment) -> dict[str, np.ndarray]:
    """The rows that one record adds to the results, but for its earthquake.

    By its path in the file ("/summary/pga") the values of every variable that grows with the records, in the type of
    the file; the first dimension is the one that grows. Variables that count records hold 0.
    """
    return {
        path: _of_record(variable, one)
        for path, variable in _variables(one.config).items()
        if variable.dims[0] in GROWING and path != EVENT
    }


def _of_record(variable: StoredVariable, one: RecordAssessment) -> np.ndarray:
    if variable.of_ground and not one.shaken:
        return _absent(variable, 1, one.bodies, one.config)
    values = np.asarray(_take(variable)(one))
    if variable.dims[0] == "record":
        values = _in_dims(variable, values[np.newaxis], one.bodies)
    return variable.values(values)


def _variables(config: Config) -> dict[str, StoredVariable]:
    """The variables that an assessment by a configuration has, less those of /failures and /directions, by path."""
    return {
        f"{group}/{name}": variable
        for group in ("/summary", "/half_cycles", "/overturning_intervals", "/spectra", "/records")
        for name, variable in ASSESSMENT_GROUPS[group].items()
        if variable.stored is None or variable.stored(config)
    }


def _take(variable: StoredVariable) -> Callable[..., Any]:
    assert variable.take is not None, variable.long_name
    return variable.take


def _dims(variable: StoredVariable, bodies: Bodies) -> tuple[str, ...]:
    """The dimensions in the file: a restitution range adds one; without it there is a single case and none for it."""
    return variable.dims if bodies.cases > 1 else tuple(dim for dim in variable.dims if dim != "case")


def _in_dims(variable: StoredVariable, values: np.ndarray, bodies: Bodies) -> np.ndarray:
    one_case = bodies.cases == 1 and "case" in variable.dims
    return values.squeeze(axis=variable.dims.index("case")) if one_case else values


def _absent(variable: StoredVariable, rows: int, bodies: Bodies, config: Config) -> np.ndarray:
    """So many rows without a value."""
    sizes = {"block": len(bodies.names), "case": bodies.cases, "model": len(config.models.use)}
    sizes |= {"demand": len(config.demands), **AXIS_SIZES}
    shape = (rows, *(sizes[dim] for dim in _dims(variable, bodies)[1:]))
    return np.full(shape, variable.absent, dtype=variable.kind)
