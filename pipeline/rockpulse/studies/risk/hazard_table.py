"""A hazard file as a table of texts, and the numbers, rates and sites that its rows hold."""

from __future__ import annotations

import io

import numpy as np
import pandas as pd

from rockpulse.errors import ConfigError
from rockpulse.foreign_text import first_line

__all__ = ["EXPECTED", "coordinates", "numbers", "rates", "row_of_site", "separator", "table_of"]

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


def coordinates(table: pd.DataFrame) -> tuple[int, int] | None:
    """Places of the columns of longitude and latitude; None without them."""
    named = {str(name).strip().lower(): place for place, name in enumerate(table.columns)}
    return (named["lon"], named["lat"]) if {"lon", "lat"} <= named.keys() else None


def row_of_site(
    path: str, table: pd.DataFrame, places: tuple[int, int], site: tuple[float, float] | None
) -> tuple[int, str]:
    """The row of the place nearest to a site (longitude and latitude), and in words which one that is.

    Without a site, the only row. Raises ConfigError for no row, several without a site, and a nearest one that is more
    than 50 km away.
    """
    from obspy.geodetics import degrees2kilometers, locations2degrees

    longitude, latitude = (numbers(path, table, place) for place in places)
    if len(table) == 0:
        raise ConfigError(f"{path}: expected a row for a site, found none")
    if site is None:
        if len(table) > 1:
            raise ConfigError(
                f"{path}: curves of {len(table)} sites; name one by its longitude and latitude ([hazard] longitude, "
                "latitude, or --site)"
            )
        return 0, f"the only place of the file, {_named(longitude[0], latitude[0])}"
    distance = degrees2kilometers(locations2degrees(latitude, longitude, site[1], site[0]))
    row = int(np.argmin(distance))
    named = _named(longitude[row], latitude[row])
    if not distance[row] <= FARTHEST:
        raise ConfigError(
            f"{path}: the place nearest to the site {_named(*site)} is {named}, {distance[row]:,.0f} km away; expected "
            f"one within {FARTHEST:g} km; longitude stands before latitude"
        )
    return row, f"place {named}, {distance[row]:.1f} km from the site"


def _named(longitude: float, latitude: float) -> str:
    return f"{longitude:.4g} E {latitude:.4g} N"
