"""The ground motions of a results file, and the probability over their earthquakes that one overturns a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rockpulse.earthquakes import members, probability_interval
from rockpulse.motions.events import UNKNOWN


class Share(NamedTuple):
    """The probability that a motion overturns a body, over earthquakes that weigh alike, with its interval of 90 % [-].

    Where results hold no probability it is the share of earthquakes whose motions overturn the body, as they are or
    weaker. ``least`` and ``most`` are what it is if the motions that are not known never overturn the body, or always;
    ``low`` and ``high`` the ends of the interval for other earthquakes like these, ``unknown`` the motions that are not
    known.
    """

    value: float
    low: float
    high: float
    least: float
    most: float
    unknown: int


@dataclass(frozen=True, eq=False)
class Motions:
    """The ground motions of the results: ids of records or names of pairs, and the rows of /summary of each.

    ``index`` is (motions, directions), -1 where a direction was not assessed; ``events`` are the earthquakes of the
    motions; ``kind`` is "record", "pair" or "sequence". ``any_azimuth`` says that the direction of the bodies is not
    known: the probability of a pair is then the mean over its directions, not that of the worst.
    """

    names: list[str]
    index: np.ndarray
    events: list[str]
    kind: str
    any_azimuth: bool = False

    @property
    def event_count(self) -> int:
        """Number of earthquakes that are known to be others; one where none is known."""
        return _others(self.events)

    def kept(self, left_out: np.ndarray) -> np.ndarray:
        """(motions, bodies) True for the motions of which a direction is not left out (records, bodies)."""
        return np.asarray(~self.over(left_out, True).all(axis=1))

    def event_counts(self, kept: np.ndarray) -> np.ndarray:
        """The same of the motions that are kept for each body, (bodies,) of (motions, bodies)."""
        return np.array([_others(np.array(self.events, dtype=str)[own].tolist()) for own in kept.T], dtype=int)

    def over(self, values: np.ndarray, missing: Any) -> np.ndarray:
        """Values (records, ...) as (motions, directions, ...), with `missing` in a direction that was not assessed."""
        return np.concatenate([values, np.full_like(values, missing, shape=(1, *values.shape[1:]))])[self.index]

    def anywhere(self, so: np.ndarray, missing: bool = False) -> np.ndarray:
        """(motions, ...) where something (records, ...) is so in one of the directions, or in a missing one."""
        return np.asarray(self.over(so, missing).any(axis=1))

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Mean over the earthquakes, which weigh alike, of the mean over the motions of each: (...) of (motions, ...).

        Motions that are NaN are left out; without any other it is NaN.
        """
        own = members(np.array(self.events, dtype=str)).astype(float)
        known = ~np.isnan(values)
        counts, sums = (np.tensordot(own, table, 1) for table in (known, np.where(known, values, 0.0)))
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sum(sums / counts, axis=0, where=counts > 0.0) / (counts > 0.0).sum(axis=0))

    def shares(self, probability: np.ndarray, left_out: np.ndarray | None = None) -> list[Share]:
        """Of every body the probability over the earthquakes, from that (records, bodies) under each record.

        Motions of which all directions are `left_out` (records, bodies) count as if they were not there.

        Notes
        -----
        The interval is that of Clopper & Pearson (1934) for as many earthquakes, of which the sum of the probabilities
        overturn the body. A sum of independent numbers between 0 and 1 spreads no more than a binomial one of the same
        mean (Hoeffding 1956, Ann. Math. Stat. 27(3), 713-721, doi:10.1214/aoms/1177728178), so it covers at least what
        it states: over 20 populations, 3 to 30 earthquakes, 0.94 to 1.00 at nominal 0.90, where percentiles of
        resampled earthquakes cover 0.01 to 0.85 and the bootstrap-t 0.34 to 0.95. For none of n it is 1 - 0.05^(1/n),
        the rule of three 3/n.
        """
        table = self.over(probability, np.nan)
        # Of the directions of a pair the worst counts, unless that of the body is not known either.
        over = np.mean if self.any_azimuth else np.max
        known, least, most = (over(np.where(np.isnan(table), filled, table), axis=1) for filled in (np.nan, 0.0, 1.0))
        known = np.where(least == most, least, known)
        kept = np.ones(known.shape, dtype=bool) if left_out is None else self.kept(left_out)
        unknown = (np.isnan(known) & kept).sum(axis=0)
        value, least, most = (self.mean(np.where(kept, one, np.nan)) for one in (known, least, most))
        low, high = probability_interval(value, self.event_counts(kept))
        tables = (value, low, high, least, most, unknown)
        return [Share(*one) for one in zip(*(table.tolist() for table in tables), strict=True)]


def _others(events: list[str]) -> int:
    """Number of earthquakes that are known to be others; one where none is known, 0 where there is none."""
    return len({event for event in events if event != UNKNOWN}) or len(set(events))
