"""Numbers in text files: lines, fixed-width blocks, blank-separated blocks, and the messages when they are wrong."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from rockpulse.errors import RecordFormatError

__all__ = ["check_count", "fixed_width", "free_numbers", "free_rows", "printed_number", "text_lines"]

_NUMBER_BYTES = b" \t0123456789+-.eEdD"
_FORTRAN_EXPONENT = bytes.maketrans(b"dD", b"ee")
_FORTRAN_EXPONENT_TEXT = str.maketrans("dD", "ee")
#: Characters of the longest exponent of a number, its sign included.
_EXPONENT_DIGITS = 4
_NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eEdD][+-]?\d+)?\s*", re.ASCII)


def text_lines(content: bytes) -> list[str]:
    """Lines of an engineering text file, at least one; it may come from any agency and decade.

    Text that is no UTF-8 is taken as Latin-1, which maps every byte to a character: no degree sign or Turkish name in a
    header stops the reading. Lines end in LF, CRLF or a lone CR; blank lines and Ctrl-Z at the end are left out.
    """
    content = content.rstrip(b"\x1a\x00 \t\r\n").replace(b"\r\n", b"\n")
    if b"\r" in content:
        content = b"\n".join(line.rstrip(b"\r") for line in content.split(b"\n")).replace(b"\r", b"\n")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return text.split("\n")


def printed_number(text: str) -> tuple[float, float]:
    """Value of a printed number and half a unit of its last digit; NaN and 0 for one that is beyond all numbers.

    Examples
    --------
    >>> printed_number("3.91E+1")
    (39.1, 0.05)
    """
    mantissa, _, exponent = text.strip().lower().replace("d", "e").partition("e")
    decimals = len(mantissa.partition(".")[2])
    value = float(text.lower().replace("d", "e"))
    # int() takes no thousands of digits.
    if not np.isfinite(value) or len(exponent) > _EXPONENT_DIGITS:
        return float("nan"), 0.0
    return value, float(f"5e{int(exponent or 0) - decimals - 1}")


def check_count(where: str, declared: int, available: int, unit: str = "samples") -> None:
    """Compare a declared count with what the file can hold, before anything is allocated.

    Raises RecordFormatError if fewer are available than declared, or none is declared.
    """
    if declared < 1:
        raise RecordFormatError(f"{where}: expected a positive number of {unit} in the header, found {declared}")
    if available < declared:
        raise RecordFormatError(
            f"{where}: expected {declared} {unit} (header), found {available}; "
            "the file may be truncated: download it again"
        )


def _to_float(fields: Sequence[bytes] | np.ndarray, where: str, located: Iterator[tuple[int, str]]) -> np.ndarray:
    """Convert all fields at once, and look for the damaged one only if that fails."""
    try:
        values = np.array(fields, dtype=float)
    except ValueError:
        values = np.array([np.nan])
    if np.all(np.isfinite(values)):
        return values
    for line, field in located:
        if not _NUMBER.fullmatch(field) or not np.isfinite(float(field.translate(_FORTRAN_EXPONENT_TEXT))):
            raise RecordFormatError(
                f"{where}:{line}: expected a finite number, found {field.strip()[:40] or 'a blank field'!r}; "
                "repair the line or download the file again"
            )
    raise RecordFormatError(f"{where}: the numbers cannot be converted; download the file again")


def _plain_ascii(text: str) -> bytes:
    """The text as bytes, one for each character; a character beyond ASCII cannot become part of a number."""
    return text.encode("ascii", errors="replace")


def fixed_width(lines: Sequence[str], first: int, width: int, per_row: int, count: int, where: str) -> np.ndarray:
    """The first `count` numbers in columns of equal width, touching or not; surplus rows are left alone.

    `lines[0]` is line `first` of the file `where`, from 1. Raises RecordFormatError for too few numbers, a row of
    another length, or a field that is no finite number.
    """
    if width < 1 or per_row < 1:
        raise RecordFormatError(
            f"{where}: expected fields of at least 1 character, at least 1 in a row, found {per_row} of {width} from "
            f"line {first} on; the header is damaged: download the file again"
        )
    rows = max(-(-count // per_row), 0)
    block = [row.rstrip() for row in lines[:rows]]
    _check_rows(block, first, width, per_row, count, where)
    text = "".join(block)[: count * width]
    joined = _plain_ascii(text)
    located = ((first + index // per_row, text[index * width : (index + 1) * width]) for index in range(count))
    if joined.translate(None, _NUMBER_BYTES):
        fields: np.ndarray = np.array([b"nan"])
    else:
        fields = np.frombuffer(joined.translate(_FORTRAN_EXPONENT), dtype=f"S{width}")
    return _to_float(fields, where, located)


def _check_rows(block: Sequence[str], first: int, width: int, per_row: int, count: int, where: str) -> None:
    """Report a row whose length does not fit its fields or their number; rows come without blanks at the end."""
    rows = -(-count // per_row)
    full = width * per_row
    for index, row in enumerate(block):
        if index == len(block) - 1:
            # The end of a truncated file.
            available = index * per_row + -(-len(row) // width)
            check_count(f"{where}:{first + len(block)}", count, available, "numbers")
        last = index == rows - 1
        fields = count - index * per_row if last else per_row
        if len(row) > full or (len(row) < fields * width if last else len(row) != full):
            raise RecordFormatError(
                f"{where}:{first + index}: expected {fields} fields of {width} characters, found a row of {len(row)} "
                "characters; the line is damaged: download the file again"
            )
    if not block:
        check_count(f"{where}:{first}", count, 0, "numbers")


def free_numbers(lines: Sequence[str], first: int, where: str) -> np.ndarray:
    """Numbers separated by blanks, any count per row, as one array (n,); RecordFormatError for a field that is none.

    `lines[0]` is line `first` of the file `where`, from 1.
    """
    joined = _plain_ascii("\n".join(lines))
    located = ((first + index, field) for index, line in enumerate(lines) for field in line.split())
    if joined.translate(None, _NUMBER_BYTES + b"\n\r\f\v"):
        return _to_float([b"nan"], where, located)
    return _to_float(joined.translate(_FORTRAN_EXPONENT).split() or np.empty(0), where, located)


def free_rows(lines: Sequence[str], first: int, columns: int, where: str) -> np.ndarray:
    """Rows of numbers separated by blanks as an array (rows, columns).

    Raises RecordFormatError for a row of another length and a field that is no finite number.
    """
    counts = [len(line.split()) for line in lines]
    if counts.count(columns) != len(counts):
        row = next(index for index, count in enumerate(counts) if count != columns)
        raise RecordFormatError(
            f"{where}:{first + row}: expected a row of {columns}, found {lines[row][:60].strip()!r}; "
            "the line is damaged: download the file again"
        )
    return free_numbers(lines, first, where).reshape(-1, columns)
