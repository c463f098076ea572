"""The table of the ties at the demands of the site, with the force and elongation at each anchor."""

import math
from collections.abc import Sequence

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.tie_demand import TieFinding, tie_findings
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.views.shared.formatting import ABSENT, share, three_digits
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell
from rockpulse.views.shared.words import body_name, say

#: Largest number of anchors that are described below the table.
ANCHORS = 8


def tie_table(answers: Answers, found: Sequence[BodyVerdict], records: Sequence[Cell]) -> Table | None:
    """Return a row for each tie and demand, and below it the demands on each anchor; None if there are no ties.

    `records` are the cells with the names of the records.
    """
    rows = tie_findings(answers, found)
    if not rows:
        return None
    several = len(answers.demands) > 1
    heads = (("tie", ""), *([("demand", "")] if several else []), ("height", "m"), ("elongation", "mm"), ("share", ""))
    heads = (*heads, ("force", "kN"), ("yields", ""), ("breaks", ""), ("record", ""))
    headings = tuple(Heading(say(f"tie.head.{name}"), unit) for name, unit in heads)
    cells = tuple(_cells(one, several, records) for one in rows)
    anchors = [_anchor(one) for one in rows if one.deciding]
    more = [say("tie.more", count=len(anchors) - ANCHORS)] if len(anchors) > ANCHORS else []
    return Table("ties", say("tie.caption"), headings, cells, (say("tie.legend"), *anchors[:ANCHORS], *more))


def _name(one: TieFinding) -> str:
    return say("tie.name", body=body_name(one.body.name), number=one.number)


def _cells(one: TieFinding, several: bool, records: Sequence[Cell]) -> tuple[Cell, ...]:
    yields = math.isfinite(one.tie.yield_force)
    return (
        Cell(_name(one), link=f"body-{one.body.place}"),
        *([Cell(one.demand)] if several else []),
        number_cell(one.tie.height),
        number_cell(1000.0 * one.elongation),
        number_cell(one.share, lambda value: share(value) if value < 1.0 or math.isnan(value) else say("tie.over")),
        number_cell(one.force / 1000.0),
        _count(one.yielded if yields else None, one.motions),
        _count(one.broken if math.isfinite(one.tie.ultimate) else None, one.motions),
        records[one.governing] if one.governing >= 0 else Cell(ABSENT),
    )


def _count(count: int | None, motions: int) -> Cell:
    """Return a cell with a number of records; a dash if the tie cannot yield or break."""
    return Cell(ABSENT, math.nan) if count is None else Cell(say("count_of", count=count, total=motions), float(count))


def _anchor(one: TieFinding) -> str:
    """State the force and elongation that an anchor must resist, and whether the tie never breaks."""
    return _taken(one) + (say("tie.unlimited") if math.isinf(one.tie.ultimate) else "")


def _taken(one: TieFinding) -> str:
    limit = one.tie.yield_force
    fields = {
        "name": _name(one),
        "force": three_digits((limit if one.yielded else one.force) / 1000.0, "kN"),
        "elongation": three_digits(1000.0 * one.elongation, "mm"),
        "limit": three_digits(limit / 1000.0, "kN"),
        "count": one.broken,
        "motions": one.motions,
    }
    if one.broken:
        return say("tie.breaks", **fields)
    if one.force == 0.0 or math.isnan(one.elongation):
        return say("tie.slack" if one.force == 0.0 else "tie.overturns", **fields)
    if one.yielded:
        return say("tie.yields", **fields)
    return say("tie.elastic", **fields) + (say("tie.capacity", **fields) if math.isfinite(limit) else "")
