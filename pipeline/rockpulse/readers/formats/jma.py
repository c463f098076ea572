"""Acceleration files of the Japan Meteorological Agency (CSV): seven header lines, then NS, EW, UD in gal.

Times are in Japan Standard Time (UTC+9). The station name is encoded in Shift-JIS.
"""

import re

import numpy as np

from rockpulse.errors import UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions, begins_with

_TITLE = re.compile(r"\s*SITE CODE\s*=", re.IGNORECASE)
_KEY = re.compile(r"\s*([A-Z][A-Z .]*?)\s*=\s*(.*)", re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(?:\d{1,9}\.?\d{0,9}|\.\d{1,9})", re.ASCII)
_RATE = re.compile(r"(\d{1,6}(?:\.\d{0,6})?)\s*(?:HZ)?\s*", re.ASCII | re.IGNORECASE)
_HEADER_LIMIT = 20
_AHEAD = 9.0  # hours by which the clocks of Japan are ahead of UTC
_COMPONENTS = {"NS": "N", "EW": "E", "UD": "Z"}


def read_jma(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read the three components; `options` is not used, because the file states unit and interval."""
    lines = kit.text_lines(file.content)
    entries, first = _header(file.name, lines)
    stated, _, aside = entries.text("UNIT").partition("(")
    unit = kit.canonical_unit(stated, entries.where("UNIT"))
    if aside and kit.UNITS[kit.canonical_unit(aside.strip(" )"), entries.where("UNIT"))] != kit.UNITS[unit]:
        two = f"the entry states two units, {entries.text('UNIT')!r}"
        raise UnitError(f"{entries.where('UNIT')}: {two}; correct the wrong one")
    rate = float(entries.positive("SAMPLING RATE", _RATE, "'SAMPLING RATE= 100Hz'"))
    names = [name.strip().upper() for name in lines[first - 1].split(",") if name.strip()]
    rows = [line.replace(",", " ") for line in lines[first:]]
    table = kit.free_rows(rows, first + 1, len(names), file.name)
    code, *site = (part.strip() for part in entries.text("SITE CODE").split(","))
    station, _, name = code.partition(" ")
    digits = re.match(r"\w+?(?=[^\x00-\x7f]|$)", station)
    place = [entries.text("LAT."), entries.text("LON.")]
    start = [float(part) for part in entries.text("INITIAL TIME").split() if _NUMBER.fullmatch(part)]
    begin = kit.instant(start[:3], start[3:6], _AHEAD) if len(start) == 6 else None
    latitude, longitude = (place if all(place) else [*site, "", ""])[:2]
    return [
        kit.build_record(
            file,
            samples,
            1.0 / rate,
            unit,
            number=number,
            processed=False,
            component=names[number - 1],
            station=digits[0] if digits else station,
            station_name=name.strip(),
            start_time=begin,
            station_place=(latitude, longitude),
            warnings=[] if begin else [f"the start time {entries.text('INITIAL TIME')!r} cannot be read"],
        )
        for number, samples in enumerate(np.ascontiguousarray(table.T), 1)
    ]


def _header(name: str, lines: list[str]) -> tuple[kit.Entries, int]:
    """Return the entries of the header, and the index of the first row of samples."""
    entries = kit.Entries(name, len(lines))
    for at, line in enumerate(lines[:_HEADER_LIMIT], 1):
        text = line[: kit.LONGEST_LINE]
        named = [word.strip().upper() for word in text.split(",") if word.strip()]
        if named and all(word in _COMPONENTS for word in named):
            return entries, at
        match = _KEY.match(text)
        if match:
            entries[match[1].upper()] = kit.Entry(match[2].strip(), line=at)
    expected = f"a line 'NS,EW,UD' among the first {_HEADER_LIMIT}"
    raise kit.unexpected(f"{name}:{min(len(lines), _HEADER_LIMIT)}", expected, "none")


JMA = Format(
    name="jma",
    what="JMA acceleration (Japan Meteorological Agency), CSV",
    recognised="'SITE CODE=' in the first line",
    unit="gal, from the header",
    example="acc.csv",
    detect=begins_with(_TITLE),
    parse=read_jma,
)
