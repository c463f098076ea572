"""CSMIP volume 1 files of the California Geological Survey (and the networks that write the same layout).

Each channel has 13 lines of text, 100 integers (16I5), 50 reals (8F10) and then, on newer files, a heading line that
names count, rate, unit and Fortran format of the accelerations. Older files have no heading: pairs of time [s] and
acceleration [g/10] with unequal steps follow. A line ``/&`` ends the channel; channels differ in length.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rockpulse.errors import RecordFormatError
from rockpulse.readers.csmip_layout import (
    HEADER_LINES,
    LONGEST_LINE,
    TEXT_LINES,
    Header,
    channels,
    equal_block,
    heading_at,
    missing_channels,
    read_header,
)
from rockpulse.readers.csmip_numbers import held_count, held_peak_real, real
from rockpulse.readers.fields import check_count, printed_number
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import held_length, held_peak_time, held_units
from rockpulse.readers.pairs import Block, declared_points, pair_block, pair_unit
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record.record import STANDARD_GRAVITY, Record

__all__ = ["FORMATS", "is_csmip_v1", "read_csmip_v1", "read_uncorrected"]

_TITLE = re.compile(r"\s?uncorrected accelerogram data\b", re.IGNORECASE)
_PEAK = re.compile(r"max\s*=\s*(-?\d*\.\d+)\s*g\b(?:\s*,\s*at\s+(\d{0,6}\.\d{1,6})\s*sec)?", re.IGNORECASE)
_UNIT = re.compile(r"\s*units of uncor \w+\s+(?:is|are)\s+(?:sec(?:onds)?\s+and\s+)?(g(?:/10)?)\b", re.IGNORECASE)
_POINTS = re.compile(r"no\. of points\s*=\s*(\d{1,15})\b", re.IGNORECASE)
_RATE = re.compile(r"\bat\s+(\d{1,6}(?:\.\d{0,6})?)\s*samples/sec", re.IGNORECASE)
_LENGTH = re.compile(r"record length\s*=\s*(\d{0,6}\.\d{1,6})\s*sec", re.IGNORECASE)
_RATE_TOLERANCE, _LENGTH_TOLERANCE = 1e-3, 5e-3
#: Bytes that hold the 13 lines of text.
_OPENING = 1500


def is_csmip_v1(head: bytes, name: str) -> bool:
    """Whether the first line is the title of an uncorrected volume, and the network is not RENADIC."""
    opening = head[:_OPENING].decode("latin-1")
    return bool(_TITLE.match(opening)) and "renadic" not in opening.lower()


def read_csmip_v1(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every channel; the options are not used, because the format states everything."""
    return read_uncorrected(file, "csmip_v1")


def read_uncorrected(file: SourceFile, format: str) -> list[Record]:
    """Read every channel of a file in this layout, whichever network wrote it; `format` becomes `Record.format`.

    The first line of the file is 'Uncorrected Accelerogram Data'. Raises RecordFormatError, UnitError or
    NotAcceleration.
    """
    lines, spans, copies = channels(file, _TITLE, "Uncorrected Accelerogram Data")
    headers = []
    for number, (start, end) in enumerate(spans, 1):
        check_count(f"{file.name}:{end}", HEADER_LINES, end - start, f"header lines of channel {number}")
        headers.append(read_header(lines[start : start + HEADER_LINES]))
    notes = (*missing_channels(file.name, lines, spans, headers), *copies)
    return [
        _channel(file, lines, span, number, header.noting(*notes), format)
        for number, (span, header) in enumerate(zip(spans, headers, strict=True), 1)
    ]


def _channel(
    file: SourceFile, lines: Sequence[str], span: tuple[int, int], number: int, header: Header, format: str
) -> Record:
    start, end = span
    match = _PEAK.search(lines[start + 11][:LONGEST_LINE])
    peak, rounding = printed_number(match[1]) if match else (float("nan"), 0.0)
    block = _block(file.name, lines, start, end)
    behind = lines[start + TEXT_LINES : start + HEADER_LINES]
    times = [(match and match[2]) or "", real(behind, 8)]
    told = _check_length(lines[start + 10], behind, block) + held_peak_real(behind, 7, block, STANDARD_GRAVITY)
    told += [note for text in times for note in held_peak_time(text, block.times, block.values)]
    return header.record(
        file,
        number,
        block.noting(*dict.fromkeys(told)),
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
        block = pair_block(name, lines, first, end, count, unit)
        return block.noting(*held_count(lines[start + TEXT_LINES : first], count))
    if heading.kind != "acceleration":
        raise NotAcceleration(
            f"{name}:{first + 1}: expected points of acceleration, found {heading.kind}; "
            "read the acceleration file of the same record"
        )
    block = equal_block(name, lines, heading, end, heading.unit)
    named = _UNIT.match(lines[start + 11][:LONGEST_LINE])
    stated = [(f"line {first + 1}", block.unit), *([(f"line {start + 12}", named[1].lower())] if named else [])]
    _check_text(lines[start + 10][:LONGEST_LINE], block, f"{name}:{first + 1}")
    counted = held_count(lines[start + TEXT_LINES : first], block.samples.size)
    return block.noting(*counted, *held_units(stated))


def _check_text(line: str, block: Block, where: str) -> None:
    """Check number and rate in the text against the heading."""
    points, rate = _POINTS.search(line), _RATE.search(line)
    count, step = block.samples.size, block.dt
    if points and int(points[1]) != count:
        raise RecordFormatError(
            f"{where}: expected {int(points[1])} points (text of the channel), found a heading with {count}; "
            "the file is damaged: download it again"
        )
    if rate:
        number, rounding = printed_number(rate[1])
        if not abs(1.0 / step - number) <= max(1.01 * rounding, _RATE_TOLERANCE * number):
            raise RecordFormatError(
                f"{where}: expected {number:g} samples/sec (text of the channel), found a heading with {1.0 / step:g}; "
                "the file is damaged: download it again"
            )


def _check_length(line: str, behind: Sequence[str], block: Block) -> list[str]:
    """Warnings where the length in the text, or real 3, is not that of the samples or pairs as the file holds them."""
    length = _LENGTH.search(line[:LONGEST_LINE])
    count, spare = round(block.duration / block.dt), _LENGTH_TOLERANCE * block.duration
    stated = [length[1] if length else "", real(behind, 3)]
    return [note for text in stated for note in held_length(text, count, block.dt, spare)]


FORMATS = (
    Format(
        name="csmip_v1",
        what="CSMIP volume 1, both layouts",
        recognised="first line 'Uncorrected Accelerogram Data'",
        unit="g or g/10, from the header",
        processed="no",
        example="CICLC.v1",
        detect=is_csmip_v1,
        parse=read_csmip_v1,
    ),
)
