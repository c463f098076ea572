"""What the figures and marks in a table of verdicts mean; only of those that are shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.ladder import cautions
from rockpulse.storage.hdf5_reader import flag_words
from rockpulse.views.shared.record_marks import doubt_notes, doubts
from rockpulse.views.shared.table import Mark
from rockpulse.views.shared.terminal import lower_bound, rough

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "BEYOND_CRITICAL",
    "ESTIMATE",
    "MARKED",
    "NONE_UP_TO",
    "NO_ANSWER",
    "OUTSIDE",
    "SO_FAR",
    "UNPREDICTABLE",
    "beyond_critical",
    "verdict_notes",
]

#: How a peak is shown that `auto` took from one of these.
MARKED = {"impulsive": rough, "settled": lower_bound}

#: Marks at a peak, at a safety factor, or at a capacity.
OUTSIDE = Mark(
    "*",
    "*: outside the range of this model (slenderness below 3, or a body unlike those of the rule's fit); read with "
    "caution.",
)
UNPREDICTABLE = Mark("?", "?: not predictable: another answer when C or the record changes in the ninth digit.")
_OF_AUTO = "Peaks of auto: ~0.06 an estimate from impulses; >0.12 the peak so far, when the verdict was sure."
ESTIMATE = Mark("~", _OF_AUTO, before=True)
SO_FAR = Mark(">", _OF_AUTO, before=True)
NO_ANSWER = Mark(
    "!",
    "!: from this factor on the model cannot answer, as in free flight: a lower bound; below it no overturning was "
    "found.",
)
NONE_UP_TO = Mark(
    ">",
    ">: none found up to there, where the search ends ([search] factor_max): on a weak record that says little.",
    before=True,
)

#: What a rotation beyond the critical angle is, where it did not end in overturning.
BEYOND_CRITICAL = (
    "Above 1: rocked beyond the critical angle and back, carried by the motion: it did not overturn, but came near."
)


def verdict_notes(summary: xr.Dataset, of_factors: list[str]) -> list[str]:
    """Notes to a table of verdicts."""
    notes = [
        "Figures: largest rotation over the critical angle (theta_max/alpha_c). C: velocity ratio of an impact. "
        "a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one that overturns the block "
        "alone.",
        *([BEYOND_CRITICAL] if beyond_critical(summary) else []),
        *of_factors,
    ]
    if "pgv_drift" in summary and summary["pgv_drift"].any():
        notes.append(
            "~ (drift): the record's baseline drifts: its velocity does not end at zero, and PGV may be off by as much."
        )
    notes += doubt_notes(doubts(summary).values())
    notes += cautions(summary["model"].values)
    if "applicable" in summary and (summary["applicable"] == 0).any():
        notes.append(OUTSIDE.note)
    if "predictable" in summary and (summary["predictable"] == 0).any():
        notes.append(UNPREDICTABLE.note)
    if "auto" in summary["model"].values:
        used = _models_used(summary)
        notes.append(f"auto: the cheapest model that answers, here {used}; the figures are those of that model.")
        if _any_marked(summary):
            notes.append(ESTIMATE.note)
    reasons = {int(code) for code in summary["reason"].values[summary["outcome"].values == Outcome.UNRESOLVED]}
    if reasons:
        words = ", ".join(Reason(code).name.lower().replace("_", " ") for code in sorted(reasons))
        notes.append(f"unresolved: the model cannot say ({words}).")
    return notes


def beyond_critical(summary: xr.Dataset) -> bool:
    """Whether a rotation beyond the critical angle did not end in overturning."""
    return bool(((summary["outcome"] == Outcome.ROCKS) & (summary["peak_rotation_ratio"] > 1.0)).any())


def _models_used(summary: xr.Dataset) -> str:
    """How many answers of `auto` are whose: "static 12, nonlinear 4"."""
    used = summary["model_used"].sel(model="auto")
    codes, counts = np.unique(used.values, return_counts=True)
    names = flag_words(used)
    return ", ".join(f"{names[code].replace('_', ' ')} {count}" for code, count in zip(codes, counts, strict=True))


def _any_marked(summary: xr.Dataset) -> bool:
    """Whether a peak of `auto` is shown with a mark."""
    used = summary["model_used"].sel(model="auto")
    rocks = summary["outcome"].sel(model="auto") == Outcome.ROCKS
    marked = [code for code, name in flag_words(used).items() if name in MARKED]
    return bool((rocks & used.isin(marked)).any())
