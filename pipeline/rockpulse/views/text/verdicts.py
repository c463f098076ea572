"""The verdicts of all models as text: a line for every record and body, and what overturns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import verdicts
from rockpulse.failures import some
from rockpulse.views.shared.answer_cells import (
    NAMES,
    TITLES,
    answer_cells,
    factor_cells,
    factor_columns,
    margin_cells,
    marks_of,
    safety_cells,
)
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.record_marks import record_cells
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number
from rockpulse.views.shared.terminal import between, figure, paragraph, ratio, restitution, several, shortened
from rockpulse.views.shared.verdict_notes import NO_ANSWER, NONE_UP_TO, counted, share_notes, verdict_notes
from rockpulse.views.text.capacity import NAME_WIDTH, factor_notes, uncertainty_words

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["body_verdicts", "factor_table", "governing", "overturned", "probability_table", "verdict_table"]

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
    order = sorted(range(len(found)), key=lambda place: -found[place].share.value)[:most]
    places = sorted(order) if most is None else order
    motions, names = answers.motions, answers.factor
    rows = []
    for one in (found[place] for place in places):
        share, (smallest, median) = one.share, margin_cells(one.margin)
        rows.append(
            (
                Cell("  " + one.body.block),
                number(one.body.restitution, restitution),
                Cell(one.overall.word + (" at the demand" if one.overall > one.grade else "")),
                number(share.value, ratio),
                Cell(between(share.low, share.high, ratio)),
                Cell(f"{one.overturned} of {len(motions.names)}", float(one.overturned)),
                smallest,
                median,
            )
        )
    of = "P" if answers.probable else "share"
    headings = ("", "C", "verdict", of, "90 %", "overturned by", f"smallest {TITLES[names]}", "median")
    which = f"the {len(rows)} most likely to overturn of {len(found)} bodies" if len(rows) < len(found) else "each body"
    title = f"Verdict on {which}, {counted(motions)} ({answers.model} model):"
    widths = (NAME_WIDTH, *(None,) * (len(headings) - 1))
    table = Table("", "", tuple(map(lambda name, width: Heading(name, width=width), headings, widths)), tuple(rows))
    notes = [
        *share_notes(answers),
        *dict.fromkeys(mark.note for mark in marks_of(c for r in rows for c in r) if mark.note),
    ]
    return "\n".join([paragraph(title), *lines(table), *(paragraph(note, "  ") for note in notes)])


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
