"""Reads lines, header entries, numbers and units of text files, and makes the errors for damaged files."""

import re
from collections.abc import Iterable, Iterator, Sequence
from difflib import get_close_matches
from typing import NamedTuple

import numpy as np

from rockpulse.errors import RecordFormatError, Remedy, UnitError
from rockpulse.readers.source import NotAcceleration, OtherKind
from rockpulse.record.record import STANDARD_GRAVITY

#: Factor of each unit: acceleration in m/s2 = value in the file x factor.
UNITS: dict[str, float] = {"m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 0.001}
UNITS |= {"g": STANDARD_GRAVITY, "g/10": STANDARD_GRAVITY / 10.0}
#: Remedies for a file that states no unit, or no sampling interval.
GIVE_UNIT, GIVE_INTERVAL = Remedy("units", tuple(UNITS)), Remedy("dt")

#: Longest header line that is read [characters]; only damaged lines are longer.
LONGEST_LINE = 200
#: Advice in messages on a damaged header, on another damaged part of a file, and on a truncated file.
HEADER_DAMAGED = "correct the line, or write the samples as columns with their unit"
FILE_DAMAGED = "correct the file"
LINE_DAMAGED = "correct the line"
TRUNCATED = "the file may be truncated: download it again"
#: Advice in messages on a file of velocity or displacement, and on a file of several records.
ACCELERATION_FILE = "read the acceleration file of the same record"
OWN_FILE = "write each record into a file of its own"
_NUMBER_BYTES = b" \t0123456789+-.eEdD"
_FORTRAN_EXPONENT, _FORTRAN_EXPONENT_TEXT = bytes.maketrans(b"dD", b"ee"), str.maketrans("dD", "ee")
_EXPONENT_DIGITS = 4  # characters of the longest exponent of a number, its sign included
_NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eEdD][+-]?\d+)?\s*", re.ASCII)
_RAISED = str.maketrans("⁻²¹", "-21")
_SECOND = r"s(?:ec(?:ond)?s?)?"
#: Pattern of units of acceleration and velocity in running text; ``g`` and ``cm`` are recognised only in brackets.
_MENTIONED = re.compile(
    rf"(?<![a-z0-9])(?:(?:mm|cm|m)[ .·*]?{_SECOND}(?:\^|\*\*)?\(?-(?:(?P<squared>2)|1)\)?|"
    rf"(?:mm|cm|m)(?:/|p| per |/per/){_SECOND}(?P<again>[ /]?(?:\^|\*\*)?2| ?squared|[ /]{_SECOND})?|"
    rf"(?P<other>gals?|milli-?g|%g|(?:in|ft)/{_SECOND}(?:(?:\^|\*\*)?2|/{_SECOND}))|kines?)(?![a-z0-9])"
)
#: Units in headings of columns other than accelerations, in the spelling of `_squeezed`.
_QUANTITIES = {
    "time": "s ms us µs min seg segundos sek sekunden secondi secondes sn saniye millis minutes minuten minuti",
    "velocity": "m/s cm/s mm/s in/s ft/s ms-1 cms-1 mms-1 m.s-1 cm.s-1 kine kines",
    "displacement": "m cm mm in ft",
    "frequency": "hz khz",
    # These units are recognised but not accepted: canonical_unit rejects them.
    "acceleration": "mg millig milli-g %g ft/s2 in/s2 ft/s/s in/s/s mgal count counts volt volts mv "
    "millivolt millivolts",
}
_QUANTITY = {spelling: quantity for quantity, spellings in _QUANTITIES.items() for spelling in spellings.split()}
_CREDIBLE_PGA_G = (1e-3, 3.0)


def unexpected(
    where: str, expected: str, found: str, advice: str = HEADER_DAMAGED, *remedies: Remedy
) -> RecordFormatError:
    """Return the error that states what was expected and what was found at a place ``file:line``."""
    return RecordFormatError(f"{where}: expected {expected}, found {found}; {advice}", *remedies)


def no_acceleration(where: str, expected: str, found: str, advice: str = ACCELERATION_FILE) -> NotAcceleration:
    """Return the error for a file or channel that contains no acceleration, at a place ``file:line``."""
    return NotAcceleration(f"{where}: expected {expected}, found {found}; {advice}")


def other_kind(where: str, kind: str) -> OtherKind:
    """Return the error for a file whose name alone says that it contains velocity or displacement."""
    advice = f"{ACCELERATION_FILE}, or rename the file if it contains accelerations"
    return OtherKind(f"{where}: expected accelerations, found {kind}, as the file name says; {advice}")


def matched(pattern: re.Pattern[str], text: str, group: int = 1) -> str:
    """Return a group of a pattern matched at the start of a text; empty if the pattern does not match."""
    match = pattern.match(text)
    return (match[group] or "") if match else ""


