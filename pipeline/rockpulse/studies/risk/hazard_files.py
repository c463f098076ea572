"""Reads hazard curves of one or many points: tables of rates, probabilities or return periods, and OpenQuake files."""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from rockpulse.config.study_settings import HazardSettings
from rockpulse.errors import ConfigError
from rockpulse.files import column_numbers, read_text, separator, table_of
from rockpulse.record.measures import MEASURES, PGA, ROWS
from rockpulse.studies.risk.hazard import (
    Hazard,
    HazardCurve,
    PowerLawHazard,
    SiteHazards,
    known_measure,
    of_each,
    unit_factor,
)

EXPECTED = (
    'expected columns "pga [g],rate" (or pgv, si, sa(1.0), and "probability in 50 years"), OpenQuake\'s hazard curves '
    '("# ... investigation_time=..., imt=...", lon,lat,depth,poe-0.005,...), return periods ("TR [years],ag [g]"), or '
    "the grid of NTC 2008 (ID;LON;LAT;T30ag;T30F0;T30Tc;...)"
)

#: Default unit of a_g in the grid of NTC 2008 (annex B).
ANNEX = "g/10"
#: Heading of a column with a_g for a return period: "T475ag", "ag_475" or "ag TR=475", with or without a unit.
OF_PERIOD = re.compile(r"(?:tr?=?(\d+)_?ag|ag_?(?:tr?=?)?(\d+))(?:\[(.+)\])?")


class _Sheet(NamedTuple):
    """The content of a hazard file: levels in the unit of the file, and annual rates [1/year], for one or n points."""

    path: str
    measure: str
    unit: str
    level: np.ndarray
    rates: np.ndarray
    places: np.ndarray | None = None  #: (n, 2) longitude and latitude [degrees]
    warnings: tuple[str, ...] = ()
    rock: bool = False  #: whether the levels are for rock

    def curve(self, row: int, soil_factor: float, warnings: tuple[str, ...] = ()) -> HazardCurve:
        """Return the hazard curve of one row in SI units, without levels of probability 1 or 0."""
        in_si = unit_factor(self.measure, self.unit, self.path)
        where = self.path if self.places is None else f"{self.path}, place {place_in_words(*self.places[row])}"
        level, rate = (values[row] if values.ndim > 1 else values for values in (self.level, self.rates))
        order = np.argsort(level, kind="stable")
        kept = order[np.isfinite(rate[order]) & (rate[order] > 0.0)]
        if kept.size < 2:
            raise ConfigError(
                f"{where}: expected two or more levels at which the rate is finite and not zero, found {kept.size} of "
                f"{level.size}"
            )
        warnings += self.warnings
        if self.rock and soil_factor == 1.0:
            warnings += ("a_g is given for rock: for other ground, set soil_factor",)
        return HazardCurve(self.measure, in_si * level[kept], rate[kept], where, self.unit, soil_factor, warnings)

    def at(self, site: tuple[float, float] | None) -> tuple[int, tuple[str, ...]]:
        """Return the row of the point nearest to a site, and a warning with its distance; ConfigError beyond 50 km."""
        if self.places is None:
            if site is None:
                return 0, ()
            raise ConfigError(
                f"{self.path}: the file has one hazard curve without coordinates, so no site can be looked up in it; "
                "remove the longitude and latitude of the site, or give a file of several sites (OpenQuake's hazard "
                "curves or the grid of NTC 2008)"
            )
        if site is not None:
            rows, distance = nearest_places(self.path, self.places, _checked_sites([site]))
            return int(rows[0]), (f"{1e-3 * distance[0]:.1f} km from the site",)
        if len(self.places) > 1:
            raise ConfigError(
                f"{self.path}: the file has curves of {len(self.places)} sites; select one by its longitude and "
                "latitude ([hazard] longitude, latitude, or --site)"
            )
        return 0, ("the only site in the file",)


