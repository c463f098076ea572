"""The verdicts of all models as text: a line for every record and body, and what overturns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, searched_up_to
from rockpulse.assessment.demand import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, verdicts
from rockpulse.earthquakes import FEWEST_EVENTS
from rockpulse.errors import some
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.answer_cells import (
    NAMES,
    TITLES,
    answer_cells,
    factor_cell,
    factor_cells,
    factor_columns,
    margin_cells,
    marks_of,
    safety_cells,
    unexplained,
)
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import (
    ABSENT,
    between,
    figure,
    paragraph,
    ratio,
    restitution,
    several,
    shortened,
)
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO, body_notes, counted, noun, verdict_notes
from rockpulse.views.text.capacity import NAME_WIDTH, factor_notes, uncertainty_words

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "body_verdicts",
    "factor_table",
    "governing",
    "overturned",
    "probability_table",
    "verdict_table",
    "worst_motions",
]

#: Records that govern, and bodies that each of them governs, which are named.
NAMED = 3


def verdict_table(
    summary: xr.Dataset, records: Sequence[str] | None = None, blocks: Sequence[str] | None = None
) -> str:
    """The verdict of every model, one line per block under a heading per record, with footnotes.

    Of some records or blocks where these are given.
    """
    answers = _answers(summary, records, blocks)
    of_factors = factor_notes(answers)
    columns = {model: answer_cells(one) for model, one in answers.of_models.items()}
    marks = marks_of(cell for column in columns.values() for cells in column for cell in cells)
    columns |= factor_columns(answers)
    notes = verdict_notes(answers, of_factors, marks)
    return "\n".join([*_lines(answers, columns), "", *(paragraph(note, "  ") for note in notes)])


def probability_table(answers: Answers) -> str:
    """The probability of overturning and the factors that it grows with, laid out as the verdicts.

    Empty where there is none.
    """
    if not answers.probable:
        return ""
    columns = {
        "P": [[_probability(*one) for one in zip(*rows, strict=True)] for rows in _with_ends(answers)],
        **{TITLES[name]: factor_cells(answers, name) for name in ("factor_10", "factor_50", "capacity_mean")},
        "read from": [[Cell(word.replace("_", " ")) for word in row] for row in answers.source.tolist()],
    }
    notes = [
        "P: probability of overturning under the record as it is, in brackets its interval of 90 %; factor of 10 %, of "
        f"50 %: factors on the record at which it is that; mean capacity: exp of the mean logarithm of the factor that "
        f"overturns; {uncertainty_words(answers)}."
    ]
    cells = (cell for column in columns.values() for row in column for cell in row)
    notes += [NONE_UP_TO.note] if NONE_UP_TO in marks_of(cells) else []
    title = "Probability of overturning, and the factors on the record that it grows with"
    return "\n".join([title, *_lines(answers, columns), "", *(paragraph(note, "  ") for note in notes), "", ""])


def factor_table(answers: Answers) -> str:
    """The smallest factor on a model's input that overturns the block, laid out as the verdicts.

    Empty where no model was searched.
    """
    if not any(one.searched for one in answers.of_models.values()):
        return ""
    columns = {model: safety_cells(one) for model, one in answers.of_models.items() if one.searched}
    marks = marks_of(cell for column in columns.values() for row in column for cell in row)
    notes = [
        "-: not computed. (2): in two intervals of the factor; between them the block stands (group "
        "overturning_intervals)."
    ]
    if NONE_UP_TO in marks:
        notes.insert(0, NONE_UP_TO.note)
    elif any(np.isinf(one["safety_factor"]).any() for one in answers.of_models.values()):
        notes.insert(0, "none: not found up to the end of the search.")
    notes += ["!: a lower bound, from this factor on the model cannot answer."] if NO_ANSWER in marks else []
    title = "Safety factors: the smallest factor on the input of the model at which the block overturns"
    return "\n".join([title, *_lines(answers, columns), "", *(paragraph(note, "  ") for note in notes)])


def _with_ends(answers: Answers) -> Iterator[tuple[list[float], ...]]:
    tables = (answers[f"overturning_probability{end}"].tolist() for end in ("", "_low", "_high"))
    return zip(*tables, strict=True)


def _probability(value: float, low: float, high: float) -> Cell:
    shown = ratio(value) if math.isnan(low) else f"{ratio(value)} ({between(low, high, ratio)})"
    return Cell(shown, value)


def overturned(answers: Answers, files: str = "") -> str:
    """The part of the overview on overturning: the records that overturn each block, by the fullest model in use.

    Before them stands what is to be known of the `files`, where not all are among these records. Below stand the counts
    of every model, and the pairs in which a block rocks under a record but is overturned by a weaker copy of it, which
    is no safer.
    """
    names = [cell.marked for cell in record_cells(answers.summary)]
    fallen = answers.by_block(np.logical_or, answers.overturned)
    # A probability already counts what rocks by luck alone.
    factor = np.full(fallen.shape, np.inf) if answers.probable else answers.by_block(np.fmin, answers["safety_factor"])
    counts = [one.overturnings("block") for one in answers.of_models.values()]
    told = [f"What overturns (by the {answers.model} model):", *([paragraph(files, "    ", "  ! ")] if files else [])]
    rows, by_weaker = [], []
    for place, block in enumerate(answers.blocks):
        weaker = [
            f"{names[row]} ({figure(factor[row, place])})"
            for row in np.flatnonzero(~fallen[:, place] & (factor[:, place] < 1.0))
        ]
        nothing = "nothing as recorded does, but see below" if weaker else "nothing does"
        named = ", ".join(names[row] for row in np.flatnonzero(fallen[:, place]))
        told.append(paragraph(named or nothing, "      ", f"  {block}: "))
        by_weaker += [paragraph(", ".join(weaker), "      ", f"  {block}: ")] if weaker else []
        rows.append((Cell(block), *(Cell(f"{own[place]} of {len(names)}", float(own[place])) for own in counts)))
    headings = (Heading("records that overturn", width=NAME_WIDTH), *map(Heading, answers.models))
    told += ["", *("  " + line for line in lines(Table("", "", headings, tuple(rows))))]
    if by_weaker:
        told += ["", "What rocks, but a weaker copy of the record overturns it (SF in brackets):", *by_weaker]
    return "\n".join(told)


def body_verdicts(answers: Answers, most: int | None = None) -> str:
    """The verdict on every body over all motions; of more than `most` those that are the most likely to overturn."""
    found = verdicts(answers)
    order = sorted(range(len(found)), key=lambda place: -found[place].decides.value)[:most]
    places = sorted(order) if most is None else order
    names = [cell.marked for cell in record_cells(answers.summary)]
    factors, (top, turn) = _middle_factors(answers), _largest_survived(answers)
    uplift = answers.summary["uplift_acceleration"].values / STANDARD_GRAVITY
    of = "P" if answers.probable else "share"
    shares = [f"{of} at {name}" for name in answers.demands] if answers.demands else [of]
    headings = ("", "verdict", *shares, "up to", "a_up [g]", "f_50" if answers.probable else "median SF")
    headings = (*headings, "top [cm]", "turn [deg]", "worst " + noun(answers.motions).split()[0])
    rows = []
    for place in places:
        one = found[place]
        of_demands = [demand.share for demand in one.demands] or [one.share]
        rows.append(
            (
                Cell("  " + one.body.name),
                Cell(one.word),
                *(number(share.value, ratio) for share in of_demands),
                number(one.decides.high, ratio),
                number(float(uplift[one.body.place]), ratio),
                unexplained(factors[place]),
                number(float(top[place]), ratio),
                number(float(turn[place]), ratio),
                Cell(names[one.governing] if one.governing >= 0 else ABSENT),
            )
        )
    which = f"the {len(rows)} most likely to overturn of {len(found)} bodies" if len(rows) < len(found) else "each body"
    title = f"Verdict on {which}, {_under(answers, found)} ({answers.model} model):"
    widths = (NAME_WIDTH, *(None,) * (len(headings) - 1))
    table = Table("", "", tuple(map(lambda name, width: Heading(name, width=width), headings, widths)), tuple(rows))
    notes = [*_legend(answers), *body_notes(answers, found)]
    return "\n".join([paragraph(title), *lines(table), *(paragraph(note, "  ") for note in notes)])


def _under(answers: Answers, found: Sequence[BodyVerdict]) -> str:
    """The motions that the verdicts rest on: as they are, or brought to the demands of the site."""
    motions = answers.motions
    if motions.kind == "sequence" or not answers.demands:
        return counted(motions) + ("" if motions.kind == "sequence" else ", as recorded")
    told = []
    for place, (name, demand) in enumerate(answers.demands.items()):
        every = [one.demands[place] for one in found]
        lost, left = max(one.left_out for one in every), min(one.earthquakes for one in every)
        without = f", {lost} left out, farther from it than a factor of {FARTHEST[1]:g}" if lost else ""
        short = f"; {several(left, 'earthquake')} left, {FEWEST_AT_DEMAND} are needed" if every[0].few else ""
        told.append(f"{name} ({demand.words}{without}{short})")
    return f"{counted(motions)} brought to the demand {' and '.join(told)}"


def _legend(answers: Answers) -> list[str]:
    """The meaning of the words and columns of the verdicts, in three lines at most."""
    if answers.motions.kind == "sequence":
        return []
    few = answers.motions.event_count
    little = f" ({several(few, 'earthquake')}: read that end)" if few < FEWEST_EVENTS else ""
    what = "P: probability of overturning" if answers.probable else "share: earthquakes that overturn it"
    middle = "f_50: median factor for P = 50 %" if answers.probable else "SF: factor on a record that overturns"
    return [
        f"{what}, over earthquakes; up to: end of its 90 % interval{little}. overturns: {OVERTURNS:g} or more; may "
        f"overturn: {MAY_OVERTURN:g} or more; rocks: less; stays: never lifted. a_up: uplift; {middle}; top, turn: "
        "largest displacement and rotation survived."
    ]


def _middle_factors(answers: Answers) -> list[Cell]:
    """The median over the motions of the factor of 50 % probability, else of the safety factor, of every body."""
    if not answers.probable:
        return [margin_cells(margin)[1] for margin in answers.margins()]
    least = np.fmin.reduce(answers.motions.over(answers["factor_50"], np.nan), axis=1)
    known = np.where(np.isnan(least), np.inf, least)
    middle = np.sort(known, axis=0)[(len(known) - 1) // 2] if len(known) else np.full(len(answers.bodies), np.nan)
    limit = searched_up_to(answers["factor_50"], answers["factor_50_low"])
    return [factor_cell(float(value), limit) for value in middle]


def _largest_survived(answers: Answers) -> tuple[np.ndarray, np.ndarray]:
    """Of every body the largest displacement of its top [cm] and rotation [degrees] in what does not overturn it."""
    stays = np.isin(answers["outcome"], (Outcome.AT_REST, Outcome.ROCKS))
    peak = np.fmax.reduce(np.where(stays, answers["peak_rotation_ratio"], np.nan), axis=0, initial=np.nan)
    places = [body.place for body in answers.bodies]
    turn = peak * answers.summary["alpha_c"].values[places]
    return 100.0 * answers.summary["height"].values[places] * np.sin(turn), np.degrees(turn)


def worst_motions(answers: Answers, most: int) -> str:
    """The motions that are the most likely to overturn a body, as they are: the body, its probability and factor."""
    motions, factor = answers.motions, np.fmin.reduce(answers.motions.over(answers[answers.factor], np.nan), axis=1)
    if not motions.names:
        return ""
    if answers.probable:
        chance = np.fmax.reduce(motions.over(answers["overturning_probability"], np.nan), axis=1)
    else:
        chance = answers.overturned.astype(float)
    likely, near = np.where(np.isnan(chance), -1.0, chance), np.where(np.isnan(factor), np.inf, factor)
    body = np.array([np.lexsort((own, -every))[0] for own, every in zip(near, likely, strict=True)])
    at = np.arange(len(body)), body
    order = np.lexsort((near[at], -likely[at]))[:most]
    limit = searched_up_to(answers[answers.factor], answers.proven())
    pga, pgv = (np.fmax.reduce(motions.over(answers[name], np.nan), axis=1) for name in ("pga", "pgv"))
    marked = dict(zip(answers.records, (cell.marked for cell in record_cells(answers.summary)), strict=True))
    rows = [
        (
            Cell("  " + marked.get(motions.names[row], motions.names[row])),
            number(pga[row] / STANDARD_GRAVITY, ratio),
            number(pgv[row], ratio),
            Cell(shortened(answers.bodies[body[row]].name, NAME_WIDTH)),
            *([number(chance[row, body[row]], ratio)] if answers.probable else []),
            unexplained(factor_cell(float(factor[row, body[row]]), limit)),
            Cell(f"{int(answers.overturned[row].sum())} of {len(answers.bodies)}"),
        )
        for row in order.tolist()
    ]
    headings = ("", "PGA [g]", "PGV [m/s]", "worst for", *(["P"] if answers.probable else []), TITLES[answers.factor])
    which = f"The {len(rows)} worst of {len(motions.names)}" if len(rows) < len(motions.names) else "All"
    what = {"record": "records", "pair": "pairs of channels", "sequence": "sequences"}[motions.kind]
    title = f"{which} {what}, as recorded:"
    table = Table("", "", tuple(map(Heading, (*headings, "overturn"))), tuple(rows))
    return "\n".join([title, *lines(table)])


def governing(answers: Answers) -> str:
    """The records that the verdicts rest on in words, with the bodies; empty where nothing is known of any.

    Of every body that is the record of its smallest factor or, without one, the first that overturns it.
    """
    ruled: dict[int, dict[str, None]] = {}
    for one in verdicts(answers):
        if one.governing >= 0:
            ruled.setdefault(one.governing, {})[one.body.block] = None
    told = []
    for row, blocks in sorted(ruled.items(), key=lambda item: -len(item[1]))[:NAMED]:
        if known := Known(answers.summary, record=answers.records[row]).described:
            of = some(list(blocks), NAMED)
            told.append(paragraph(f"{answers.records[row]}: {known} (for {of})", "      ", "  "))
    if not told:
        return ""
    others = [f"  and {several(len(ruled) - NAMED, 'other record')}"] if len(ruled) > NAMED else []
    what = f"of the smallest {NAMES[answers.factor]}" if answers.told else "that overturns"
    return "\n".join([f"What governs (the record {what}, by the {answers.model} model):", *told, *others])


def _answers(summary: xr.Dataset, records: Sequence[str] | None, blocks: Sequence[str] | None) -> Answers:
    named = {"record": records, "block": blocks}
    return Answers(summary.sel({dim: list(labels) for dim, labels in named.items() if labels is not None}))


def _lines(answers: Answers, columns: dict[str, list[list[Cell]]]) -> list[str]:
    """A line for every body under a heading for every record."""
    demand = [answers["uplift_ratio"], answers["impulse_ratio"]]
    rows = [
        (
            Cell("  " + shortened(body.block, NAME_WIDTH)),
            number(body.restitution, restitution),
            *(number(float(table[row, lane]), ratio) for table in demand),
            *(column[row][lane] for column in columns.values()),
        )
        for row in range(len(answers.records))
        for lane, body in enumerate(answers.bodies)
    ]
    head, *laid = lines(Table("", "", tuple(map(Heading, ("", "C", "a/a_up", "I/I_1c", *columns))), tuple(rows)))
    found, size = [], len(answers.bodies)
    for place, cell in enumerate(record_cells(answers.summary)):
        found += ["", _heading(cell.marked, Known(answers.summary, record=cell.text)), head]
        found += laid[place * size : (place + 1) * size]
    return found[1:]


def _heading(name: str, record: Known) -> str:
    impulse = record.value("main_impulse")
    return "  ".join([name, *record.strength, *([] if math.isnan(impulse) else [f"I {figure(impulse, 'm/s')}"])])
