"""Seismic hazard, the annual rate of exceedance of an intensity measure: a power law, a table, or one for each body.

.. note:: A hazard is an annual rate of exceedance H over levels x in SI units. A curve is linear in the logarithms
   between its points, and is extrapolated with its outermost slopes. With the soil factor S, the rate of x at the
   ground surface of a site is the rate of x/S on rock.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rocking.pictures import short_repr
from rockpulse.errors import ConfigError
from rockpulse.option import hint
from rockpulse.record.measures import HAZARD, MEASURES, PGA


def unit_factor(measure: str, unit: str, where: str) -> float:
    """Return the factor that converts a unit to SI; ConfigError, which begins with `where`, for an unknown unit."""
    known = MEASURES[measure].known_units
    if unit not in known:
        raise ConfigError(f"{where}: expected a unit of {measure} among {', '.join(known)}, found {unit!r}")
    return known[unit]


def known_measure(measure: str, where: str) -> str:
    """Return the measure if a hazard can be given in it; otherwise raise ConfigError, which begins with `where`."""
    if measure not in HAZARD:
        found = f"found {measure!r}{hint(measure, HAZARD)}"
        raise ConfigError(f"{where}: expected a measure among {', '.join(HAZARD)}, {found}")
    return measure


class _Hazard(ABC):
    """Base class of the hazard at one point: the annual rate at which each level of a measure is exceeded."""

    measure: str
    unit: str
    soil_factor: float

    def _check(self, where: str, **positive: float) -> None:
        """Set the default unit; raise ConfigError for an unknown measure or unit, or a value that is not positive."""
        known_measure(self.measure, f"{where} measure")
        object.__setattr__(self, "unit", self.unit or MEASURES[self.measure].shown_unit)
        unit_factor(self.measure, self.unit, f"{where} unit")
        for name, value in {**positive, "soil_factor": self.soil_factor}.items():
            if not (isinstance(value, (int, float)) and math.isfinite(value) and value > 0.0):
                raise ConfigError(f"{where} {name}: expected a positive number, found {value!r}")

    @property
    def unit_in_si(self) -> float:
        """Factor that converts the unit of the levels to SI."""
        return MEASURES[self.measure].known_units[self.unit]

    @property
    def _levels(self) -> str:
        on_soil = "" if self.soil_factor == 1.0 else f", levels times the soil factor {self.soil_factor:g}"
        return f"{self.measure} in {self.unit}{on_soil}"

    def rate(self, level: np.ndarray | float) -> np.ndarray:
        """Return the annual rate of exceedance [1/year] at levels in SI units."""
        return np.exp(self.log_rate(np.log(np.asarray(level, dtype=float))))

    @abstractmethod
    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """Return the logarithm of the annual rate [1/year] at the logarithms of levels in SI units."""


@dataclass(frozen=True)
class PowerLawHazard(_Hazard):
    """The annual rate of exceedance k0 x^-k.

    Attributes
    ----------
    k0, k : float
        Annual rate at x = 1 (in `unit`) and log-log slope [-].
    measure : str
        Intensity measure of :data:`rockpulse.record.measures.HAZARD`, such as "pga".
    unit : str
        Unit of x: "m/s2", "g", "cm/s2", or for a velocity "m/s", "cm/s"; SI by default.
    soil_factor : float
        Ratio of levels at the site surface to those for which k0 and k were given [-].
    warnings : tuple of str
        Warnings on the hazard.

    Raises
    ------
    ConfigError
        For numbers that are not positive, or an unknown measure or unit.

    Examples
    --------
    >>> hazard = PowerLawHazard(k0=1e-4, k=2.5, unit="g")
    >>> round(float(hazard.rate(9.80665)), 10)
    0.0001
    """

    __repr__ = short_repr

    #: Logarithms of the levels at which the log-log slope changes, and range of levels for which the hazard is given.
    knots: ClassVar[np.ndarray] = np.zeros(0)
    covered: ClassVar[tuple[float, float]] = (0.0, math.inf)

    k0: float
    k: float
    measure: str = PGA
    unit: str = ""
    soil_factor: float = 1.0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check("[hazard]", k0=self.k0, k=self.k)

    @property
    def words(self) -> str:
        """Description of the hazard in words."""
        return f"power law {self.k0:g} x^-{self.k:g} of {self._levels}"

    @property
    def slopes(self) -> np.ndarray:
        """Log-log slopes from low to high levels."""
        return np.array([self.k])

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """Return the logarithm of the annual rate [1/year] at the logarithms of levels in SI units."""
        one = math.log(self.unit_in_si * self.soil_factor)
        return np.asarray(math.log(self.k0) - self.k * (log_level - one))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """Return the logarithm of -dH/d ln x [1/year] at the logarithms of levels in SI units."""
        return math.log(self.k) + self.log_rate(log_level)

    def integral_above(self, log_level: np.ndarray) -> np.ndarray:
        """Return the integral [1/year] of the rate over ln x, from `log_level` (of a level in SI units) to infinity."""
        return np.exp(self.log_rate(log_level)) / self.k


@dataclass(frozen=True, eq=False)
class HazardCurve(_Hazard):
    """A hazard curve given by a table.

    Attributes
    ----------
    level, rates : (n,) ndarray
        Levels in SI units, ascending, and annual rates of exceedance [1/year], positive and not increasing.
    source : str
        Name of the source for messages.
    unit : str
        Unit of levels in messages; SI by default.
    measure, soil_factor, warnings
        As for :class:`PowerLawHazard`.

    Raises
    ------
    ConfigError
        For fewer than two points, levels or rates that are not positive or not in order, two equal last rates, or
        an unknown measure or unit.

    Examples
    --------
    >>> curve = HazardCurve("pga", np.array([1.0, 2.0, 4.0]), np.array([1e-2, 2e-3, 2e-4]))
    >>> curve.rate(np.array([1.0, 2.0 ** 0.5, 8.0])).round(6).tolist()
    [0.01, 0.004472, 2e-05]
    """

    __repr__ = short_repr

    measure: str
    level: np.ndarray
    rates: np.ndarray
    source: str = "hazard"
    unit: str = ""
    soil_factor: float = 1.0
    warnings: tuple[str, ...] = ()
    knots: np.ndarray = field(init=False, repr=False)  #: Logarithms of the levels at which the slope changes
    slopes: np.ndarray = field(init=False, repr=False)  #: Log-log slopes from low to high levels

    def __post_init__(self) -> None:
        level, rates = np.asarray(self.level, dtype=float), np.asarray(self.rates, dtype=float)
        self._check(self.source)
        if level.ndim != 1 or level.shape != rates.shape or level.size < 2:
            raise ConfigError(
                f"{self.source}: expected as many rates as levels, two or more, found {rates.size} and {level.size}"
            )
        if not (np.all(np.isfinite(level) & (level > 0.0)) and np.all(np.diff(level) > 0.0)):
            raise ConfigError(f"{self.source}: expected positive levels in ascending order, found {level.tolist()}")
        if not (np.all(np.isfinite(rates) & (rates > 0.0)) and np.all(np.diff(rates) <= 0.0)):
            raise ConfigError(f"{self.source}: expected positive rates that do not increase, found {rates.tolist()}")
        slopes = -np.diff(np.log(rates)) / np.diff(np.log(level))
        if slopes[-1] == 0.0:
            raise ConfigError(f"{self.source}: the last two rates are equal, {rates[-1]:g}: leave the last one out")
        knots = np.log(level * self.soil_factor)
        for name, value in (("level", level), ("rates", rates), ("knots", knots), ("slopes", slopes)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def covered(self) -> tuple[float, float]:
        """First and last level of the table, multiplied by the soil factor."""
        return float(self.level[0] * self.soil_factor), float(self.level[-1] * self.soil_factor)

    @property
    def words(self) -> str:
        """Description of the hazard in words."""
        return f"{self.source}: {self.level.size} points of {self._levels}"

    def _piece(self, log_level: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.knots, log_level, side="right") - 1, 0, self.slopes.size - 1)

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """Return the logarithm of the annual rate [1/year] at the logarithms of levels in SI units."""
        piece = self._piece(log_level)
        return np.asarray(np.log(self.rates[piece]) - self.slopes[piece] * (log_level - self.knots[piece]))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """Return ln(-dH/d ln x) [1/year] at the logarithms of levels in SI units; -inf if the rate is constant."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.slopes[self._piece(log_level)]) + self.log_rate(log_level))

    def integral_above(self, log_level: np.ndarray) -> np.ndarray:
        """Return the integral [1/year] of the rate over ln x, from `log_level` (of a level in SI units) to infinity."""
        piece = self._piece(log_level)
        ends = np.append(self.knots[1:-1], np.inf)
        level = self.slopes == 0.0  # never in the last piece
        slopes = np.where(level, 1.0, self.slopes)

        def of_piece(start: np.ndarray, number: np.ndarray) -> np.ndarray:
            length = ends[number] - start
            share = np.where(level[number], length, -np.expm1(-slopes[number] * length) / slopes[number])
            return np.asarray(np.exp(self.log_rate(start)) * share)

        whole = of_piece(self.knots[:-1], np.arange(slopes.size))
        beyond = np.append(np.cumsum(whole[:0:-1])[::-1], 0.0)
        return of_piece(np.asarray(log_level, dtype=float), piece) + beyond[piece]


