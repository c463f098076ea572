"""The tree of results, put together from the assessed records (docs/schema.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rockpulse.bodies import Bodies
from rockpulse.config import Config
from rockpulse.direction_statistics import direction_statistics
from rockpulse.directions import sweep_azimuths
from rockpulse.failures import Failure
from rockpulse.models.predictability import NOT_CHECKED
from rockpulse.models.response import Outcome, Reason
from rockpulse.scene import USED
from rockpulse.variables import (
    ANSWER,
    BLOCK,
    CAPACITY_RATIO,
    CASE,
    DEMAND,
    FAILURE,
    HALF_CYCLE,
    OVERTURNING,
    RECORD,
    SITE_DEMAND,
    WAVES,
    Meaning,
    described,
)

if TYPE_CHECKING:
    from rockpulse.assessment import RecordAssessment

__all__ = ["build_tree"]


def build_tree(
    done: Sequence[RecordAssessment],
    bodies: Bodies,
    config: Config,
    failures: Sequence[Failure],
    swept: Mapping[str, Sequence[str]] | None = None,
) -> xr.DataTree:
    """The results of all records as one tree.

    Parameters
    ----------
    done : sequence of RecordAssessment
        In the order of the rows.
    bodies : Bodies
        The bodies that were assessed.
    config : Config
        Its text becomes an attribute.
    failures : sequence of Failure
        What was left out.
    swept : mapping of str to sequence of str, optional
        Name of each pair of channels that was swept over direction, and the ids of its directions.
    """
    summary = _summary(done, bodies, config)
    groups = {
        "/summary": summary,
        "/half_cycles": _half_cycles(done, bodies, config),
        "/overturning_intervals": _overturning_intervals(done, bodies, config),
        "/failures": _table("failure", FAILURE, {name: [getattr(row, name) for row in failures] for name in FAILURE}),
    }
    if swept is not None:
        groups["/directions"] = direction_statistics(summary, sweep_azimuths(config.records.azimuth_step), swept)
    if config.records.store != "none":
        groups["/records"] = _records(done, config)
    tree = xr.DataTree.from_dict(groups)
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to recorded ground motions"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    return tree


def _summary(done: Sequence[RecordAssessment], bodies: Bodies, config: Config) -> xr.Dataset:
    models = list(config.models.answering)
    shape = (len(done), len(bodies.names), bodies.cases)
    # A restitution range adds a dimension; without one there is a single case and no dimension for it.
    case = ("case",) if bodies.cases > 1 else ()
    lanes = ("block", *case)
    block = {
        "width": bodies.width,
        "height": bodies.height,
        "block_warnings": bodies.warnings,
        **{name: getattr(bodies.lanes, name)[:: bodies.cases] for name in ("radius", "alpha_c", "p", "slenderness")},
        "critical_impulse": bodies.lanes.critical_impulse[:: bodies.cases],
    }
    variables: dict[str, xr.Variable] = {}
    for name, meaning in RECORD.items():
        variables[name] = described(("record",), [one.record[name] for one in done], meaning)
    for name, meaning in BLOCK.items():
        variables[name] = described(("block",), block[name], meaning)
    restitution = bodies.per_case(np.asarray(bodies.lanes.restitution))
    variables["restitution"] = described(lanes, _squeeze(restitution, bodies), CASE["restitution"])
    for name, meaning in DEMAND.items():
        values = np.array([one.per_block[name] for one in done]).reshape(shape)
        variables[name] = described(("record", *lanes), _squeeze(values, bodies), meaning)
    answers = {
        name: np.array([one.per_model[name] for one in done]).reshape(*shape, len(models))
        for name in ANSWER
        if name != "capacity_pga"
    }
    pga = np.array([one.record["pga"] for one in done]).reshape(-1, 1, 1, 1)
    answers["capacity_pga"] = answers["safety_factor"] * pga
    for name, meaning in ANSWER.items():
        values = _squeeze(answers[name], bodies, axis=2)
        variables[name] = described(("record", *lanes, "model"), values, meaning)
    _flag(variables["pgv_drift"], ["reliable", "drift"])
    _flag(variables["outcome"], [outcome.name.lower() for outcome in Outcome])
    _flag(variables["reason"], [reason.name.lower() for reason in Reason])
    _flag(variables["model_used"], USED)
    _flag(variables["factor_resolved"], ["not_computed", "no", "yes"], first=-1)
    _flag(variables["applicable"], ["outside_range", "applicable"])
    _flag(variables["predictable"], ["not_checked", "no", "yes"], first=NOT_CHECKED)
    if config.demands:
        _add_demands(variables, config)
    variables["safety_factor"].attrs["comment"] = (
        f"searched up to a factor of {config.search.factor_max:g} in steps of search_step, edges to 1e-6; inf if none; "
        "a factor at which the model cannot answer counts as overturning (factor_resolved)"
    )
    checked = f"relative changes of C and the record by 1e-9; peaks to {config.models.tolerance:g}"
    if config.models.output == "outcome":
        checked += "; of auto the outcome alone"
    variables["predictable"].attrs["comment"] = checked
    coords = {
        "record": described(("record",), [one.scene.record.id for one in done], (str, "1", "record id")),
        "block": described(("block",), bodies.names, (str, "1", "name of the body")),
        "model": described(
            ("model",),
            models,
            (str, "1", "model, from the cheapest to the dearest; auto: the cheapest that answers, see model_used"),
        ),
    }
    if config.demands:
        names = [demand.name for demand in config.demands]
        coords["demand"] = described(("demand",), names, (str, "1", "name of the demand"))
    return xr.Dataset(variables, coords)


def _add_demands(variables: dict[str, xr.Variable], config: Config) -> None:
    """What the site asks for, and the capacity of every body over it."""
    demands = {
        "demand_acceleration": np.array([demand.acceleration for demand in config.demands]),
        "limit_state": [demand.limit_state for demand in config.demands],
    }
    for name, meaning in SITE_DEMAND.items():
        variables[name] = described(("demand",), demands[name], meaning)
    capacity = variables["capacity_pga"]
    ratio = capacity.values[..., np.newaxis] / variables["demand_acceleration"].values
    variables["capacity_ratio"] = described((*map(str, capacity.dims), "demand"), ratio, CAPACITY_RATIO)


def _overturning_intervals(done: Sequence[RecordAssessment], bodies: Bodies, config: Config) -> xr.Dataset:
    columns: dict[str, list[np.ndarray]] = {name: [] for name in OVERTURNING}
    for record_index, one in enumerate(done):
        for model_index, model in enumerate(config.models.answering):
            found = one.scales[model]
            columns["record_index"].append(np.full(found.lane.size, record_index))
            columns["block_index"].append(found.lane // bodies.cases)
            columns["case_index"].append(found.lane % bodies.cases)
            columns["model_index"].append(np.full(found.lane.size, model_index))
            for name in ("lower", "upper", "open", "resolved"):
                columns[name].append(getattr(found, name))
    table = _table("interval", OVERTURNING, {name: _joined(parts) for name, parts in columns.items()})
    for name in ("open", "resolved"):
        _flag(table[name].variable, ["no", "yes"])
    return table


def _half_cycles(done: Sequence[RecordAssessment], bodies: Bodies, config: Config) -> xr.Dataset:
    columns: dict[str, list[np.ndarray]] = {name: [] for name in HALF_CYCLE}
    for record_index, one in enumerate(done):
        for model_index, model in enumerate(config.models.answering):
            table = one.responses[model].half_cycles
            if table is None:
                continue
            lane, cycle = np.nonzero(np.isfinite(table.start_velocity).T)
            columns["record_index"].append(np.full(lane.size, record_index))
            columns["block_index"].append(lane // bodies.cases)
            columns["case_index"].append(lane % bodies.cases)
            columns["model_index"].append(np.full(lane.size, model_index))
            columns["half_cycle"].append(cycle + 1)
            for name in ("start_velocity", "peak", "duration", "impulse_count", "interval", "impact_speed"):
                columns[name].append(getattr(table, name)[cycle, lane])
    return _table("row", HALF_CYCLE, {name: _joined(parts) for name, parts in columns.items()})


def _records(done: Sequence[RecordAssessment], config: Config) -> xr.Dataset:
    """Ragged arrays: the values of all records one after the other, with the number of each."""
    waves = [one.scene.waves for one in done]
    variables = {
        "half_wave_row_size": _ragged("wave", "record", [w.impulse.size for w in waves], "half-waves of each record"),
    }
    for name, meaning in WAVES.items():
        values = [getattr(w, name) for w in waves]
        variables[f"half_wave_{name}"] = described(("wave",), _joined(values), meaning)
    if config.records.store == "all":
        records = [one.scene.record for one in done]
        variables["row_size"] = _ragged("sample", "record", [r.npts for r in records], "samples of each record")
        variables["acceleration"] = described(
            ("sample",), _joined([r.acceleration for r in records]), (float, "m s-2", "conditioned ground acceleration")
        )
    if config.models.histories:
        _add_histories(variables, done, config)
    ids = [one.scene.record.id for one in done]
    return xr.Dataset(variables, {"record": described(("record",), ids, (str, "1", "record id"))})


def _add_histories(variables: dict[str, xr.Variable], done: Sequence[RecordAssessment], config: Config) -> None:
    rotation, velocity = [], []
    index: dict[str, list[int]] = {"record_index": [], "lane_index": [], "model_index": []}
    for record_index, one in enumerate(done):
        for model_index, model in enumerate(config.models.answering):
            response = one.responses[model]
            if response.rotation is None or response.velocity is None:
                continue
            for lane in range(response.rotation.shape[0]):
                rotation.append(response.rotation[lane])
                velocity.append(response.velocity[lane])
                for name, value in zip(index, (record_index, lane, model_index), strict=True):
                    index[name].append(value)
    sizes = [history.size for history in rotation]
    variables["history_row_size"] = _ragged("instant", "history", sizes, "instants of each history")
    for name, meaning in (
        ("record_index", "index into record"),
        ("lane_index", "index into block x case of /summary, case running faster"),
        ("model_index", "index into model of /summary"),
    ):
        variables[f"history_{name}"] = described(("history",), index[name], (int, "1", meaning))
    variables["rotation"] = described(
        ("instant",), _joined(rotation), (float, "rad", "rotation at the record's samples")
    )
    variables["velocity"] = described(("instant",), _joined(velocity), (float, "rad s-1", "its rate"))


def _table(dimension: str, meanings: dict[str, Meaning], columns: dict[str, Any]) -> xr.Dataset:
    return xr.Dataset({name: described((dimension,), columns[name], meanings[name]) for name in meanings})


def _flag(variable: xr.Variable, meanings: Sequence[str], first: int = 0) -> None:
    variable.attrs["flag_values"] = np.arange(first, first + len(meanings), dtype=np.int8)
    variable.attrs["flag_meanings"] = " ".join(meanings)


def _ragged(sample_dimension: str, dimension: str, sizes: list[int], long_name: str) -> xr.Variable:
    variable = described((dimension,), sizes, (int, "1", long_name))
    variable.attrs["sample_dimension"] = sample_dimension
    return variable


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(parts) if parts else np.zeros(0)


def _squeeze(values: np.ndarray, bodies: Bodies, axis: int = -1) -> np.ndarray:
    return values if bodies.cases > 1 else values.squeeze(axis=axis)