def first_match(pattern: re.Pattern[str], lines: Iterable[str], group: int = 1) -> str:
    """Return a group of a pattern from the first line that begins with it; empty if no line does."""
    found = (match for line in lines if (match := pattern.match(line[:LONGEST_LINE])))
    return next((match[group] or "" for match in found), "")


class Entry(NamedTuple):
    """The value that a header states for a key, the words in brackets after the key, and the line number."""

    text: str = ""
    aside: str = ""
    line: int = 1


class Entries(dict[str, Entry]):
    """The entries of a header by key; a missing key gives an empty entry with the line number `end`."""

    def __init__(self, name: str, end: int = 1) -> None:
        super().__init__()
        self.name, self.end = name, end

    def __missing__(self, key: str) -> Entry:
        return Entry(line=self.end)

    def text(self, key: str) -> str:
        """Return the value of a key; empty if it is blank or missing."""
        return self[key].text

    def where(self, key: str) -> str:
        """Return the place ``file:line`` of a key, for messages."""
        return f"{self.name}:{self[key].line}"

    def positive(self, key: str, pattern: re.Pattern[str], expected: str) -> str:
        """Return the value of a key, or the first group of `pattern` in it; raise an error if it is not above 0."""
        match = pattern.fullmatch(self.text(key))
        if not match or not float(match[match.re.groups and 1]) > 0.0:
            raise unexpected(self.where(key), expected, repr(self.text(key)) if self.text(key) else "none")
        return match[match.re.groups and 1]


def text_lines(content: bytes) -> list[str]:
    """Return the lines (at least one) of a file in UTF-8 or Latin-1; blank lines and Ctrl-Z at its end are removed."""
    content = content.rstrip(b"\x1a\x00 \t\r\n").replace(b"\r\n", b"\n")
    if b"\r" in content:
        content = b"\n".join(line.rstrip(b"\r") for line in content.split(b"\n")).replace(b"\r", b"\n")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return text.split("\n")


def printed_number(text: str) -> tuple[float, float]:
    """Return a number and half a unit of its last digit: 39.1 and 0.05 for "3.91E+1"; NaN and 0 for other text."""
    mantissa, _, exponent = text.strip().lower().replace("d", "e").partition("e")
    value = float(text.lower().replace("d", "e") or "nan")
    # int() rejects texts of thousands of digits.
    if not np.isfinite(value) or len(exponent) > _EXPONENT_DIGITS:
        return float("nan"), 0.0
    return value, float(f"5e{int(exponent or 0) - len(mantissa.partition('.')[2]) - 1}")


def check_count(where: str, declared: int, available: int, unit: str = "samples") -> None:
    """Raise an error if a declared count is not positive or exceeds what the file can contain."""
    if declared < 1:
        raise RecordFormatError(f"{where}: expected a positive number of {unit} in the header, found {declared}")
    if available < declared:
        raise unexpected(where, f"{declared} {unit} (header)", str(available), TRUNCATED)


def _floats(fields: Sequence[bytes] | np.ndarray, where: str, located: Iterator[tuple[int, str]]) -> np.ndarray:
    """Return all fields as numbers; raise an error with the line of the first damaged field."""
    try:
        values = np.array(fields, dtype=float)
    except ValueError:
        values = np.array([np.nan])
    if np.all(np.isfinite(values)):
        return values
    for line, field in located:
        if not _NUMBER.fullmatch(field) or not np.isfinite(float(field.translate(_FORTRAN_EXPONENT_TEXT))):
            found = repr(field.strip()[:40] or "a blank field")
            raise unexpected(f"{where}:{line}", "a finite number", found, "correct the line")
    raise RecordFormatError(f"{where}: expected finite numbers, found a field without one; correct the fields")


