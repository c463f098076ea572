"""The journal of a run: what is finished, durable as soon as it is, in one file beside the output.

The file is a sqlite database, ``results.h5.journal``, exclusively locked by the run that writes it; the lock goes with
the process, however it ends. It does not look into what it keeps.
"""

from __future__ import annotations

import os
import secrets
import sqlite3
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from types import TracebackType
from typing import Self

from rockpulse.errors import ResultsError
from rockpulse.failures import Failure
from rockpulse.storage.atomic_file import journal_path

__all__ = ["UNFINISHED", "Done", "Journal", "JournalError", "journal_path"]

#: Fingerprint of a task that broke off for want of its file or of memory, or by a fault of the program. No task has it:
#: a run that is resumed tries again.
UNFINISHED = ""

#: Marks a sqlite file as ours, in its header: "RPJ" and the version of the tables.
APPLICATION = int.from_bytes(b"RPJ\x02")
#: What sqlite is given at once [bytes]; a result may be larger, a value of sqlite may not take more than a billion.
PIECE = 64 * 1024**2
#: How long another run may take to begin or to end before it counts as being at work [s].
PATIENCE = 1.0
TABLES = """
    CREATE TABLE run (id TEXT NOT NULL, started TEXT NOT NULL);
    CREATE TABLE done (key TEXT PRIMARY KEY, fingerprint TEXT NOT NULL);
    CREATE TABLE part (key TEXT, number INTEGER, piece INTEGER, crc INTEGER NOT NULL, content BLOB NOT NULL,
        PRIMARY KEY (key, number, piece));
    CREATE TABLE failure (key TEXT, number INTEGER, file TEXT NOT NULL, stage TEXT NOT NULL, reason TEXT NOT NULL,
        kind TEXT NOT NULL, PRIMARY KEY (key, number));
"""


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


