"""First pass over the files: reads every file once, and keeps its records and the location of their samples."""

import hashlib
import logging
import traceback
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from rockpulse.errors import Failure, RecordRefused, RockpulseError
from rockpulse.readers import ReadOptions, read_source
from rockpulse.readers.folders import Found, in_order, open_files, read_failure, read_opened, sample_digest, settled
from rockpulse.readers.source import Archive, folder_station_files, open_source
from rockpulse.record.record import Record
from rockpulse.run.journal import Message


@dataclass(frozen=True, slots=True)
class SamplesLocation:
    """The location of the samples of one channel (file, member of an archive, channel), with checksums."""

    path: str  # the file, or the zip archive
    member: int | None  # index of the file in the archive; None outside archives
    channel: int  # index of the channel in the file, from 0
    source_sha256: str  # SHA-256 of the file
    digest: bytes  # digest of samples and interval (`rockpulse.readers.parts.sample_digest`)


@dataclass(frozen=True, eq=False, slots=True)
class Located:
    """A record without its samples, and the location of its samples; it takes little memory and can be pickled."""

    record: Record  # zeros instead of the samples, in the memory of one number
    parts: tuple[SamplesLocation, ...]  # several for a record split over several files

    @property
    def digest(self) -> bytes:
        """Return a digest that is equal for records with the same samples and sampling interval."""
        digests = [part.digest for part in self.parts]
        return digests[0] if len(digests) == 1 else hashlib.sha256(b" ".join(digests)).digest()

    def read(self, options: ReadOptions) -> Record:
        """Read the record again, with its samples, with the same options as in the first pass over the files.

        Raises RecordRefused if a file has changed since then, RockpulseError or OSError if reading fails.
        """
        samples = [_samples(part, options, self.record.source) for part in self.parts]
        return replace(self.record, acceleration=samples[0] if len(samples) == 1 else np.concatenate(samples))


def _samples(part: SamplesLocation, options: ReadOptions, source: str) -> np.ndarray:
    file = Path(part.path).stat()
    state = (file.st_mtime_ns, file.st_size, file.st_ino)  # changes with the content
    records = _channels(part.path, part.member, state, options)
    found = records[part.channel] if part.channel < len(records) else None
    if found is None or found.source_sha256 != part.source_sha256 or sample_digest(found) != part.digest:
        which = source if source == part.path else f"{source}: {part.path}"
        raise RecordRefused(
            f"{which} has changed since the beginning of this run; do not change the records during a run; run again "
            "with --resume"
        )
    return found.acceleration


@lru_cache(maxsize=2)
def _channels(path: str, member: int | None, state: tuple[int, int, int], options: ReadOptions) -> tuple[Record, ...]:
    """Return all channels of a file; the last two files are cached, as successive tasks often need the same file."""
    if member is None:
        return tuple(read_source(open_source(Path(path)), options))
    archive = _archive(path, state)
    if member >= len(archive.names):
        raise RecordRefused(
            f"{path}: the archive contains fewer files than at the beginning of this run; run again with --resume"
        )
    return tuple(read_source(archive.member(member), options))


@lru_cache(maxsize=1)
def _archive(path: str, state: tuple[int, int, int]) -> Archive:
    """Open an archive; the last one is cached, as successive tasks often need the same archive."""
    return Archive(Path(path))


@dataclass(frozen=True, slots=True)
class FileSurvey:
    """The content of a file or archive: records without samples, and failures."""

    located: tuple[Located, ...] = ()  # the channels in order
    failures: tuple[Failure, ...] = ()  # failures of the file or its members
    messages: tuple[Message, ...] = ()  # every log line
    broken_off: int = 0  # number of files and members to read again after an error of the file system or memory


def survey_file(found: Found, options: ReadOptions) -> FileSurvey:
    """Read a file, or every member of an archive, without keeping samples; every error becomes a row of /failures."""
    located: list[Located] = []
    failures: list[Failure] = []
    messages: list[Message] = []
    broken_off: list[str] = []

    def leave_out(name: str, fault: Exception) -> None:
        if isinstance(fault, MemoryError) or (isinstance(fault, OSError) and fault.errno is not None):
            broken_off.append(name)  # an OSError without a number concerns the content of the file
        if not isinstance(fault, RockpulseError | OSError):
            messages.append(("rockpulse", logging.ERROR, f"{name}: {traceback.format_exc()}"))
            fault = unexpected_fault(fault)
        failures.append(read_failure(found, name, fault))

    name = found.path
    try:
        for opened in open_files(found, folder_station_files):
            try:
                for channel, record in enumerate(read_opened(opened, options)):
                    path = record.source if record.source == name else name  # one string in memory
                    place = SamplesLocation(path, opened.member, channel, record.source_sha256, sample_digest(record))
                    located.append(Located(record.without_samples(), (place,)))
            except Exception as fault:
                leave_out(opened.name, fault)
    except Exception as fault:
        leave_out(name, fault)
    return FileSurvey(tuple(located), tuple(failures), tuple(messages), len(broken_off))


def unexpected_fault(fault: BaseException) -> RuntimeError:
    """Return the error that is reported for an exception which no input file should cause."""
    if isinstance(fault, MemoryError):
        return RuntimeError("out of memory; use fewer workers, or a machine with more of it")
    return RuntimeError(f"unexpected {type(fault).__name__}: {fault}; please report it with this file")


def gather_survey(located: list[Located], failures: Iterable[Failure]) -> tuple[list[Located], list[Failure]]:
    """Combine the contents of all files: join records that are split over several files, and add the failures."""
    located.sort(key=lambda one: one.parts[0].path)  # the files are finished in any order
    of_record = {id(one.record): one for one in located}
    whole, duplicates = settled([one.record for one in located], lambda record: of_record[id(record)].digest)
    joined = []
    for record, pieces in whole:
        one = of_record[id(pieces[0])]
        if len(pieces) > 1:
            record = record.without_samples()
        if one.record is not record:
            one = Located(record, tuple(part for piece in pieces for part in of_record[id(piece)].parts))
        joined.append(one)
    return joined, sorted([*failures, *duplicates], key=in_order)
