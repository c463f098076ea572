"""The bytes of a record file and the station metadata in its folder, from a disk, an archive or a stream."""

import codecs
import gzip
import hashlib
import io
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
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


def _folder_file(folder: Path) -> Neighbour:
    """Return a function that reads a file of a folder by name; it returns None for missing or too large files."""

    def content(name: str) -> bytes | None:
        path = folder / name
        return path.read_bytes() if path.is_file() and path.stat().st_size <= FILE_LIMIT else None

    return content


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
    stations, beside = station_files or (lambda: folder_station_files(path.parent)), _folder_file(path.parent)
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
    if not Path(name).is_file():
        return SourceFile(name, content[:HEAD], lambda: content)
    folder, head = Path(name).parent, content[:HEAD]
    return SourceFile(name, head, lambda: content, lambda: folder_station_files(folder), beside=_folder_file(folder))
