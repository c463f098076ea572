"""Reads records from files, folders, globs and zip archives; every file that fails is listed as a failure."""

import glob
import logging
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import BinaryIO, NamedTuple

from rockpulse.errors import (
    NO_RECORD,
    ConfigError,
    Failure,
    RecordFormatError,
    RecordRefused,
    RockpulseError,
    stored_remedies,
)
from rockpulse.files import check_regular
from rockpulse.readers import ReadOptions, read_source, source
from rockpulse.readers import read as read_file
from rockpulse.readers.file_pairs import PairSettings, check_pairs
from rockpulse.readers.format import FileSettings
from rockpulse.readers.no_record import is_quiet
from rockpulse.readers.parts import sample_digest, settled
from rockpulse.record.record import Record

logger = logging.getLogger("rockpulse")
PathLike = str | os.PathLike[str]


class Found(NamedTuple):
    """A file or a zip archive to read; `named` is true if the user named the file itself."""

    path: str
    named: bool


class Opened(NamedTuple):
    """A file or a member of an archive that was opened, or the error if it could not be opened."""

    name: str  # as in `Record.source`
    file: source.SourceFile | RockpulseError | OSError  # the file, or the error that prevented its opening
    member: int | None = None  # index in `Archive.names`; None for a file outside an archive


def read(
    path: PathLike | BinaryIO,
    units: str | None = None,
    dt: float | None = None,
    response: str = "sensitivity",
    stationxml: PathLike | BinaryIO | None = None,
) -> list[Record]:
    """Read every channel of a strong-motion file, or of all files of a folder.

    Parameters
    ----------
    path : str, path or binary file
        A file, plain or compressed with gzip, or an open file, which is read from its current position. A folder is
        read as by `rockpulse.read_all`; the failures that it returns, except skipped files, are logged as warnings.
    units : str, optional
        Unit of the accelerations, a key of `UNITS`, for files that do not state one (columns, SAC).
    dt : float, optional
        Sampling interval [s] for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts are converted to m/s2 with a StationXML; see `ReadOptions`.
    stationxml : str, path or binary file, optional
        Station metadata of miniSEED; by default the StationXML files in the folder of the file are used.

    Returns
    -------
    list of Record
        Records in m/s2, in the order of the file or, for a folder, sorted by path and channel.

    Raises
    ------
    RecordFormatError
        If no reader recognises the file, or it violates the rules of its format.
    RecordRefused
        For a valid file without usable acceleration (velocity, spectra, counts without a gain, gaps), or a folder
        without a record.
    UnitError
        If the unit is missing or unknown.
    ConfigError
        If `dt` or `response` is not allowed, or a `stationxml` is given for a folder.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> [record.component for record in rp.read("data/samples/records/CICLC.v1")]
    ['90 Deg', '360 Deg', 'Up']
    >>> len(rp.read("data/samples/records"))
    14
    """
    if not isinstance(path, str | os.PathLike) or not Path(path).is_dir():
        return read_file(path, units, dt, response, stationxml)
    if stationxml is not None:
        raise ConfigError(
            f"{path}: the option stationxml applies to a single file; put the StationXML into the folder of its records"
        )
    records, failures = read_all(path, units, None, dt, response)
    reasons = [row.reason for row in failures if row.kind != "skipped"]
    if not records:
        raise RecordRefused(f"{path}: no record in the folder{': ' * bool(reasons)}{'; '.join(reasons[:3])}")
    for reason in reasons:
        logger.warning("%s", reason)
    return records


