"""The table of the verdicts on the bodies, used by all views: its columns, rows and legend, and notes on results."""

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Any

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Motions, searched_up_to
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
    worse_with_pedestal,
)
from rockpulse.model_table import MODELS, UPPER_BOUND, is_upper_bound
from rockpulse.selection.events import UNKNOWN
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import ABSENT, ratio, several, share, six_digits, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, CellMark, Heading, Table, number_cell
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
    apart = any(abs(row.overturned / max(row.motions, 1) - row.share.value) > APART for row in rows)
    return [
        " ".join(filter(None, (what, *words))) + capacity + (f" {say('legend.rotation')}" if turned else "") + sliding,
        *([say("legend.nominal")] if answers.probable and apart else []),
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
    cells: dict[str, tuple[str, Callable[[TieFinding], Cell]]] = {
        "tie": ("", lambda one: Cell(_name(one), link=f"body-{one.body.place}")),
        "demand": ("", lambda one: Cell(one.demand)),
        "height": ("m", lambda one: number_cell(one.tie.height)),
        "elongation": ("mm", lambda one: number_cell(1000.0 * one.elongation)),
        "share": ("", lambda one: number_cell(one.share, lambda own: say("tie.over") if own >= 1.0 else share(own))),
        "force": ("kN", lambda one: number_cell(one.force / 1000.0)),
        "yields": ("", lambda one: _count(one.yielded, one, one.tie.yield_force)),
        "breaks": ("", lambda one: _count(one.broken, one, one.tie.ultimate)),
        "record": ("", lambda one: record(one.governing) if one.governing >= 0 else Cell(ABSENT)),
    }
    if len(answers.demands) == 1:
        del cells["demand"]
    headings = tuple(Heading(say(f"tie.head.{name}"), unit) for name, (unit, _) in cells.items())
    every = tuple(tuple(cell(one) for _, cell in cells.values()) for one in rows)
    anchors = [_anchor(one) for one in rows if one.deciding]
    more = [say("tie.more", count=len(anchors) - ANCHORS)] if len(anchors) > ANCHORS else []
    return Table("ties", say("tie.caption"), headings, every, (say("tie.legend"), *anchors[:ANCHORS], *more))


def _name(one: TieFinding) -> str:
    return say("tie.name", body=body_name(one.body.name), number=one.number)


def _count(count: int, one: TieFinding, limit: float) -> Cell:
    """Return a cell with a number of records; a dash if the tie cannot yield or break, as the limit is infinite."""
    counted = col.count_of(count, one.motions)._replace(value=float(count))
    return Cell(ABSENT, math.nan) if math.isinf(limit) else counted


def _anchor(one: TieFinding) -> str:
    """State the force and elongation that an anchor must resist, and whether the tie never breaks."""
    limit = one.tie.yield_force
    fields = {
        "name": _name(one),
        "force": three_digits((limit if one.yielded else one.force) / 1000.0, "kN"),
        "elongation": three_digits(1000.0 * one.elongation, "mm"),
        "limit": three_digits(limit / 1000.0, "kN"),
        "count": one.broken,
        "motions": one.motions,
    }
    keys = ["yields"] if one.yielded else ["elastic", *(["capacity"] if math.isfinite(limit) else [])]
    if one.broken:
        keys = ["breaks"]
    elif one.force == 0.0 or math.isnan(one.elongation):
        keys = ["slack" if one.force == 0.0 else "overturns"]
    keys += ["unlimited"] if math.isinf(one.tie.ultimate) else []
    return "".join(say(f"tie.{key}", **fields) for key in keys)


def factor_heading(factor: str) -> str:
    """Return the column heading of a scale factor; `factor` is the name of its variable, such as "factor_10"."""
    return say(f"column.{factor}.head")


def factor_name(factor: str) -> str:
    """Return the words for a scale factor in a sentence; `factor` is the name of its variable, such as "factor_10"."""
    return say(f"factor.{factor}")


def stored_uncertainty(answers: Answers) -> str:
    """Return the stored description of the uncertainty that the probability of overturning includes."""
    return str(answers.summary["overturning_probability"].attrs.get("comment", "nonlinear model"))


def factor_notes(answers: Answers, swept: bool = False) -> list[str]:
    """Explain the columns of scale factors; with `swept`, each value is the smallest over all directions of a pair."""
    if not answers.has_factor:
        return []
    factor = answers[answers.factor]
    of = "the main impulse (I_s/I kept)" if answers.motions.kind == "sequence" else "the record"
    of += ", over direction," if swept else ""
    none = none_found(answers)
    if answers.probable:
        least = f" Scale factor at P = 10 %: smallest multiplier on {of}." if swept else ""
        known = stored_uncertainty(answers)
        known = known[:1].upper() + known[1:]
        return [f"P: probability of overturning under the record as recorded.{least} {known}.{none}"]
    notes = [f"SF: smallest scale factor on {of} at which the body overturns by the {answers.model} model.{none}"]
    if missed := missed_step(answers):
        notes[0] += (
            f" Ranges of overturning scale factors narrower than the step of the search (up to {missed:.1%}) may lie "
            f"below SF, undetected: the second digit of SF is not reliable ([search] {MODELS[answers.model].grid})."
        )
    if bounds := np.count_nonzero(answers.bound):
        notes.append(
            "!: a lower bound: from this scale factor on the model gives no result (free flight, for example; "
            f"{bounds} of {answers.bound.size}); below it no overturning was found."
        )
    rocks = (answers["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        may = ", or may (!)" if np.any(rocks & answers.bound) else ""
        rock = "rocks" if lucky == 1 else "rock"
        notes.append(f"{lucky} with SF below 1 {rock} only: a smaller scale factor overturns the body{may}.")
    return notes


def none_found(answers: Answers) -> str:
    """Explain the entry for bodies that do not overturn at any scale factor; empty if there are no such bodies."""
    factor = answers[answers.factor]
    if not np.isinf(factor).any():
        return ""
    return f" {col.factor_cell(math.inf, searched_up_to(factor, answers.proven())).marked}{col.NONE_UP_TO.note[1:]}"


def missed_step(answers: Answers) -> float:
    """Return the relative width of an interval of scale factors that the search can miss; 0 for exact solutions."""
    return max(float(np.nanmax(answers["search_step"], initial=1.0)) - 1.0, 0.0)


def verdict_notes(answers: Answers, of_factors: list[str], marks: Collection[CellMark]) -> list[str]:
    """Return all notes below a table with the results of every model; `marks` are the marks that the table contains."""
    notes = [
        "Model columns: largest rotation over the critical angle (theta_max/alpha_c). C: velocity ratio of "
        "an impact. Uplift ratio: PGA over the PGA that lifts the body. I/I_1c: main impulse over the single impulse "
        "that overturns the body.",
        *([say("note.beyond_critical")] if beyond_critical(answers) else []),
        *of_factors,
    ]
    if answers["pgv_drift"].any():
        notes.append(
            "~ (drift): the baseline of the record drifts: its velocity does not end at zero, and PGV may be wrong by "
            "as much."
        )
    notes += [*col.doubt_notes(col.record_cells(answers.summary)), *cautions(answers.models)]
    notes += [col.OUTSIDE.note] if col.OUTSIDE in marks else []
    models = answers.of_models.values()
    reasons = {int(code) for one in models for code in one["reason"][one["outcome"] == Outcome.UNRESOLVED]}
    if reasons:
        words = ", ".join(Reason(code).name.lower().replace("_", " ") for code in sorted(reasons))
        notes.append(f"unresolved: the model gives no result ({words}).")
    return notes


def beyond_critical(answers: Answers) -> bool:
    """Return whether a body rotated beyond its critical angle without overturning."""
    return any(
        bool(((one["outcome"] == Outcome.ROCKS) & (one["peak_rotation_ratio"] > 1.0)).any())
        for one in answers.of_models.values()
    )


def counted_motions(motions: Motions) -> str:
    """Return the number of records and earthquakes as text, such as "7 records of 2 earthquakes"."""
    if motions.kind == "sequence":
        return say("motions.sequence")
    each = f", each in {motions.index.shape[1]} directions" if motions.kind == "pair" else ""
    noun = "pair of channels" if motions.kind == "pair" else motions.kind
    return f"{several(len(motions.names), noun)} of {several(motions.event_count, 'earthquake')}{each}"


def body_notes(answers: Answers, found: Sequence[BodyVerdict]) -> list[str]:
    """Return a sentence for every body with crushing at its edge, and for every body on a pedestal."""
    notes, crushed = [], answers.summary["hinge_depth"].values > 0.0
    for name in np.array(answers.blocks)[crushed].tolist():
        notes.append(say("crushed.note", name=name, **Known(answers.summary, block=name).crushing))
    for alone, worst in worse_with_pedestal(answers, found):
        value = f"{'P' if answers.probable else 'share'} {ratio(worst.share.value)}"
        outcome = ", ".join(filter(None, (worst.deciding.word, value)))
        notes.append(
            f"{alone}: assessed alone and as one body with its pedestal; the worse result governs: {worst.body.name} "
            f"({outcome}); simultaneous motions of both parts are not modelled."
        )
    return notes


def cautions(names: Iterable[str]) -> list[str]:
    """Return a sentence for each model whose input sequence is an upper bound."""
    bounds = [MODELS[name] for name in names if is_upper_bound(name)]
    return [f"{model.name}: an {UPPER_BOUND} ({model.upper_bound}), not a prediction." for model in bounds]
