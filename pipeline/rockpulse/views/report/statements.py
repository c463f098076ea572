"""The verdict in sentences: which bodies overturn, by which model, under which motions, and what the words mean."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.demand import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, DemandVerdict, Grade
from rockpulse.ladder import UPPER_BOUND, is_upper_bound
from rockpulse.motions.events import UNKNOWN
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared.answer_cells import TITLES, margin_cells
from rockpulse.views.shared.terminal import figure, ratio, several
from rockpulse.views.shared.verdict_notes import counted, noun

__all__ = ["acceleration", "counted_by", "headline", "of_bodies", "of_unknown_event", "typeset"]

#: Bodies that are named one by one in a sentence.
NAMED = 6

#: Sentences on bodies of one grade, by whether they are one or several, from worst to best.
_HEADS = {
    Grade.OVERTURNS: ("overturns", "overturn"),
    Grade.NOT_KNOWN: ("cannot be judged", "cannot be judged"),
    Grade.MAY_OVERTURN: ("may overturn", "may overturn"),
    Grade.ROCKS: ("rocks", "rock"),
    Grade.STAYS: (
        "stays at rest: none of these lifts it, so that they say nothing of stronger ones",
        "stay at rest: none of these lifts them, so that they say nothing of stronger ones",
    ),
}


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
    return [*sentences, *(_demand(answers, every) for every in of_demands)]


def _demand(answers: Answers, every: tuple[DemandVerdict, ...]) -> str:
    """A sentence on the motions that are brought to one demand."""
    demand, motions = answers.demands[every[0].name], answers.motions
    state = f", {demand.limit_state}" if demand.limit_state else ""
    lost, left = max(one.left_out for one in every), min(one.earthquakes for one in every)
    what = f"{several(len(motions.names) - lost, noun(motions))} of {several(left, 'earthquake')}"
    told = f"At the demand “{every[0].name}”, {typeset(demand.words)}{state}, stand {what} that are brought to it"
    if lost:
        told += f"; left out are {lost}, which lie farther from it than a factor of {FARTHEST[1]:g}"
    if any(one.few for one in every):
        told += f". That is no verdict: {FEWEST_AT_DEMAND} earthquakes are needed"
    return f"{told}."


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
            " The verdict is that under the motions brought to the demand of the site, each by one factor, a pair by "
            f"the geometric mean of both; factors outside {FARTHEST[0]:g} to {FARTHEST[1]:g} are left out. The "
            "motions as they are recorded decide nothing then."
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
    return -one.decides.value, math.inf if math.isnan(one.margin.smallest) else one.margin.smallest


def _why(answers: Answers, one: BodyVerdict) -> str:
    """The probability of a body with its upper bound, at the demand that decides, and its smallest factor."""
    told = []
    if answers.motions.kind != "sequence":
        what = "P" if answers.probable else "share"
        where = "" if one.deciding is None else f" at {one.deciding.name}"
        told.append(f"{what}{where} {ratio(one.decides.value)}, at most {ratio(one.decides.high)}")
    if not math.isnan(one.margin.smallest):
        smallest = margin_cells(one.margin)[0].marked
        told.append(f"smallest {TITLES[answers.factor]} {smallest}")
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


def typeset(words: str) -> str:
    """Words with a unit as they are shown in running text.

    Examples
    --------
    >>> typeset("PGA 2.94 m/s2")
    'PGA 2.94 m/s²'
    """
    return words.replace("m/s2", "m/s²")
