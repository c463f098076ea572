"""CSMIP volume 2: corrected acceleration, velocity and displacement, of which the acceleration is read.

Each channel has a title, the 13 lines of text of volume 1, 11 more about the correction, integers (16I5), reals (8F10)
and up to three blocks. Each block begins with a heading, as in ``3251 POINTS OF ACCEL DATA EQUALLY SPACED AT .020
SEC.  (UNITS: CM/SEC/SEC)``; newer ones name the Fortran format, USC's no unit. Channels differ in length.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers.csmip_layout import (
    LONGEST_LINE,
    TEXT_LINES,
    Header,
    Heading,
    channels,
    equal_block,
    heading_at,
    missing_channels,
    read_header,
)
from rockpulse.readers.csmip_numbers import held_peak_real, real
from rockpulse.readers.fields import check_count, printed_number
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.held import held_length, held_lengths_of_units, held_peak_time
from rockpulse.readers.pairs import Block
from rockpulse.readers.repeats import distinct_sections
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import Record

__all__ = ["FORMATS", "is_csmip_v2", "read_corrected", "read_csmip_v2"]

_TITLE = re.compile(r"\s?corrected accelerogram\b", re.IGNORECASE)
_OPENING = re.compile(
    r"(?:\s?corrected accelerogram\b[^\r\n]*[\r\n]+)+\s?uncorrected accelerogram data\b", re.IGNORECASE
)
#: The title, the lines of volume 1, and those about the correction.
_CORRECTION = 1 + TEXT_LINES
_ALL_TEXT = _CORRECTION + 11

_FILTER = re.compile(r"\s*accelerogram\s+(?:is\s+)?(.*\bfiltered\b.*?)[\s.]*$", re.IGNORECASE)
_DECLARED = re.compile(r"\s*(\d{1,15})\s+(?:points of\s+)?(instrument.*corrected)\b", re.IGNORECASE)
_INTERVAL = re.compile(r"\s*at equally-spaced intervals of\s+(\d*\.?\d+)\s*sec", re.IGNORECASE)
_PEAK = re.compile(
    r"\s*peak acceleration\s*=\s*(-?\d*\.?\d+)\s*(?!at\b)([a-z][a-z/]*)(?:\s*at\s+(\d{0,6}\.\d{1,6})\s*sec)?",
    re.IGNORECASE,
)
_OTHER_PEAKS = re.compile(
    r"\s*peak\s+(?:velocity|displacement)\s*=\s*-?\d*\.?\d+\s*(?!at\b)([a-z][a-z/]*)", re.IGNORECASE
)
_LENGTH = re.compile(r".{0,40}?\b(?:record length|duration)\s*=\s*(\d{0,6}\.\d{1,6})\s*sec", re.IGNORECASE)
#: The length of the trace before its correction, which may end a little earlier or later [share of it].
_LENGTH_TOLERANCE = 5e-3
#: The component in the title and in the last line of the text.
_COMPONENT = re.compile(r"\b(?:chan\s*\d{1,4}\s*:|comp)\s+(\S.{0,30}?)(?=\s{2}|\s+from\b|\s*$)", re.IGNORECASE)


def is_csmip_v2(head: bytes, name: str) -> bool:
    """Whether the first two lines are the titles of a corrected and of its uncorrected volume."""
    return bool(_OPENING.match(head[:1000].decode("latin-1")))


def read_csmip_v2(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read the acceleration of every channel; raises NotAcceleration for a file of velocity or displacement only."""
    return read_corrected(file, "csmip_v2", read_header)


