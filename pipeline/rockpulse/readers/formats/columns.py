"""Plain columns of numbers (CSV, TXT), with or without times; unit and interval are never guessed."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from itertools import pairwise

import numpy as np

from rockpulse.errors import RecordFormatError, Remedy
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.kit.column_statements import column_directions, column_units, same_directions, stated_peak
from rockpulse.readers.parts import with_slopes
from rockpulse.warning_text import WarningText

_LOOK_AT = 500  # number of rows that are checked to recognise a table
#: Largest number of columns without headings that are read beside times, and that may be channels of one station.
_COMPONENTS, _NO_STATION = 3, 4
#: Largest number of characters of a line, and of a list, in a message.
_SHOWN, _LISTED = 60, 200
_INTEGRAL = 0.95  # correlation above which a column is the integral of the previous column
#: Patterns of decimal numbers that touch: a number before the sign of the next number, and a row without signs.
_TOUCHING = re.compile(rb"(\.\d*+(?:[eEdD][+-]?\d++)?+)(?=[+-]\d*+\.\d)")
_INSEPARABLE = re.compile(r"[\s\d.,;eEdD+-]*\.\d{3,}\.\d")
#: Words in messages for the properties that must be known of a series wrapped into rows.
_TOO = {"units": "the unit too (option units, --units)", "dt": "the interval too (option dt, --dt)"}
#: Names of the columns of a station in an example.
_NAMES = ("acc_NS", "acc_EW", "acc_UD")


@dataclass(frozen=True)
class _Columns:
    """The numbers of a table, the headings of its columns (empty if it has none), and warnings."""

    table: np.ndarray
    headings: tuple[kit.ColumnHeading, ...]
    warnings: tuple[str, ...] = ()

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.table.shape[1]

    def picked(self, order: Sequence[int], *warnings: str) -> "_Columns":
        """Return the columns with the indices `order`, in this order, with `warnings` added."""
        headings = tuple(self.headings[index] for index in order) if self.headings else ()
        return _Columns(self.table[:, order], headings, (*self.warnings, *warnings))


def is_columns(head: bytes, name: str) -> bool:
    """Return whether a short header is followed by rows of numbers with the same number of columns."""
    if b"\x00" in head:
        return False
    lines, _ = _lines(head)
    layout = kit.find_layout(lines)
    if layout is None:
        return False
    rows = [line for line in lines[layout.start :] if line.strip()][:_LOOK_AT]
    # Prose may end in a number; a table with a few damaged rows is still a table.
    return 2 * sum(kit.row_width(row, layout.delimiter) == layout.width for row in rows) >= len(rows)


def read_columns(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read all columns of accelerations; without headings, only one column, or up to three after the times, are read.

    A series that is wrapped into rows is read if the header states its number of values or, with a warning, if unit and
    interval are known and the values continue smoothly from row to row. The text of a header must not contradict the
    numbers.
    """
    lines, start_time = _lines(file.content)
    layout = kit.find_layout(lines)
    if layout is None:
        expected = "rows of numbers, all with the same number of columns"
        raise RecordFormatError(f"{file.name}: expected {expected}, found none")
    for number, line in enumerate(lines[: layout.start], 1):
        if _INSEPARABLE.match(line):
            found = f"numbers that touch in {line.strip()[:_SHOWN]!r}"
            raise kit.unexpected(f"{file.name}:{number}", "blanks between numbers", found, "separate them")
    _check_above(file.name, lines, layout)
    headings, end = kit.column_headings(lines[: layout.start], layout)
    stop = kit.end_of_numbers(lines, layout.start)
    numbered = kit.number_lines(file.name, lines[:stop], layout, kit.names_time(headings))
    where = f"{file.name}:{numbered.start + 1}"
    steps = {f"line {said.line}: {said.wording!r}": said.value for said in kit.stated_steps(lines[: layout.start])}
    declared = next((step for step in (options.dt, numbered.step, *steps.values()) if step is not None), None)
    lacking = [kit.GIVE_UNIT] * (options.units is None) + [kit.GIVE_INTERVAL] * (declared is None)
    prose = lines[:end]
    columns = _columns(file.name, lines[:stop], layout, headings, numbered, prose, lacking, lines[stop:])
    if columns.width > 1 and kit.counts_rows(columns.table, columns.headings):
        columns = columns.picked(range(1, columns.width), "the first column counts the rows; it was left out")
    columns = _with_one_time(columns)
    kinds = [heading.kind for heading in columns.headings]
    at = kinds.index("time") if "time" in kinds else 0
    if kit.climbs(columns.table[:, 0]) and not kit.climbs(columns.table[:, at]):
        # The headings are a title, such as "Acceleration (g) vs Time (s)".
        columns, prose = replace(columns, headings=()), lines[: layout.start]
    elif at:
        columns = columns.picked([at, *(index for index in range(len(kinds)) if index != at)])
    first = columns.headings[0] if columns.headings else kit.ColumnHeading("")
    climb = np.diff(columns.table[:, 0])
    if first.kind == "spectrum" and columns.width > 1 and (np.all(climb > 0.0) or np.all(climb < 0.0)):
        raise kit.no_acceleration(where, "accelerations over time", f"columns over {first.name!r}, a spectrum")
    step, times = kit.time_column_step(file.name, columns.table, columns.headings, numbered.start, declared)
    if step is not None:
        if first.kind in ("acceleration", "velocity", "displacement"):
            expected = f"{first.kind} in the column {first.name!r}"
            raise kit.unexpected(where, expected, "that it increases like times", _name_them(columns.width, True))
        columns = columns.picked(range(1, columns.width))
    if times is not None:
        table, remark = kit.at_even_times(times, columns.table)
        columns = replace(columns, table=table, warnings=(*columns.warnings, remark))
    wide = step is None and not columns.headings and columns.width > _NO_STATION
    if not lacking and wide and kit.runs_on(columns.table):
        columns = _in_reading_order(columns, np.empty(0), guessed=True)
    _check_apart(where, columns, step is not None, lacking)
    columns = _accelerations(file, columns, prose)
    headings = columns.headings or (kit.ColumnHeading(""),) * columns.width
    units = column_units(file.name, headings, prose, options)
    facing = column_directions(file, headings, prose)
    given = options.said_by("dt").removeprefix("the ")
    sources = {"time column": step, "first line": numbered.step, **steps, given: options.dt}
    dt = kit.agreed_step(file.name, sources, options.advice("dt") if options.dt else "correct the wrong one", given)
    names = [heading.name for heading in headings]
    notes: list[str] = [*columns.warnings, *kit.held_units(zip(names, units, strict=True))]
    for said in kit.stated_durations(prose):
        notes += kit.held_length(said.wording, len(columns.table), dt)
    notes += [WarningText("scale_stated", factor=said.value) for said in kit.stated_scales(prose)]
    notes += [*kit.reversed_polarity(prose), *same_directions(headings, facing)]
    peaks = stated_peak(columns.table, units, prose)
    records = [
        kit.build_record(
            file,
            samples,
            dt,
            unit,
            number=number,
            processed=None,
            component=heading.name or toward.label,
            facing=toward,
            channel=_without_unit(heading.name) or toward.label or kit.name_suffix(file) or str(number),
            station_name=kit.stated_station(prose),
            start_time=start_time or kit.stated_start(prose),
            warnings=notes,
            **peaks.get(number, {}),
        )
        for number, (samples, heading, unit, toward) in enumerate(
            zip(columns.table.T, headings, units, facing, strict=True), 1
        )
    ]
    return [with_slopes(record) for record in records]


