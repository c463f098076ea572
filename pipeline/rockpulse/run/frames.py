"""Packs arrays into bytes, and stores them in files as frames: entries with a checksum that detects damage."""

import json
import math
import os
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from io import FileIO
from typing import Any, NamedTuple

import numpy as np

#: First bytes of packed arrays, and kinds of numpy types that can be packed: numbers and strings, no objects.
MAGIC, KINDS = b"RPA1", "biufU"
#: First bytes of a frame, with letters and a version byte.
MARK = b"\x89RPJ\x03\r\n\x1a"
#: Start of a frame: the first bytes, the sizes of head and body, and a checksum (CRC) of both sizes and of the head.
START = struct.Struct("<8sQQI")
#: Largest head, and size of the blocks that are read to find the start of a frame [bytes].
HEAD, READ_AT_ONCE = 64 * 1024**2, 1024**2


def pack(arrays: Mapping[str, np.ndarray]) -> bytes:
    """Convert named arrays of numbers or strings to bytes for :func:`unpack`; raise TypeError for other arrays.

    The bytes are ``RPA1``, the length of the header (8 bytes, little-endian), the header (JSON: name, numpy type and
    shape of each array), and the values in C order.
    """
    for name, array in arrays.items():
        if array.dtype.kind not in KINDS:
            raise TypeError(f"{name}: expected numbers or strings, found an array of type {array.dtype}")
    text = json.dumps([(name, array.dtype.str, array.shape) for name, array in arrays.items()]).encode()
    values = (np.ascontiguousarray(array).data for array in arrays.values())
    return b"".join([MAGIC, len(text).to_bytes(8, "little"), text, *values])


def unpack(packed: bytes) -> dict[str, np.ndarray]:
    """Return the arrays packed by :func:`pack`, read-only; raise ValueError for other bytes."""
    begin = len(MAGIC) + 8
    if packed[: len(MAGIC)] != MAGIC or len(packed) < begin:
        raise ValueError("expected packed arrays, found other bytes")
    offset = begin + int.from_bytes(packed[len(MAGIC) : begin], "little")
    arrays = {}
    for name, kind, shape in json.loads(packed[begin:offset]):
        dtype = np.dtype(kind)
        if dtype.kind not in KINDS or not dtype.itemsize:
            raise ValueError(f"{name}: expected numbers or strings, found type {dtype}")
        count = math.prod(shape)
        size = count * dtype.itemsize
        if offset + size > len(packed):
            raise ValueError(f"{name}: expected {size} bytes of packed arrays, found {len(packed) - offset}")
        # The slice is an aligned copy; frombuffer refuses empty bytes.
        values = np.frombuffer(packed[offset : offset + size], dtype) if size else np.zeros(count, dtype)
        arrays[name] = values.reshape(shape)
        offset += size
    if offset != len(packed):
        raise ValueError(f"expected {offset} bytes of packed arrays, found {len(packed)}")
    return arrays


class Frame(NamedTuple):
    """An entry (frame) of a file: a head in JSON whose checksum is correct, and a body of bytes that may be damaged."""

    start: int  # position in the file
    head: dict[str, Any]
    body: int  # position of the body in the file
    sizes: tuple[tuple[int, int], ...]  # size and CRC of each part of the body

    @property
    def end(self) -> int:
        """Position of the end of the frame in the file."""
        return self.body + sum(size for size, _ in self.sizes)

    def parts(self, file: FileIO) -> tuple[bytes, ...] | None:
        """Read the parts of the body; return None if a checksum is wrong."""
        parts, place = [], self.body
        for size, crc in self.sizes:
            parts.append(_read(file, place, size))
            place += size
            if len(parts[-1]) != size or zlib.crc32(parts[-1]) != crc:
                return None
        return tuple(parts)


def append(file: FileIO, place: int, head: dict[str, Any], parts: Sequence[bytes]) -> Frame:
    """Write a frame at a position of a file and flush it to disk; if writing fails, the file ends at this position."""
    sizes = tuple((len(part), zlib.crc32(part)) for part in parts)
    text = json.dumps({**head, "parts": sizes}).encode()
    body = sum(map(len, parts))
    start = START.pack(MARK, len(text), body, _crc(len(text), body, text))
    try:
        file.seek(place)
        for piece in (start + text, *parts):
            _write(file, piece)
        os.fsync(file.fileno())
    except OSError:
        file.truncate(place)
        raise
    return Frame(place, head, place + len(start) + len(text), sizes)


def read_frames(file: FileIO, take: Callable[[Frame], None]) -> tuple[int, int]:
    """Call `take` with each frame whose head is undamaged; return the end of the last one, and the damaged places."""
    size = file.seek(0, os.SEEK_END)
    place = end = gaps = 0
    cut_off = True
    while place < size:
        if (frame := frame_at(file, place, size)) is not None:
            gaps += place > end
            take(frame)
            place = end = frame.end
        else:
            cut_off = cut_off if place > end else _is_cut_off(file, place, size)
            place = _next_mark(file, place + 1, size)
    return end, gaps + (end < size and not cut_off)


def frame_at(file: FileIO, place: int, size: int) -> Frame | None:
    """Return the frame at a position of a file of a given size, or None if there is no complete frame."""
    start = _read(file, place, START.size)
    if len(start) < START.size or not start.startswith(MARK):
        return None
    _, length, body, crc = START.unpack(start)
    begin = place + START.size + length
    if length > HEAD or begin + body > size:
        return None
    text = _read(file, place + START.size, length)
    if _crc(length, body, text) != crc:
        return None
    try:
        head = json.loads(text)
        sizes = tuple((int(part), int(checksum)) for part, checksum in head.pop("parts"))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):  # written by another program
        return None
    whole = all(part >= 0 for part, _ in sizes) and sum(part for part, _ in sizes) == body
    return Frame(place, head, begin, sizes) if whole else None


def _is_cut_off(file: FileIO, place: int, size: int) -> bool:
    """Return whether a frame starts at a position but ends after the end of the file."""
    start = _read(file, place, START.size)
    if len(start) < START.size:
        return start[: len(MARK)] == MARK[: len(start)]
    mark, length, body, _ = START.unpack(start)
    return mark == MARK and place + START.size + length + body > size


def _next_mark(file: FileIO, place: int, size: int) -> int:
    """Return the position at which the next frame starts, or the size of the file."""
    while place < size:
        block = _read(file, place, READ_AT_ONCE)
        if (found := block.find(MARK)) >= 0:
            return place + found
        if len(block) < READ_AT_ONCE:
            break
        place += len(block) - len(MARK) + 1
    return size


def _crc(length: int, body: int, text: bytes) -> int:
    return zlib.crc32(text, zlib.crc32(struct.pack("<QQ", length, body)))


def _write(file: FileIO, content: bytes) -> None:
    """Write all bytes, in several calls if necessary, as the system writes at most 2 GB at a time."""
    left = memoryview(content)
    while left:
        left = left[file.write(left) :]


def _read(file: FileIO, place: int, size: int) -> bytes:
    file.seek(place)
    pieces = []
    while size and (piece := file.read(size)):
        pieces.append(piece)
        size -= len(piece)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)
