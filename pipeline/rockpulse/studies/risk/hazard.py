"""How often the ground exceeds a level of an intensity measure: a power law, or a tabled hazard curve.

.. note:: A hazard is an annual rate of exceedance H over levels x in SI units. Between its points a curve is straight
   in the logarithms; beyond them it goes on with its outermost slopes, which is told wherever it matters. A probability
   in T years is a rate by H = -ln(1 - probability)/T (Poisson).
"""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pandas as pd

from rockpulse.config.hazard_settings import HAZARD_MEASURES, HazardSettings
from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line
from rockpulse.input_file import read_text
from rockpulse.record.record import STANDARD_GRAVITY

__all__ = ["Hazard", "HazardCurve", "PowerLawHazard", "hazard_of", "load_hazard"]

#: Units of the levels, by the kind of the measure, as factors to SI.
ACCELERATIONS = {"g": STANDARD_GRAVITY, "g/10": 0.1 * STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01}
VELOCITIES = {"m/s": 1.0, "cm/s": 0.01}

#: Units of OpenQuake's levels.
OPENQUAKE = {"pga": "g", "sa": "g", "pgv": "cm/s"}


EXPECTED = (
    'expected columns "pga [g],rate" (or pgv, si, sa(1.0), and "probability in 50 years"), OpenQuake\'s hazard curves '
    '("# ... investigation_time=..., imt=...", lon,lat,depth,poe-0.005,...) or return periods ("TR [years],ag [g]")'
)


def _unit_factor(measure: str, unit: str, where: str) -> float:
    known = VELOCITIES if measure in ("pgv", "si") else ACCELERATIONS
    if unit not in known:
        raise ConfigError(f"{where}: expected a unit of {measure} among {', '.join(known)}, found {unit!r}")
    return known[unit]


