"""Tables as data, and their layout on the terminal; the report lays them out by its HTML templates."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from textwrap import wrap
from typing import NamedTuple

from rockpulse.views.shared.formatting import paragraph, shortened, three_digits
from rockpulse.views.shared.words import say

#: Longest heading that remains in one line on the terminal, and longest line of a longer heading [characters].
UNWRAPPED, HEADING_WIDTH = 8, 12


class CellMark(NamedTuple):
    """A mark before or after the text of a cell: ``sign`` is printed, and ``key`` selects the texts that explain it."""

    key: str = ""
    sign: str = ""
    before: bool = False

    @property
    def text(self) -> str:
        """Return the sign of the mark, or its text in the current language."""
        return self.sign or say(f"mark.{self.key}.sign")

    @property
    def note(self) -> str:
        """Return the note that explains the mark; empty if the mark has no note."""
        return say(f"mark.{self.key}.note") if self.key else ""


class Cell(NamedTuple):
    """A cell of a table: its text, the value by which it is sorted, and its marks."""

    text: str  # text without marks
    value: float | None = None  # sort value, NaN last
    marks: tuple[CellMark, ...] = ()
    grade: str = ""  # "", "good", "fair", "unknown" or "bad" (in capitals on the terminal)
    link: str = ""  # id of the linked part of the report

    @property
    def before(self) -> str:
        """Return the marks before the text."""
        return "".join(mark.text for mark in self.marks if mark.before)

    @property
    def after(self) -> str:
        """Return the marks after the text."""
        return "".join(mark.text for mark in self.marks if not mark.before)

    @property
    def marked(self) -> str:
        """Return the text with its marks."""
        return f"{self.before}{self.text}{self.after}"


class Heading(NamedTuple):
    """The heading of a column, its small print in the report, and the largest width of its cells on the terminal."""

    title: str
    unit: str = ""
    note: str = ""
    width: int | None = None

    @property
    def label(self) -> str:
        """The title of the column with its unit in brackets."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


@dataclass(frozen=True)
class Table:
    """A table; ``key`` is its id in the report, where it gets a search field if it has more than ``searched`` rows."""

    key: str
    caption: str
    headings: tuple[Heading, ...]
    rows: tuple[tuple[Cell, ...], ...]
    footnotes: tuple[str, ...] = ()
    searched: int = 20

    def __post_init__(self) -> None:
        wrong = [place for place, row in enumerate(self.rows) if len(row) != len(self.headings)]
        if wrong:
            raise ValueError(f"table {self.key}: row {wrong[0]}: expected {len(self.headings)} cells")

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Return, for each column, whether it is sorted by the numbers in its cells."""
        return tuple(any(row[place].value is not None for row in self.rows) for place in range(len(self.headings)))

    @cached_property
    def flush_right(self) -> tuple[bool, ...]:
        """Return, for each column, whether the report aligns it to the right, as a column of numbers."""
        graded = (any(row[place].grade for row in self.rows) for place in range(len(self.headings)))
        return tuple(numeric and not words for numeric, words in zip(self.numeric, graded, strict=True))

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """Return the footnotes, followed by the notes on the marks in the order in which the marks appear."""
        notes = dict.fromkeys(mark.note for row in self.rows for cell in row for mark in cell.marks if mark.note)
        return *self.footnotes, *notes


@dataclass(frozen=True)
class Fact:
    """The name of a fact, and the lines of text that state it."""

    name: str
    lines: tuple[str, ...]


def number_cell(
    value: float | None, show: Callable[[float], str] = three_digits, marks: tuple[CellMark, ...] = ()
) -> Cell:
    """Return the cell of a number; an unknown number has no marks."""
    known = math.nan if value is None else value
    return Cell(show(known), known, () if math.isnan(known) else marks)


def lines(table: Table, indent: str = "") -> list[str]:
    """Return the lines of a table in aligned columns: the headings, wrapped, then the rows."""
    columns, headings = [], []
    for place, heading in enumerate(table.headings):
        numeric = table.numeric[place]
        cells = [row[place] for row in table.rows]
        hanging = max((len(cell.after) for cell in cells), default=0) if numeric else 0
        words = [cell.before + _plain(cell, heading.width) + cell.after.ljust(hanging) for cell in cells]
        title = _wrapped(heading.label.replace("\N{SOFT HYPHEN}", ""), max(map(len, words), default=0) - hanging)
        headings.append(len(title))
        columns.append([*(word + " " * hanging for word in title), *words])
    tallest, laid = max(headings, default=0), []
    for place, (words, count) in enumerate(zip(columns, headings, strict=True)):
        width, own = max(map(len, words)), [""] * (tallest - count) + words
        laid.append([word.rjust(width) if table.numeric[place] else word.ljust(width) for word in own])
    return [indent + "  ".join(row).rstrip() for row in zip(*laid, strict=True)]


def _wrapped(label: str, width: int) -> list[str]:
    """Wrap a heading to few, narrow lines; `width` is the width of the cells below it."""
    if len(label) <= max(width, UNWRAPPED):
        return [label.replace("\N{NO-BREAK SPACE}", " ")]
    wide = max(width, HEADING_WIDTH)
    count = max(2, len(_filled(label, wide)))
    narrow = next(size for size in range(1, wide + 1) if len(_filled(label, size)) <= count)
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in _filled(label, max(narrow, width))]


def _filled(label: str, width: int) -> list[str]:
    return wrap(label, width, break_long_words=False, break_on_hyphens=False)


def table_text(table: Table) -> str:
    """Return the table as text for the terminal: caption, rows and notes."""
    caption = [paragraph(table.caption)] if table.caption else []
    return "\n".join([*caption, *lines(table, "  "), *(paragraph(note, "  ") for note in table.notes)])


def _plain(cell: Cell, width: int | None) -> str:
    text = cell.text if width is None else shortened(cell.text, width)
    return text.upper() if cell.grade == "bad" else text
