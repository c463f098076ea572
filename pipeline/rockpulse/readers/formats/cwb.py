"""CWB and CWA free-field files of Taiwan.

Lines that begin with ``#`` are followed by rows of the time [s] and the accelerations [gal] of three channels in
4F10.3; fields may touch. Clocks show local time (GMT+08). The files are raw except for the removed offset.
"""

import re
from datetime import datetime

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

_UNIT_LINE = re.compile(r"#[^\0]{0,2000}?[\r\n]#\s*AmplitudeUnit\s*:", re.ASCII | re.IGNORECASE)
_ENTRY = re.compile(r"#\s*([^:(]+)(?:\(([^)]*)\))?\s*:(.*)")
_NUMBER = re.compile(r"\d{1,9}(?:\.\d{0,9})?", re.ASCII)
_FORMAT = re.compile(r"(\d{1,2})F(\d{1,2})\.\d{1,2}", re.ASCII | re.IGNORECASE)
_CHANNEL = re.compile(r"([UVZNE])\s*\(([+-])\)", re.IGNORECASE)
_PEAK = re.compile(r"(-?\d{1,9}\.?\d{0,9})\s*~\s*(-?\d{1,9}\.?\d{0,9})", re.ASCII)
_MOMENT = re.compile(r"(?a)(\d{4})/\s*(\d{1,2})/\s*(\d{1,2})-\s*(\d{1,2}):\s*(\d{1,2}):\s*(\d{1,2}(?:\.\d{0,9})?)")
_ZONE = re.compile(r"GMT\s*([+-]\s*\d{1,2})", re.ASCII | re.IGNORECASE)


def read_cwb(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every channel; `options` is not used, because the file states unit and interval."""
    lines = kit.text_lines(file.content)
    first = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")), len(lines))
    header = kit.Entries(file.name)
    for line, text in enumerate(lines[:first], start=1):
        if match := _ENTRY.match(text[: kit.LONGEST_LINE]):
            header[re.sub(r"[\W_]", "", match[1]).lower()] = kit.Entry(match[3].strip(), match[2] or "", line)
    unit = kit.canonical_unit(header.text("amplitudeunit").partition(".")[0], header.where("amplitudeunit"))
    expected = "a line '#SampleRate(Hz)' with a number of samples per s above 0"
    rate = float(header.positive("samplerate", _NUMBER, expected))
    expected = "a line '#RecordLength(sec)' with a duration above 0"
    length, rounding = kit.printed_number(header.positive("recordlength", _NUMBER, expected))
    sequence, layout = header.get("datasequence", kit.Entry(line=first)), header.get("data", kit.Entry(line=first))
    channels, fields = _CHANNEL.findall(sequence.text), _FORMAT.fullmatch(layout.text)
    if not sequence.text.lower().startswith("time") or not channels:
        expected = "'#DataSequence: Time U(+); N(+); E(+)'"
        raise kit.unexpected(f"{file.name}:{sequence.line}", expected, repr(sequence.text))
    columns, rows = len(channels) + 1, len(lines) - first
    if not fields or int(fields[1]) != columns:
        expected = f"'#Data: {columns}F10.3' for the time and {len(channels)} channels"
        raise kit.unexpected(f"{file.name}:{layout.line}", expected, repr(layout.text))
    kit.check_count(f"{file.name}:{len(lines)}", max(1, int((length - rounding) * rate)), rows, "rows")
    table = kit.fixed_width(lines[first:], first + 1, int(fields[2]), columns, rows * columns, file.name)
    table = table.reshape(rows, columns)
    with np.errstate(over="ignore"):
        even = kit.printed_at(table[:, 0], 1.0 / rate)
    if not even:
        expected = table[0, 0] + np.arange(rows) / rate
        row = int(np.argmax(np.abs(table[:, 0] - expected) > 0.1 / rate))
        should, found = f"the time {expected[row]:g} s ({rate:g} samples per s, header)", f"{table[row, 0]:g} s"
        advice = "rows are missing or the rate is wrong: download the file again"
        raise kit.unexpected(f"{file.name}:{first + row + 1}", should, found, advice)
    start_time, notes = _start_time(header, float(table[0, 0]))
    if rows > (length + rounding) * rate + 1.0:
        notes.append(f"the header states {length:g} s at {rate:g} samples per s, but the file has {rows} rows")
    return [
        kit.build_record(
            file,
            table[:, number],
            1.0 / rate,
            unit,
            number=number,
            processed=False,
            component=f"{letter}({sign})",
            facing=kit.direction(letter) if sign == "+" else kit.direction(letter).opposite,
            channel=letter.upper(),
            station=header.text("stationcode"),
            station_name=header.text("stationname"),
            event=header.text("origintime"),
            start_time=start_time,
            origin_time=_moment(header["origintime"]),
            magnitude=(header.text("magnitude"), header["magnitude"].aside),
            hypocentre=(header.text("epicenterlatitude"), header.text("epicenterlongitude")),
            depth_km=header.text("depth"),
            station_place=(header.text("stationlatitude"), header.text("stationlongitude")),
            header_peak=_peak(header.text(f"amplitudemax{letter.lower()}")),
            warnings=notes,
        )
        for number, (letter, sign) in enumerate(channels, start=1)
    ]


def _start_time(header: kit.Entries, first: float) -> tuple[datetime | None, list[str]]:
    """Return the UTC time of the first sample, and warnings; `first` is its time in the time column [s]."""
    entry = header["starttime"]
    if not entry.text:
        return None, []
    if not _ZONE.search(entry.aside):
        return None, [f"the start time {entry.text!r} names no time zone; it was left out"]
    start = _moment(entry)
    if start is None:
        return None, [f"the start time {entry.text!r} cannot be read"]
    start, notes = kit.near_event(start, _moment(header["origintime"]))
    return kit.later(start, first), notes


def _moment(entry: kit.Entry) -> datetime | None:
    """Return the UTC time of an entry such as 2018/02/06-23:50:29.000; None if its time zone is not stated."""
    moment, zone = _MOMENT.fullmatch(entry.text), _ZONE.search(entry.aside)
    if not moment or not zone:
        return None
    numbers = [float(part) for part in moment.groups()]
    return kit.instant(numbers[:3], numbers[3:], float(zone[1].replace(" ", "")))


def _peak(text: str) -> tuple[float, float]:
    """Return the larger absolute value of a range such as ``-12.3~10.5``, and half a unit of its last digit."""
    stated = _PEAK.fullmatch(text)
    return max(kit.printed_number(text.lstrip("-")) for text in stated.groups()) if stated else kit.printed_number("")


CWB = Format(
    name="cwb",
    what="CWB or CWA free field (Taiwan)",
    recognised="lines that begin with '#', one of them '#AmplitudeUnit:'",
    unit="gal, from the header",
    example="2-EGF.dat",
    detect=begins_with(_UNIT_LINE, 2100),
    parse=read_cwb,
)
