"""A hazard file as a table of texts, and the numbers, rates and sites that its rows hold."""

from __future__ import annotations

import io

import numpy as np
import pandas as pd

from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line

__all__ = ["EXPECTED", "coordinates", "named", "nearest_places", "numbers", "rates", "separator", "table_of"]

EXPECTED = (
    'expected columns "pga [g],rate" (or pgv, si, sa(1.0), and "probability in 50 years"), OpenQuake\'s hazard curves '
    '("# ... investigation_time=..., imt=...", lon,lat,depth,poe-0.005,...), return periods ("TR [years],ag [g]"), or '
    "the grid of NTC 2008 (ID;LON;LAT;T30ag;T30F0;T30Tc;...)"
)

#: Distance of a site beyond which its hazard stands for no other [km].
FARTHEST = 50.0


def separator(text: str) -> str:
    """What stands between the cells of the first line of a table."""
    head = text.lstrip("\n").partition("\n")[0]
    return next((mark for mark in (";", "\t") if mark in head), ",")


def table_of(path: str, text: str) -> pd.DataFrame:
    """The cells of a table as texts; with semicolons or tabs between them commas are decimal ones."""
    between = separator(text)
    try:
        table = pd.read_csv(io.StringIO(text), sep=between, skipinitialspace=True, dtype=str)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, ValueError) as error:
        raise ConfigError(f"{path}: {EXPECTED}; {first_line(error)}") from None
    return (
        table if between == "," else table.map(lambda cell: cell.replace(",", ".") if isinstance(cell, str) else cell)
    )


def numbers(path: str, table: pd.DataFrame, column: int) -> np.ndarray:
    """A column (n,) of numbers; ConfigError where a cell is none."""
    found = pd.to_numeric(table.iloc[:, column], errors="coerce").to_numpy(dtype=float)
    if np.any(np.isnan(found)):
        row = int(np.argmax(np.isnan(found)))
        raise ConfigError(
            f"{path}: row {row + 1} of column {table.columns[column]!r}: expected a number, found "
            f"{table.iloc[row, column]!r}"
        )
    return found


def rates(path: str, probability: np.ndarray, years: float) -> np.ndarray:
    """Annual rates from probabilities in so many years, H = -ln(1 - probability)/years (Poisson); inf for 1."""
    if not years > 0.0 or np.any((probability < 0.0) | (probability > 1.0)):
        raise ConfigError(f"{path}: expected probabilities from 0 to 1 in a positive number of years")
    with np.errstate(divide="ignore"):
        return np.asarray(-np.log1p(-probability) / years)


def coordinates(path: str, table: pd.DataFrame) -> np.ndarray | None:
    """Longitude and latitude (n, 2) of each row [degrees]; None without these columns, ConfigError without a row."""
    columns = {str(name).strip().lower(): place for place, name in enumerate(table.columns)}
    if not {"lon", "lat"} <= columns.keys():
        return None
    if len(table) == 0:
        raise ConfigError(f"{path}: expected a row for a site, found none")
    return np.stack([numbers(path, table, columns[name]) for name in ("lon", "lat")], axis=1)


def nearest_places(path: str, places: np.ndarray, sites: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The row (m,) of the place nearest to each of some sites, and how far away it is [m].

    `places` (n, 2) and `sites` (m, 2) are longitudes and latitudes [degrees]. Raises ConfigError for a site whose
    nearest place is more than 50 km away.
    """
    from obspy.geodetics import degrees2kilometers, locations2degrees
    from scipy.spatial import KDTree

    _, rows = KDTree(_on_sphere(places)).query(_on_sphere(sites))
    near = places[rows]
    distance = degrees2kilometers(locations2degrees(near[:, 1], near[:, 0], sites[:, 1], sites[:, 0]))
    far = int(np.argmax(distance))
    if not distance[far] <= FARTHEST:
        raise ConfigError(
            f"{path}: the place nearest to the site {named(*sites[far])} is {named(*near[far])}, {distance[far]:,.0f} "
            f"km away; expected one within {FARTHEST:g} km; longitude stands before latitude"
        )
    return rows, 1e3 * distance


def named(longitude: float, latitude: float) -> str:
    """A place in words."""
    return f"{longitude:.4g} E {latitude:.4g} N"


def _on_sphere(places: np.ndarray) -> np.ndarray:
    """Places (n, 2) as points (n, 3) of a sphere of radius 1, where what is near is near, across any meridian."""
    longitude, latitude = np.radians(places).T
    level = np.cos(latitude)
    return np.stack([level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)], axis=1)
