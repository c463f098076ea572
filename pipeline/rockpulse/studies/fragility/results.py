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
from rockpulse.motions.tables import Selection
from rockpulse.record.measures import MEASURES, REFERENCE
from rockpulse.storage.variables import failure_table, with_values
from rockpulse.storage.variables.fragility import (
    CAPACITIES,
    COORDINATES,
    CURVE,
    CURVES,
    EFFICIENCY,
    FRAGILITY,
    IDA,
    POOLED,
    QUALITIES,
    STRIPES,
    TESTED,
    Status,
)
from rockpulse.studies.fragility.curves import Curve
from rockpulse.studies.fragility.ensemble import Ensemble, Fits, dispersion_ratio, fit_ensemble, gather
from rockpulse.studies.fragility.limit_states import limit_state_names

#: Points of a curve, and how many dispersions they reach beyond the outermost medians of a body.
POINTS, REACH = 41, 3.0

#: Logarithm of the farthest level of a curve: one that hardly rises would leave the range of numbers.
FARTHEST = 600.0


def build_fragility_tree(
    parts: Sequence[Part],
    names: Sequence[str],
    block: Block,
    uplift: np.ndarray,
    config: Config,
    failures: Sequence[Failure],
    selection: Selection | None = None,
) -> xr.DataTree:
    """Fit everything and lay it out.

    The parts are those of :func:`rockpulse.studies.fragility.capacity.motion_capacity` with "event"; the block has (m,)
    lanes, one for each name, and `uplift` (m,) the accelerations of the ground that lift them, NaN where not known.
    """
    settings = config.fragility
    states, measures = limit_state_names(settings.limit_states), list(settings.measures)
    ensemble = gather(parts, len(names), config, selection)
    lanes = range(len(names))
    single, pooled = fit_ensemble(ensemble, [[lane] for lane in lanes]), fit_ensemble(ensemble, [list(lanes)])
    coords = _coordinates(block=names, limit_state=states, measure=measures)
    tree = xr.DataTree.from_dict(
        {
            "/fragility": _curves(single, block, uplift, measures, coords),
            "/capacities": _capacities(ensemble, coords),
            "/efficiency": _efficiency(ensemble, single, pooled, coords),
            "/failures": failure_table(failures),
        }
    )
    tree.attrs["kind"] = FRAGILITY
    tree.attrs["title"] = config.site.name or "Fragility of rigid blocks under recorded ground motions"
    tree.attrs["site_description"] = config.site.description
    tree.attrs["configuration"] = config.as_text()
    tree.attrs["data"] = settings.data
    tree.attrs["confidence"] = settings.confidence
    return tree


def _curves(
    fits: Fits, block: Block, uplift: np.ndarray, measures: Sequence[str], coords: dict[str, xr.Variable]
) -> xr.Dataset:
    level, probability = _grid(fits)
    values = {
        **{name: fits.of(name) for name in CURVE},
        "level": level,
        **dict(zip(("probability", "probability_low", "probability_high"), probability, strict=True)),
        "measure_units": [MEASURES[key].unit for key in measures],
        "measure_long_name": [MEASURES[key].long_name for key in measures],
        **{name: getattr(block, name) for name in ("alpha_c", "p", "restitution")},
        "uplift_acceleration": uplift,
    }
    return xr.Dataset(with_values(CURVES, values), coords)


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
    search = data.config.search
    factors = np.moveaxis(data.factors, 2, 1)
    if data.reached is None:
        variables = with_values(IDA, {"factor": factors, "reached": np.isfinite(factors), "search_step": data.step})
        variables["factor"].attrs["comment"] = (
            f"searched up to a factor of {search.factor_max:g} with {search.points} factors on each body, in steps of "
            "search_step; where a limit state is reached in a narrower interval only, too high"
        )
    else:
        reached = np.moveaxis(data.reached, 3, 1)
        variables = with_values(STRIPES, {"factor": factors, "reached": reached, "weight": data.weight})
    values = {
        "measure_value": np.moveaxis(data.measures, 2, 1),
        "event": data.clusters,
        "source": data.sources,
        **dict(zip(QUALITIES, data.qualities.T, strict=True)),
        **data.facts,
    }
    coords = _coordinates(record=data.ids) | coords
    capacities = xr.Dataset(variables | with_values(CAPACITIES, values), coords)
    if data.reached is None:
        capacities.attrs["points"] = search.points
        capacities.attrs["factor_max"] = search.factor_max
    return capacities


def _efficiency(data: Ensemble, single: Fits, pooled: Fits, coords: dict[str, xr.Variable]) -> xr.Dataset:
    measures = list(data.config.fragility.measures)
    ratios = ("beta_ratio", "beta_ratio_low", "beta_ratio_high")
    values: dict[str, Any] = dict(zip(("quality_records", "quality_events"), data.told_by(), strict=True))
    for prefix, fits, shown in (("", single, slice(None)), ("pooled_", pooled, 0)):
        values |= {prefix + name: table[shown] for name, table in zip(ratios, _ratios(fits, measures), strict=True)}
        values |= {f"{prefix}slope": fits.slope[shown], f"{prefix}p_value": fits.p_value[shown]}
    beta = single.of("beta").astype(float)
    # PGA and PGA/(g tan alpha_c) are the same for one body but for rounding: the first of equal ones.
    best = [
        "" if np.all(np.isnan(row)) else measures[int(np.nanargmin(np.round(row, 9)))]
        for row in beta.reshape(-1, len(measures))
    ]
    values["most_efficient"] = np.reshape(best, beta.shape[:2])
    values |= {f"pooled_{name}": pooled.of(name)[0] for name in POOLED}
    return xr.Dataset(with_values(EFFICIENCY, values), coords | _coordinates(quality=TESTED))


def _coordinates(**labels: Sequence[str]) -> dict[str, xr.Variable]:
    return {name: COORDINATES[name].variable(list(values)) for name, values in labels.items()}


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
