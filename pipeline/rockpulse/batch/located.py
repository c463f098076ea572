"""A record without its samples, and where they are."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers.archive import Archive
from rockpulse.readers.parts import sample_digest
from rockpulse.readers.source import SourceFile, open_source
from rockpulse.record.record import Record

__all__ = ["Located", "Place"]


@dataclass(frozen=True, slots=True)
class Place:
    """The place of the samples of one channel, and their checksums from when they were read first."""

    path: str  # the file, or the zip archive
    member: int | None  # place of the file in the archive; None outside archives
    channel: int  # number of the channel in the file, from 0
    source_sha256: str  # of the file
    digest: str  # of the samples and the interval (`rockpulse.readers.parts.sample_digest`)


@dataclass(frozen=True, eq=False, slots=True)
class Located:
    """A record without its samples; small, and picklable."""

    record: Record  # with as many zeros as there are samples, in the memory of one
    parts: tuple[Place, ...]  # several for a record that its agency cut into files

    @property
    def digest(self) -> str:
        """The same for two records of the same samples and interval."""
        digests = [part.digest for part in self.parts]
        return digests[0] if len(digests) == 1 else hashlib.sha256(" ".join(digests).encode()).hexdigest()

    def read(self, options: ReadOptions) -> Record:
        """The record with its samples, read with the options of the survey.

        Raises
        ------
        RecordRefused
            If a file is not what it was when it was surveyed.
        RockpulseError, OSError
            If it can no longer be read.
        """
        samples = [_samples(part, options, self.record.source) for part in self.parts]
        return replace(self.record, acceleration=np.concatenate(samples))


def _samples(part: Place, options: ReadOptions, source: str) -> np.ndarray:
    records = _channels(part.path, part.member, _state(part.path), options)
    found = records[part.channel] if part.channel < len(records) else None
    if found is None or found.source_sha256 != part.source_sha256 or sample_digest(found) != part.digest:
        which = source if source == part.path else f"{source}: {part.path}"
        raise RecordRefused(
            f"{which} has changed since the beginning of this run; leave the records as they are while they are worked "
            "on, and run again with --resume"
        )
    return found.acceleration


def _state(path: str) -> tuple[int, int, int]:
    """Properties of a file that change when its content does."""
    state = Path(path).stat()
    return state.st_mtime_ns, state.st_size, state.st_ino


@lru_cache(maxsize=2)
def _channels(path: str, member: int | None, state: tuple[int, int, int], options: ReadOptions) -> tuple[Record, ...]:
    """Every channel of a file; the last ones are kept, for the tasks of a file's channels follow one another."""
    return tuple(read_source(_opened(path, member, state), options))


def _opened(path: str, member: int | None, state: tuple[int, int, int]) -> SourceFile:
    if member is None:
        return open_source(Path(path))
    archive = _archive(path, state)
    if member >= len(archive.names):
        raise RecordRefused(f"{path}: the archive has lost members since the beginning of this run")
    return archive.member(member)


@lru_cache(maxsize=1)
def _archive(path: str, state: tuple[int, int, int]) -> Archive:
    """The archive, opened once for many members: its table of contents is read at every opening."""
    return Archive(Path(path))