def read_all(
    paths: PathLike | Iterable[PathLike],
    units: str | None = None,
    on_file: Callable[[str], None] | None = None,
    dt: float | None = None,
    response: str = "sensitivity",
    files: Sequence[FileSettings] = (),
    pairs: Sequence[PairSettings] = (),
) -> tuple[list[Record], list[Failure]]:
    """Read every record in files, folders, globs and zip archives.

    Parameters
    ----------
    paths : path or iterable of paths
        Files, folders (searched to any depth; links to folders are not followed), globs (``**`` for any depth) and zip
        archives. An existing path is never used as a glob.
    units : str, optional
        Unit of the accelerations for files that state no unit; see `rockpulse.read`.
    on_file : callable, optional
        Function that is called with the path of each file after it was read.
    dt : float, optional
        Sampling interval [s] for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts are converted to m/s2 with a StationXML; see `rockpulse.readers.ReadOptions`.
    files : sequence of FileSettings, optional
        Unit and interval of some of the files, instead of `units` and `dt`; if several match a file, the last one that
        gives a property is used. A file that states something else is rejected.
    pairs : sequence of PairSettings, optional
        Files that are the two components of a recording.

    Returns
    -------
    records : list of Record
        Sorted by path and channel, with distinct ids (``~2`` is appended to the second of two equal ids). A record that
        its agency split into several files is joined.
    failures : list of Failure
        Sorted by file. A file that may be a record but cannot be read is "failed". Velocities, displacements, spectra
        and other files are "failed" if the user named them and "skipped" otherwise. A record with the samples and the
        interval of another file is a "duplicate", unless the directions of the two differ. The settings with which a
        file could be read are in `Failure.remedies`.

    Raises
    ------
    UnitError
        If `units` is not an accepted unit. Faulty files raise no error.
    ConfigError
        If `response` is not an accepted value, a pattern of `files` matches no file, or a file of `pairs` is missing.

    Examples
    --------
    >>> records, failures = rp.read_all(["records", "velocity.csv"])
    >>> len(records), [one.kind for one in failures]
    (5, ['failed'])
    """
    options = ReadOptions(units, dt, response, tuple(files), tuple(pairs))
    found, failures = find_files(paths)
    check_patterns(found, options)
    # The station metadata of a folder are read once for all its records.
    station_files = lru_cache(maxsize=16)(source.folder_station_files)
    records: list[Record] = []
    for item in found:
        for opened in open_files(item, station_files):
            try:
                records += read_opened(opened, options)
            except (RockpulseError, OSError) as fault:
                failures.append(read_failure(item, opened.name, fault))
        if on_file is not None:
            on_file(item.path)
    whole, duplicates = settled(records, sample_digest)
    return [record for record, _ in whole], sorted(failures + duplicates, key=in_order)


def in_order(row: Failure) -> tuple[str, str]:
    """Return the key by which failures are sorted: file, then reason."""
    return row.file, row.reason


def find_files(
    paths: PathLike | Iterable[PathLike], passed_over: Iterable[PathLike] = ()
) -> tuple[list[Found], list[Failure]]:
    """Return the sorted, distinct files under `paths`, except `passed_over`, and failures for paths without files."""
    # The files in `passed_over` are written by the run. They are not opened, as closing a file that this process has
    # locked would release the lock. Only XML files are opened, to skip metadata of stations and earthquakes.
    found: dict[str, Found] = {}
    failures: list[Failure] = []
    for given in [paths] if isinstance(paths, str | os.PathLike) else paths:
        items, faults = _files_of_path(os.fspath(given))
        failures += faults
        for item in items:
            key = os.path.abspath(item.path)  # noqa: PTH100 - links stay what they are
            if key not in found or item.named:
                found[key] = item
    own = {identity for path in passed_over if (identity := _identity(path)) is not None}
    kept = [item for item in found.values() if not own or _identity(item.path) not in own]
    return sorted(kept), failures


def _files_of_path(text: str) -> tuple[list[Found], list[Failure]]:
    """Return the files that match a path or pattern given by the user, and failures if there are none."""
    path, lacking = Path(text), ""
    items: list[Found] = []
    faults: list[Failure] = []
    if not text:
        return [], [Failure(text, "find", "an empty path was given; is a shell variable unset?", "failed")]
    if path.is_dir():
        items, faults = _walk(path)
        lacking = "no file to read in the folder; check it" if not faults else ""
    elif os.path.lexists(path):
        items = [Found(str(path), True)]
    elif glob.has_magic(text):
        for hit in map(Path, glob.glob(text, recursive=True)):  # noqa: PTH207 - takes absolute patterns
            inside, missed = _walk(hit) if hit.is_dir() else ([] if _quiet_file(hit) else [Found(str(hit), False)], [])
            items += inside
            faults += missed
        lacking = "the pattern matches no file; check it"
    else:
        lacking = "no such file or folder; check the path"
    if lacking and not items:
        faults.append(Failure(text, "find", f"{text}: {lacking}", "failed"))
    return items, faults


