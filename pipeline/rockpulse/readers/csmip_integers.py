"""The integers (16I5) in the header of a CSMIP, USC or RENADIC channel that the readers use: count and direction."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rockpulse.readers.facing import Direction, direction
from rockpulse.readers.held import held_direction

__all__ = ["channel_count", "direction_code", "one_direction"]

_LONGEST_LINE = 200
#: The first row of integers; the fourth of them counts the channels of the recorder.
_FIRST_ROW = re.compile(r"[ \d-]{15} *(\d{1,3})(?=[ \d-]{60}$)", re.ASCII)
#: Integer 27, in the second row: the azimuth of the channel, or a code.
_AZIMUTH, _CODE = slice(50, 55), re.compile(r" *\d{1,3}", re.ASCII)
_UP, _DOWN = 500, 600


def channel_count(behind: Sequence[str]) -> int:
    """Channels of the recorder, from the lines behind the text; 0 where none of them is a row of integers."""
    at = _first_row(behind)
    row = _FIRST_ROW.match(behind[at]) if at < len(behind) else None
    return int(row[1]) if row else 0


def direction_code(behind: Sequence[str]) -> int:
    """The azimuth or code of the direction, from the lines behind the text; 0 where the file does not say."""
    at = _first_row(behind) + 1
    field = behind[at][_AZIMUTH] if at < len(behind) else ""
    return int(field) if _CODE.fullmatch(field) else 0


def _first_row(behind: Sequence[str]) -> int:
    rows = (at for at, line in enumerate(behind) if _FIRST_ROW.match(line[:_LONGEST_LINE].rstrip()))
    return next(rows, len(behind))


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