def _lines(content: bytes) -> tuple[Sequence[str], datetime | None]:
    """Return the lines (touching numbers separated, clock times as seconds), and the UTC time of the first row."""
    return kit.without_stamps(kit.text_lines(_TOUCHING.sub(rb"\1 ", content)))


def _check_above(name: str, lines: Sequence[str], layout: kit.Layout) -> None:
    """Raise an error if a damaged row precedes the table, below its headings or below another row of numbers."""
    filled = [index for index, line in enumerate(lines[: layout.start]) if line.strip()]
    for before, at in pairwise(filled):
        cells = [cell.strip(' "\r') for cell in lines[at][: kit.LINE_LIMIT].strip().split(layout.delimiter or "\t")]
        wrong = [column for column, cell in enumerate(cells, 1) if not kit.NUMBER.fullmatch(cell)]
        if len(cells) != layout.width or not 0 < len(wrong) < len(cells):
            continue
        is_row = kit.row_width(lines[before], layout.delimiter) == layout.width
        if is_row or (1 not in wrong and kit.column_headings(lines[:at], layout)[0]):
            found = repr(cells[wrong[0] - 1][:_SHOWN])
            raise kit.unexpected(f"{name}:{at + 1}", f"a number in column {wrong[0]}", found, "repair the cell")


