"""The hazards of many bodies, each at its own site."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rockpulse.errors import ConfigError
from rockpulse.studies.risk.hazard import Hazard

__all__ = ["SiteHazards", "of_each"]


@dataclass(frozen=True, eq=False)
class SiteHazards:
    """A hazard for each of m bodies; those of one site and soil factor share it.

    Made by :func:`rockpulse.load_site_hazards`.

    Attributes
    ----------
    hazards : tuple of PowerLawHazard or HazardCurve
        The different ones, all of one measure and unit.
    of_body : (m,) ndarray
        The number of the hazard of each body.
    distance : (m,) ndarray
        From the site of each body to the place that its hazard was computed for [m]; NaN where that is not known.
    """

    hazards: tuple[Hazard, ...]
    of_body: np.ndarray
    distance: np.ndarray

    @classmethod
    def distinct(
        cls, keys: np.ndarray, hazard: Callable[..., Hazard], distance: np.ndarray | None = None
    ) -> SiteHazards:
        """The hazards of m bodies whose keys (m, k) say which ones are alike; `hazard` makes one of a key."""
        found, of_body = np.unique(keys, axis=0, return_inverse=True)
        known = np.full(len(keys), np.nan) if distance is None else distance
        return cls(tuple(hazard(*key) for key in found.tolist()), of_body.ravel(), known)

    @property
    def measure(self) -> str:
        """The intensity measure of all."""
        return self.hazards[0].measure

    @property
    def unit(self) -> str:
        """The unit in which levels are told."""
        return self.hazards[0].unit

    @property
    def unit_in_si(self) -> float:
        """The unit in SI units."""
        return self.hazards[0].unit_in_si

    @property
    def covered(self) -> tuple[float, float]:
        """Levels between which the hazard was given; NaN for an end that is not the same for all."""
        ends = np.array([one.covered for one in self.hazards])
        low, high = np.where(ends.min(axis=0) == ends.max(axis=0), ends[0], np.nan).tolist()
        return low, high

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is to be known of any of them, and how far away the places of the curves are."""
        told = tuple(dict.fromkeys(text for one in self.hazards for text in one.remarks))
        if np.all(np.isnan(self.distance)):
            return told
        return (f"of the place nearest to each body, up to {1e-3 * np.nanmax(self.distance):.1f} km away", *told)

    @property
    def words(self) -> str:
        """What the hazards are, in words."""
        if len(self.hazards) == 1:
            return self.hazards[0].words
        return f"{len(self.hazards)} hazards of {self.measure} in {self.unit}, such as {self.hazards[0].words}"

    def chosen(self, bodies: np.ndarray) -> SiteHazards:
        """The hazards of some bodies by their numbers."""
        return SiteHazards(self.hazards, self.of_body[bodies], self.distance[bodies])

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """ln of the annual rate of each body at logarithms (m, ...) of levels in SI units."""
        found = np.empty(log_level.shape)
        for number in np.unique(self.of_body).tolist():
            own = self.of_body == number
            found[own] = self.hazards[number].log_rate(log_level[own])
        return found

    def log_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Logarithms (m, 1) of the levels between which the hazard of each body was given."""
        with np.errstate(divide="ignore"):
            ends = np.log([self.hazards[number].covered for number in self.of_body.tolist()])
        return ends[:, :1], ends[:, 1:]


def of_each(values: ArrayLike, count: int, what: str) -> np.ndarray:
    """A positive number for each of so many bodies, or one for all: (count,); ConfigError for anything else."""
    found = np.asarray(values, dtype=float)
    if found.shape not in ((), (count,)) or not np.all(np.isfinite(found) & (found > 0.0)):
        raise ConfigError(
            f"{what}: expected one positive number, or one for each of {count} bodies, got {values!r:.80}"
        )
    return np.broadcast_to(found, (count,))
