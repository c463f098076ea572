"""The places that a file has hazard curves of, and which of them is nearest to a site."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockpulse.errors import ConfigError
from rockpulse.input_table import numbers

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["coordinates", "named", "nearest_places"]

#: Distance of a site beyond which its hazard stands for no other [km].
FARTHEST = 50.0


def coordinates(path: str, table: pd.DataFrame) -> np.ndarray | None:
    """Longitude and latitude (n, 2) of each row [degrees]; None without these columns, ConfigError without a row."""
    columns = {str(name).lower(): str(name) for name in table.columns}
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
