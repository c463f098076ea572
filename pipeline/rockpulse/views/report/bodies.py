"""The tables of the verdict: one row per body, and the earthquakes that it rests on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rockpulse.assessment.answers import Answers, Share
from rockpulse.assessment.verdict import OVERTURNS, BodyVerdict, Grade
from rockpulse.views.report.records_used import record_named
from rockpulse.views.report.statements import motions_words
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.answer_cells import TITLES, margin_cells, unexplained
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, figure, restitution

__all__ = ["body_table", "event_table", "grade_cell"]

#: The grade of the cell of a verdict.
_GRADES = {
    Grade.STAYS: "good",
    Grade.ROCKS: "good",
    Grade.MAY_OVERTURN: "fair",
    Grade.NOT_KNOWN: "unknown",
    Grade.OVERTURNS: "bad",
}

#: Between the ends of an interval, where no line breaks.
TO = "\N{WORD JOINER}–\N{WORD JOINER}"

#: Rows that need no filter.
FEW = 8


def grade_cell(words: Words, one: BodyVerdict, before: str = "") -> Cell:
    """The verdict on a body in a word or two behind others, sorted from best to worst."""
    few = one.deciding is not None and one.deciding.few
    key = "no_verdict" if few else one.overall.name.lower()
    # What nothing here overturns, but half of such earthquakes might, is not to be taken for good at a glance.
    unsure = one.overall == Grade.ROCKS and one.decides.high >= OVERTURNS
    return Cell(before + words(f"grade.{key}"), float(one.overall), grade="fair" if unsure else _GRADES[one.overall])


def body_table(words: Words, answers: Answers, found: Sequence[BodyVerdict]) -> Table:
    """One row per body: verdict, probability at each demand and as it is, factor, the record that it rests on."""
    motions, factor = answers.motions, words.shared(TITLES[answers.factor])
    several = any(one.body.several for one in found)
    headings = [
        Heading(words("head.body")),
        *([Heading("C")] if several else []),
        Heading(words("head.verdict"), note=words.shared(answers.model)),
        Heading(words("head.smallest", factor=factor)),
    ]
    rows = [
        [
            Cell(one.body.block, link=f"body-{one.body.place}"),
            *([number(one.body.restitution, restitution)] if several else []),
            grade_cell(words, one),
            unexplained(margin_cells(one.margin)[0]),
        ]
        for one in found
    ]
    if motions.kind != "sequence":  # of which there is one
        of = words("head.probability" if answers.probable else "head.share")
        at = [words("head.at", what=of, name=name) for name in answers.demands]
        at.append(words("head.as_recorded", what=of))
        place = len(headings) - 1
        headings[place:place] = [Heading(title, note=words("head.interval")) for title in at]
        counted = words("head.of", motions=words.several(len(motions.names), motions.kind))
        headings += [Heading(words("head.under")), Heading(words("head.median", factor=factor))]
        headings += [Heading(words("head.overturned"), note=counted)]
        headings += [Heading(words(f"head.{name}")) for name in ("unknown", "not_lifted")]
        for row, one in zip(rows, found, strict=True):
            shares = [_share_cell(words, demand.share, _GRADES[demand.grade]) for demand in one.demands]
            row[place:place] = [*shares, _share_cell(words, one.share)]
            row += [_governing(words, answers, one), unexplained(margin_cells(one.margin)[1])]
            row += [number(count, str) for count in (one.overturned, one.share.unknown, one.at_rest)]
    caption = words("caption.bodies", motions=motions_words(words, motions))
    return Table("verdict-bodies", caption, tuple(headings), tuple(map(tuple, rows)), searched=FEW)


def _governing(words: Words, answers: Answers, one: BodyVerdict) -> Cell:
    """The record that the smallest factor is of."""
    if one.governing < 0 or math.isinf(one.margin.smallest):
        return Cell(ABSENT)
    name = record_cells(answers.summary)[one.governing]
    told = record_named(words, Known(answers.summary, record=answers.records[one.governing]), name.text)
    return unexplained(name)._replace(text=told, link=f"record-{one.governing}")


def _share_cell(words: Words, share: Share, grade: str = "") -> Cell:
    low, high = words.ratio(share.low), words.ratio(share.high)
    shown = f"{words.ratio(share.value)} ({low if low == high == ABSENT else f'{low}{TO}{high}'})"
    return Cell(shown, share.value, grade=grade)


def event_table(words: Words, answers: Answers) -> Table:
    """The earthquakes, with what the files state of each, and the motions that are counted to it."""
    motions = answers.motions
    of_event: dict[str, list[int]] = {}
    for place, event in enumerate(motions.events):
        of_event.setdefault(event, []).append(place)
    rows = []
    for event, places in of_event.items():
        known = [
            Known(answers.summary, record=answers.records[row]) for row in np.unique(motions.index[places]) if row >= 0
        ]
        names = ", ".join(motions.names[place] for place in places)
        rows.append((Cell(event), *_of_earthquake(words, known), number(len(places), str), Cell(names)))
    titles = ("earthquake", "date", "magnitude", "distance", "motions", "which")
    always = ("earthquake", "motions", "which")
    shown = [place for place, title in enumerate(titles) if title in always or any(row[place].text for row in rows)]
    of_shown = tuple(tuple(row[place] for place in shown) for row in rows)
    headings = tuple(Heading(words(f"head.{titles[place]}")) for place in shown)
    return Table("earthquakes", words("caption.earthquakes"), headings, of_shown)


def _of_earthquake(words: Words, known: Sequence[Known]) -> tuple[Cell, Cell, Cell]:
    """Date, magnitude, and nearest and farthest epicentral distance of some records; empty where none states it."""
    dates = sorted({date for one in known if (date := one.date)})
    magnitudes = list(dict.fromkeys(told for one in known if (told := one.magnitude)))
    distances = [distance / 1000.0 for one in known if not math.isnan(distance := one.real("epicentral_distance"))]
    largest = max((one.real("magnitude") for one in known if one.magnitude), default=math.nan)
    ends = list(dict.fromkeys(figure(end) for end in (min(distances), max(distances)))) if distances else []
    return (
        Cell(dates[0] if dates else ""),
        Cell(", ".join(magnitudes), largest),
        Cell(
            words("between", low=ends[0], high=ends[1]) if len(ends) > 1 else "".join(ends),
            min(distances, default=math.nan),
        ),
    )
