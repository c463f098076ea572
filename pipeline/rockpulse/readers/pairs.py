"""(time, acceleration) pairs of digitised traces: the block, and the header words for its length and its unit.

The volume 1 files of CSMIP, USC and RENADIC hold five pairs in a row, in fields of equal width that may touch.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.fields import check_count, fixed_width
from rockpulse.readers.held import left_in_row
from rockpulse.readers.spacing import make_even
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record.record import STANDARD_GRAVITY

__all__ = ["PAIRS_PER_ROW", "Block", "declared_points", "pair_block", "pair_unit", "surplus"]

PAIRS_PER_ROW = 5
#: Characters of a line that may hold a title, or of what stands for a unit.
_LONGEST_LINE = 400
_POINTS = re.compile(r"no\. of points\s*=\s*(\d{1,15})\b", re.IGNORECASE)
_UNIT = re.compile(r"units (?:of uncor (?:accel|data) )?(?:is|are)\s+(?:sec(?:onds)?\s+and\s+)?(\S+)", re.IGNORECASE)


@dataclass(frozen=True)
class Block:
    """Samples of one channel."""

    samples: np.ndarray  # (n,) equally spaced accelerations [unit]
    dt: float  # sampling interval [s]
    unit: str  # a key of `UNITS`
    times: np.ndarray  # (m,) times as the file holds or implies them, before any resampling [s]
    values: np.ndarray  # (m,) accelerations at these times [unit]
    warnings: tuple[str, ...] = ()

    @property
    def peak(self) -> float:
        """Largest absolute value as the file holds it [unit]."""
        return float(np.max(np.abs(self.values)))

    @property
    def duration(self) -> float:
        """Time that the values of the file last, the step behind the last included [s]."""
        return float(self.times[-1] - self.times[0]) + self.dt

    def noting(self, *warnings: str) -> Block:
        """The same samples with further warnings."""
        return replace(self, warnings=(*self.warnings, *warnings))


def declared_points(line: str, where: str) -> int:
    """The number in a header line ``No. of Points = 11999``; RecordFormatError, with `where`, if there is none."""
    match = _POINTS.search(line)
    if not match:
        raise RecordFormatError(
            f"{where}: expected 'No. of Points = N', found {line[:60].strip()!r}; "
            "the header is damaged: download the file again"
        )
    return int(match[1])


def pair_unit(line: str, where: str) -> str:
    """The key of `UNITS` in a header line ``Units are sec and g/10``; UnitError, with `where`, if there is none."""
    match = _UNIT.search(line)
    return canonical_unit((match[1] if match else line.strip())[:_LONGEST_LINE], where)


def surplus(
    lines: Sequence[str],
    first: int,
    end: int,
    name: str = "",
    title: re.Pattern[str] | None = None,
    used: int | None = None,
) -> tuple[str, ...]:
    """A warning for rows between the declared samples (index `first`) and the end of the channel (index `end`).

    Where `used` tells the characters of the declared samples in the last of their rows, numbers behind them in that row
    are told as well. `title` matches the line with which another record of the file `name` would begin, which is
    refused: formats of one channel have no place for it.
    """
    rows = 0
    notes = () if used is None else left_in_row(lines[first - 1], first, used)
    for at in range(first, end):
        if title and title.match(lines[at][:_LONGEST_LINE]):
            raise RecordFormatError(
                f"{name}:{at + 1}: expected the end of the file, found {lines[at][:60].strip()!r}, the beginning of "
                "another record; write each record into a file of its own"
            )
        rows += bool(lines[at].strip())
    return (*notes, f"line {first + 1}: {rows} rows beyond the declared count were left out") if rows else notes


def pair_block(name: str, lines: Sequence[str], first: int, end: int, count: int, unit: str) -> Block:
    """Read the `count` pairs of one channel in ``lines[first:end]`` and make their spacing equal, see `make_even`.

    Raises RecordFormatError for too few pairs, a damaged row, times that do not increase, and a gap.
    """
    check_count(f"{name}:{end}", count, PAIRS_PER_ROW * max(end - first, 0), "pairs")
    rows = -(-count // PAIRS_PER_ROW)
    block = lines[first : first + rows]
    fields = 2 * min(PAIRS_PER_ROW, count)
    width, rest = divmod(len(block[0].rstrip()), fields)
    margin = 0
    if rest == 1 and all(row.startswith(" ") for row in block):
        # Carriage control of a line printer in front of every row.
        block, margin = [row[1:] for row in block], 1
    pairs = fixed_width(block, first + 1, width or 1, 2 * PAIRS_PER_ROW, 2 * count, name).reshape(-1, 2)
    gravity = UNITS[unit] / STANDARD_GRAVITY
    samples, dt, notes = make_even(pairs[:, 0], pairs[:, 1], name, first + 1, PAIRS_PER_ROW, gravity)
    used = margin + 2 * width * (count - (rows - 1) * PAIRS_PER_ROW)
    return Block(samples, dt, unit, pairs[:, 0], pairs[:, 1], (*surplus(lines, first + rows, end, used=used), *notes))
