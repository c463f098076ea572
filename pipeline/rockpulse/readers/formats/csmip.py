"""CSMIP files of the California Geological Survey, and of networks that use the same layout.

A file of volume 1 (uncorrected) has channels as in `kit.csmip_layout`, with accelerations below a heading; older files
have no heading, but pairs of time [s] and acceleration [g/10] with unequal steps. In volume 2 (corrected) the heading
is like ``3251 POINTS OF ACCEL DATA EQUALLY SPACED AT .020 SEC. (UNITS: CM/SEC/SEC)``; newer headings also name the
Fortran format, and headings of USC have no unit. Only acceleration is read. Volume 3 (spectra) is rejected.

Files of RENADIC (Universidad de Chile) are of volume 1, with pairs. Recorders with four channels have one channel
without a sensor, which contains only zeros. Long records are split into files ``...parte1.v1``, ``...parte2.v1``.
Origin times are from the clocks of the instruments, some of which were never set.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NoReturn

from rockpulse.errors import RecordRefused, UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with
from rockpulse.readers.kit import csmip_layout as layout
from rockpulse.readers.parts import PartRule

UNCORRECTED = re.compile(r"\s?uncorrected accelerogram data\b", re.IGNORECASE)
_PEAK_1 = re.compile(r".*?max\s*=\s*(-?\d*\.\d+)\s*g\b(?:\s*,\s*at\s+(\d{0,6}\.\d{1,6})\s*sec)?", re.IGNORECASE)
_UNIT = re.compile(r"\s*units of uncor \w+\s+(?:is|are)\s+(?:sec(?:onds)?\s+and\s+)?(g(?:/10)?)\b", re.IGNORECASE)
_POINTS = re.compile(r".*?no\. of points\s*=\s*(\d{1,15})\b", re.IGNORECASE)
_RATE = re.compile(r".*?\bat\s+(\d{1,6}(?:\.\d{0,6})?)\s*samples/sec", re.IGNORECASE)
_LENGTH_1 = re.compile(r".*?record length\s*=\s*(\d{0,6}\.\d{1,6})\s*sec", re.IGNORECASE)
#: Relative tolerances of sampling rate and stated length: a correction may shorten or extend a trace a little.
_RATE_TOLERANCE, _LENGTH_TOLERANCE = 1e-3, 5e-3
_OPENING = 1500  # number of bytes that contain the 13 lines of text of the first channel
_CORRECTED = re.compile(r"\s?corrected accelerogram\b", re.IGNORECASE)
_BOTH_TITLES = re.compile(rf"(?:{_CORRECTED.pattern}[^\r\n]*[\r\n]+)+{UNCORRECTED.pattern}", re.IGNORECASE)
_ReadHeader = Callable[[Sequence[str]], layout.CsmipHeader]
_Held = Callable[[Sequence[str], kit.ChannelSamples], list[str]]
#: Number of lines of title and text in volume 1, and in volume 2, which has further lines about the correction.
_CORRECTION, _ALL_TEXT = 1 + layout.TEXT_LINES, 1 + layout.TEXT_LINES + 11
_FILTER = re.compile(r"\s*accelerogram\s+(?:is\s+)?(.*\bfiltered\b.*?)[\s.]*$", re.IGNORECASE)
_DECLARED = re.compile(r"\s*(\d{1,15})\s+(?:points of\s+)?(instrument.*corrected)\b", re.IGNORECASE)
_INTERVAL = re.compile(r"\s*at equally-spaced intervals of\s+(\d*\.?\d+)\s*sec", re.IGNORECASE)
_PEAK_2 = re.compile(
    r"\s*peak acceleration\s*=\s*(-?\d*\.?\d+)\s*(?!at\b)([a-z][a-z/]*)(?:\s*at\s+(\d{0,6}\.\d{1,6})\s*sec)?",
    re.IGNORECASE,
)
_OTHER_PEAKS = re.compile(r"(?i)\s*peak\s+(?:velocity|displacement)\s*=\s*-?\d*\.?\d+\s*(?!at\b)([a-z][a-z/]*)")
_LENGTH_2 = re.compile(r".{0,40}?\b(?:record length|duration)\s*=\s*(\d{0,6}\.\d{1,6})\s*sec", re.IGNORECASE)
#: Patterns of the component in the title and in the last line of the text.
_COMPONENT = re.compile(r"\b(?:chan\s*\d{1,4}\s*:|comp)\s+(\S.{0,30}?)(?=\s{2}|\s+from\b|\s*$)", re.IGNORECASE)
_SPECTRA = r"\s?response and fourier|\s?(?:response|fourier)\b[^\r\n]*\bspectr[^\r\n]*[\r\n]+\s?corrected accelerogram"
_SPECTRA_WORDS = "response and Fourier spectra (volume 3 of CSMIP or USC)"
#: Pattern of the line with the station number, and of the line below it with the name.
_STATION = re.compile(r"^\s?station no\.?\s+(\w+)\b[^\r\n]*[\r\n]+(\S[^\r\n]*?)(?:\s\s|[\r\n])", re.I | re.M)
_FIRST_TIME = re.compile(r"\s*(-?\d{0,6}\.\d{1,9})", re.ASCII)
_SPECTRA_OPENING = 4000  # number of bytes at the start of a file in which spectra are recognised


def is_uncorrected(head: bytes, name: str, renadic: bool) -> bool:
    """Return whether a file is an uncorrected file of RENADIC or, if `renadic` is false, of another network."""
    opening = head[:_OPENING].decode("latin-1")
    return bool(UNCORRECTED.match(opening)) and ("renadic" in opening.lower()) is renadic


def _held_uncorrected(head: Sequence[str], block: kit.ChannelSamples) -> list[str]:
    length, time = kit.matched(_LENGTH_1, head[10]), kit.matched(_PEAK_1, head[11], 2)
    return _held(block, head[layout.TEXT_LINES :], (3, 8, 7), kit.STANDARD_GRAVITY, length, time)


def _held(
    block: kit.ChannelSamples, behind: Sequence[str], numbers: Sequence[int], unit: float, length: str, time: str
) -> list[str]:
    """Return warnings if length, time of the peak or peak contradict the samples.

    The text states `length` and `time`; the floating-point header values `numbers` are the length, the time and the
    peak [`unit` m/s2].
    """
    notes: list[str] = []
    count, spare = round(block.duration / block.dt), _LENGTH_TOLERANCE * block.duration
    for text in (length, layout.real_header_value(behind, numbers[0])):
        notes += kit.held_length(text, count, block.dt, spare)
    for text in (time, layout.real_header_value(behind, numbers[1])):
        notes += kit.held_peak_time(text, block.times, block.values)
    return notes + layout.held_peak_real(behind, numbers[2], block, unit)


def read_uncorrected(
    file: kit.SourceFile,
    options: ReadOptions,
    title: re.Pattern[str] = UNCORRECTED,
    wording: str = "Uncorrected Accelerogram Data",
    read_header: _ReadHeader = layout.read_csmip_header,
    held: _Held = _held_uncorrected,
) -> list[kit.Record]:
    """Read every channel of an uncorrected file (volume 1) of any network."""
    lines, spans, copies = layout.channels(file, title, wording, layout.HEADER_LINES)
    heads = [[line[: kit.LONGEST_LINE] for line in lines[at : at + layout.HEADER_LINES]] for at, _ in spans]
    headers = [read_header(head) for head in heads]
    notes = (*layout.missing_channels(file.name, lines, spans, headers), *copies)
    records = []
    for number, ((start, end), head, header) in enumerate(zip(spans, heads, headers, strict=True), 1):
        block = _uncorrected_block(file.name, lines, start, end)
        block = block.noting(*dict.fromkeys(held(head, block)))
        peak = kit.printed_number(kit.matched(_PEAK_1, head[11]))
        stated: dict[str, Any] = {"header_peak": peak, "peak_factor": kit.STANDARD_GRAVITY}
        records.append(header.record(file, number, block, notes, processed=False, **stated))
    return records


def _uncorrected_block(name: str, lines: Sequence[str], start: int, end: int) -> kit.ChannelSamples:
    first, below = start + layout.HEADER_LINES, lines[start + layout.TEXT_LINES : start + layout.HEADER_LINES]
    heading = layout.heading_at(lines, first) if first < end else None
    if not heading:
        count = kit.declared_points(lines[start + 10], f"{name}:{start + 11}")
        unit = kit.pair_unit(lines[start + 11], f"{name}:{start + 12}")
        return kit.pair_block(name, lines, first, end, count, unit).noting(*layout.held_count(below, count))
    where = f"{name}:{first + 1}"
    if heading.kind != "acceleration":
        raise kit.no_acceleration(where, "points of acceleration", heading.kind)
    block = layout.equal_block(name, lines, heading, end, heading.unit)
    counts, units = (line[: kit.LONGEST_LINE] for line in lines[start + 10 : start + 12])
    _check_heading(where, kit.matched(_POINTS, counts), block.samples.size, "{:.15g} points", "{:.15g}")
    _check_heading(where, kit.matched(_RATE, counts), 1.0 / block.dt, "{:g} samples/sec", "{:g}", _RATE_TOLERANCE)
    named = kit.matched(_UNIT, units).lower()
    stated = [(f"line {first + 1}", block.unit), (f"line {start + 12}", named or block.unit)]
    return block.noting(*layout.held_count(below, block.samples.size), *kit.held_units(stated))


def _check_heading(where: str, text: str, found: float, stated: str, heading: str, share: float = 0.0) -> None:
    """Raise an error if the number `text` in the text of a channel differs from `found`, that of the heading."""
    number, rounding = kit.printed_number(text)
    if abs(found - number) > max(1.01 * rounding, share * number):
        expected = f"{stated.format(number)} (text of the channel)"
        raise kit.unexpected(where, expected, f"a heading with {heading.format(found)}", kit.FILE_DAMAGED)


def read_corrected(
    file: kit.SourceFile, options: ReadOptions, read_header: _ReadHeader = layout.read_csmip_header
) -> list[kit.Record]:
    """Read every channel of a corrected file (volume 2) of any network."""
    lines, spans, copies = layout.channels(file, _CORRECTED, "Corrected accelerogram", _ALL_TEXT)
    records, left_out, headers = [], [], []
    for number, (start, end) in enumerate(spans, 1):
        text = [line[: kit.LONGEST_LINE] for line in lines[start : start + _ALL_TEXT]]
        repeated = (_COMPONENT.search(line) for line in (text[0], text[-2]))
        header = read_header(lines[start + 1 : min(start + _ALL_TEXT + 2, end)])
        headers.append(replace(header, repeated=tuple(match[1] for match in repeated if match)))
        heading, behind = _acceleration(file.name, lines, start, end)
        if heading.kind != "acceleration":
            left_out.append((number, heading))
            continue
        unit, peak, peak_factor = _unit_and_peak(text, heading, file.name, start + 1)
        block = layout.equal_block(file.name, lines, heading, behind, unit)
        where = f"{file.name}:{heading.at + 1}"
        _check_heading(where, kit.first_match(_DECLARED, text), block.samples.size, "{:.15g} points", "{:.15g}")
        _check_heading(where, kit.first_match(_INTERVAL, text), block.dt, "an interval of {:g} s", "{:g} s")
        block = block.noting(*_held_corrected(text, lines[start + _ALL_TEXT : heading.at], block))
        steps = [kit.first_match(_DECLARED, text[_CORRECTION:], 2), kit.first_match(_FILTER, text[_CORRECTION:])]
        done = [" ".join((words.lower() if words.isupper() else words).split()) for words in steps if words]
        stated: dict[str, Any] = {"header_peak": peak, "peak_factor": peak_factor}
        done = [f"by the agency: {words}" for words in done]
        records.append(headers[-1].record(file, number, block, processed=True, processing=done, **stated))
    if not records:
        _, heading = left_out[0]
        where, advice = f"{file.name}:{heading.at + 1}", "read the file with the acceleration of the same record"
        raise kit.no_acceleration(where, "points of acceleration", heading.kind, advice)
    notes = (*layout.missing_channels(file.name, lines, spans, headers), *copies)
    notes += tuple(
        f"line {heading.at + 1}: channel {number} holds {heading.kind} but no acceleration; it was left out"
        for number, heading in left_out
    )
    return kit.with_warnings(records, notes)


def _acceleration(name: str, lines: Sequence[str], start: int, end: int) -> tuple[layout.SeriesHeading, int]:
    """Return the heading of the acceleration, or else of the first series, and the index of the line after it."""
    found: list[layout.SeriesHeading] = []
    for at in range(start + _ALL_TEXT, end):
        heading = None if found and found[-1].at >= at else layout.heading_at(lines, at)
        found += [heading] if heading else []
    channel = f"the channel that begins at line {start + 1}"
    if not found:
        expected = f"a line 'N points of accel data equally spaced at ...' in {channel}"
        raise kit.unexpected(f"{name}:{end}", expected, "none", kit.TRUNCATED)
    blocks = list(zip(found, [*(heading.at for heading in found[1:]), end], strict=True))
    for heading, behind in blocks:
        per_row = heading.layout[0] if heading.layout else 8
        rows, available = -(-heading.count // per_row) if per_row else 0, behind - heading.at - 1
        if available < rows:
            kit.check_count(f"{name}:{behind}", rows, available, f"rows of {heading.kind}")
    accelerations = [block for block in blocks if block[0].kind == "acceleration"]
    distinct, copies = kit.distinct_sections(
        lines, [(heading.at, behind) for heading, behind in accelerations], "block"
    )
    if len(distinct) > 1:
        where, found_twice = f"{name}:{accelerations[1][0].at + 1}", "a second block of acceleration"
        raise kit.unexpected(where, f"the end of {channel}", found_twice, kit.FILE_DAMAGED)
    heading, behind = (accelerations or blocks)[0]
    return replace(heading, warnings=(*heading.warnings, *copies)), behind


def _unit_and_peak(
    text: Sequence[str], heading: layout.SeriesHeading, where: str, line: int
) -> tuple[str, tuple[float, float], float]:
    """Return the unit, the stated peak with half a unit of its last digit, and m/s2 per unit of the peak."""
    for at, words in enumerate(text, line):
        if match := _PEAK_2.match(words):
            # USC writes CMS/SEC/SEC.
            stated = kit.canonical_unit(re.sub(r"^cms\b", "cm", match[2], flags=re.IGNORECASE), f"{where}:{at}")
            return heading.unit or stated, kit.printed_number(match[1]), kit.UNITS[stated]
    if not heading.unit:
        expected = "expected the unit of acceleration in the heading or after 'Peak acceleration = N', found none"
        raise UnitError(f"{where}:{heading.at + 1}: {expected}; correct the header")
    return heading.unit, kit.printed_number(""), 1.0


def _held_corrected(text: Sequence[str], behind: Sequence[str], block: kit.ChannelSamples) -> list[str]:
    """Return warnings if the stated length, peak, interval or units contradict the samples."""
    time, unit = (kit.first_match(_PEAK_2, text, group) for group in (3, 2))
    notes = _held(block, behind, (60, 65, 66), kit.UNITS["cm/s2"], kit.first_match(_LENGTH_2, text), time)
    step, rounding = kit.printed_number(layout.real_header_value(behind, 61))
    if abs(step - block.dt) > 1.01 * rounding:
        value = f"floating-point value 61 of the header states an interval of {step:g} s"
        notes.append(f"{value}, but the heading states {block.dt:g} s")
    others = [match[1] for line in text if (match := _OTHER_PEAKS.match(line))]
    return list(dict.fromkeys(notes)) + (kit.held_lengths_of_units([unit, *others]) if unit else [])


def refuse_spectra(file: kit.SourceFile, options: ReadOptions) -> NoReturn:
    """Raise the error for a volume 3 file, which contains spectra."""
    station = _STATION.search(file.head[:_SPECTRA_OPENING].decode("latin-1"))
    of = f" of station {station[1]}, {' '.join(station[2].split())}" if station else ""
    advice = "read the volume 1 or 2 (.V1, .V2) of the same record"
    raise kit.no_acceleration(f"{file.name}:1", f"an accelerogram{of}", _SPECTRA_WORDS, advice)


def read_renadic(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every channel except dead channels (all zero); raise RecordRefused if all are dead."""
    records = [replace(record, origin_time=None) for record in read_uncorrected(file, options)]
    kept = [record for record in records if record.acceleration.any()]
    if not kept:
        raise RecordRefused(f"{file.name}: all samples of all channels are zero: no sensor was connected")
    dead = ((at, record.component) for at, record in enumerate(records, 1) if not record.acceleration.any())
    notes = [f"channel {at} ({component}) is dead, all samples are zero; it was left out" for at, component in dead]
    return kit.with_warnings(kept, notes)


