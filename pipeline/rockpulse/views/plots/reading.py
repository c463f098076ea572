"""Open the results of every kind that a picture is drawn from, the accuracy report too."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.storage.accuracy_variables import REPORT
from rockpulse.storage.hdf5.results_file import check_schema, load, opened, readable

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["open_results"]


def open_results(path: str | Path) -> xr.DataTree:
    """Read the file of any verb into memory.

    Parameters
    ----------
    path : str or Path
        Written by rockpulse.

    Returns
    -------
    xarray.DataTree
        As :func:`rockpulse.load` returns it; an accuracy report, which that refuses, as it is stored.

    Raises
    ------
    ResultsError
        For a file that is none of rockpulse's.
    OSError
        Where the file cannot be opened.
    """
    from rockpulse.storage.hdf5.netcdf4 import read_tree

    if check_schema(path, reports=True) != REPORT:
        return load(path)
    with opened(path, reports=True) as (hdf5, _), readable(path):
        return read_tree(hdf5)
