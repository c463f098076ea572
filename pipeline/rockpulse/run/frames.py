"""Named arrays as bytes, and frames in a file: a head of a few names and a body of bytes, each found and checked alone.

Whatever is damaged in a file of frames costs the frames that it is in, and no other one.
"""

import json
import math
import os
import struct
import zlib
from collections.abc import Mapping, Sequence
from io import FileIO
from typing import Any, NamedTuple

import numpy as np

#: What packed arrays begin with.
MAGIC = b"RPA1"
#: Kinds of numpy types that are packed: numbers and texts, nothing that could hold an object.
KINDS = "biufU"

#: What every frame begins with; the byte after the letters is the version.
MARK = b"\x89RPJ\x03\r\n\x1a"
#: The beginning of a frame: the mark, the bytes of the head, those of the body, and a CRC of both and of the head.
START = struct.Struct("<8sQQI")
#: Largest head [bytes].
HEAD = 64 * 1024**2
#: What is read at once where the beginning of a frame is looked for [bytes].
READ_AT_ONCE = 1024**2


def pack(arrays: Mapping[str, np.ndarray]) -> bytes:
    """Named arrays of numbers or texts as bytes, which :func:`unpack` reads without trusting them.

    Raises
    ------
    TypeError
        For an array of anything else.

    Notes
    -----
    ``RPA1``, the length of the header (8 bytes, little-endian), the header (JSON: name, numpy type, shape of each
    array), and the values in C order, one array after the other.

    Examples
    --------
    >>> unpack(pack({"a": np.arange(3.0), "b": np.array(["x", "yz"])}))["b"].tolist()
    ['x', 'yz']
    """
    for name, array in arrays.items():
        if array.dtype.kind not in KINDS:
            raise TypeError(f"{name}: expected numbers or texts, found an array of type {array.dtype}")
    text = json.dumps([(name, array.dtype.str, array.shape) for name, array in arrays.items()]).encode()
    return b"".join([MAGIC, len(text).to_bytes(8, "little"), text, *(array.tobytes() for array in arrays.values())])


def unpack(packed: bytes) -> dict[str, np.ndarray]:
    """The arrays of :func:`pack`, read-only; a ValueError for bytes that are something else."""
    begin = len(MAGIC) + 8
    if packed[: len(MAGIC)] != MAGIC or len(packed) < begin:
        raise ValueError("expected packed arrays, found other bytes")
    offset = begin + int.from_bytes(packed[len(MAGIC) : begin], "little")
    arrays = {}
    for name, kind, shape in json.loads(packed[begin:offset]):
        dtype = np.dtype(kind)
        if dtype.kind not in KINDS or not dtype.itemsize:
            raise ValueError(f"{name}: expected numbers or texts, found type {dtype}")
        count = math.prod(shape)
        size = count * dtype.itemsize
        if offset + size > len(packed):
            raise ValueError(f"{name}: expected {size} bytes of packed arrays, found {len(packed) - offset}")
        # A slice is a copy whose values lie where the processor likes them; nothing can be viewed in no bytes.
        values = np.frombuffer(packed[offset : offset + size], dtype) if size else np.zeros(count, dtype)
        arrays[name] = values.reshape(shape)
        offset += size
    if offset != len(packed):
        raise ValueError(f"expected {offset} bytes of packed arrays, found {len(packed)}")
    return arrays


class Frame(NamedTuple):
    """A frame whose head is as it was written; its body may not be."""

    head: dict[str, Any]
    body: int  # place of the body in the file
    sizes: tuple[tuple[int, int], ...]  # size and CRC of each part of the body as it was written

    @property
    def end(self) -> int:
        """Its place in the file."""
        return self.body + sum(size for size, _ in self.sizes)

    def parts(self, file: FileIO) -> tuple[bytes, ...] | None:
        """The parts of the body; None where they are not as they were written."""
        parts, place = [], self.body
        for size, crc in self.sizes:
            parts.append(_read(file, place, size))
            place += size
            if len(parts[-1]) != size or zlib.crc32(parts[-1]) != crc:
                return None
        return tuple(parts)


def append(file: FileIO, place: int, head: dict[str, Any], parts: Sequence[bytes]) -> Frame:
    """Write a frame at a place of a file; it is on the disk when this returns.

    An OSError where it cannot be written whole; nothing of it is left then.
    """
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
    return Frame(head, place + len(start) + len(text), sizes)


def frames_of(file: FileIO) -> tuple[list[Frame], int, int]:
    """All frames of a file whose heads are as they were written, in their order; the end of the last one; and the gaps.

    Gaps are places where a frame should begin and none does, other than one at the end that was cut off.
    """
    size = file.seek(0, os.SEEK_END)
    found: list[Frame] = []
    place = end = gaps = 0
    cut_off = True
    while place < size:
        if (frame := _frame(file, place, size)) is not None:
            gaps += place > end
            found.append(frame)
            place = end = frame.end
        else:
            cut_off = cut_off if place > end else _is_cut_off(file, place, size)
            place = _next_mark(file, place + 1, size)
    return found, end, gaps + (end < size and not cut_off)


def _frame(file: FileIO, place: int, size: int) -> Frame | None:
    """The frame that begins at a place, if one does and the file holds all of it."""
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
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):  # made by somebody else
        return None
    whole = all(part >= 0 for part, _ in sizes) and sum(part for part, _ in sizes) == body
    return Frame(head, begin, sizes) if whole else None


def _is_cut_off(file: FileIO, place: int, size: int) -> bool:
    """Whether a frame that is none begins as one whose end was never written."""
    start = _read(file, place, START.size)
    if len(start) < START.size:
        return start[: len(MARK)] == MARK[: len(start)]
    mark, length, body, _ = START.unpack(start)
    return mark == MARK and place + START.size + length + body > size


def _next_mark(file: FileIO, place: int, size: int) -> int:
    """Where the mark of a frame stands next, from a place on; the size of the file where it stands nowhere."""
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
    """Write all of it: the system takes no more than 2 GB at a time, and less where a disk or a limit is near."""
    left = memoryview(content)
    while left:
        left = left[file.write(left) :]


def _read(file: FileIO, place: int, size: int) -> bytes:
    """So many bytes from a place on, or as many as there are."""
    file.seek(place)
    pieces = []
    while size and (piece := file.read(size)):
        pieces.append(piece)
        size -= len(piece)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)