def _first_times(file: kit.SourceFile) -> dict[str, float]:
    """Return the time of the first sample of each component [s]; if a component occurs twice, the first one is used."""
    lines, spans, _ = layout.channels(file, UNCORRECTED, "Uncorrected Accelerogram Data", layout.HEADER_LINES)
    times: dict[str, float] = {}
    for start, _ in spans:
        component = layout.read_csmip_header(lines[start : start + layout.HEADER_LINES]).full_component.strip()
        times.setdefault(component, float(kit.matched(_FIRST_TIME, lines[start + layout.HEADER_LINES]) or 0.0))
    return times


CSMIP_V1 = Format(
    name="csmip_v1",
    what="CSMIP volume 1, both layouts",
    recognised="first line 'Uncorrected Accelerogram Data'",
    unit="g or g/10, from the header",
    example="CICLC.v1",
    detect=partial(is_uncorrected, renadic=False),
    parse=read_uncorrected,
)
CSMIP_V2 = Format(
    name="csmip_v2",
    what="CSMIP volume 2, the acceleration of each channel",
    recognised="first lines 'Corrected accelerogram' and 'Uncorrected Accelerogram Data'",
    unit="cm/s2, from the heading of the block",
    processed="yes",
    example="CE58667.V2",
    detect=begins_with(_BOTH_TITLES, 1000),
    parse=read_corrected,
)
CSMIP_V3 = Format(
    name="csmip_v3",
    what=_SPECTRA_WORDS,
    recognised=f"first lines like {_SPECTRA}",
    unit="-",
    processed="-",
    example="CE89146.V3",
    detect=begins_with(re.compile(_SPECTRA, re.IGNORECASE), _SPECTRA_OPENING),
    parse=refuse_spectra,
)
RENADIC = Format(
    name="renadic",
    what="RENADIC (Chile) volume 1, parts joined",
    recognised="first line 'Uncorrected Accelerogram Data', RENADIC in the header",
    unit="g/10, from the header",
    example="curico1002271parte1.v1",
    detect=partial(is_uncorrected, renadic=True),
    parse=read_renadic,
    parts=PartRule(re.compile(r"(.*?)[\s_-]*parte?[\s_-]*(\d{1,2})", re.IGNORECASE | re.ASCII), _first_times),
)
