"""Plain columns of numbers (CSV, TXT): one or more accelerations, with or without a time column.

Nothing in such a file tells the unit, so it is asked for, never guessed. The interval comes from the time column, from
a first line ``N dt`` (the DEEPSOIL layout), or from the caller.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers.channel import build_record
from rockpulse.readers.facing import BRACKET, heading_direction
from rockpulse.readers.fields import check_count, free_numbers, text_lines
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.readers.table_layout import NUMBER, Layout, find_layout, row_width, split_row
from rockpulse.readers.time_column import agreed_step, counts_rows, names_time, time_column_step
from rockpulse.readers.units import UNITS, canonical_unit
from rockpulse.record import Record

__all__ = ["FORMAT", "is_columns", "read_columns"]

_MOTION = re.compile(r"\b(vel|velocity|disp|displacement)\b", re.IGNORECASE)
_ACCELERATION = re.compile(r"\bacc", re.IGNORECASE)
_COUNT_AND_STEP = re.compile(r"\s*(\d+)[\s,;]+(\d*\.\d+(?:[eE][+-]?\d+)?)\s*", re.ASCII)


_AS_PYTHON = str.maketrans({",": ".", "d": "e", "D": "e"})
#: Rows of the table that decide whether it is one.
_LOOK_AT = 500
#: A series wrapped into rows looks like channels side by side; from this number of columns on, something has to tell.
_WRAPPED = 4


def is_columns(head: bytes, name: str) -> bool:
    """Whether rows of numbers, all with the same number of columns, follow a short header that is no other format's."""
    from rockpulse.readers import FORMATS

    if b"\x00" in head or any(row.detect(head, name) for row in FORMATS if row.detect is not is_columns):
        return False
    lines = text_lines(head)
    layout = find_layout(lines)
    if layout is None:
        return False
    rows = [line for line in lines[layout.start :] if line.strip()][:_LOOK_AT]
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
    if layout.width > 1 and counts_rows(table, layout):
        table, layout = table[:, 1:], replace(layout, width=layout.width - 1, names=layout.names[1:])
        warnings.append("the first column counts the rows; it was left out")
    time_step = time_column_step(file.name, table, layout, start, step if options.dt is None else options.dt)
    if time_step is not None:
        table, names = table[:, 1:], layout.names[1:]
    elif layout.width >= _WRAPPED and not layout.names:
        raise RecordFormatError(
            f"{file.name}:{start + 1}: expected a time column, headings, or at most {_WRAPPED - 1} columns, found "
            f"{layout.width} columns of numbers: channels side by side, or one series in rows of {layout.width}? "
            "Write one value to a line, or name the columns in a line above them"
        )
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
    return float(text.translate(_AS_PYTHON))


def _table(name: str, lines: Sequence[str], layout: Layout, start: int) -> np.ndarray:
    """(n, columns) numbers of the file."""
    rows = lines[start:]
    if layout.delimiter == "," and layout.width == 2 and not any("." in row for row in rows):
        raise RecordFormatError(
            f"{name}:{start + 1}: expected to know whether a comma separates columns or marks decimals, found "
            f"{rows[0].strip()!r} and no point in any row; write decimal points, or separate the columns with ';'"
        )
    table = _numbers(rows, layout)
    if table is not None:
        return table
    rows = [row.strip().rstrip(layout.delimiter) if layout.delimiter else row.strip() for row in rows]
    for index, row in enumerate(rows):
        fields = split_row(row, layout.delimiter)
        finite = all(NUMBER.fullmatch(field) and np.isfinite(_as_float(field)) for field in fields)
        if row and (len(fields) != layout.width or not finite):
            raise RecordFormatError(
                f"{name}:{start + index + 1}: expected {layout.width} finite numbers, found {row[:80]!r}; "
                "repair the line or cut the record there"
            )
    # Blank rows and separators at the end of a row do no harm.
    table = _numbers([row for row in rows if row], layout)
    if table is None:
        raise RecordFormatError(
            f"{name}:{start + 1}: the rows cannot be read as {layout.width} columns of numbers; write them with one "
            "separator and one decimal mark"
        )
    return table


def _numbers(rows: Sequence[str], layout: Layout) -> np.ndarray | None:
    """(n, columns) All rows at once; None unless every row has its separators and its numbers."""
    text = "\n".join(rows).replace('"', " ")
    if not text or not text.isascii():
        return None
    codes = np.frombuffer(text.encode(), dtype=np.uint8)
    starts = np.append(0, np.flatnonzero(codes == ord("\n")) + 1)
    if layout.delimiter:
        separators = np.add.reduceat(codes == ord(layout.delimiter), starts, dtype=np.intp)
        if np.any(separators != layout.width - 1):
            return None
        text = text.replace(layout.delimiter, " ")
    filled = np.frombuffer(text.encode(), dtype=np.uint8) > ord(" ")
    begins = filled & ~np.append(False, filled[:-1])
    if np.any(np.add.reduceat(begins, starts, dtype=np.intp) != layout.width):
        return None
    try:
        return free_numbers([text.replace(",", ".") if layout.decimal == "," else text], 1, "").reshape(
            -1, layout.width
        )
    except RecordFormatError:
        return None


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
