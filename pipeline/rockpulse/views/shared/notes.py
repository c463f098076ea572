"""Notes that explain the numbers and marks in tables of verdicts."""

import math
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Motions, searched_up_to
from rockpulse.assessment.verdict import BodyVerdict, worse_with_pedestal
from rockpulse.model_table import MODELS, UPPER_BOUND, is_upper_bound
from rockpulse.views.shared.formatting import ratio, several
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import CellMark
from rockpulse.views.shared.table_columns import NONE_UP_TO, OUTSIDE, doubt_notes, factor_cell, record_cells
from rockpulse.views.shared.words import say


def factor_heading(factor: str) -> str:
    """Return the column heading of a scale factor; `factor` is the name of its variable, such as "factor_10"."""
    return say(f"column.{factor}.head")


def factor_name(factor: str) -> str:
    """Return the words for a scale factor in a sentence; `factor` is the name of its variable, such as "factor_10"."""
    return say(f"factor.{factor}")


def stored_uncertainty(answers: Answers) -> str:
    """Return the stored description of the uncertainty that the probability of overturning includes."""
    return str(answers.summary["overturning_probability"].attrs.get("comment", "nonlinear model"))


def factor_notes(answers: Answers, swept: bool = False) -> list[str]:
    """Explain the columns of scale factors; with `swept`, each value is the smallest over all directions of a pair."""
    if not answers.has_factor:
        return []
    factor = answers[answers.factor]
    of = "the main impulse (I_s/I kept)" if answers.motions.kind == "sequence" else "the record"
    of += ", over direction," if swept else ""
    none = none_found(answers)
    if answers.probable:
        least = f" Scale factor at P = 10 %: smallest multiplier on {of}." if swept else ""
        known = stored_uncertainty(answers)
        known = known[:1].upper() + known[1:]
        return [f"P: probability of overturning under the record as recorded.{least} {known}.{none}"]
    notes = [f"SF: smallest scale factor on {of} at which the body overturns by the {answers.model} model.{none}"]
    if missed := missed_step(answers):
        notes[0] += (
            f" Ranges of overturning scale factors narrower than the step of the search (up to {missed:.1%}) may lie "
            f"below SF, undetected: the second digit of SF is not reliable ([search] {MODELS[answers.model].grid})."
        )
    if bounds := np.count_nonzero(answers.bound):
        notes.append(
            "!: a lower bound: from this scale factor on the model gives no result (free flight, for example; "
            f"{bounds} of {answers.bound.size}); below it no overturning was found."
        )
    rocks = (answers["outcome"] == Outcome.ROCKS) & (factor < 1.0)
    if lucky := np.count_nonzero(rocks):
        may = ", or may (!)" if np.any(rocks & answers.bound) else ""
        rock = "rocks" if lucky == 1 else "rock"
        notes.append(f"{lucky} with SF below 1 {rock} only: a smaller scale factor overturns the body{may}.")
    return notes


def none_found(answers: Answers) -> str:
    """Explain the entry for bodies that do not overturn at any scale factor; empty if there are no such bodies."""
    factor = answers[answers.factor]
    if not np.isinf(factor).any():
        return ""
    return f" {factor_cell(math.inf, searched_up_to(factor, answers.proven())).marked}{NONE_UP_TO.note[1:]}"


def missed_step(answers: Answers) -> float:
    """Return the relative width of an interval of scale factors that the search can miss; 0 for exact solutions."""
    return max(float(np.nanmax(answers["search_step"], initial=1.0)) - 1.0, 0.0)


def verdict_notes(answers: Answers, of_factors: list[str], marks: Collection[CellMark]) -> list[str]:
    """Return all notes below a table with the results of every model; `marks` are the marks that the table contains."""
    notes = [
        "Model columns: largest rotation over the critical angle (theta_max/alpha_c). C: velocity ratio of "
        "an impact. Uplift ratio: PGA over the PGA that lifts the body. I/I_1c: main impulse over the single impulse "
        "that overturns the body.",
        *([say("note.beyond_critical")] if beyond_critical(answers) else []),
        *of_factors,
    ]
    if answers["pgv_drift"].any():
        notes.append(
            "~ (drift): the baseline of the record drifts: its velocity does not end at zero, and PGV may be wrong by "
            "as much."
        )
    notes += [*doubt_notes(record_cells(answers.summary)), *cautions(answers.models)]
    notes += [OUTSIDE.note] if OUTSIDE in marks else []
    models = answers.of_models.values()
    reasons = {int(code) for one in models for code in one["reason"][one["outcome"] == Outcome.UNRESOLVED]}
    if reasons:
        words = ", ".join(Reason(code).name.lower().replace("_", " ") for code in sorted(reasons))
        notes.append(f"unresolved: the model gives no result ({words}).")
    return notes


def beyond_critical(answers: Answers) -> bool:
    """Return whether a body rotated beyond its critical angle without overturning."""
    return any(
        bool(((one["outcome"] == Outcome.ROCKS) & (one["peak_rotation_ratio"] > 1.0)).any())
        for one in answers.of_models.values()
    )


def counted_motions(motions: Motions) -> str:
    """Return the number of records and earthquakes as text, such as "7 records of 2 earthquakes"."""
    if motions.kind == "sequence":
        return say("motions.sequence")
    each = f", each in {motions.index.shape[1]} directions" if motions.kind == "pair" else ""
    noun = "pair of channels" if motions.kind == "pair" else motions.kind
    return f"{several(len(motions.names), noun)} of {several(motions.event_count, 'earthquake')}{each}"


def body_notes(answers: Answers, found: Sequence[BodyVerdict]) -> list[str]:
    """Return a sentence for every body with crushing at its edge, and for every body on a pedestal."""
    notes, crushed = [], answers.summary["hinge_depth"].values > 0.0
    for name in np.array(answers.blocks)[crushed].tolist():
        notes.append(say("crushed.note", name=name, **Known(answers.summary, block=name).crushing))
    for alone, worst in worse_with_pedestal(answers, found):
        value = f"{'P' if answers.probable else 'share'} {ratio(worst.share.value)}"
        outcome = ", ".join(filter(None, (worst.deciding.word, value)))
        notes.append(
            f"{alone}: assessed alone and as one body with its pedestal; the worse result governs: {worst.body.name} "
            f"({outcome}); simultaneous motions of both parts are not modelled."
        )
    return notes


def cautions(names: Iterable[str]) -> list[str]:
    """Return a sentence for each model whose input sequence is an upper bound."""
    bounds = [MODELS[name] for name in names if is_upper_bound(name)]
    return [f"{model.name}: an {UPPER_BOUND} ({model.upper_bound}), not a prediction." for model in bounds]
