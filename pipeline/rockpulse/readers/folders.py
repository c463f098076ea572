"""From paths to records: files, folders, globs and zip archives; a file that fails becomes a row, not a crash."""

import glob
import logging
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import BinaryIO, NamedTuple

from rockpulse.errors import NO_RECORD, ConfigError, Failure, RecordFormatError, RecordRefused, RockpulseError
from rockpulse.files import check_regular
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers import read as read_file
from rockpulse.readers.archive import Archive, is_archive
from rockpulse.readers.format import FileSettings
from rockpulse.readers.no_record import is_quiet
from rockpulse.readers.parts import sample_digest, settled
from rockpulse.readers.source import (
    NoRecord,
    NotAcceleration,
    OtherKind,
    SourceFile,
    Table,
    check_link,
    folder_station_files,
    open_source,
)
from rockpulse.record.record import Record

logger = logging.getLogger("rockpulse")
PathLike = str | os.PathLike[str]


class Found(NamedTuple):
    """A file or a zip archive to read; `named` tells that the user gave its very name."""

    path: Path
    named: bool


class Opened(NamedTuple):
    """A file, or a member of an archive, on its way to the readers."""

    name: str  # as in `Record.source`
    file: SourceFile | RockpulseError | OSError  # the file, or the reason why it cannot be opened
    member: int | None = None  # its place in `Archive.names`; None for a file that is no member of an archive


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
        A file, plain or compressed with gzip, or an open one, read from its position. A folder is read as by
        `rockpulse.read_all`, which also tells the files that gave no record; these are logged as warnings here.
    units : str, optional
        Unit of the accelerations, a key of `UNITS`, for files that do not state one (columns, SAC).
    dt : float, optional
        Sampling interval [s] for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts with a StationXML become m/s2; see `ReadOptions`.
    stationxml : str, path or binary file, optional
        Station metadata of miniSEED. Without it the StationXML files beside a file with a name are searched.

    Returns
    -------
    list of Record
        In m/s2, in the order of the file; of a folder sorted by path and channel.

    Raises
    ------
    RecordFormatError
        No reader recognises the file, or it breaks the rules of its format.
    RecordRefused
        A sound file without usable acceleration: velocity, spectra, counts without a gain, gaps; a folder without a
        record.
    UnitError
        The unit is missing or unknown.
    ConfigError
        `dt` or `response` is none that can be, or a `stationxml` is given for a folder.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> [record.component for record in rp.read("data/samples/records/CICLC.v1")]
    ['90 Deg', '360 Deg', 'Up']
    >>> len(rp.read("data/samples/records"))
    10
    """
    if not isinstance(path, str | os.PathLike) or not Path(path).is_dir():
        return read_file(path, units, dt, response, stationxml)
    if stationxml is not None:
        raise ConfigError(f"{path}: stationxml is of one file; put it into the folder, beside its records")
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
) -> tuple[list[Record], list[Failure]]:
    """Read every record under some paths.

    Parameters
    ----------
    paths : path or iterable of paths
        Files, folders (searched to any depth; links to folders are not followed), globs (``**`` for any depth) and zip
        archives. A path that exists is never taken as a glob.
    units : str, optional
        Unit of the accelerations for files that do not state one; see `rockpulse.read`.
    on_file : callable, optional
        Called with the path of each file after it was read.
    dt : float, optional
        Sampling interval [s] for columns without a time column.
    response : {"sensitivity", "remove"}
        How counts with a StationXML become m/s2; see `rockpulse.readers.ReadOptions`.
    files : sequence of FileSettings, optional
        Unit and interval of some of the files, in place of `units` and `dt`; where several choose a file the last one
        that gives a property decides it. A file that states something else is refused.

    Returns
    -------
    records : list of Record
        Sorted by path and channel, with distinct ids (``~2`` appended to the second of two). A record that its agency
        cut into files is one.
    failures : list of Failure
        Sorted by file. A file that may be a record and cannot be read "failed"; so did velocities, displacements,
        spectra and other files if named, which are "skipped" otherwise. A record whose samples and interval another
        file has is a "duplicate", unless the two face different directions.

    Raises
    ------
    UnitError
        If `units` is none of the accepted ones. No file raises anything.
    ConfigError
        If `response` is, or a pattern of `files` chooses no file.

    Examples
    --------
    >>> records, failures = rp.read_all(["records", "velocity.csv"])
    >>> len(records), [one.kind for one in failures]
    (5, ['failed'])
    """
    options = ReadOptions(units, dt, response, tuple(files))
    found, failures = find_files(paths)
    check_patterns(found, options.files)
    # One look at a folder's station metadata serves all its records.
    station_files = lru_cache(maxsize=16)(folder_station_files)
    records: list[Record] = []
    for item in found:
        for opened in open_files(item, station_files):
            try:
                records += read_opened(opened, options)
            except (RockpulseError, OSError) as fault:
                failures.append(read_failure(item, opened.name, fault))
        if on_file is not None:
            on_file(str(item.path))
    whole, duplicates = settled(records, sample_digest)
    return [record for record, _ in whole], sorted(failures + duplicates, key=in_order)


def in_order(row: Failure) -> tuple[str, str]:
    """Key that sorts the rows of files that gave no record: by file and reason."""
    return row.file, row.reason


def find_files(
    paths: PathLike | Iterable[PathLike], passed_over: Iterable[PathLike] = ()
) -> tuple[list[Found], list[Failure]]:
    """Files behind the paths of `read_all`, each once, sorted, but `passed_over`, and rows for paths without one."""
    # The run writes the files that are passed over: to open and close one that this process has locked would give up
    # the lock. Only XML is opened, to pass over metadata of stations and earthquakes.
    found: dict[str, Found] = {}
    failures: list[Failure] = []
    for given in [paths] if isinstance(paths, str | os.PathLike) else paths:
        items, faults = _behind(os.fspath(given))
        failures += faults
        for item in items:
            key = os.path.abspath(item.path)  # noqa: PTH100 - links stay what they are
            if key not in found or item.named:
                found[key] = item
    own = {identity for path in passed_over if (identity := _identity(path)) is not None}
    kept = [item for item in found.values() if not own or _identity(item.path) not in own]
    return sorted(kept, key=lambda item: str(item.path)), failures


def _behind(text: str) -> tuple[list[Found], list[Failure]]:
    """The files behind one path, and a row where there is none."""
    path, lacking = Path(text), ""
    items: list[Found] = []
    faults: list[Failure] = []
    if not text:
        return [], [Failure(text, "find", "an empty path was given; is a variable of the shell unset?", "failed")]
    if path.is_dir():
        items, faults = _walk(path)
        lacking = "no file to read in the folder; check it" if not faults else ""
    elif os.path.lexists(path):
        items = [Found(path, True)]
    elif glob.has_magic(text):
        for hit in map(Path, glob.glob(text, recursive=True)):  # noqa: PTH207 - takes absolute patterns
            inside, missed = _walk(hit) if hit.is_dir() else ([] if _quiet_file(hit) else [Found(hit, False)], [])
            items += inside
            faults += missed
        lacking = "the pattern matches no file; check it"
    else:
        lacking = "no such file or folder; check the path"
    if lacking and not items:
        faults.append(Failure(text, "find", f"{text}: {lacking}", "failed"))
    return items, faults


def check_patterns(found: Sequence[Found], files: Sequence[FileSettings]) -> None:
    """Raise ConfigError for a pattern that chooses none of the files, nor a member of an archive among them."""
    names = [str(item.path) for item in found]
    missed = [row for row in files if not any(map(row.chooses, names))]
    if missed:
        names += [name for item in found for name in _member_names(item.path)]
        missed = [row for row in missed if not any(map(row.chooses, names))]
    if missed and names:
        raise ConfigError(
            f"{missed[0].where}: expected the end of the path of a file to read, found none among {len(names)} files, "
            f"such as {names[-1]}; correct the pattern, or take the entry out"
        )


def _member_names(path: Path) -> list[str]:
    """The members of an archive; none of another file, or of one that cannot be opened: its reading says why."""
    try:
        if not path.is_file() or not is_archive(path):
            return []
        with Archive(path) as archive:
            return list(archive.names)
    except (RockpulseError, OSError):
        return []


def _identity(path: PathLike) -> tuple[int, int] | None:
    """Device and inode, equal for all names and links of a file; None where there is no file."""
    try:
        state = os.stat(path)  # noqa: PTH116 - takes any path
    except (OSError, ValueError):  # whoever opens it says why
        return None
    return state.st_dev, state.st_ino


def _walk(folder: Path) -> tuple[list[Found], list[Failure]]:
    """Files below a folder, and a row for each folder that cannot be listed."""
    faults: list[OSError] = []
    items = []
    for parent, folders, files in os.walk(folder, onerror=faults.append):
        folders[:] = [name for name in folders if not name.startswith(".")]
        paths = [Path(parent, name) for name in files if not name.startswith(".")]
        items += [Found(path, False) for path in paths if not _quiet_file(path)]
    return items, [Failure(str(fault.filename), "find", str(fault), "failed") for fault in faults]


def _quiet_file(path: Path) -> bool:
    return is_quiet(str(path), partial(open_source, path))


def open_files(found: Found, station_files: Callable[[Path], list[tuple[str, bytes]]]) -> Iterator[Opened]:
    """Open a file, or each member of an archive, or give the error; `station_files` gives those of a folder."""
    path = found.path
    try:
        check_link(path)
        check_regular(path, RecordRefused)
        if not is_archive(path):
            yield Opened(str(path), open_source(path, partial(station_files, path.parent)))
            return
        empty = True
        with Archive(path) as archive:
            for number, name in enumerate(archive.names):
                if is_quiet(name, partial(archive.member, number)):
                    continue
                empty = False
                try:
                    member: SourceFile | RockpulseError = archive.member(number)
                except RockpulseError as fault:
                    member = fault
                yield Opened(name, member, number)
        if empty:
            raise RecordFormatError(f"{path}: no file to read in the archive; check it")
    except (RockpulseError, OSError) as fault:
        yield Opened(str(path), fault)


def read_opened(opened: Opened, options: ReadOptions) -> list[Record]:
    """Every channel of a file that was opened; raises the error that kept it from being opened or read."""
    if isinstance(opened.file, Exception):
        raise opened.file
    return read_source(opened.file, options)


def read_failure(found: Found, name: str, fault: Exception) -> Failure:
    """The row for a file, or a member of an archive, called `name`, that gave no record because of `fault`."""
    named = found.named and name == str(found.path)
    if isinstance(fault, NoRecord) and not named:
        return Failure(name, "read", f"{name}: {NO_RECORD}", "skipped")
    reason = str(fault) if name in str(fault) else f"{name}: {fault}"
    skipped = isinstance(fault, OtherKind | Table) or (isinstance(fault, NotAcceleration) and not named)
    return Failure(name, "read", reason, "skipped" if skipped else "failed")