def _with_one_time(columns: _Columns) -> _Columns:
    """Remove all but one of several columns of times; a column in seconds is preferred."""
    headed = [at for at, heading in enumerate(columns.headings) if heading.kind == "time"]
    times = [at for at in headed if len(headed) > 1 and np.all(np.diff(columns.table[:, at]) > 0.0)]
    if len(times) < 2:
        return columns
    kept = next((at for at in times if "sec" in columns.headings[at].name.lower()), times[0])
    left = ", ".join(columns.headings[at].name for at in times if at != kept)
    order = [at for at in range(columns.width) if at == kept or at not in times]
    return columns.picked(order, f"further columns of times left out: {left}")


def _without_unit(heading: str) -> str:
    """Return a heading without the text in brackets, unless it is a direction."""
    return kit.BRACKET.sub(lambda text: text[1] if kit.is_direction(text[1].strip()) else "", heading).strip()


def _columns(
    name: str,
    lines: Sequence[str],
    layout: kit.Layout,
    headings: tuple[kit.ColumnHeading, ...],
    numbered: kit.Numbered,
    prose: Sequence[str],
    lacking: Sequence[Remedy],
    behind: Sequence[str],
) -> _Columns:
    """Return the table of the file; if one series is wrapped into its rows, return it as a single column."""
    first = numbered.start + 1
    rows = lines[numbered.start :]
    kit.check_decimals(name, rows, layout, first, bool(headings))
    filled = [index for index, row in enumerate(rows) if row.strip()]
    last = kit.split_row(rows[filled[-1]], layout.delimiter)
    values = (len(filled) - 1) * layout.width + len(last)
    stated = kit.stated_counts(prose)
    said = {round(count.value) for count in stated}
    counts = {numbered.count, *said}
    warnings = _behind(name, len(lines) + 1, behind, layout, complete=not counts.isdisjoint({values, len(filled)}))
    is_series = layout.width > 1 and not headings and values in counts and len(filled) not in counts
    is_short = layout.width > len(last) and not headings and layout.width > 2
    if is_series or is_short:
        body = _Columns(kit.read_table(name, rows[: filled[-1]], layout, first), (), warnings)
        last_row, shorter = rows[filled[-1] : filled[-1] + 1], replace(layout, width=len(last))
        end = kit.read_table(name, last_row, shorter, first + filled[-1])
        if is_series:
            return _in_reading_order(body, end)
    if numbered.count > values:
        available, unit = (values, "values") if layout.width > 2 else (len(filled), "rows")
        kit.check_count(f"{name}:{len(lines)}", numbered.count, available, unit)
    if is_short:
        if not lacking and kit.runs_on(body.table):
            other = (_other_count(said, values, "numbers"),) if said else ()
            return _in_reading_order(replace(body, warnings=(*body.warnings, *other)), end, guessed=True)
        found = f"a last row of {len(last)} below rows of {layout.width}"
        raise _wrapped(f"{name}:{first + filled[-1]}", layout.width, found, lacking)
    table = kit.read_table(name, rows, layout, first)
    if numbered.step is not None:
        kit.check_count(f"{name}:{len(lines)}", numbered.count, len(table), "rows")
        if (beyond := len(table) - numbered.count) > 0:
            warnings += (f"{beyond} rows beyond the {numbered.count} of the first line were left out",)
        table = table[: numbered.count]
    elif said and (
        min(said) > len(table) or (any(map(kit.surely_counts, stated)) and not counts & {len(table), values})
    ):
        warnings += (_other_count(said, len(table), "rows"),)
    return _Columns(table, headings, warnings)


