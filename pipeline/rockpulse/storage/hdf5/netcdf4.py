"""Reads netCDF-4 variables, dimensions and attributes from HDF5 with h5py only.

A dimension is stored as an HDF5 dimension scale: the variable of the same name, or a dataset without values. xarray
with h5netcdf takes several times as long for a hundred variables (docs/decisions/005).
"""

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing


class _Stored(BackendArray):
    """The values of a variable in an open file; only the requested values are read."""

    def __init__(self, stored: h5py.Dataset) -> None:
        self.stored, self.shape, self.dtype = stored, stored.shape, stored.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self._read)

    def _read(self, key: tuple[Any, ...]) -> np.ndarray:
        return np.asarray(self.stored[key])


def dataset_of(group: h5py.Group) -> xr.Dataset:
    """Return a group as a dataset whose numbers are read on demand; raise ValueError if a dimension has no name."""
    variables: dict[Hashable, xr.Variable] = {
        one.name: xr.Variable(one.dimensions(), _values(one.stored), attributes(one.stored))
        for one in variables_of(group)
    }
    coordinates = [name for name, variable in variables.items() if variable.dims == (name,)]
    return xr.Dataset(variables, attrs=attributes(group)).set_coords(coordinates)


def read_tree(hdf5: h5py.File) -> xr.DataTree:
    """Read all groups of an open file into memory; raise the errors of h5py and :func:`dataset_of`."""
    # Times stay plain seconds; xarray must not turn them into time deltas.
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


#: Attributes that HDF5 and netCDF use internally.
HIDDEN = {"CLASS", "DIMENSION_LIST", "NAME", "REFERENCE_LIST"}
HIDDEN |= {"_NCProperties", "_Netcdf4Coordinates", "_Netcdf4Dimid", "_nc3_strict"}

#: Beginning of the attribute NAME of a dimension without a variable; the size of the dimension follows in ten columns.
NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
#: Prefix of the name of a variable that has the name of a dimension without being its coordinate.
NOT_A_COORDINATE = "_nc4_non_coord_"


@dataclass(frozen=True, eq=False)
class Variable:
    """A variable of an open file, with the dimension names of its group."""

    name: str
    stored: h5py.Dataset
    scales: Mapping[h5py.Dataset, str]  # names of the dimension scales of the group, which HDF5 is slow to find

    def dimensions(self) -> tuple[str, ...]:
        """Return the names of the dimensions of the variable; raise ValueError if a dimension has no name."""
        stored = self.stored
        if not stored.shape:
            return ()
        if stored.ndim == 1 and stored in self.scales:
            return (self.name,)
        scales = [stored.file[one[0]] for one in stored.attrs.get("DIMENSION_LIST", ()) if len(one)]
        names = [self.scales.get(scale) or scale.name for scale in scales]
        if len(names) != stored.ndim or None in names:
            raise ValueError(f"variable {self.name!r} has {stored.ndim} dimensions, of which {len(names)} have a name")
        return tuple(str(name).rpartition("/")[2] for name in names)


def groups_of(group: h5py.Group) -> Iterator[h5py.Group]:
    """Yield a group and all its subgroups, in the order in which they were written."""
    yield group
    for item in group.values():
        if isinstance(item, h5py.Group):
            yield from groups_of(item)


def variables_of(group: h5py.Group) -> list[Variable]:
    """Return the variables of a group, in the order in which they were written."""
    datasets = {name: item for name, item in group.items() if isinstance(item, h5py.Dataset)}
    scales = {item: name for name, item in datasets.items() if h5py.h5ds.is_scale(item.id)}
    return [
        Variable(name.removeprefix(NOT_A_COORDINATE), item, scales)
        for name, item in datasets.items()
        if not (item in scales and is_bare_dimension(item.attrs.get("NAME")))
    ]


def attributes(item: h5py.Group | h5py.Dataset) -> dict[str, Any]:
    """Return the attributes of a group or variable, without internal ones; an array of one value becomes a scalar."""
    held = item.attrs
    return {name: _plain(held[name]) for name in held if name not in HIDDEN}


def is_bare_dimension(name: Any) -> bool:
    """Return whether the attribute NAME of a dataset marks it as a dimension without a variable."""
    return isinstance(name, bytes) and name.startswith(NO_VARIABLE.encode())


def _plain(value: Any) -> Any:
    if isinstance(value, h5py.Empty):
        return np.array([], value.dtype)
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.ravel()[0]
    return value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value


def slab(variable: xr.Variable, positions: Mapping[Any, Any]) -> np.ndarray:
    """Read the values at given indices or slices; `positions` may contain dimensions that the variable lacks."""
    box, inside = _box(variable, positions)
    return np.asarray(box.isel(inside).values)


def pointwise(variable: xr.Variable, places: Mapping[str, np.ndarray]) -> np.ndarray:
    """Read one value at each of several points, which are given by their indices along each dimension."""
    box, inside = _box(variable, places)
    return np.asarray(box.values[tuple(inside[dim] for dim in box.dims)])


def _box(variable: xr.Variable, positions: Mapping[Any, Any]) -> tuple[xr.Variable, dict[Any, Any]]:
    """Read the smallest block of values that contains all indices; return the block, and the indices within it."""
    box: dict[Any, slice] = {}
    inside = {}
    for dim in variable.dims:
        wanted = positions.get(dim, slice(None))
        if isinstance(wanted, slice):
            box[dim] = wanted
        else:
            start, stop = (int(wanted.min()), int(wanted.max()) + 1) if wanted.size else (0, 0)
            box[dim], inside[dim] = slice(start, stop), wanted - start
    return variable.isel(box).load(), inside


def flag_words(variable: xr.Variable | xr.DataArray) -> dict[int, str]:
    """Return the word for each value of a flag variable; empty if the variable is not a flag."""
    if "flag_meanings" not in variable.attrs:
        return {}
    values = np.atleast_1d(variable.attrs["flag_values"]).tolist()
    return dict(zip(values, str(variable.attrs["flag_meanings"]).split(), strict=True))


def flags_as_words(values: np.ndarray, words: dict[int, str]) -> np.ndarray:
    """Return the word for each flag value; a value without a word becomes its digits."""
    codes, inverse = np.unique(values, return_inverse=True)
    names = np.array([words.get(code, str(code)) for code in codes.tolist()], dtype=object)
    return names[inverse].reshape(values.shape) if codes.size else values.astype(object)
