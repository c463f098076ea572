"""The changes between two results files as text."""

import math
from collections.abc import Sequence

from rockpulse.storage.hdf5.results_file import ResultsFile
from rockpulse.views.diff.answer_changes import Changes
from rockpulse.views.diff.differences import CAPACITY, FACTOR, OUTCOME, SAFETY, Differences, OnlyIn
from rockpulse.views.shared.formatting import ABSENT, paragraph, shortened
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number_cell, table_text

#: Names that are listed of what only one file has, and half of the lines of the configuration and of bodies; and how
#: many for one screen, which shows as many variables as lines.
LISTED, ON_SCREEN = 12, 3
#: Longest place and text in a table, and name in a place.
PLACE_WIDTH = 44
TEXT_WIDTH = 20
NAME_WIDTH = 34
#: What is said of ratios that crossed one.
CROSSED = {
    FACTOR: "Factors of 10 % that crossed 1 (below it the record as it is overturns with more than 10 % probability)",
    SAFETY: "Safety factors that crossed 1 (below it a weaker copy of the record overturns)",
    CAPACITY: "Capacities over demand that crossed 1 (below it the record overturns before it reaches the demand)",
}


def difference_overview(
    found: Differences, first: ResultsFile, second: ResultsFile, tolerance: str, full: bool = True
) -> str:
    """The differences as text: bodies, flipped verdicts, crossed ratios and the rest; one screen without `full`."""
    most = LISTED if full else ON_SCREEN
    parts = ["\n".join(map(_file, "-+", (first, second)))]
    if not found.same:
        title = f"Bodies whose margin changed (by the {found.model} model): {len(found.bodies)}"
        parts.append(_list(title, found.bodies, 2 * most))
    flips, crossed = found.sides[OUTCOME], {title: found.sides[name] for name, title in CROSSED.items()}
    if flips.count:
        by_model = f"{flips.count_by_model} of {flips.compared_by_model}"
        title = f"Verdicts that flipped: {flips.count} of {flips.compared}"
        parts.append(_changes(title, by_model, found.model, flips))
    elif flips.compared:
        parts.append(f"No verdict of {flips.compared} flipped.")
    told = {title: one for title, one in crossed.items() if one.count}
    parts += [
        _changes(f"{title}: {one.count}", str(one.count_by_model), found.model, one) for title, one in told.items()
    ]
    parts.append("\n".join(f"  {name}: {old} -> {new}" for name, old, new in found.about))
    changes = [paragraph(line[1:], "      ", f"  {line[0]} ") for line in found.configuration]
    parts.append("\n".join(["Configuration:", *_first(changes, 2 * most, " lines")]) if changes else "")
    parts += [_only(one, most) for one in found.only]
    parts.append(_list("Other differences:", found.others, len(found.others) if full else most, "    "))
    parts.append(_variables(found, tolerance, len(found.variables) if full else 2 * most))
    if not full and any("\n  and " in part for part in parts):
        parts.append("All of it: rockpulse diff BEFORE AFTER --full")
    same = f"The results are the same: {found.compared} values within {tolerance}."
    apart = f"The results differ ({found.compared} values compared within {tolerance})."
    return "\n\n".join([*filter(None, parts), same if found.same else apart])


def _file(mark: str, file: ResultsFile) -> str:
    sizes = file.dataset("summary").sizes if "summary" in file.groups else {}
    counts = ", ".join(f"{sizes[dim]} {dim}s" for dim in ("record", "block", "model") if dim in sizes)
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
    """The title, and the first of some lines; empty where there are none."""
    said = [paragraph(line, indent, "  ") for line in every]
    return "\n".join([title, *_first(said, most)]) if said else ""


def _first(said: list[str], most: int, noun: str = "") -> list[str]:
    """The first lines, and how many more there are."""
    return said if len(said) <= most else [*said[:most], f"  and {len(said) - most} more{noun}"]


def _changes(title: str, by_model: str, model: str, changes: Changes) -> str:
    """The title, then a line for each change that is listed, and how many more there are."""
    rows = tuple(
        (*(Cell(shortened(name, NAME_WIDTH)) for name in change.place), Cell(f"{change.before} -> {change.after}"))
        for change in changes.named
    )
    shown = lines(Table("", "", (Heading(""),) * len(rows[0]), rows))[1:]
    more = [f"  and {changes.count - len(rows)} more (--limit)"] if changes.count > len(rows) else []
    heading = paragraph(f"{title} ({by_model} by the {model} model)" if model else title, "    ", "")
    return "\n".join([heading, *("  " + line for line in shown), *more])


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
    note = "largest: relative difference (inf: one is no finite number), and where it is; of texts and flags the first."
    shown = table_text(Table("", f"Variables beyond {tolerance}:", headings, rows, (note,)))
    more = len(found.variables) - len(rows)
    return f"{shown}\n  and {more} more variables" if more > 0 else shown


def _place(names: Sequence[str]) -> str:
    """Names in one line, each cut as far as the longest of them have to be."""
    room = PLACE_WIDTH - 2 * (len(names) - 1)
    width = max(map(len, names), default=0)
    while sum(min(len(name), width) for name in names) > room:
        width -= 1
    return ", ".join(_cut(name, width) for name in names)


def _cut(name: str, width: int) -> str:
    """The end of a record id is its time: what stands before it tells more, and is kept where it can be."""
    channel, at, start = name.partition("@")
    room = width - len(channel) - len("@…")
    if len(name) > width and at and room > 0:
        return f"{channel}@…{start[-room:]}"
    return shortened(name, width)


def _text(value: str) -> str:
    return shortened(value.replace("\n", " | "), TEXT_WIDTH) or "(empty)"
