"""The journal of a run: a file next to the output in which the results of every finished task are saved at once.

The file, ``results.h5.journal``, consists of frames (`rockpulse.run.frames`), one for the run and one for each task.
The run locks the file until its process ends. The journal stores the parts of results as bytes, without reading them.
"""

import os
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from io import FileIO
from pathlib import Path
from typing import Any, Self

from rockpulse.errors import Failure, ResultsError
from rockpulse.files import check_regular
from rockpulse.foreign_text import in_utf8
from rockpulse.run.frames import MARK, Frame, append, frame_at, read_frames
from rockpulse.storage.hdf5.atomic import flush, journal_path

__all__ = ["UNFINISHED", "Done", "Journal", "JournalError", "holder", "journal_path", "open_locked"]
#: Fingerprint of a task that was aborted by an unreadable file, lack of memory or a program error, and that a resumed
#: run repeats.
UNFINISHED = ""
#: Longest wait for a lock, which another process may be about to release, and interval between attempts [s].
PATIENCE, PAUSE = 1.0, 0.02

if sys.platform == "win32":
    import msvcrt

    def _lock(file: FileIO) -> None:
        """Lock one byte beyond the end of a file, because on Windows locked bytes cannot be read."""
        file.seek(2**62)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(file: FileIO) -> None:
        """Lock the file through this handle; other handles of the same file neither share nor release the lock."""
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def open_locked(path: Path) -> FileIO | None:
    """Open or create a file and lock it; None if another process has the lock, OSError if opening fails."""
    file = FileIO(os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666), "r+")
    end = time.monotonic() + PATIENCE
    try:
        while True:
            try:
                _lock(file)
            except (BlockingIOError, PermissionError):  # the second on Windows
                if time.monotonic() > end:
                    file.close()
                    return None
                time.sleep(PAUSE)
            else:
                return file
    except BaseException:
        file.close()
        raise


def holder(path: Path) -> str:
    """Return the process that has locked a file, or "another process" if the operating system does not report it."""
    table = Path("/proc/locks")
    if table.is_file():
        inode = str(path.stat().st_ino)
        for line in table.read_text(encoding="ascii").splitlines():
            # 1: FLOCK ADVISORY WRITE <process> <device>:<device>:<inode> <first byte> <last byte>
            words = line.split()
            if "WRITE" in words and words[5].rpartition(":")[2] == inode and int(words[4]) > 0:
                return f"process {words[4]}"
    return "another process"


#: A log message: name of the logger, level and text.
Message = tuple[str, int, str]


@dataclass(frozen=True)
class Done:
    """The result of a finished task."""

    key: str  # key of the task
    fingerprint: str  # fingerprint of the task, or UNFINISHED
    parts: tuple[bytes, ...] = ()  # packed Part (rockpulse.run.analysis) of each record
    failures: tuple[Failure, ...] = ()  # a row for each failure; a single row for an aborted task
    messages: tuple[Message, ...] = ()  # every log line
    seconds: dict[str, float] = field(default_factory=dict)  # time of each step [s]


class JournalError(ResultsError):
    """Error: the journal cannot be used; the message states what happens to the records stored in it."""

    def __init__(self, message: str, tells_resume: bool = True) -> None:
        super().__init__(message, tells_resume)


@dataclass(frozen=True, slots=True)
class _Kept:
    """What is kept in memory of the frame of a task: as little as possible, as there may be 100,000 of them."""

    fingerprint: str
    failures: tuple[Failure, ...]
    count: int  # of the parts
    start: int  # position of the frame in the file


