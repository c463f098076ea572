"""Writer of netCDF-4 files with h5py only (docs/decisions/005), with a checksum of each variable.

The checksum of a variable is the SHA-256 of its type and shape in one line (``float64 3x2``; ``text 3``), a line feed,
and its values in C order: numbers little-endian, each text in UTF-8 with a zero byte after it. The checksum of the
attributes covers sorted lines, ``PATH`` for each group, ``PATH DIMENSION...`` for each variable and ``PATH@ATTRIBUTE
CHECKSUM``.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import h5py
import numpy as np

from rockpulse.foreign_text import in_utf8
from rockpulse.storage.hdf5.netcdf4 import HIDDEN, NO_VARIABLE, NOT_A_COORDINATE, attributes, groups_of
from rockpulse.version import __version__

if TYPE_CHECKING:
    import xarray as xr


class TreeWriter:
    """A results file that is being written; it is complete at the end of the ``with`` block."""

    def __init__(self, path: Path, attrs: Mapping[str, Any]) -> None:
        self._path = path
        self._hdf5 = h5py.File(path, "w", track_order=True)  # as in netCDF
        self._sizes: dict[str, dict[str, int]] = {}
        self._dims: dict[str, tuple[str, ...]] = {}
        self._scales: dict[tuple[str, str], h5py.Dataset] = {}  # scales of dimensions, by group and name
        self._numbers: dict[tuple[str, str], int] = {}  # numbers of dimensions, by group and name
        self._variables: dict[str, h5py.Dataset] = {}
        self._written: dict[str, int] = {}  # number of values along the first dimension
        self._checksums: dict[str, VariableChecksum] = {}
        self._set(self._hdf5, attrs)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        try:
            if error is None:
                self._complete()
        finally:
            self._close(error)

    def add_group(self, path: str, sizes: Mapping[str, int], attrs: Mapping[str, Any]) -> None:
        """Add a group, such as "/summary" ("/" always exists), with the size of each of its dimensions."""
        group = self._hdf5 if path == "/" else self._hdf5.create_group(path, track_order=True)
        self._sizes[path] = dict(sizes)
        for name, size in sizes.items():
            self._numbers[path, name] = len(self._numbers)
            self._make_scale(path, name, self._create(_joined(path, name), (size,), ">f4"), f"{NO_VARIABLE}{size:10}")
        self._set(group, attrs)

    def add_variable(self, path: str, dims: tuple[str, ...], dtype: np.dtype[Any], attrs: Mapping[str, Any]) -> None:
        """Add a variable, such as "/summary/pga"; its values are written later. `dtype` may be a string type."""
        group, name = _apart(path)
        if dtype.kind == "b":
            raise TypeError(f"{path}: expected numbers or strings, found True or False, which netCDF cannot store")
        stored = h5py.string_dtype() if dtype.kind in "UO" else dtype
        # All values are written later (missing ones as NaN), so that HDF5 need not write fill values first.
        fill = np.array([np.nan], dtype.newbyteorder("=")) if dtype.kind == "f" else None
        shape = tuple(self._sizes[group][dim] for dim in dims)
        if dims == (name,):
            variable = self._take_place(group, name, stored, fill)
        else:
            place = _joined(group, NOT_A_COORDINATE + name) if name in self._sizes[group] else path
            variable = self._create(place, shape, stored, fill)
            for axis, dim in enumerate(dims):
                h5py.h5ds.attach_scale(variable.id, self._scales[group, dim].id, axis)
        if dims:
            numbers = np.array([self._numbers[group, dim] for dim in dims], np.int32)
            variable.attrs["_Netcdf4Coordinates"] = numbers
            if shape[0] and dims != (name,):
                variable.attrs["_Netcdf4Dimid"] = numbers[0]
        self._variables[path], self._dims[path], self._written[path] = variable, dims, 0
        self._checksums[path] = VariableChecksum(dtype, shape)
        self._set(variable, {**({} if fill is None else {"_FillValue": fill}), **attrs})

    def append(self, path: str, values: np.ndarray) -> None:
        """Write the next values of a variable along its first dimension, or the value of a scalar variable."""
        values = np.asarray(values)
        variable, begin = self._variables[path], self._written[path]
        shape = variable.shape
        if values.shape[1:] != shape[1:] or (shape and begin + len(values) > shape[0]):
            raise ValueError(
                f"{path}: expected values that fit {shape} from index {begin} on, found the shape {values.shape}"
            )
        if values.dtype.kind in "UO":
            values = np.array([in_utf8(str(text)) for text in values.ravel().tolist()], object).reshape(values.shape)
        self._checksums[path].add(values)
        if not shape:
            variable[...] = values[()]
            return
        self._written[path] = begin + len(values)
        if values.size:
            variable[begin : begin + len(values)] = values

    def read(self, path: str, begin: int, end: int) -> np.ndarray:
        """Read the values already written at the indices `begin` to `end` - 1 of the first dimension of a variable."""
        variable = self._variables[path]
        if h5py.check_string_dtype(variable.dtype):
            return np.asarray(variable.asstr()[begin:end]).astype(str)
        return np.asarray(variable[begin:end])

    def _complete(self) -> None:
        """Write the checksums and the name of this program to the file."""
        for path, checksum in self._checksums.items():
            variable = self._variables[path]
            if variable.shape and self._written[path] != len(variable):
                raise ValueError(f"{path}: expected {len(variable)} values, found {self._written[path]}")
            variable.attrs[CHECKSUM] = checksum.hexdigest()
        attrs = {group.name: attributes(group) for group in groups_of(self._hdf5)}
        attrs |= {path: attributes(variable) for path, variable in self._variables.items()}
        self._hdf5.attrs[CHECKSUM_OF_ATTRIBUTES] = attributes_checksum(attrs, self._dims)
        versions = f"version=2,rockpulse={__version__},hdf5={h5py.version.hdf5_version},h5py={h5py.__version__}"
        self._hdf5.attrs["_NCProperties"] = np.bytes_(versions)

    def _create(self, path: str, shape: tuple[int, ...], dtype: Any, fill: np.ndarray | None = None) -> h5py.Dataset:
        """Create an HDF5 dataset; a dimension with size zero becomes unlimited."""
        most = {"maxshape": tuple(size or None for size in shape)} if 0 in shape else {}
        value = None if fill is None else fill[0]
        return self._hdf5.create_dataset(path, shape, dtype, fillvalue=value, track_order=True, **most)

    def _make_scale(self, group: str, dim: str, scale: h5py.Dataset, name: str) -> None:
        scale.attrs["_Netcdf4Dimid"] = np.int32(self._numbers[group, dim])
        scale.make_scale(name)
        self._scales[group, dim] = scale

    def _take_place(self, group: str, dim: str, dtype: Any, fill: np.ndarray | None) -> h5py.Dataset:
        """Replace the placeholder of a dimension by the variable of the same name, also in all references to it."""
        before = self._scales[group, dim]
        attached = [
            (self._variables[path].id, dims.index(dim))
            for path, dims in self._dims.items()
            if dim in dims and _apart(path)[0] == group
        ]
        for variable, axis in attached:
            h5py.h5ds.detach_scale(variable, before.id, axis)
        path, shape = _joined(group, dim), before.shape
        del self._hdf5[path]
        scale = self._create(path, shape, dtype, fill)
        self._make_scale(group, dim, scale, dim)
        for variable, axis in attached:
            h5py.h5ds.attach_scale(variable, scale.id, axis)
        return scale

    def _set(self, item: h5py.Group | h5py.Dataset, attrs: Mapping[str, Any]) -> None:
        """Write attributes of a group or variable; a number becomes an array of one element, as netCDF requires."""
        for key, value in attrs.items():
            name = str(key)
            if name in HIDDEN:
                raise ValueError(f"{item.name}: an attribute cannot have the name {name!r}, which netCDF reserves")
            if np.asarray(value).dtype.kind == "b":
                raise TypeError(f"{item.name}: attribute {name!r}: expected numbers or strings, found True or False")
            if isinstance(value, str):
                value = in_utf8(value)
            elif np.isscalar(value) and not isinstance(value, bytes):
                value = np.array([value])
            item.attrs[name] = value

    def _close(self, error: BaseException | None) -> None:
        """Close the file; after an error, first cut it to zero bytes. Raise OSError if it could not be written."""
        faults: list[Exception] = []
        if error is None:
            try:
                self._hdf5.flush()
            except (OSError, RuntimeError) as fault:  # raised by h5py for a full disk
                faults.append(fault)
        if error is not None or faults:
            # Truncate to free space: on a full disk HDF5 cannot close the file and would crash Python at exit.
            os.truncate(self._path, 0)
        try:
            self._hdf5.close()
        except (OSError, RuntimeError) as fault:
            faults.append(fault)
        if error is None and faults:
            raise OSError(str(faults[0])) from faults[0]


def write_tree(tree: xr.DataTree, path: Path, attrs: Mapping[str, Any]) -> None:
    """Write a whole tree to a file; `attrs` replaces the attributes of its root."""
    with TreeWriter(path, attrs) as writer:
        for node in tree.subtree:
            dataset = node.to_dataset(inherit=False)
            add_dataset(writer, node.path, dataset, {} if node.path == "/" else dataset.attrs)
            for name, variable in dataset.variables.items():
                writer.append(_joined(node.path, name), variable.values)


def add_dataset(
    writer: TreeWriter, path: str, dataset: xr.Dataset, attrs: Mapping[str, Any], sizes: Mapping[str, int] | None = None
) -> None:
    """Add a group with the variables of a dataset, but without values; `sizes` replaces sizes of dimensions."""
    writer.add_group(path, {**{str(dim): size for dim, size in dataset.sizes.items()}, **(sizes or {})}, attrs)
    # CF: variables name their coordinates that are not dimensions.
    further = {name: set(dataset[name].dims) for name in dataset.coords if name not in dataset.dims}
    for name, variable in dataset.variables.items():
        beside = [
            str(one) for one, dims in further.items() if name not in dataset.coords and dims <= set(variable.dims)
        ]
        extra = {"coordinates": " ".join(beside)} if beside else {}
        writer.add_variable(
            _joined(path, name), tuple(map(str, variable.dims)), variable.dtype, {**variable.attrs, **extra}
        )


def _joined(path: str, name: Any) -> str:
    return f"{path.rstrip('/')}/{name}"


def _apart(path: str) -> tuple[str, str]:
    group, _, name = path.rpartition("/")
    return group or "/", name


#: Name of the attribute of a variable that contains its checksum.
CHECKSUM = "sha256"
#: Name of the root attribute that contains the checksum of all attributes.
CHECKSUM_OF_ATTRIBUTES = "attributes_sha256"


class VariableChecksum:
    """Computes the checksum of one variable, whose values are added in pieces."""

    def __init__(self, dtype: np.dtype[Any], shape: tuple[int, ...]) -> None:
        self._text = dtype.kind in "UO"
        kind = "text" if self._text else dtype.name
        self._hash = hashlib.sha256(f"{kind} {'x'.join(map(str, shape))}\n".encode())

    def add(self, values: np.ndarray) -> None:
        """Add the next values to the checksum."""
        if self._text:
            texts = (text.encode() if isinstance(text, str) else text for text in values.ravel().tolist())
            self._hash.update(b"".join(text + b"\0" for text in texts))
        else:
            self._hash.update(np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).data)

    def hexdigest(self) -> str:
        """Return the checksum of all added values."""
        return self._hash.hexdigest()


def attributes_checksum(attrs: Mapping[str, Mapping[str, Any]], dimensions: Mapping[str, Sequence[str]]) -> str:
    """Return the checksum of all attributes and dimension names of a file."""
    lines = [f"{path} {' '.join(dimensions[path])}" if path in dimensions else path for path in attrs]
    for path, own in attrs.items():
        for name, value in own.items():
            if (path, name) != ("/", CHECKSUM_OF_ATTRIBUTES):
                lines.append(f"{path}@{name} {_of_value(value)}")
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()


def _of_value(value: Any) -> str:
    values = np.atleast_1d(np.asarray(value))
    if values.dtype.kind == "S":  # byte strings are texts, too
        values = values.astype(object)
    checksum = VariableChecksum(values.dtype, values.shape)
    checksum.add(values)
    return checksum.hexdigest()
