"""The table of the verdicts on the bodies, used by all views: its columns, rows and legend."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import (
    FEWEST_AT_DEMAND,
    MAY_OVERTURN,
    OVERTURNS,
    WEAK,
    BodyVerdict,
    Finding,
    Grade,
    TieFinding,
    tie_findings,
)
from rockpulse.selection.events import UNKNOWN
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import ABSENT, share, six_digits, three_digits
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell
from rockpulse.views.shared.words import body_name, counted_words, say

#: Largest difference of P and the share of records that overturn the nominal body that is not explained.
APART = 0.1
#: Meaning of each verdict, as a key of [legend] in the texts.
_MEANINGS = (
    *("overturns", "may_overturn", "rocks", "no_margin", "not_lifted", "at_rest", "not_known", "slides_first"),
)


def verdict_columns(answers: Answers, rows: Sequence[Finding]) -> tuple[col.Column, ...]:
    """Return the columns that follow the names of the bodies; if there are demands, all columns refer to a demand."""
    if answers.motions.kind == "sequence":
        return col.columns("verdict", "smallest_safety_factor")
    sliding = ("sliding",) if any(map(_may_slide, rows)) else ()
    if not answers.demands:
        smallest = col.columns(f"smallest_{answers.factor}") if answers.has_factor else ()
        return (*col.columns("overturned_by"), *smallest, *col.columns("governing", "uplift", *sliding))
    names = ["at_demand"] if len(answers.demands) > 1 else []
    names += ["verdict"] if any(one.grade != Grade.NO_VERDICT for one in rows) else []
    names += ["probability" if answers.probable else "share", "probability_upper"]
    names += ["capacity"] if answers.has_factor else []
    names += ["overturned_by"]
    if not all(math.isnan(one.median_rotation) for one in rows):
        names += ["median_rotation", "others_rotation", "top_displacement"]
    return col.columns(*names, *sliding, "governing")


def _apart(found: Finding) -> bool:
    """Return whether the share of records that overturn the nominal body differs much from the probability."""
    return bool(abs(found.overturned / max(found.motions, 1) - found.share.value) > APART)


def _may_slide(found: Finding) -> bool:
    return found.slides_first or not math.isnan(found.sliding)


def verdict_rows(
    answers: Answers, found: Sequence[tuple[BodyVerdict, Finding]], governing: Callable[[int], Cell]
) -> dict[str, list[Any]]:
    """Return the values of the columns, a row for each finding; `governing` returns the cell of a record."""
    summary, places = answers.summary, [one.body.place for one, _ in found]
    rows = [row for _, row in found]
    turn = np.array([row.others_rotation for row in rows]) * summary["alpha_c"].values[places]
    return {
        "demand": [row.demand for row in rows],
        "found": rows,
        "value": [row.share.value for row in rows],
        "high": [row.share.high for row in rows],
        "margin": [row.margin for row in rows],
        "fallen": [row.overturned for row in rows],
        "total": [row.motions for row in rows],
        "median": [row.median_rotation for row in rows],
        "others": [row.others_rotation for row in rows],
        "top": (100.0 * summary["height"].values[places] * np.sin(turn)).tolist(),
        "uplift": summary["uplift_acceleration"].values[places].tolist(),
        "governing": [governing(row.governing) if row.governing >= 0 else Cell(ABSENT) for row in rows],
    }


def verdict_legend(answers: Answers, rows: Sequence[Finding]) -> list[str]:
    """Explain the columns and words of the table, and which records are not counted."""
    if answers.motions.kind == "sequence":
        return [say("legend.sequence")]
    sliding = f" {say('legend.sliding')}" if any(map(_may_slide, rows)) else ""
    factor = f" {say(f'legend.{answers.factor}')}" if answers.has_factor else ""
    if not answers.demands:
        first = f" {say('legend.slides_first')}" if any(row.slides_first for row in rows) else ""
        return [say("legend.as_recorded") + factor + sliding + first, *_not_counted(rows)]
    found = {row.status for row in rows}
    levels = {"overturns": six_digits(OVERTURNS), "may": six_digits(MAY_OVERTURN)}
    words = [say(f"legend.{name}", **levels) for name in _MEANINGS if name in found]
    what = say("legend.probability" if answers.probable else "legend.share")
    capacity = f" {say('legend.capacity', factor=say(f'factor.{answers.factor}'))}" if answers.has_factor else ""
    turned = any(not math.isnan(row.median_rotation) for row in rows)
    return [
        " ".join(filter(None, (what, *words))) + capacity + (f" {say('legend.rotation')}" if turned else "") + sliding,
        *([say("legend.nominal")] if answers.probable and any(map(_apart, rows)) else []),
        *_not_counted(rows),
    ]


def _not_counted(rows: Sequence[Finding]) -> list[str]:
    """State how many records are too far from a demand or too weak, and which demands have too few earthquakes."""
    notes = []
    for demand in dict.fromkeys(row.demand for row in rows):
        own = [row for row in rows if row.demand == demand]
        at = say("legend.of_demand", name=demand) if demand else ""
        lost, weak = max(row.left_out for row in own), max(row.weak for row in own)
        if lost:
            low, high = map(six_digits, FARTHEST)
            notes.append(say("legend.left_out", motions=counted_words(lost, "motion"), at=at, low=low, high=high))
        if weak:
            notes.append(say("legend.weak", motions=counted_words(weak, "motion"), at=at, share=six_digits(WEAK)))
        fewest = min(row.earthquakes for row in own)
        if demand and fewest < FEWEST_AT_DEMAND:
            events = counted_words(fewest, "earthquake")
            notes.append(say("legend.few", events=events, at=at, needed=FEWEST_AT_DEMAND))
    return notes


def of_unknown_event(motions: Motions) -> str:
    """Describe how records of unknown earthquakes are counted; empty if all earthquakes are known."""
    count = motions.events.count(UNKNOWN)
    if not count:
        return ""
    key = "unknown_event.as_one" if count == len(motions.events) else "unknown_event.not_counted"
    return say(key, motions=counted_words(count, "motion"))


#: Largest number of anchors that are described below the table.
ANCHORS = 8


def tie_table(answers: Answers, found: Sequence[BodyVerdict], record: Callable[[int], Cell]) -> Table | None:
    """Return a table with a row for each tie and demand, and notes on the anchors; None if there are no ties.

    `record` returns the cell with the name of a record, given by its row in /summary.
    """
    rows = tie_findings(answers, found)
    if not rows:
        return None
    several = len(answers.demands) > 1
    heads = (("tie", ""), *([("demand", "")] if several else []), ("height", "m"), ("elongation", "mm"), ("share", ""))
    heads = (*heads, ("force", "kN"), ("yields", ""), ("breaks", ""), ("record", ""))
    headings = tuple(Heading(say(f"tie.head.{name}"), unit) for name, unit in heads)
    cells = tuple(_cells(one, several, record) for one in rows)
    anchors = [_anchor(one) for one in rows if one.deciding]
    more = [say("tie.more", count=len(anchors) - ANCHORS)] if len(anchors) > ANCHORS else []
    return Table("ties", say("tie.caption"), headings, cells, (say("tie.legend"), *anchors[:ANCHORS], *more))


def _name(one: TieFinding) -> str:
    return say("tie.name", body=body_name(one.body.name), number=one.number)


def _cells(one: TieFinding, several: bool, record: Callable[[int], Cell]) -> tuple[Cell, ...]:
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
        record(one.governing) if one.governing >= 0 else Cell(ABSENT),
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
