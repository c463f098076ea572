"""The journal of a run: what is finished, durable as soon as it is, in one file beside the output.

The file, ``results.h5.journal``, is a row of frames (`rockpulse.batch.frames`), one for the run and one for each
outcome, exclusively locked by the run that writes it; the lock goes with the process, however it ends. It does not look
into what it keeps.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from rockpulse.batch.file_lock import holder, open_locked
from rockpulse.batch.frames import MARK, Body, Frame, append, frames_of, is_beginning, parts_of
from rockpulse.errors import ResultsError
from rockpulse.failures import Failure
from rockpulse.input_file import check_regular
from rockpulse.storage.hdf5.atomic import flush, journal_path

__all__ = ["UNFINISHED", "Done", "Journal", "JournalError", "journal_path"]

#: Fingerprint of a task that broke off for want of its file or of memory, or by a fault of the program. No task has it:
#: a run that is resumed tries again.
UNFINISHED = ""

#: Beginnings of the journals of other versions: frames of another kind, and before them a database of sqlite with a
#: name of ours at its place in the header.
OTHER_FRAMES, DATABASE, OUR_DATABASE = MARK[:4], b"SQLite format 3\0", (68, b"RPJ")


@dataclass(frozen=True)
class Done:
    """The outcome of a task."""

    key: str  # of the task
    fingerprint: str  # of the task, or UNFINISHED
    parts: tuple[bytes, ...] = ()  # for each motion its Part (rockpulse.motions.runner), packed
    failures: tuple[Failure, ...] = ()  # a row for everything that failed; one alone for a task that broke off
    messages: tuple[tuple[int, str], ...] = ()  # level and text of every line for the log
    seconds: dict[str, float] = field(default_factory=dict)  # time of each step [s]


class JournalError(ResultsError):
    """The journal itself cannot be used; the message says what becomes of what it keeps."""

    def __init__(self, message: str, tells_resume: bool = True) -> None:
        super().__init__(message, tells_resume)


@dataclass(frozen=True, slots=True)
class _Kept:
    """An outcome, and where its parts are."""

    fingerprint: str
    failures: tuple[Failure, ...]
    body: Body


class Journal:
    """The finished tasks of a run, in a file; made by :meth:`open`, to be used in a ``with`` block.

    The `run_id` stays the same after the run is resumed. `gaps` is the number of places in the file, as it was opened,
    where something stands that was not written there.
    """

    def __init__(self, path: Path, file: FileIO) -> None:
        """Find what a locked file keeps; the run, when it began, and where the next frame is written."""
        frames = frames_of(file)
        self.path, self.gaps = path, frames.gaps
        self.run_id, self.started, self._end = "", "", frames.end
        self._file, self._identity = file, _identity(os.fstat(file.fileno()))
        self._kept: dict[str, _Kept] = {}
        for frame in frames.found:
            if not _is_ours(frame.head):
                self.gaps += 1
                continue
            self.run_id, self.started = frame.head["run"], frame.head["started"]
            if "key" in frame.head:
                self._keep(frame)

    @classmethod
    def open(cls, target: str | os.PathLike[str], resume: bool = False, overwrite: bool = False) -> Journal:
        """Create the journal of a run beside its output, or go on with one that was stopped, and lock it.

        With `resume` what a stopped run has finished is kept; where there is none a new run begins. Without it
        `overwrite` drops what a stopped run has finished.

        Raises
        ------
        JournalError
            For a journal that another process holds, one of a stopped run where neither `resume` nor `overwrite` says
            what is to become of it, a foreign file, or a place that cannot be written.
        """
        path = journal_path(target)
        check_regular(path, JournalError)
        empty, file = True, None
        try:
            file = open_locked(path)
            if file is None:
                raise JournalError(
                    f"{path}: {holder(path)} is writing this output; wait for it, or choose another output"
                )
            if _identity_of(path) != _identity(os.fstat(file.fileno())):
                empty = False  # it is another's by now
                raise JournalError(f"{path}: another run on this output has just ended; give the command again")
            empty = os.fstat(file.fileno()).st_size == 0
            journal = cls(path, file)
            journal._take_up(resume, overwrite)
        except BaseException as error:
            if file is not None:
                if empty:
                    path.unlink(missing_ok=True)
                file.close()
            if isinstance(error, OSError):
                raise JournalError(
                    f"{path}: cannot keep the journal of the run beside the output: {error.strerror or error}; choose "
                    "another output"
                ) from error
            raise
        return journal

    @property
    def in_place(self) -> bool:
        """Whether the file is still the one that was opened; who removes it takes the finished records with it."""
        return _identity_of(self.path) == self._identity

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give the lock back; what is finished stays for a run that resumes."""
        self._file.close()

    def remove(self) -> None:
        """Remove the file, as the output is complete, and close it; one that has taken its place stays."""
        if not self.in_place:
            self._file.close()
        elif os.name == "posix":  # before the lock is given back, lest it be somebody else's; elsewhere one cannot
            self.path.unlink(missing_ok=True)
            self._file.close()
        else:
            self._file.close()
            self.path.unlink(missing_ok=True)

    def finished(self) -> dict[str, str]:
        """Fingerprint of each finished task, by key."""
        return {key: kept.fingerprint for key, kept in self._kept.items()}

    def add(self, done: Done) -> None:
        """Keep the outcome of a task in place of an earlier one; it is on the disk when this returns.

        Raises
        ------
        JournalError
            Where it cannot be written, as on a full disk: what was kept before stays. Where somebody has removed the
            file.
        """
        if not self.in_place:
            raise JournalError(
                f"{self.path}: the journal was removed while the run was at work, and what was finished with it; begin "
                "anew"
            )
        rows = [[*map(_in_utf8, (row.file, row.stage, row.reason, row.kind))] for row in done.failures]
        outcome = {"key": done.key, "fingerprint": done.fingerprint, "failures": rows}
        try:
            self._keep(self._append(outcome, done.parts))
        except OSError as error:
            count = sum(kept.fingerprint != UNFINISHED for kept in self._kept.values())
            raise JournalError(
                f"{self.path}: cannot keep the result of {done.key}: {error.strerror or error}; the {count} finished "
                "before are kept: make room on the disk, then give the same command with --resume"
            ) from error

    def parts(self, key: str) -> tuple[bytes, ...]:
        """The parts of a finished task in their order; a JournalError where they are not as they were written."""
        if key not in self._kept:
            return ()
        found = self._parts(key)
        if found is None:
            raise JournalError(
                f"{self.path}: the result of {key} is not as it was written; the same command with --resume does this "
                "record again"
            )
        return found

    def drop_damaged(self, is_result: Callable[[str, tuple[bytes, ...]], bool]) -> list[str]:
        """Forget the tasks whose results are not as they were written, so that they are done again; their keys.

        With them go those of which `is_result` says, by key and parts, that they are none: anybody can write a frame.
        """
        dropped = [key for key in self._kept if (found := self._parts(key)) is None or not is_result(key, found)]
        for key in dropped:
            del self._kept[key]
        return sorted(dropped)

    def failures(self) -> dict[str, tuple[Failure, ...]]:
        """The failures of each finished task that has some, by key."""
        return {key: kept.failures for key, kept in self._kept.items() if kept.failures}

    def _take_up(self, resume: bool, overwrite: bool) -> None:
        """Go on behind what is kept, or begin anew."""
        if not self.run_id and not is_beginning(self._file):
            raise JournalError(f"{self.path}: {_foreign(self._file)}")
        if self.run_id and resume:
            if self._file.seek(0, os.SEEK_END) > self._end:  # behind it lies what was cut off
                self._file.truncate(self._end)
            return
        count = sum(kept.fingerprint != UNFINISHED for kept in self._kept.values())
        if count and not overwrite:
            raise JournalError(
                f"{self.path}: a run that began {self.started} was stopped with {count} record{'s' * (count != 1)} "
                "done; go on with --resume, or begin anew with --overwrite"
            )
        self._file.truncate(0)
        self._end, self._kept = 0, {}
        self.run_id, self.started = secrets.token_hex(16), f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"
        self._append({})
        if os.name == "posix":  # elsewhere a folder cannot be opened
            flush(self.path.parent, os.O_RDONLY)

    def _append(self, outcome: dict[str, Any], parts: tuple[bytes, ...] = ()) -> Frame:
        head = {"run": self.run_id, "started": self.started, **outcome}
        frame = append(self._file, self._end, head, parts)
        self._end = frame.end
        return frame

    def _keep(self, frame: Frame) -> None:
        failures = tuple(Failure(*row) for row in frame.head["failures"])
        self._kept[frame.head["key"]] = _Kept(frame.head["fingerprint"], failures, frame.body)

    def _parts(self, key: str) -> tuple[bytes, ...] | None:
        try:
            return parts_of(self._file, self._kept[key].body)
        except OSError as error:
            raise JournalError(f"{self.path}: cannot be read: {error.strerror or error}") from error


