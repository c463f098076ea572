"""The meaning of the figures and marks of the tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rockpulse.assessment.answers import Answers, searched_up_to
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.ladder import cautions
from rockpulse.views.report.answers import AnswerCells
from rockpulse.views.shared.answer_cells import AT_MOST, factor_cell, margin_cells, marks_of
from rockpulse.views.shared.record_marks import doubt_notes
from rockpulse.views.shared.verdict_notes import (
    BEYOND_CRITICAL,
    ESTIMATE,
    NO_ANSWER,
    NONE_UP_TO,
    OUTSIDE,
    SO_FAR,
    UNPREDICTABLE,
    beyond_critical,
)
from rockpulse.views.text.capacity import passed_over

__all__ = ["table_notes"]


def table_notes(cells: AnswerCells, found: Sequence[BodyVerdict]) -> list[str]:
    """A line for everything in the tables that does not speak for itself."""
    answers = cells.answers
    notes = [
        "Figures of a model: largest rotation over the critical angle, θ_max/α_c, under the motion as it is. C: "
        "velocity ratio of an impact. a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one "
        "that overturns the block alone.",
        *([BEYOND_CRITICAL] if beyond_critical(answers) else []),
        *_of_factors(answers),
        *doubt_notes(cells.names),
    ]
    notes += cautions(answers.models, ": its overturning says that the body may be unsafe, nothing more")
    margins = [margin for one in found for margin in (one.margin, *(demand.margin for demand in one.demands))]
    marks = cells.marks | marks_of(margin_cells(margin)[0] for margin in margins)
    told = [mark.note for mark in (OUTSIDE, UNPREDICTABLE, ESTIMATE, SO_FAR, NO_ANSWER, AT_MOST) if mark in marks]
    notes += dict.fromkeys(told)
    if answers.motions.kind == "pair":
        notes.append(
            "Every direction of a sweep is a record of the tables; the verdict takes each pair of channels once, in "
            "its worst direction."
        )
    return notes


def _of_factors(answers: Answers) -> list[str]:
    """The meaning of SF, and the gaps that its search may have left; nothing where the model was not searched."""
    if not answers.searched:
        return []
    of = "the main impulse (with I_s/I kept)" if answers.motions.kind == "sequence" else "the record"
    words = f"SF: smallest factor on {of} at which the body overturns by the {answers.model} model."
    factor, step = answers["safety_factor"], answers["search_step"]
    if np.isinf(factor).any():
        words += f" {factor_cell(math.inf, searched_up_to(factor, answers.proven())).marked}{NONE_UP_TO.note[1:]}"
    if (answers["interval_count"] > 1).any():
        words += (
            " (2): it overturns in two intervals of the factor: beyond the first the body stands again before it "
            "overturns again."
        )
    missed = float(np.max(step, initial=1.0, where=~np.isnan(step))) - 1.0
    if missed > 0.0:
        words += f" {passed_over(missed)}."
    return [words]