def load_hazard(path: str | Path, site: tuple[float, float] | None = None, soil_factor: float = 1.0) -> HazardCurve:
    """Read a hazard curve from a CSV file.

    Parameters
    ----------
    path : str or Path
        A table of two columns, the level with its measure and unit ("pga [g]", "pgv [cm/s]", "si [m/s]", "sa(1.0) [g]")
        and "rate" [1/year] or "probability in 50 years"; OpenQuake's hazard curves of one measure; return periods of
        Italian practice, "TR [years],ag [g]" with any other columns; or the grid of NTC 2008, one row per grid point
        with "LON", "LAT" and for each return period "T30ag", "T30F0", "T30Tc", or with the periods in a line above.
        If the delimiter is ";" or a tab, a comma is a decimal comma.
    site : (float, float), optional
        Longitude and latitude [degrees], for a file of several points: the nearest point up to 50 km away is used.
    soil_factor : float
        S, ratio of levels at the site surface to levels in the file [-].

    Returns
    -------
    HazardCurve
        The curve in SI units, without points of probability 1 or 0.

    Raises
    ------
    ConfigError
        For a file of another format, a file of several points without `site`, or no point near the site.

    Examples
    --------
    >>> hazard = rp.load_hazard("curve.csv")  # 0.0005 a year at 0.4 g
    >>> round(float(hazard.rate(0.4 * 9.80665)), 6)
    0.0005
    """
    sheet = _read(path)
    row, warnings = sheet.at(site)
    return sheet.curve(row, soil_factor, warnings)


def load_site_hazards(path: str | Path, sites: ArrayLike, soil_factor: ArrayLike = 1.0) -> SiteHazards:
    """Read a hazard for each of many bodies from a CSV file with the curves of many points.

    Parameters
    ----------
    path : str or Path
        OpenQuake's hazard curves of one measure, or the grid of NTC 2008, as for :func:`load_hazard`.
    sites : (m, 2) array_like
        Longitude and latitude of each body [degrees]; the nearest point up to 50 km away is used.
    soil_factor : float or (m,) array_like
        S, as for :func:`load_hazard`.

    Returns
    -------
    SiteHazards
        One curve for each combination of point and soil factor.

    Raises
    ------
    ConfigError
        As :func:`load_hazard`; also for a file without coordinates, or invalid sites or soil factors.

    Examples
    --------
    >>> hazards = rp.load_site_hazards("curves.csv", [(12.0, 42.0), (13.1, 42.0)])
    >>> [one.rates.round(4).tolist() for one in hazards.hazards]
    [[0.0202, 0.001], [0.0305, 0.002]]
    """
    sheet, asked = _read(path), _checked_sites(sites)
    if sheet.places is None:
        raise ConfigError(
            f"{path}: the file has one hazard curve without coordinates, so the sites of the bodies cannot be looked "
            "up in it; give a file of several sites (OpenQuake's hazard curves or the grid of NTC 2008), or remove "
            "longitude and latitude from the table of bodies"
        )
    rows, distance = nearest_places(sheet.path, sheet.places, asked)
    keys = np.stack([rows, of_each(soil_factor, len(asked), "soil factor")], axis=1)
    return SiteHazards.distinct(keys, lambda row, factor: sheet.curve(int(row), factor), distance)


