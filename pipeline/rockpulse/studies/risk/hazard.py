"""How often the ground exceeds a level of an intensity measure: a power law, or a tabled hazard curve.

.. note:: A hazard is an annual rate of exceedance H over levels x in SI units. Between its points a curve is straight
   in the logarithms; beyond them it goes on with its outermost slopes, which is told wherever it matters. A hazard of
   rock is brought to the ground of a site by the soil factor S: the rate of x there is that of x/S on rock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.record.measures import HAZARD, MEASURES, PGA

__all__ = ["Hazard", "HazardCurve", "PowerLawHazard", "known_measure", "unit_factor"]


def unit_factor(measure: str, unit: str, where: str) -> float:
    """A unit of a measure in SI units; ConfigError for a unit of something else."""
    known = MEASURES[measure].known_units
    if unit not in known:
        raise ConfigError(f"{where}: expected a unit of {measure} among {', '.join(known)}, found {unit!r}")
    return known[unit]


def known_measure(measure: str, where: str) -> str:
    """The measure itself; ConfigError where hazards are not given in it."""
    if measure not in HAZARD:
        raise ConfigError(f"{where}: expected a measure among {', '.join(HAZARD)}, found {measure!r}")
    return measure


def _checked_unit(measure: str, unit: str, where: str) -> str:
    """The unit, that in SI where it is empty; ConfigError for an unknown measure or a unit that it does not have."""
    known_measure(measure, f"{where} measure")
    unit = unit or MEASURES[measure].shown_unit
    unit_factor(measure, unit, f"{where} unit")
    return unit


def _check_positive(where: str, **values: float) -> None:
    for name, value in values.items():
        if not (isinstance(value, (int, float)) and math.isfinite(value) and value > 0.0):
            raise ConfigError(f"{where} {name}: expected a positive number, found {value!r}")


def _on_soil(soil_factor: float) -> str:
    return "" if soil_factor == 1.0 else f", levels times the soil factor {soil_factor:g}"


@dataclass(frozen=True)
class PowerLawHazard:
    """The annual rate of exceedance k0 x^-k.

    Attributes
    ----------
    k0 : float
        Rate at the level 1 in the unit [1/year].
    k : float
        Slope in the logarithms [-].
    measure : str
        Intensity measure, of those that serve hazards in :data:`rockpulse.record.measures.MEASURES`, such as "pga".
    unit : str
        Of the level at which k0 is meant: "m/s2", "g", "cm/s2", or "m/s", "cm/s" of a velocity; that in SI without.
    soil_factor : float
        Levels at the ground of the site over those that k0 and k are meant for [-].
    remarks : tuple of str
        What is to be known of the hazard, in words.

    Raises
    ------
    ConfigError
        For numbers that are not positive, a measure or a unit that is not known.

    Examples
    --------
    >>> hazard = PowerLawHazard(k0=1e-4, k=2.5, unit="g")
    >>> round(float(hazard.rate(9.80665)), 10)
    0.0001
    """

    k0: float
    k: float
    measure: str = PGA
    unit: str = ""
    soil_factor: float = 1.0
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_positive("[hazard]", k0=self.k0, k=self.k, soil_factor=self.soil_factor)
        object.__setattr__(self, "unit", _checked_unit(self.measure, self.unit, "[hazard]"))

    @property
    def unit_in_si(self) -> float:
        """The unit in SI units."""
        return unit_factor(self.measure, self.unit, "hazard")

    @property
    def knots(self) -> np.ndarray:
        """Logarithms of the levels at which the slope changes: none."""
        return np.zeros(0)

    @property
    def covered(self) -> tuple[float, float]:
        """Levels between which the hazard was given."""
        return 0.0, math.inf

    @property
    def words(self) -> str:
        """What the hazard is, in words."""
        return f"power law {self.k0:g} x^-{self.k:g} of {self.measure} in {self.unit}{_on_soil(self.soil_factor)}"

    @property
    def slopes(self) -> np.ndarray:
        """The slopes in the logarithms, from low levels to high ones."""
        return np.array([self.k])

    def rate(self, level: np.ndarray | float) -> np.ndarray:
        """Annual rate of exceedance [1/year] at levels in SI units."""
        return np.exp(self.log_rate(np.log(np.asarray(level, dtype=float))))

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """ln of the rate at logarithms of levels in SI units."""
        one = math.log(self.unit_in_si * self.soil_factor)
        return np.asarray(math.log(self.k0) - self.k * (log_level - one))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """ln of -dH/d ln x [1/year] at logarithms of levels in SI units."""
        return math.log(self.k) + self.log_rate(log_level)

    def integral_above(self, log_level: np.ndarray) -> np.ndarray:
        """The integral of the rate over ln x from logarithms of levels in SI units upwards [1/year]."""
        return np.exp(self.log_rate(log_level)) / self.k


@dataclass(frozen=True, eq=False)
class HazardCurve:
    """A tabled hazard curve.

    Attributes
    ----------
    measure : str
        As for :class:`PowerLawHazard`.
    level : (n,) ndarray
        Levels in SI units, ascending.
    rates : (n,) ndarray
        Annual rates of exceedance [1/year], positive and not rising.
    source : str
        Where it comes from, for messages.
    unit : str
        In which levels are told; that in SI without.
    soil_factor : float
        Levels at the ground of the site over those of the curve [-].
    remarks : tuple of str
        What is to be known of the curve, in words.

    Raises
    ------
    ConfigError
        For fewer than two points, levels or rates that are not positive or not in order, an unknown measure or unit, or
        last rates that are alike.

    Examples
    --------
    >>> curve = HazardCurve("pga", np.array([1.0, 2.0, 4.0]), np.array([1e-2, 2e-3, 2e-4]))
    >>> curve.rate(np.array([1.0, 2.0 ** 0.5, 8.0])).round(6).tolist()
    [0.01, 0.004472, 2e-05]
    """

    measure: str
    level: np.ndarray
    rates: np.ndarray
    source: str = "hazard"
    unit: str = ""
    soil_factor: float = 1.0
    remarks: tuple[str, ...] = ()
    knots: np.ndarray = field(init=False, repr=False)  #: Logarithms of the levels at which the slope changes
    slopes: np.ndarray = field(init=False, repr=False)  #: The slopes in the logarithms, from low levels to high ones

    def __post_init__(self) -> None:
        level, rates = np.asarray(self.level, dtype=float), np.asarray(self.rates, dtype=float)
        object.__setattr__(self, "unit", _checked_unit(self.measure, self.unit, self.source))
        _check_positive(self.source, soil_factor=self.soil_factor)
        if level.ndim != 1 or level.shape != rates.shape or level.size < 2:
            raise ConfigError(
                f"{self.source}: expected as many rates as levels, two or more, found {rates.size} and {level.size}"
            )
        if not (np.all(np.isfinite(level) & (level > 0.0)) and np.all(np.diff(level) > 0.0)):
            raise ConfigError(f"{self.source}: expected positive levels that ascend, found {level.tolist()}")
        if not (np.all(np.isfinite(rates) & (rates > 0.0)) and np.all(np.diff(rates) <= 0.0)):
            raise ConfigError(f"{self.source}: expected positive annual rates that do not rise, found {rates.tolist()}")
        slopes = -np.diff(np.log(rates)) / np.diff(np.log(level))
        if slopes[-1] == 0.0:
            raise ConfigError(
                f"{self.source}: the last two rates are alike, {rates[-1]:g}: nothing says how it falls beyond them"
            )
        knots = np.log(level * self.soil_factor)
        for name, value in (("level", level), ("rates", rates), ("knots", knots), ("slopes", slopes)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def unit_in_si(self) -> float:
        """The unit in SI units."""
        return unit_factor(self.measure, self.unit, self.source)

    @property
    def covered(self) -> tuple[float, float]:
        """Levels between which the hazard was given, at the ground of the site."""
        return float(self.level[0] * self.soil_factor), float(self.level[-1] * self.soil_factor)

    @property
    def words(self) -> str:
        """What the hazard is, in words."""
        return f"{self.source}: {self.level.size} points of {self.measure} in {self.unit}{_on_soil(self.soil_factor)}"

    def _piece(self, log_level: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.knots, log_level, side="right") - 1, 0, self.slopes.size - 1)

    def rate(self, level: np.ndarray | float) -> np.ndarray:
        """Annual rate of exceedance [1/year] at levels in SI units."""
        return np.exp(self.log_rate(np.log(np.asarray(level, dtype=float))))

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """ln of the rate at logarithms of levels in SI units."""
        piece = self._piece(log_level)
        return np.asarray(np.log(self.rates[piece]) - self.slopes[piece] * (log_level - self.knots[piece]))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """ln of -dH/d ln x [1/year] at logarithms of levels in SI units; -inf where the rate does not fall."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.slopes[self._piece(log_level)]) + self.log_rate(log_level))

    def integral_above(self, log_level: np.ndarray) -> np.ndarray:
        """The integral of the rate over ln x from logarithms of levels in SI units upwards [1/year]."""
        piece = self._piece(log_level)
        ends = np.append(self.knots[1:-1], np.inf)
        level = self.slopes == 0.0  # a piece on which the rate stays the same, never the last one
        slopes = np.where(level, 1.0, self.slopes)

        def of_piece(start: np.ndarray, number: np.ndarray) -> np.ndarray:
            length = ends[number] - start
            share = np.where(level[number], length, -np.expm1(-slopes[number] * length) / slopes[number])
            return np.asarray(np.exp(self.log_rate(start)) * share)

        whole = of_piece(self.knots[:-1], np.arange(slopes.size))
        beyond = np.append(np.cumsum(whole[:0:-1])[::-1], 0.0)
        return of_piece(np.asarray(log_level, dtype=float), piece) + beyond[piece]


#: Either of them.
Hazard: TypeAlias = PowerLawHazard | HazardCurve
