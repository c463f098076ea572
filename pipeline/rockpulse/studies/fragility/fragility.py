"""Fragility of the bodies of a site under a set of records, and the tree of a fragility file (docs/schema.md)."""

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.search.capacity import uplift_scale
from rockpulse.config.bodies import gather_bodies
from rockpulse.config.configuration import Config, given_config
from rockpulse.errors import Failure
from rockpulse.record.measures import MEASURES, REFERENCE
from rockpulse.record.record import Record
from rockpulse.run.analysis import Analysis, Blocks, Part, Plan, Records, Work, joined, run, selected
from rockpulse.selection.directions import PlannedMotion, planned_ids
from rockpulse.selection.tables import selection_of
from rockpulse.storage.variables import failure_table, with_values
from rockpulse.storage.variables import fragility as stored
from rockpulse.storage.variables.summary import FACTS
from rockpulse.studies.fragility.ensemble import Ensemble, Fits, dispersion_ratio, fit_ensemble
from rockpulse.studies.fragility.motion_capacity import FragilityBodies, empty_capacity, motion_capacity

#: Number of points of a curve, its extent beyond the medians of a body (in dispersions), and the largest absolute
#: logarithm of a level, which prevents overflow for a nearly flat curve.
POINTS, REACH, FARTHEST = 41, 3.0, 600.0


def fragility(
    records: Records,
    config: Config | str | os.PathLike[str] | None = None,
    bodies: Blocks | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
    *,
    units: str | None = None,
    dt: float | None = None,
) -> xr.DataTree:
    """Compute fragility curves of bodies, with confidence bands over events, and the efficiency of intensity measures.

    Parameters
    ----------
    records : path, Record, or iterable of either
        Paths or all channels; read, selected, rotated and conditioned as in :func:`rockpulse.assess`, in any order.
    config : Config or path, optional
        Configuration with the sections records, conditioning, half_waves, intense_phase, search, fragility and the
        bodies.
    bodies : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of the bodies of the configuration; full sizes in m.
    failures, progress, units, dt
        As for :func:`rockpulse.assess`.

    Returns
    -------
    xarray.DataTree
        /fragility, /capacities, /efficiency and /failures, see docs/schema.md. A curve that the records do not
        determine is NaN, with the reason in `statement`.

    Raises
    ------
    ConfigError
        If there is no body, two records have the same id, or a table of events does not match the records. A record
        that cannot be used is a row of /failures.

    Notes
    -----
    With ``data = "stripes"`` every record is scaled to each level, within ``[fragility] factors``, and the curve is the
    probability of reaching the limit state at a level. With ``data = "ida"`` the capacity is the first scale factor
    that reaches the limit state, and the curve is the probability of reaching it at or below a level. This probability
    is larger, as the rotation need not increase with the scale factor (docs/decisions/012).

    Examples
    --------
    >>> curve = rp.fragility(records, config)["fragility"].sel(block="pier", limit_state="overturning", measure="pga")
    >>> round(float(curve["median"]), 1)  # m/s2
    6.5
    """
    return run(FragilityAnalysis(given_config(config, units, dt), bodies), records, failures, progress)


class FragilityAnalysis(Analysis):
    """The fragility analysis: computes the capacity of every body under every record, and fits the curves."""

    name = "fragility"
    doing = "scaling"
    kind = stored.FRAGILITY

    def __init__(self, config: Config, bodies: Blocks | None = None) -> None:
        super().__init__(config)
        gathered = gather_bodies(config.bodies if bodies is None else bodies, config.records)
        self.block_names, block, owner = gathered.apart()
        self.lanes = FragilityBodies(block, gathered, owner)
        self.selection = selection_of(config)

    @property
    def work(self) -> Work:
        """The function that computes the capacities of all bodies under one record."""
        return partial(motion_capacity, lanes=self.lanes, config=self.config, selection=self.selection)

    @cached_property
    def empty_part(self) -> Part:
        """Arrays with no rows that have the names, types and other dimensions of the arrays of a part."""
        return empty_capacity(len(self.block_names), self.config, self.selection)

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Fit the curves to the results of all records, and return the tree of a fragility file."""
        block, names, settings = self.lanes.block, self.block_names, self.config.fragility
        aloft = np.array([bool(self.lanes.bodies.floors[body]) for body in self.lanes.owner])
        known = ~aloft & (not self.config.records.include_vertical)
        uplift = np.where(known, uplift_scale(block, np.array([-1.0, 1.0]), settings.equation), np.nan)
        states = [state if isinstance(state, str) else f"{state:g}" for state in settings.limit_states]
        coords = _coordinates(block=names, limit_state=states, measure=settings.measures)
        capacities = _capacities(joined([self.empty_part, *parts]), self.config, coords)
        ensemble, lanes = Ensemble.of(capacities, self.config), list(range(len(names)))
        single, pooled = fit_ensemble(ensemble, [[lane] for lane in lanes]), fit_ensemble(ensemble, [lanes])
        nodes = {
            "/fragility": _curves(single, block, uplift, settings.measures, coords),
            "/capacities": capacities,
            "/efficiency": _efficiency(ensemble, single, pooled, coords),
            "/failures": failure_table(failures),
        }
        tree = self.described(xr.DataTree.from_dict(nodes), "Fragility of rigid blocks under recorded ground motions")
        tree.attrs |= {"data": settings.data, "confidence": settings.confidence}
        return tree

    def plan(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Plan:
        """Return the plan of the analysis; records missing in the table [fragility] selection are skipped."""
        plan = super().plan(records, failures)
        if self.selection is None:
            return plan
        of_motion = {one.name: planned_ids(one, self.config) for one in plan.planned}
        return selected(plan, self.selection.rows, of_motion, "[fragility] selection")


def _curves(
    fits: Fits, block: Block, uplift: np.ndarray, measures: Sequence[str], coords: dict[str, xr.Variable]
) -> xr.Dataset:
    level, probability = _grid(fits)
    values = {
        **{name: fits.of(name) for name in stored.CURVE},
        "level": level,
        **dict(zip(("probability", "probability_low", "probability_high"), probability, strict=True)),
        "measure_units": [MEASURES[key].unit for key in measures],
        "measure_long_name": [MEASURES[key].long_name for key in measures],
        **{name: getattr(block, name) for name in ("alpha_c", "p", "restitution")},
        "uplift_acceleration": uplift,
    }
    return xr.Dataset(with_values(stored.CURVES, values), coords)


def _grid(fits: Fits) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return intensity levels for all limit states of each body, and the curves with their bands at these levels."""
    groups, states, measures = fits.curves.shape
    level = np.full((groups, measures, POINTS), np.nan)
    tables = [np.full((groups, states, measures, POINTS), np.nan) for _ in range(3)]
    for group, measure in np.ndindex(groups, measures):
        fitted = [curve for curve in fits.curves[group, :, measure] if np.isfinite(curve.median)]
        if not fitted:
            continue
        ends = [np.log(curve.median) + side * REACH * curve.beta for curve in fitted for side in (-1.0, 1.0)]
        level[group, measure] = np.exp(np.clip(np.linspace(min(ends), max(ends), POINTS), -FARTHEST, FARTHEST))
        for state, curve in enumerate(fits.curves[group, :, measure]):
            if np.isfinite(curve.median):
                for table, values in zip(tables, curve.probability(level[group, measure]), strict=True):
                    table[group, state, measure] = values
    return level, tables


