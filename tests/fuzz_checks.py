"""What the fuzzer holds against a record: the promises that every record keeps, and the facts of the file's header.

The header of a damaged file still states facts: number of samples, interval, unit, peak, length. They are looked for
line by line and apart from the readers, and a record that is read without a warning has to be like them.
"""

import codecs
import re
from collections.abc import Callable, Iterator, Sequence
from datetime import timedelta

import numpy as np

from rockpulse.record.record import STANDARD_GRAVITY, Record

__all__ = ["CHECKED", "broken_promise", "contradiction"]

#: A stated peak that is further off than this factor has to be told.
PEAK_FACTOR = 1.5
_FACTORS = {"cm/s^2": 0.01, "cm/s2": 0.01, "m/s^2": 1.0, "m/s2": 1.0, "m/s/s": 1.0, "g": STANDARD_GRAVITY}

Fact = tuple[str, str]


def broken_promise(records: list[Record]) -> str:
    """What is wrong with what a reader returned, or nothing."""
    if not records:
        return "no record and no error"
    for record in records:
        promises = {
            "at least two finite samples": record.npts >= 2 and bool(np.all(np.isfinite(record.acceleration))),
            "a positive interval": bool(np.isfinite(record.dt)) and record.dt > 0.0,
            "an id and a format": bool(record.id and record.format and record.source),
            "UTC": record.start_time is None or record.start_time.utcoffset() == timedelta(0),
            "a known orientation": record.orientation in ("horizontal", "vertical", "structural", "unknown"),
            "an azimuth below 360": bool(np.isnan(record.azimuth)) or 0.0 <= record.azimuth < 360.0,
            "warnings in words": all(isinstance(note, str) and note for note in record.warnings),
            "processed or not": record.processed in (True, False, None),
        }
        broken = [promise for promise, kept in promises.items() if not kept]
        if broken:
            return f"{record.id}: expected {', '.join(broken)}"
    return ""


def _lines(content: bytes) -> list[str]:
    coding = "utf-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "latin-1"
    return re.split(r"[\r\n]+", content.decode(coding, errors="replace"))


def _until_numbers(lines: Sequence[str]) -> list[str]:
    """The lines in front of the first that begins with a number and has no words."""
    first = next((at for at, line in enumerate(lines) if re.match(r"\s*[+-]?\.?\d[^A-DF-Za-df-z]*$", line)), len(lines))
    return list(lines[:first])


def _stated(lines: Sequence[str], patterns: dict[str, str]) -> Iterator[Fact]:
    """Each fact that a line states, as its name and its text."""
    for line in lines:
        for fact, pattern in patterns.items():
            match = re.fullmatch(pattern, line)
            if match and match[1].strip():
                yield fact, match[1].strip()


_DYNA = {
    "count": r"NDATA:(.*)",
    "step": r"SAMPLING_INTERVAL_S:(.*)",
    "unit": r"UNITS:(.*)",
    "gal": r"PGA_CM/S\^2:(.*)",
    "length": r"DURATION_S:(.*)",
    "peak time": r"TIME_PGA_S:(.*)",
}
_SIGMA = {
    "count": r"Number of Data\s*:(.*)",
    "step": r"Time Increment \(s\)\s*:(.*)",
    "unit": r"Accelaration time series in (\S+)\s*",
    "m/s2": r"PGA \(m/s/s\)\s*:(.*)",
}
_WORDS = {
    "count": r"(\d+) points at equal spacing of .*",
    "step": r".* points at equal spacing of (\S+) sec",
    "unit": r"The units are \((\S+)\)",
}


def _dyna(lines: Sequence[str]) -> Iterator[Fact]:
    title = next((at for at, line in enumerate(lines) if line.startswith("EVENT_NAME:")), 0)
    keys = (at for at in range(title, len(lines)) if not re.match(r"[A-Z][A-Z0-9_/^]*:", lines[at]))
    yield from _stated(lines[title : next(keys, len(lines))], _DYNA)


#: By format, the facts of a header.
CHECKED: dict[str, Callable[[Sequence[str]], Iterator[Fact]]] = {
    "dyna": _dyna,
    "sigma": lambda lines: _stated(_until_numbers(lines), _SIGMA),
    "columns": lambda lines: _stated(_until_numbers(lines), _WORDS),
}


def contradiction(record: Record, content: bytes) -> str:
    """A fact of the header that the record is not like, in words; empty if there is none or a warning was given."""
    if record.warnings or record.format not in CHECKED:
        return ""
    for fact, text in CHECKED[record.format](_lines(content)):
        if not _agrees(record, fact, text):
            return f"{record.id}: read without a warning, but the header states the {fact} {text!r}"
    return ""


def _agrees(record: Record, fact: str, text: str) -> bool:
    if fact == "unit":
        return abs(record.unit_factor) == _FACTORS.get(text.lower(), abs(record.unit_factor))
    try:
        value = float(text.lower().replace("d", "e"))
    except ValueError:  # damaged: it states nothing
        return True
    if not np.isfinite(value):
        return True
    if fact == "count":
        return record.npts == value
    if fact == "step":
        return abs(record.dt - value) <= 1e-9 * abs(value)
    if fact == "length":
        return abs(record.npts * record.dt - value) <= 2.5 * record.dt
    if fact == "peak time":
        at = value / record.dt
        beside = np.abs(record.acceleration[max(round(min(at, record.npts)) - 3, 0) :][:7])
        return bool(np.max(beside, initial=0.0) >= record.pga / PEAK_FACTOR)
    stated = abs(value) * {"gal": 0.01, "m/s2": 1.0}[fact]
    return record.pga / PEAK_FACTOR <= stated <= PEAK_FACTOR * record.pga
