"""Compares the statements of a header with the data, and returns warnings about contradictions."""

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from rockpulse.readers.kit.direction import Direction
from rockpulse.readers.kit.text import FILE_DAMAGED, OWN_FILE, UNITS, fixed_width, printed_number, unexpected
from rockpulse.warning_text import WarningText

#: Tolerance of a stated length [steps], which may count the samples or the steps between them.
LENGTH_STEPS = 2.0
#: Ratio of the stated length to that of the samples, or its inverse, above which interval or count may be wrong.
LENGTH_RATIO = 1.5
#: Number of samples on either side of the stated time of the peak, and share of the peak that one of them must reach.
_BESIDE_PEAK, _PEAK_SHARE = 2, 0.9
_TURN = 1.0  # largest difference between two stated values of the same azimuth [degrees]
_NUMBER = re.compile(r"\s*[+-]?(?:\d{1,9}\.?\d{0,12}|\.\d{1,12})(?:[eEdD][+-]?\d{1,2})?\s*", re.ASCII)
_LENGTH = re.compile(r"(mm|cm|m|in|ft)s?(?=/|\s|$)", re.IGNORECASE)
_LONGEST_LINE = 400  # number of characters of a line that are searched for a title
#: Index of the first line of a part of a file, and index of the line after its last line.
Span = tuple[int, int]


def held_length(text: str, count: int, dt: float, spare: float = 0.0) -> list[str]:
    """Return a warning if the stated length `text` [s] contradicts `count` samples at `dt`; `spare` adds tolerance."""
    if not _NUMBER.fullmatch(text):
        return []
    stated, rounding = printed_number(text)
    if abs(stated - count * dt) <= LENGTH_STEPS * dt * (1.0 + 1e-9) + 1.01 * rounding + spare:
        return []
    warning = WarningText("length_differs", stated=stated, count=count, interval=dt, found=count * dt, decides=True)
    differs = stated > 0.0 and not 1.0 < LENGTH_RATIO * stated / (count * dt) < LENGTH_RATIO**2
    return [warning if differs else str(warning)]


def held_peak_time(text: str, times: np.ndarray, values: np.ndarray) -> list[str]:
    """Return a warning if the samples are small at the time `text` [s] at which the header states the peak."""
    if not _NUMBER.fullmatch(text) or times.size < 2:
        return []
    stated, rounding = printed_number(text)
    peak, step = float(np.max(np.abs(values))), float(np.median(np.diff(times)))
    near = np.abs(times - stated) <= (_BESIDE_PEAK + 0.5) * step + rounding
    if np.max(np.abs(values), where=near, initial=0.0) >= _PEAK_SHARE * peak:
        return []
    found = f"at the interval of {step:g} s the samples have it at {float(times[np.argmax(np.abs(values))]):g} s"
    return [f"the header states the peak at {stated:g} s, but {found}"]


def held_units(stated: Iterable[tuple[str, str]]) -> list[str]:
    """Return a warning if the stated units differ; `stated` contains names, each with a key of `UNITS`."""
    stated = list(stated)
    if len({UNITS[unit] for _, unit in stated}) < 2:
        return []
    listed = ", ".join(f"{unit} ({name})" for name, unit in stated)
    return [f"the units of one file differ: {listed}; one of them is wrong, and so is the peak stated in it"]


def held_lengths_of_units(units: Sequence[str]) -> list[str]:
    """Return a warning if the units of acceleration, velocity and displacement have different units of length."""
    if len({match[1].lower() for unit in units if (match := _LENGTH.match(unit))}) < 2:
        return []
    return [f"the header states the units {' and '.join(units)}, with different units of length; one of them is wrong"]


def contradictory(said: Direction, other: Direction) -> bool:
    """Return whether two directions contradict each other; an unknown direction contradicts no other."""
    if "unknown" in (said.orientation, other.orientation):
        return False
    turn = abs((said.azimuth - other.azimuth + 180.0) % 360.0 - 180.0)
    return said.orientation != other.orientation or said.sign != other.sign or turn > _TURN


def doubted_direction(said: Direction, other: Direction, note: str) -> str:
    """Return `note`, a warning on two contradictory directions; if one is vertical, the record must be confirmed."""
    one_vertical = {said.orientation, other.orientation} == {"vertical", "horizontal"}
    return WarningText("may_be_vertical", stated=note, decides=True) if one_vertical else note


