"""PEER AT2 files: a few header lines, then equally spaced accelerations in g.

The database delivers the files with a list, ``_SearchResults.csv``, that names the files of each record. The
distances Rjb and Rrup in this list are not used, as they are measured to the rupture and not to the epicentre.
"""

import csv
import re
from collections.abc import Sequence
from functools import lru_cache
from itertools import takewhile

import numpy as np

from rockpulse.errors import RecordFormatError, RockpulseError, UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.warning_text import WarningText

_HEADER_LIMIT = 10
# 5,000 means five thousand; 1/200 is not accepted.
_COUNT = r"(?P<count>\d{1,3}(?:,\d{3})+(?![\d.])|\d+)"
_STEP = r"(?P<step>[+-]?(?:\d+\.?\d*|\.\d+)(?:[ED][+-]?\d+)?)(?![\d.ED]|\s*/\s*\d)"
_NPTS, _DT = r"(?:NPTS|(?:NUMBER|NO\.?) OF POINTS)", r"(?:\bDT|TIME STEP)"
_BOTH = rf"{_NPTS}\s*[,;&]?\s*{_DT}\b(?:\s*\(\w+\))?"
#: Patterns of the line with number of points and interval.
_COUNT_AND_STEP = [
    re.compile(
        rf"{_NPTS}\s*[=:][\s\",]*{_COUNT}.*?{_DT}\s*(?:\(\w+\))?\s*[=:][\s\",]*{_STEP}", re.IGNORECASE | re.ASCII
    ),
    re.compile(rf"{_DT}\s*(?:\(\w+\))?\s*[=:]\s*{_STEP}.*?{_NPTS}\s*[=:]\s*{_COUNT}", re.IGNORECASE | re.ASCII),
    re.compile(rf"^\s*{_COUNT}[\s,]+{_STEP}[\s,]+(?:SEC\w*[\s,]+)?{_BOTH}", re.IGNORECASE | re.ASCII),
    re.compile(rf"{_BOTH}\s*[=:]?\s*{_COUNT}[\s,]+{_STEP}", re.IGNORECASE | re.ASCII),
]
#: Pattern of a line without words, below the line of the unit, with number of points and interval.
_BARE = re.compile(rf"\s*(?P<count>[1-9]\d{{1,8}})[\s,]+{_STEP}\s*(?:SEC\w*)?\s*", re.IGNORECASE | re.ASCII)
_NAMES_BOTH = [re.compile(words, re.IGNORECASE) for words in (_NPTS, rf"{_DT}\b")]
_MILLISECONDS = re.compile(r"(?<![a-z])m(?:illi)?s(?:ec\w*)?\b", re.IGNORECASE)
_UNIT = re.compile(r"UNITS?\s*(?:OF|ARE|IN|IS|[:=])\s*[(\[]?([^\s)\],;]+)", re.IGNORECASE)
_SERIES = re.compile(r"(?i)\b(ACCELERATION|VELOCITY|DISPLACEMENT|(?:ACC(?:EL)?|VEL|DISPL?)(?=\.?\s+(?:TIME|HIST)))\b")
#: Pattern of a unit after the name of the series without the word UNITS: (G), IN G, CM/SEC/SEC.
_WITHOUT_WORD = re.compile(
    r"\.?S?(?:\s+(?:TIME|SERIES|HISTORY|DATA|RECORD|VALUES))*[\s,:-]*"
    r"(?:[(\[]\s*(?P<bracket>%?\s*G(?:'?S)?|MG|GALS?|(?:MM|CM|M|IN|FT)\s*(?:/|PER\b|S)[^)\]]*)[)\]]"
    r"|IN\s+(?P<named>%?G|MG|GALS?)\b|(?:IN\s+)?(?P<bare>(?:MM|CM|M|IN|FT)/[^\s,;]+))",
    re.IGNORECASE,
)
_DATE = re.compile(r"\d+[/-]\d+[/-]\d+.*")
#: Patterns of the lines of a rotated record: its two source directions, and its own direction.
_ROTATED = re.compile(r"\s*H\d FOR ROTATION\s*:\s*", re.IGNORECASE)
_TURNED = re.compile(r"\b(\w{1,12}) COMPONENT\s*,?\s*AZIMUTH\s*[=:]?\s*(\d{1,3}(?:\.\d*)?)", re.IGNORECASE | re.ASCII)
_SCALE = re.compile(r"\b(?:SCALE FACTOR|SCALED BY)\s*[=:]?\s*(\d*\.?\d+(?:E[+-]?\d+)?)", re.IGNORECASE | re.ASCII)
#: Patterns of an interval and a peak [g] in further header lines (SHAKE2000, NRC).
_OTHER_STEP = re.compile(rf"\bDT\s*[=:]\s*{_STEP}", re.IGNORECASE | re.ASCII)
_PEAK = re.compile(
    r".*?\b(?:AMAX\s*[=:]|PEAK ACCELERATION\s*\(G\)\s*[=:])[\s\",]*(-?\d*\.\d+(?:E[+-]?\d+)?)", re.IGNORECASE | re.ASCII
)
#: Pattern of text in brackets after a component; the line may end before the closing bracket.
_BEHIND = re.compile(r"\s*\([^()]*\)?\s*$")
#: Pattern of the boundary of two numbers that only the sign of the second separates (an exponent has a letter).
_TOUCHING = re.compile(r"(?<=[\d.])(?=[+-])")
#: Patterns of the first line of files from rockpulse, and of files from PEER, which are always corrected.
_WRITTEN = re.compile(r"(\w+) RECORD( ON A STRUCTURE)?, WRITTEN BY ROCKPULSE")
_PEER = re.compile(r"\bPEER\b|\bNGA\b|\bSTRONG[\s-]MOTION DATA(?:BASE)?\b", re.IGNORECASE)
_VALUE = re.compile(r"\s*[+-]?\.?\d")
_WIDTHS = (15, 10, 16, 12, 8, 13, 14, 11, 9)
_LIST, _LIST_BEGINS, _UNLISTED = "_SearchResults.csv", "record sequence number", ("", "", "", "")