def check_patterns(found: Sequence[Found], options: ReadOptions) -> None:
    """Raise ConfigError if a pattern of `files` matches no file, or a name in `pairs` does not match exactly one."""
    names = [item.path for item in found]
    missed = [row for row in options.files if not any(map(row.chooses, names))]
    if missed or options.pairs:
        names += [name for item in found for name in _member_names(Path(item.path))]
        check_pairs(names, options.pairs)
        missed = [row for row in missed if not any(map(row.chooses, names))]
    if missed and names:
        raise ConfigError(
            f"{missed[0].where}: the pattern matches none of the files to read ({len(names)} in all, such as "
            f"{names[-1]}); correct the pattern, or remove the entry"
        )


def _member_names(path: Path) -> list[str]:
    """Return the names of the members of an archive; empty for other files and unreadable archives."""
    try:
        if not path.is_file() or not source.is_archive(path):
            return []
        with source.Archive(path) as archive:
            return list(archive.names)
    except (RockpulseError, OSError):
        return []


def _identity(path: PathLike) -> tuple[int, int] | None:
    """Return the numbers of device and inode, which are the same for all links to a file; None if there is no file."""
    try:
        state = os.stat(path)  # noqa: PTH116 - takes any path
    except (OSError, ValueError):  # the error is reported when the file is opened
        return None
    return state.st_dev, state.st_ino


def _walk(folder: Path) -> tuple[list[Found], list[Failure]]:
    """Return the files in a folder and its subfolders, and a failure for each folder that cannot be listed."""
    faults: list[OSError] = []
    items = []
    for parent, folders, files in os.walk(folder, onerror=faults.append):
        folders[:] = [name for name in folders if not name.startswith(".")]
        paths = [Path(parent, name) for name in files if not name.startswith(".")]
        items += [Found(str(path), False) for path in paths if not _quiet_file(path)]
    return items, [Failure(str(fault.filename), "find", str(fault), "failed") for fault in faults]


def _quiet_file(path: Path) -> bool:
    return is_quiet(str(path), partial(source.open_source, path))


def open_files(found: Found, station_files: Callable[[Path], list[tuple[str, bytes]]]) -> Iterator[Opened]:
    """Yield the opened file, or each opened member of an archive; an error is yielded instead of being raised."""
    path = Path(found.path)
    try:
        source.check_link(path)
        check_regular(path, RecordRefused)
        if not source.is_archive(path):
            yield Opened(str(path), source.open_source(path, partial(station_files, path.parent)))
            return
        empty = True
        with source.Archive(path) as archive:
            for number, name in enumerate(archive.names):
                if is_quiet(name, partial(archive.member, number)):
                    continue
                empty = False
                try:
                    member: source.SourceFile | RockpulseError = archive.member(number)
                except RockpulseError as fault:
                    member = fault
                yield Opened(name, member, number)
        if empty:
            raise RecordFormatError(f"{path}: no file to read in the archive; check it")
    except (RockpulseError, OSError) as fault:
        yield Opened(str(path), fault)


def read_opened(opened: Opened, options: ReadOptions) -> list[Record]:
    """Return the records of an opened file; raise the error that prevented opening or reading it."""
    if isinstance(opened.file, Exception):
        raise opened.file
    return read_source(opened.file, options)


def read_failure(found: Found, name: str, fault: Exception) -> Failure:
    """Return the failure for a file or a member of an archive that has no record because of `fault`."""
    named = found.named and name == found.path
    if isinstance(fault, source.NoRecord) and not named:
        return Failure(name, "read", f"{name}: {NO_RECORD}", "skipped")
    reason = str(fault) if name in str(fault) else f"{name}: {fault}"
    skipped = isinstance(fault, source.OtherKind | source.TableOfResults) or (
        isinstance(fault, source.NotAcceleration) and not named
    )
    remedy = stored_remedies(fault.remedies) if isinstance(fault, RockpulseError) else ""
    return Failure(name, "read", reason, "skipped" if skipped else "failed", remedy)