def read_corrected(file: SourceFile, format: str, header: Callable[[Sequence[str]], Header]) -> list[Record]:
    """Read a volume 2, whichever network wrote it; `header` reads the 13 lines of text of volume 1.

    The first line of the file is 'Corrected accelerogram'. A channel without acceleration is left out, with a warning
    on the others; NotAcceleration if none has acceleration. `format` becomes `Record.format`.
    """
    lines, spans, copies = channels(file, _TITLE, "Corrected accelerogram")
    records, left_out, headers = [], [], []
    for number, (start, end) in enumerate(spans, 1):
        check_count(f"{file.name}:{end}", _ALL_TEXT, end - start, f"header lines of channel {number}")
        read = header(lines[start + 1 : min(start + _ALL_TEXT + 2, end)])
        repeated = (_COMPONENT.search(lines[at][:LONGEST_LINE]) for at in (start, start + _ALL_TEXT - 2))
        headers.append(replace(read, repeated=tuple(match[1] for match in repeated if match)))
        heading, behind = _acceleration(file.name, lines, start, end)
        if heading.kind != "acceleration":
            left_out.append((number, heading))
            continue
        text = [line[:LONGEST_LINE] for line in lines[start : start + _ALL_TEXT]]
        unit, peak = _unit_and_peak(text, heading, file.name, start + 1)
        block = equal_block(file.name, lines, heading, behind, unit)
        _check_correction(text, block, f"{file.name}:{heading.at + 1}")
        block = block.noting(*_held(text, lines[start + _ALL_TEXT : heading.at], block))
        records.append(
            headers[-1].record(
                file,
                number,
                block,
                format=format,
                processed=True,
                peak=peak,
                processing=_correction(text[_CORRECTION:]),
            )
        )
    if not records:
        _, heading = left_out[0]
        raise NotAcceleration(
            f"{file.name}:{heading.at + 1}: expected points of acceleration, found {heading.kind}; "
            "read the file with the acceleration of the same record"
        )
    notes = (*missing_channels(file.name, lines, spans, headers), *copies)
    notes += tuple(
        f"line {heading.at + 1}: channel {number} holds {heading.kind} but no acceleration; it was left out"
        for number, heading in left_out
    )
    return [replace(record, warnings=record.warnings + notes) for record in records]


