"""From paths to records: files, folders, globs and zip archives; a file that fails becomes a row, not a crash.

Left out without a row, in folders and archives: hidden files and folders, and files that cannot be records by their
name (notes, configurations, results), and StationXML and QuakeML. Other texts, tables and pictures are "skipped", and
so are velocities, displacements and spectra; a file that may be a record and that no reader takes "failed".
"""

from __future__ import annotations

import glob
import hashlib
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rockpulse.errors import NO_RECORD, ConfigError, Failure, RecordFormatError, RecordRefused, RockpulseError
from rockpulse.files import check_regular
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers.archive import Archive, is_archive
from rockpulse.readers.format import FileSettings
from rockpulse.readers.formats.renadic import whole_records
from rockpulse.readers.no_record import is_quiet
from rockpulse.readers.source import (
    NoRecord,
    NotAcceleration,
    SourceFile,
    check_link,
    folder_station_files,
    open_source,
)
from rockpulse.record.record import Record, distinct_ids
from rockpulse.remark import find

__all__ = [
    "Found",
    "Opened",
    "check_patterns",
    "find_files",
    "in_order",
    "open_files",
    "read_all",
    "read_failure",
    "read_opened",
    "sample_digest",
    "settled",
]

PathLike = str | os.PathLike[str]


@dataclass(frozen=True)
class Found:
    """A file or a zip archive to read; `named` tells that the user gave its very name."""

    path: Path
    named: bool


class Opened(NamedTuple):
    """A file, or a member of an archive, on its way to the readers."""

    name: str  # as in `Record.source`
    file: SourceFile | RockpulseError | OSError  # the file, or the reason why it cannot be opened
    member: int | None = None  # its place in `Archive.names`; None for a file that is no member of an archive


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
        Files, folders (searched to any depth; links to folders are not followed), globs (``**`` for any depth; a
        folder that matches is searched) and zip archives. A path that exists is never taken as a glob.
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
        Sorted by path and channel, with distinct ids: the second of two records with one id and different content
        has ``~2`` appended. A record that its agency cut into files is one; see
        `rockpulse.readers.formats.renadic.whole_records`.
    failures : list of Failure
        Sorted by file. A file that is a record, or may be one, and cannot be read "failed", and so did an empty one. A
        velocity, a displacement, a spectrum, and a text, table or picture that shows no sign of a record, "failed" if
        it was named and is "skipped" if it was met in a folder, a glob or an archive. A record whose samples and
        interval another file has is a "duplicate", unless the two say that they face different directions; the one
        stays that knows most of direction, time and event.

    Raises
    ------
    UnitError
        If `units` is none of the accepted ones. No file raises anything.
    ConfigError
        If `response` is, or a pattern of `files` chooses no file.
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


def settled(
    records: Sequence[Record], digest: Callable[[Record], str]
) -> tuple[list[tuple[Record, tuple[Record, ...]]], list[Failure]]:
    """The records of all files: each content once, cut records joined, sorted by path and channel, ids distinct.

    `digest` gives equal texts for records of equal samples: :func:`sample_digest` where the samples are at hand; only
    the number of samples is used here. Returned are each record with the given records that it is made of (several
    where parts were joined), and a row for each record whose content another one has.
    """
    kept, duplicates = _without_duplicates(sorted(records, key=_place), digest)
    whole = sorted(whole_records(kept), key=lambda item: _place(item[0]))
    named = distinct_ids([record for record, _ in whole])
    return [(record, pieces) for record, (_, pieces) in zip(named, whole, strict=True)], duplicates


def sample_digest(record: Record) -> str:
    """SHA-256 of the samples and the interval of a record as read."""
    digest = hashlib.sha256(record.acceleration.tobytes())
    digest.update(f"{record.dt:.9g}".encode())
    return digest.hexdigest()


def in_order(row: Failure) -> tuple[str, str]:
    """Key that sorts the rows of files that gave no record: by file and reason."""
    return row.file, row.reason


def _place(record: Record) -> tuple[str, str]:
    return record.source, record.channel


