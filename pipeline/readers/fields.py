"""Numbers in text files: lines, fixed-width blocks, blank-separated blocks, and the messages when they are wrong."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from rockpulse.errors import RecordFormatError

__all__ = ["check_count", "fixed_width", "free_numbers", "printed_number", "text_lines"]

_NUMBER_BYTES = b" \t0123456789+-.eEdD"
_FORTRAN_EXPONENT = bytes.maketrans(b"dD", b"ee")
_FORTRAN_EXPONENT_TEXT = str.maketrans("dD", "ee")
_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?\s*", re.ASCII)


def text_lines(content: bytes) -> list[str]:
    """Lines of an engineering text file, which may come from any agency and decade.

    Latin-1 maps every byte to a character, so no degree sign or Turkish name in a header stops the reading.
    """
    text = content.decode("latin-1").rstrip("\x1a\x00")
    lines = re.split(r"\r*\n|\r", text)
    while lines and not lines[-1].strip():
        lines.pop()
    return lines


def printed_number(text: str) -> tuple[float, float]:
    """Value of a printed number and half a unit of its last digit.

    Examples
    --------
    >>> printed_number("3.91E+1")
    (39.1, 0.05)
    """
    mantissa, _, exponent = text.strip().lower().replace("d", "e").partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(text.lower().replace("d", "e")), float(f"5e{int(exponent or 0) - decimals - 1}")


def check_count(where: str, declared: int, available: int, unit: str = "samples") -> None:
    """Compare a declared count with what the file can hold, before anything is allocated.

    Raises
    ------
    RecordFormatError
        If fewer are there than declared, or none is declared.
    """
    if declared < 1:
        raise RecordFormatError(f"{where}: expected a positive number of {unit} in the header, found {declared}")
    if available < declared:
        raise RecordFormatError(
            f"{where}: expected {declared} {unit} (header), found {available}; "
            "the file may be truncated: download it again"
        )


def _to_float(fields: Sequence[bytes] | np.ndarray, where: str, located: Iterator[tuple[int, str]]) -> np.ndarray:
    """Convert all fields at once; only when that fails look for the one to blame."""
    try:
        values = np.array(fields).astype(float)
    except ValueError:
        values = np.array([np.nan])
    if np.all(np.isfinite(values)):
        return values
    for line, field in located:
        if not _NUMBER.fullmatch(field) or not np.isfinite(float(field.translate(_FORTRAN_EXPONENT_TEXT))):
            raise RecordFormatError(
                f"{where}:{line}: expected a finite number, found {field.strip() or 'a blank field'!r}; "
                "repair the line or download the file again"
            )
    raise RecordFormatError(f"{where}: the numbers cannot be converted; download the file again")


def fixed_width(lines: Sequence[str], first: int, width: int, per_row: int, count: int, where: str) -> np.ndarray:
    """Numbers in columns of equal width, touching or not.

    Parameters
    ----------
    lines : sequence of str
        Rows that may belong to the block; surplus rows are left alone.
    first : int
        Number of ``lines[0]`` in the file, from 1, for messages.
    width, per_row : int
        Characters of a field, fields of a full row.
    count : int
        Numbers to read.
    where : str
        Name of the file.

    Returns
    -------
    (count,) ndarray
        The numbers.

    Raises
    ------
    RecordFormatError
        Too few numbers, a row of another length, a field that is no finite number.
    """
    rows = -(-count // per_row)
    block = [line.rstrip() for line in lines[: max(rows, 0)]]
    available = sum(-(-len(row) // width) for row in block)
    check_count(f"{where}:{first + len(block)}", count, available, "numbers")
    last = count - (rows - 1) * per_row
    full = width * per_row
    for index, row in enumerate(block):
        expected = full if index < rows - 1 else max(last * width, len(row))
        if len(row) != expected or len(row) > full:
            raise RecordFormatError(
                f"{where}:{first + index}: expected {per_row if index < rows - 1 else last} fields of {width} "
                f"characters, found a row of {len(row)} characters; the line is damaged: download the file again"
            )
    joined = "".join(block)[: count * width].encode("latin-1")
    located = (
        (first + index // per_row, joined[index * width : (index + 1) * width].decode("latin-1"))
        for index in range(count)
    )
    if joined.translate(None, _NUMBER_BYTES):
        fields: np.ndarray = np.array([b"nan"])
    else:
        fields = np.frombuffer(joined.translate(_FORTRAN_EXPONENT), dtype=f"S{width}")
    return _to_float(fields, where, located)


def free_numbers(lines: Sequence[str], first: int, where: str) -> np.ndarray:
    """Numbers separated by blanks, any count per row.

    Parameters
    ----------
    lines : sequence of str
        Rows of the block.
    first : int
        Number of ``lines[0]`` in the file, from 1, for messages.
    where : str
        Name of the file.

    Returns
    -------
    (n,) ndarray
        The numbers.

    Raises
    ------
    RecordFormatError
        A field that is no finite number.
    """
    joined = "\n".join(lines).encode("latin-1")
    located = ((first + index, field) for index, line in enumerate(lines) for field in line.split())
    if joined.translate(None, _NUMBER_BYTES + b"\n\r\f\v"):
        return _to_float([b"nan"], where, located)
    return _to_float(joined.translate(_FORTRAN_EXPONENT).split() or np.empty(0), where, located)
