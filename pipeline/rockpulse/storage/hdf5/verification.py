"""Verifies that a results file and, on request, its input files have not changed."""

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from rockpulse.config.configuration import stored_sections
from rockpulse.errors import RecordRefused, ResultsError, RockpulseError
from rockpulse.files import check_regular
from rockpulse.readers.source import Archive, is_archive, open_source
from rockpulse.record.record import BETWEEN
from rockpulse.storage.hdf5.layout import missing_variables, wrong_variables
from rockpulse.storage.hdf5.netcdf4 import attributes, groups_of, variables_of
from rockpulse.storage.hdf5.results_file import checked, damage_reported
from rockpulse.storage.hdf5.writer import CHECKSUM, CHECKSUM_OF_ATTRIBUTES, VariableChecksum, attributes_checksum

#: Amount of data that is read at once [bytes].
CHUNK = 32 * 1024**2
NO_CHECKSUMS = "the file has no checksums: it was written by another program"


@dataclass(frozen=True)
class Verification:
    """The result of comparing a results file and its input files with their stored checksums."""

    kind: str  # kind of results
    schema: str  # schema version
    variables: int  # number of checksums that were compared
    inputs: int  # number of input files that were found and read
    absent: tuple[str, ...]  # input files that are missing
    differences: tuple[str, ...]  # one sentence for each change; empty without changes


def verify(
    path: str | os.PathLike[str], inputs: bool = True, progress: Callable[[list[Any]], Any] = iter
) -> Verification:
    """Compare a results file with its stored checksums and its schema, and (with `inputs`) its input files as well.

    `progress` is called with each list that is processed, and returns an iterable of its items.
    """
    with checked(path) as (hdf5, kind, _), damage_reported(path):
        variables, differences = _wrong_checksums(hdf5, progress)
        count = 0 if differences == [NO_CHECKSUMS] else len(variables)
        differences += [*missing_variables(variables, kind), *wrong_variables(variables, kind)]
        stored = stored_checksums(hdf5) if inputs else []
        schema, folders = str(hdf5.attrs["schema_version"]), record_folders(str(hdf5.attrs.get("configuration", "")))
    sources = input_files(stored)
    places = {existing_path(name, folders): name for name in sources}
    absent: list[str] = []
    open_archive = lru_cache(maxsize=1)(Archive)  # the members of an archive follow one another
    for place in progress(sorted(places)):
        name = places[place]
        if not _there(_location(place)[0]):
            absent.append(name)
            continue
        try:
            if sources[name] != {_input_checksum(place, open_archive)}:
                differences.append(f"input {name}: it is not the file that was read (its SHA-256 differs)")
        except (RockpulseError, OSError) as error:
            differences.append(f"input {name}: it can no longer be read ({error})")
    return Verification(kind, schema, count, len(sources) - len(absent), tuple(absent), tuple(differences))


def _wrong_checksums(
    hdf5: h5py.File, progress: Callable[[list[Any]], Any]
) -> tuple[dict[str, h5py.Dataset], list[str]]:
    """Return the variables of a file by path, and a sentence for each that differs from its checksum."""
    attrs = {group.name: attributes(group) for group in groups_of(hdf5)}
    variables: dict[str, h5py.Dataset] = {}
    dimensions: dict[str, tuple[str, ...]] = {}
    for group in groups_of(hdf5):
        for variable in variables_of(group):
            path = f"{group.name.rstrip('/')}/{variable.name}"
            variables[path], attrs[path] = variable.stored, attributes(variable.stored)
            try:
                dimensions[path] = variable.dimensions()
            except ValueError:  # a dimension without a name, in files of other programs
                dimensions[path] = ("?",)
    of_all = attrs["/"].get(CHECKSUM_OF_ATTRIBUTES)
    if of_all is None and not any(CHECKSUM in attrs[path] for path in variables):
        return variables, [NO_CHECKSUMS]
    found = []
    for path in progress(list(variables)):
        stored = attrs[path].get(CHECKSUM)
        if stored is None:
            found.append(f"variable {path}: it has no checksum; it was added later")
            continue
        try:
            if _checksum(variables[path]) != stored:
                found.append(f"variable {path}: its values were changed")
        except (OSError, RuntimeError, ValueError) as error:
            found.append(f"variable {path}: it cannot be read ({error})")
    if attributes_checksum(attrs, dimensions) != of_all:
        found.append("attributes, or the names or dimensions of variables, were changed")
    return variables, found


def _checksum(variable: h5py.Dataset) -> str:
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


def stored_checksums(hdf5: h5py.File) -> list[tuple[str, str]]:
    """Return two strings for every record of a results file: names of its input files, and their SHA-256."""
    return [
        pair
        for group in hdf5.values()
        if isinstance(group, h5py.Group) and {"source", "source_sha256"} <= set(group)
        for pair in zip(group["source"].asstr()[:], group["source_sha256"].asstr()[:], strict=True)
        if pair[1]
    ]


def input_files(stored: Iterable[tuple[str, str]]) -> dict[str, set[str]]:
    """Return the stored SHA-256 of each input file; there are several if the file changed during the run."""
    found: dict[str, set[str]] = {}
    for source, checksum in stored:
        for name, one in _apart(source, checksum):
            found.setdefault(name, set()).add(one)
    return found


def record_folders(configuration: str) -> list[Path]:
    """Return the folders of a stored configuration to which the stored file names may be relative."""
    try:
        named = stored_sections(configuration).get("records", {}).get("paths", ())
    except ResultsError:
        return []
    paths = [Path(path) for path in named if isinstance(path, str)] if isinstance(named, list | tuple) else []
    return list(dict.fromkeys(folder for path in paths for folder in (path, *path.parents)))


def existing_path(source: str, folders: Iterable[Path]) -> str:
    """Return the stored path of a file or, if it does not exist, the path of the file in one of the folders."""
    named = (source, *(str(folder / source) for folder in folders))
    return next((name for name in named if _there(_location(name)[0])), source)


def _apart(source: str, checksum: str) -> list[tuple[str, str]]:
    """Split the stored file names of a record; return each name with its checksum."""
    checksums = checksum.split(BETWEEN)
    names = [source] if len(checksums) == 1 and _there(_location(source)[0]) else source.split(BETWEEN)
    if len(checksums) == 1:
        checksums *= len(names)
    if len(names) != len(checksums):
        raise ResultsError(f"the record of {source}: expected a SHA-256 for each of its files, found {checksum!r}")
    return list(zip(names, checksums, strict=True))


def _there(path: str | Path) -> bool:
    """Return whether a file exists; False also if its name is too long or its folder cannot be read."""
    return os.path.exists(path)  # noqa: PTH110 - Path.exists raises for these


def _location(source: str) -> tuple[Path, str | None]:
    """Return the path of a stored file name and, for ``archive.zip!member``, the name of the archive member."""
    if "!" in source and not _there(source):
        archive, _, member = source.partition("!")
        while not _there(archive) and "!" in member:
            further, _, member = member.partition("!")
            archive = f"{archive}!{further}"
        return Path(archive), member
    return Path(source), None


def _input_checksum(source: str, open_archive: Callable[[Path], Archive]) -> str:
    """Return the SHA-256 of a file or archive member; RockpulseError or OSError if it cannot be read."""
    place, _ = _location(source)
    check_regular(place, ResultsError)
    if not is_archive(place):
        return open_source(place).sha256
    archive = open_archive(place)
    if source not in archive.names:
        raise RecordRefused("the archive no longer has this member")
    return archive.member(archive.names.index(source)).sha256
