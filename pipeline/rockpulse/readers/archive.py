"""Reads the members of a zip archive in memory, without writing to disk."""

import lzma
import re
import zipfile
import zlib
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path, PurePosixPath

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers.source import FILE_LIMIT, HEAD, RATIO_LIMIT, SourceFile, archive_kind

#: Largest number of members of an archive; an archive with more is rejected.
MEMBER_LIMIT = 100_000
#: Largest total size of the members of an archive [bytes]; a larger archive is rejected.
TOTAL_LIMIT = 2 * 1024**3
_LOCAL_HEADER = 30  # bytes of a member's local header before its name
_NESTED = (".zip", ".gz", ".tgz", ".tar", ".bz2", ".xz", ".7z", ".rar", ".zst")


def is_archive(path: Path) -> bool:
    """Return whether a file is a zip archive, judged by its first bytes or its name; office documents are excluded."""
    if path.suffix.lower() == ".zip":
        return True
    with path.open("rb") as stream:
        return archive_kind(stream.read(HEAD)) == "a zip archive"


class Archive:
    """An open zip archive of records; use it in a ``with`` block or close it. Unsafe archives are rejected."""

    def __init__(self, path: Path) -> None:
        try:
            # zipfile raises NotImplementedError for a feature or a compression that it does not support.
            self._archive = zipfile.ZipFile(path)
        except (zipfile.BadZipFile, NotImplementedError, ValueError) as fault:
            raise RecordFormatError(f"{path}: damaged zip archive ({fault}); download it again") from fault
        entries = sorted((entry for entry in self._archive.infolist() if not entry.is_dir()), key=lambda e: e.filename)
        try:
            _check_entries(str(path), entries)
        except RecordRefused:
            self.close()
            raise
        self._station_files = lru_cache(maxsize=16)(partial(_station_files, self._archive, entries))
        by_name = {entry.filename: entry for entry in entries}
        self._beside = lru_cache(maxsize=16)(partial(_beside, self._archive, by_name))
        self._entries = [entry for entry in entries if not _hidden(entry.filename)]
        self.names = [f"{path}!{entry.filename}" for entry in self._entries]

    def __enter__(self) -> "Archive":
        return self

    def __exit__(self, *fault: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the archive."""
        self._archive.close()

    def member(self, number: int) -> SourceFile:
        """Return the member with this index in `names`, unpacked in memory."""
        entry, name = self._entries[number], self.names[number]
        content = _content(self._archive, entry, name)
        folder = PurePosixPath(entry.filename).parent
        stations, beside = partial(self._station_files, folder), partial(self._beside, folder)
        return SourceFile(name, content[:HEAD], partial(bytes, content), stations, beside=beside)


def _check_entries(path: str, entries: list[zipfile.ZipInfo]) -> None:
    """Raise an error if an archive has too many members or bytes, or if its members overlap, as in a zip bomb."""
    if len(entries) > MEMBER_LIMIT:
        raise RecordRefused(f"{path}: {len(entries)} members, expected at most {MEMBER_LIMIT}; split the archive")
    total = sum(entry.file_size for entry in entries)
    if total > TOTAL_LIMIT:
        raise RecordRefused(f"{path}: {total} bytes in all members, expected at most {TOTAL_LIMIT}; split the archive")
    by_place = sorted(entries, key=lambda entry: entry.header_offset)
    for entry, following in pairwise(by_place):
        if entry.header_offset + _LOCAL_HEADER + entry.compress_size > following.header_offset:
            both = f"{entry.filename} and {following.filename}"
            raise RecordRefused(f"{path}: the members {both} overlap in the archive; create the archive again")


def _hidden(name: str) -> bool:
    parts = PurePosixPath(name.replace("\\", "/")).parts
    return "__MACOSX" in parts or any(part.startswith(".") and part != ".." for part in parts)


def _content(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str) -> bytes:
    inside = entry.filename.replace("\\", "/")
    if inside.startswith("/") or re.match(r"[A-Za-z]:", inside) or ".." in inside.split("/"):
        raise RecordRefused(f"{name}: the name points to a folder outside the archive; create the archive again")
    if inside.lower().endswith(_NESTED):
        raise RecordRefused(f"{name}: an archive or compressed file inside the archive; unpack the outer one first")
    if entry.flag_bits & 0x1:
        raise RecordRefused(f"{name}: encrypted; unpack the archive with its password first")
    if entry.file_size > FILE_LIMIT:
        raise RecordRefused(f"{name}: {entry.file_size} bytes, expected at most {FILE_LIMIT}; shorten the record")
    if entry.file_size > RATIO_LIMIT * entry.compress_size:
        found = f"its compression ratio is {entry.file_size / max(entry.compress_size, 1):.0f}, above the limit"
        raise RecordRefused(f"{name}: {found} of {RATIO_LIMIT}; unpack it by hand if it is a record")
    try:
        with archive.open(entry) as stream:
            # The declared size limits the read, even if the compressed data would expand further.
            content = stream.read(entry.file_size + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError, lzma.LZMAError) as fault:
        # RuntimeError includes NotImplementedError, raised for a compression that zipfile does not support.
        found = f"damaged member, or a compression method that is not supported ({fault})"
        raise RecordFormatError(f"{name}: {found}; download the archive again") from fault
    if not content:
        raise RecordFormatError(f"{name}: the file is empty; download the archive again")
    kind = archive_kind(content)
    if kind:
        raise RecordRefused(f"{name}: {kind} inside the archive; unpack the outer one first")
    return content


def _station_files(
    archive: zipfile.ZipFile, entries: list[zipfile.ZipInfo], folder: PurePosixPath
) -> list[tuple[str, bytes]]:
    """Return the name and the content of each XML file in a folder of the archive."""
    xml = (entry for entry in entries if entry.filename.lower().endswith(".xml"))
    beside = (entry for entry in xml if PurePosixPath(entry.filename).parent == folder)
    named = ((f"{archive.filename}!{entry.filename}", entry) for entry in beside)
    return [(name, _content(archive, entry, name)) for name, entry in named]


def _beside(
    archive: zipfile.ZipFile, entries: dict[str, zipfile.ZipInfo], folder: PurePosixPath, name: str
) -> bytes | None:
    wanted = str(folder / name)
    return _content(archive, entries[wanted], f"{archive.filename}!{wanted}") if wanted in entries else None
