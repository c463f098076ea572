"""The results of all models as text: a line for every record and body, verdicts, and worst records."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, searched_up_to
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, Grade, verdicts
from rockpulse.earthquakes import FEWEST_EVENTS
from rockpulse.errors import some
from rockpulse.record.measures import PGA, PGV
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import ABSENT, paragraph, ratio, several, shortened, three_digits
from rockpulse.views.shared.notes import (
    body_notes,
    counted_motions,
    factor_heading,
    factor_name,
    factor_notes,
    stored_uncertainty,
    verdict_notes,
)
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Heading, Table, lines

#: Columns of every table by record, and columns of the probability.
DEMAND = ("block", "restitution", "uplift_ratio", "impulse_ratio")
PROBABILITY = ("probability_interval", "factor_10", "factor_50", "capacity_mean", "source")
#: Largest number of governing records, and of bodies that are named for each.
NAMED = 3


def verdict_table(summary: xr.Dataset) -> str:
    """Return the results of every model as text: a line for each body below the heading of each record."""
    answers = Answers(summary)
    of_models = col.answer_columns(answers)
    marks = col.marks_of(cell for column in of_models.values() for cell in column)
    factors = col.factor_columns(answers)
    more = zip(*of_models.values(), *zip(*col.filled(factors, col.AnswerRows.every(answers)), strict=True), strict=True)
    notes = verdict_notes(answers, factor_notes(answers), marks)
    return _below_records("", answers, (*map(Heading, of_models), *col.headed(factors)), list(more), notes)


def probability_table(answers: Answers) -> str:
    """Return probabilities and scale factors of overturning as text; empty if the results have none."""
    if not answers.probable:
        return ""
    selected = col.columns(*PROBABILITY)
    table = col.filled(selected, col.AnswerRows.every(answers))
    notes = [
        "P: probability of overturning under the record as recorded, in brackets its 90 % interval; scale factors: on "
        "the record, at P = 10 % and 50 %; mean scale factor: geometric mean of those at which the body overturns; "
        f"{stored_uncertainty(answers)}."
    ]
    notes += [col.NONE_UP_TO.note] if col.NONE_UP_TO in col.marks_of(cell for row in table for cell in row) else []
    title = "Probability of overturning and scale factors on the record"
    return _below_records(title, answers, col.headed(selected), table, notes) + "\n\n"


def factor_table(answers: Answers) -> str:
    """Return the smallest scale factors in every searched model as text; empty if no model was searched."""
    searched = {name: one for name, one in answers.of_models.items() if one.searched}
    if not searched:
        return ""
    selected = col.columns("safety_intervals")
    own = [[row[0] for row in col.filled(selected, col.AnswerRows.every(one))] for one in searched.values()]
    marks = col.marks_of(cell for column in own for cell in column)
    notes = [
        "-: not computed. (2): overturning in two intervals of scale factors, none between them (group "
        "overturning_intervals)."
    ]
    if col.NONE_UP_TO in marks:
        notes.insert(0, col.NONE_UP_TO.note)
    elif any(np.isinf(one["safety_factor"]).any() for one in answers.of_models.values()):
        notes.insert(0, "none: no overturning up to the largest scale factor tried.")
    notes += (
        ["!: a lower bound; from this scale factor on the model gives no result."] if col.NO_ANSWER in marks else []
    )
    title = "SF: smallest scale factor on the input of each model at which the body overturns"
    return _below_records(title, answers, tuple(map(Heading, searched)), list(zip(*own, strict=True)), notes)


def _below_records(
    title: str, answers: Answers, headings: Iterable[Heading], table: Sequence[tuple[Cell, ...]], notes: Sequence[str]
) -> str:
    """Return a table as text: below the heading of each record, its body rows; `table` has their further cells."""
    demands = col.filled(col.columns(*DEMAND), col.AnswerRows.every(answers))
    rows = [
        (Cell("  " + shortened(body.text, col.NAME_WIDTH)), *demand, *more)
        for (body, *demand), more in zip(demands, table, strict=True)
    ]
    demanded = (Heading(""), *col.headed(col.columns(*DEMAND[1:])))
    every = lines(Table("", "", (*demanded, *headings), tuple(rows)))
    head, laid = every[: -len(rows)], every[-len(rows) :]
    found, size = [], len(answers.bodies)
    for place, cell in enumerate(col.record_cells(answers.summary)):
        record = Known(answers.summary, record=cell.text)
        impulse = record.value("main_impulse")
        strength = [*record.strength, *([] if math.isnan(impulse) else [f"I {three_digits(impulse, 'm/s')}"])]
        found += ["", "  ".join([cell.marked, *strength]), *head, *laid[place * size : (place + 1) * size]]
    text_lines = [*([title] if title else []), *found[1:], "", *(paragraph(note, "  ") for note in notes)]
    return "\n".join(text_lines)


def overturned(answers: Answers, files: str = "") -> str:
    """Return the records that overturn each body, and their number in every model; `files` is shown above."""
    names = [cell.marked for cell in col.record_cells(answers.summary)]
    fallen = answers.by_block(np.logical_or, answers.overturned)
    # A probability already includes chance survival.
    factor = np.full(fallen.shape, np.inf) if answers.probable else answers.by_block(np.fmin, answers["safety_factor"])
    lucky = ~fallen & (factor < 1.0)
    counts = [one.overturnings("block") for one in answers.of_models.values()]
    text_lines = [
        f"Records that overturn each body ({answers.model} model):",
        *([paragraph(files, "    ", "  ! ")] if files else []),
    ]
    rows, by_weaker = [], []
    for place, block in enumerate(answers.blocks):
        weaker = [f"{names[row]} ({three_digits(factor[row, place])})" for row in np.flatnonzero(lucky[:, place])]
        nothing = "none as recorded, but see below" if weaker else "none"
        named = ", ".join(names[row] for row in np.flatnonzero(fallen[:, place]))
        text_lines.append(paragraph(named or nothing, "      ", f"  {block}: "))
        by_weaker += [paragraph(", ".join(weaker), "      ", f"  {block}: ")] if weaker else []
        rows.append((Cell(block), *(col.count_of(own[place], len(names)) for own in counts)))
    headings = (Heading("number of records", width=col.NAME_WIDTH), *map(Heading, answers.models))
    text_lines += ["", *lines(Table("", "", headings, tuple(rows)), "  ")]
    if by_weaker:
        text_lines += ["", "Records that overturn the body only if scaled down (SF in brackets):", *by_weaker]
    return "\n".join(text_lines)


def body_verdicts(answers: Answers, most: int | None = None) -> str:
    """Return a table of the verdicts as text, limited to the `most` bodies that are most likely to overturn."""
    found, summary = verdicts(answers), answers.summary
    places = np.argsort([-one.decides.value for one in found], kind="stable")[:most]
    lanes = (np.sort(places) if most is None else places).tolist()
    kept = [found[lane] for lane in lanes]
    names = [cell.marked for cell in col.record_cells(summary)]
    (top, rotation), factors = _largest_survived(answers), _middle_factors(answers)
    demands = [[demand.share for demand in one.demands] or [one.share] for one in kept]
    of = "P" if answers.probable else "share"
    likely = {f"{of} at {name}": place for place, name in enumerate(answers.demands)} or {of: 0}
    middle = f"median_{'factor_50' if answers.probable else 'safety_factor'}"
    values = {
        "name": [f"  {one.body.name}" for one in kept],
        "found": kept,
        "high": [one.decides.high for one in kept],
        "uplift": [float(summary["uplift_acceleration"].values[one.body.place]) for one in kept],
        "median": [factors[lane] for lane in lanes],
        "top": top[lanes].tolist(),
        "rotation": rotation[lanes].tolist(),
        "worst": [names[one.governing] if one.governing >= 0 else ABSENT for one in kept],
        **{title: [shares[place].value for shares in demands] for title, place in likely.items()},
    }
    selected = (
        col.titled("", Cell, "name", width=col.NAME_WIDTH),
        col.titled(col.COLUMNS["verdict"].heading.title, lambda one: Cell(col.grade_cell(one).text), "found"),
        *(col.titled(title, col.formatted(ratio), title) for title in likely),
        *col.columns("probability_upper", "uplift", middle, "top", "rotation"),
        *col.columns("worst", worst=f"worst {answers.motions.kind}"),
    )
    which = (
        f"the {len(kept)} of {len(found)} bodies that are most likely to overturn"
        if len(kept) < len(found)
        else "each body"
    )
    title = f"Verdict on {which}, {_under(answers, found)} ({answers.model} model):"
    unsized = np.isnan(top[lanes]) & ~np.isnan(rotation[lanes])
    reasons = {"height not given": unsized.any(), "no record without overturning": np.isnan(rotation[lanes]).any()}
    absent = " or ".join(reason for reason, occurs in reasons.items() if occurs)
    notes = [*_legend(answers, kept, absent), *body_notes(answers, found)]
    table = lines(Table("", "", col.headed(selected), tuple(col.filled(selected, values))))
    return "\n".join([paragraph(title), *table, *(paragraph(note, "  ") for note in notes)])


def _under(answers: Answers, found: Sequence[BodyVerdict]) -> str:
    """Describe the records from which the verdicts follow, unscaled or scaled to the demands."""
    motions = answers.motions
    if motions.kind == "sequence" or not answers.demands:
        return counted_motions(motions) + ("" if motions.kind == "sequence" else ", as recorded")
    demands = []
    for place, (name, demand) in enumerate(answers.demands.items()):
        every = [one.demands[place] for one in found]
        lost, left = max(one.left_out for one in every), min(one.earthquakes for one in every)
        without = f", {lost} left out: scale factor outside {FARTHEST[0]:g} to {FARTHEST[1]:g}" if lost else ""
        short = f"; {several(left, 'earthquake')} left, {FEWEST_AT_DEMAND} are needed" if every[0].few else ""
        demands.append(f"{name} ({demand.words}{without}{short})")
    return f"{counted_motions(motions)} scaled to the demand {' and '.join(demands)}"


#: Meaning of each verdict in terms of the probability, or of the share of records, from which it follows.
_MEANING = {
    Grade.OVERTURNS: f"overturns: {{0}} >= {OVERTURNS:g}",
    Grade.MAY_OVERTURN: f"may overturn: {{0}} >= {MAY_OVERTURN:g}",
    Grade.ROCKS: f"rocks: {{0}} < {MAY_OVERTURN:g}",
    Grade.AT_REST: "at rest: never lifted",
    Grade.NOT_KNOWN: "not known: some records give no result",
}


def _legend(answers: Answers, found: Sequence[BodyVerdict], absent: str) -> list[str]:
    """Explain the verdicts and columns of the table; `absent` says why a largest rotation is missing."""
    if answers.motions.kind == "sequence":
        return []
    few = answers.motions.event_count
    little = f" (wide: {several(few, 'earthquake')})" if few < FEWEST_EVENTS else ""
    what, middle = "share: share of earthquakes that overturn the body", "at which it overturns"
    if answers.probable:
        what, middle = "P: probability of overturning, mean over earthquakes", "at P = 50 %"
    of, grades = what.partition(":")[0], {one.overall for one in found}
    words = "; ".join(meaning.format(of) for grade, meaning in _MEANING.items() if grade in grades)
    return [
        f"{what}; upper 90 %: upper end of the 90 % interval{little}. {words[:1].upper()}{words[1:]}. Uplift PGA: PGA "
        f"at which the body starts to lift. Median scale factor: median over records of the multiplier {middle}. Top "
        f"displ., rotation: largest without overturning{f' (-: {absent})' if absent else ''}."
    ]


def _middle_factors(answers: Answers) -> list[Cell]:
    """Return for every body a cell with the median over the records of the scale factor at P = 50 %."""
    if not answers.probable:
        return [col.margin_cells(margin)[1] for margin in answers.margins()]
    least = np.fmin.reduce(answers.motions.over(answers["factor_50"], np.nan), axis=1)
    known = np.where(np.isnan(least), np.inf, least)
    middle = np.sort(known, axis=0)[(len(known) - 1) // 2] if len(known) else np.full(len(answers.bodies), np.nan)
    limit = searched_up_to(answers["factor_50"], answers["factor_50_low"])
    return [col.factor_cell(float(value), limit) for value in middle]


def _largest_survived(answers: Answers) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement of the top [cm] and rotation [degrees] of every body, the largest without overturning."""
    stays = np.isin(answers["outcome"], (Outcome.AT_REST, Outcome.ROCKS))
    peak = np.fmax.reduce(np.where(stays, answers["peak_rotation_ratio"], np.nan), axis=0, initial=np.nan)
    places = [body.place for body in answers.bodies]
    turn = peak * answers.summary["alpha_c"].values[places]
    return 100.0 * answers.summary["height"].values[places] * np.sin(turn), np.degrees(turn)


