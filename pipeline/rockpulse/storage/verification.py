"""Whether a results file is what was written, and its inputs are what was read."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import h5netcdf
import h5py
import numpy as np

from rockpulse.errors import ResultsError, RockpulseError
from rockpulse.storage.assessment_variables import always_stored
from rockpulse.storage.checksums import (
    CHECKSUM,
    CHECKSUM_OF_ATTRIBUTES,
    VariableChecksum,
    attributes_checksum,
    attributes_of,
    variables_of,
)
from rockpulse.storage.input_files import in_place, input_checksums, input_files, record_folders, stored_checksums
from rockpulse.storage.save_load import ASSESSMENT, check_schema

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
    kind = check_schema(path, reports=True)
    with _readable(path), h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
        schema = str(file.attrs["schema_version"])
        differences, count = _wrong_checksums(file, progress)
        if kind == ASSESSMENT:
            differences += _wrong_variables(file, schema)
        stored = stored_checksums(file) if inputs else []
        folders = record_folders(str(file.attrs.get("configuration", "")))
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


@contextmanager
def _readable(path: str | os.PathLike[str]) -> Iterator[None]:
    try:
        yield
    except RockpulseError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError) as error:
        raise ResultsError(f"{path}: the results file is damaged ({error}); run the assessment again") from error


def _wrong_checksums(file: h5netcdf.File, progress: Callable[[list[Any]], Any]) -> tuple[list[str], int]:
    variables = list(variables_of(file))
    if CHECKSUM_OF_ATTRIBUTES not in file.attrs and not any(CHECKSUM in one.attrs for _, one in variables):
        return ["the file has no checksums: it was written by an earlier version, or by another program"], 0
    found = []
    for path, variable in progress(variables):
        stored = variable.attrs.get(CHECKSUM)
        if stored is None:
            found.append(f"variable {path}: it has no checksum; it was not written with the others")
            continue
        try:
            same = _checksum(variable) == stored
        except (OSError, RuntimeError, ValueError) as error:
            found.append(f"variable {path}: it cannot be read ({error})")
            continue
        if not same:
            found.append(f"variable {path}: its values are not what was written")
    if attributes_checksum(*attributes_of(file)) != file.attrs.get(CHECKSUM_OF_ATTRIBUTES):
        found.append("attributes, or names and dimensions of variables, are not what was written")
    return found, len(variables)


def _checksum(variable: h5netcdf.Variable) -> str:
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


def _wrong_variables(file: h5netcdf.File, schema: str) -> list[str]:
    """Variables that an assessment lacks, or holds in another type or unit than docs/schema.md says."""
    found = []
    there = dict(variables_of(file))
    for group, declared in always_stored(schema).items():
        for name, expected in declared.items():
            kind, units = expected.kind, expected.units
            path = f"{group}/{name}"
            if path not in there:
                found.append(f"variable {path}: it is missing")
                continue
            variable = there[path]
            text = h5py.check_string_dtype(variable.dtype) is not None
            if text != (kind is str) or (not text and variable.dtype.kind != np.dtype(kind).kind):
                found.append(f"variable {path}: expected values of type {np.dtype(kind).name}, found {variable.dtype}")
            if variable.attrs.get("units") != units:
                found.append(f"variable {path}: expected the unit {units!r}, found {variable.attrs.get('units')!r}")
    return found