def _header_end(lines: Sequence[str], complete: bool = False) -> int | None:
    """Return the index of the header line with the number of points (if `complete`, also the interval), or None."""
    above = ""
    for index, line in enumerate(text[: kit.LONGEST_LINE] for text in lines[:_HEADER_LIMIT]):
        bare = _BARE.fullmatch(line)
        if _NAMES_BOTH[0].search(line) or (bare and _SERIES.search(above) and _UNIT.search(above)):
            # A line without digits contains the headings of a table.
            both = re.search(r"(?<![\w.])\.?\d", line) and (bare or all(word.search(line) for word in _NAMES_BOTH))
            return index if not complete or (both and "\x00" not in "".join(lines[: index + 1])) else None
        above = line
    return None


def is_at2(head: bytes, name: str) -> bool:
    """Return whether one of the first lines of a text contains NPTS and DT."""
    return _header_end(kit.text_lines(head[:2000]), complete=True) is not None


def read_at2(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only channel of the file; the unit of `options` is used only if the header states no unit."""
    lines = kit.text_lines(file.content)
    end = _header_end(lines, complete=True)
    if end is None:
        raise kit.unexpected(file.name, f"NPTS and DT in one of the first {_HEADER_LIMIT} lines", "none", "is it AT2?")
    # A few words, such as the Fortran format, may precede the first row of numbers.
    rows = range(end + 1, min(len(lines), end + 1 + _HEADER_LIMIT))
    first = next((index for index in rows if _VALUE.match(lines[index])), end + 1)
    header = [line[: kit.LONGEST_LINE] for line in lines[:first]]
    event, station, component, facing = _title(header[: end + 1])
    unit = _unit(file, header, station, options.units)
    matches = (pattern.search(header[end]) for pattern in _COUNT_AND_STEP)
    match = next(filter(None, matches), None) or _BARE.fullmatch(header[end])
    if match is None:
        expected, advice = "'NPTS= 4000, DT= .01 SEC' or '4000 .01 NPTS, DT'", "write the line in one of these ways"
        raise kit.unexpected(f"{file.name}:{end + 1}", expected, repr(header[end].strip()), advice)
    count, step = int(match["count"].replace(",", "")), float(re.sub("[dD]", "e", match["step"]))
    if not (np.isfinite(step) and step > 0.0) or _MILLISECONDS.search(header[end]):
        raise RecordFormatError(f"{file.name}:{end + 1}: expected a positive DT in s, found {header[end].strip()!r}")
    stop, behind = _numbers_stop(file.name, lines, first, count)
    samples, warnings = _samples(file.name, lines[:stop], first, count)
    facing, direction_notes = _facing(file, header, facing)
    peak = kit.first_match(_PEAK, header)
    written = _WRITTEN.match(header[0])
    # PEER records are corrected; files of rockpulse state it in the title, other files do not.
    processed = True if _PEER.search(header[0]) else None
    if written:
        processed = {"CORRECTED": True, "UNCORRECTED": False}.get(written[1])
    (listed_event, listed_station, magnitude, vs30), notes = _list_entry(file)
    return [
        kit.build_record(
            file,
            samples,
            step,
            unit,
            processed=processed,
            structural=bool(written and written[2]),
            component=component,
            facing=facing,
            channel="" if component else facing.label,
            station_name=station or listed_station,
            event=event or listed_event,
            header_peak=kit.printed_number(peak),
            peak_factor=kit.UNITS["g"] if peak else None,
            magnitude=(magnitude, ""),
            vs30=vs30,
            warnings=[*warnings, *behind, *notes, *direction_notes, *_header_warnings(header, end, step)],
        )
    ]


def _title(header: Sequence[str]) -> tuple[str, str, str, kit.Direction]:
    """Return event, station name, component, and direction of the component from the lines of the title.

    The component is the last part of the second line that is a direction; a network in brackets, perhaps truncated, may
    follow.
    """
    line = header[1] if len(header) > 2 else ""
    if header[0].startswith('"'):  # SHAKE2000: event, station, component
        named = [part.strip() for part in header[0].replace('"', "").split(",")][:3]
        component = named[2] if len(named) > 2 else ""
        return named[0], named[1] if len(named) > 1 else "", component, kit.heading_direction(component)
    title = [part.strip() for part in _ROTATED.sub("", line).split(",")]
    # Names of events have commas too: "Chi-Chi, Taiwan, 9/20/1999, CHY101, E".
    dated = [index for index, part in enumerate(title[1:-1], 1) if _DATE.fullmatch(part)]
    event = dated[0] + 1 if dated else 1
    at, component, facing = len(title) - 1, "", kit.Direction()
    for index in range(len(title) - 1, max(event - 1, len(title) - 4, 0), -1):
        words = _BEHIND.sub("", title[index])
        found = _component_direction(words)
        last = index == len(title) - 1 or title[index + 1].startswith("(")
        if found.orientation != "unknown" or (words and last and not component):
            at, component, facing = index, words, found
        if found.orientation != "unknown":
            break
    turned = next((match for text in header if (match := _TURNED.search(text))), None)
    if turned:
        component, facing = f"{turned[1]} {float(turned[2]):g}", kit.Direction("horizontal", float(turned[2]) % 360.0)
    elif _ROTATED.match(line):
        component, facing = "", kit.Direction()
    return ", ".join(title[:event]), ", ".join(title[event:at]), component, facing


def _component_direction(words: str) -> kit.Direction:
    """Return the direction of a component; a number is an azimuth even without leading zeros (9 for 009)."""
    facing = kit.direction(words.zfill(3) if words.isdecimal() else words)
    return facing if facing.orientation != "unknown" else kit.heading_direction(words)


def _facing(file: kit.SourceFile, header: Sequence[str], titled: kit.Direction) -> tuple[kit.Direction, list[str]]:
    """Return the direction from title or file name, and warnings; a vertical direction has priority."""
    if titled.orientation != "unknown" and file.path.stem[-1:].isdecimal():
        return titled, []
    named = kit.name_direction(file)
    if titled.orientation == "unknown":
        titled = kit.stated_direction(header)
    if titled.orientation == "unknown" or named.orientation == "unknown":
        return (named if titled.orientation == "unknown" else titled), []
    if named.orientation == titled.orientation:
        return titled, []
    upright = named if named.orientation == "vertical" else titled
    return upright, ["title and file name disagree on whether the channel is vertical; it is used as vertical"]


def _header_warnings(header: Sequence[str], end: int, step: float) -> list[str]:
    """Return warnings about stated scale factors, and about lines that contradict the interval `step` in line `end`."""
    notes: list[str] = []
    for number, line in enumerate(header, 1):
        other, scale = _OTHER_STEP.search(line), _SCALE.search(line)
        if other and number != end + 1 and float(other["step"].lower()) != step:
            used = f"an interval of {float(other['step'].lower()):g} s, but line {end + 1} {step:g} s, which is used"
            notes.append(f"line {number} of the header states {used}")
        notes += [WarningText("scale_stated", factor=float(scale[1].lower()))] if scale else []
    return notes


def _numbers_stop(name: str, lines: Sequence[str], first: int, count: int) -> tuple[int, list[str]]:
    """Return the index of the line after the numbers, and a warning if words and then more numbers follow."""
    stop = kit.end_of_numbers(lines, first)
    if stop == len(lines) or sum(len(line.split()) for line in lines[first:stop]) < count:
        return len(lines), []
    behind = lines[stop:]
    if _header_end(behind) is not None:
        found, advice = f"{behind[0][:60].strip()!r}, the beginning of another record", kit.OWN_FILE
        raise kit.unexpected(f"{name}:{stop + 1}", "the end of the file", found, advice)
    rows = sum(bool(_VALUE.match(line)) for line in behind)
    found = f"line {stop + 1}: the numbers stop at {behind[0][:60].strip()!r}; {rows} rows of numbers after it"
    return stop, [f"{found} were left out"] if rows else []


def _unit(file: kit.SourceFile, header: Sequence[str], station: str, given: str | None) -> str:
    name = file.name
    for index, line in enumerate(header):
        series = _SERIES.search(line)
        unit = _UNIT.search(line)
        if not (series or unit):
            continue
        if series and not series[1].upper().startswith("ACC"):
            of = f" of station {station}" if station else ""
            expected, advice = f"an acceleration series{of}", "read the AT2 file of the same record"
            raise kit.no_acceleration(f"{name}:{index + 1}", expected, repr(line.strip()), advice)
        if unit:
            return kit.canonical_unit(unit[1], f"{name}:{index + 1}")
        behind = _WITHOUT_WORD.match(line, series.end()) if series else None
        if behind:
            return kit.canonical_unit(next(filter(None, behind.groups())), f"{name}:{index + 1}")
    if kit.kind_of_name(file) not in ("", "acceleration"):
        raise kit.other_kind(name, kit.kind_of_name(file))
    if given is None:
        raise UnitError(
            f"{name}: expected a header line 'ACCELERATION TIME SERIES IN UNITS OF G', found none; to state the "
            f"unit, {kit.GIVE_UNIT.advice(name)}",
            kit.GIVE_UNIT,
        )
    return kit.canonical_unit(given, "option units")


def _samples(name: str, lines: Sequence[str], first: int, count: int) -> tuple[np.ndarray, list[str]]:
    """Return samples and warnings; numbers are separated at blanks or, if they touch, by the width of the fields."""
    block = lines[first:]
    try:
        values = kit.free_numbers(block, first + 1, name)
        fault = None
    except RecordFormatError as error:
        values, fault = np.empty(0), error
    if values.size < count and block:
        parted = [_TOUCHING.sub(" ", line) for line in block]
        if sum(len(line.split()) for line in parted) == count:
            return kit.free_numbers(parted, first + 1, name), []
        touching = _by_width(name, block, first, count)
        if touching is not None:
            return touching, []
    if fault is not None:
        raise fault
    kit.check_count(f"{name}:{len(lines)}", count, values.size)
    surplus, row = values.size - count, len(block[0].split())
    rows = sum(1 for line in block if line.strip())
    if row > 1 and rows == count:
        found = f"{rows} rows of {row}: columns, such as time and acceleration, instead of one series"
        advice = "remove the lines above the numbers and read the file as columns, or keep the accelerations only"
        raise kit.unexpected(f"{name}:{first + 1}", f"{count} numbers (NPTS)", found, advice)
    if surplus > row:
        found, advice = str(values.size), "find out which is right and repair the header"
        raise kit.unexpected(f"{name}:{first + 1}", f"{count} numbers (NPTS)", found, advice)
    notes = [f"{surplus} values beyond the NPTS= {count} of the header were left out"] if surplus else []
    return values[:count], notes


def _by_width(name: str, block: Sequence[str], first: int, count: int) -> np.ndarray | None:
    """Return the samples of rows with fields of equal width; None if the rows fit no usual width."""
    length = len(block[0].rstrip())
    for width in _WIDTHS:
        if length < width or length % width or -(-count // (length // width)) != len(block):
            continue
        try:
            return kit.fixed_width(block, first, width, length // width, count, name)
        except RecordFormatError:
            continue  # another width may fit; if none does, the caller reports the first fault
    return None


def _list_entry(file: kit.SourceFile) -> tuple[tuple[str, str, str, str], list[str]]:
    """Return event, station, magnitude and Vs30 from PEER's list in the folder, and a warning if it is unreadable."""
    try:
        content = file.beside(_LIST)
        rows = {} if content is None else _rows(content)
    except (RockpulseError, OSError) as fault:
        return _UNLISTED, [f"{_LIST} in the same folder cannot be read, magnitude and Vs30 are unknown: {fault}"]
    return rows.get(file.path.name.lower(), _UNLISTED), []


@lru_cache(maxsize=4)
def _rows(content: bytes) -> dict[str, tuple[str, str, str, str]]:
    """Return event, station, magnitude and Vs30 for each file name (in lower case) in the list of a folder."""
    found: dict[str, tuple[str, str, str, str]] = {}
    reader = ([cell.strip() for cell in cells] for cells in csv.reader(kit.text_lines(content), skipinitialspace=True))
    try:
        lowered = ([cell.lower() for cell in cells] for cells in reader)
        heads = next((cells for cells in lowered if _LIST_BEGINS in cells), [])
        for cells in takewhile(lambda cells: len(cells) >= len(heads) and any(cells), reader):
            entries = dict(zip(heads, cells, strict=False))
            names = [value for head, value in entries.items() if "filename" in head.replace(" ", "")]
            vs30 = next((value for head, value in entries.items() if head.startswith("vs30")), "")
            event = " ".join(filter(None, (entries.get("earthquake name"), entries.get("year"))))
            row = (event, entries.get("station name", ""), entries.get("magnitude", ""), vs30)
            found |= {name.replace("\\", "/").rpartition("/")[2].lower(): row for name in names}
    except csv.Error as fault:
        raise RecordFormatError(f"{_LIST}: cannot be read as CSV: {fault}") from fault
    return found


AT2 = Format(
    name="at2",
    what="PEER AT2",
    recognised="a line with NPTS and DT near the top, or with both numbers below the line of units",
    unit="g, from the header",
    processed="by title",
    example="RSN763_LOMAP_GIL067.AT2",
    detect=is_at2,
    parse=read_at2,
)