def held_direction(said: Direction, other: Direction, note: str) -> Direction:
    """Return the more precise of two directions, or an unknown direction with warning `note` if they contradict."""
    if contradictory(said, other):
        if said.orientation == other.orientation == "horizontal":
            return Direction("horizontal", note=note)
        return Direction(note=doubted_direction(said, other, note))
    return other if said.orientation == "unknown" or (np.isnan(said.azimuth) and not np.isnan(other.azimuth)) else said


def surplus(
    lines: Sequence[str], first: int, end: int, name: str = "", title: re.Pattern[str] | None = None, used: int = 0
) -> tuple[str, ...]:
    """Return warnings about numbers that follow the declared ones; raise an error if another record follows.

    The numbers after the declared ones are in ``lines[first:end]`` and, in the line before them, beyond the first
    `used` characters (if it is not 0). Another record begins with a line that matches `title`.
    """
    notes = []
    if used and lines[first - 1][used:].strip():
        notes.append(f"line {first}: numbers beyond the declared count were left out")
    for at in range(first, end):
        if title and title.match(lines[at][:_LONGEST_LINE]):
            found = f"{lines[at][:60].strip()!r}, the beginning of another record"
            raise unexpected(f"{name}:{at + 1}", "the end of the file", found, OWN_FILE)
    rows = sum(bool(line.strip()) for line in lines[first:end])
    return (*notes, *([f"line {first + 1}: {rows} rows beyond the declared count were left out"] if rows else []))


def fixed_block(
    name: str,
    lines: Sequence[str],
    span: Span,
    width: int,
    per_row: int,
    count: int,
    title: re.Pattern[str] | None = None,
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return the first `count` numbers of the lines `span`, in fields of equal width, and warnings about the rest."""
    first, end = span
    samples, rows = fixed_width(lines[first:end], first + 1, width, per_row, count, name), -(-count // per_row)
    return samples, surplus(lines, first + rows, end, name, title, width * (count - (rows - 1) * per_row))


def last_of_equal(lines: Sequence[str], at: int) -> int:
    """Return the index of the last line that repeats the line at index `at`; blank lines may lie between."""
    last = at
    for index in range(at + 1, len(lines)):
        if lines[index].strip():
            if lines[index].split() != lines[at].split():
                break
            last = index
    return last


def repeated_marker(first: int, last: int) -> tuple[str, ...]:
    """Return a warning if a line is repeated; `first` and `last` are the indices of its first and last copy."""
    return (f"line {first + 1}: the line is repeated up to line {last + 1}; it was read once",) if last > first else ()


def distinct_sections(
    lines: Sequence[str], spans: Sequence[Span], what: str = "channel"
) -> tuple[list[Span], tuple[str, ...]]:
    """Return the sections of a file that repeat no earlier section, and a warning about each copy left out."""
    first: dict[tuple[str, ...], Span] = {}
    notes = []
    for span in spans:
        content = tuple(line.rstrip() for line in lines[slice(*span)] if line.strip())
        copied = first.setdefault(content, span)
        if copied is not span:
            known = f"the {what} of line {copied[0] + 1}"
            notes.append(f"line {span[0] + 1}: {known} is repeated in the file; it was read once")
    return list(first.values()), tuple(notes)


class Counted(NamedTuple):
    """A channel, its recorder, and the number of channels that the header states for this recorder."""

    line: int  # number of the channel's first line, from 1
    recorder: str
    number: str
    counted: int  # number of channels of the recorder; 0 if it is not stated
    kind: str = ""  # such as "acceleration", if a file contains acceleration and velocity as separate channels


def completeness(
    name: str, channels: Iterable[Counted], whose: str = "the header states", closed: bool = False
) -> tuple[str, ...]:
    """Return a warning for each recorder with missing channels; raise an error if a channel occurs twice.

    The warning begins with the words `whose`. A single channel in a file with an end mark (`closed`) gives no warning.
    """
    first: dict[tuple[str, str, str], int] = {}
    held: dict[str, set[str | int]] = {}
    counted: dict[str, int] = {}
    for channel in channels:
        key = (channel.recorder, channel.number, channel.kind)
        if channel.number and key in first:
            found = f"that of line {first[key]} a second time"
            raise unexpected(f"{name}:{channel.line}", "another channel", found, FILE_DAMAGED)
        first[key] = channel.line
        held.setdefault(channel.recorder, set()).add(channel.number or channel.line)
        counted[channel.recorder] = max(channel.counted, counted.get(channel.recorder, 0))
    if closed and len(first) == 1:
        return ()
    fewer = [(counted[one], len(numbers)) for one, numbers in held.items() if len(numbers) < counted[one]]
    words = "channels of this recorder, but this file has"
    return tuple(f"{whose} {stated} {words} {found}; it may be truncated" for stated, found in fewer)