def worst_motions(answers: Answers, most: int) -> str:
    """Return the unscaled records that are most likely to overturn a body, as a table in text form."""
    motions, factor = answers.motions, np.fmin.reduce(answers.motions.over(answers[answers.factor], np.nan), axis=1)
    if not motions.names:
        return ""
    chance = answers.overturned.astype(float)
    if answers.probable:
        chance = np.fmax.reduce(motions.over(answers["overturning_probability"], np.nan), axis=1)
    likely, near = np.where(np.isnan(chance), -1.0, chance), np.where(np.isnan(factor), np.inf, factor)
    body = np.array([np.lexsort((own, -every))[0] for own, every in zip(near, likely, strict=True)])
    at = np.arange(len(body)), body
    order = np.lexsort((near[at], -likely[at]))[:most]
    marked = dict(zip(answers.records, (cell.marked for cell in col.record_cells(answers.summary)), strict=True))
    strength = {name: np.fmax.reduce(motions.over(answers[name], np.nan), axis=1)[order] for name in (PGA, PGV)}
    values = {name: column.tolist() for name, column in strength.items()} | {
        "name": [f"  {marked.get(motions.names[row], motions.names[row])}" for row in order],
        "pgv_drift": [0] * len(order),
        "worst_for": [shortened(answers.bodies[lane].name, col.NAME_WIDTH) for lane in body[order]],
        "overturning_probability": chance[at][order].tolist(),
        "near": factor[at][order].tolist(),
        "fallen": answers.overturned.sum(axis=1)[order].tolist(),
    }
    limit, bodies = searched_up_to(answers[answers.factor], answers.proven()), len(answers.bodies)
    title = col.COLUMNS["overturns"].heading.title
    selected = (
        col.titled("", Cell, "name"),
        *col.columns(PGA, PGV, "worst_for", *(["overturning_probability"] if answers.probable else [])),
        col.titled(
            factor_heading(answers.factor), lambda value: col.unexplained(col.factor_cell(value, limit)), "near"
        ),
        col.titled(title, lambda count: Cell(col.count_of(count, bodies).text), "fallen"),
    )
    which = f"The worst {len(order)} of {len(motions.names)}" if len(order) < len(motions.names) else "All"
    what = {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}[motions.kind]
    table = lines(Table("", "", col.headed(selected), tuple(col.filled(selected, values))))
    note = f"Worst body: the one most likely to overturn{', with its P and scale factor' if answers.probable else ''}."
    if np.isinf(factor[at][order]).any() and not math.isnan(limit):
        note += f" {col.factor_cell(math.inf, limit).marked}: no overturning up to the largest scale factor tried."
    return "\n".join(
        [f"{which} {what} (unscaled), worst first:", *table, *([paragraph(note, "  ")] if answers.has_factor else [])]
    )


def governing(answers: Answers) -> str:
    """Describe the records that govern the verdicts, and name their bodies; empty if there are none."""
    ruled: dict[int, dict[str, None]] = {}
    for one in verdicts(answers):
        if one.governing >= 0:
            ruled.setdefault(one.governing, {})[one.body.block] = None
    text_lines = []
    for row, blocks in sorted(ruled.items(), key=lambda item: -len(item[1]))[:NAMED]:
        record = answers.records[row]
        if known := Known(answers.summary, record=record).described:
            text_lines.append(paragraph(f"{record}: {known} (for {some(list(blocks), NAMED)})", "      ", "  "))
    if not text_lines:
        return ""
    if len(ruled) > NAMED:
        text_lines.append(f"  and {several(len(ruled) - NAMED, 'other record')}")
    what = f"with the smallest {factor_name(answers.factor)}" if answers.has_factor else "that overturns"
    return "\n".join([f"Governing records (the one {what}, {answers.model} model):", *text_lines])
