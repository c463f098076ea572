"""Opens record files and the station metadata beside them: files on disk, members of zip archives, and streams."""

import codecs
import gzip
import hashlib
import io
import lzma
import re
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from itertools import pairwise
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.files import check_regular

#: Number of bytes at the start of a file from which its format is recognised.
HEAD = 65536
#: Largest file, or member of an archive, that is read [bytes]: twice the text of one day at 200 samples per second.
FILE_LIMIT = 256 * 1024**2
#: Largest compression ratio of a file that is read; text of numbers reaches 10, a silent channel 100.
RATIO_LIMIT = 500
#: Largest number of members of an archive; an archive with more is rejected.
MEMBER_LIMIT = 100_000
#: Largest total size of the members of an archive [bytes]; a larger archive is rejected.
TOTAL_LIMIT = 2 * 1024**3
_LOCAL_HEADER = 30  # bytes of a member's local header before its name
_NESTED = (".zip", ".gz", ".tgz", ".tar", ".bz2", ".xz", ".7z", ".rar", ".zst")
_GZIP = b"\x1f\x8b\x08"
#: First bytes of files that contain other files.
_ARCHIVES = {
    "a zip archive": (b"PK\x03\x04", b"PK\x05\x06"),
    "a gzip file": (_GZIP,),
    "a bzip2 file": (b"BZh",),
    "an xz file": (b"\xfd7zXZ\x00",),
    "a 7z archive": (b"7z\xbc\xaf\x27\x1c",),
    "a rar archive": (b"Rar!\x1a\x07",),
    "a zstd file": (b"\x28\xb5\x2f\xfd",),
}
_TAR_MARK = 257
#: Pattern of a word, and number of bytes at the start of a file in which a word indicates a header.
_WORD, _TOP = re.compile(rb"[A-Za-z]{3}"), 1000
#: Beginnings of the name of the first member of zip files that are office documents, not archives of records.
_DOCUMENTS = (b"[Content_Types].xml", b"mimetype", b"docProps/", b"_rels/", b"xl/")
_FIRST_NAME = 30
#: Suffixes of files of station metadata.
_STATION_FILES = (".xml", ".dataless", ".dless")
StationFiles = Callable[[], list[tuple[str, bytes]]]
Neighbour = Callable[[str], bytes | None]


class Unrecognised(RecordFormatError):
    """Error: no reader recognises the file, which may contain a record; it is always reported as "failed"."""


class NoRecord(Unrecognised):
    """Error: no reader recognises the file, which is probably not a record; it is skipped unless the user named it."""


class NotAcceleration(RecordRefused):
    """Error: the file contains velocity, displacement or spectra; it is skipped unless the user named it."""


class OtherKind(NotAcceleration):
    """Error: the file name indicates velocity or displacement; the file is skipped even if the user named it."""


class TableOfResults(NoRecord):
    """Error: the file is a table of results or parameters; it is skipped even if the user named it."""


@dataclass(frozen=True)
class SourceFile:
    """A file to be read, from a disk, an archive or a stream."""

    name: str  # path, or archive.zip!member, as messages and `Record.source` show it
    head: bytes  # the first `HEAD` bytes
    load: Callable[[], bytes]  # returns all bytes, decompressed; called once, after a reader has recognised `head`
    station_files: StationFiles = list  # returns name and bytes of the StationXML files in the same folder
    chosen: bool = False  # whether the caller named the StationXML files, so that their names do not matter
    beside: Neighbour = lambda name: None  # returns the bytes of a file in the same folder; None if missing

    def __post_init__(self) -> None:
        object.__setattr__(self, "head", _plain_text(self.head, self._coding))

    @cached_property
    def _coding(self) -> str:
        """Return the encoding given by a byte-order mark; empty without a mark, and for binary data."""
        if self.head.startswith(codecs.BOM_UTF8):
            return "utf-8-sig"
        if not self.head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            return ""
        try:
            text = codecs.getincrementaldecoder("utf-16")().decode(self.head)
        except UnicodeDecodeError:
            return ""
        return "" if "\x00" in text else "utf-16"

    @cached_property
    def _bytes(self) -> bytes:
        return self.load()

    @cached_property
    def content(self) -> bytes:
        """Return all bytes; text of a known encoding is converted to UTF-8."""
        return _plain_text(self._bytes, self._coding)

    @cached_property
    def sha256(self) -> str:
        """Return the SHA-256 of the decompressed file as it is stored, before any change of encoding."""
        return hashlib.sha256(self._bytes).hexdigest()

    def first_half(self) -> "SourceFile | None":
        """Return the first half of a file if it contains words and the second half repeats it; otherwise None."""
        half, odd = divmod(len(self.content), 2)
        begins = min(half, HEAD)
        if odd or not _WORD.search(self.content, 0, _TOP) or not self.content.startswith(self.content[:begins], half):
            return None
        first = self.content[:half]
        if not self.content.endswith(first):
            return None
        return replace(self, head=first[:HEAD], load=lambda: first)

    @property
    def path(self) -> PurePosixPath:
        """Return the path of the file, or of the member within its archive, without ``.gz``."""
        path = PurePosixPath(self.name.replace("\\", "/").rpartition("!")[2])
        return path.with_suffix("") if path.suffix.lower() == ".gz" and path.stem else path


def _plain_text(content: bytes, coding: str) -> bytes:
    return content.decode(coding, errors="replace").encode() if coding else content


