"""The tree of results, put together from the assessed records (docs/schema.md).

What one record adds to it is a part (:func:`record_part`); the tree is the parts one after the other, with what does
not depend on the records.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rockpulse.assessment.direction_statistics import direction_statistics
from rockpulse.assessment.growing_variables import growing_columns, lane_dimensions, sizes_of
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.failures import Failure
from rockpulse.motions.directions import sweep_azimuths
from rockpulse.storage.variables import (
    ANSWER,
    BLOCK,
    CASE,
    DEMAND,
    FAILURE,
    HALF_CYCLE,
    OVERTURNING,
    SITE_DEMAND,
    WAVES,
    described,
)

if TYPE_CHECKING:
    from rockpulse.assessment.record_assessment import RecordAssessment

__all__ = ["build_tree", "failure_table", "joined_parts", "record_part", "template"]

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

    Parameters
    ----------
    parts : sequence of mapping of str to ndarray
        What each record adds (:func:`record_part`), in the order of the rows.
    bodies : Bodies
        The bodies that were assessed.
    config : Config
        Its text becomes an attribute.
    failures : sequence of Failure
        What was left out.
    swept : mapping of str to sequence of str, optional
        Name of each pair of channels that was swept over direction, and the ids of its directions.
    """
    columns = growing_columns(bodies, config)
    sizes = sizes_of(bodies, config)
    empty = {path: column.empty(sizes) for path, column in columns.items()}
    arrays = joined_parts([empty, *parts])
    groups: dict[str, dict[str, xr.Variable]] = defaultdict(dict)
    for path, column in columns.items():
        group, _, name = path.rpartition("/")
        groups[group][name] = column.variable(arrays[path])
    groups["/summary"] |= _static(bodies, config)
    datasets = {group: xr.Dataset(variables) for group, variables in groups.items()}
    nodes = {group: datasets[group] for group in ("/summary", "/half_cycles", "/overturning_intervals")}
    nodes["/failures"] = failure_table(failures)
    if swept is not None:
        azimuths = sweep_azimuths(config.records.azimuth_step)
        nodes["/directions"] = direction_statistics(nodes["/summary"], azimuths, swept)
    if "/records" in datasets:
        nodes["/records"] = datasets["/records"]
    tree = xr.DataTree.from_dict(nodes)
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to recorded ground motions"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    return tree


def template(bodies: Bodies, config: Config) -> xr.DataTree:
    """The tree without a record: what does not depend on the records, and every other variable empty.

    Parameters
    ----------
    bodies : Bodies
        The bodies that are assessed.
    config : Config
        Options.
    """
    return build_tree([], bodies, config, [], {} if config.records.components == "sweep" else None)


def failure_table(failures: Sequence[Failure]) -> xr.Dataset:
    """The node /failures.

    Parameters
    ----------
    failures : sequence of Failure
        What was left out.
    """
    return xr.Dataset(
        {
            name: described(("failure",), [getattr(row, name) for row in failures], meaning)
            for name, meaning in FAILURE.items()
        }
    )


