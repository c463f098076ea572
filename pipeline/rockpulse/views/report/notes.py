"""The meaning of the figures and marks of the tables."""

from __future__ import annotations

from collections.abc import Sequence

from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.views.report.answers import AnswerCells
from rockpulse.views.shared.answer_cells import AT_MOST, margin_cells, marks_of
from rockpulse.views.shared.record_marks import doubt_notes
from rockpulse.views.shared.verdict_notes import (
    BEYOND_CRITICAL,
    ESTIMATE,
    OUTSIDE,
    SO_FAR,
    UNPREDICTABLE,
    beyond_critical,
    cautions,
)
from rockpulse.views.text.capacity import factor_notes

__all__ = ["table_notes"]


def table_notes(cells: AnswerCells, found: Sequence[BodyVerdict]) -> list[str]:
    """A line for everything in the tables that does not speak for itself."""
    answers = cells.answers
    notes = [
        "Figures of a model: largest rotation over the critical angle, θ_max/α_c, under the motion as it is. C: "
        "velocity ratio of an impact. a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one "
        "that overturns the block alone.",
        *([BEYOND_CRITICAL] if beyond_critical(answers) else []),
        *factor_notes(answers),
        *doubt_notes(cells.names),
    ]
    notes += cautions(answers.models, ": its overturning says that the body may be unsafe, nothing more")
    margins = [margin for one in found for margin in (one.margin, *(demand.margin for demand in one.demands))]
    marks = cells.marks | marks_of(margin_cells(margin)[0] for margin in margins)
    told = [mark.note for mark in (OUTSIDE, UNPREDICTABLE, ESTIMATE, SO_FAR, AT_MOST) if mark in marks]
    notes += dict.fromkeys(told)
    if answers.motions.kind == "pair":
        how = "with P the mean over its directions" if answers.motions.any_azimuth else "in its worst direction"
        notes.append(f"Every direction of a sweep is a record of the tables; the verdict takes each pair once, {how}.")
    return notes
