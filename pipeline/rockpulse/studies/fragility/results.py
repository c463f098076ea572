"""The tree of a fragility file, put together from the capacities of the records (docs/schema.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from rocking.block import Block
from rockpulse.config.configuration import Config
from rockpulse.failures import Failure
from rockpulse.motions.runner import Part
from rockpulse.storage.fragility_variables import (
    BODY,
    CAPACITY,
    CURVE,
    EFFICIENCY,
    FRAGILITY,
    GRID,
    LEVEL,
    MEASURE,
    POOLED,
    QUALITY,
    RECORD,
    SEARCH_STEP,
    STRENGTH,
    STRIPES,
    VALUE,
)
from rockpulse.storage.variables import FAILURE, Meaning, described
from rockpulse.studies.fragility.curves import Curve
from rockpulse.studies.fragility.efficiency import dispersion_ratio
from rockpulse.studies.fragility.ensemble import Ensemble, Fits, fit_ensemble, gather
from rockpulse.studies.fragility.limit_states import NOT_KNOWN, limit_state_names
from rockpulse.studies.fragility.measures import MEASURES, QUALITIES
from rockpulse.studies.fragility.statements import Band, Extrapolated, Status

__all__ = ["build_fragility_tree"]

#: The measure that dispersions are compared with.
REFERENCE = "velocity_ratio"

#: Points of a curve, and how many dispersions they reach beyond the outermost medians of a body.
POINTS, REACH = 41, 3.0

#: Logarithm of the farthest level of a curve: one that hardly rises would leave the range of numbers.
FARTHEST = 600.0


def build_fragility_tree(
    parts: Sequence[Part],
    names: Sequence[str],
    block: Block,
    config: Config,
    failures: Sequence[Failure],
) -> xr.DataTree:
    """Fit everything and lay it out.

    The parts are those of :func:`rockpulse.studies.fragility.capacity.motion_capacity` with "event"; the block has (m,)
    lanes, one for each name.
    """
    settings = config.fragility
    states, measures = limit_state_names(settings.limit_states), list(settings.measures)
    ensemble = gather(parts, len(names), config)
    lanes = range(len(names))
    single, pooled = fit_ensemble(ensemble, [[lane] for lane in lanes]), fit_ensemble(ensemble, [list(lanes)])
    coords = {
        "block": _labels("block", names, "name of the body"),
        "limit_state": _labels("limit_state", states, "limit state: uplift, theta_max/alpha_c, overturning"),
        "measure": _labels("measure", measures, "intensity measure"),
    }
    tree = xr.DataTree.from_dict(
        {
            "/fragility": _curves(single, block, measures, coords),
            "/capacities": _capacities(ensemble, coords),
            "/efficiency": _efficiency(single, pooled, measures, coords),
            "/failures": xr.Dataset(
                {
                    name: described(("failure",), [getattr(row, name) for row in failures], FAILURE[name])
                    for name in FAILURE
                }
            ),
        }
    )
    tree.attrs["kind"] = FRAGILITY
    tree.attrs["title"] = config.site.name or "Fragility of rigid blocks under recorded ground motions"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    tree.attrs["data"] = settings.data
    tree.attrs["confidence"] = settings.confidence
    return tree


def _curves(fits: Fits, block: Block, measures: Sequence[str], coords: dict[str, xr.Variable]) -> xr.Dataset:
    dims = ("block", "limit_state", "measure")
    variables = {name: described(dims, fits.of(name), meaning) for name, meaning in CURVE.items()}
    _flag(variables["status"], [status.name.lower() for status in Status])
    _flag(variables["band"], [band.name.lower() for band in Band])
    _flag(variables["extrapolated"], [side.name.lower() for side in Extrapolated])
    level, probability = _grid(fits)
    variables["level"] = described(("block", "measure", "point"), level, LEVEL)
    for name, table in zip(GRID, probability, strict=True):
        variables[name] = described((*dims, "point"), table, GRID[name])
    for name, attribute in (("measure_units", "units"), ("measure_long_name", "long_name")):
        variables[name] = described(
            ("measure",), [getattr(MEASURES[key], attribute) for key in measures], MEASURE[name]
        )
    for name, meaning in BODY.items():
        variables[name] = described(("block",), getattr(block, name), meaning)
    return xr.Dataset(variables, coords)


def _grid(fits: Fits) -> tuple[np.ndarray, list[np.ndarray]]:
    """Common levels of all limit states of a body, and the curves and bands at them."""
    groups, states, measures = fits.curves.shape
    level = np.full((groups, measures, POINTS), np.nan)
    tables = [np.full((groups, states, measures, POINTS), np.nan) for _ in range(3)]
    for group, measure in np.ndindex(groups, measures):
        fitted = [curve for curve in fits.curves[group, :, measure] if np.isfinite(curve.median)]
        if not fitted:
            continue
        ends = [np.log(curve.median) + side * REACH * curve.beta for curve in fitted for side in (-1.0, 1.0)]
        level[group, measure] = np.exp(np.clip(np.linspace(min(ends), max(ends), POINTS), -FARTHEST, FARTHEST))
        for state in range(states):
            curve: Curve = fits.curves[group, state, measure]
            if np.isfinite(curve.median):
                for table, values in zip(tables, curve.probability(level[group, measure]), strict=True):
                    table[group, state, measure] = values
    return level, tables


def _capacities(data: Ensemble, coords: dict[str, xr.Variable]) -> xr.Dataset:
    record = {"record": _labels("record", data.ids, "record id")}
    if data.reached is None:
        factors = np.moveaxis(data.factors, 2, 1)
        dims: tuple[str, ...] = ("record", "block", "limit_state")
        variables = {
            "factor": described(dims, factors, CAPACITY["factor"]),
            "reached": described(dims, np.isfinite(factors), CAPACITY["reached"]),
        }
        variables["factor"].attrs["comment"] = (
            f"searched up to a factor of {data.config.search.factor_max:g} with {data.config.search.points} factors on "
            "each body, in steps of search_step; where a limit state is reached in a narrower interval only, too high"
        )
        variables["search_step"] = described(("record", "block"), data.step, SEARCH_STEP)
        _flag(variables["reached"], ["above_the_search", "reached"])
    else:
        variables = {
            "factor": described(("record", "block", "stripe"), np.moveaxis(data.factors, 2, 1), STRIPES["factor"]),
            "reached": described(
                ("record", "block", "limit_state", "stripe"), np.moveaxis(data.reached, 3, 1), STRIPES["reached"]
            ),
        }
        _flag(variables["reached"], ["not_known", "not_reached", "reached"], first=NOT_KNOWN)
    variables["measure_value"] = described(("record", "block", "measure"), np.moveaxis(data.measures, 2, 1), VALUE)
    columns = {
        "event": data.clusters,
        "source": data.sources,
        **dict(zip(QUALITIES, data.qualities.T, strict=True)),
    }
    for name, meaning in RECORD.items():
        variables[name] = described(("record",), columns[name], meaning)
    capacities = xr.Dataset(variables, {**record, **coords})
    if data.reached is None:
        capacities.attrs["points"] = data.config.search.points
        capacities.attrs["factor_max"] = data.config.search.factor_max
    return capacities


def _efficiency(single: Fits, pooled: Fits, measures: Sequence[str], coords: dict[str, xr.Variable]) -> xr.Dataset:
    dims = ("block", "limit_state", "measure")
    variables = {}
    for prefix, fits, shown in (("", single, slice(None)), ("pooled_", pooled, 0)):
        own = dims if prefix == "" else dims[1:]
        for name, table in zip(EFFICIENCY, _ratios(fits, measures), strict=True):
            variables[prefix + name] = described(own, table[shown], EFFICIENCY[name])
        for name, values in (("slope", fits.slope), ("p_value", fits.p_value)):
            variables[prefix + name] = described((*own, "quality"), values[shown], QUALITY[name])
    beta = single.of("beta").astype(float)
    # PGA and PGA/(g tan alpha_c) are the same for one body but for rounding: the first of equal ones.
    best = [
        "" if np.all(np.isnan(row)) else measures[int(np.nanargmin(np.round(row, 9)))]
        for row in beta.reshape(-1, len(measures))
    ]
    variables["most_efficient"] = described(
        dims[:2],
        np.reshape(best, beta.shape[:2]),
        (str, "1", "measure of smallest dispersion; empty where none has one"),
    )
    for name, meaning in POOLED.items():
        variables[f"pooled_{name}"] = described(dims[1:], pooled.of(name)[0], meaning)
    _flag(variables["pooled_extrapolated"], [side.name.lower() for side in Extrapolated])
    qualities = _labels("quality", [*QUALITIES, STRENGTH], "quality of the record; strength: the measure at factor 1")
    return xr.Dataset(variables, {**coords, "quality": qualities})


def _ratios(fits: Fits, measures: Sequence[str]) -> np.ndarray:
    """Ratio of dispersions with its limits: (3, g, s, k)."""
    table = np.full((3, *fits.curves.shape), np.nan)
    if REFERENCE in measures:
        column = list(measures).index(REFERENCE)
        for place in np.ndindex(fits.curves.shape):
            curve: Any = fits.curves[place]
            reference: Any = fits.curves[(*place[:2], column)]
            if curve.status == reference.status == Status.FITTED:
                table[(slice(None), *place)] = dispersion_ratio(curve, reference)
    return table


def _labels(name: str, values: Sequence[str], long_name: str) -> xr.Variable:
    meaning: Meaning = (str, "1", long_name)
    return described((name,), list(values), meaning)


def _flag(variable: xr.Variable, meanings: Sequence[str], first: int = 0) -> None:
    variable.attrs["flag_values"] = np.arange(first, first + len(meanings), dtype=np.int8)
    variable.attrs["flag_meanings"] = " ".join(meanings)
