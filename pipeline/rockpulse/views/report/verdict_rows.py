"""The table of the verdict: one row per body."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rockpulse.views.report.events import CONFIDENCE, FEWEST_EVENTS
from rockpulse.views.report.motions import Motions
from rockpulse.views.report.standing import Standing
from rockpulse.views.report.verdict import BodyVerdict, DemandVerdict, Grade
from rockpulse.views.shared.record_marks import doubts
from rockpulse.views.shared.table import Cell, Heading, Table
from rockpulse.views.shared.terminal import ABSENT, figure, restitution, share
from rockpulse.views.text.capacity import factor_cell

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["grade_cell", "verdict_table"]

_WORDS = {
    Grade.SAFE: "safe",
    Grade.UNTESTED: "stands, never lifted",
    Grade.STANDS: "stands",
    Grade.THIN: "stands, hardly a margin",
    Grade.NO_MARGIN: "stands, margin not computed",
    Grade.NOT_KNOWN: "not known",
    Grade.NOT_SAFE: "not safe",
}

#: Rows that need no filter.
FEW = 8

_MARKS = {
    Grade.SAFE: "good",
    Grade.UNTESTED: "fair",
    Grade.STANDS: "fair",
    Grade.THIN: "fair",
    Grade.NO_MARGIN: "fair",
    Grade.NOT_KNOWN: "unknown",
    Grade.NOT_SAFE: "bad",
}


def grade_cell(one: BodyVerdict, model: str, before: str = "") -> Cell:
    """The verdict on a body in a word or two, sorted from best to worst.

    Parameters
    ----------
    one : BodyVerdict
        The verdict.
    model : str
        By which model: what an upper-bound type input overturns is not shown to be unsafe.
    before : str
        What the words begin with.
    """
    grade = one.overall
    doubtful = model == "resonance" and grade == Grade.NOT_SAFE
    words = "not shown to be safe" if doubtful else _WORDS[grade]
    where = " at the demand" if grade > one.grade else ""
    return Cell(before + words + where, float(grade), grade="unknown" if doubtful else _MARKS[grade])


def verdict_table(summary: xr.Dataset, found: Sequence[BodyVerdict], motions: Motions, model: str) -> Table:
    """One row per body: verdict, safety factor, what it rests on, capacity over demand.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    found : sequence of BodyVerdict
        Of all bodies.
    motions : Motions
        Under what.
    model : str
        By which model.
    """
    names = [name + mark for name, mark in doubts(summary).items()]
    with_events = motions.kind != "sequence"
    demands = [] if not found else [one.name for one in found[0].demands]
    headings = (
        Heading("body"),
        Heading("C"),
        Heading("verdict", note=model),
        Heading("smallest SF", note="safety factor"),
        Heading("under"),
        Heading("median SF"),
        *(Heading(f"capacity/demand: {name}", note=_asked(summary, name)) for name in demands),
        Heading("over\u00adturned", note="as it is"),
        Heading("by weaker"),
        Heading("not known"),
        Heading("not lifted"),
        *(_event_columns(motions) if with_events else ()),
    )
    kinds = (Standing.OVERTURNS, Standing.WEAKER_OVERTURNS, Standing.UNKNOWN)
    rows = []
    for one in found:
        governed = one.governing >= 0 and not math.isinf(one.smallest)
        counts = [*(one.counts[kind] for kind in kinds), one.at_rest]
        rows.append(
            (
                Cell(one.body.block, link=f"body-{one.body.place}"),
                Cell(restitution(one.body.restitution), one.body.restitution),
                grade_cell(one, model),
                Cell(_at_most(one) + factor_cell(one.smallest, None, _resolved(one), one.limit), one.smallest),
                Cell(names[one.governing], link=f"record-{one.governing}") if governed else Cell(ABSENT),
                Cell(factor_cell(one.median, None, 0 if one.median_bound else None, one.limit), one.median),
                *(_demand_cell(demand, model) for demand in one.demands),
                *(Cell(str(count), float(count)) for count in counts),
                *(_event_cells(one, motions) if with_events else ()),
            )
        )
    caption = f"Verdict on each body under {motions.counted()}; counts are of {_plural(motions)}"
    return Table("verdict-bodies", caption, headings, tuple(rows), searched=FEW)


def _plural(motions: Motions) -> str:
    return {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}[motions.kind]


def _event_columns(motions: Motions) -> tuple[Heading, ...]:
    hit = Heading("earth\u00adquakes", note="that do, or may")
    if motions.event_count < FEWEST_EVENTS:
        return (hit,)
    return hit, Heading("of others, at most", note=f"{CONFIDENCE:.0%} confidence")


def _event_cells(one: BodyVerdict, motions: Motions) -> tuple[Cell, ...]:
    hit = Cell(f"{one.events_hit} of {motions.event_count}", float(one.events_hit))
    if motions.event_count < FEWEST_EVENTS:
        return (hit,)
    return hit, Cell(share(one.largest_share), one.largest_share)


def _at_most(one: BodyVerdict | DemandVerdict) -> str:
    """What stands before a smallest value that may be smaller: a direction is missing, or not known."""
    return "≤" if one.smallest_open and not math.isinf(one.smallest) else ""


def _resolved(one: BodyVerdict | DemandVerdict) -> int | None:
    return 0 if one.smallest_bound else None


def _demand_cell(demand: DemandVerdict, model: str) -> Cell:
    factor = _at_most(demand) + factor_cell(demand.smallest, None, _resolved(demand), demand.limit)
    median = factor_cell(demand.median, None, 0 if demand.median_bound else None, demand.limit)
    why = f", {demand.unknown} not known" if demand.unknown else ""
    # What an upper-bound type input overturns is not shown to be unsafe.
    mark = "unknown" if model == "resonance" and demand.grade == Grade.NOT_SAFE else _MARKS[demand.grade]
    return Cell(f"{factor}, median {median}{why}", demand.smallest, grade=mark)


def _asked(summary: xr.Dataset, name: str) -> str:
    return figure(float(summary["demand_acceleration"].sel(demand=name)), "m/s²")