def fixed_width(lines: Sequence[str], first: int, width: int, per_row: int, count: int, where: str) -> np.ndarray:
    """Return the first `count` numbers of rows with fields of equal width; `first` is the line number of `lines[0]`."""
    if width < 1 or per_row < 1:
        found = f"{per_row} fields of {width} characters from line {first} on"
        raise unexpected(where, "fields of at least 1 character, at least 1 in a row", found)
    block = [row.rstrip() for row in lines[: max(-(-count // per_row), 0)]]
    _check_rows(block, first, width, per_row, count, where)
    text = "".join(block)[: count * width]
    joined = text.encode("ascii", errors="replace")  # a character beyond ASCII cannot become part of a number
    located = ((first + index // per_row, text[index * width : (index + 1) * width]) for index in range(count))
    if joined.translate(None, _NUMBER_BYTES):
        return _floats([b"nan"], where, located)
    return _floats(np.frombuffer(joined.translate(_FORTRAN_EXPONENT), dtype=f"S{width}"), where, located)


def _check_rows(block: Sequence[str], first: int, width: int, per_row: int, count: int, where: str) -> None:
    """Raise an error for the first row whose length does not fit its number of fields."""
    rows = -(-count // per_row)
    full = width * per_row
    for index, row in enumerate(block):
        if index == len(block) - 1:  # the end of a truncated file
            available = index * per_row + -(-len(row) // width)
            check_count(f"{where}:{first + len(block)}", count, available, "numbers")
        last = index == rows - 1
        fields = count - index * per_row if last else per_row
        if len(row) > full or (len(row) < fields * width if last else len(row) != full):
            expected, found = f"{fields} fields of {width} characters", f"a row of {len(row)} characters"
            raise unexpected(f"{where}:{first + index}", expected, found, LINE_DAMAGED)
    if not block:
        check_count(f"{where}:{first}", count, 0, "numbers")


def free_numbers(lines: Sequence[str], first: int, where: str) -> np.ndarray:
    """Return the numbers of rows separated by blanks; `first` is the line number of `lines[0]`."""
    joined = "\n".join(lines).encode("ascii", errors="replace")
    located = ((first + index, field) for index, line in enumerate(lines) for field in line.split())
    if joined.translate(None, _NUMBER_BYTES + b"\n\r\f\v"):
        return _floats([b"nan"], where, located)
    return _floats(joined.translate(_FORTRAN_EXPONENT).split() or np.empty(0), where, located)


def free_rows(lines: Sequence[str], first: int, columns: int, where: str) -> np.ndarray:
    """Return the numbers of rows separated by blanks as an array (rows, columns)."""
    row = next((row for row, line in enumerate(lines) if len(line.split()) != columns), None)
    if row is not None:
        raise unexpected(f"{where}:{first + row}", f"a row of {columns}", repr(lines[row][:60].strip()), LINE_DAMAGED)
    return free_numbers(lines, first, where).reshape(-1, columns)


def canonical_unit(text: str, where: str) -> str:
    """Return the key of `UNITS` for the spelling of a unit; raise UnitError, with the place `where`, if unknown."""
    unit = spelled_unit(text)
    if unit not in UNITS:
        quantity = quantity_of(text)
        of = f", which is a unit of {quantity}" if quantity and quantity != "acceleration" else ""
        of_user = where.startswith(("option", "--")) or "[records]" in where
        advice = "" if of_user else "; correct the file, or write columns and give their unit"
        near = "".join(f' (did you mean "{close}"?)' for close in get_close_matches(unit, UNITS, n=1))
        found = f"unknown unit of acceleration {text[:40]!r}{of}{near}"
        raise UnitError(f"{where}: {found}; expected one of {', '.join(UNITS)}{advice}")
    return unit


def for_other_files(option: str) -> str:
    """Return the advice for an option of the command line that contradicts a statement in a file."""
    return (
        f"correct the wrong one; or, if {option} is meant for other files, give it for them only ([[records.file]] "
        f"in the configuration), or convert them first, so that they state it (rockpulse convert FILE {option} -o "
        "FILE.csv)"
    )


def _squeezed(text: str) -> str:
    unit = re.sub(r"[\s^*]|\.$", "", text.strip().lower().translate(_RAISED))
    return re.sub(r"se[cg](?:ond|undo)?s?|(?<=/)sn", "s", unit)


def spelled_unit(text: str) -> str:
    """Return the key of `UNITS` for a spelling of a unit; return an unknown unit in lower case."""
    unit = re.sub(r"(?:/s/s|[.·]?s-2|/?per/?s2|ps2|(?<=m)/s/2|/s?squared)$", "/s2", _squeezed(text).replace("_", "/"))
    return {"gals": "gal", "(g)": "g", "g's": "g", "gs": "g"}.get(unit, unit)


def quantity_of(text: str) -> str:
    """Return the quantity of a unit: acceleration, velocity, displacement, time or frequency; empty if unknown."""
    return "acceleration" if spelled_unit(text) in UNITS else _QUANTITY.get(_squeezed(text), "")


def mentioned_units(text: str) -> Iterator[tuple[str, str, int]]:
    """Yield the quantity, spelling and index of each unit in a text such as ``acc_cm_s2``."""
    for match in _MENTIONED.finditer(text.lower().translate(_RAISED).replace("_", "/")):
        squared = match["again"] or match["squared"] or match["other"]
        wording = text[match.start() : match.end()] if text.isascii() else match[0]
        yield "acceleration" if squared else "velocity", wording, match.start()


def other_readings(peak: float, unit: str = "") -> str:
    """Return a text with the units in which a peak would be an ordinary acceleration."""
    low, high = _CREDIBLE_PGA_G
    own = UNITS.get(unit)
    others = {name: factor for name, factor in UNITS.items() if name != "gal" and factor != own}
    readings = {name: peak * factor / STANDARD_GRAVITY for name, factor in others.items()}
    fitting = [f"{value:.3g} g if it is {name}" for name, value in readings.items() if low <= value <= high]
    if fitting:
        return " or ".join(fitting)
    nearest = (max if max(readings.values()) < low else min)(readings, key=lambda name: readings[name])
    return f"{readings[nearest]:.3g} g if it is {nearest}, which is not an ordinary acceleration either"