class Journal:
    """The finished tasks of a run, in a file; made by :meth:`open`, to be used in a ``with`` block.

    The `run_id` stays the same after the run is resumed.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, run_id: str) -> None:
        self.path = path
        self.run_id = run_id
        self._connection = connection
        self._file = _identity(path)

    @classmethod
    def open(cls, target: str | os.PathLike[str], resume: bool = False, overwrite: bool = False) -> Journal:
        """Create the journal of a run beside its output, or go on with one that was stopped, and lock it.

        With `resume` what a stopped run has finished is kept; where there is none a new run begins. Without it
        `overwrite` drops what a stopped run has finished.

        Raises
        ------
        JournalError
            For a journal that another process holds, one of a stopped run where neither `resume` nor `overwrite` says
            what is to become of it, a damaged or foreign file, or a place that cannot be written.
        """
        path = journal_path(target)
        _check_name(path)
        existed, locked = path.exists() and path.stat().st_size > 0, False
        try:
            connection = sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)
        except sqlite3.Error as error:
            raise JournalError(f"{path}: cannot open the journal of the run: {error}") from error
        try:
            opened = _identity(path)
            with _explained(path):
                _lock(connection)
                if opened is None or _identity(path) != opened:
                    raise JournalError(f"{path}: another run on this output has just ended; give the command again")
                locked = True
                if _is_empty(connection):
                    run_id = _create(connection)
                else:
                    _check_ours(connection, path)
                    run_id = _taken_up(connection, path, resume, overwrite)
        except BaseException:
            if locked and not existed:
                _unlink(path)
            connection.close()
            raise
        return cls(path, connection, run_id)

    @property
    def in_place(self) -> bool:
        """Whether the file is still the one that was opened; who removes it takes the finished records with it."""
        return self._file is not None and _identity(self.path) == self._file

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give the lock back; what is finished stays for a run that resumes."""
        self._connection.close()

    def remove(self) -> None:
        """Remove the file, as the output is complete, and close it; one that has taken its place stays."""
        if not self.in_place:
            self._connection.close()
        elif os.name == "posix":  # before the lock is given back, lest it be somebody else's; elsewhere one cannot
            _unlink(self.path)
            self._connection.close()
        else:
            self._connection.close()
            _unlink(self.path)

    def finished(self) -> dict[str, str]:
        """Fingerprint of each finished task, by key."""
        with _explained(self.path):
            return dict(self._connection.execute("SELECT key, fingerprint FROM done"))

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
        failures = [
            (done.key, number, *map(_in_utf8, (row.file, row.stage, row.reason, row.kind)))
            for number, row in enumerate(done.failures)
        ]
        pieces = (
            (done.key, number, piece, zlib.crc32(content), content)
            for number, part in enumerate(done.parts)
            for piece, content in enumerate(_pieces(part))
        )
        try:
            with _transaction(self._connection) as execute:
                for table in ("done", "part", "failure"):
                    execute(f"DELETE FROM {table} WHERE key = ?", (done.key,))
                for row in pieces:
                    execute("INSERT INTO part VALUES (?, ?, ?, ?, ?)", row)
                for failure in failures:
                    execute("INSERT INTO failure VALUES (?, ?, ?, ?, ?, ?)", failure)
                execute("INSERT INTO done VALUES (?, ?)", (done.key, done.fingerprint))
        except sqlite3.Error as error:
            raise JournalError(
                f"{self.path}: cannot keep the result of {done.key}: {error}; the {self._count()} finished before are "
                "kept: make room on the disk, then give the same command with --resume"
            ) from error

    def parts(self, key: str) -> tuple[bytes, ...]:
        """The parts of a finished task in their order; a JournalError where they are not as they were kept."""
        with _explained(self.path):
            query = "SELECT number, crc, content FROM part WHERE key = ? ORDER BY number, piece"
            found = self._connection.execute(query, (key,)).fetchall()
        if any(zlib.crc32(content) != crc for _, crc, content in found):
            raise _damaged(self.path, f"the result of {key} is not what was written")
        return tuple(_joined([row[2] for row in rows]) for _, rows in groupby(found, key=lambda row: row[0]))

    def drop_damaged(self) -> list[str]:
        """Forget the tasks whose results are not as they were kept, so that they are done again; their keys."""
        with _explained(self.path):
            rows = self._connection.execute("SELECT key, crc, content FROM part")
            damaged = sorted({key for key, crc, content in rows if zlib.crc32(content) != crc})
            with _transaction(self._connection) as execute:
                for key in damaged:
                    for table in ("done", "part", "failure"):
                        execute(f"DELETE FROM {table} WHERE key = ?", (key,))
        return damaged

    def failures(self) -> dict[str, tuple[Failure, ...]]:
        """The failures of each finished task that has some, by key."""
        found: dict[str, list[Failure]] = {}
        with _explained(self.path):
            query = "SELECT key, file, stage, reason, kind FROM failure ORDER BY key, number"
            for key, *row in self._connection.execute(query):
                found.setdefault(key, []).append(Failure(*row))
        return {key: tuple(rows) for key, rows in found.items()}

    def _count(self) -> int:
        return int(self._connection.execute("SELECT count(*) FROM done").fetchone()[0])


def _pieces(part: bytes) -> Iterator[memoryview]:
    """A part in pieces that sqlite takes; one piece of nothing for an empty part."""
    for start in range(0, max(len(part), 1), PIECE):
        yield memoryview(part)[start : start + PIECE]


def _joined(pieces: list[bytes]) -> bytes:
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def _identity(path: Path) -> tuple[int, int] | None:
    """Device and number of a file; None where there is none."""
    try:
        state = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return state.st_dev, state.st_ino


def _check_name(path: Path) -> None:
    """Whether the file system takes the names of the journal and of sqlite's own beside it, the longest of all."""
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            path.with_name(f"{path.name}-journal").lstat()
    except OSError as error:
        raise JournalError(
            f"{path}: cannot keep the journal of the run beside the output: {error.strerror}; choose another output"
        ) from error


def _unlink(path: Path) -> None:
    """Remove the database and sqlite's own journal of it."""
    path.unlink(missing_ok=True)
    path.with_name(f"{path.name}-journal").unlink(missing_ok=True)


