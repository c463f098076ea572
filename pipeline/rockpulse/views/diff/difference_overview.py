"""The differences between two results files as text for the terminal."""

import math
import os
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import xarray as xr

from rockpulse.storage.hdf5.results_file import ResultsFile, of_tree, open_results_file
from rockpulse.views.diff.answer_changes import Changes
from rockpulse.views.diff.differences import CAPACITY, FACTOR, OUTCOME, SAFETY, Differences, OnlyIn, compare_results
from rockpulse.views.shared.formatting import ABSENT, paragraph, several, shortened
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number_cell, table_text

#: Largest number of listed names that only one file contains, in full and on one screen; of lines of configuration
#: and of bodies, twice as many are listed.
LISTED, ON_SCREEN = 12, 3
#: Largest width [characters] of a location and of a text in a table, and of a name within a location.
PLACE_WIDTH = 44
TEXT_WIDTH = 20
NAME_WIDTH = 34
#: Text on ratios that crossed 1.
CROSSED = {
    FACTOR: "Scale factors at P = 10 % that crossed 1 (below it the record as recorded overturns with P above 10 %)",
    SAFETY: "Smallest scale factors (SF) that crossed 1 (below it the record overturns if it is scaled down)",
    CAPACITY: "Capacities over demand that crossed 1 (below it the record overturns before it reaches the demand)",
}


def diff(
    before: xr.DataTree | str | os.PathLike[str],
    after: xr.DataTree | str | os.PathLike[str],
    rtol: float = 1e-9,
    atol: float = 0.0,
    ignore: str | Sequence[str] = (),
    limit: int | None = None,
    full: bool = False,
) -> Differences:
    """Return the changes between two results of the same kind, which ``print`` shows as ``rockpulse diff`` does.

    Parameters
    ----------
    before, after : xarray.DataTree or path
        Results of the same kind; their rows are matched by name.
    rtol, atol : float
        Numbers may differ by `rtol` times the larger number [-], plus `atol` in the unit of each variable.
    ignore : str or sequence of str
        Variables that are not compared, as ``name`` or ``/group/name``.
    limit : int, optional
        Largest number of changed verdicts and of crossed ratios that are named; by default 3, or 20 with `full`.
    full : bool
        Whether every variable, name and line that differs is shown, instead of one screen of them.

    Returns
    -------
    Differences
        `same` states whether the results are equal; `bodies`, `variables` and `only` contain the differences.

    Raises
    ------
    ResultsError
        If the results are of different kinds, or `ignore` contains an unknown name.

    Examples
    --------
    >>> before, after = (rp.assess(record, bodies={"wall": (width, 2.2)}) for width in (0.25, 0.8))
    >>> rp.diff(before, after).same, rp.diff(before, before).same
    (False, True)
    """
    with ExitStack() as stack:
        first, second = (
            of_tree(one, name) if isinstance(one, xr.DataTree) else stack.enter_context(open_results_file(Path(one)))
            for one, name in ((before, "before"), (after, "after"))
        )
        names = (ignore,) if isinstance(ignore, str) else ignore
        found = compare_results(first, second, rtol, atol, names, limit or (20 if full else 3))
        tolerance = f"rtol {rtol:g}" + (f", atol {atol:g}" if atol else "")
        found.text = difference_overview(found, first, second, tolerance, full)
    return found


def difference_overview(
    found: Differences, first: ResultsFile, second: ResultsFile, tolerance: str, full: bool = True
) -> str:
    """Return the differences between two files as text, on one screen unless `full`."""
    most = LISTED if full else ON_SCREEN
    parts = ["\n".join(map(_file, "-+", (first, second)))]
    if not found.same:
        title = f"Bodies whose margin changed (by the {found.model} model): {len(found.bodies)}"
        parts.append(_list(title, found.bodies, 2 * most))
    flips, crossed = found.sides[OUTCOME], {title: found.sides[name] for name, title in CROSSED.items()}
    if flips.count:
        by_model = f"{flips.count_by_model} of {flips.compared_by_model}"
        title = f"Verdicts that changed: {flips.count} of {flips.compared}"
        parts.append(_changes(title, by_model, found.model, flips))
    elif flips.compared:
        parts.append(f"None of {flips.compared} verdicts changed.")
    changed = {title: one for title, one in crossed.items() if one.count}
    parts += [
        _changes(f"{title}: {one.count}", str(one.count_by_model), found.model, one) for title, one in changed.items()
    ]
    parts.append("\n".join(f"  {name}: {old} -> {new}" for name, old, new in found.about))
    changes = [paragraph(line[1:], "      ", f"  {line[0]} ") for line in found.configuration]
    parts.append("\n".join(["Configuration:", *_first(changes, 2 * most, " lines")]) if changes else "")
    parts += [_only(one, most) for one in found.only]
    parts.append(_list("Other differences:", found.others, len(found.others) if full else most, "    "))
    parts.append(_variables(found, tolerance, len(found.variables) if full else 2 * most))
    if not full and any("\n  and " in part for part in parts):
        parts.append("All differences: rockpulse diff BEFORE AFTER --full")
    same = f"The results are the same: {found.compared} values within {tolerance}."
    apart = f"The results differ ({found.compared} values compared within {tolerance})."
    return "\n\n".join([*filter(None, parts), same if found.same else apart])


