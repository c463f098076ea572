"""The verdict on every body over all motions: whether it may be counted as safe, by how much, and what it rests on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.views.report.events import largest_share
from rockpulse.views.report.motions import Motions
from rockpulse.views.report.standing import Body, Standing, lanes, standings
from rockpulse.views.text.capacity import search_limit, thin_margin

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["BodyVerdict", "DemandVerdict", "Grade", "verdicts"]


class Grade(IntEnum):
    """What is said of a body, from best to worst."""

    SAFE = 0
    UNTESTED = 1  #: no motion lifts it
    STANDS = 2  #: under a design sequence, which stands for other motions and does not bound them
    THIN = 3
    NO_MARGIN = 4
    NOT_KNOWN = 5
    NOT_SAFE = 6


@dataclass(frozen=True)
class DemandVerdict:
    """A body against one ground acceleration that the site asks for.

    Attributes
    ----------
    name : str
        Of the demand.
    grade : Grade
        NOT_SAFE where a motion overturns the body below the demand, NOT_KNOWN where that cannot be excluded, THIN where
        the smallest capacity is hardly above it.
    smallest, median : float
        Capacity (safety factor x PGA) over demand, over the motions for which it is known [-]; inf: none found. Those
        too weak for the search to reach the demand are left out, unless all are.
    smallest_bound, median_bound : bool
        Whether the true value may be larger.
    smallest_open : bool
        Whether the true value may be smaller: a direction is missing, or not known.
    limit : float
        How much of the demand was searched where none was found, the smallest [-]; NaN without.
    below, unknown : int
        Motions that overturn it below the demand; for which it is not known.
    """

    name: str
    grade: Grade
    smallest: float
    median: float
    smallest_bound: bool
    median_bound: bool
    smallest_open: bool
    limit: float
    below: int
    unknown: int


@dataclass(frozen=True)
class BodyVerdict:
    """One body over all motions, by the model that is counted.

    Attributes
    ----------
    body : Body
        Which.
    grade : Grade
        That of its worst motion, as recorded and weaker.
    counts : dict of Standing to int
        Motions by standing.
    at_rest : int
        Motions that do not lift it, which say little of it.
    smallest, median : float
        Safety factor over the motions for which it is known [-]; inf: none found, NaN: not known.
    smallest_bound, median_bound : bool
        Whether the true value may be larger.
    smallest_open : bool
        Whether the true value may be smaller: a direction is missing, or not known.
    limit : float
        Up to which factor was searched where none was found, the smallest [-]; NaN without.
    governing : int
        Row of /summary with the smallest factor; without a finite one, of the first motion that overturns it; -1: none.
    events_hit : int
        Earthquakes with a motion that overturns it, as it is or weaker, or for which it is not known.
    largest_share : float
        Upper bound of the share of such earthquakes [-]; NaN where too few say nothing.
    demands : tuple of DemandVerdict
        One a demand.
    """

    body: Body
    grade: Grade
    counts: dict[Standing, int]
    at_rest: int
    smallest: float
    median: float
    smallest_bound: bool
    median_bound: bool
    smallest_open: bool
    limit: float
    governing: int
    events_hit: int
    largest_share: float
    demands: tuple[DemandVerdict, ...]

    @property
    def overall(self) -> Grade:
        """The worst of its grade and those of the demands: what fails the demand of the site is not called safe."""
        return max(self.grade, *(demand.grade for demand in self.demands), Grade.SAFE)

    @property
    def never_lifted(self) -> bool:
        """Whether no motion lifts it: it was not tested."""
        return 0 < self.at_rest == sum(self.counts.values())


#: What the worst standing of a body makes of it.
_GRADE = {
    Standing.STANDS: Grade.SAFE,
    Standing.THIN: Grade.THIN,
    Standing.NO_MARGIN: Grade.NO_MARGIN,
    Standing.UNKNOWN: Grade.NOT_KNOWN,
    Standing.WEAKER_OVERTURNS: Grade.NOT_SAFE,
    Standing.OVERTURNS: Grade.NOT_SAFE,
}


def verdicts(summary: xr.Dataset, bodies: list[Body], model: str, motions: Motions) -> list[BodyVerdict]:
    """The verdict on every body.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    bodies : list of Body
        Which.
    model : str
        Whose answers are counted.
    motions : Motions
        Over what they are put together.
    """
    single = standings(summary, bodies, model)
    worst = motions.worst(single)
    factor = _or(lanes(summary, "safety_factor", bodies, model), single, math.nan)
    bound = _or(lanes(summary, "factor_resolved", bodies, model), single, -1) == 0
    outcome = lanes(summary, "outcome", bodies, model)
    assert outcome is not None
    resting = np.array([np.all(outcome[rows] == Outcome.AT_REST, axis=0) for rows in motions.rows]).reshape(worst.shape)
    smallest = _smallest(factor, bound, motions)
    searched = _or(lanes(summary, "safe_up_to", bodies, model), single, math.nan)
    of_demands = _demands(summary, bodies, model, motions, single)
    events = np.array(motions.events)
    sequence = motions.kind == "sequence"
    found = []
    for lane, body in enumerate(bodies):
        own = worst[:, lane]
        hit = min(len(set(events[own >= Standing.UNKNOWN].tolist())), motions.event_count)
        low, at_low, open_low = smallest.least(lane)
        middle, at_middle = smallest.median(lane)
        resting_under = int(np.count_nonzero(resting[:, lane]))
        best = Grade.STANDS if sequence else Grade.UNTESTED if resting_under == own.size else Grade.SAFE
        found.append(
            BodyVerdict(
                body=body,
                grade=max(best, _GRADE[Standing(int(own.max()))]) if own.size else Grade.NOT_KNOWN,
                counts={kind: int(np.count_nonzero(own == kind)) for kind in Standing},
                at_rest=resting_under,
                smallest=low,
                median=middle,
                smallest_bound=at_low,
                median_bound=at_middle,
                smallest_open=open_low,
                limit=search_limit(factor[:, lane], searched[:, lane]),
                governing=_governing(factor[:, lane], single[:, lane]),
                events_hit=hit,
                largest_share=math.nan if sequence else largest_share(hit, motions.event_count),
                demands=of_demands[lane],
            )
        )
    return found


def _or(table: np.ndarray | None, like: np.ndarray, otherwise: float) -> np.ndarray:
    return np.full(like.shape, otherwise) if table is None else table


@dataclass(frozen=True, eq=False)
class _Smallest:
    """Of every motion and body the smallest value over its directions.

    Attributes
    ----------
    known : (motions, bodies) ndarray
        Of the directions that are known; NaN where none is.
    bound : (motions, bodies) ndarray of bool
        Whether the true value may be larger.
    open : (motions, bodies) ndarray of bool
        Whether it may be smaller, for a direction is missing or not known.
    """

    known: np.ndarray
    bound: np.ndarray
    open: np.ndarray

    def least(self, lane: int) -> tuple[float, bool, bool]:
        """The smallest over the motions, whether it may be larger, whether it may be smaller."""
        known = ~np.isnan(self.known[:, lane])
        if not known.any():
            return math.nan, False, False
        value, at_bound = _of(np.min, self.known[known, lane], self.bound[known, lane])
        partial = self.open[:, lane] & known & (self.known[:, lane] == value)
        return value, at_bound, bool(partial.any())

    def median(self, lane: int) -> tuple[float, bool]:
        """The median over the motions of which all directions are known, and whether it may be larger."""
        whole = ~np.isnan(self.known[:, lane]) & ~self.open[:, lane]
        return _of(np.median, self.known[whole, lane], self.bound[whole, lane]) if whole.any() else (math.nan, False)


def _smallest(values: np.ndarray, bound: np.ndarray, motions: Motions) -> _Smallest:
    low = np.full((len(motions.rows), values.shape[1]), np.nan)
    at, partial = np.zeros(low.shape, dtype=bool), np.zeros(low.shape, dtype=bool)
    for place, rows in enumerate(motions.rows):
        nothing = np.isnan(values[rows])
        low[place] = np.where(nothing, np.inf, values[rows]).min(axis=0, initial=np.inf)
        low[place, nothing.all(axis=0)] = np.nan
        at[place] = np.where(nothing | bound[rows], np.inf, values[rows]).min(axis=0, initial=np.inf) > low[place]
        partial[place] = nothing.any(axis=0) | motions.missing[place]
    return _Smallest(low, at, partial)


def _of(which: Callable[[np.ndarray], Any], values: np.ndarray, bound: np.ndarray) -> tuple[float, bool]:
    """The smallest or the median, and whether it may be larger."""
    low, high = (float(which(of)) for of in (values, np.where(bound, np.inf, values)))
    return low, high > low


def _governing(factor: np.ndarray, standings: np.ndarray) -> int:
    if np.any(np.isfinite(factor)):
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    fallen = np.flatnonzero(standings >= Standing.UNKNOWN)
    return int(fallen[np.argmax(standings[fallen])]) if fallen.size else -1


def _demands(
    summary: xr.Dataset, bodies: list[Body], model: str, motions: Motions, single: np.ndarray
) -> list[tuple[DemandVerdict, ...]]:
    """Of every body, one verdict a demand."""
    ratios = lanes(summary, "capacity_ratio", bodies, model)
    if ratios is None:
        return [() for _ in bodies]
    bound = _or(lanes(summary, "factor_resolved", bodies, model), single, -1) == 0
    searched = _or(lanes(summary, "safe_up_to", bodies, model), single, math.nan)
    margin = thin_margin(_or(lanes(summary, "search_step", bodies, model), single, math.nan))
    doubtful = np.zeros(single.shape, dtype=bool)
    for name in ("applicable", "predictable"):
        doubtful |= _or(lanes(summary, name, bodies, model), single, 1) == 0
    found = [
        [
            _demand(
                str(name),
                ratios[:, lane, place],
                bound[:, lane],
                proven[:, lane],
                doubtful[:, lane],
                margin[:, lane],
                motions,
            )
            for place, (name, proven) in enumerate(_proven(summary, searched))
        ]
        for lane in range(len(bodies))
    ]
    return [tuple(each) for each in found]


def _proven(summary: xr.Dataset, searched: np.ndarray) -> list[tuple[Any, np.ndarray]]:
    """Of every demand, how much of it each record was searched up to."""
    strength = summary["pga"].values[:, None] * searched
    demands = summary["demand_acceleration"]
    return [(name, strength / float(demands.sel(demand=name))) for name in demands["demand"].values]


def _demand(
    name: str,
    ratio: np.ndarray,
    bound: np.ndarray,
    proven: np.ndarray,
    doubtful: np.ndarray,
    margin: np.ndarray,
    motions: Motions,
) -> DemandVerdict:
    """One body, one demand: all arrays are of the records."""
    below = (ratio < 1.0) & ~bound
    # A search that ends below the demand has shown nothing of what lies between.
    unknown = ~below & (np.isnan(ratio) | ((ratio < 1.0) & bound) | (np.isinf(ratio) & ~(proven >= 1.0)) | doubtful)
    under = np.array([below[rows].any() for rows in motions.rows], dtype=bool)
    open_ = np.array([unknown[rows].any() for rows in motions.rows], dtype=bool) | motions.missing
    every = _smallest(ratio[:, None], bound[:, None], motions)
    low = every.known[:, 0]
    reached = np.array([proven[rows].min() for rows in motions.rows])
    told = ~np.isnan(low) & ~(np.isinf(low) & (reached < 1.0))
    shown = np.where(told, low, np.nan) if told.any() else low
    of_shown = _Smallest(shown[:, None], every.bound, every.open)
    smallest, smallest_bound, smallest_open = of_shown.least(0)
    median, median_bound = of_shown.median(0)
    thin = ~(np.where(np.isinf(ratio), proven, ratio) >= margin)
    enough = Grade.THIN if thin.any() else Grade.SAFE
    grade = Grade.NOT_SAFE if under.any() else Grade.NOT_KNOWN if open_.any() or not open_.size else enough
    return DemandVerdict(
        name=name,
        grade=grade,
        smallest=smallest,
        median=median,
        smallest_bound=smallest_bound,
        median_bound=median_bound,
        smallest_open=smallest_open,
        limit=search_limit(shown, reached),
        below=int(np.count_nonzero(under)),
        unknown=int(np.count_nonzero(open_ & ~under)),
    )
