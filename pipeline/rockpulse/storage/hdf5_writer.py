"""Writing the HDF5 file of a tree, variable by variable or piece by piece, with the checksum of each."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import h5netcdf
import h5py
import numpy as np

from rockpulse.storage.checksums import CHECKSUM, CHECKSUM_OF_ATTRIBUTES, VariableChecksum, attributes_checksum

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["TreeWriter", "in_utf8", "write_tree"]


class TreeWriter:
    """A results file that is being written; to be used in a ``with`` block, at the end of which it is complete.

    All sizes are known beforehand, so that every variable lies in the file in one piece: who reads one variable of many
    records reads nothing else. An OSError wherever the file cannot be written, whatever HDF5 calls it.
    """

    def __init__(self, path: Path, attrs: Mapping[str, Any]) -> None:
        self._path = path
        self._hdf5 = h5py.File(path, "w", track_order=True)  # as netCDF has it
        self._file = h5netcdf.File(self._hdf5, "w", decode_vlen_strings=True)
        self._sizes: dict[str, dict[str, int]] = {}
        self._variables: dict[str, h5netcdf.Variable] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}
        self._written: dict[str, int] = {}
        self._checksums: dict[str, VariableChecksum] = {}
        _set(self._file, attrs)

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
        """Add a group, as "/summary" ("/" is there already), with the size of each of its dimensions."""
        group = self._file if path == "/" else self._file.create_group(path)
        self._sizes[path] = dict(sizes)
        for name, size in sizes.items():
            group.dimensions[name] = size
        _set(group, attrs)

    def add_variable(self, path: str, dims: tuple[str, ...], dtype: np.dtype[Any], attrs: Mapping[str, Any]) -> None:
        """Add a variable, as "/summary/pga", without its values; texts where `dtype` is a type of texts."""
        group, _, name = path.rpartition("/")
        stored = h5py.string_dtype() if dtype.kind in "UO" else dtype
        # Every value is written: what is absent is a NaN of its own, and HDF5 need not write fill values first.
        absent = {"fillvalue": np.array(np.nan, dtype)} if dtype.kind == "f" else {}
        variable = self._file[group or "/"].create_variable(name, dims, stored, **absent)
        _set(variable, attrs)
        shape = tuple(self._sizes[group or "/"][dim] for dim in dims)
        self._variables[path] = variable
        self._shapes[path] = shape
        self._written[path] = 0
        self._checksums[path] = VariableChecksum(dtype, shape)

    def append(self, path: str, values: np.ndarray) -> None:
        """Write the next values of a variable along its first dimension; all of a variable without dimensions.

        A ValueError for values that do not fit into the variable.
        """
        values = np.asarray(values)
        shape, begin = self._shapes[path], self._written[path]
        if values.shape[1:] != shape[1:] or (shape and begin + len(values) > shape[0]):
            raise ValueError(f"{path}: expected values for {shape} from {begin} on, was given {values.shape}")
        if values.dtype.kind in "UO":
            values = np.array([in_utf8(str(text)) for text in values.ravel().tolist()], object).reshape(values.shape)
        self._checksums[path].add(values)
        if not shape:
            self._variables[path][...] = values[()]
            return
        self._written[path] = begin + len(values)
        if values.size:
            self._variables[path][begin : begin + len(values)] = values

    def read(self, path: str, begin: int, end: int) -> np.ndarray:
        """Values that were written, along the first dimension from `begin` to before `end`; texts as numpy strings."""
        values = np.asarray(self._variables[path][begin:end])
        return values.astype(str) if values.dtype == object else values

    def _complete(self) -> None:
        """Set the checksums."""
        for path, checksum in self._checksums.items():
            shape = self._shapes[path]
            if shape and self._written[path] != shape[0]:
                raise ValueError(f"{path}: expected {shape[0]} values, was given {self._written[path]}")
            self._variables[path].attrs[CHECKSUM] = checksum.hexdigest()
        self._file.attrs[CHECKSUM_OF_ATTRIBUTES] = attributes_checksum(self._file)

    def _close(self, error: BaseException | None) -> None:
        """Close the file, of which nothing is left where there is an error."""
        try:
            if error is None:
                self._hdf5.flush()
        except (OSError, RuntimeError) as fault:  # how h5py reports a full disk
            error = fault
            raise OSError(str(fault)) from fault
        finally:
            if error is not None:
                # Room for what HDF5 still holds: on a full disk, a file that it cannot close crashes Python at exit.
                os.truncate(self._path, 0)
            self._file.close()
            self._hdf5.close()


def write_tree(tree: xr.DataTree, path: Path, attrs: Mapping[str, Any]) -> None:
    """Write a whole tree of numbers, texts and flags, whose attributes are numbers, texts or lists of numbers.

    `attrs` takes the place of the attributes of its root. An OSError where the file cannot be written.
    """
    with TreeWriter(path, attrs) as writer:
        for node in tree.subtree:
            dataset = node.to_dataset(inherit=False)
            add_dataset(writer, node.path, dataset, {} if node.path == "/" else dataset.attrs)
            for name, variable in dataset.variables.items():
                writer.append(_joined(node.path, name), variable.values)


def add_dataset(
    writer: TreeWriter,
    path: str,
    dataset: xr.Dataset,
    attrs: Mapping[str, Any],
    sizes: Mapping[str, int] | None = None,
) -> None:
    """Add a group with the variables of a dataset, without their values.

    `sizes` are of dimensions whose size is not that in the dataset.
    """
    writer.add_group(path, {**{str(dim): size for dim, size in dataset.sizes.items()}, **(sizes or {})}, attrs)
    # CF: what is a coordinate without being a dimension is named by the variables that it belongs to.
    further = {name: set(dataset[name].dims) for name in dataset.coords if name not in dataset.dims}
    for name, variable in dataset.variables.items():
        beside = [
            str(one) for one, dims in further.items() if name not in dataset.coords and dims <= set(variable.dims)
        ]
        extra = {"coordinates": " ".join(beside)} if beside else {}
        writer.add_variable(
            _joined(path, name), tuple(map(str, variable.dims)), variable.dtype, {**variable.attrs, **extra}
        )


def in_utf8(text: str) -> str:
    """The text as HDF5 takes it: bytes outside UTF-8, as file names may hold, become the replacement character."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace").replace("\0", "\ufffd")


def _set(item: Any, attrs: Mapping[str, Any]) -> None:
    held = item.attrs  # which h5netcdf looks up anew each time
    for name, value in attrs.items():
        held[str(name)] = in_utf8(value) if isinstance(value, str) else value


def _joined(path: str, name: Any) -> str:
    return f"{path.rstrip('/')}/{name}"
