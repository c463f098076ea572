"""Builds the tree of results from the assessed records (docs/schema.md).

.. note:: Median and largest value over direction are defined as RotD50 and RotD100 (Boore 2010,
   doi:10.1785/0120090400). A direction without a result may have any value from rest to overturning; a median, largest
   or smallest value that depends on it is NaN.
"""

import base64
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.record_assessment import RecordAssessment
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.study_settings import logo_bytes
from rockpulse.errors import Failure
from rockpulse.record.measures import PGA
from rockpulse.selection.directions import sweep_azimuths
from rockpulse.storage.variables import StoredVariable, failure_table
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS, DIRECTIONS, GROWING
from rockpulse.storage.variables.probability import AXIS_SIZES, MEAN


def direction_statistics(
    summary: xr.Dataset,
    azimuths: Sequence[float] | np.ndarray,
    pairs: Mapping[str, Sequence[str]],
    with_probability: bool = False,
) -> xr.Dataset:
    """Compute the group /directions: statistics over the directions of each pair; `pairs` lists its record ids."""
    place = {str(record): number for number, record in enumerate(summary["record"].values)}
    pairs = {pair: records for pair, records in pairs.items() if any(record in place for record in records)}
    index = np.array([[place.get(record, -1) for record in records] for records in pairs.values()], dtype=int)
    index = index.reshape(len(pairs), len(azimuths))

    def swept(name: str) -> np.ndarray:
        """Return the values (pair, direction, ...) of a variable; NaN for a direction that was not assessed."""
        values = summary[name].values.astype(float)
        return np.concatenate([values, np.full((1, *values.shape[1:]), np.nan)])[index]

    directions = np.asarray(azimuths, dtype=float)
    measures: dict[str, Any] = {"pair": list(pairs), "direction_azimuth": directions, "record_index": index}
    for name in (PGA, "main_impulse"):
        largest, at = largest_over(swept(name))
        measures |= {f"{name}_median": median_over(swept(name)), f"{name}_largest": largest}
        measures[f"{name}_azimuth"] = _at(directions, at)

    peaks, factors = swept("peak_rotation_ratio"), swept("safety_factor")
    over = swept("outcome") == Outcome.OVERTURNS
    # If a body overturns in several directions, the one in which it overturns first counts.
    first = np.where(over, np.nan_to_num(swept("overturning_time"), nan=np.inf), np.inf)
    largest, at = largest_over(peaks, first)
    smallest, factor_at = smallest_over(factors)
    answers = {
        "median_rotation_ratio": median_over(peaks),
        "largest_rotation_ratio": largest,
        "largest_azimuth": _at(directions, at),
        "overturning_share": over.mean(axis=1),
        "unanswered_count": np.isnan(peaks).sum(axis=1),
        "smallest_safety_factor": smallest,
        "safety_factor_azimuth": _at(directions, factor_at),
    }
    dims = dict.fromkeys(answers, ("pair", *(str(dim) for dim in summary["peak_rotation_ratio"].dims[1:])))
    if with_probability:
        answers[MEAN] = swept("overturning_probability").mean(axis=1)
        dims[MEAN] = ("pair", *(str(dim) for dim in summary["overturning_probability"].dims[1:]))
    values = measures | answers
    variables = {name: one.variable(values[name], dims.get(name)) for name, one in DIRECTIONS.items() if name in values}
    return xr.Dataset(variables, {"pair": variables.pop("pair"), "block": summary["block"], "model": summary["model"]})


def median_over(values: np.ndarray) -> np.ndarray:
    """Return the median over axis 1 of values from 0 to inf; NaN if the median depends on missing values."""
    unknown = np.isnan(values)
    low, high = (np.median(np.where(unknown, bound, values), axis=1) for bound in (0.0, np.inf))
    return np.where(low == high, low, np.nan)