def _checked_sites(sites: ArrayLike) -> np.ndarray:
    expected = "sites: expected a longitude and a latitude [degrees] for each body"
    try:
        found = np.asarray(sites, dtype=float)
    except (TypeError, ValueError):
        raise ConfigError(f"{expected}, got {sites!r:.80}") from None
    if found.ndim != 2 or found.shape[1] != 2 or not found.size:
        raise ConfigError(f"{expected}, got shape {found.shape}")
    wrong = ~np.isfinite(found).all(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ConfigError(f"{expected}, got {found[row].tolist()} for body {row + 1}")
    return found


def hazard_of(settings: HazardSettings, folder: Path = Path()) -> Hazard:
    """Return the hazard described in the section [hazard]; file names are relative to `folder`."""
    return _of_factor(settings, folder)(settings.soil)


def site_hazards_of(
    settings: HazardSettings, sites: np.ndarray | None, soil_factor: np.ndarray | None, count: int, folder: Path
) -> SiteHazards:
    """Return the hazards of `count` bodies; without `sites` or `soil_factor`, the values of [hazard] apply."""
    for key, stated, own in (
        ("longitude, latitude", settings.longitude is not None, sites),
        ("soil_factor", settings.soil != 1.0, soil_factor),
    ):
        if stated and own is not None:
            raise ConfigError(f"[hazard] {key}: also given for each body; remove it here or in the table of bodies")
    factors = of_each(settings.soil if soil_factor is None else soil_factor, count, "soil factor")
    if sites is None:
        return SiteHazards.distinct(factors[:, np.newaxis], _of_factor(settings, folder))
    if settings.file is None:
        raise ConfigError(
            "[hazard] file: each body has its own site; give a file with the hazard curves of several sites, or remove "
            "longitude and latitude from the table of bodies"
        )
    return load_site_hazards(folder / settings.file, sites, factors)


def _of_factor(settings: HazardSettings, folder: Path) -> Callable[[float], Hazard]:
    """Return a function that returns the hazard of section [hazard] for a soil factor."""
    site = None if settings.longitude is None or settings.latitude is None else (settings.longitude, settings.latitude)
    if settings.k0 is not None and settings.k is not None:
        if site is not None:
            raise ConfigError("[hazard] longitude, latitude: a power law has no site; remove them, or give a file")
        law = partial(PowerLawHazard, settings.k0, settings.k, settings.measure, settings.unit or "")
        return lambda factor: law(soil_factor=factor)
    if settings.file is None:
        raise ConfigError(
            "[hazard]: expected a file or the power law k0, k in the configuration, or --hazard, found none of these"
        )
    sheet = _read(folder / settings.file)
    row, warnings = sheet.at(site)
    return lambda factor: sheet.curve(row, factor, warnings)


def _read(path: str | Path) -> _Sheet:
    where, name = Path(path), str(path)
    if not where.exists() or where.is_dir():
        raise ConfigError(f"{path}: no such file; expected a hazard curve")
    lines = read_text(where, what="a hazard curve").splitlines()
    if lines and lines[0].startswith("#") and "investigation_time" in lines[0]:
        return _openquake(name, lines)
    table = table_of(name, _with_one_heading([line for line in lines if line.strip() and not line.startswith("#")]))
    heads = [str(column).strip() for column in table.columns]
    places = place_coordinates(name, table)
    if places is not None:
        return _grid(name, table, heads, places)
    if heads and heads[0].lower().startswith("tr"):
        return _return_periods(name, table, heads)
    return _levels(name, table, heads)


def _measure_of(path: str, text: str) -> str:
    found = re.fullmatch(r"(\w+)\s*\(\s*([0-9.]+)\s*s?\s*\)", text.strip().lower())
    return known_measure(f"{found[1]}_{float(found[2]):g}" if found else text.strip().lower(), path)


def _rates(path: str, probability: np.ndarray, years: float) -> np.ndarray:
    """Convert probabilities in a number of years to annual rates of a Poisson process; probability 1 gives inf."""
    if not years > 0.0 or np.any((probability < 0.0) | (probability > 1.0)):
        raise ConfigError(f"{path}: expected probabilities from 0 to 1 in a positive number of years")
    with np.errstate(divide="ignore"):
        return np.asarray(-np.log1p(-probability) / years)


def _levels(path: str, table: pd.DataFrame, heads: list[str]) -> _Sheet:
    known, second_head = len(heads) == 2, heads[-1].lower() if heads else ""
    first = re.fullmatch(r"(.+?)\s*\[(.+?)\]", heads[0]) if known else None
    years = re.fullmatch(r"probability in ([0-9.]+) years?", second_head)
    if first is None or not (years or re.fullmatch(r"rate(\s*\[1/(a|year|yr)\])?", second_head)):
        raise ConfigError(f"{path}: {EXPECTED}; found the columns {', '.join(heads) or 'none'}")
    second = column_numbers(path, table, heads[1])
    rate = _rates(path, second, float(years[1])) if years else second
    return _Sheet(path, _measure_of(path, first[1]), first[2].strip(), column_numbers(path, table, heads[0]), rate)


def _return_periods(path: str, table: pd.DataFrame, heads: list[str]) -> _Sheet:
    named = {name.lower().partition("[")[0].strip(): place for place, name in enumerate(heads)}
    unit = re.fullmatch(r"ag\s*\[(.+?)\]", heads[named["ag"]].lower()) if "ag" in named else None
    if unit is None:
        raise ConfigError(
            f'{path}: expected the column "ag [g]" in addition to the return periods, found {", ".join(heads)}'
        )
    period, level = column_numbers(path, table, heads[0], above=0.0), column_numbers(path, table, heads[named["ag"]])
    return _Sheet(path, PGA, unit[1].strip(), level, 1.0 / period, rock=True)


def _with_one_heading(lines: list[str]) -> str:
    """Return the lines; return periods in a line above the column names ("TR = 30") are added to these names."""
    above = lines[0] if lines else ""
    if len(lines) < 2 or len(re.findall(r"\bTR\s*=\s*\d+", above, re.IGNORECASE)) < 2:
        return "\n".join(lines)
    between, period, heads = separator(above), "", []
    names = lines[1].split(between)
    for place, name in enumerate(names):
        cells = above.split(between)
        stated = re.search(r"TR\s*=\s*(\d+)", cells[place] if place < len(cells) else "", re.IGNORECASE)
        period = f"T{stated[1]}" if stated else period
        heads.append(name if re.match(r"\s*t\d", name, re.IGNORECASE) else f"{period}{name.strip()}")
    return "\n".join([between.join(heads), *lines[2:]])


def _grid(path: str, table: pd.DataFrame, heads: list[str], places: np.ndarray) -> _Sheet:
    found = [OF_PERIOD.fullmatch(name.lower().replace(" ", "")) for name in heads]
    columns = [(place, stated) for place, stated in enumerate(found) if stated]
    units = {stated[3] or ANNEX for _, stated in columns}
    if len(columns) < 2 or len(units) > 1:
        raise ConfigError(
            f"{path}: expected, in addition to LON and LAT, a_g of several return periods in one unit (T30ag, T50ag, "
            f"...), found {', '.join(heads)}"
        )
    period = np.array([float(stated[1] or stated[2]) for _, stated in columns])
    if np.any(period <= 0.0):
        raise ConfigError(f"{path}: expected positive return periods [years], found {period.min():g}")
    level = np.stack([column_numbers(path, table, heads[place]) for place, _ in columns], axis=1)
    unit = units.pop()
    return _Sheet(path, PGA, unit, level, 1.0 / period, places, (f"a_g read in {unit}",), rock=True)


def _openquake(path: str, lines: list[str]) -> _Sheet:
    # A spreadsheet may add commas to the end of the comment line.
    stated = dict(re.findall(r"(investigation_time|imt)\s*=\s*(\"[^\"]*\"|'[^']*'|[^\s,\"']+)", lines[0]))
    if set(stated) != {"investigation_time", "imt"}:
        raise ConfigError(f"{path}, line 1: expected investigation_time=... and imt=..., found {lines[0]!r:.120}")
    years = float(stated["investigation_time"].strip("'\""))
    measure = _measure_of(path, stated["imt"].strip("'\""))
    unit = MEASURES[measure].openquake
    if not unit:
        known = [name.upper() + "(...)" * bool(row.periods) for name, row in ROWS.items() if row.openquake]
        raise ConfigError(f"{path}, line 1: expected imt among {', '.join(known)}, found {stated['imt']}")
    table = table_of(path, "\n".join(lines[1:]))
    heads = [str(name) for name in table.columns]
    columns = [place for place, name in enumerate(heads) if name.startswith("poe-")]
    places = place_coordinates(path, table)
    if not columns or places is None:
        raise ConfigError(f"{path}, line 2: expected lon, lat and poe-LEVEL columns, found {', '.join(heads)}")
    try:
        level = np.array([float(heads[place].removeprefix("poe-")) for place in columns])
    except ValueError as error:
        raise ConfigError(f"{path}, line 2: expected a number after poe-: {error}") from None
    probability = np.stack([column_numbers(path, table, heads[place]) for place in columns], axis=1)
    return _Sheet(path, measure, unit, level, _rates(path, probability, years), places)


#: Largest distance of a site from the point of its hazard curve [km].
FARTHEST = 50.0


def place_coordinates(path: str, table: pd.DataFrame) -> np.ndarray | None:
    """Return longitude and latitude (n, 2) of the rows [degrees]; None if these columns are missing."""
    columns = {str(name).lower(): str(name) for name in table.columns}
    if not {"lon", "lat"} <= columns.keys():
        return None
    if len(table) == 0:
        raise ConfigError(f"{path}: expected a row for a site, found none")
    return np.stack([column_numbers(path, table, columns[name]) for name in ("lon", "lat")], axis=1)


def nearest_places(path: str, places: np.ndarray, sites: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the index of the point nearest to each site, and its distance [m]; ConfigError if it exceeds 50 km."""
    from obspy.geodetics import degrees2kilometers, locations2degrees
    from scipy.spatial import KDTree

    _, rows = KDTree(_on_sphere(places)).query(_on_sphere(sites))
    near = places[rows]
    distance = degrees2kilometers(locations2degrees(near[:, 1], near[:, 0], sites[:, 1], sites[:, 0]))
    far = int(np.argmax(distance))
    if not distance[far] <= FARTHEST:
        raise ConfigError(
            f"{path}: the place nearest to the site {place_in_words(*sites[far])} is {place_in_words(*near[far])}, "
            f"{distance[far]:,.0f} km away; expected one within {FARTHEST:g} km; longitude comes before latitude"
        )
    return rows, 1e3 * distance


def place_in_words(longitude: float, latitude: float) -> str:
    """Return a longitude and a latitude as text."""
    return f"{longitude:.4g} E {latitude:.4g} N"


def _on_sphere(places: np.ndarray) -> np.ndarray:
    longitude, latitude = np.radians(places).T
    level = np.cos(latitude)
    return np.stack([level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)], axis=1)
