"""The first look at every file: what is in it, without its samples."""

from __future__ import annotations

import logging
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rockpulse.batch.located import Located, Place
from rockpulse.errors import RockpulseError
from rockpulse.failures import Failure
from rockpulse.readers import ReadOptions
from rockpulse.readers.folders import (
    Found,
    in_order,
    open_files,
    read_failure,
    read_opened,
    sample_digest,
    settled,
)
from rockpulse.readers.source import folder_station_files
from rockpulse.record.record import Record

__all__ = ["FileSurvey", "gather", "survey_file", "unexpected"]


@dataclass(frozen=True)
class FileSurvey:
    """The content of a file, or of an archive, without samples."""

    located: tuple[Located, ...] = ()  # its channels, in the order of the file
    failures: tuple[Failure, ...] = ()  # for the file, or the members, that gave none
    messages: tuple[tuple[int, str], ...] = ()  # level and text of every line for the log
    broken_off: int = 0  # files and members that want of the file system or of memory broke off: to be read again


def survey_file(found: Found, options: ReadOptions) -> FileSurvey:
    """Read a file, or every member of an archive one after the other, and keep all but the samples.

    Every fault is a row of the failures, one of the program too.
    """
    located: list[Located] = []
    failures: list[Failure] = []
    messages: list[tuple[int, str]] = []
    broken_off: list[str] = []

    def leave_out(name: str, fault: Exception) -> None:
        if isinstance(fault, MemoryError) or (isinstance(fault, OSError) and fault.errno is not None):
            broken_off.append(name)  # an OSError without a number is about what is in the file
        if not isinstance(fault, RockpulseError | OSError):
            messages.append((logging.ERROR, f"{name}: {traceback.format_exc()}"))
            fault = unexpected(fault)
        failures.append(read_failure(found, name, fault))

    name = str(found.path)
    try:
        for opened in open_files(found, folder_station_files):
            try:
                for channel, record in enumerate(read_opened(opened, options)):
                    place = Place(name, opened.member, channel, record.source_sha256, sample_digest(record))
                    located.append(Located(record.without_samples(), (place,)))
            except Exception as fault:
                leave_out(opened.name, fault)
    except Exception as fault:
        leave_out(name, fault)
    return FileSurvey(tuple(located), tuple(failures), tuple(messages), len(broken_off))


def unexpected(fault: BaseException) -> RuntimeError:
    """The error that is reported for a fault that no input should cause."""
    if isinstance(fault, MemoryError):
        return RuntimeError("out of memory; use fewer workers, or a machine with more of it")
    return RuntimeError(f"unexpected {type(fault).__name__}: {fault}; please report it with this file")


def gather(
    found: Sequence[Found], surveys: Iterable[tuple[Found, FileSurvey]], failures: Iterable[Failure]
) -> tuple[list[Located], list[Failure]]:
    """Everything that all files together hold: each content once, cut records joined, distinct ids.

    The surveys may come in any order, and lack files whose worker was lost; these are among the failures. Records and
    rows are those of ``read_all``, in the same order, with the same ids, but without samples.
    """
    by_file = {str(one.path): survey for one, survey in surveys}
    ordered = [by_file[str(one.path)] for one in found if str(one.path) in by_file]
    every = [one for survey in ordered for one in survey.located]
    places = {id(one.record): one for one in every}
    rows = [*failures, *(row for survey in ordered for row in survey.failures)]
    whole, duplicates = settled([one.record for one in every], lambda record: places[id(record)].digest)
    located = [_joined(record, [places[id(piece)] for piece in pieces]) for record, pieces in whole]
    return located, sorted([*rows, *duplicates], key=in_order)


def _joined(record: Record, pieces: Sequence[Located]) -> Located:
    return Located(record.without_samples(), tuple(part for piece in pieces for part in piece.parts))