def largest_over(values: np.ndarray, first: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest value over axis 1, and its index (-1 if it is NaN).

    Among several infinite values, the index of the value with the smallest `first` is returned.
    """
    endless = np.isposinf(values)
    largest = np.where(endless.any(axis=1), np.inf, values.max(axis=1))
    key = np.where(endless, np.zeros_like(values) if first is None else first, np.inf)
    among = np.argmax(endless & (key == key.min(axis=1, keepdims=True)), axis=1)
    place = np.where(endless.any(axis=1), among, np.argmax(values, axis=1))
    return largest, np.where(np.isnan(largest), -1, place)


def smallest_over(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest value over axis 1 (NaN if any is missing), and its index (-1 if it is not finite)."""
    smallest = values.min(axis=1)
    return smallest, np.where(np.isfinite(smallest), np.argmin(values, axis=1), -1)


def _at(azimuths: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.append(azimuths, np.nan)[place]


#: The only variable of the records that is not in the parts, as it depends on all records.
EVENT = "/summary/event"


def build_tree(
    parts: Sequence[Mapping[str, np.ndarray]],
    bodies: Bodies,
    config: Config,
    failures: Sequence[Failure],
    swept: Mapping[str, Sequence[str]] | None = None,
) -> xr.DataTree:
    """Return the tree of results from the parts of all records; `swept` lists the record ids of each rotated pair."""
    arrays = joined_parts([empty_rows(bodies, config), *parts])
    groups: dict[str, dict[str, xr.Variable]] = defaultdict(dict)
    for path, variable in _variables(bodies, config).items():
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


def empty_tree(bodies: Bodies, config: Config) -> xr.DataTree:
    """Return the tree of results without any records."""
    return build_tree([], bodies, config, [], {} if config.records.components == "sweep" else None)


def empty_rows(bodies: Bodies, config: Config) -> dict[str, np.ndarray]:
    """Return, by path, an empty array for each variable that has rows for every record."""
    return {
        path: _absent(one, 0, bodies, config)
        for path, one in _variables(bodies, config).items()
        if one.dims[0] in GROWING
    }


def joined_parts(parts: Sequence[Mapping[str, np.ndarray]], records_before: int = 0) -> dict[str, np.ndarray]:
    """Join the parts of several records; the index of the first record in the whole tree is `records_before`."""
    first = records_before + np.cumsum([0, *(len(part["/summary/record"]) for part in parts[:-1])])
    joined = {}
    for path in parts[0]:
        values = [part[path] for part in parts]
        if path.endswith("record_index"):
            values = [one + start for one, start in zip(values, first, strict=True)]
        joined[path] = values[0] if len(values) == 1 else np.concatenate(values)
    return joined


def record_part(one: RecordAssessment) -> dict[str, np.ndarray]:
    """Return the variables of one record by path, such as "/summary/pga", without its earthquake."""
    return {
        path: _of_record(variable, one)
        for path, variable in _variables(one.bodies, one.config).items()
        if variable.dims[0] in GROWING and path != EVENT
    }


def _of_record(variable: StoredVariable, one: RecordAssessment) -> np.ndarray:
    if variable.of_ground and not one.shaken:
        return _absent(variable, 1, one.bodies, one.config)
    values = np.asarray(_take(variable)(one))
    if variable.dims[0] == "record":
        values = _in_dims(variable, values[np.newaxis], one.bodies)
    return variable.values(values)


def _variables(bodies: Bodies, config: Config) -> dict[str, StoredVariable]:
    """Return the stored variables of an assessment by path, without those of /failures and /directions."""
    return {
        f"{group}/{name}": variable
        for group in ("/summary", "/half_cycles", "/overturning_intervals", "/spectra", "/records")
        for name, variable in ASSESSMENT_GROUPS[group].items()
        if (variable.stored is None or variable.stored(config)) and ("tie" not in variable.dims or bodies.tie_count)
    }


def _take(variable: StoredVariable) -> Callable[..., Any]:
    assert variable.take is not None, variable.long_name
    return variable.take


def _dims(variable: StoredVariable, bodies: Bodies) -> tuple[str, ...]:
    """Return the dimensions of a variable in the file; `case` is omitted if every body has a single restitution."""
    return variable.dims if bodies.cases > 1 else tuple(dim for dim in variable.dims if dim != "case")


def _in_dims(variable: StoredVariable, values: np.ndarray, bodies: Bodies) -> np.ndarray:
    return values.squeeze(axis=variable.dims.index("case")) if _dims(variable, bodies) != variable.dims else values


def _absent(variable: StoredVariable, rows: int, bodies: Bodies, config: Config) -> np.ndarray:
    own = {"block": len(bodies.names), "case": bodies.cases, "tie": bodies.tie_count}
    sizes = own | {"model": len(config.models.use), "demand": len(config.demands), **AXIS_SIZES}
    shape = (rows, *(sizes[dim] for dim in _dims(variable, bodies)[1:]))
    return np.full(shape, variable.absent, dtype=variable.kind)
