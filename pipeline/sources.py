"""From paths to records: files, folders, globs and zip archives; what fails becomes a row, not a crash.

Left out without a row, in folders and archives: hidden files and folders, and files that cannot be records by their
name (`QUIET`: notes, configurations, station metadata, results). Everything else that is no record is "skipped".
"""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.failures import Failure
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers.archive import is_archive, members
from rockpulse.readers.renadic import join_parts
from rockpulse.readers.source import (
    NotAcceleration,
    SourceFile,
    Unrecognised,
    check_link,
    folder_station_files,
    open_source,
)
from rockpulse.record import Record, distinct_ids

__all__ = ["QUIET", "read_all"]

#: Suffixes of files that lie beside records and are passed over without a row unless they are named explicitly.
QUIET = frozenset({".md", ".toml", ".xml", ".h5", ".html", ".pdf", ".png"})

PathLike = str | os.PathLike[str]


@dataclass(frozen=True)
class _Found:
    """A file to read; `named` if the user gave its very name."""

    path: Path
    named: bool


def read_all(
    paths: PathLike | Iterable[PathLike],
    units: str | None = None,
    on_file: Callable[[str], None] | None = None,
    dt: float | None = None,
    response: str = "sensitivity",
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

    Returns
    -------
    records : list of Record
        Sorted by path and channel, with distinct ids: the second of two records with one id and different content
        has ``~2`` appended. A record that its agency cut into files is one; see
        `rockpulse.readers.renadic.join_parts`.
    failures : list of Failure
        Sorted by file. A file that is no acceleration record "failed" if it was named and is "skipped" if it was met
        in a folder, a glob or an archive; one that is a record and cannot be read failed in any case, and so did an
        empty one. A record whose samples, interval and component came before is a "duplicate".

    Raises
    ------
    UnitError
        If `units` is none of the accepted ones. No file raises anything.
    ConfigError
        If `response` is.
    """
    options = ReadOptions(units, dt, response)
    found, failures = _find([paths] if isinstance(paths, str | os.PathLike) else list(paths))
    # One look at a folder's station metadata serves all its records.
    station_files = lru_cache(maxsize=16)(folder_station_files)
    records: list[Record] = []
    for item in found:
        for name, outcome in _files(item, station_files):
            try:
                if isinstance(outcome, Exception):
                    raise outcome
                records += read_source(outcome, options)
            except (RockpulseError, OSError) as fault:
                failures.append(_failure(name, fault, item.named and name == str(item.path)))
        if on_file is not None:
            on_file(str(item.path))
    records.sort(key=lambda record: (record.source, record.channel))
    records, duplicates = _without_duplicates(records)
    records = sorted(join_parts(records), key=lambda record: (record.source, record.channel))
    return distinct_ids(records), sorted(failures + duplicates, key=lambda row: (row.file, row.reason))


def _find(paths: Sequence[PathLike]) -> tuple[list[_Found], list[Failure]]:
    """Files behind the paths, each once, sorted; a file that is named and also lies in a folder counts as named."""
    found: dict[str, _Found] = {}
    failures = []
    for given in paths:
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
            items = [_Found(path, True)]
        elif glob.has_magic(text):
            items = []
            for hit in map(Path, glob.glob(text, recursive=True)):  # noqa: PTH207 - takes absolute patterns
                inside, faults = _walk(hit) if hit.is_dir() else ([_Found(hit, False)], [])
                items += [item for item in inside if item.path.suffix.lower() not in QUIET]
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
    return sorted(found.values(), key=lambda item: str(item.path)), failures


def _walk(folder: Path) -> tuple[list[_Found], list[Failure]]:
    """Files below a folder, and a row for each folder that cannot be listed."""
    faults: list[OSError] = []
    items = []
    for parent, folders, files in os.walk(folder, onerror=faults.append):
        folders[:] = [name for name in folders if not name.startswith(".")]
        paths = [Path(parent, name) for name in files if not name.startswith(".")]
        items += [_Found(path, False) for path in paths if path.suffix.lower() not in QUIET]
    return items, [Failure(str(fault.filename), "find", str(fault), "failed") for fault in faults]


def _files(
    item: _Found, station_files: Callable[[Path], list[tuple[str, bytes]]]
) -> Iterator[tuple[str, SourceFile | RockpulseError | OSError]]:
    """The file, or the members of the archive, or the fault that kept them from being opened."""
    path = item.path
    try:
        check_link(path)
        if path.exists() and not path.is_file():
            raise OSError(f"{path}: expected a regular file, found a device, socket or pipe")
        if not is_archive(path):
            yield str(path), open_source(path, partial(station_files, path.parent))
            return
        count = 0
        for name, member in members(path):
            if Path(name).suffix.lower() not in QUIET:
                count += 1
                yield name, member
        if not count:
            raise RecordFormatError(f"{path}: no file to read in the archive; check it")
    except (RockpulseError, OSError) as fault:
        yield str(path), fault


def _failure(name: str, fault: RockpulseError | OSError, named: bool) -> Failure:
    no_record = isinstance(fault, Unrecognised | NotAcceleration)
    reason = str(fault) if name in str(fault) else f"{name}: {fault}"
    return Failure(name, "read", reason, "skipped" if no_record and not named else "failed")


def _without_duplicates(records: Sequence[Record]) -> tuple[list[Record], list[Failure]]:
    seen: dict[str, Record] = {}
    kept, failures = [], []
    for record in records:
        digest = hashlib.sha256(record.acceleration.tobytes())
        digest.update(f"{record.dt!r} {record.component}".encode())
        first = seen.setdefault(digest.hexdigest(), record)
        if first is record:
            kept.append(record)
        else:
            reason = f"channel {record.channel}: same samples, interval and component as {first.id} of {first.source}"
            failures.append(Failure(record.source, "read", reason, "duplicate"))
    return kept, failures