def joined_parts(parts: Sequence[Mapping[str, np.ndarray]], records_before: int = 0) -> dict[str, np.ndarray]:
    """Parts one after the other, with the columns that count records counted on.

    Parameters
    ----------
    parts : sequence of mapping of str to ndarray
        At least one, all with the same variables; in each the first record has number 0.
    records_before : int
        Number of the first record of the first part.

    Returns
    -------
    dict of str to ndarray
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


def record_part(one: RecordAssessment, bodies: Bodies, config: Config) -> dict[str, np.ndarray]:
    """What one record adds to the results.

    Parameters
    ----------
    one : RecordAssessment
        The record and the answers.
    bodies : Bodies
        The bodies that were assessed.
    config : Config
        Options.

    Returns
    -------
    dict of str to ndarray
        By its path in the file ("/summary/pga") the values of every variable that grows with the records, in the type
        of the file; the first dimension is the one that grows. Columns that count records hold 0.
    """
    found: dict[str, Any] = _of_summary(one, bodies, config)
    found |= _of_overturning(one, bodies, config)
    found |= _of_half_cycles(one, bodies, config)
    if config.records.store != "none":
        found |= _of_record(one, config)
    return {path: column.values(found[path]) for path, column in growing_columns(bodies, config).items()}


def _static(bodies: Bodies, config: Config) -> dict[str, xr.Variable]:
    """What does not depend on the records, the coordinates included."""
    block = {
        "width": bodies.width,
        "height": bodies.height,
        "block_warnings": bodies.warnings,
        **{name: getattr(bodies.lanes, name)[:: bodies.cases] for name in ("radius", "alpha_c", "p", "slenderness")},
        "critical_impulse": bodies.lanes.critical_impulse[:: bodies.cases],
    }
    variables = {name: described(("block",), block[name], meaning) for name, meaning in BLOCK.items()}
    restitution = _squeeze(bodies.per_case(np.asarray(bodies.lanes.restitution)), bodies)
    variables["restitution"] = described(lane_dimensions(bodies), restitution, CASE["restitution"])
    variables["block"] = described(("block",), bodies.names, (str, "1", "name of the body"))
    variables["model"] = described(
        ("model",),
        list(config.models.answering),
        (str, "1", "model, from the cheapest to the dearest; auto: the cheapest that answers, see model_used"),
    )
    if config.demands:
        of_site = {
            "demand_acceleration": [demand.acceleration for demand in config.demands],
            "limit_state": [demand.limit_state for demand in config.demands],
        }
        for name, meaning in SITE_DEMAND.items():
            variables[name] = described(("demand",), of_site[name], meaning)
        names = [demand.name for demand in config.demands]
        variables["demand"] = described(("demand",), names, (str, "1", "name of the demand"))
    return variables


def _of_summary(one: RecordAssessment, bodies: Bodies, config: Config) -> dict[str, Any]:
    # A restitution range adds a dimension; without one there is a single case and no dimension for it.
    found: dict[str, Any] = {"record": [one.scene.record.id], **{name: [one.record[name]] for name in one.record}}
    for name in DEMAND:
        found[name] = _squeeze(one.per_block[name][np.newaxis], bodies)
    answers = dict(one.per_model)
    answers["capacity_pga"] = answers["safety_factor"] * one.record["pga"]
    for name in ANSWER:
        found[name] = _squeeze(answers[name][np.newaxis], bodies, axis=2)
    if config.demands:
        acceleration = np.array([demand.acceleration for demand in config.demands])
        found["capacity_ratio"] = found["capacity_pga"][..., np.newaxis] / acceleration
    return {f"/summary/{name}": values for name, values in found.items()}


def _of_overturning(one: RecordAssessment, bodies: Bodies, config: Config) -> dict[str, Any]:
    columns: dict[str, list[np.ndarray]] = {name: [] for name in OVERTURNING}
    for model_index, model in enumerate(config.models.answering):
        found = one.scales[model]
        _add_indices(columns, found.lane, bodies, model_index)
        for name in ("lower", "upper", "open", "resolved"):
            columns[name].append(getattr(found, name))
    return {f"/overturning_intervals/{name}": _joined(parts) for name, parts in columns.items()}


def _of_half_cycles(one: RecordAssessment, bodies: Bodies, config: Config) -> dict[str, Any]:
    columns: dict[str, list[np.ndarray]] = {name: [] for name in HALF_CYCLE}
    for model_index, model in enumerate(config.models.answering):
        table = one.responses[model].half_cycles
        if table is None:
            continue
        lane, cycle = np.nonzero(np.isfinite(table.start_velocity).T)
        _add_indices(columns, lane, bodies, model_index)
        columns["half_cycle"].append(cycle + 1)
        for name in ("start_velocity", "peak", "duration", "impulse_count", "interval", "impact_speed"):
            columns[name].append(getattr(table, name)[cycle, lane])
    return {f"/half_cycles/{name}": _joined(parts) for name, parts in columns.items()}


def _add_indices(columns: dict[str, list[np.ndarray]], lane: np.ndarray, bodies: Bodies, model_index: int) -> None:
    columns[RECORD_INDEX].append(np.zeros(lane.size, dtype=int))
    columns["block_index"].append(lane // bodies.cases)
    columns["case_index"].append(lane % bodies.cases)
    columns["model_index"].append(np.full(lane.size, model_index))


def _of_record(one: RecordAssessment, config: Config) -> dict[str, Any]:
    record, waves = one.scene.record, one.scene.waves
    found: dict[str, Any] = {"record": [record.id], "half_wave_row_size": [waves.impulse.size]}
    found |= {f"half_wave_{name}": getattr(waves, name) for name in WAVES}
    if config.records.store == "all":
        found |= {"row_size": [record.npts], "acceleration": record.acceleration}
    if config.models.histories:
        found |= _histories(one, config)
    return {f"/records/{name}": values for name, values in found.items()}


def _histories(one: RecordAssessment, config: Config) -> dict[str, Any]:
    rotation: list[np.ndarray] = []
    velocity: list[np.ndarray] = []
    lanes: list[int] = []
    models: list[int] = []
    for model_index, model in enumerate(config.models.answering):
        response = one.responses[model]
        if response.rotation is None or response.velocity is None:
            continue
        count = response.rotation.shape[0]
        rotation += list(response.rotation)
        velocity += list(response.velocity)
        lanes += range(count)
        models += [model_index] * count
    return {
        "history_row_size": [history.size for history in rotation],
        "history_record_index": [0] * len(lanes),
        "history_lane_index": lanes,
        "history_model_index": models,
        "rotation": _joined(rotation),
        "velocity": _joined(velocity),
    }


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(parts) if parts else np.zeros(0)


def _squeeze(values: np.ndarray, bodies: Bodies, axis: int = -1) -> np.ndarray:
    return values if bodies.cases > 1 else values.squeeze(axis=axis)
