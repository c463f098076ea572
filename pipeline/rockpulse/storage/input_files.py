"""The files that results rest on: which they are, what they were, and what they are now."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from itertools import groupby
from pathlib import Path

import h5py

from rockpulse.config.configuration import stored_sections
from rockpulse.errors import RecordRefused, ResultsError, RockpulseError
from rockpulse.files import check_regular
from rockpulse.readers.archive import Archive, is_archive
from rockpulse.readers.source import open_source
from rockpulse.record.record import BETWEEN

__all__ = ["in_place", "input_checksums", "input_files", "record_folders", "stored_checksums"]


def stored_checksums(hdf5: h5py.File) -> list[tuple[str, str]]:
    """The files of every record of an open results file and their SHA-256, as they are stored."""
    groups = [
        item for item in hdf5.values() if isinstance(item, h5py.Group) and {"source", "source_sha256"} <= set(item)
    ]
    return [
        pair
        for group in groups
        for pair in zip(group["source"].asstr()[:], group["source_sha256"].asstr()[:], strict=True)
        if pair[1]
    ]


def input_files(stored: Iterable[tuple[str, str]]) -> dict[str, set[str]]:
    """The files (``archive.zip!member``) that records were read from, by name, from pairs of :func:`stored_checksums`.

    The values are their SHA-256 as stored; several where a file changed between two records. A ResultsError where a
    record has not a SHA-256 for each of its files.
    """
    found: dict[str, set[str]] = {}
    for source, checksum in stored:
        for name, one in _apart(source, checksum):
            found.setdefault(name, set()).add(one)
    return found


def record_folders(configuration: str) -> list[Path]:
    """Folders from which the files of a run may have been named, by the configuration that is stored in its results.

    The paths of its records are absolute. A text that is no configuration names no folder.
    """
    try:
        named = stored_sections(configuration).get("records", {}).get("paths", ())
    except ResultsError:
        return []
    paths = [Path(path) for path in named if isinstance(path, str)] if isinstance(named, list | tuple) else []
    return list(dict.fromkeys(folder for path in paths for folder in (path, *path.parents)))


def in_place(source: str, folders: Iterable[Path]) -> str:
    """A file as it is named, or its path below one of the folders if it is there and not where it is named."""
    named = (source, *(str(folder / source) for folder in folders))
    return next((name for name in named if _there(_location(name)[0])), source)


def _apart(source: str, checksum: str) -> list[tuple[str, str]]:
    """The files of a record and the checksum of each; equal checksums stand once."""
    checksums = checksum.split(BETWEEN)
    names = [source] if len(checksums) == 1 and _there(_location(source)[0]) else source.split(BETWEEN)
    if len(checksums) == 1:
        checksums *= len(names)
    if len(names) != len(checksums):
        raise ResultsError(f"the record of {source}: expected a SHA-256 for each of its files, found {checksum!r}")
    return list(zip(names, checksums, strict=True))


def _there(path: str | Path) -> bool:
    """Whether a file is there; a name too long for one, or a folder that may not be looked into, is no error here."""
    return os.path.exists(path)  # noqa: PTH110 - Path.exists raises for these


def _location(source: str) -> tuple[Path, str | None]:
    """The file on the disk, and the member if that is an archive; names may hold a "!" themselves."""
    if "!" in source and not _there(source):
        archive, _, member = source.partition("!")
        while not _there(archive) and "!" in member:
            further, _, member = member.partition("!")
            archive = f"{archive}!{further}"
        return Path(archive), member
    return Path(source), None


def input_checksums(sources: Iterable[str]) -> Iterator[tuple[str, str | Exception | None]]:
    """Every file and its SHA-256 as it is now, or the error that kept it from being read, or None where it is absent.

    `sources` are sorted keys of :func:`input_files`, so that an archive is opened once.
    """
    for place, names in groupby(sources, key=lambda source: _location(source)[0]):
        if not _there(place):
            yield from ((name, None) for name in names)
            continue
        try:
            check_regular(place, ResultsError)
            opened = Archive(place) if is_archive(place) else nullcontext()
        except (RockpulseError, OSError) as error:
            yield from ((name, error) for name in names)
            continue
        with opened as archive:
            for name in names:
                yield name, _checksum(place, archive, name)


def _checksum(place: Path, archive: Archive | None, name: str) -> str | Exception:
    try:
        if archive is None:
            return open_source(place).sha256
        if name not in archive.names:
            raise RecordRefused("the archive no longer has this member")
        return archive.member(archive.names.index(name)).sha256
    except (RockpulseError, OSError) as error:
        return error
