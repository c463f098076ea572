"""Whether a results file is what was written, and its inputs are what was read."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import h5py
import numpy as np

from rockpulse.storage.checksums import (
    CHECKSUM,
    CHECKSUM_OF_ATTRIBUTES,
    VariableChecksum,
    attributes_checksum,
)
from rockpulse.storage.input_files import in_place, input_checksums, input_files, record_folders, stored_checksums
from rockpulse.storage.layout import missing_variables, wrong_variables
from rockpulse.storage.netcdf4 import attributes, groups_of, variables_of
from rockpulse.storage.save_load import check_schema, readable

__all__ = ["Verification", "verify"]

#: Values that are read at once [bytes].
CHUNK = 32 * 1024**2


@dataclass(frozen=True)
class Verification:
    """The outcome of a comparison of a results file and its inputs with their checksums."""

    kind: str  # of results
    schema: str  # version of it
    variables: int  # number of those that were compared
    inputs: int  # number of input files that were found and read
    absent: tuple[str, ...]  # input files that are not where they were
    differences: tuple[str, ...]  # a sentence each; empty where file and inputs are as they were


@dataclass(frozen=True)
class _Listed:
    """The variables of an open file, attributes of groups and variables, and dimensions of variables, by path."""

    variables: dict[str, h5py.Dataset] = field(default_factory=dict)
    attrs: dict[str, dict[str, Any]] = field(default_factory=dict)
    dimensions: dict[str, tuple[str, ...]] = field(default_factory=dict)


def verify(
    path: str | os.PathLike[str], inputs: bool = True, progress: Callable[[list[Any]], Any] = iter
) -> Verification:
    """Compare a results file with its checksums and its schema, and with `inputs` also the files that it was made of.

    `progress` wraps the list of variables, then that of input files, on its way into the loop.

    Raises
    ------
    ResultsError
        For a file that HDF5 cannot open, that is no results file of rockpulse, or of another major schema version.
    OSError
        Where it cannot be opened.
    """
    kind = check_schema(path)
    with readable(path), h5py.File(path, "r") as hdf5:
        file = _listed(hdf5)
        root = file.attrs["/"]
        schema = str(root["schema_version"])
        differences, count = _wrong_checksums(file, progress)
        differences += [*missing_variables(file.variables, kind, schema), *wrong_variables(file.variables, kind)]
        stored = stored_checksums(hdf5) if inputs else []
        folders = record_folders(str(root.get("configuration", "")))
    sources = input_files(stored)
    places = {in_place(name, folders): name for name in sources}
    absent: list[str] = []
    for place, found in input_checksums(progress(sorted(places))):
        name = places[place]
        if found is None:
            absent.append(name)
        elif isinstance(found, Exception):
            differences.append(f"input {name}: it can no longer be read ({found})")
        elif sources[name] != {found}:
            differences.append(f"input {name}: it is not the file that was read (its SHA-256 differs)")
    return Verification(kind, schema, count, len(sources) - len(absent), tuple(absent), tuple(differences))


def _listed(hdf5: h5py.File) -> _Listed:
    """What a file holds; the dimension of a variable that another program has added without any is "?"."""
    file = _Listed()
    for group in groups_of(hdf5):
        file.attrs[group.name] = attributes(group)
        for variable in variables_of(group):
            path = f"{group.name.rstrip('/')}/{variable.name}"
            file.variables[path] = variable.stored
            file.attrs[path] = attributes(variable.stored)
            try:
                file.dimensions[path] = variable.dimensions()
            except ValueError:
                file.dimensions[path] = ("?",)
    return file


def _wrong_checksums(file: _Listed, progress: Callable[[list[Any]], Any]) -> tuple[list[str], int]:
    of_all = file.attrs["/"].get(CHECKSUM_OF_ATTRIBUTES)
    if of_all is None and not any(CHECKSUM in file.attrs[path] for path in file.variables):
        return ["the file has no checksums: it was written by an earlier version, or by another program"], 0
    found = []
    for path in progress(list(file.variables)):
        stored = file.attrs[path].get(CHECKSUM)
        if stored is None:
            found.append(f"variable {path}: it has no checksum; it was not written with the others")
            continue
        try:
            same = _checksum(file.variables[path]) == stored
        except (OSError, RuntimeError, ValueError) as error:
            found.append(f"variable {path}: it cannot be read ({error})")
            continue
        if not same:
            found.append(f"variable {path}: its values are not what was written")
    if attributes_checksum(file.attrs, file.dimensions) != of_all:
        found.append("attributes, or names and dimensions of variables, are not what was written")
    return found, len(file.variables)


def _checksum(variable: h5py.Dataset) -> str:
    """The checksum of the values as they are now, read a piece at a time."""
    dtype = np.dtype(object) if h5py.check_string_dtype(variable.dtype) else np.dtype(variable.dtype)
    shape = variable.shape
    checksum = VariableChecksum(dtype, shape)
    if not shape:
        checksum.add(np.asarray(variable[()], dtype))
    elif 0 not in shape:
        step = max(1, CHUNK // (dtype.itemsize * int(np.prod(shape[1:]))))
        for begin in range(0, shape[0], step):
            checksum.add(np.asarray(variable[begin : begin + step], dtype))
    return checksum.hexdigest()