def _lock(connection: sqlite3.Connection) -> None:
    """Take the lock before the mode that keeps it, in which of two runs that begin together neither would get it."""
    connection.execute("PRAGMA page_size = 65536")
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("BEGIN EXCLUSIVE")
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")  # from now on, beyond the transaction
    connection.execute("COMMIT")
    connection.execute("PRAGMA journal_mode = PERSIST")  # a tenth of the time of a commit that truncates or deletes it


def _is_empty(connection: sqlite3.Connection) -> bool:
    return not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]


def _create(connection: sqlite3.Connection) -> str:
    run_id = secrets.token_hex(16)
    with _transaction(connection) as execute:
        execute(f"PRAGMA application_id = {APPLICATION}")
        for statement in filter(str.strip, TABLES.split(";")):
            execute(statement)
        execute("INSERT INTO run VALUES (?, ?)", (run_id, f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"))
    return run_id


def _check_ours(connection: sqlite3.Connection, path: Path) -> None:
    found = connection.execute("PRAGMA application_id").fetchone()[0]
    if found == APPLICATION:
        return
    if found.to_bytes(4, signed=True)[:3] == APPLICATION.to_bytes(4)[:3]:
        raise JournalError(
            f"{path}: the journal of a run of another version of rockpulse; resume the run with that version, or "
            "remove the file"
        )
    raise JournalError(
        f"{path}: expected the journal of a run of rockpulse, found another database, which is left alone; choose "
        "another output"
    )


def _taken_up(connection: sqlite3.Connection, path: Path, resume: bool, overwrite: bool) -> str:
    """The id of the run in a journal that exists, or of a new one in its place."""
    run_id, started = connection.execute("SELECT id, started FROM run").fetchone()
    if resume:
        return str(run_id)
    count = connection.execute("SELECT count(*) FROM done").fetchone()[0]
    if count and not overwrite:
        raise JournalError(
            f"{path}: a run that began {started} was stopped with {count} record{'s' * (count != 1)} done; go on with "
            "--resume, or begin anew with --overwrite"
        )
    with _transaction(connection) as execute:
        for name in ("run", "done", "part", "failure"):
            execute(f"DROP TABLE {name}")
    connection.execute("VACUUM")
    return _create(connection)


@contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[Callable[..., sqlite3.Cursor]]:
    """All of it or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield connection.execute
    except BaseException:
        if connection.in_transaction:  # sqlite has rolled back by itself where the disk is full
            connection.execute("ROLLBACK")
        raise
    connection.execute("COMMIT")


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """The error of sqlite as one that tells the user what to do."""
    try:
        yield
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode == sqlite3.SQLITE_BUSY:
            raise JournalError(
                f"{path}: {_holder(path)} is writing this output; wait for it, or choose another output"
            ) from error
        raise JournalError(f"{path}: cannot use the journal of the run: {error}") from error
    except sqlite3.DatabaseError as error:
        if error.sqlite_errorcode == sqlite3.SQLITE_NOTADB:
            raise JournalError(
                f"{path}: expected the journal of a run of rockpulse, found another file, which is left alone; choose "
                "another output, or remove the file by hand"
            ) from error
        raise _damaged(path, str(error)) from error


def _damaged(path: Path, how: str) -> JournalError:
    return JournalError(f"{path}: the journal of the run is damaged ({how}); remove it and begin anew")


def _holder(path: Path) -> str:
    """The process that has locked a file, where the operating system tells."""
    table = Path("/proc/locks")
    if table.is_file():
        inode = str(path.stat().st_ino)
        for line in table.read_text(encoding="ascii").splitlines():
            # 1: POSIX ADVISORY WRITE <process> <device>:<device>:<inode> <first byte> <last byte>
            words = line.split()
            if "WRITE" in words and words[5].rpartition(":")[2] == inode and int(words[4]) > 0:
                return f"process {words[4]}"
    return "another process"


def _in_utf8(text: str) -> str:
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
