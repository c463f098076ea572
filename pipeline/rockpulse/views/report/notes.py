"""The meaning of the figures and marks of the tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, searched_up_to
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.model_table import is_upper_bound
from rockpulse.views.report.answers import AnswerCells
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.answer_cells import AT_MOST, factor_cell, margin_cells, marks_of
from rockpulse.views.shared.record_marks import doubt_notes
from rockpulse.views.shared.verdict_notes import (
    BEYOND_CRITICAL,
    NO_ANSWER,
    NONE_UP_TO,
    OUTSIDE,
    beyond_critical,
)

__all__ = ["table_notes"]


def table_notes(cells: AnswerCells, found: Sequence[BodyVerdict], uncertainty: UncertaintySettings) -> list[str]:
    """A line for everything in the tables that does not speak for itself."""
    words, answers = cells.words, cells.answers
    notes = [words("note.figures")]
    if beyond_critical(answers):
        notes.append(words.shared(BEYOND_CRITICAL))
    notes += [*_of_factors(words, answers, uncertainty), *map(words.shared, doubt_notes(cells.names))]
    notes += [words("note.upper_bound", model=words.shared(model)) for model in answers.models if is_upper_bound(model)]
    margins = [margin for one in found for margin in (one.margin, *(demand.margin for demand in one.demands))]
    marks = cells.marks | marks_of(margin_cells(margin)[0] for margin in margins)
    told = [mark.note for mark in (OUTSIDE, AT_MOST, NO_ANSWER) if mark in marks]
    notes += dict.fromkeys(map(words.shared, told))
    if answers.motions.kind == "pair":
        notes.append(words("note.pair_mean" if answers.motions.any_azimuth else "note.pair_worst"))
    return notes


def _of_factors(words: Words, answers: Answers, uncertainty: UncertaintySettings) -> list[str]:
    """The meaning of the columns that tell how near to overturning a body is; nothing where that is not known."""
    if not answers.told:
        return []
    factor = answers[answers.factor]
    none = ""
    if np.isinf(factor).any():
        limit = searched_up_to(factor, answers.proven())
        none = f" {words.cell(factor_cell(math.inf, limit))}{words.shared(NONE_UP_TO.note)[1:]}"
    if answers.probable:
        low, high = map(words.ratio, uncertainty.restitution)
        spread, geometry = words.share(uncertainty.factor), words.share(uncertainty.geometry)
        stated = words("note.uncertainty", factor=spread, low=low, high=high, geometry=geometry)
        return [f"{words('note.factor_10')} {stated}{none}"]
    of = words("note.of_sequence" if answers.motions.kind == "sequence" else "note.of_record")
    notes = [words("note.factor", of=of, model=words.shared(answers.model)) + none]
    missed = float(np.nanmax(answers["search_step"], initial=1.0)) - 1.0
    if missed > 0.0:  # in closed form nothing is missed
        notes.append(words("note.step", step=words.number(f"{missed:.1%}")))
    rocks = (answers["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        notes.append(words("note.lucky", count=lucky))
    return notes
