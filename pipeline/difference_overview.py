"""What changed between two results files as text."""

from __future__ import annotations

import math

from rockpulse.differences import Differences, OnlyIn
from rockpulse.results_file import ResultsFile
from rockpulse.terminal import ABSENT, aligned, paragraph, shortened

__all__ = ["difference_overview"]

#: Names that are listed of what only one file has, and lines of the configuration.
LISTED = 12

#: Longest place and text in a table.
PLACE_WIDTH = 42
TEXT_WIDTH = 20


def difference_overview(found: Differences, first: ResultsFile, second: ResultsFile, tolerance: str) -> str:
    """The files, then what only one of them has, verdicts that flipped, and variables beyond the tolerance.

    Parameters
    ----------
    found : Differences
        What was compared.
    first, second : ResultsFile
        The files.
    tolerance : str
        In words.
    """
    parts = [_files(first, second), _about(found), _configuration(found)]
    parts += [_only(one) for one in found.only]
    if found.others:
        parts.append("\n".join(["Other differences:", *(paragraph(line, "    ", "  ") for line in found.others)]))
    parts += [_flips(found), _variables(found, tolerance)]
    same = f"The results are the same: {found.compared} values within {tolerance}."
    apart = f"The results differ ({found.compared} values compared within {tolerance})."
    return "\n\n".join([*(part for part in parts if part), same if found.same else apart])


def _files(first: ResultsFile, second: ResultsFile) -> str:
    lines = []
    for mark, file in (("-", first), ("+", second)):
        sizes = file.dataset("summary").sizes if "summary" in file.groups else {}
        counts = ", ".join(f"{sizes[dim]} {dim}s" for dim in ("record", "block", "model") if dim in sizes)
        history = str(file.attrs.get("history", "")).splitlines()
        lines += [f"{mark} {file.path}", f"    {counts or file.kind}; {history[-1] if history else ''}"]
    return "\n".join(lines)


def _about(found: Differences) -> str:
    return "\n".join(f"  {name}: {old} -> {new}" for name, old, new in found.about)


def _configuration(found: Differences) -> str:
    if not found.configuration:
        return ""
    shown = [f"  {line}" for line in found.configuration[: 2 * LISTED]]
    more = len(found.configuration) - len(shown)
    return "\n".join(["Configuration:", *shown, *([f"  and {more} more lines"] if more else [])])


def _only(one: OnlyIn) -> str:
    lines = []
    for mark, names in (("-", one.first), ("+", one.second)):
        if names:
            lines.append(f"{one.what} only in the {'first' if mark == '-' else 'second'} file: {len(names)}")
            lines += [paragraph(name, "      ", f"  {mark} ") for name in names[:LISTED]]
            lines += [f"  and {len(names) - LISTED} more"] if len(names) > LISTED else []
    return "\n".join(lines)


def _flips(found: Differences) -> str:
    if not found.verdicts:
        return ""
    if not found.flipped:
        return f"No verdict of {found.verdicts} flipped."
    rows = [[flip.place, f"{flip.before} -> {flip.after}"] for flip in found.flips]
    more = found.flipped - len(rows)
    return "\n".join(
        [
            f"Verdicts that flipped: {found.flipped} of {found.verdicts}",
            *("  " + line for line in aligned(rows, left=2)),
            *([f"  and {more} more (--limit)"] if more else []),
        ]
    )


def _variables(found: Differences, tolerance: str) -> str:
    if not found.variables:
        return ""
    rows = [["variable", "differ", "of", "largest", "  where", "  before -> after"]]
    for one in found.variables:
        size = ABSENT if math.isnan(one.largest) else f"{one.largest:.1e}"
        change = f"{_text(one.before)} -> {_text(one.after)}"
        rows.append(
            [
                one.name,
                str(one.differing),
                str(one.compared),
                size,
                f"  {shortened(one.place, PLACE_WIDTH)}",
                f"  {change}",
            ]
        )
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    # Numbers flush right between names flush left.
    made = [
        [row[0], *(cell.rjust(width) for cell, width in zip(row[1:4], widths[1:4], strict=True)), *row[4:]]
        for row in rows
    ]
    note = "largest: relative difference (inf: one is no finite number), and where it is; of texts and flags the first."
    return "\n".join(
        [
            f"Variables beyond {tolerance}:",
            *("  " + line for line in aligned(made, left=6, gap="  ")),
            paragraph(note, "  "),
        ]
    )


def _text(value: str) -> str:
    return shortened(value.replace("\n", " | "), TEXT_WIDTH) or "(empty)"