def _behind(name: str, line: int, behind: Sequence[str], layout: kit.Layout, complete: bool) -> tuple[str, ...]:
    """Return a warning about lines after the numbers; raise an error if they may contain more samples.

    If `complete` is true, the count of the numbers equals that of the header, and no error is raised.
    """
    rows = [kit.row_width(text, layout.delimiter) == layout.width for text in behind]
    if not any(map(str.strip, behind)) or (complete and not any(rows)):
        return ()
    stop = f"the numbers stop at {behind[0].strip()[:_SHOWN]!r}"
    if not any(rows):
        return (f"line {line}: {stop}, and the header does not state how many there are; is the file complete?",)
    kinds = kit.stated_kinds(behind[: rows.index(True)])
    if complete or (kinds and "acceleration" not in kinds):
        return (f"line {line}: {stop}; {sum(rows)} rows of numbers after it were left out",)
    raise RecordFormatError(
        f"{name}:{line}: expected {layout.width} finite numbers, or the end of the numbers, found "
        f"{behind[0].strip()[:_SHOWN]!r} and {sum(rows)} rows of numbers after it; repair the line, write a second "
        "record into a file of its own, or state the number of values in the header (NPTS = ...)"
    )


def _other_count(said: Collection[int], found: int, what: str) -> str:
    return f"the header mentions {min(said)} samples, but the file has {found} {what}; is it complete?"


def _in_reading_order(columns: _Columns, end: np.ndarray, guessed: bool = False) -> _Columns:
    """Return the values of all rows as one series; `end` contains the last row, and `guessed` adds a warning."""
    series = np.concatenate([columns.table.ravel(), end.ravel()])
    note = (
        f"rows of {columns.table.shape[1]} numbers were read as one series of {series.size}, because the values "
        "continue smoothly from row to row; nothing in the file says so"
    )
    return _Columns(series[:, None], (), (*columns.warnings, note) if guessed else columns.warnings)


def _name_them(width: int, timed: bool, names: Sequence[str] = _NAMES) -> str:
    """Return the advice to name the columns, with an example; `timed` is true if the first column contains times."""
    named = [*names, *(f"acc_{number}" for number in range(len(names) + 1, width + 1))][: width - timed]
    line = " ".join(["time"] * timed + named)
    return f"name the columns in the line above the numbers, such as '{line}'"


def _wrapped(where: str, width: int, found: str, lacking: Sequence[Remedy]) -> RecordFormatError:
    series = "The values do not continue smoothly from row to row, as those of one series do"
    if width <= _NO_STATION and "last row" not in found:
        series = f"Rows of up to {_NO_STATION} numbers are not read as one series: they may be channels of a station"
        lacking = ()
    elif lacking:
        given = " and ".join(_TOO[one.key] for one in lacking)
        series = f"Give {given}: then they are read as one series if the values continue smoothly from row to row"
    return RecordFormatError(
        f"{where}: expected a time column, headings, or one column, found {found}. They may be channels side by side "
        f"or one series in rows of {width}. {series}. Otherwise, write one value per line, state the number of values "
        f"in the header (NPTS = ...), or {_name_them(width, False)}",
        *lacking,
    )


def _check_apart(where: str, columns: _Columns, timed: bool, lacking: Sequence[Remedy]) -> None:
    """Raise an error if nothing states which quantity each column contains."""
    width = columns.width
    late = next((index for index in range(width) if kit.climbs(columns.table[:, index])), None)
    if late is not None:
        found, advice = f"column {late + 1 + timed}, which increases like times", "write the times as the first column"
        raise kit.unexpected(where, "accelerations", found, advice)
    if columns.headings or width == 1:
        return
    if timed and width > _COMPONENTS:
        expected = f"headings, or at most {_COMPONENTS} columns beside the times"
        found = f"{width} columns of numbers and no headings"
        raise kit.unexpected(where, expected, found, _name_them(width + 1, True))
    if not timed:
        raise _wrapped(where, width, f"{width} columns of numbers", lacking)
    for before in range(width - 1):
        rate, growth = columns.table[:, before], np.diff(columns.table[:, before + 1])
        with np.errstate(all="ignore"):
            alike = growth.size > 2 and abs(np.corrcoef(growth, rate[1:] + rate[:-1])[0, 1])
        if alike > _INTEGRAL:
            found = f"column {before + 3}, which is the integral of column {before + 2}, like a velocity"
            advice = _name_them(width + 1, True, ("acc", "vel", "disp"))
            raise kit.unexpected(where, "accelerations in all columns", found, advice)


