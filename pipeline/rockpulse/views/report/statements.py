"""The verdict in sentences: which bodies overturn, by which model, under which motions, and what the words mean."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import MAY_OVERTURN, OVERTURNS, BodyVerdict, DemandVerdict, Grade
from rockpulse.ladder import UPPER_BOUND, is_upper_bound
from rockpulse.motions.events import UNKNOWN
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.pairing import listed
from rockpulse.views.shared.answer_cells import TITLES, margin_cells
from rockpulse.views.shared.terminal import figure, ratio, several
from rockpulse.views.shared.verdict_notes import counted, noun

__all__ = ["acceleration", "counted_by", "headline", "of_bodies", "of_unknown_event"]

#: Bodies that are named one by one in a sentence.
NAMED = 6

#: Sentences on bodies of one grade, by whether they are one or several, from worst to best.
_HEADS = {
    Grade.OVERTURNS: ("overturns", "overturn"),
    Grade.NOT_KNOWN: ("cannot be judged, for an answer is missing", "cannot be judged, for answers are missing"),
    Grade.MAY_OVERTURN: ("may overturn", "may overturn"),
    Grade.ROCKS: ("rocks", "rock"),
    Grade.STAYS: (
        "stays at rest: none of these lifts it, so that they say nothing of stronger ones",
        "stay at rest: none of these lifts them, so that they say nothing of stronger ones",
    ),
}

_UNKNOWN_DEMAND = (
    "a record has no answer, or is so weak that the search for its factor ended below the demand ([search] factor_max)"
)


def headline(answers: Answers, found: Sequence[BodyVerdict], files: str = "") -> list[str]:
    """One sentence for every grade that occurs, from worst to best; then one for every demand.

    The first says how many of the `files` were used, where not all were.
    """
    motions = answers.motions
    under = f"under {counted(motions)}{f' ({files})' if files else ''}"
    sentences = []
    for grade, heads in _HEADS.items():
        own = [one for one in found if one.overall == grade]
        if own:
            sentences.append(f"{of_bodies(len(own), len(found))} {heads[len(own) != 1]}: {_named(answers, own)}.")
    if not sentences:
        return [f"There is no body to judge{f' ({files})' if files else ''}."]
    sentences[0] = f"By the {_model(answers.model)}, {under}: {sentences[0]}"
    of_demands = zip(*(one.demands for one in found), strict=True)
    return [*sentences, *(_demand(answers, found, every) for every in of_demands)]


def _demand(answers: Answers, found: Sequence[BodyVerdict], every: tuple[DemandVerdict, ...]) -> str:
    """A sentence on the bodies under motions as strong as one demand."""
    name, state = every[0].name, answers.limit_state(every[0].name)
    failing = [
        f"{one.body.name} ({ratio(against.margin.smallest)})"
        for one, against in zip(found, every, strict=True)
        if against.below
    ]
    unknown = sum(one.grade == Grade.NOT_KNOWN for one in every)
    met = len(every) - len(failing) - unknown
    named = f": {listed(failing)}" if failing else ""
    why = _UNKNOWN_DEMAND if answers.told else "no factor of this model is known ([search] models, intervals)"
    least = "with at most 10 % probability of overturning " if answers.probable else ""
    return (
        f"Demand “{name}”, {acceleration(answers.demands[name])}{f', {state}' if state else ''}: {met} of "
        f"{several(len(every), 'body')} {'stands' if met == 1 else 'stand'} {least}under every {noun(answers.motions)} "
        f"scaled to this PGA, {len(failing)} {'does' if len(failing) == 1 else 'do'} "
        f"not{' for certain' if is_upper_bound(answers.model) else ''}{named}"
        + (f"; of {unknown} it is not known: {why}." if unknown else ".")
    )


def counted_by(answers: Answers) -> str:
    """Sentences on what the words of the verdict mean."""
    motions, model = answers.motions, answers.model
    if motions.kind == "sequence":
        return (
            f"Rocks: by the {_model(model)} neither the design sequence nor a weaker one (main impulse smaller, I_s/I "
            "kept) overturns the body. That is not called safe: a design sequence stands for the records of its site "
            "and leaves some of their rotations uncovered. The safety factor is the smallest factor on the main "
            "impulse at which the body overturns."
        )
    if answers.probable:
        what = (
            "P is the probability that a motion overturns the body, as recorded, by the nonlinear model under the "
            "uncertainty that is stated below"
        )
    else:
        what = (
            f"The share of earthquakes with a motion that by the {_model(model)} overturns the body, as recorded or "
            "weaker, stands in for a probability of overturning, which is known of the nonlinear model alone"
        )
    words = (
        f"{what}: the mean over the motions of an earthquake, then over the earthquakes, alike. Overturns: "
        f"{OVERTURNS:g} or more. May overturn: {MAY_OVERTURN:g} or more. Rocks: below; "
        "that is as sure as the upper end of the interval is low, and no proof of safety. Stays: no motion lifts it."
    )
    if answers.demands:
        words += (
            " Capacity over demand asks whether each record brought to the PGA of the demand overturns the body"
            f"{' with more than 10 % probability' if answers.probable else ''}; below 1 the body may overturn at the "
            "demand."
        )
    return words


def of_unknown_event(motions: Motions) -> str:
    """A sentence on the motions whose earthquake is unknown, after a blank; empty where all are known."""
    count = motions.events.count(UNKNOWN)
    which = f"{several(count, 'motion')} whose earthquake neither the files nor a table ([records] events) tell"
    if not count:
        return ""
    return f" As one earthquake counts: {which}." if count == len(motions.events) else f" Not counted is: {which}."


def _named(answers: Answers, own: Sequence[BodyVerdict]) -> str:
    words = [f"{one.body.name} ({_why(answers, one)})" for one in sorted(own, key=_likely)[:NAMED]]
    more = [f"{len(own) - NAMED} more"] if len(own) > NAMED else []
    return ", ".join(words) + "".join(f" and {rest}" for rest in more)


def _likely(one: BodyVerdict) -> tuple[float, float]:
    """The most likely to overturn first, then that of the smallest factor."""
    return -one.share.value, math.inf if math.isnan(one.margin.smallest) else one.margin.smallest


def _why(answers: Answers, one: BodyVerdict) -> str:
    """The probability of a body with its upper bound, its smallest factor, and the demand that decides."""
    told = []
    if answers.motions.kind != "sequence":
        what = "P" if answers.probable else "share"
        told.append(f"{what} {ratio(one.share.value)}, at most {ratio(one.share.high)}")
    if not math.isnan(one.margin.smallest):
        smallest = margin_cells(one.margin)[0].marked
        told.append(f"smallest {TITLES[answers.factor]} {smallest}")
    if one.overall > one.grade:
        worst = min(demand.margin.smallest for demand in one.demands if demand.grade == one.overall)
        told.append(f"capacity over demand {ratio(worst)}")
    return ", ".join(told) or "no factor is known"


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
