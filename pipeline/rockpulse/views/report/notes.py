"""What the figures and marks of the tables mean."""

from __future__ import annotations

import math

import numpy as np

from rockpulse.ladder import UPPER_BOUND
from rockpulse.views.report.answers import Answers
from rockpulse.views.report.motions import Motions
from rockpulse.views.shared.record_marks import doubt_notes
from rockpulse.views.shared.verdict_notes import (
    BEYOND_CRITICAL,
    ESTIMATE,
    NO_ANSWER,
    OUTSIDE,
    UNPREDICTABLE,
    beyond_critical,
)
from rockpulse.views.text.capacity import BEYOND, factor_cell, passed_over, search_limit

__all__ = ["table_notes"]

_MARKS = (OUTSIDE, UNPREDICTABLE, ESTIMATE, NO_ANSWER)


def table_notes(answers: Answers, motions: Motions) -> list[str]:
    """A line for everything in the tables that does not speak for itself."""
    notes = [
        "Figures of a model: largest rotation over the critical angle, θ_max/α_c, under the motion as it is. C: "
        "velocity ratio of an impact. a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one "
        "that overturns the block alone.",
        *([BEYOND_CRITICAL] if beyond_critical(answers.summary) else []),
        *_of_factors(answers, motions),
        *doubt_notes(answers.names),
    ]
    if "resonance" in answers.models:
        notes.append(
            f"resonance: an {UPPER_BOUND} (every main impulse at the worst moment), not a prediction: its overturning "
            "says that the body may be unsafe, nothing more."
        )
    marks = answers.marked()
    notes += [mark.note for mark in _MARKS if mark.sign in marks]
    if motions.kind == "pair":
        notes.append(
            "Every direction of a sweep is a record of the tables; the verdict takes each pair of channels once, in "
            "its worst direction."
        )
    return notes


def _of_factors(answers: Answers, motions: Motions) -> list[str]:
    """What SF is, and what its search may have missed; nothing where the model was not searched."""
    summary = answers.summary.sel(model=answers.model)
    if "safety_factor" not in summary or not np.any(summary["safety_factor"].notnull()):
        return []
    of = "the main impulse (with I_s/I kept)" if motions.kind == "sequence" else "the record"
    words = f"SF: smallest factor on {of} at which the body overturns by the {answers.model} model."
    factor = summary["safety_factor"].values
    if np.isinf(factor).any():
        limit = search_limit(factor, summary["safe_up_to"].values if "safe_up_to" in summary else None)
        words += f" {factor_cell(math.inf, limit=limit)}: {BEYOND}."
    if "interval_count" in summary and int(summary["interval_count"].max()) > 1:
        words += (
            " (2): it overturns in two intervals of the factor: beyond the first the body stands again before it "
            "overturns again."
        )
    missed = float(summary["search_step"].max()) - 1.0 if "search_step" in summary else 0.0
    if missed > 0.0:
        words += f" {passed_over(missed)}."
    return [words]
