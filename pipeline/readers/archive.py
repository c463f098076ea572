"""Members of a zip archive, read in memory: nothing is written to disk."""

from __future__ import annotations

import lzma
import re
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from rockpulse.errors import RecordFormatError, RecordRefused, RockpulseError
from rockpulse.readers.source import FILE_LIMIT, HEAD, SourceFile

__all__ = ["MEMBER_LIMIT", "RATIO_LIMIT", "is_archive", "members"]

#: An archive with more members is refused.
MEMBER_LIMIT = 100_000
#: Members that were compressed more than this are refused; text of numbers reaches 10, a silent channel 100.
RATIO_LIMIT = 500

_NESTED = (".zip", ".gz", ".tgz", ".tar", ".bz2", ".xz", ".7z", ".rar", ".zst")


def is_archive(path: Path) -> bool:
    """Whether a file is a zip archive, by its first bytes or its name."""
    if path.suffix.lower() == ".zip":
        return True
    with path.open("rb") as stream:
        return stream.read(4) == b"PK\x03\x04"


def members(path: Path) -> Iterator[tuple[str, SourceFile | RockpulseError]]:
    """The record files of an archive, in order of their names.

    Parameters
    ----------
    path : Path
        A zip archive.

    Yields
    ------
    name : str
        ``archive.zip!member``.
    file : SourceFile or RockpulseError
        The member, or why it is not read: a name that leaves the archive, an archive in the archive, a member larger
        than `FILE_LIMIT` or compressed more than `RATIO_LIMIT`, encryption, damage.

    Raises
    ------
    RecordFormatError
        If the archive itself cannot be opened.
    OSError
        As the operating system says.
    """
    try:
        # NotImplementedError is how zipfile names a feature or a compression that it does not know.
        archive = zipfile.ZipFile(path)
    except (zipfile.BadZipFile, NotImplementedError, ValueError) as fault:
        raise RecordFormatError(f"{path}: damaged zip archive ({fault}); download it again") from fault
    with archive:
        entries = sorted((entry for entry in archive.infolist() if not entry.is_dir()), key=lambda e: e.filename)
        if len(entries) > MEMBER_LIMIT:
            raise RecordRefused(f"{path}: {len(entries)} members, the most that is read is {MEMBER_LIMIT}; split it")
        for entry in entries:
            name = f"{path}!{entry.filename}"
            if _hidden(entry.filename):
                continue
            try:
                content = _content(archive, entry, name)
            except RockpulseError as fault:
                yield name, fault
                continue
            yield name, _member(archive, entries, entry, name, content)


def _hidden(name: str) -> bool:
    parts = PurePosixPath(name.replace("\\", "/")).parts
    return "__MACOSX" in parts or any(part.startswith(".") and part != ".." for part in parts)


def _content(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str) -> bytes:
    inside = entry.filename.replace("\\", "/")
    if inside.startswith("/") or re.match(r"[A-Za-z]:", inside) or ".." in inside.split("/"):
        raise RecordRefused(f"{name}: the name leads out of the archive; make the archive anew")
    if inside.lower().endswith(_NESTED):
        raise RecordRefused(f"{name}: an archive or compressed file inside the archive; unpack the outer one first")
    if entry.flag_bits & 0x1:
        raise RecordRefused(f"{name}: encrypted; unpack the archive with its password first")
    if entry.file_size > FILE_LIMIT:
        raise RecordRefused(f"{name}: {entry.file_size} bytes, the most that is read is {FILE_LIMIT}")
    if entry.file_size > RATIO_LIMIT * max(entry.compress_size, 1):
        raise RecordRefused(
            f"{name}: compressed {entry.file_size / max(entry.compress_size, 1):.0f} times, the limit is "
            f"{RATIO_LIMIT}; unpack it by hand if it is a record"
        )
    try:
        with archive.open(entry) as stream:
            # The declared size bounds the read, whatever the compressed data would expand to.
            content = stream.read(entry.file_size + 1)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        NotImplementedError,
        RuntimeError,
        ValueError,
        lzma.LZMAError,
    ) as fault:
        raise RecordFormatError(
            f"{name}: damaged member, or one packed in an unknown way ({fault}); download the archive again"
        ) from fault
    if not content:
        raise RecordFormatError(f"{name}: the file is empty; download the archive again")
    return content


def _member(
    archive: zipfile.ZipFile, entries: list[zipfile.ZipInfo], entry: zipfile.ZipInfo, name: str, content: bytes
) -> SourceFile:
    folder = PurePosixPath(entry.filename).parent

    def station_files() -> list[tuple[str, bytes]]:
        beside = [
            other
            for other in entries
            if other.filename.lower().endswith(".xml") and PurePosixPath(other.filename).parent == folder
        ]
        return [(f"{archive.filename}!{other.filename}", _content(archive, other, other.filename)) for other in beside]

    return SourceFile(name, content[:HEAD], lambda: content, station_files)
