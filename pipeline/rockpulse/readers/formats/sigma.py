"""SIGMA and ITACA ``.acc`` text files (Italy, France) of one corrected component, with header lines ``key : value``.

``Accelaration time series in m/s/s`` (spelled like this in the files) ends the header; the samples follow in fields of
14 characters that may touch. The time in the header is the origin time of the earthquake.
"""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions

_HEADER_LIMIT = 40  # largest number of header lines; usual headers have ten
_LONGEST_LINE = 400
_KEYS = (
    *("event date & time", "station code / name", "network", "orientation", "processing info"),
    *("filter cut-off frequency", "time increment", "number of data", "pga"),
)
_FEWEST_KEYS = 4  # smallest number of keys by which the format is recognised
_LINE = re.compile(r"\s*([A-Za-z][^:(]{0,40}?)\s*(?:\(([^()]{0,20})\)\s*)?:\s*(.*)")
_SERIES = re.compile(r"\s*(acc\w*|vel\w*|disp\w*)\s+time\s+(?:series|history)\s+in\s+(\S+)\s*", re.IGNORECASE)
_OTHERS = {"v": "velocity", "d": "displacement"}
_COUNT = re.compile(r"\d{1,9}", re.ASCII)
_DECIMAL = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,12}|\.\d{1,12})(?:[eEdD][+-]?\d{1,2})?", re.ASCII)
_CORNERS = re.compile(r"(\d{1,6}\.?\d{0,6})\s*-\s*(\d{1,6}\.?\d{0,6})", re.ASCII)
_WIDTH = 14
_LOOK_AT = 50  # number of rows from which the field width is found
#: Usual names of the components whose letters are in the reverse order.
_OTHER_WAY_ROUND = {"WE": "EW", "W-E": "EW", "SN": "NS", "S-N": "NS"}


def is_sigma(head: bytes, name: str) -> bool:
    """Return whether the first lines contain several keys of this format."""
    lines = [line[:_LONGEST_LINE] for line in kit.text_lines(head[: _HEADER_LIMIT * _LONGEST_LINE])[:_HEADER_LIMIT]]
    keys = {match[1].lower() for line in lines if (match := _LINE.match(line))}
    return len(keys.intersection(_KEYS)) >= _FEWEST_KEYS and not keys.isdisjoint(_KEYS[-3:-1])


