"""CSMIP volume 1 files of the California Geological Survey (and the networks that write the same layout).

Each channel has 13 lines of text, 100 integers (16I5), 50 reals (8F10) and then, on newer files, a heading line that
names count, rate, unit and Fortran format of the accelerations. Older files have no heading: pairs of time [s] and
acceleration [g/10] with unequal steps follow. A line ``/&`` ends the channel; channels differ in length.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rockpulse.readers.csmip_layout import HEADER_LINES, channels, equal_block, heading_at, read_header
from rockpulse.readers.fields import check_count, printed_number
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.pairs import Block, declared_points, pair_block, pair_unit
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record import STANDARD_GRAVITY, Record

__all__ = ["FORMAT", "is_csmip_v1", "read_csmip_v1", "read_uncorrected"]

_TITLE = re.compile(r"\s?uncorrected accelerogram data\b", re.IGNORECASE)
_PEAK = re.compile(r"max\s*=\s*(-?\d*\.\d+)\s*g\b", re.IGNORECASE)
#: Bytes that hold the 13 lines of text.
_OPENING = 1500


def is_csmip_v1(head: bytes, name: str) -> bool:
    """Whether the first line is the title of an uncorrected volume, and the network is not RENADIC."""
    opening = head[:_OPENING].decode("latin-1")
    return bool(_TITLE.match(opening)) and "renadic" not in opening.lower()


def read_csmip_v1(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel.

    Parameters
    ----------
    file : SourceFile
        The file.
    options : ReadOptions
        Not used: the format states everything.

    Raises
    ------
    RecordFormatError, UnitError, NotAcceleration
        With file and line, what was found and what was expected.
    """
    return read_uncorrected(file, FORMAT.name)


def read_uncorrected(file: SourceFile, format: str) -> list[Record]:
    """Read every channel of a file in this layout, whichever network wrote it.

    Parameters
    ----------
    file : SourceFile
        The file; its first line is 'Uncorrected Accelerogram Data'.
    format : str
        `Record.format`.

    Raises
    ------
    RecordFormatError, UnitError, NotAcceleration
        With file and line, what was found and what was expected.
    """
    lines, spans = channels(file, _TITLE, "Uncorrected Accelerogram Data")
    return [_channel(file, lines, start, end, number, format) for number, (start, end) in enumerate(spans, 1)]


def _channel(file: SourceFile, lines: Sequence[str], start: int, end: int, number: int, format: str) -> Record:
    check_count(f"{file.name}:{end}", HEADER_LINES, end - start, f"header lines of channel {number}")
    header = lines[start : start + HEADER_LINES]
    match = _PEAK.search(header[11][:200])
    peak, rounding = printed_number(match[1]) if match else (float("nan"), 0.0)
    return read_header(header).record(
        file,
        number,
        _block(file.name, lines, start, end),
        format=format,
        processed=False,
        peak=(peak * STANDARD_GRAVITY, rounding * STANDARD_GRAVITY),
    )


def _block(name: str, lines: Sequence[str], start: int, end: int) -> Block:
    first = start + HEADER_LINES
    heading = heading_at(lines, first) if first < end else None
    if not heading:
        count = declared_points(lines[start + 10], f"{name}:{start + 11}")
        unit = pair_unit(lines[start + 11], f"{name}:{start + 12}")
        return pair_block(name, lines, first, end, count, unit)
    if heading.kind != "acceleration":
        raise NotAcceleration(
            f"{name}:{first + 1}: expected points of acceleration, found {heading.kind}; "
            "read the acceleration file of the same record"
        )
    return equal_block(name, lines, heading, end, heading.unit)


FORMAT = Format(
    name="csmip_v1",
    what="CSMIP volume 1, both layouts",
    recognised="first line 'Uncorrected Accelerogram Data'",
    unit="g or g/10, from the header",
    processed="no",
    example="CICLC.v1",
    detect=is_csmip_v1,
    parse=read_csmip_v1,
)