def _acceleration(name: str, lines: Sequence[str], start: int, end: int) -> tuple[Heading, int]:
    """Heading of the acceleration (or else of the first series), and the index of the line behind its block.

    Raises RecordFormatError where a block is missing, cut short or there twice.
    """
    found: list[Heading] = []
    for at in range(start + _ALL_TEXT, end):
        heading = heading_at(lines, at)
        if heading and not (found and found[-1].at >= at):
            found.append(heading)
    if not found:
        raise RecordFormatError(
            f"{name}:{end}: expected a line 'N points of accel data equally spaced at ...' in the channel that begins "
            f"at line {start + 1}, found none; the file may be truncated: download it again"
        )
    ends = [*(heading.at for heading in found), end][1:]
    for heading, behind in zip(found, ends, strict=True):
        per_row = heading.layout[0] if heading.layout else 8
        rows = -(-heading.count // per_row) if per_row else 0
        available = behind - heading.at - 1
        if available < rows:
            check_count(f"{name}:{behind}", rows, available, f"rows of {heading.kind}")
    accelerations = [pair for pair in zip(found, ends, strict=True) if pair[0].kind == "acceleration"]
    blocks, copies = distinct_sections(lines, [(heading.at, behind) for heading, behind in accelerations], "block")
    if copies and len(blocks) == 1:
        heading, behind = accelerations[0]
        return replace(heading, warnings=(*heading.warnings, *copies)), behind
    if len(accelerations) > 1:
        raise RecordFormatError(
            f"{name}:{accelerations[1][0].at + 1}: expected the end of the channel that begins at line {start + 1}, "
            "found a second block of acceleration; the file is damaged: download it again"
        )
    return accelerations[0] if accelerations else (found[0], ends[0])


def _first(pattern: re.Pattern[str], lines: Sequence[str]) -> re.Match[str] | None:
    return next((match for line in lines if (match := pattern.match(line))), None)


def _unit_and_peak(text: Sequence[str], heading: Heading, where: str, line: int) -> tuple[str, tuple[float, float]]:
    """Unit as worded by the heading, else by the peak; the peak and half a unit of its last digit [m/s2].

    For messages, `where` is the name of the file and `line` the number of the first line of text.
    """
    found = next(((at, match) for at, words in enumerate(text, line) if (match := _PEAK.match(words))), None)
    if found:
        at, match = found
        # USC writes CMS/SEC/SEC.
        stated = canonical_unit(re.sub(r"^cms\b", "cm", match[2], flags=re.IGNORECASE), f"{where}:{at}")
        value, rounding = printed_number(match[1])
        return heading.unit or stated, (value * UNITS[stated], rounding * UNITS[stated])
    if not heading.unit:
        raise UnitError(
            f"{where}:{heading.at + 1}: expected the unit of acceleration in the heading or behind "
            "'Peak acceleration = N', found none; repair the header or download the file again"
        )
    return heading.unit, (float("nan"), 0.0)


def _check_correction(text: Sequence[str], block: Block, where: str) -> None:
    """Check the count and the interval in the text of the channel against those of the heading."""
    declared, interval = _first(_DECLARED, text), _first(_INTERVAL, text)
    if declared and int(declared[1]) != block.samples.size:
        raise RecordFormatError(
            f"{where}: expected {int(declared[1])} points (text of the channel), found a heading with "
            f"{block.samples.size}; the file is damaged: download it again"
        )
    if interval:
        step, rounding = printed_number(interval[1])
        if not abs(block.dt - step) <= 1.01 * rounding:
            raise RecordFormatError(
                f"{where}: expected an interval of {step:g} s (text of the channel), found a heading with "
                f"{block.dt:g} s; the file is damaged: download it again"
            )


def _held(text: Sequence[str], behind: Sequence[str], block: Block) -> list[str]:
    """Warnings where length, peak and its time, interval or the units of the peaks contradict the block.

    They stand in the text and in reals 60 (length), 61 (interval), 65 (time of the peak) and 66 (peak in cm/s2).
    """
    length, peak = _first(_LENGTH, text), _first(_PEAK, text)
    others = [match[1] for line in text if (match := _OTHER_PEAKS.match(line))]
    spare = _LENGTH_TOLERANCE * block.duration
    lengths, times = [length[1] if length else "", real(behind, 60)], [(peak and peak[3]) or "", real(behind, 65)]
    notes = [note for one in lengths for note in held_length(one, block.values.size, block.dt, spare)]
    notes += [note for one in times for note in held_peak_time(one, block.times, block.values)]
    notes += held_peak_real(behind, 66, block, UNITS["cm/s2"])
    interval = real(behind, 61)
    step, rounding = printed_number(interval) if interval else (block.dt, 0.0)
    if abs(step - block.dt) > 1.01 * rounding:
        notes.append(f"real 61 of the header states an interval of {step:g} s, the heading {block.dt:g} s")
    return list(dict.fromkeys(notes)) + (held_lengths_of_units([peak[2], *others]) if peak else [])


def _correction(correction: Sequence[str]) -> list[str]:
    """The agency's own words for the correction of the record."""
    filtered, corrected = _first(_FILTER, correction), _first(_DECLARED, correction)
    steps = [match[group] for match, group in ((corrected, 2), (filtered, 1)) if match]
    return [f"by the agency: {' '.join((words.lower() if words.isupper() else words).split())}" for words in steps]


FORMATS = (
    Format(
        name="csmip_v2",
        what="CSMIP volume 2, the acceleration of each channel",
        recognised="first lines 'Corrected accelerogram' and 'Uncorrected Accelerogram Data'",
        unit="cm/s2, from the heading of the block",
        processed="yes",
        example="CE58667.V2",
        detect=is_csmip_v2,
        parse=read_csmip_v2,
    ),
)
