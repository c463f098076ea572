"""Plain columns of numbers (CSV, TXT): one or more accelerations, with or without a time column.

Nothing in such a file tells the unit, so it is asked for, never guessed. The interval comes from the time column, from
a first line ``N dt`` (the DEEPSOIL layout), or from the caller.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

import numpy as np

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers.channel import build_record
from rockpulse.readers.facing import BRACKET, heading_direction
from rockpulse.readers.fields import check_count, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.table_layout import NUMBER, Layout, find_layout, row_width, split_row
from rockpulse.readers.time_column import agreed_step, names_time, time_column_step
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record import Record

__all__ = ["FORMAT", "is_columns", "read_columns"]

_MOTION = re.compile(r"\b(vel|velocity|disp|displacement)\b", re.IGNORECASE)
_ACCELERATION = re.compile(r"\bacc", re.IGNORECASE)
_COUNT_AND_STEP = re.compile(r"\s*(\d+)[\s,;]+(\d*\.\d+(?:[eE][+-]?\d+)?)\s*", re.ASCII)


def is_columns(head: bytes, name: str) -> bool:
    """Whether rows of numbers, all with the same number of columns, follow a short header."""
    if b"\x00" in head:
        return False
    lines = text_lines(head)
    layout = find_layout(lines)
    if layout is None:
        return False
    rows = [line for line in lines[layout.start :] if line.strip()]
    # Prose may end in a number; a table with a few damaged rows is still a table.
    return 2 * sum(row_width(row) == layout.width for row in rows) >= len(rows)


def read_columns(file: SourceFile, options: ReadOptions) -> list[Record]:
    """Read every column but that of time.

    Parameters
    ----------
    file : SourceFile
        The file.
    options : ReadOptions
        `units` is needed, a key of `UNITS`; `dt` where neither a time column nor a line ``N dt`` gives the interval.

    Raises
    ------
    UnitError
        No unit given, an unknown one, or one that contradicts a column heading.
    NotAcceleration
        A heading that names velocity or displacement only.
    RecordFormatError
        With file and line, what was found and what was expected.
    """
    if options.units is None:
        raise UnitError(
            f"{file.name}: plain columns do not state their unit; give it with the option units, "
            f"one of {', '.join(UNITS)}: --units g on the command line, units = 'g' under [records] of the "
            "configuration, or read(path, units='g')"
        )
    unit = canonical_unit(options.units, "option units")
    lines = text_lines(file.content)
    layout = find_layout(lines)
    if layout is None:
        raise RecordFormatError(
            f"{file.name}: expected rows of numbers, all with the same number of columns, found none"
        )
    header = "\n".join(lines[: layout.start])
    if _MOTION.search(header.replace("_", " ")) and not _ACCELERATION.search(header.replace("_", " ")):
        raise NotAcceleration(
            f"{file.name}:{layout.start}: expected accelerations, the header speaks of velocity or displacement only; "
            "read the acceleration file of the same record"
        )
    start, declared, step = _count_and_step(file.name, lines, layout)
    table = _table(file.name, lines, layout, start)
    warnings: list[str] = []
    if declared:
        check_count(f"{file.name}:{len(lines)}", declared, len(table), "rows")
        if len(table) > declared:
            warnings.append(f"{len(table) - declared} rows beyond the {declared} of the first line were left out")
        table = table[:declared]
    time_step = time_column_step(file.name, table, layout, start, step if options.dt is None else options.dt)
    if time_step is not None:
        table, names = table[:, 1:], layout.names[1:]
    else:
        names = layout.names
    step = agreed_step(file.name, {"time column": time_step, "first line": step, "option dt": options.dt})
    return _channels(file, table, names, step, unit, warnings)


def _count_and_step(name: str, lines: Sequence[str], layout: Layout) -> tuple[int, int, float | None]:
    """First row of data, and the N and dt of a DEEPSOIL first line (0 and None where there is none).

    With two columns the line looks like data; it is a heading if the time would run backwards after it. Under a
    heading that names the time, rows are data.
    """
    row = layout.start
    if names_time(layout):
        return row, 0, None
    if layout.width == 2 and row + 1 < len(lines):
        fields, following = (split_row(lines[index], layout.delimiter) for index in (row, row + 1))
        two_numbers = len(following) == 2 and all(NUMBER.fullmatch(field) for field in following)
        if two_numbers and _as_float(following[0]) <= _as_float(fields[0]) and _as_float(fields[0]) > 0.0:
            row += 1
    above = row - 1
    if above >= 0:
        match = _COUNT_AND_STEP.fullmatch(lines[above])
        if match:
            count, step = int(match[1]), float(match[2])
            check_count(f"{name}:{above + 1}", count, len(lines) - row, "rows")
            return row, count, step
    return layout.start, 0, None


def _as_float(text: str) -> float:
    return float(text.replace(",", "."))


def _table(name: str, lines: Sequence[str], layout: Layout, start: int) -> np.ndarray:
    """(n, columns) numbers of the file."""
    import pandas as pd

    rows = [line.strip().rstrip(layout.delimiter) if layout.delimiter else line.strip() for line in lines[start:]]
    if layout.delimiter == "," and not any("." in row for row in rows) and layout.width == 2:
        raise RecordFormatError(
            f"{name}:{start + 1}: expected to know whether a comma separates columns or marks decimals, found "
            f"{rows[0]!r} and no point in any row; write decimal points, or separate the columns with ';'"
        )
    fault = RecordFormatError(f"{name}:{start + 1}: the rows cannot be read as {layout.width} columns of numbers")
    try:
        frame = pd.read_csv(
            io.StringIO("\n".join(rows)),
            header=None,
            names=range(layout.width),
            index_col=False,
            sep=layout.delimiter or r"\s+",
            decimal=layout.decimal,
            dtype=float,
            on_bad_lines="error",
        )
        values = frame.to_numpy()
    except (ValueError, pd.errors.ParserError) as error:
        fault = RecordFormatError(f"{fault} ({error})")
        values = np.full((1, layout.width), np.nan)
    widths_differ = any(len(row.split(layout.delimiter)) != layout.width for row in rows if row)
    if not widths_differ and np.all(np.isfinite(values)):
        return values
    for index, row in enumerate(rows):
        fields = split_row(row, layout.delimiter)
        finite = all(NUMBER.fullmatch(field) and np.isfinite(_as_float(field)) for field in fields)
        if row and (len(fields) != layout.width or not finite):
            raise RecordFormatError(
                f"{name}:{start + index + 1}: expected {layout.width} finite numbers, found {row[:80]!r}; "
                "repair the line or cut the record there"
            )
    raise fault


def _channels(
    file: SourceFile, table: np.ndarray, names: Sequence[str], step: float, unit: str, warnings: Sequence[str]
) -> list[Record]:
    records: list[Record] = []
    motions = [name for name in names if _MOTION.search(name.replace("_", " "))]
    notes = [*warnings, *([f"columns left out, no acceleration: {', '.join(motions)}"] if motions else [])]
    for index in range(table.shape[1]):
        name = names[index] if names else ""
        if name in motions:
            continue
        stated = BRACKET.search(name)
        if stated and stated[1].strip():
            heading_unit = canonical_unit(stated[1], f"{file.name}: column {name!r}")
            if UNITS[heading_unit] != UNITS[unit]:
                raise UnitError(
                    f"{file.name}: the column {name!r} is headed {heading_unit}, the option units says {unit}; "
                    "correct the wrong one"
                )
        records.append(
            build_record(
                file,
                index + 1,
                table[:, index],
                step,
                unit,
                format="columns",
                processed=None,
                component=name,
                facing=heading_direction(name),
                channel=BRACKET.sub("", name).strip() or str(index + 1),
                warnings=notes,
            )
        )
    if not records:
        raise NotAcceleration(f"{file.name}: expected an acceleration column, found {', '.join(motions)} only")
    return records


FORMAT = Format(
    name="columns",
    what="columns of numbers (CSV, TXT), with or without time",
    recognised="rows of numbers after a short header",
    unit="asked for (units)",
    processed="unknown",
    example="record.csv",
    detect=is_columns,
    parse=read_columns,
)
