"""The capacities of all records and bodies, the curves fitted to them, and the efficiency of each measure.

.. note:: A measure is efficient if capacities in this measure have a small dispersion beta, and sufficient if these
   capacities depend on no other property of the record (Luco & Cornell 2007, doi:10.1193/1.2723158). The test of
   sufficiency adds a covariate to the likelihood of the curve, z = a + b ln x + c ln u, for the records whose property
   u, such as the magnitude, is known.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import xarray as xr
from scipy.special import stdtr

from rockpulse.config.configuration import Config, config_from_text
from rockpulse.config.study_settings import OVERTURNING
from rockpulse.earthquakes import FEWEST_EVENTS, jackknife_error, jackknife_half_width
from rockpulse.record.measures import MEASURES
from rockpulse.storage.variables.fragility import QUALITIES, STATED, TESTED, Status
from rockpulse.storage.variables.summary import FACTS
from rockpulse.studies.fragility.curves import Curve, fit_curve, missing, standardised
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, FAMILIES, NOT_ABOVE, Observations, maximise
from rockpulse.studies.fragility.motion_capacity import NOT_KNOWN


def dispersion_ratio(curve: Curve, reference: Curve) -> tuple[float, float, float]:
    """Return beta divided by the beta of a reference curve, and the jackknife limits of this ratio; NaN if unknown."""
    difference = curve.log_beta - reference.log_beta
    half = np.nan if curve.events < FEWEST_EVENTS else jackknife_half_width(difference, curve.confidence)
    ratio, low, high = np.exp(difference[0] + np.array([0.0, -half, half]))
    return float(ratio), float(low), float(high)


def sufficiency(rows: Observations, column: int, model: str = "lognormal") -> tuple[float, float]:
    """Return the slope d ln median/d ln u for a property u of the records, and its p-value; NaN if undetermined."""
    nothing = np.nan, np.nan
    values = rows.qualities[:, column]
    known = np.isfinite(values) & (values > 0.0)
    if not np.all(known):
        rows = rows.only(known)
        if missing(rows)[0] != Status.FITTED:
            return nothing
    u = np.log(rows.qualities[:, column])
    if np.ptp(u) == 0.0:
        return nothing
    x, _, spread = standardised(np.log(rows.level))
    quality, _, quality_spread = standardised(u)
    design = np.stack([np.ones(x.size), x, quality], axis=1)
    theta = maximise(FAMILIES[model], design, rows.kind, rows.without_each_event())
    slopes = -theta[:, 2] / theta[:, 1] * spread / quality_spread
    if not theta[0, 1] > 0.0:
        return nothing
    events = len(rows.events)
    if events < FEWEST_EVENTS or not np.all(theta[:, 1] > 0.0):
        return float(slopes[0]), np.nan
    statistic = abs(slopes[0]) / jackknife_error(slopes)
    return float(slopes[0]), float(2.0 * stdtr(events - 1, -statistic))


@dataclass(frozen=True, eq=False)
class Ensemble:
    """The capacities of m bodies under n records, for s limit states, in k intensity measures."""

    ids: list[str]  # (n,) ids of the records
    clusters: list[str]  # (n,) events of the records
    measures: np.ndarray  # (n, k, m) intensity measures of the unscaled records
    qualities: np.ndarray  # (n, c) properties in the order of QUALITIES
    facts: dict[str, np.ndarray]  # (n,) properties of earthquake and site by name
    factors: np.ndarray  # (n, s, m) first scale factors that reach a state, or (n, r, m) all scale factors [-]
    reached: np.ndarray | None  # (n, s, r, m) 1 if the limit state was reached, 0 if not, or NOT_KNOWN
    weight: np.ndarray | None  # (n, r) weight of each scale factor [-]
    config: Config

    @classmethod
    def of(cls, table: xr.Dataset, config: Config) -> Self:
        """Return the capacities in the group /capacities of a fragility file."""
        stripes = "stripe" in table.dims
        return cls(
            ids=[str(name) for name in table["record"].values],
            clusters=[str(name) for name in table["event"].values],
            measures=np.moveaxis(table["measure_value"].values, 1, 2),
            qualities=np.column_stack([table[name].values for name in QUALITIES]),
            facts={name: table[name].values for name in FACTS},
            factors=np.moveaxis(table["factor"].values, 1, 2),
            reached=np.moveaxis(table["reached"].values, 1, 3) if stripes else None,
            weight=table["weight"].transpose("record", "stripe").values if stripes else None,
            config=config,
        )

    def observations(self, state: int, measure: int, lanes: Sequence[int]) -> Observations:
        """Return the observations of some bodies for a limit state and a measure; all arguments are indices."""
        if self.reached is None:
            factor = self.factors[:, state, None][:, :, lanes]
            least, most = self.config.fragility.factors
            most = min(most, self.config.search.factor_max)
            kind = np.select([np.isinf(factor), factor < least], [ABOVE, NOT_ABOVE], EXACT)
            factor = np.clip(factor, least, most)
        else:
            factor, reached = self.factors[:, :, lanes], self.reached[:, state][:, :, lanes]
            kind = np.select([reached == NOT_KNOWN, reached == 1], [NOT_KNOWN, NOT_ABOVE], ABOVE)
        own = np.broadcast_to(self.measures[:, measure, None][:, :, lanes], factor.shape)
        known = (kind != NOT_KNOWN) & (factor * own > 0.0)
        record = np.broadcast_to(np.arange(len(self.ids))[:, None, None], factor.shape)[known]
        weight = None if self.weight is None else np.broadcast_to(self.weight[:, :, None], factor.shape)[known]
        return Observations.of(
            (factor * own)[known],
            kind[known],
            np.array(self.clusters, dtype=str)[record],
            np.array(self.ids, dtype=str)[record],
            np.column_stack([self.qualities[record], own[known], self.stated[record]]),
            weight,
        )

    @property
    def stated(self) -> np.ndarray:
        """Properties (records, STATED) that the files state, NaN if unknown; a magnitude M is given as exp(M)."""
        return np.column_stack(
            [np.exp(self.facts[name]) if name == "magnitude" else self.facts[name] for name in STATED]
        )

    def quality_counts(self) -> tuple[list[int], list[int]]:
        """Return, for each property in TESTED, the numbers of records and of events for which it is known."""
        every = np.ones((len(self.ids), 1))  # the intensity measure is known for every record
        values = np.column_stack([self.qualities, every, self.stated])
        known, clusters = np.isfinite(values) & (values > 0.0), np.array(self.clusters, dtype=str)
        return known.sum(axis=0).tolist(), [np.unique(clusters[own]).size for own in known.T]


def stored_ensemble(tree: xr.DataTree) -> Ensemble:
    """Return the capacities stored in a fragility file."""
    return Ensemble.of(tree["capacities"].to_dataset(), config_from_text(str(tree.attrs["configuration"])))


@dataclass(frozen=True, eq=False)
class Fits:
    """The curves (g, s, k) of g groups of bodies for s limit states in k measures, with their sufficiency tests."""

    curves: np.ndarray
    slope: np.ndarray
    p_value: np.ndarray

    def of(self, attribute: str) -> np.ndarray:
        """Return one attribute of every curve as an array (groups, limit states, measures)."""
        return np.vectorize(lambda curve: getattr(curve, attribute), otypes=[object])(self.curves)


def fit_ensemble(ensemble: Ensemble, groups: Sequence[Sequence[int]]) -> Fits:
    """Fit all curves and test sufficiency; groups of several bodies are fitted only in dimensionless measures."""
    settings = ensemble.config.fragility
    shape = (len(groups), len(settings.limit_states), len(settings.measures))
    curves = np.empty(shape, dtype=object)
    slope, p_value = (np.full((*shape, len(TESTED)), np.nan) for _ in range(2))
    for place in np.ndindex(shape):
        group, state, measure = place
        common = len(groups[group]) == 1 or MEASURES[settings.measures[measure]].unit == "1"
        rows = ensemble.observations(state, measure, groups[group] if common else [])
        model = settings.overturning_model if settings.limit_states[state] == OVERTURNING else settings.model
        curve = curves[place] = fit_curve(rows, model, settings.confidence)
        if curve.status == Status.FITTED:
            for quality in range(len(TESTED)):
                slope[(*place, quality)], p_value[(*place, quality)] = sufficiency(rows, quality, model)
    return Fits(curves, slope, p_value)
