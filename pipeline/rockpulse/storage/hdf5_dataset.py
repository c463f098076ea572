"""A group of a netCDF-4 file as an xarray.Dataset whose numbers are read when they are asked for, by h5py alone.

xarray's own way through h5netcdf looks every object up anew at every property, which takes several times as long for a
hundred variables (docs/decisions/005). Nothing is decoded: texts are texts, NaN is NaN.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

__all__ = ["dataset_of", "read_tree"]

#: Attributes of HDF5 and netCDF-4 that say how objects belong together, and nothing of the values.
HIDDEN = {
    "CLASS",
    "DIMENSION_LIST",
    "NAME",
    "REFERENCE_LIST",
    "_NCProperties",
    "_Netcdf4Coordinates",
    "_Netcdf4Dimid",
    "_nc3_strict",
}

#: Beginning of the name of a scale that is a dimension and no variable.
NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable."


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
    stored = {name: item for name, item in group.items() if isinstance(item, h5py.Dataset)}
    variables: dict[Hashable, xr.Variable] = {}
    for name, item in stored.items():
        attrs = dict(item.attrs)
        if not bytes(attrs.get("NAME", b"")).startswith(NO_VARIABLE):
            variables[name] = xr.Variable(_dimensions(name, item, attrs), _values(item), attributes(attrs))
    coordinates = [name for name, variable in variables.items() if variable.dims == (name,)]
    return xr.Dataset(variables, attrs=attributes(dict(group.attrs))).set_coords(coordinates)


def read_tree(path: str | os.PathLike[str]) -> xr.DataTree:
    """All groups of a file, read into memory. What h5py and :func:`dataset_of` raise passes."""
    with h5py.File(path, "r") as hdf5:
        # Times are plain seconds and stay so, whatever units xarray may take for time deltas.
        return xr.DataTree.from_dict(
            {
                group.name: xr.decode_cf(dataset_of(group).load(), decode_times=False, decode_timedelta=False)
                for group in _groups(hdf5)
            }
        )


def _groups(group: h5py.Group) -> Iterator[h5py.Group]:
    """A group and all within it, in the order in which they were written."""
    yield group
    for item in group.values():
        if isinstance(item, h5py.Group):
            yield from _groups(item)


def _values(stored: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(stored.dtype):
        return np.asarray(stored.asstr()[()]).astype(str)
    return indexing.LazilyIndexedArray(_Stored(stored))


def attributes(attrs: dict[str, Any]) -> dict[str, Any]:
    """Attributes as h5py reads them, less those that are not about the values; an array of one value is that value."""
    return {name: _plain(value) for name, value in attrs.items() if name not in HIDDEN}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.ravel()[0]
    return value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value


def _dimensions(name: str, stored: h5py.Dataset, attrs: dict[str, Any]) -> tuple[str, ...]:
    """Names of the dimensions of a variable: those of the scales that it is attached to."""
    if not stored.shape:
        return ()
    if attrs.get("CLASS") == b"DIMENSION_SCALE" and stored.ndim == 1:
        return (name,)
    scales = [stored.file[one[0]].name for one in attrs.get("DIMENSION_LIST", ()) if len(one)]
    if len(scales) != stored.ndim or None in scales:
        raise ValueError(f"variable {name!r} has {stored.ndim} dimensions, of which {len(scales)} have a name")
    return tuple(str(scale).rpartition("/")[2] for scale in scales)
