"""A file that one process at a time has open; the system gives the lock back with the process, however it ends."""

from __future__ import annotations

import os
import sys
import time
from io import FileIO
from pathlib import Path

__all__ = ["holder", "open_locked"]

#: How long another process may take to begin or to end before it counts as being at work [s].
PATIENCE = 1.0
#: How long is waited before the lock is asked for again [s].
PAUSE = 0.02

if sys.platform == "win32":
    import msvcrt

    def _lock(file: FileIO) -> None:
        """Lock a byte that no file has, for what is locked cannot be read here."""
        file.seek(2**62)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(file: FileIO) -> None:
        """Lock the file as it was opened: another opening of it, by whatever process, neither has nor ends the lock."""
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def open_locked(path: Path) -> FileIO | None:
    """A file opened to be read and written, made where there is none, and locked; None where another process has it.

    An OSError where it cannot be opened, or the file system has no locks.
    """
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
    """The process that has locked a file, where the operating system tells."""
    table = Path("/proc/locks")
    if table.is_file():
        inode = str(path.stat().st_ino)
        for line in table.read_text(encoding="ascii").splitlines():
            # 1: FLOCK ADVISORY WRITE <process> <device>:<device>:<inode> <first byte> <last byte>
            words = line.split()
            if "WRITE" in words and words[5].rpartition(":")[2] == inode and int(words[4]) > 0:
                return f"process {words[4]}"
    return "another process"
