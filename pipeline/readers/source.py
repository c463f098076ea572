"""The bytes of one record file and what lies beside it, wherever it comes from."""

from __future__ import annotations

import gzip
import hashlib
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from rockpulse.errors import RecordFormatError, RecordRefused

__all__ = [
    "FILE_LIMIT",
    "HEAD",
    "NotAcceleration",
    "SourceFile",
    "Unrecognised",
    "check_link",
    "folder_station_files",
    "open_source",
    "open_stream",
]

#: Bytes from the start of a file that decide its format.
HEAD = 65536
#: Largest file, or member of an archive, that is read [bytes]; a day of one channel at 200/s as text is half of it.
FILE_LIMIT = 256 * 1024**2

StationFiles = Callable[[], list[tuple[str, bytes]]]


class Unrecognised(RecordFormatError):
    """No reader knows the file: skipped in a folder, an error where it was named."""


class NotAcceleration(RecordRefused):
    """A velocity, displacement or spectrum: skipped in a folder, an error where it was named."""


@dataclass(frozen=True)
class SourceFile:
    """A file to be read.

    Attributes
    ----------
    name : str
        Path, or ``archive.zip!member``, as messages and `Record.source` show it.
    head : bytes
        The first `HEAD` bytes.
    load : callable
        Returns all bytes; called once, after a reader has recognised `head`.
    station_files : callable
        Returns (name, bytes) of the StationXML files in the same folder.
    """

    name: str
    head: bytes
    load: Callable[[], bytes]
    station_files: StationFiles = list

    @cached_property
    def content(self) -> bytes:
        """All bytes, decompressed."""
        return self.load()

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of `content`."""
        return hashlib.sha256(self.content).hexdigest()

    @property
    def path(self) -> PurePosixPath:
        """The last part of the name as a path, without ``.gz``."""
        path = PurePosixPath(self.name.replace("\\", "/").rpartition("!")[2])
        return path.with_suffix("") if path.suffix.lower() == ".gz" and path.stem else path


def folder_station_files(folder: Path) -> list[tuple[str, bytes]]:
    """(name, bytes) of the XML files in a folder, sorted by name."""
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() == ".xml" and path.is_file())
    return [(str(path), path.read_bytes()) for path in paths if path.stat().st_size <= FILE_LIMIT]


def check_link(path: Path) -> None:
    """Refuse a symbolic link whose target does not exist; the operating system would only say that `path` does not.

    Raises
    ------
    FileNotFoundError
        With the target.
    """
    if path.is_symlink() and not path.exists():
        raise FileNotFoundError(
            f"{path}: the symbolic link points nowhere, {path.readlink()} does not exist; mend the link or remove it"
        )


def open_source(path: Path, station_files: StationFiles | None = None) -> SourceFile:
    """Open a file on disk, plain or compressed with gzip.

    Parameters
    ----------
    path : Path
        File to read.
    station_files : callable, optional
        As in `SourceFile`; by default the folder of `path` is searched.

    Raises
    ------
    RecordFormatError
        If the file is empty, or is named ``.gz`` and is no sound gzip file.
    RecordRefused
        If it is larger than `FILE_LIMIT`, compressed or not (when the content is asked for).
    OSError
        As the operating system says.
    """
    check_link(path)
    compressed = path.suffix.lower() == ".gz"

    def take(count: int) -> bytes:
        if not compressed:
            with path.open("rb") as stream:
                return stream.read(count)
        try:
            with gzip.open(path, "rb") as stream:
                return stream.read(count)
        except (gzip.BadGzipFile, zlib.error, EOFError) as fault:
            raise RecordFormatError(f"{path}: damaged gzip file ({fault}); download it again") from fault

    def load() -> bytes:
        content = take(FILE_LIMIT + 1)
        if len(content) > FILE_LIMIT:
            raise RecordRefused(f"{path}: larger than {FILE_LIMIT} bytes, the most that is read; cut the record")
        return content

    head = take(HEAD)
    if not head:
        raise RecordFormatError(f"{path}: the file is empty; download it again")
    return SourceFile(str(path), head, load, station_files or (lambda: folder_station_files(path.parent)))


def open_stream(stream: BinaryIO) -> SourceFile:
    """An open binary file, or bytes in memory, read from where it stands.

    Parameters
    ----------
    stream : binary file
        ``open(path, "rb")``, ``io.BytesIO`` and the like; its ``name``, where it has one, tells where StationXML files
        may lie.

    Raises
    ------
    RecordFormatError
        If nothing is left to read.
    RecordRefused
        If more than `FILE_LIMIT` bytes are.
    """
    name = getattr(stream, "name", None)
    name = name if isinstance(name, str) else "stream"
    content = stream.read(FILE_LIMIT + 1)
    if len(content) > FILE_LIMIT:
        raise RecordRefused(f"{name}: larger than {FILE_LIMIT} bytes, the most that is read; cut the record")
    if not content:
        raise RecordFormatError(f"{name}: nothing left to read; is the stream at its end, or the file empty?")
    return SourceFile(name, content[:HEAD], lambda: content)
