"""Tables as content: titles, cells with what they are sorted by, and how bad a cell is."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rockpulse.views.shared.terminal import ABSENT, figure, ratio

__all__ = ["Cell", "Column", "Fact", "Table", "number", "proportion", "share"]


@dataclass(frozen=True)
class Column:
    """The head of a column.

    Attributes
    ----------
    title : str
        What stands in it.
    note : str
        Small print below the title.
    numeric : bool
        Whether its cells are sorted by their number; texts are sorted as words.
    words : bool
        Whether its cells are words all the same, as a verdict is.
    """

    title: str
    note: str = ""
    numeric: bool = False
    words: bool = False


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell.

    Attributes
    ----------
    text : str
        What is shown; escaped by the template.
    value : float or None
        What it is sorted by; None for words. NaN comes last in both directions.
    link : str
        Id of the part of the page that it leads to; empty for none.
    grade : {"", "good", "fair", "unknown", "bad"}
        How it is marked, beside what it says.
    """

    text: str
    value: float | None = None
    link: str = ""
    grade: str = ""


@dataclass(frozen=True)
class Table:
    """A table of the page.

    Attributes
    ----------
    key : str
        Its id in the page.
    caption : str
        What it shows.
    columns : tuple of Column
        Heads.
    rows : tuple of tuples of Cell
        As many cells as columns.
    searched : bool
        Whether it has a field to filter its rows.
    """

    key: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    searched: bool = False

    def __post_init__(self) -> None:
        wrong = [place for place, row in enumerate(self.rows) if len(row) != len(self.columns)]
        if wrong:
            raise ValueError(f"table {self.key}: row {wrong[0]} has not {len(self.columns)} cells")


@dataclass(frozen=True)
class Fact:
    """A name and what is known under it, one line or several."""

    name: str
    lines: tuple[str, ...]


def number(value: float | None, unit: str = "", link: str = "") -> Cell:
    """A cell with a number of three digits; a dash where it is absent.

    Parameters
    ----------
    value : float or None
        The number.
    unit : str
        Its unit.
    link : str
        As of :class:`Cell`.

    Examples
    --------
    >>> number(5.5574, "m/s²").text, number(None).text
    ('5.56 m/s²', '-')
    """
    return Cell(figure(math.nan if value is None else value, unit), math.nan if value is None else value, link)


def proportion(value: float | None) -> Cell:
    """A cell with a ratio around one.

    Parameters
    ----------
    value : float or None
        The ratio [-].
    """
    return Cell(ABSENT if value is None else ratio(value), math.nan if value is None else value)


def share(value: float) -> str:
    """A share in percent; a dash where it is not known.

    Parameters
    ----------
    value : float
        The share [-].

    Examples
    --------
    >>> share(0.5358), share(float("nan"))
    ('54 %', '-')
    """
    return ABSENT if math.isnan(value) else f"{100.0 * value:.0f} %"
