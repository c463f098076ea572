"""The verdict in sentences: the bodies that are safe, by which model, under which motions, and what safe means."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import BodyVerdict, DemandVerdict, Grade
from rockpulse.ladder import UPPER_BOUND, is_upper_bound
from rockpulse.motions.events import UNKNOWN
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.pairing import listed
from rockpulse.views.shared.terminal import figure, ratio, several

__all__ = ["acceleration", "counted", "counted_by", "headline", "noun", "of_bodies", "of_unknown_event"]

#: Bodies that are named one by one in a sentence.
NAMED = 6

_HEADS = {
    Grade.SAFE: ("is safe under {these}", "are safe under {these}"),
    Grade.UNTESTED: (
        "is lifted by none of these, so that they say nothing of it",
        "are lifted by none of these, so that they say nothing of them",
    ),
    Grade.STANDS: ("stands under {these}", "stand under {these}"),
    Grade.THIN: ("stands under {these}, but with hardly a margin", "stand under {these}, but with hardly a margin"),
    Grade.NO_MARGIN: ("stands, by an unknown margin", "stand, by an unknown margin"),
    Grade.NOT_KNOWN: (
        "cannot be called safe, for an answer is missing",
        "cannot be called safe, for answers are missing",
    ),
    Grade.NOT_SAFE: ("is not safe", "are not safe"),
}

_UNKNOWN_DEMAND = (
    "a record has no answer, or is so weak that the search for the safety factor ended below the demand ([search] "
    "factor_max)"
)

#: What is said in place of NOT_SAFE where an upper-bound type input overturns a body.
_NOT_SHOWN = ("is not shown to be safe", "are not shown to be safe")


def headline(answers: Answers, found: Sequence[BodyVerdict], files: str = "") -> list[str]:
    """One sentence for every grade that occurs, from worst to best; then one for every demand.

    The first says how many of the `files` were used, where not all were.
    """
    motions, model = answers.motions, answers.model
    searched = any(not math.isnan(one.margin.smallest) for one in found)
    how = "" if motions.kind == "sequence" else ", as recorded and weaker" if searched else ", as recorded"
    under = f"under {counted(motions)}{f' ({files})' if files else ''}{how}"
    sentences = []
    for grade in sorted(_HEADS, reverse=True):
        own = [one for one in found if one.overall == grade]
        if own:
            heads = _NOT_SHOWN if is_upper_bound(model) and grade == Grade.NOT_SAFE else _HEADS[grade]
            head = heads[len(own) != 1].format(these="it" if motions.kind == "sequence" else "these")
            sentences.append(f"{of_bodies(len(own), len(found))} {head}: {_named(own)}.")
    if not sentences:
        return [f"There is no body to judge{f' ({files})' if files else ''}."]
    sentences[0] = f"By the {_model(model)}, {under}: {sentences[0][0].lower()}{sentences[0][1:]}"
    of_demands = zip(*(one.demands for one in found), strict=True)
    return [*sentences, *(_demand(answers, found, every) for every in of_demands)]


def _demand(answers: Answers, found: Sequence[BodyVerdict], every: tuple[DemandVerdict, ...]) -> str:
    """A sentence on the bodies under motions as strong as one demand."""
    name, total, model = every[0].name, len(every), answers.model
    strength = acceleration(answers.demands[name])
    state = answers.limit_state(name)
    met = sum(one.grade in (Grade.SAFE, Grade.THIN) for one in every)
    failing = [
        f"{one.body.name} ({ratio(against.margin.smallest)})"
        for one, against in zip(found, every, strict=True)
        if against.grade == Grade.NOT_SAFE
    ]
    below = len(failing)
    unknown = total - met - below
    named = f": {listed(failing)}" if failing else ""
    searched = any(not math.isnan(one.margin.smallest) for one in found)
    why = _UNKNOWN_DEMAND if searched else "no safety factor of this model was searched ([search] models)"
    return (
        f"Demand “{name}”, {strength}{f', {state}' if state else ''}: {met} of {several(total, 'body')} "
        f"{'stands' if met == 1 else 'stand'} under every {noun(answers.motions)} scaled to this PGA or below, "
        f"{below} {'does' if below == 1 else 'do'} not{' for certain' if is_upper_bound(model) else ''}{named}"
        + (f"; of {unknown} it is not known: {why}." if unknown else ".")
    )


def counted_by(answers: Answers) -> str:
    """A sentence on the bodies that are counted as safe."""
    motions, model = answers.motions, answers.model
    if motions.kind == "sequence":
        return (
            f"Stands: by the {_model(model)} neither the design sequence nor a weaker one (main impulse smaller, I_s/I "
            "kept) overturns the body. That is not called safe: a design sequence stands for the records of its site "
            "and leaves some of their rotations uncovered. The safety factor is the smallest factor on the main "
            "impulse at which the body overturns."
        )
    each = "record" if motions.kind == "record" else "pair of channels, in any of its directions,"
    words = (
        f"Counted as safe: a body that by the {_model(model)} is overturned neither by any {each} as it is nor by a "
        "weaker copy of it: the safety factor (SF) is the smallest factor on the record at which the body overturns, "
        "and 1 or more is asked for. A body that rocks under a record but has SF below 1 is not counted as safe: "
        "rocking is not monotonic, a weaker record overturns it. Unresolved and unpredictable answers, and those "
        "outside the range of the model, are not counted as safe either. A factor above 1 by less than a tenth, or "
        "than seven steps of the search, is hardly a margin: a finer search may find a smaller one."
    )
    if answers.demands:
        words += (
            " Capacity over demand asks whether the body stands under each record brought to the PGA of the demand, "
            "or below; a body that does not is not counted as safe either. It may meet a demand that is weaker than "
            "the records, and not be safe under them."
        )
    return words


def of_unknown_event(motions: Motions) -> str:
    """A sentence on the motions whose earthquake is unknown, after a blank; empty where all are known."""
    count = motions.events.count(UNKNOWN)
    which = f"{several(count, 'motion')} whose earthquake neither the files nor a table ([records] events) tell"
    if not count:
        return ""
    return f" As one earthquake counts: {which}." if count == len(motions.events) else f" Not counted is: {which}."


def _named(own: Sequence[BodyVerdict]) -> str:
    ordered = sorted(own, key=lambda one: math.inf if math.isnan(one.margin.smallest) else one.margin.smallest)
    words = [f"{one.body.name} ({_margin(one)})" for one in ordered[:NAMED]]
    more = [f"{len(own) - NAMED} more"] if len(own) > NAMED else []
    return ", ".join(words) + "".join(f" and {rest}" for rest in more)


def _margin(one: BodyVerdict) -> str:
    if math.isnan(one.margin.smallest):
        return "no safety factor"
    decisive = [demand for demand in one.demands if demand.grade == one.overall > one.grade]
    if not decisive:
        return _own_margin(one)
    if one.overall == Grade.NOT_KNOWN:
        return f"{_own_margin(one)}, but it is not known at the demand “{decisive[0].name}”"
    worst = min(demand.margin.smallest for demand in decisive)
    return f"{_own_margin(one)}, but capacity over demand {ratio(worst)}"


def _own_margin(one: BodyVerdict) -> str:
    margin, never = one.margin, "never lifted, " if one.never_lifted else ""
    if math.isinf(margin.smallest):
        return f"{never}no overturning found" + (
            "" if math.isnan(margin.limit) else f" up to a factor of {figure(margin.limit)}"
        )
    least = "at least " if margin.bounds[0] else "at most " if margin.open else ""
    return f"{never}smallest SF {least}{ratio(margin.smallest)}"


def _model(model: str) -> str:
    return f"{model} model ({UPPER_BOUND}, no prediction)" if is_upper_bound(model) else f"{model} model"


def of_bodies(count: int, total: int) -> str:
    """So many of so many bodies.

    Examples
    --------
    >>> of_bodies(1, 4)
    '1 of 4 bodies'
    """
    return f"{count} of {several(total, 'body')}"


def acceleration(value: float) -> str:
    """An acceleration [m/s2] in m/s² and g."""
    return f"{figure(value, 'm/s²')} ({figure(value / STANDARD_GRAVITY, 'g')})"