def archive_kind(head: bytes) -> str:
    """Return the kind of archive from the first bytes, such as "a zip archive"; empty for other files."""
    length = int.from_bytes(head[_FIRST_NAME - 4 : _FIRST_NAME - 2], "little")
    first = head[_FIRST_NAME : _FIRST_NAME + length]
    if head.startswith(b"PK\x03\x04") and (first.startswith(_DOCUMENTS) or first.endswith(b".npy")):
        return ""
    if head[_TAR_MARK : _TAR_MARK + 5] == b"ustar":
        return "a tar archive"
    return next((kind for kind, marks in _ARCHIVES.items() if head.startswith(marks)), "")


def _refuse_archive(name: str, head: bytes, inside: str = "") -> None:
    kind = archive_kind(head)
    if kind == "a zip archive" and not inside:
        advice = "read it with rockpulse.read_all, or give it to 'rockpulse assess' or 'rockpulse convert'"
        raise RecordRefused(f"{name}: a zip archive may hold many records; {advice}")
    if kind:
        raise RecordRefused(f"{name}: {kind}{inside}; unpack it first")


def _unpack(name: str, packed: BinaryIO, size: int, count: int) -> bytes:
    """Return the first `count` bytes of a gzip file after decompression; `size` is its compressed size."""
    most = RATIO_LIMIT * max(size, 1)
    try:
        with gzip.open(packed, "rb") as stream:
            content = stream.read(min(count, most + 1))
    except (gzip.BadGzipFile, zlib.error, EOFError) as fault:
        raise RecordFormatError(f"{name}: damaged gzip file ({fault}); download it again") from fault
    if len(content) > most:
        raise RecordRefused(
            f"{name}: its compression ratio is above the limit of {RATIO_LIMIT}; unpack it by hand if it is a record"
        )
    return content


def _check_size(name: str, content: bytes) -> bytes:
    if len(content) > FILE_LIMIT:
        raise RecordRefused(f"{name}: expected a file of at most {FILE_LIMIT} bytes; shorten the record")
    return content


def folder_station_files(folder: Path) -> list[tuple[str, bytes]]:
    """Return the name and the content of each XML or dataless SEED file in a folder, sorted by name."""
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in _STATION_FILES and path.is_file())
    return [(str(path), path.read_bytes()) for path in paths if path.stat().st_size <= FILE_LIMIT]


def _folder_file(folder: Path, name: str) -> bytes | None:
    """Return the content of a file in a folder; None if it is missing or too large."""
    path = folder / name
    return path.read_bytes() if path.is_file() and path.stat().st_size <= FILE_LIMIT else None


def check_link(path: Path) -> None:
    """Raise FileNotFoundError, with the name of the target, if a symbolic link leads to a missing file."""
    if path.is_symlink() and not path.exists():
        found = f"the target of the symbolic link, {path.readlink()}, does not exist"
        raise FileNotFoundError(f"{path}: {found}; correct the link or remove it")


def open_source(path: Path, station_files: StationFiles | None = None) -> SourceFile:
    """Open a file on disk, plain or compressed with gzip; by default, station files are read from its folder."""
    name = str(path)
    check_link(path)
    if path.is_dir():
        advice = "read it with rockpulse.read_all, or name a file in it"
        raise IsADirectoryError(f"{name}: a folder; {advice}")
    check_regular(path, RecordRefused)
    with path.open("rb") as stream:
        compressed = stream.read(len(_GZIP)) == _GZIP

    def take(count: int) -> bytes:
        with path.open("rb") as stream:
            return _unpack(name, stream, path.stat().st_size, count) if compressed else stream.read(count)

    head = take(HEAD)
    if not head:
        raise RecordFormatError(f"{name}: the file is empty; download it again")
    _refuse_archive(name, head, " in a gzip file" if compressed else "")
    stations, beside = station_files or partial(folder_station_files, path.parent), partial(_folder_file, path.parent)
    return SourceFile(name, head, lambda: _check_size(name, take(FILE_LIMIT + 1)), stations, beside=beside)


def open_stream(stream: BinaryIO) -> SourceFile:
    """Open a binary file object or bytes, plain or compressed with gzip, from the current position."""
    if not hasattr(stream, "read"):
        raise TypeError(f"expected a path or an open binary file, found {type(stream).__name__}")
    name = getattr(stream, "name", None)
    name = name if isinstance(name, str) else "stream"
    content = b""
    while len(content) <= FILE_LIMIT:  # a pipe may return fewer bytes than requested
        part = stream.read(FILE_LIMIT + 1 - len(content))
        if not isinstance(part, bytes):
            found = f"found one that gives {type(part).__name__}"
            raise TypeError(f"{name}: expected a file opened in binary mode, open(path, 'rb'), {found}")
        if not part:
            break
        content += part
    compressed = _check_size(name, content).startswith(_GZIP)
    if compressed:
        content = _check_size(name, _unpack(name, io.BytesIO(content), len(content), FILE_LIMIT + 1))
    if not content:
        raise RecordFormatError(f"{name}: nothing left to read; is the stream at its end, or the file empty?")
    _refuse_archive(name, content[:HEAD], " in a gzip file" if compressed else "")
    found = SourceFile(name, content[:HEAD], lambda: content)
    if not Path(name).is_file():
        return found
    folder = Path(name).parent
    stations, beside = partial(folder_station_files, folder), partial(_folder_file, folder)
    return replace(found, station_files=stations, beside=beside)


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
