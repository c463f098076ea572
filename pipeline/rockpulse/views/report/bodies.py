"""The tables of the verdict: one row per body, and the earthquakes that it rests on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import BodyVerdict, DemandVerdict, Grade, Standing
from rockpulse.ladder import is_upper_bound
from rockpulse.motions.events import CONFIDENCE, FEWEST_EVENTS
from rockpulse.views.report.statements import counted
from rockpulse.views.shared.answer_cells import margin_cells, unexplained
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, figure, restitution, share

__all__ = ["body_table", "event_table", "grade_cell"]

#: What is said of a body, and the grade of the cell.
_GRADES = {
    Grade.SAFE: ("safe", "good"),
    Grade.UNTESTED: ("stands, never lifted", "fair"),
    Grade.STANDS: ("stands", "fair"),
    Grade.THIN: ("stands, hardly a margin", "fair"),
    Grade.NO_MARGIN: ("stands, margin not computed", "fair"),
    Grade.NOT_KNOWN: ("not known", "unknown"),
    Grade.NOT_SAFE: ("not safe", "bad"),
}

#: Rows that need no filter.
FEW = 8

_PLURAL = {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}


def grade_cell(one: BodyVerdict, model: str, before: str = "") -> Cell:
    """The verdict on a body in a word or two behind others, sorted from best to worst.

    A body that is overturned by an upper-bound type input is not shown to be unsafe.
    """
    grade = one.overall
    words, mark = _GRADES[grade]
    if is_upper_bound(model) and grade == Grade.NOT_SAFE:
        words, mark = "not shown to be safe", "unknown"
    where = " at the demand" if grade > one.grade else ""
    return Cell(before + words + where, float(grade), grade=mark)


def body_table(answers: Answers, found: Sequence[BodyVerdict]) -> Table:
    """One row per body: verdict, safety factor, the record that it rests on, capacity over demand."""
    motions, model = answers.motions, answers.model
    names = [*map(unexplained, record_cells(answers.summary))]
    asked = answers.demands.items()
    headings = (
        Heading("body"),
        Heading("C"),
        Heading("verdict", note=model),
        Heading("smallest SF", note="safety factor"),
        Heading("under"),
        Heading("median SF"),
        *(Heading(f"capacity/demand: {name}", note=figure(value, "m/s²")) for name, value in asked),
        Heading("over\u00adturned", note="as it is"),
        Heading("by weaker"),
        Heading("not known"),
        Heading("not lifted"),
        *_event_headings(motions),
    )
    kinds = (Standing.OVERTURNS, Standing.WEAKER_OVERTURNS, Standing.UNKNOWN)
    rows = []
    for one in found:
        smallest, median = map(unexplained, margin_cells(one.margin))
        governed = one.governing >= 0 and not math.isinf(one.margin.smallest)
        rows.append(
            (
                Cell(one.body.block, link=f"body-{one.body.place}"),
                number(one.body.restitution, restitution),
                grade_cell(one, model),
                smallest,
                names[one.governing]._replace(link=f"record-{one.governing}") if governed else Cell(ABSENT),
                median,
                *(_demand_cell(demand, model) for demand in one.demands),
                *(Cell(str(count), float(count)) for count in (*(one.counts[kind] for kind in kinds), one.at_rest)),
                *_event_cells(one, motions),
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


def _event_headings(motions: Motions) -> tuple[Heading, ...]:
    """None for a design sequence; a bound on other earthquakes only from enough of them."""
    headings = (
        Heading("earth\u00adquakes", note="that do, or may"),
        Heading("of others, at most", note=f"{CONFIDENCE:.0%} confidence"),
    )
    return headings[: _event_columns(motions)]


def _event_cells(one: BodyVerdict, motions: Motions) -> tuple[Cell, ...]:
    hit = Cell(f"{one.events_hit} of {motions.event_count}", float(one.events_hit))
    return (hit, number(one.largest_share, share))[: _event_columns(motions)]


def _event_columns(motions: Motions) -> int:
    return 0 if motions.kind == "sequence" else 1 if motions.event_count < FEWEST_EVENTS else 2


def _demand_cell(demand: DemandVerdict, model: str) -> Cell:
    smallest, median = (cell.marked for cell in margin_cells(demand.margin))
    why = f", {demand.unknown} not known" if demand.unknown else ""
    # A body that is overturned by an upper-bound type input is not shown to be unsafe.
    mark = "unknown" if is_upper_bound(model) and demand.grade == Grade.NOT_SAFE else _GRADES[demand.grade][1]
    return Cell(f"{smallest}, median {median}{why}", demand.margin.smallest, grade=mark)
