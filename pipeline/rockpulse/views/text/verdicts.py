"""The results of all models as text: a line for every record and body, the verdicts, and the worst records."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, searched_up_to
from rockpulse.assessment.verdict import Grade, nominal_motion, overturning_probabilities, too_far, verdicts
from rockpulse.errors import some
from rockpulse.record.measures import PGA, PGV
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import paragraph, several, shortened, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Heading, Table, lines
from rockpulse.views.shared.verdict_table import (
    body_notes,
    counted_motions,
    factor_heading,
    factor_name,
    factor_notes,
    of_unknown_event,
    stored_uncertainty,
    verdict_columns,
    verdict_legend,
    verdict_notes,
    verdict_rows,
)

#: Columns of every table by record, and columns of the probability.
DEMAND = ("block", "restitution", "uplift_ratio", "impulse_ratio")
PROBABILITY = ("probability_interval", "factor_10", "factor_50", "factor_mean", "source")
#: How a demand is given.
STATE_DEMAND = 'To state a demand: --demand pga=0.35g, [site] pga = "0.35 g" or ag and ground, or [[demand]].'
#: Largest number of governing records, and of bodies that are named for each.
NAMED = 3


def verdict_table(summary: xr.Dataset) -> str:
    """Return the results of every model as text; the bodies follow below each record."""
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
    """Return text with a line for each body below each record; `table` has the cells after the name and the demand."""
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
    """Return, as text, the records that overturn each body, their number in every model, and the note `files`."""
    names = [cell.marked for cell in col.record_cells(answers.summary)]
    fallen = answers.by_block(np.logical_or, answers.overturned)
    # P already accounts for bodies that survive by chance although a smaller scale factor overturns them.
    factor = np.full(fallen.shape, np.inf) if answers.probable else answers.by_block(np.fmin, answers["safety_factor"])
    lucky = ~fallen & (factor < 1.0)
    counts = [one.overturnings("block") for one in answers.of_models.values()]
    text_lines = [
        f"Records that overturn each body{', as recorded' if answers.demands else ''} ({answers.model} model):",
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
    """Return the verdicts on the bodies over all records; `most` limits them to the bodies most likely to overturn."""
    found = verdicts(answers)
    places = np.argsort([-one.share.value for one in found], kind="stable")[:most]
    kept = [found[lane] for lane in (np.sort(places) if most is None else places).tolist()]
    rows = [(one, row) for one in kept for row in one.findings]
    findings, every = [row for _, row in rows], [row for one in found for row in one.findings]
    values = verdict_rows(answers, rows, col.marked_record(answers.summary))
    selected = (
        col.titled("", Cell, "name", width=col.NAME_WIDTH),
        *(
            replace(one, cell=lambda row: Cell(col.grade_cell(row).text)) if one.name == "verdict" else one
            for one in verdict_columns(answers, findings)
        ),
    )
    table = col.filled(selected, {**values, "name": [f"  {one.body.name}" for one, _ in rows]})
    which = f"the {len(kept)} of {len(found)} bodies that are most likely to overturn"
    each = which if len(kept) < len(found) else "each body"
    judged = any(row.grade != Grade.NO_VERDICT for row in every)
    title = f"Verdict on {each}" if judged else each[:1].upper() + each[1:]
    unknown = of_unknown_event(answers.motions)
    asked = STATE_DEMAND if not answers.demands and answers.motions.kind != "sequence" else ""
    notes = [*verdict_legend(answers, every), *filter(None, [asked, unknown]), *body_notes(answers, found)]
    return "\n".join(
        [
            paragraph(f"{title}, {_under(answers)} ({answers.model} model):"),
            *lines(Table("", "", col.headed(selected), tuple(table))),
            *(paragraph(note, "  ") for note in notes),
        ]
    )


def _under(answers: Answers) -> str:
    """Describe the records on which the verdicts are based: unscaled, or scaled to the demands of the site."""
    motions = answers.motions
    if motions.kind == "sequence" or not answers.demands:
        return counted_motions(motions) + ("" if motions.kind == "sequence" else ", as recorded")
    named = answers.demands.items()
    demands = " and ".join(f"“{name}”" + f" ({one.words})" * (not name.startswith(one.title)) for name, one in named)
    return f"{counted_motions(motions)} scaled to the demand {demands}"


def worst_motions(answers: Answers, most: int) -> str:
    """Return the records most likely to overturn a body, unscaled or at the worst demand, with P and scale factor."""
    motions, found = answers.motions, [one.deciding for one in verdicts(answers)]
    if not motions.names or not found:
        return ""
    demand = max(found, key=lambda one: (one.grade, one.share.value)).demand or None
    far = too_far(answers, demand)
    factor = np.where(far, np.nan, answers.ratios(demand))
    chance = np.where(far, np.nan, overturning_probabilities(answers, demand))
    fallen, _ = nominal_motion(answers, demand)
    fallen = motions.in_any_direction(np.asarray(fallen & ~far))
    factor = np.fmin.reduce(motions.over(factor, np.nan), axis=1)
    chance = np.fmax.reduce(motions.over(chance, np.nan), axis=1)
    likely, near = np.where(np.isnan(chance), -1.0, chance), np.where(np.isnan(factor), np.inf, factor)
    body = np.array([np.lexsort((own, -every))[0] for own, every in zip(near, likely, strict=True)])
    at = np.arange(len(body)), body
    order = np.lexsort((near[at], -likely[at]))
    order = order[np.asarray(motions.kept(far).any(axis=1))[order]][:most]
    if not order.size:
        return ""
    marked, rows = col.marked_record(answers.summary), {name: row for row, name in enumerate(answers.records)}
    names = [motions.names[row] for row in order]
    strength = {name: np.fmax.reduce(motions.over(answers[name], np.nan), axis=1)[order] for name in (PGA, PGV)}
    values = {name: column.tolist() for name, column in strength.items()} | {
        "name": [f"  {marked(rows[name]).text if name in rows else name}" for name in names],
        "pgv_drift": [0] * len(order),
        "worst_for": [shortened(answers.bodies[lane].name, col.NAME_WIDTH) for lane in body[order]],
        "overturning_probability": chance[at][order].tolist(),
        "near": factor[at][order].tolist(),
        "fallen": fallen.sum(axis=1)[order].tolist(),
    }
    limit, bodies = searched_up_to(answers.ratios(demand), answers.proven(demand)), len(answers.bodies)
    of_factor = factor_heading(answers.factor) if demand is None else col.COLUMNS["capacity"].heading.title
    selected = (
        col.titled("", Cell, "name"),
        *col.columns(PGA, PGV, "worst_for", *(["overturning_probability"] if answers.probable else [])),
        col.titled(of_factor, lambda value: col.unexplained(col.factor_cell(value, limit)), "near"),
        col.titled(
            col.COLUMNS["overturns"].heading.title, lambda count: Cell(col.count_of(count, bodies).text), "fallen"
        ),
    )
    which = f"The worst {len(order)} of {len(motions.names)}" if len(order) < len(motions.names) else "All"
    what = {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}[motions.kind]
    table = lines(Table("", "", col.headed(selected), tuple(col.filled(selected, values))))
    note = "Worst body: the one most likely to overturn"
    note += f", with its P and {'scale factor' if demand is None else 'capacity/demand'}." if answers.probable else "."
    note += " PGA and PGV: as recorded." if demand is not None else ""
    if np.isinf(values["near"]).any() and not math.isnan(limit):
        note += f" {col.factor_cell(math.inf, limit).marked}: no overturning up to the largest scale factor tried."
    scaled = "unscaled" if demand is None else f"scaled to the demand “{demand}”"
    return "\n".join(
        [f"{which} {what} ({scaled}), worst first:", *table, *([paragraph(note, "  ")] if answers.has_factor else [])]
    )


def governing(answers: Answers) -> str:
    """Describe the records that govern the verdicts, with the bodies they govern; empty if there are none."""
    ruled: dict[int, dict[str, None]] = {}
    for one in verdicts(answers):
        if (row := one.deciding.governing) >= 0:
            ruled.setdefault(row, {})[one.body.block] = None
    text_lines = []
    for row, blocks in sorted(ruled.items(), key=lambda item: -len(item[1]))[:NAMED]:
        record = answers.records[row]
        if known := Known(answers.summary, record=record).described:
            text_lines.append(paragraph(f"{record}: {known} (for {some(list(blocks), NAMED)})", "      ", "  "))
    if not text_lines:
        return ""
    if len(ruled) > NAMED:
        text_lines.append(f"  and {several(len(ruled) - NAMED, 'other record')}")
    smallest = "capacity/demand" if answers.demands else factor_name(answers.factor)
    what = f"with the smallest {smallest}" if answers.has_factor else "that overturns"
    return "\n".join([f"Governing records (the one {what}, {answers.model} model):", *text_lines])
