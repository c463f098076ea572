"""The integers (16I5) and reals (8F10) in the header of a CSMIP, USC or RENADIC channel that repeat its text."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rockpulse.readers.channel import PEAK_TOLERANCE
from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.fields import printed_number
from rockpulse.readers.held import held_direction
from rockpulse.readers.pairs import Block
from rockpulse.readers.units import UNITS
from rockpulse.record.record import STANDARD_GRAVITY

__all__ = ["channel_count", "direction_code", "held_count", "held_peak_real", "one_direction", "real"]

_LONGEST_LINE = 200
#: The first row of integers; the fourth of them counts the channels of the recorder.
_FIRST_ROW = re.compile(r"[ \d-]{15} *(\d{1,3})(?=[ \d-]{60}$)", re.ASCII)
#: Integer 27, in the second row: the azimuth of the channel, or a code.
_AZIMUTH, _CODE = slice(50, 55), re.compile(r" *\d{1,3}", re.ASCII)
_UP, _DOWN = 500, 600
#: Integer 28, the number of points of volume 1, which has no room for more digits.
_POINTS, _MOST_POINTS = slice(55, 60), 99_999
#: Reals follow 100 integers; 0 and -999 stand for unknown.
_INTEGER_ROWS, _REAL_WIDTH, _UNKNOWN = 7, 10, (0.0, -999.0)
_REAL = re.compile(r" *-?\d{0,8}\.\d{0,8}", re.ASCII)


def channel_count(behind: Sequence[str]) -> int:
    """Channels of the recorder, from the lines behind the text; 0 where none of them is a row of integers."""
    row = next(filter(None, map(_integers, behind)), None)
    return int(row[1]) if row else 0


def direction_code(behind: Sequence[str]) -> int:
    """The azimuth or code of the direction, from the lines behind the text; 0 where the file does not say."""
    at = _first_row(behind) + 1
    field = behind[at][_AZIMUTH] if at < len(behind) else ""
    return int(field) if _CODE.fullmatch(field) else 0


def held_count(behind: Sequence[str], points: int) -> list[str]:
    """A warning where integer 28 is not the number of points in the text; 0 and -999 say nothing."""
    at = _first_row(behind) + 1
    field = behind[at][_POINTS] if at < len(behind) else ""
    if not re.fullmatch(r" *\d{1,5}", field, re.ASCII) or int(field) in (0, points) or points > _MOST_POINTS:
        return []
    return [f"integer 28 of the header states {int(field)} points, the text {points}"]


def real(behind: Sequence[str], number: int) -> str:
    """A real as it is printed, by its number from 1, from the lines behind the text; empty where it is unknown."""
    row, column = divmod(number - 1, 8)
    at = _first_row(behind) + _INTEGER_ROWS + row
    field = behind[at][_REAL_WIDTH * column : _REAL_WIDTH * (column + 1)] if at < len(behind) else ""
    if not _REAL.fullmatch(field) or not any(map(str.isdigit, field)) or float(field) in _UNKNOWN:
        return ""
    return field


def held_peak_real(behind: Sequence[str], number: int, block: Block, per_unit: float) -> list[str]:
    """A warning where a real, a peak in units of `per_unit` m/s2, is not the peak of the samples."""
    text = real(behind, number)
    if not text:
        return []
    peak, rounding = printed_number(text)
    stated, found = abs(peak) * per_unit / STANDARD_GRAVITY, block.peak * UNITS[block.unit] / STANDARD_GRAVITY
    if abs(stated - found) > PEAK_TOLERANCE * max(stated, found) + rounding * per_unit / STANDARD_GRAVITY:
        return [f"real {number} of the header states a peak of {stated:.4g} g, the samples have {found:.4g} g"]
    return []


def _integers(line: str) -> re.Match[str] | None:
    """The line as the first row of integers; None for any other line."""
    return _FIRST_ROW.match(line[:_LONGEST_LINE].rstrip())


def _first_row(behind: Sequence[str]) -> int:
    return next((at for at, line in enumerate(behind) if _integers(line)), len(behind))


def one_direction(component: str, code: int, repeated: Sequence[str] = ()) -> Direction:
    """The direction of the wording; unknown, with a note, where the code or a line that repeats it tells another one.

    Codes of sensors without an azimuth, 1100 and 1200 for H1 and H2, tell none, and neither does 0.
    """
    told = Direction("horizontal", float(code % 360)) if 1 <= code <= 360 else Direction()
    if code in (_UP, _DOWN):
        told = Direction("vertical", sign=1.0 if code == _UP else -1.0)
    note = f"the text says {component!r}, integer 27 of the header says {code}: the direction is unknown"
    facing = held_direction(direction(component), told, note)
    for other in repeated:
        note = f"the text says {component!r}, another line of the header {other!r}: the direction is unknown"
        facing = facing if facing.note else held_direction(facing, direction(other), note)
    return facing