def find_files(
    paths: PathLike | Iterable[PathLike], passed_over: Iterable[PathLike] = ()
) -> tuple[list[Found], list[Failure]]:
    """Files behind the paths of :func:`read_all`, each once, sorted; one that is named once counts as named.

    `passed_over` are the files that the run writes, no input whatever link or name leads to them: to open and close one
    that this process has locked would give up the lock. Nothing is opened but XML, to pass over metadata of stations
    and earthquakes. Each path behind which there is nothing, and each folder that cannot be listed, gives a row.
    """
    found: dict[str, Found] = {}
    failures = []
    for given in [paths] if isinstance(paths, str | os.PathLike) else paths:
        text = os.fspath(given)
        path = Path(text)
        if not text:
            failures.append(
                Failure(text, "find", "an empty path was given; is a variable of the shell unset?", "failed")
            )
            continue
        if path.is_dir():
            items, faults = _walk(path)
            failures += faults
            if not items and not faults:
                failures.append(Failure(text, "find", f"{text}: no file to read in the folder; check it", "failed"))
        elif os.path.lexists(path):
            items = [Found(path, True)]
        elif glob.has_magic(text):
            items = []
            for hit in map(Path, glob.glob(text, recursive=True)):  # noqa: PTH207 - takes absolute patterns
                inside, faults = _walk(hit) if hit.is_dir() else ([] if _quiet_file(hit) else [Found(hit, False)], [])
                items += inside
                failures += faults
            if not items:
                failures.append(Failure(text, "find", f"{text}: the pattern matches no file; check it", "failed"))
        else:
            failures.append(Failure(text, "find", f"{text}: no such file or folder; check the path", "failed"))
            continue
        for item in items:
            key = os.path.abspath(item.path)  # noqa: PTH100 - links stay what they are
            if key not in found or item.named:
                found[key] = item
    own = {identity for path in passed_over if (identity := _identity(path)) is not None}
    kept = [item for item in found.values() if not own or _identity(item.path) not in own]
    return sorted(kept, key=lambda item: str(item.path)), failures


def check_patterns(found: Sequence[Found], files: Sequence[FileSettings]) -> None:
    """Raise ConfigError for a pattern that chooses none of the files, nor a member of an archive among them.

    Where there is no file at all, the rows of :func:`find_files` say what is wrong.
    """
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
    """Open a file, or each member of an archive; the error that prevented it stands in its place.

    `station_files` gives name and bytes of the StationXML files in a folder.
    """
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
                if not is_quiet(name, partial(archive.member, number)):
                    empty = False
                    yield Opened(name, _member(archive, number), number)
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
    return Failure(name, "read", reason, "skipped" if isinstance(fault, NotAcceleration) and not named else "failed")


def _member(archive: Archive, number: int) -> SourceFile | RockpulseError:
    try:
        return archive.member(number)
    except RockpulseError as fault:
        return fault


def _without_duplicates(
    records: Sequence[Record], digest: Callable[[Record], str]
) -> tuple[list[Record], list[Failure]]:
    """Each content once, and rows for the others; kept is the record that knows its direction, else time and event."""
    alike: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        alike[digest(record)].append(record)
    first_of: dict[int, Record] = {}
    for group in alike.values():
        kept: list[Record] = []
        for record in sorted(group, key=_unknown):
            first = next((one for one in kept if _same_motion(one, record)), None)
            if first is None:
                kept.append(record)
            else:
                first_of[id(record)] = first
    failures = [
        Failure(
            record.source,
            "read",
            f"channel {record.channel}: same samples and interval as {first.id} of {first.source}",
            "duplicate",
        )
        for record in records
        if (first := first_of.get(id(record))) is not None
    ]
    return [record for record in records if id(record) not in first_of], failures


def _unknown(record: Record) -> tuple[bool, ...]:
    return record.orientation == "unknown", record.start_time is None, not record.event


def _same_motion(one: Record, other: Record) -> bool:
    """Whether two records with the same samples are one motion, under any name of the file and channel.

    Channels of one file, and those that a file says to be dead, may be alike and are told apart by their component.
    """
    if one.component == other.component:
        return True
    if one.source == other.source or any(find(record.warnings, "dead_channel") for record in (one, other)):
        return False
    if "unknown" in (one.orientation, other.orientation):
        return True
    same = np.array_equal(one.azimuth, other.azimuth, equal_nan=True)
    return one.orientation == other.orientation and same