def _is_ours(head: Mapping[str, Any]) -> bool:
    """Whether the head of a frame has what is asked of it: anybody can make one."""
    names = ("run", "started") if "key" not in head else ("run", "started", "key", "fingerprint")
    rows = head.get("failures", [])
    return (
        all(isinstance(head.get(name), str) for name in names)
        and isinstance(rows, list)
        and all(isinstance(row, list) and len(row) == 4 and all(isinstance(one, str) for one in row) for row in rows)
    )


def _foreign(file: FileIO) -> str:
    """Of what is no journal of this version: what it is, and what to do."""
    file.seek(0)
    content = file.read(128)
    at, name = OUR_DATABASE
    if content.startswith(OTHER_FRAMES) or (content.startswith(DATABASE) and content[at : at + len(name)] == name):
        return (
            "the journal of a run of another version of rockpulse; resume the run with that version, or remove the file"
        )
    return (
        "expected the journal of a run of rockpulse, found another file, which is left alone; choose another output, "
        "or remove the file by hand"
    )


def _identity(state: os.stat_result) -> tuple[int, int]:
    """Device and number of a file."""
    return state.st_dev, state.st_ino


def _identity_of(path: Path) -> tuple[int, int] | None:
    """Device and number of the file of a name; None where there is none."""
    with suppress(FileNotFoundError, NotADirectoryError):
        return _identity(path.stat())
    return None


def _in_utf8(text: str) -> str:
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