def _accelerations(file: kit.SourceFile, columns: _Columns, prose: Sequence[str]) -> _Columns:
    """Return the columns that are accelerations by headings, header text or file name; raise an error if none is."""
    name, sizes = file.name, _sizes(columns)
    headings = columns.headings or (kit.ColumnHeading(""),) * columns.width
    named = any(heading.kind == "acceleration" for heading in headings)
    fits = [one.kind == "acceleration" or (not one.kind and (one.known or not named)) for one in headings]
    fits = [fit and index not in sizes for index, fit in enumerate(fits)]
    kept = [index for index, fit in enumerate(fits) if fit]
    left = ", ".join(heading.name for heading, fit in zip(headings, fits, strict=True) if not fit)[:_LISTED]
    if not kept:
        raise kit.no_acceleration(f"{name}:{len(prose) + 1}", "an acceleration column", f"{left} only")
    said = kit.stated_kinds(prose)
    others = [kind for kind in said if kind != "acceleration"]
    if others and not all(headings[index].kind for index in kept):
        where, listed = f"{name}:{said[others[0]]}", " and ".join(others)
        if "acceleration" not in said and "spectrum" not in said:
            found = f"but the header mentions {listed} only; {kit.ACCELERATION_FILE}"
            raise kit.NotAcceleration(f"{where}: expected accelerations, {found}")
        expected, found = "a statement of which columns are accelerations", f"a header that mentions {listed}"
        raise kit.unexpected(where, expected, found, _name_them(columns.width, False))
    by_name = kit.kind_of_name(file)
    if by_name not in ("", "acceleration"):
        if not said and not any(headings[index].kind for index in kept):
            raise kit.other_kind(name, by_name)
        if not all(headings[index].kind for index in kept):
            found = f"acceleration in the header and {by_name} in the file name"
            raise kit.unexpected(name, "one kind of motion", found, _name_them(columns.width, False))
        note = f"the name of the file says {by_name}, but the headings say acceleration; check which is right"
        columns = replace(columns, warnings=(*columns.warnings, note))
    return columns.picked(kept, f"columns left out because they are no accelerations: {left}") if left else columns


def _sizes(columns: _Columns) -> list[int]:
    """Return the indices of columns that contain the magnitude of a vector, according to heading or numbers."""
    if columns.width < _COMPONENTS:
        headed = [kit.means_size(heading.name) and heading.kind == "acceleration" for heading in columns.headings]
        return [index for index, size in enumerate(headed) if size and np.all(columns.table[:, index] >= 0.0)]
    with np.errstate(over="ignore"):
        squares = columns.table**2
    found = []
    for index in np.flatnonzero(np.all(columns.table >= 0.0, axis=0) & np.any(columns.table > 0.0, axis=0)):
        named = bool(columns.headings) and kit.means_size(columns.headings[index].name)
        before = np.sum(squares[:, max(index - _COMPONENTS, 0) : index], axis=1)
        if named or (index > 1 and np.allclose(before, squares[:, index], rtol=0.01, atol=1e-4 * np.max(before))):
            found.append(int(index))
    return found


COLUMNS = Format(
    name="columns",
    what="columns of numbers (CSV, TXT, XLSX, MAT, NPY, NPZ), with or without time",
    recognised="rows of numbers after a short header",
    unit="must be given (--units), or from the headings",
    processed="unknown",
    example="record.csv",
    detect=is_columns,
    parse=read_columns,
)