def _capacities(done: Part, config: Config, coords: dict[str, xr.Variable]) -> xr.Dataset:
    factors, search = np.moveaxis(done["factors"], 2, 1), config.search
    if "step" in done:
        values = {"factor": factors, "reached": np.isfinite(factors), "search_step": done["step"]}
        variables = with_values(stored.IDA, values)
        variables["factor"].attrs["comment"] = (
            f"searched up to a scale factor of {search.factor_max:g}, with {search.points} scale factors for each body "
            "in steps of search_step; too high if a limit state is reached only in a narrower interval"
        )
    else:
        reached = np.moveaxis(done["reached"], 3, 1)
        variables = with_values(stored.STRIPES, {"factor": factors, "reached": reached, "weight": done["weight"]})
    values = {
        "measure_value": np.moveaxis(done["measures"], 2, 1),
        **{name: done[name] for name in ("event", "source", *FACTS)},
        **dict(zip(stored.QUALITIES, done["qualities"].T, strict=True)),
    }
    variables |= with_values(stored.CAPACITIES, values)
    capacities = xr.Dataset(variables, _coordinates(record=done["record"].tolist()) | coords)
    if "step" in done:
        capacities.attrs |= {"points": search.points, "factor_max": search.factor_max}
    return capacities


def _efficiency(data: Ensemble, single: Fits, pooled: Fits, coords: dict[str, xr.Variable]) -> xr.Dataset:
    measures = list(data.config.fragility.measures)
    values: dict[str, Any] = dict(zip(("quality_records", "quality_events"), data.quality_counts(), strict=True))
    for prefix, fits, shown in (("", single, slice(None)), ("pooled_", pooled, 0)):
        for end, table in zip(("", "_low", "_high"), _ratios(fits, measures), strict=True):
            values[f"{prefix}beta_ratio{end}"] = table[shown]
        values |= {f"{prefix}slope": fits.slope[shown], f"{prefix}p_value": fits.p_value[shown]}
    beta = single.of("beta").astype(float)
    # For one body PGA and PGA/(g tan alpha_c) differ only by rounding: the first of equal dispersions is chosen.
    best = [
        "" if np.all(np.isnan(row)) else measures[int(np.nanargmin(np.round(row, 9)))]
        for row in beta.reshape(-1, len(measures))
    ]
    values["most_efficient"] = np.reshape(best, beta.shape[:2])
    values |= {f"pooled_{name}": pooled.of(name)[0] for name in stored.POOLED}
    return xr.Dataset(with_values(stored.EFFICIENCY, values), coords | _coordinates(quality=stored.TESTED))


def _coordinates(**labels: Sequence[str]) -> dict[str, xr.Variable]:
    return {name: stored.COORDINATES[name].variable(list(values)) for name, values in labels.items()}


def _ratios(fits: Fits, measures: Sequence[str]) -> np.ndarray:
    """Return each dispersion divided by that of the reference measure, with limits (3, groups, states, measures)."""
    table = np.full((3, *fits.curves.shape), np.nan)
    if REFERENCE in measures:
        column = list(measures).index(REFERENCE)
        for place in np.ndindex(fits.curves.shape):
            curve: Any = fits.curves[place]
            reference: Any = fits.curves[(*place[:2], column)]
            if curve.status == reference.status == stored.Status.FITTED:
                table[(slice(None), *place)] = dispersion_ratio(curve, reference)
    return table
