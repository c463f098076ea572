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

    Raises
    ------
    ConfigError
        For no hazard, hazards of several measures or units, or numbers of hazards that there are not.
    """

    hazards: tuple[Hazard, ...]
    of_body: np.ndarray
    distance: np.ndarray

    def __post_init__(self) -> None:
        kinds = {(one.measure, one.unit) for one in self.hazards}
        if len(kinds) != 1:
            found = ", ".join(f"{measure} in {unit}" for measure, unit in sorted(kinds))
            raise ConfigError(f"hazards: expected one measure in one unit, found {found or 'no hazard'}")
        numbers, distance = np.asarray(self.of_body), np.asarray(self.distance, dtype=float)
        known = np.issubdtype(numbers.dtype, np.integer) and numbers.ndim == 1
        if not known or distance.shape != numbers.shape or np.any((numbers < 0) | (numbers >= len(self.hazards))):
            raise ConfigError(
                f"of_body, distance: expected for each body a number from 0 to {len(self.hazards) - 1} and a distance, "
                f"got {self.of_body!r:.80}, {self.distance!r:.80}"
            )
        object.__setattr__(self, "of_body", numbers)
        object.__setattr__(self, "distance", distance)

    @classmethod
    def of_all(cls, hazard: Hazard, count: int) -> SiteHazards:
        """One hazard for so many bodies."""
        return cls((hazard,), np.zeros(count, int), np.full(count, np.nan))

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
        return self._of_each(log_level, lambda one, at: one.log_rate(at))

    def integral_above(self, log_level: np.ndarray) -> np.ndarray:
        """The integral of each rate over ln x from logarithms (m, ...) of levels in SI units upwards [1/year]."""
        return self._of_each(log_level, lambda one, at: one.integral_above(at))

    def _of_each(self, log_level: np.ndarray, read: Callable[[Hazard, np.ndarray], np.ndarray]) -> np.ndarray:
        if len(numbers := np.unique(self.of_body).tolist()) == 1:
            return read(self.hazards[numbers[0]], log_level)
        found = np.empty(log_level.shape)
        for number in numbers:
            own = self.of_body == number
            found[own] = read(self.hazards[number], log_level[own])
        return found

    def log_ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Logarithms (m, 1) of the levels between which the hazard of each body was given."""
        with np.errstate(divide="ignore"):
            ends = np.log([self.hazards[number].covered for number in self.of_body.tolist()])
        return ends[:, :1], ends[:, 1:]


def of_each(values: ArrayLike, count: int, what: str) -> np.ndarray:
    """A positive number for each of so many bodies, or one for all: (count,); ConfigError for anything else."""
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        found = np.full(1, np.nan)
    if found.shape not in ((), (count,)) or not np.all(np.isfinite(found) & (found > 0.0)):
        raise ConfigError(
            f"{what}: expected one positive number, or one for each of {count} bodies, got {values!r:.80}"
        )
    return np.broadcast_to(found, (count,))
