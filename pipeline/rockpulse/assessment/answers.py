"""The results of one model for every body under every record, and the safety margin of each body.

A "motion" is a record, or a pair of channels if it is assessed in several directions, each of which is then a record.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.site_demands import SiteDemand, stored_demands
from rockpulse.earthquakes import members, probability_interval
from rockpulse.model_table import fullest, is_full
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.hdf5.netcdf4 import flags_as_words, slab
from rockpulse.storage.variables.probability import MEAN, SOURCES


class Share(NamedTuple):
    """A probability of overturning [-] or a share of earthquakes that overturn a body, with its 90 % interval."""

    value: float
    low: float  # ends of the 90 % interval
    high: float
    least: float  # value if the records without a result do not overturn the body
    most: float  # value if all records without a result overturn the body
    unknown: int  # number of records without a result


@dataclass(frozen=True, eq=False)
class Motions:
    """The motions of the results (records, or pairs of channels), and means over their earthquakes."""

    names: list[str]  # ids of records or names of pairs
    index: np.ndarray  # (motions, directions) rows of /summary, -1 if a direction was not assessed
    events: list[str]  # earthquakes of the motions
    kind: str  # "record", "pair" or "sequence"
    any_azimuth: bool = False  # whether P of a pair is the mean over its directions (unknown direction of bodies)

    @property
    def event_count(self) -> int:
        """Number of different earthquakes; 1 if no record states its earthquake."""
        return len({*self.events} - {UNKNOWN}) or len({*self.events})

    def kept(self, left_out: np.ndarray) -> np.ndarray:
        """Return a mask (motions, bodies): True unless all directions of the motion are in the mask `left_out`."""
        return np.asarray(~self.over(left_out, True).all(axis=1))

    def event_counts(self, kept: np.ndarray) -> np.ndarray:
        """Return, for each body, the number of earthquakes of the motions in the mask `kept` (motions, bodies)."""
        if not self.events:
            return np.zeros(kept.shape[1], dtype=int)
        names, first = np.unique(np.sort(self.events), return_index=True)
        present = np.logical_or.reduceat(kept[np.argsort(self.events, kind="stable")], first, axis=0)
        known = present[names != UNKNOWN].sum(axis=0)
        return np.where(known > 0, known, present.any(axis=0))

    def over(self, values: np.ndarray, missing: Any) -> np.ndarray:
        """Arrange values (records, ...) as (motions, directions, ...), with `missing` for directions not assessed."""
        return np.concatenate([values, np.full_like(values, missing, shape=(1, *values.shape[1:]))])[self.index]

    def in_any_direction(self, so: np.ndarray, missing: bool = False) -> np.ndarray:
        """Return a mask (motions, ...), True if `so` (records, ...) is True in any direction of a motion."""
        return np.asarray(self.over(so, missing).any(axis=1))

    def of_earthquakes(self, values: np.ndarray) -> np.ndarray:
        """Return the mean (earthquakes, ...) over the motions of each earthquake; unknown values (NaN) are ignored."""
        own = members(np.array(self.events, dtype=str)).astype(float)
        known = ~np.isnan(values)
        # The counts of a body are those of the next one, if the same results of both are known.
        alike = values.ndim == 2 and bool(np.all(known == known[:, :1]))
        counts = np.tensordot(own, known[:, :1] if alike else known, 1)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.tensordot(own, np.where(known, values, 0.0), 1) / counts)

    def shares(self, probability: np.ndarray, left_out: np.ndarray | None = None) -> list[Share]:
        """Return, for each body, the mean over earthquakes of the probability of overturning (records, bodies).

        Records or pairs with all directions in `left_out` (records, bodies) are excluded. The interval applies to
        other earthquakes of the same kind (:func:`rockpulse.earthquakes.probability_interval`).
        """
        table = self.over(probability, np.nan)
        # The worst direction of a pair counts, unless the direction of the body is unknown.
        over = np.mean if self.any_azimuth else np.max
        known, least, most = (over(np.where(np.isnan(table), filled, table), axis=1) for filled in (np.nan, 0.0, 1.0))
        known = np.where(least == most, least, known)
        kept = np.ones(known.shape, dtype=bool) if left_out is None else self.kept(left_out)
        unknown = (np.isnan(known) & kept).sum(axis=0)
        of_events = self.of_earthquakes(np.where(kept, known, np.nan))
        value = _mean(of_events)
        if np.array_equal(least, most):
            least = most = value
        else:
            least, most = (_mean(self.of_earthquakes(np.where(kept, one, np.nan))) for one in (least, most))
        low, high = probability_interval(of_events, self.event_counts(kept & ~np.isnan(known)))
        tables = (value, low, high, least, most, unknown)
        return [Share(*one) for one in zip(*(table.tolist() for table in tables), strict=True)]


def _mean(values: np.ndarray) -> np.ndarray:
    """Return the mean over earthquakes of values (earthquakes, ...); unknown values (NaN) are ignored."""
    known = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sum(values, axis=0, where=known) / known.sum(axis=0))


#: A margin is computed for each body, for each block with its worst restitution, or for each motion with its worst
#: block.
Of = Literal["body", "block", "motion"]


class Body(NamedTuple):
    """A block with one of its restitutions; ``place`` is the index of the block, ``case`` that of the restitution."""

    block: str
    place: int
    case: int
    restitution: float
    several: bool

    @property
    def name(self) -> str:
        """Name of the block; the restitution is added if the block has several."""
        return f"{self.block}, C = {self.restitution:.3f}" if self.several else self.block


class Margin(NamedTuple):
    """Smallest and median scale factor of overturning, or smallest and median capacity/demand; inf if not found."""

    smallest: float
    median: float
    bounds: tuple[bool, bool]  # whether smallest and median are lower bounds, as the model gives no result there
    open: bool  # whether the smallest is an upper bound, as a direction of the motion has no result
    limit: float  # end of the search if no factor was found; NaN if a factor was found for all motions
    place: int  # index of the motion with the smallest scale factor; -1 for none
    unknown: int  # number of motions without a result in any direction
    partial: int  # number of motions with results in some directions only
    weak: int  # number of motions for which the search ended below 1


class Answers:
    """The results of one model; `answers[name]` is a stored variable, an array over records and, mostly, bodies."""

    def __init__(self, summary: xr.Dataset, motions: Motions | None = None, model: str | None = None) -> None:
        self.summary = summary
        self.models: list[str] = [str(name) for name in summary["model"].values]
        self.model: str = fullest_model(summary) if model is None else model
        self.records: list[str] = [str(name) for name in summary["record"].values]
        self.blocks: list[str] = [str(name) for name in summary["block"].values]
        self.bodies: list[Body] = bodies_of(summary)
        self._motions = motions
        self._tables: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._tables:
            self._tables[name] = lanes(self.summary, name, self.bodies, self.model)
        return self._tables[name]

    @cached_property
    def motions(self) -> Motions:
        """The records, or pairs of channels, over which margins are computed."""
        if self._motions is not None:
            return self._motions
        index, events = np.arange(len(self.records))[:, np.newaxis], [str(event) for event in self["event"]]
        given = len(events) > 0 and bool((self["npts"] < 0).all())
        return Motions(self.records, index, events, "sequence" if given else "record")

    @cached_property
    def of_models(self) -> "dict[str, Answers]":
        """The results of every model, by name."""
        others = {name: Answers(self.summary, self._motions, name) for name in self.models if name != self.model}
        return {name: others.get(name, self) for name in self.models}

    @cached_property
    def demands(self) -> dict[str, SiteDemand]:
        """The demands of the site, by name."""
        return stored_demands(self.summary)

    @cached_property
    def source(self) -> np.ndarray:
        """How each probability (records, bodies) was computed, in words."""
        return flags_as_words(self["probability_source"], dict(enumerate(SOURCES)))

    @property
    def searched(self) -> bool:
        """True if scale factors at which bodies overturn were searched for with the model."""
        return not bool(np.isnan(self["safety_factor"]).all())

    @cached_property
    def probable(self) -> bool:
        """True if probabilities of overturning were computed with the model."""
        return is_full(self.model) and not bool(np.isnan(self["overturning_probability"]).all())

    @property
    def factor(self) -> str:
        """Name of the variable that is used as scale factor: "factor_10" if probable, otherwise "safety_factor"."""
        return "factor_10" if self.probable else "safety_factor"

    @property
    def has_factor(self) -> bool:
        """True if at least one scale factor is known."""
        return not bool(np.isnan(self[self.factor]).all())

    @property
    def bound(self) -> np.ndarray:
        """Mask (records, bodies): True if the scale factor is a lower bound, above which the model gives no result."""
        return np.asarray((self["factor_resolved"] == 0) & (not self.probable))

    @property
    def counts(self) -> list[int]:
        """Number of results with each outcome, in the order of Outcome."""
        return [int(np.count_nonzero(self["outcome"] == outcome)) for outcome in Outcome]

    @cached_property
    def overturned(self) -> np.ndarray:
        """Mask (motions, bodies) of unscaled records or pairs that overturn the body in at least one direction."""
        return self.motions.in_any_direction(self["outcome"] == Outcome.OVERTURNS)

    @property
    def unresolved(self) -> list[int]:
        """For each body, the number of motions without a result in at least one direction."""
        silent = self.motions.in_any_direction(self["outcome"] == Outcome.UNRESOLVED)
        return [int(count) for count in silent.sum(axis=0)]

    def proven(self, demand: str | None = None) -> np.ndarray:
        """Return the scale factors or capacity/demand (records, bodies) of `ratios` up to which no body overturns."""
        factor = self[self.factor]
        reached = np.where(np.isinf(factor), self["factor_10_low"], factor) if self.probable else self["safe_up_to"]
        return reached if demand is None else reached / self.of_demand("demand_factor", demand)

    def ratios(self, demand: str | None = None) -> np.ndarray:
        """Return the scale factors (records, bodies) or, with a `demand`, capacity/demand."""
        if demand is None:
            return self[self.factor]
        if self.probable:
            return np.asarray(self[self.factor] / self.of_demand("demand_factor", demand))
        return self.of_demand("capacity_ratio", demand)

    def of_demand(self, name: str, demand: str) -> np.ndarray:
        """Return the values (records, bodies) of a variable at a demand; for ties (records, bodies, ties)."""
        return np.asarray(self[name][:, :, [*self.demands].index(demand)])

    @property
    def least_over_direction(self) -> tuple[np.ndarray, np.ndarray]:
        """Smallest scale factor of each motion, and its row in /summary (-1 if unknown); both (motions, bodies)."""
        factor = self.motions.over(self[self.factor], np.nan)
        place = np.argmin(np.where(np.isnan(factor), np.inf, factor), axis=1)
        finite = np.isfinite(factor).any(axis=1)
        row = np.take_along_axis(self.motions.index, place, axis=1)
        return np.fmin.reduce(factor, axis=1), np.where(finite, row, -1)

    def by_block(self, worst: np.ufunc, table: np.ndarray) -> np.ndarray:
        """Reduce a table (motions, bodies) to (motions, blocks); `worst` combines the restitutions of a block."""
        firsts = np.flatnonzero([body.case == 0 for body in self.bodies])
        return np.asarray(worst.reduceat(table, firsts, axis=1))

    def overturnings(self, of: Of = "body") -> list[int]:
        """Return how many records overturn each body or block, or how many blocks each record overturns."""
        fallen = self.overturned if of == "body" else self.by_block(np.logical_or, self.overturned)
        return [int(count) for count in fallen.sum(axis=1 if of == "motion" else 0)]

    def margins(self, of: Of = "body", demand: str | None = None, left_out: np.ndarray | None = None) -> list[Margin]:
        """Return the margin of every body, block or motion, in scale factors or, with a `demand`, in capacity/demand.

        For margins of bodies, motions with all directions in `left_out` (records, bodies) are excluded.
        """
        ratio = self.motions.over(self.ratios(demand), np.nan)
        bound = self.motions.over(self.bound, False)
        # Lower and upper bound of each scale factor, and scale factor at which the search ended.
        least, most = (np.fmin.reduce(values, axis=1) for values in (ratio, np.where(bound, np.inf, ratio)))
        reached = np.fmin.reduce(self.motions.over(self.proven(demand), np.nan), axis=1)
        partial = np.isnan(ratio).any(axis=1)
        if of != "body":
            least, most, reached = (self.by_block(np.fmin, table) for table in (least, most, reached))
            partial = self.by_block(np.logical_or, partial)
        tables = (least, most, reached, partial)
        if left_out is None:
            return _margins(*(table.T for table in tables) if of == "motion" else tables)
        kept = self.motions.kept(left_out)
        least, most, reached = (np.where(kept, table, np.nan) for table in tables[:3])
        lost = (~kept).sum(axis=0).tolist()
        margins = _margins(least, most, reached, partial & kept)
        return [one._replace(unknown=one.unknown - more) for one, more in zip(margins, lost, strict=True)]


def answers_of(tree: xr.DataTree) -> Answers:
    """Return the results of the most complete model in a tree of results."""
    summary = tree["summary"].to_dataset()
    swept = "directions" in tree.children
    return swept_answers(summary, tree["directions"].to_dataset()) if swept else Answers(summary)


def swept_answers(summary: xr.Dataset, directions: xr.Dataset) -> Answers:
    """Return the results of the most complete model for pairs of channels; each direction of a pair is a record."""
    events = [str(event) for event in summary["event"].values]
    index = directions["record_index"].transpose("pair", "direction").values
    kept = np.flatnonzero((index >= 0).any(axis=1))
    index = index[kept]
    names = [str(name) for name in directions["pair"].values[kept]]
    of = [events[own[own >= 0][0]] for own in index]
    return Answers(summary, Motions(names, index, of, "pair", MEAN in directions))


def lanes(dataset: xr.Dataset, name: str, bodies: list[Body], model: str) -> np.ndarray:
    """Return a stored variable of one model, over records, bodies and, for some variables, demands and ties."""
    variable = dataset[name].variable
    at = [str(label) for label in dataset["model"].values].index(model)
    values = slab(variable, {"model": slice(at, at + 1)})
    order = ("record", "pair", "block", "case", "demand", "tie", "model")
    dims = [dim for dim in order if dim in variable.dims]
    values = values.transpose([variable.dims.index(dim) for dim in dims])
    values = values[..., 0] if "model" in dims else values
    if "block" not in dims:
        return values
    places, cases = ([getattr(body, which) for body in bodies] for which in ("place", "case"))
    return np.asarray(values[:, places, cases] if "case" in dims else values[:, places])


def bodies_of(summary: xr.Dataset) -> list[Body]:
    """Return the bodies of results; each restitution of a block is a body."""
    values = summary["restitution"].transpose("block", ...).values
    values = values.reshape(values.shape[0], -1)
    found = []
    for place, (block, own) in enumerate(zip(summary["block"].values, values, strict=True)):
        count = 1 if (own == own[0]).all() else own.size
        found += [Body(str(block), place, case, float(own[case]), count > 1) for case in range(count)]
    return found


def fullest_model(summary: xr.Dataset) -> str:
    """Return the name of the model that is closest to the full equation of motion."""
    return fullest(str(model) for model in summary["model"].values)


def searched_up_to(factor: np.ndarray, proven: np.ndarray) -> float:
    """Return the smallest scale factor at which a search ended without overturning; NaN without such a search."""
    none = np.isinf(factor)
    return float(np.min(proven[none])) if none.any() else math.nan


def _margins(least: np.ndarray, most: np.ndarray, reached: np.ndarray, partial: np.ndarray) -> list[Margin]:
    """Return the margin of every column of the given tables, which have a row for each motion."""
    known = ~np.isnan(least)
    # A search that ended below 1 gives no information on the factors up to 1.
    weak = np.isinf(least) & (reached < 1.0)
    strong = known & ~weak
    shown = np.where(strong | ~strong.any(axis=0), least, np.nan)
    smallest = np.fmin.reduce(shown, axis=0, initial=np.nan)
    at_most = np.fmin.reduce(np.where(np.isnan(shown), np.nan, most), axis=0, initial=np.nan)
    whole = np.isnan(shown) | partial
    median, median_at_most = (_median(np.where(whole, np.nan, values)) for values in (shown, most))
    none = np.isinf(shown)
    limit = np.where(none.any(axis=0), np.min(np.where(none, reached, np.inf), axis=0, initial=np.inf), np.nan)
    place = np.argmin(np.where(np.isnan(shown), np.inf, shown), axis=0) if len(shown) else np.zeros(limit.shape, int)
    columns = (
        smallest,
        median,
        np.stack([at_most > smallest, median_at_most > median], axis=-1),
        (partial & (shown == smallest)).any(axis=0),
        limit,
        np.where(np.isnan(smallest), -1, place),
        (~known).sum(axis=0),
        (known & partial).sum(axis=0),
        weak.sum(axis=0),
    )
    rows = zip(*(one.tolist() for one in columns), strict=True)
    return [Margin(low, middle, (below, above), *others) for low, middle, (below, above), *others in rows]


def _median(values: np.ndarray) -> np.ndarray:
    """Return the median of the known values in every column; NaN if a column has none."""
    count = (~np.isnan(values)).sum(axis=0)
    ordered = np.sort(values, axis=0)  # NaN is sorted last
    if not len(values):
        return np.full(count.shape, np.nan)
    middle = np.take_along_axis(ordered, np.stack([(count - 1) // 2, count // 2]), axis=0)
    return np.asarray(middle.sum(axis=0) / 2.0)