def _known_measure(measure: str, where: str) -> str:
    if measure not in HAZARD_MEASURES:
        raise ConfigError(f"{where}: expected a measure among {', '.join(HAZARD_MEASURES)}, found {measure!r}")
    return measure


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
        Intensity measure, of those that fragility knows: pga, pgv, si, sa_0.5, sa_1, sa_2.
    unit : str
        Of the level at which k0 is meant: "m/s2", "g", "cm/s2", or "m/s", "cm/s" of pgv and si.

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
    measure: str = "pga"
    unit: str = ""

    def __post_init__(self) -> None:
        for name in ("k0", "k"):
            value = getattr(self, name)
            if not (isinstance(value, (int, float)) and math.isfinite(value) and value > 0.0):
                raise ConfigError(f"[hazard] {name}: expected a positive number, found {value!r}")
        _known_measure(self.measure, "[hazard] measure")
        unit = self.unit or ("m/s" if self.measure in ("pgv", "si") else "m/s2")
        object.__setattr__(self, "unit", unit)
        _unit_factor(self.measure, unit, "[hazard] unit")

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
        return f"power law {self.k0:g} x^-{self.k:g} of {self.measure} in {self.unit}"

    def slopes(self) -> tuple[float, float]:
        """Slopes in the logarithms at the lowest and highest levels."""
        return self.k, self.k

    def rate(self, level: np.ndarray | float) -> np.ndarray:
        """Annual rate of exceedance [1/year] at levels in SI units."""
        return np.exp(self.log_rate(np.log(np.asarray(level, dtype=float))))

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """ln of the rate at logarithms of levels in SI units."""
        unit = math.log(_unit_factor(self.measure, self.unit, ""))
        return np.asarray(math.log(self.k0) - self.k * (log_level - unit))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """ln of -dH/d ln x [1/year] at logarithms of levels in SI units."""
        return math.log(self.k) + self.log_rate(log_level)


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

    Raises
    ------
    ConfigError
        For fewer than two points, levels or rates that are not positive or not in order, an unknown measure, or last
        rates that are alike.

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
    _slope: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        level, rates = np.asarray(self.level, dtype=float), np.asarray(self.rates, dtype=float)
        _known_measure(self.measure, self.source)
        if level.ndim != 1 or level.shape != rates.shape or level.size < 2:
            raise ConfigError(
                f"{self.source}: expected as many rates as levels, two or more, found {rates.size} and {level.size}"
            )
        if not (np.all(np.isfinite(level) & (level > 0.0)) and np.all(np.diff(level) > 0.0)):
            raise ConfigError(f"{self.source}: expected positive levels that ascend, found {level.tolist()}")
        if not (np.all(np.isfinite(rates) & (rates > 0.0)) and np.all(np.diff(rates) <= 0.0)):
            raise ConfigError(f"{self.source}: expected positive annual rates that do not rise, found {rates.tolist()}")
        slope = -np.diff(np.log(rates)) / np.diff(np.log(level))
        if slope[-1] == 0.0:
            raise ConfigError(
                f"{self.source}: the last two rates are alike, {rates[-1]:g}: nothing says how it falls beyond them"
            )
        for name, value in (("level", level), ("rates", rates), ("_slope", slope)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def knots(self) -> np.ndarray:
        """Logarithms of the levels at which the slope changes."""
        return np.log(self.level)

    @property
    def covered(self) -> tuple[float, float]:
        """Levels between which the hazard was given."""
        return float(self.level[0]), float(self.level[-1])

    @property
    def words(self) -> str:
        """What the hazard is, in words."""
        return f"{self.source}: {self.level.size} points of {self.measure}"

    def slopes(self) -> tuple[float, float]:
        """Slopes in the logarithms at the lowest and highest levels."""
        return float(self._slope[0]), float(self._slope[-1])

    def _piece(self, log_level: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.knots, log_level, side="right") - 1, 0, self._slope.size - 1)

    def rate(self, level: np.ndarray | float) -> np.ndarray:
        """Annual rate of exceedance [1/year] at levels in SI units."""
        return np.exp(self.log_rate(np.log(np.asarray(level, dtype=float))))

    def log_rate(self, log_level: np.ndarray) -> np.ndarray:
        """ln of the rate at logarithms of levels in SI units."""
        piece = self._piece(log_level)
        return np.asarray(np.log(self.rates[piece]) - self._slope[piece] * (log_level - self.knots[piece]))

    def log_density(self, log_level: np.ndarray) -> np.ndarray:
        """ln of -dH/d ln x [1/year] at logarithms of levels in SI units; -inf where the rate does not fall."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self._slope[self._piece(log_level)]) + self.log_rate(log_level))


#: Either of them.
Hazard: TypeAlias = PowerLawHazard | HazardCurve


def load_hazard(path: str | Path, site: tuple[float, float] | None = None) -> HazardCurve:
    """A hazard curve from a CSV file.

    Parameters
    ----------
    path : str or Path
        A table of two columns, the level with its measure and unit ("pga [g]", "pgv [cm/s]", "si [m/s]", "sa(1.0)
        [g]") and "rate" [1/year] or "probability in 50 years"; OpenQuake's hazard curves of one measure; or return
        periods as Italian practice has them, "TR [years],ag [g]" with any other columns.
    site : (float, float), optional
        Longitude and latitude [degrees] of the row, for OpenQuake's curves of several sites: the nearest one.

    Returns
    -------
    HazardCurve
        In SI units. Points without a finite positive rate, at which a probability was 1 or 0, are left out.

    Raises
    ------
    ConfigError
        For a file that is none of these, or of several sites where none was named.
    """
    where = Path(path)
    if not where.exists() or where.is_dir():
        raise ConfigError(f"{path}: expected a file with a hazard curve, found none")
    text = read_text(where, what="a hazard curve")
    lines = text.splitlines()
    if lines and lines[0].startswith("#") and "investigation_time" in lines[0]:
        return _openquake(str(path), lines, site)
    table = _table(str(path), "\n".join(line for line in lines if not line.startswith("#")))
    heads = [str(name).strip() for name in table.columns]
    if heads and heads[0].lower().startswith("tr"):
        return _return_periods(str(path), table, heads)
    return _levels(str(path), table, heads)


def _table(path: str, text: str) -> pd.DataFrame:
    head = text.lstrip().partition("\n")[0]
    between = next((mark for mark in (";", "\t") if mark in head), ",")
    try:
        return pd.read_csv(io.StringIO(text), sep=between, skipinitialspace=True)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, ValueError) as error:
        raise ConfigError(f"{path}: {EXPECTED}; {first_line(error)}") from None


def _numbers(path: str, table: pd.DataFrame, column: int) -> np.ndarray:
    found = pd.to_numeric(table.iloc[:, column], errors="coerce").to_numpy(dtype=float)
    if np.any(np.isnan(found)):
        row = int(np.argmax(np.isnan(found)))
        raise ConfigError(
            f"{path}: row {row + 1} of column {table.columns[column]!r}: expected a number, found "
            f"{table.iloc[row, column]!r}"
        )
    return found


def _curve(path: str, measure: str, level: np.ndarray, rates: np.ndarray) -> HazardCurve:
    order = np.argsort(level, kind="stable")
    level, rates = level[order], rates[order]
    kept = np.isfinite(rates) & (rates > 0.0)
    return HazardCurve(measure, level[kept], rates[kept], path)


def _rates(path: str, probability: np.ndarray, years: float) -> np.ndarray:
    if not years > 0.0 or np.any((probability < 0.0) | (probability > 1.0)):
        raise ConfigError(f"{path}: expected probabilities from 0 to 1 in a positive number of years")
    with np.errstate(divide="ignore"):
        return np.asarray(-np.log1p(-probability) / years)


def _measure_of(path: str, told: str) -> str:
    found = re.fullmatch(r"sa\s*\(\s*([0-9.]+)\s*(?:s)?\s*\)", told.strip().lower())
    return _known_measure(f"sa_{float(found[1]):g}" if found else told.strip().lower(), path)


def _levels(path: str, table: pd.DataFrame, heads: list[str]) -> HazardCurve:
    first = re.fullmatch(r"(.+?)\s*\[(.+?)\]", heads[0]) if heads else None
    years = re.fullmatch(r"probability in ([0-9.]+) years?", heads[1].lower()) if len(heads) == 2 else None
    if (
        first is None
        or len(heads) != 2
        or not (years or re.fullmatch(r"rate(\s*\[1/(a|year|yr)\])?", heads[1].lower()))
    ):
        raise ConfigError(f"{path}: {EXPECTED}; found the columns {', '.join(heads) or 'none'}")
    measure = _measure_of(path, first[1])
    level = _unit_factor(measure, first[2].strip(), path) * _numbers(path, table, 0)
    second = _numbers(path, table, 1)
    return _curve(path, measure, level, _rates(path, second, float(years[1])) if years else second)


def _return_periods(path: str, table: pd.DataFrame, heads: list[str]) -> HazardCurve:
    named = {name.lower().partition("[")[0].strip(): place for place, name in enumerate(heads)}
    unit = re.fullmatch(r"ag\s*\[(.+?)\]", heads[named["ag"]].lower()) if "ag" in named else None
    if unit is None:
        raise ConfigError(f'{path}: expected the column "ag [g]" beside the return periods, found {", ".join(heads)}')
    period, level = _numbers(path, table, 0), _numbers(path, table, named["ag"])
    if np.any(period <= 0.0):
        raise ConfigError(f"{path}: expected positive return periods [years], found {period.min():g}")
    return _curve(path, "pga", _unit_factor("pga", unit[1].strip(), path) * level, 1.0 / period)


def _openquake(path: str, lines: list[str], site: tuple[float, float] | None) -> HazardCurve:
    # A row of commas may stand in front of the comment, as a spreadsheet leaves it.
    told = dict(re.findall(r"(investigation_time|imt)\s*=\s*(\"[^\"]*\"|'[^']*'|[0-9.eE+-]+)", lines[0]))
    if set(told) != {"investigation_time", "imt"}:
        raise ConfigError(f"{path}, line 1: expected investigation_time=... and imt=..., found {lines[0]!r:.120}")
    years = float(told["investigation_time"].strip("'\""))
    measure = _measure_of(path, told["imt"].strip("'\""))
    table = _table(path, "\n".join(lines[1:]))
    heads = [str(name) for name in table.columns]
    columns = [place for place, name in enumerate(heads) if name.startswith("poe-")]
    if not columns or not {"lon", "lat"} <= set(heads):
        raise ConfigError(f"{path}, line 2: expected lon, lat and poe-LEVEL columns, found {', '.join(heads)}")
    row = _row(path, table, site)
    unit = _unit_factor(measure, OPENQUAKE["sa" if measure.startswith("sa_") else measure], path)
    try:
        level = unit * np.array([float(heads[place].removeprefix("poe-")) for place in columns])
    except ValueError as error:
        raise ConfigError(f"{path}, line 2: expected a level behind poe-: {error}") from None
    probability = np.array([_numbers(path, table, place)[row] for place in columns])
    return _curve(path, measure, level, _rates(path, probability, years))


def _row(path: str, table: pd.DataFrame, site: tuple[float, float] | None) -> int:
    if len(table) == 0:
        raise ConfigError(f"{path}: expected a row for a site, found none")
    if site is None:
        if len(table) > 1:
            raise ConfigError(
                f"{path}: curves of {len(table)} sites; name one by its longitude and latitude ([hazard] longitude, "
                "latitude, or --site)"
            )
        return 0
    east = (table["lon"].to_numpy(dtype=float) - site[0]) * math.cos(math.radians(site[1]))
    return int(np.argmin(np.hypot(east, table["lat"].to_numpy(dtype=float) - site[1])))


def hazard_of(settings: HazardSettings, folder: Path = Path()) -> Hazard:
    """The hazard that a configuration asks for, its file counted from a folder; ConfigError where there is none."""
    if settings.k0 is not None and settings.k is not None:
        return PowerLawHazard(settings.k0, settings.k, settings.measure, settings.unit)
    if settings.file is None:
        raise ConfigError(
            "[hazard]: expected a file or the power law k0, k in the configuration, or --hazard, found neither"
        )
    site = None if settings.longitude is None or settings.latitude is None else (settings.longitude, settings.latitude)
    return load_hazard(folder / settings.file, site)
