"""The tables of the verdict: one row per body, and the earthquakes that it rests on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import BodyVerdict, DemandVerdict, Grade
from rockpulse.motions.events import CONFIDENCE
from rockpulse.views.report.statements import typeset
from rockpulse.views.shared.answer_cells import TITLES, margin_cells, unexplained
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, between, figure, ratio, restitution, several
from rockpulse.views.shared.verdict_notes import counted

__all__ = ["body_table", "event_table", "grade_cell"]

#: The grade of the cell of a verdict.
_GRADES = {
    Grade.STAYS: "good",
    Grade.ROCKS: "good",
    Grade.MAY_OVERTURN: "fair",
    Grade.NOT_KNOWN: "unknown",
    Grade.OVERTURNS: "bad",
}

#: Rows that need no filter.
FEW = 8

_PLURAL = {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}


def grade_cell(one: BodyVerdict, before: str = "") -> Cell:
    """The verdict on a body in a word or two behind others, sorted from best to worst."""
    return Cell(before + one.word, float(one.overall), grade=_GRADES[one.overall])


def body_table(answers: Answers, found: Sequence[BodyVerdict]) -> Table:
    """One row per body: verdict, probability at each demand and as it is, factor, the record that it rests on."""
    motions, factor = answers.motions, TITLES[answers.factor]
    names = [*map(unexplained, record_cells(answers.summary))]
    of = "P" if answers.probable else "share"
    headings = (
        Heading("body"),
        Heading("C"),
        Heading("verdict", note=answers.model),
        *(Heading(f"{of} at {name}", note=typeset(one.words)) for name, one in answers.demands.items()),
        *_share_headings(answers),
        Heading(f"smallest {factor}"),
        Heading("under"),
        Heading(f"median {factor}"),
        Heading("over\u00adturned", note="as it is"),
        Heading("not known"),
        Heading("not lifted"),
    )
    rows = []
    for one in found:
        smallest, median = map(unexplained, margin_cells(one.margin))
        governed = one.governing >= 0 and not math.isinf(one.margin.smallest)
        rows.append(
            (
                Cell(one.body.block, link=f"body-{one.body.place}"),
                number(one.body.restitution, restitution),
                grade_cell(one),
                *map(_demand_cell, one.demands),
                *_share_cells(answers, one),
                smallest,
                names[one.governing]._replace(link=f"record-{one.governing}") if governed else Cell(ABSENT),
                median,
                *(Cell(str(count), float(count)) for count in (one.overturned, one.share.unknown, one.at_rest)),
            )
        )
    caption = f"Verdict on each body under {counted(motions)}; counts are of {_PLURAL[motions.kind]}"
    return Table("verdict-bodies", caption, headings, tuple(rows), searched=FEW)


def event_table(answers: Answers) -> Table:
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
        rows.append((Cell(event), *_of_earthquake(known), number(len(places), str), Cell(names)))
    headings = ("earthquake", "date", "magnitude", "distance [km]", "motions", "which")
    shown = [
        place
        for place, title in enumerate(headings)
        if title in ("earthquake", "motions", "which") or any(row[place].text for row in rows)
    ]
    caption = "Earthquakes that the motions are counted to, by the table, by name and by time"
    of_shown = tuple(tuple(row[place] for place in shown) for row in rows)
    return Table("earthquakes", caption, tuple(Heading(headings[place]) for place in shown), of_shown)


def _of_earthquake(known: Sequence[Known]) -> tuple[Cell, Cell, Cell]:
    """Date, magnitude, and nearest and farthest epicentral distance of some records; empty where none states it."""
    dates = sorted({date for one in known if (date := one.date)})
    magnitudes = list(dict.fromkeys(told for one in known if (told := one.magnitude)))
    distances = [distance / 1000.0 for one in known if not math.isnan(distance := one.real("epicentral_distance"))]
    largest = max((one.real("magnitude") for one in known if one.magnitude), default=math.nan)
    ends = list(dict.fromkeys(figure(end) for end in (min(distances), max(distances)))) if distances else []
    return (
        Cell(dates[0] if dates else ""),
        Cell(", ".join(magnitudes), largest),
        Cell(" to ".join(ends), min(distances, default=math.nan)),
    )


def _share_headings(answers: Answers) -> tuple[Heading, ...]:
    """None for a design sequence, which is one motion."""
    as_is = " as it is" if answers.demands else ""
    what = (
        Heading(f"P{as_is}", note="overturning")
        if answers.probable
        else Heading(f"share{as_is}", note="of earthquakes")
    )
    interval = Heading("interval", note=f"{CONFIDENCE:.0%}, {several(answers.motions.event_count, 'earthquake')}")
    return () if answers.motions.kind == "sequence" else (what, interval)


def _share_cells(answers: Answers, one: BodyVerdict) -> tuple[Cell, ...]:
    interval = Cell(between(one.share.low, one.share.high, ratio), one.share.high)
    return () if answers.motions.kind == "sequence" else (number(one.share.value, ratio), interval)


def _demand_cell(demand: DemandVerdict) -> Cell:
    share = demand.share
    shown = f"{ratio(share.value)} ({between(share.low, share.high, ratio)})"
    return Cell(shown, share.value, grade=_GRADES[demand.grade])
