"""A group of a netCDF-4 file as an xarray.Dataset whose numbers are read when they are asked for, by h5py alone.

xarray's own way through h5netcdf looks every object up anew at every property, which takes several times as long for a
hundred variables (docs/decisions/005). Nothing is decoded: texts are texts, NaN is NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from rockpulse.storage.netcdf4 import attributes, groups_of, variables_of

if TYPE_CHECKING:
    from collections.abc import Hashable

__all__ = ["dataset_of", "read_tree"]


class _Stored(BackendArray):
    """The numbers of a variable, read from the open file piece by piece."""

    def __init__(self, stored: h5py.Dataset) -> None:
        self.stored, self.shape, self.dtype = stored, stored.shape, stored.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self._read)

    def _read(self, key: tuple[Any, ...]) -> np.ndarray:
        return np.asarray(self.stored[key])


def dataset_of(group: h5py.Group) -> xr.Dataset:
    """A group of an open file, its texts read and its numbers not; it is of no use once the file is closed.

    Raises
    ------
    ValueError
        For a variable whose dimensions the file does not name.
    """
    variables: dict[Hashable, xr.Variable] = {
        one.name: xr.Variable(one.dimensions(), _values(one.stored), attributes(one.stored))
        for one in variables_of(group)
    }
    coordinates = [name for name, variable in variables.items() if variable.dims == (name,)]
    return xr.Dataset(variables, attrs=attributes(group)).set_coords(coordinates)


def read_tree(hdf5: h5py.File) -> xr.DataTree:
    """All groups of an open file, read into memory. What h5py and :func:`dataset_of` raise passes."""
    # Times are plain seconds and stay so, whatever units xarray may take for time deltas.
    return xr.DataTree.from_dict(
        {
            group.name: xr.decode_cf(dataset_of(group).load(), decode_times=False, decode_timedelta=False)
            for group in groups_of(hdf5)
        }
    )


def _values(stored: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(stored.dtype):
        return np.asarray(stored.asstr()[()]).astype(str)
    return indexing.LazilyIndexedArray(_Stored(stored))