def read_sigma(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the only component of the file; raise kit.NotAcceleration for velocity and displacement."""
    lines = kit.text_lines(file.content)
    header, kind, unit_text, repeated = _header(file.name, lines)
    where = f"{file.name}:{header.end}"
    if kind in _OTHERS:
        raise kit.no_acceleration(where, "'Acceleration time series'", _OTHERS[kind])
    unit = kit.canonical_unit(unit_text, where)
    step, count = header.get("time increment", kit.Entry(aside="s", line=header.end)), header.text("number of data")
    if not (_DECIMAL.fullmatch(step.text) and step.aside.lower() in ("", "s", "sec")):
        found = f"{step.text[:40]!r} ({step.aside or 'no unit'})"
        raise kit.unexpected(header.where("time increment"), "'Time Increment (s) : dt'", found)
    if not _COUNT.fullmatch(count):
        raise kit.unexpected(header.where("number of data"), "'Number of Data : n'", repr(count[:40]))
    samples, notes = _samples(file.name, lines, header.end, int(count))
    pga, pga_unit = header.text("pga"), unit
    if pga and _DECIMAL.fullmatch(pga):
        pga_unit = kit.canonical_unit(header["pga"].aside or unit_text, header.where("pga"))
    elif pga:
        notes.append(f"line {header['pga'].line}: the peak is not a valid number: {pga[:40]!r}")
        pga = ""
    component, network = header.text("orientation"), header.text("network").partition("(")[0]
    station, _, place = header.text("station code / name").partition("/")
    processed, processing = _processing(header)
    return [
        kit.build_record(
            file,
            samples,
            kit.printed_number(step.text)[0],
            unit,
            processed=processed,
            component=component,
            facing=kit.direction(_OTHER_WAY_ROUND.get(component.upper(), component)),
            network=network.strip(),
            station=station.strip(),
            station_name=place.strip(),
            event=header.text("event date & time"),
            origin_time=kit.written(header.text("event date & time")),
            header_peak=kit.printed_number(pga),
            peak_factor=kit.UNITS[pga_unit],
            warnings=[*repeated, *notes],
            processing=processing,
        )
    ]


def _header(name: str, lines: Sequence[str]) -> tuple[kit.Entries, str, str, tuple[str, ...]]:
    """Return the header entries, the first letter of the kind of motion, the unit, and warnings."""
    header = kit.Entries(name)
    for at, line in enumerate(lines[:_HEADER_LIMIT]):
        if series := _SERIES.fullmatch(line[:_LONGEST_LINE]):
            last = kit.last_of_equal(lines, at)
            header.end = last + 1
            return header, series[1][0].lower(), series[2], kit.repeated_marker(at, last)
        match = _LINE.match(line[:_LONGEST_LINE])
        if not match:
            continue
        key, value = match[1].lower(), kit.Entry(match[3].strip(), (match[2] or "").strip(), at + 1)
        before = header.setdefault(key, value)
        if key in _KEYS and before[:2] != value[:2]:
            found = f"{value.text[:40]!r} and, in line {before.line}, {before.text[:40]!r}"
            advice = "find out which is right and remove the other line"
            raise kit.unexpected(f"{name}:{at + 1}", f"one value of {match[1]!r}", found, advice)
    expected = "the line 'Acceleration time series in m/s/s' below the header"
    raise kit.unexpected(f"{name}:{min(len(lines), _HEADER_LIMIT)}", expected, "none")


def _samples(name: str, lines: Sequence[str], first: int, count: int) -> tuple[np.ndarray, list[str]]:
    """Return the declared samples, split by field width or else at blanks, and warnings about further numbers."""
    rows = [line.rstrip() for line in lines[first : first + _LOOK_AT]]
    kit.check_count(f"{name}:{len(lines)}", count, count if rows else 0)
    lengths = Counter(map(len, rows))
    length = max(lengths, key=lengths.__getitem__)
    if length and length % _WIDTH == 0:
        per_row = length // _WIDTH
        samples = kit.fixed_width(lines[first:], first + 1, _WIDTH, per_row, count, name)
        end = first + -(-count // per_row)
        spare = len(lines[end - 1].rstrip()) // _WIDTH - (count - (end - first - 1) * per_row)
    else:
        total, end = 0, first
        while end < len(lines) and total < count:
            total += len(lines[end].split())
            end += 1
        kit.check_count(f"{name}:{len(lines)}", count, total)
        samples = kit.free_numbers(lines[first:end], first + 1, name)[:count]
        spare = total - count
    notes = [f"line {end}: {spare} numbers beyond the declared count were left out"] if spare > 0 else []
    return samples, [*notes, *kit.surplus(lines, end, len(lines), name, _SERIES)]


def _processing(header: kit.Entries) -> tuple[bool | None, list[str]]:
    """Return whether the record is corrected (None: unknown), and the processing that the file states."""
    words, said = header.text("processing info"), header.text("filter cut-off frequency")
    corners = _CORNERS.fullmatch(said)
    notes = [f"file: {' '.join(words.split())}"] if words else []
    if corners:
        notes.append(f"file: filtered, {float(corners[1]):g}-{float(corners[2]):g} Hz")
    elif said:
        notes.append(f"file: filter {said}")
    if corners or "filter" in words.lower():
        return True, notes
    return (False if words.lower() in ("none", "unprocessed", "raw") else None), notes


SIGMA = Format(
    name="sigma",
    what="SIGMA/ITACA .acc",
    recognised="first lines 'Event Date & Time :', 'Time Increment (s) :', 'Number of Data :'",
    unit="m/s2, from the header",
    processed="by the header",
    example="16837_H2.cor.acc",
    detect=is_sigma,
    parse=read_sigma,
)
