"""The verdict on every body over all motions: whether it may be counted as safe, by how much, and what it rests on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.capacity_overview import THIN_MARGIN, search_limit
from rockpulse.models.response import Outcome
from rockpulse.report.events import largest_share
from rockpulse.report.motions import Motions
from rockpulse.report.standing import Body, Standing, lanes, standings

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["BodyVerdict", "DemandVerdict", "Grade", "verdicts"]


class Grade(IntEnum):
    """What is said of a body, from best to worst."""

    SAFE = 0
    STANDS = 1  #: under a design sequence, which stands for other motions and does not bound them
    THIN = 2
    NO_MARGIN = 3
    NOT_KNOWN = 4
    NOT_SAFE = 5


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
    smallest, smallest_bound = _smallest(factor, bound, motions)
    searched = _or(lanes(summary, "safe_up_to", bodies, model), single, math.nan)
    of_demands = _demands(summary, bodies, model, motions, single)
    events = np.array(motions.events)
    best = Grade.STANDS if motions.kind == "sequence" else Grade.SAFE
    found = []
    for lane, body in enumerate(bodies):
        own = worst[:, lane]
        hit = len(set(events[own >= Standing.UNKNOWN].tolist()))
        low, at_low = _of_known(np.min, smallest[:, lane], smallest_bound[:, lane])
        middle, at_middle = _of_known(np.median, smallest[:, lane], smallest_bound[:, lane])
        found.append(
            BodyVerdict(
                body=body,
                grade=max(best, _GRADE[Standing(int(own.max()))]) if own.size else Grade.NOT_KNOWN,
                counts={kind: int(np.count_nonzero(own == kind)) for kind in Standing},
                at_rest=int(np.count_nonzero(resting[:, lane])),
                smallest=low,
                median=middle,
                smallest_bound=at_low,
                median_bound=at_middle,
                limit=search_limit(factor[:, lane], searched[:, lane]),
                governing=_governing(factor[:, lane], single[:, lane]),
                events_hit=hit,
                largest_share=math.nan if motions.kind == "sequence" else largest_share(hit, motions.event_count),
                demands=of_demands[lane],
            )
        )
    return found


def _or(table: np.ndarray | None, like: np.ndarray, otherwise: float) -> np.ndarray:
    return np.full(like.shape, otherwise) if table is None else table


def _smallest(values: np.ndarray, bound: np.ndarray, motions: Motions) -> tuple[np.ndarray, np.ndarray]:
    """Of every motion the smallest over its directions, NaN where one is NaN or missing, and whether it is a bound."""
    low = np.full((len(motions.rows), values.shape[1]), np.nan)
    at = np.zeros(low.shape, dtype=bool)
    for place, rows in enumerate(motions.rows):
        if motions.missing[place]:
            continue
        low[place] = values[rows].min(axis=0)
        largest = np.where(bound[rows], np.inf, values[rows]).min(axis=0)
        at[place] = largest > low[place]
    return low, at


def _of_known(which: Callable[[np.ndarray], Any], values: np.ndarray, bound: np.ndarray) -> tuple[float, bool]:
    """The smallest or the median of what is known, and whether it may be larger."""
    known = ~np.isnan(values)
    if not known.any():
        return math.nan, False
    low, high = (float(which(of[known])) for of in (values, np.where(bound, np.inf, values)))
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
    doubtful = np.zeros(single.shape, dtype=bool)
    for name in ("applicable", "predictable"):
        doubtful |= _or(lanes(summary, name, bodies, model), single, 1) == 0
    found = [
        [
            _demand(str(name), ratios[:, lane, place], bound[:, lane], proven[:, lane], doubtful[:, lane], motions)
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
    name: str, ratio: np.ndarray, bound: np.ndarray, proven: np.ndarray, doubtful: np.ndarray, motions: Motions
) -> DemandVerdict:
    """One body, one demand: all arrays are of the records."""
    below = (ratio < 1.0) & ~bound
    # A search that ends below the demand has shown nothing of what lies between.
    unknown = ~below & (np.isnan(ratio) | ((ratio < 1.0) & bound) | (np.isinf(ratio) & ~(proven >= 1.0)) | doubtful)
    under = np.array([below[rows].any() for rows in motions.rows], dtype=bool)
    open_ = np.array([unknown[rows].any() for rows in motions.rows], dtype=bool) | motions.missing
    low, at = _smallest(ratio[:, None], bound[:, None], motions)
    reached = np.array([proven[rows].min() for rows in motions.rows])
    told = ~np.isnan(low[:, 0]) & ~(np.isinf(low[:, 0]) & (reached < 1.0))
    shown = np.where(told, low[:, 0], np.nan) if told.any() else low[:, 0]
    smallest, smallest_bound = _of_known(np.min, shown, at[:, 0])
    median, median_bound = _of_known(np.median, shown, at[:, 0])
    enough = Grade.THIN if smallest < THIN_MARGIN else Grade.SAFE
    grade = Grade.NOT_SAFE if under.any() else Grade.NOT_KNOWN if open_.any() or not open_.size else enough
    return DemandVerdict(
        name=name,
        grade=grade,
        smallest=smallest,
        median=median,
        smallest_bound=smallest_bound,
        median_bound=median_bound,
        limit=search_limit(shown, reached),
        below=int(np.count_nonzero(under)),
        unknown=int(np.count_nonzero(open_ & ~under)),
    )