def _file(mark: str, file: ResultsFile) -> str:
    sizes = file.dataset("summary").sizes if "summary" in file.groups else {}
    counts = ", ".join(several(sizes[dim], dim) for dim in ("record", "block", "model") if dim in sizes)
    history = str(file.attrs.get("history", "")).splitlines()
    return f"{mark} {file.path}\n    {counts or file.kind}; {history[-1] if history else ''}"


def _only(one: OnlyIn, most: int) -> str:
    said = []
    for mark, which, names in (("-", "first", one.first), ("+", "second", one.second)):
        if names:
            said.append(f"{one.what} only in the {which} file: {len(names)}")
            said += _first([paragraph(name, "      ", f"  {mark} ") for name in names], most)
    return "\n".join(said)


def _list(title: str, every: Sequence[str], most: int, indent: str = "      ") -> str:
    said = [paragraph(line, indent, "  ") for line in every]
    return "\n".join([title, *_first(said, most)]) if said else ""


def _first(said: list[str], most: int, noun: str = "") -> list[str]:
    return said if len(said) <= most else [*said[:most], f"  and {len(said) - most} more{noun}"]


def _changes(title: str, by_model: str, model: str, changes: Changes) -> str:
    rows = tuple(
        (*(Cell(shortened(name, NAME_WIDTH)) for name in change.place), Cell(f"{change.before} -> {change.after}"))
        for change in changes.named
    )
    listed = lines(Table("", "", (Heading(""),) * len(rows[0]), rows))[1:]
    more = [f"  and {changes.count - len(rows)} more (--limit)"] if changes.count > len(rows) else []
    heading = paragraph(f"{title} ({by_model} by the {model} model)" if model else title, "    ", "")
    return "\n".join([heading, *("  " + line for line in listed), *more])


def _variables(found: Differences, tolerance: str, most: int) -> str:
    if not found.variables:
        return ""
    rows = tuple(
        (
            Cell(one.name),
            number_cell(one.differing, str),
            number_cell(one.compared, str),
            number_cell(one.largest, lambda size: ABSENT if math.isnan(size) else f"{size:.1e}"),
            Cell(f"  {_place(one.place)}"),
            Cell(f"  {_text(one.before)} -> {_text(one.after)}"),
        )
        for one in found.variables[:most]
    )
    headings = tuple(map(Heading, ("variable", "differ", "of", "largest", "  where", "  before -> after")))
    note = (
        "largest: relative difference (inf: one value is not finite) and its position; for texts and flags, the "
        "position of the first difference."
    )
    text = table_text(Table("", f"Variables beyond {tolerance}:", headings, rows, (note,)))
    more = len(found.variables) - len(rows)
    return f"{text}\n  and {several(more, 'more variable')}" if more > 0 else text


def _place(names: Sequence[str]) -> str:
    """Return the names on one line; the longest names are shortened until the line fits the column."""
    room = PLACE_WIDTH - 2 * (len(names) - 1)
    width = max(map(len, names), default=0)
    while sum(min(len(name), width) for name in names) > room:
        width -= 1
    return ", ".join(_cut(name, width) for name in names)


def _cut(name: str, width: int) -> str:
    """Shorten a name to a width; a record id keeps its end, which contains the time."""
    channel, at, start = name.partition("@")
    room = width - len(channel) - len("@…")
    if len(name) > width and at and room > 0:
        return f"{channel}@…{start[-room:]}"
    return shortened(name, width)


def _text(value: str) -> str:
    return shortened(value.replace("\n", " | "), TEXT_WIDTH) or "(empty)"
