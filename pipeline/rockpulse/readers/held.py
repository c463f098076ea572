"""What a header states twice, held against each other or against the samples: length, peak, units, direction.

A header that contradicts itself is told, for one of its statements is wrong and nobody knows which: each function
returns a warning, or none where the statements agree or one of them is missing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np

from rockpulse.readers.facing import Direction
from rockpulse.readers.fields import printed_number
from rockpulse.readers.units import UNITS

__all__ = [
    "contradictory",
    "held_direction",
    "held_length",
    "held_lengths_of_units",
    "held_peak_time",
    "held_units",
    "left_in_row",
]

#: A stated length, of the samples or of the steps between them, may be off by this many steps.
LENGTH_STEPS = 2.0
#: At the time of the peak that a header states, and so many samples beside it, the motion reaches this share of it.
_BESIDE_PEAK, _PEAK_SHARE = 2, 0.9
#: Two statements of one azimuth may differ by so much [degrees].
_TURN = 1.0
_NUMBER = re.compile(r"\s*[+-]?(?:\d{1,9}\.?\d{0,12}|\.\d{1,12})(?:[eEdD][+-]?\d{1,2})?\s*", re.ASCII)
_LENGTH = re.compile(r"(mm|cm|m|in|ft)s?(?=/|\s|$)", re.IGNORECASE)


def held_length(text: str, count: int, dt: float, spare: float = 0.0) -> list[str]:
    """Whether `count` samples at `dt` last as long as a header prints [s], give or take `spare`.

    Examples
    --------
    >>> held_length("12.0", 1200, 0.01), held_length("12.0", 1200, 0.02)
    ([], ['the header states 12 s, 1200 samples at 0.02 s last 24 s'])
    """
    if not _NUMBER.fullmatch(text):
        return []
    stated, rounding = printed_number(text)
    if abs(stated - count * dt) <= LENGTH_STEPS * dt * (1.0 + 1e-9) + 1.01 * rounding + spare:
        return []
    return [f"the header states {stated:g} s, {count} samples at {dt:g} s last {count * dt:g} s"]


def held_peak_time(text: str, times: np.ndarray, values: np.ndarray) -> list[str]:
    """Whether the motion is near its largest where a header prints the time of the peak [s].

    The times (n,) [s] and the values (n,) are those of the file, before any interpolation.
    """
    if not _NUMBER.fullmatch(text) or times.size < 2:
        return []
    stated, rounding = printed_number(text)
    peak, step = float(np.max(np.abs(values))), float(np.median(np.diff(times)))
    near = np.abs(times - stated) <= (_BESIDE_PEAK + 0.5) * step + rounding
    if np.max(np.abs(values), where=near, initial=0.0) >= _PEAK_SHARE * peak:
        return []
    found = float(times[np.argmax(np.abs(values))])
    return [
        f"the header states the peak at {stated:g} s, at the interval of {step:g} s the samples have it at {found:g} s"
    ]


def held_units(stated: Iterable[tuple[str, str]]) -> list[str]:
    """Whether the channels of a file, or the places of a header, have one unit; each as its name and a key of `UNITS`.

    Examples
    --------
    >>> held_units([("L", "g/10"), ("V", "g")])
    ['the units of one file differ: g/10 (L), g (V); one of them is wrong, and with it a peak']
    """
    stated = list(stated)
    if len({UNITS[unit] for _, unit in stated}) < 2:
        return []
    listed = ", ".join(f"{unit} ({name})" for name, unit in stated)
    return [f"the units of one file differ: {listed}; one of them is wrong, and with it a peak"]


def held_lengths_of_units(units: Sequence[str]) -> list[str]:
    """Whether acceleration, velocity and displacement are measured in one unit of length, as a header words them.

    Examples
    --------
    >>> held_lengths_of_units(["CMS/SEC/SEC", "cm/s", "cm"]), held_lengths_of_units(["mm/s/s", "cm/s"])
    ([], ['the header states mm/s/s beside cm/s: units of two lengths; one of them is wrong'])
    """
    lengths = {match[1].lower() for unit in units if (match := _LENGTH.match(unit))}
    if len(lengths) < 2:
        return []
    return [f"the header states {' beside '.join(units)}: units of two lengths; one of them is wrong"]


def contradictory(said: Direction, told: Direction) -> bool:
    """Whether two statements of one direction, both of them known, contradict each other."""
    if "unknown" in (said.orientation, told.orientation):
        return False
    turn = abs((said.azimuth - told.azimuth + 180.0) % 360.0 - 180.0)
    return said.orientation != told.orientation or said.sign != told.sign or turn > _TURN


def held_direction(said: Direction, told: Direction, note: str) -> Direction:
    """The direction by two statements, of which one may be unknown; where they contradict, unknown with a note.

    A channel is horizontal if both say so, whichever azimuth it has.
    """
    if contradictory(said, told):
        return Direction("horizontal" if said.orientation == told.orientation == "horizontal" else "unknown", note=note)
    return told if said.orientation == "unknown" or (np.isnan(said.azimuth) and not np.isnan(told.azimuth)) else said


def left_in_row(row: str, line: int, used: int) -> tuple[str, ...]:
    """Whether the last row of a series holds more than the declared number of samples.

    The declared ones stand in its first `used` characters; `line` is its number.

    Examples
    --------
    >>> left_in_row("  0.01  0.02", 31, 6)
    ('line 31: numbers beyond the declared count were left out',)
    """
    return (f"line {line}: numbers beyond the declared count were left out",) if row[used:].strip() else ()
