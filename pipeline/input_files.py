"""The files that results rest on: which they are, what they were, and what they are now."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from itertools import groupby
from pathlib import Path

import h5netcdf

from rockpulse.errors import RecordRefused, ResultsError, RockpulseError
from rockpulse.readers.archive import Archive, is_archive
from rockpulse.readers.source import open_source

__all__ = ["input_checksums", "stored_inputs"]

#: Between the files of a record that was made of several, and between their checksums.
BETWEEN = "; "


def stored_inputs(file: h5netcdf.File) -> dict[str, set[str]]:
    """The files that the records of a results file were read from.

    Parameters
    ----------
    file : h5netcdf.File
        Open.

    Returns
    -------
    dict of str to set of str
        By file (``archive.zip!member``) its SHA-256 as stored; several where it changed between two records.

    Raises
    ------
    ResultsError
        Where a record has not a SHA-256 for each of its files.
    """
    found: dict[str, set[str]] = {}
    for group in file.groups.values():
        if not {"source", "source_sha256"} <= set(group.variables):
            continue
        for source, checksum in zip(group["source"][:], group["source_sha256"][:], strict=True):
            if not checksum:
                continue
            for name, one in _apart(source, checksum):
                found.setdefault(name, set()).add(one)
    return found


def _apart(source: str, checksum: str) -> list[tuple[str, str]]:
    """The files of a record and the checksum of each; equal checksums stand once."""
    checksums = checksum.split(BETWEEN)
    names = [source] if len(checksums) == 1 and _location(source)[0].exists() else source.split(BETWEEN)
    if len(checksums) == 1:
        checksums *= len(names)
    if len(names) != len(checksums):
        raise ResultsError(f"the record of {source}: expected a SHA-256 for each of its files, found {checksum!r}")
    return list(zip(names, checksums, strict=True))


def _location(source: str) -> tuple[Path, str | None]:
    """The file on the disk, and the member if that is an archive; names may hold a "!" themselves."""
    if "!" in source and not Path(source).exists():
        archive, _, member = source.partition("!")
        while not Path(archive).exists() and "!" in member:
            further, _, member = member.partition("!")
            archive = f"{archive}!{further}"
        return Path(archive), member
    return Path(source), None


def input_checksums(sources: Iterable[str]) -> Iterator[tuple[str, str | Exception | None]]:
    """What the files are now; archives are opened once.

    Parameters
    ----------
    sources : iterable of str
        Keys of :func:`stored_inputs`, sorted.

    Yields
    ------
    source : str
        The file.
    checksum : str, Exception or None
        Its SHA-256, or what kept it from being read, or None where it is not there.
    """
    for place, names in groupby(sources, key=lambda source: _location(source)[0]):
        if not place.exists():
            yield from ((name, None) for name in names)
            continue
        try:
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
