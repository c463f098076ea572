"""The second page: the records by earthquake, magnitude, station and direction, and what was left out, and why."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.record.measures import PGA
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.files_used import reasons_of
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import figure
from rockpulse.views.text.left_out import apart, by_kind

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["earthquake_words", "left_out_table", "record_named", "record_words", "used_table"]

#: Rows of the table of records, directions that are named in a row, and reasons of one kind.
ROWS, DIRECTIONS, REASONS = 10, 3, 2

#: Letters of a reason; the annex has all of them.
LONGEST = 90

#: Kinds whose reasons are told; those of the others are one for the kind.
_TOLD = ("failed", "skipped")


def earthquake_words(words: Words, known: Known) -> str:
    """The earthquake by its name, else by its date; empty where nothing is known of it."""
    return known.title or (words("earthquake_of", date=known.date) if known.date else "")


def record_words(words: Words, known: Known) -> str:
    """Earthquake, code of the station and direction of a record; empty where the earthquake is not known."""
    event, station = earthquake_words(words, known), known.value("station") or known.place
    return ", ".join(filter(None, (event, station, words.shared(known.direction)))) if event else ""


def record_named(words: Words, known: Known, name: str) -> str:
    """The words of a record with its id where no station is known, or the id alone; the id may bear marks."""
    told = record_words(words, known)
    return told if told and known.place else ", ".join(filter(None, (told, name)))


def used_table(words: Words, answers: Answers) -> Table:
    """A row for the records of one station and earthquake: its magnitude, directions, PGA and the worst answer.

    Of many the strongest ones; the caption tells how many there are.
    """
    pga = answers["pga"]
    groups: dict[tuple[str, str, str], list[int]] = {}
    for row, (record, event) in enumerate(zip(answers.records, answers["event"], strict=True)):
        known = Known(answers.summary, record=record)
        key = earthquake_words(words, known), known.place, str(event)
        groups.setdefault(key if key[0] and key[1] else (record, "", ""), []).append(row)
    order = sorted(groups.values(), key=lambda rows: -float(np.max(pga[rows])))
    titles = ("earthquake", "magnitude", "station", "direction", "records", PGA, "worst")
    headings = tuple(Heading(words(f"head.{title}"), "g" if title == PGA else "") for title in titles)
    rows = tuple(_used(words, answers, rows) for rows in order[:ROWS])
    told = "caption.used" if len(order) <= ROWS else "caption.strongest"
    caption = words(told, shown=len(rows), total=len(order), records=words.several(len(pga), "record"))
    return Table("used", caption, headings, rows)


def _used(words: Words, answers: Answers, rows: list[int]) -> tuple[Cell, ...]:
    every = [Known(answers.summary, record=answers.records[row]) for row in rows]
    first, strongest = every[0], max(rows, key=lambda row: float(answers["pga"][row]))
    directions = [*dict.fromkeys(filter(None, (words.shared(one.direction) for one in every)))]
    shown = ", ".join(directions) if len(directions) <= DIRECTIONS else words("directions", count=len(directions))
    return (
        Cell(earthquake_words(words, first) or answers.records[rows[0]], link=f"record-{strongest}"),
        Cell(first.magnitude, first.real("magnitude")),
        Cell(first.place or (answers.records[rows[0]] if earthquake_words(words, first) else "")),
        Cell(shown),
        number(len(rows), str),
        number(float(answers["pga"][strongest]) / STANDARD_GRAVITY, figure),
        _worst(words, answers, rows),
    )


def _worst(words: Words, answers: Answers, rows: list[int]) -> Cell:
    """The body with the largest probability under some records as they are, else that of the smallest factor."""
    if not answers.bodies:
        return Cell("")
    table = answers["overturning_probability"][rows] if answers.probable else -answers[answers.factor][rows]
    if np.isnan(table).all():
        return Cell("")
    lane = int(np.nanargmax(np.nanmax(np.where(np.isnan(table), -math.inf, table), axis=0)))
    value = float(np.nanmax(table[:, lane]))
    shown = f"{'P' if answers.probable else words.shared('SF')}\N{NO-BREAK SPACE}{words.ratio(abs(value))}"
    return Cell(f"{answers.bodies[lane].name} ({shown})")


def left_out_table(words: Words, tree: xr.DataTree) -> Table:
    """The files and channels that are no part of the verdict: a row for each kind, with reasons in readers' words."""
    found, beside = apart(by_kind(tree))
    rows = []
    for kind, every in found.items():
        said, rest = reasons_of(every, REASONS, LONGEST) if kind in _TOLD else ([words(f"left_out.why.{kind}")], 0)
        told = "; ".join([*said, *([words("left_out.other", count=rest)] if rest else [])])
        grade = "bad" if kind == "failed" else ""
        rows.append((Cell(words(f"left_out.{kind}"), grade=grade), number(len(every), str), Cell(told)))
    if beside:
        rows.append((Cell(words("left_out.no_record")), number(len(beside), str), Cell(words.listed(beside))))
    headings = (Heading(words("head.kind")), Heading(words("head.count")), Heading(words("head.reason")))
    return Table("left-out", words("caption.left_out"), headings, tuple(rows))
