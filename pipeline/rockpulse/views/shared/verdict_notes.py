"""The meaning of the figures and marks in a table of verdicts; only of those that are shown."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.screens import sliding, worse_screens
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.model_table import MODELS, UPPER_BOUND, is_upper_bound
from rockpulse.views.shared.record_marks import doubt_notes, record_cells
from rockpulse.views.shared.table import Mark
from rockpulse.views.shared.terminal import ratio, several

__all__ = [
    "BEYOND_CRITICAL",
    "NONE_UP_TO",
    "NO_ANSWER",
    "OUTSIDE",
    "beyond_critical",
    "body_notes",
    "cautions",
    "counted",
    "noun",
    "verdict_notes",
]

#: Marks at a peak, at a safety factor, or at a capacity.
OUTSIDE = Mark(
    "*",
    "*: outside the range of this model (slenderness below 3, or a body unlike those of the rule's fit); read with "
    "caution.",
)
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


def verdict_notes(answers: Answers, of_factors: list[str], marks: Collection[Mark]) -> list[str]:
    """Notes to a table of the verdicts of all models, whose figures bear some marks.

    Those on the column SF stand behind those on the figures.
    """
    notes = [
        "Figures: largest rotation over the critical angle (theta_max/alpha_c). C: velocity ratio of an impact. "
        "a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one that overturns the block "
        "alone.",
        *([BEYOND_CRITICAL] if beyond_critical(answers) else []),
        *of_factors,
    ]
    if answers["pgv_drift"].any():
        notes.append(
            "~ (drift): the record's baseline drifts: its velocity does not end at zero, and PGV may be off by as much."
        )
    notes += doubt_notes(record_cells(answers.summary))
    notes += cautions(answers.models)
    notes += [OUTSIDE.note] if OUTSIDE in marks else []
    models = answers.of_models.values()
    reasons = {int(code) for one in models for code in one["reason"][one["outcome"] == Outcome.UNRESOLVED]}
    if reasons:
        words = ", ".join(Reason(code).name.lower().replace("_", " ") for code in sorted(reasons))
        notes.append(f"unresolved: the model cannot say ({words}).")
    return notes


def beyond_critical(answers: Answers) -> bool:
    """Whether a rotation beyond the critical angle did not end in overturning."""
    return any(
        bool(((one["outcome"] == Outcome.ROCKS) & (one["peak_rotation_ratio"] > 1.0)).any())
        for one in answers.of_models.values()
    )


def counted(motions: Motions) -> str:
    """The number of motions in words: "7 records of 2 earthquakes"."""
    if motions.kind == "sequence":
        return "one design sequence, which stands for the records of its site calibration"
    each = f", each in {motions.index.shape[1]} directions" if motions.kind == "pair" else ""
    return f"{several(len(motions.names), noun(motions))} of {several(motions.event_count, 'earthquake')}{each}"


def noun(motions: Motions) -> str:
    """The word for a motion."""
    return {"record": "record", "pair": "pair of channels", "sequence": "sequence"}[motions.kind]


def body_notes(answers: Answers, found: Sequence[BodyVerdict]) -> list[str]:
    """A sentence on every body that stands on a pedestal, and on every one whose friction does not hold it."""
    notes = [
        f"{alone}: of its screens, alone and with its pedestal as one body, that of {worst.body.name} is the worse "
        f"({worst.word}, {ratio(worst.decides.value)}) and counts; motions of both parts at once are not modelled."
        for alone, worst in worse_screens(answers, found)
    ]
    notes += [
        f"{one.body.name}: {one.above} of {several(one.total, 'record')} ask for more friction than {one.friction:g} "
        f"(up to {ratio(one.most)}): it would slide, which the rocking here leaves out."
        for one in sliding(answers)
    ]
    return notes


def cautions(names: Iterable[str], more: str = "") -> list[str]:
    """A sentence, with `more` at its end, on each of the models whose input is an upper bound."""
    return [
        f"{name}: an {UPPER_BOUND} ({MODELS[name].upper_bound}), not a prediction{more}."
        for name in names
        if is_upper_bound(name)
    ]