class Journal:
    """The results of finished tasks, stored in a file; :meth:`open` returns it for use in a ``with`` block."""

    def __init__(self, path: Path, file: FileIO) -> None:
        self.path, self.run_id, self._started = path, "", ""
        self.appends = ""  # run_id of the results file to which the run appends
        self._file, self._identity = file, _identity(os.fstat(file.fileno()))
        self._kept: dict[str, _Kept] = {}
        self.gaps = 0  # number of damaged places and of foreign frames
        self._end, damaged = read_frames(file, self._take)
        self.gaps += damaged

    @classmethod
    def open(
        cls, target: str | os.PathLike[str], resume: bool = False, overwrite: bool = False, appends: str = ""
    ) -> "Journal":
        """Create the journal of a run next to its output, or open the journal of a stopped run, and lock it.

        `resume` keeps the finished tasks of a stopped run, `overwrite` deletes them; `appends` is the run_id of the
        results file to which records are appended. Raises JournalError if the file is locked or is not a journal, or
        if it contains finished tasks and neither `resume` nor `overwrite` is given.
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
                empty = False  # another run has replaced it
                raise JournalError(f"{path}: another run on this output has just ended; run the command again")
            empty = os.fstat(file.fileno()).st_size == 0
            journal = cls(path, file)
            journal._take_up(resume, overwrite, appends)
        except BaseException as error:
            if file is not None:
                if empty:
                    path.unlink(missing_ok=True)
                file.close()
            if isinstance(error, OSError):
                raise JournalError(
                    f"{path}: cannot write the journal of the run next to the output: {error.strerror or error}; "
                    "choose another output"
                ) from error
            raise
        return journal

    @classmethod
    def progress(cls, target: str | os.PathLike[str]) -> str:
        """Return a sentence on how many records an unfinished run has completed; empty if it has no journal."""
        path = journal_path(target)
        if not path.is_file():
            return ""
        with path.open("rb", buffering=0) as file:
            found = cls(path, file)
        if not found.run_id:
            return ""
        done, failed = len(found.complete), len(found.failures())
        return (
            f"the run that began {found._started} is not finished: {done} record{'s' * (done != 1)} done, {failed} of "
            "them with a failure or rejection; if it was stopped, continue with the same command and --resume"
        )

    @property
    def is_current(self) -> bool:
        """Return whether the path still leads to the opened file."""
        return _identity_of(self.path) == self._identity

    @property
    def complete(self) -> set[str]:
        """Keys of all finished tasks, including tasks of earlier runs with other files or options."""
        return {key for key, kept in self._kept.items() if kept.fingerprint != UNFINISHED}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def remove(self) -> None:
        """Close the journal and delete it, unless another file has taken its place."""
        is_current = self.is_current
        if is_current and os.name == "posix":  # before another run can get the lock
            self.path.unlink(missing_ok=True)
        self._file.close()
        if is_current and os.name != "posix":  # an open file cannot be removed
            self.path.unlink(missing_ok=True)

    def finished(self) -> dict[str, str]:
        """Return the fingerprint of each finished task, by its key."""
        return {key: kept.fingerprint for key, kept in self._kept.items()}

    def failures(self) -> dict[str, list[Failure]]:
        """Return the failures of each finished task, by its key."""
        return {key: [*kept.failures] for key, kept in self._kept.items() if kept.failures}

    def add(self, done: Done) -> None:
        """Save the result of a task on the disk, replacing an earlier result; raise JournalError if writing fails."""
        if not self.is_current:
            raise JournalError(
                f"{self.path}: the journal was removed during the run, and the finished records with it; start again"
            )
        rows = [[*map(in_utf8, (row.file, row.stage, row.reason, row.kind, row.remedy))] for row in done.failures]
        outcome = {"key": done.key, "fingerprint": done.fingerprint, "failures": rows}
        try:
            self._keep(self._append(outcome, done.parts))
        except OSError as error:
            raise JournalError(
                f"{self.path}: cannot store the result of {done.key}: {error.strerror or error}; the "
                f"{len(self.complete)} records finished before are kept: free some disk space, then run the same "
                "command with --resume"
            ) from error

    def count(self, key: str) -> int:
        """Return how many parts of results a finished task has."""
        return self._kept[key].count

    def parts(self, key: str) -> tuple[bytes, ...]:
        """Return the parts of the results of a finished task; raise JournalError if they are damaged."""
        found = self._parts(key) if key in self._kept else ()
        if found is None:
            raise JournalError(
                f"{self.path}: the stored result of {key} is damaged; the same command with --resume assesses this "
                "record again"
            )
        return found

    def drop_damaged(self, is_result: Callable[[str, tuple[bytes, ...]], bool]) -> list[str]:
        """Remove tasks whose parts are damaged or fail the test `is_result(key, parts)`; return their keys."""
        dropped = [key for key in self._kept if (found := self._parts(key)) is None or not is_result(key, found)]
        for key in dropped:
            del self._kept[key]
        return sorted(dropped)

    def _take_up(self, resume: bool, overwrite: bool, appends: str) -> None:
        """Keep the valid frames of an existing journal and write after them, or start a new journal."""
        self._file.seek(0)
        begins = self._file.read(len(MARK))
        if not self.run_id and not MARK.startswith(begins):  # and not truncated within its first bytes
            if begins.startswith(MARK[:4]):
                raise JournalError(
                    f"{self.path}: found the journal of another version of rockpulse; resume the run with that "
                    "version, or remove the file"
                )
            raise JournalError(
                f"{self.path}: expected the journal of a run of rockpulse, found another file, which is not changed; "
                "choose another output, or remove the file by hand"
            )
        if self.run_id and resume:
            self._file.truncate(self._end)  # a truncated frame follows
            if appends and appends != self.appends:
                self.appends = appends
                self._append({})
            return
        count = len(self.complete)
        if count and not overwrite:
            raise JournalError(
                f"{self.path}: a run that began {self._started} was stopped with {count} record{'s' * (count != 1)} "
                "done; continue with --resume, or start again with --overwrite"
            )
        self._file.truncate(0)
        self._end, self._kept, self.appends = 0, {}, appends
        self.run_id, self._started = secrets.token_hex(16), f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"
        self._append({})
        if os.name == "posix":  # on other systems a folder cannot be opened
            flush(self.path.parent, os.O_RDONLY)

    def _append(self, outcome: dict[str, Any], parts: Iterable[bytes] = ()) -> Frame:
        head = {"run": self.run_id, "started": self._started, "appends": self.appends, **outcome}
        frame = append(self._file, self._end, head, tuple(parts))
        self._end = frame.end
        return frame

    def _take(self, frame: Frame) -> None:
        """Take a frame that was read from the file."""
        if not _is_ours(frame.head):
            self.gaps += 1
            return
        self.run_id, self._started = frame.head["run"], frame.head["started"]
        self.appends = frame.head.get("appends", "")
        if "key" in frame.head:
            self._keep(frame)

    def _keep(self, frame: Frame) -> None:
        head, failures = frame.head, tuple(Failure(*row) for row in frame.head["failures"])
        self._kept[head["key"]] = _Kept(head["fingerprint"], failures, len(frame.sizes), frame.start)

    def _parts(self, key: str) -> tuple[bytes, ...] | None:
        try:
            frame = frame_at(self._file, self._kept[key].start, self._end)
            return None if frame is None else frame.parts(self._file)
        except OSError as error:
            raise JournalError(f"{self.path}: cannot be read: {error.strerror or error}") from error


def _is_ours(head: Mapping[str, Any]) -> bool:
    """Return whether the head of a frame has the fields and types that this journal writes."""
    names = ("run", "started", "key", "fingerprint") if "key" in head else ("run", "started")
    rows = head.get("failures", None if "key" in head else [])
    return (
        all(isinstance(head.get(name), str) for name in names)
        and isinstance(head.get("appends", ""), str)
        and isinstance(rows, list)
        and all(isinstance(row, list) and len(row) == 5 and all(isinstance(one, str) for one in row) for row in rows)
    )


def _identity(state: os.stat_result) -> tuple[int, int]:
    return state.st_dev, state.st_ino


def _identity_of(path: Path) -> tuple[int, int] | None:
    with suppress(FileNotFoundError, NotADirectoryError):
        return _identity(path.stat())
    return None