#: The hazard of one site.
Hazard: TypeAlias = PowerLawHazard | HazardCurve


@dataclass(frozen=True, eq=False)
class SiteHazards:
    """A hazard for each of m bodies, from :func:`rockpulse.load_site_hazards`.

    Attributes
    ----------
    hazards : tuple of PowerLawHazard or HazardCurve
        The distinct hazards, all of one measure and unit.
    of_body, distance : (m,) ndarray
        Index of each body's hazard, and distance [m] of the body's site from the point for which this hazard is given;
        NaN if unknown.

    Raises
    ------
    ConfigError
        If there is no hazard, for different measures or units, or invalid indices of hazards.

    Examples
    --------
    >>> hazards = rp.load_site_hazards("curves.csv", [(12.0, 42.0), (13.0, 42.0), (13.1, 42.0)])
    >>> len(hazards.hazards), hazards.of_body.tolist(), hazards.distance.round(-2).tolist()
    (2, [0, 1, 1], [0.0, 0.0, 8300.0])
    """

    __repr__ = short_repr

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
    def distinct(cls, keys: np.ndarray, hazard: Callable[..., Hazard], distance: np.ndarray | None = None) -> Self:
        """Return the hazards of bodies; `hazard` makes each hazard from a row of `keys`, which has a row per body."""
        found, of_body = np.unique(keys, axis=0, return_inverse=True)
        known = np.full(len(keys), np.nan) if distance is None else distance
        return cls(tuple(hazard(*key) for key in found.tolist()), of_body.ravel(), known)

    @property
    def measure(self) -> str:
        """Intensity measure of the hazards."""
        return self.hazards[0].measure

    @property
    def covered(self) -> tuple[float, float]:
        """First and last level of the hazards; a level that differs between hazards is NaN."""
        ends = np.array([one.covered for one in self.hazards])
        low, high = np.where(ends.min(axis=0) == ends.max(axis=0), ends[0], np.nan).tolist()
        return low, high

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings on the hazards, and the largest distance of a body from the point of its hazard curve."""
        texts = tuple(dict.fromkeys(text for one in self.hazards for text in one.warnings))
        if np.all(np.isnan(self.distance)):
            return texts
        return (
            f"given for the point nearest to each body, up to {1e-3 * np.nanmax(self.distance):.1f} km away",
            *texts,
        )

    @property
    def words(self) -> str:
        """Description of the hazards in words."""
        if len(self.hazards) == 1:
            return self.hazards[0].words
        return (
            f"{len(self.hazards)} hazards of {self.measure} in {self.hazards[0].unit}, such as {self.hazards[0].words}"
        )

    def chosen(self, bodies: np.ndarray) -> "SiteHazards":
        """Return the hazards of some of the bodies, given by their indices."""
        return SiteHazards(self.hazards, self.of_body[bodies], self.distance[bodies])

    def of_each(self, quantity: str, log_level: np.ndarray) -> np.ndarray:
        """Return, by body, "log_rate" or "integral_above" at levels (m, ...), given as ln of SI values."""
        found = np.empty(log_level.shape)
        for number in np.unique(self.of_body).tolist():
            own = self.of_body == number
            found[own] = getattr(self.hazards[number], quantity)(log_level[own])
        return found


def of_each(values: ArrayLike, count: int, what: str) -> np.ndarray:
    """Return a positive number for each of `count` bodies, from one or `count` numbers; else raise ConfigError."""
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        found = np.full(1, np.nan)
    if found.shape not in ((), (count,)) or not np.all(np.isfinite(found) & (found > 0.0)):
        raise ConfigError(
            f"{what}: expected one positive number, or one for each of {count} bodies, got {values!r:.80}"
        )
    return np.broadcast_to(found, (count,))
