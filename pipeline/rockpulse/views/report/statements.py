"""The verdict in sentences: one for every body, what its words mean, and which motions it rests on."""

from __future__ import annotations

import math

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.demand import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, Grade
from rockpulse.earthquakes import CONFIDENCE
from rockpulse.model_table import is_upper_bound
from rockpulse.motions.events import UNKNOWN
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.answer_cells import margin_cells

__all__ = [
    "acceleration",
    "basis",
    "counted_by",
    "legend",
    "model_words",
    "motions_words",
    "of_unknown_event",
    "sentence",
]


def sentence(words: Words, answers: Answers, one: BodyVerdict) -> str:
    """The verdict on one body, named before it, in a sentence: probability, at which demand, how many earthquakes."""
    if answers.motions.kind == "sequence":
        factor = margin_cells(one.margin)[0]
        margin = words("verdict.factor", factor=words.cell(factor)) if not math.isnan(one.margin.smallest) else ""
        key = "overturns_under_sequence" if one.overall == Grade.OVERTURNS else "under_sequence"
        return words(f"verdict.{key}", margin=margin)
    if one.overall == Grade.STAYS:
        return words("verdict.not_lifted", motions=motions_words(words, answers.motions))
    what = words("probability" if answers.probable else "share_of_earthquakes")
    share, demand = one.decides, one.deciding
    if demand is None:
        under = words("verdict.as_recorded", motions=motions_words(words, answers.motions))
    else:
        lost = words("verdict.left_out", motions=words.several(demand.left_out, "motion")) if demand.left_out else ""
        events = words.several(demand.earthquakes, "earthquake")
        under = words("verdict.at_demand", name=demand.name, events=events) + lost
        under += words("verdict.few", needed=FEWEST_AT_DEMAND) if demand.few else ""
    fields = {"what": what, "value": words.ratio(share.value), "high": words.ratio(share.high)}
    return words("verdict.probability", under=under, confidence=words.share(CONFIDENCE), **fields)


def basis(words: Words, answers: Answers, unused: str) -> str:
    """The model, the motions that the verdicts rest on, the files that are not used, and how strong each demand is."""
    model, motions = model_words(words, answers.model), motions_words(words, answers.motions)
    said = [words("basis", model=model, motions=motions, files=f" ({unused})" if unused else "")]
    for name, demand in answers.demands.items():
        told = words.number(demand.words.replace("m/s2", "m/s²"))
        said.append(words("demand", name=name, strength=", ".join(filter(None, (told, demand.limit_state)))))
    return " ".join(said)


def motions_words(words: Words, motions: Motions) -> str:
    """The number of motions with that of their earthquakes."""
    if motions.kind == "sequence":
        return words("motions.sequence")
    fields = {
        "motions": words.several(len(motions.names), motions.kind),
        "events": words.several(motions.event_count, "earthquake"),
    }
    if motions.kind == "pair":
        key = "motions.pair_mean" if motions.any_azimuth else "motions.pair"
        return words(key, directions=motions.index.shape[1], **fields)
    return words("motions.record", **fields)


def legend(words: Words, answers: Answers) -> str:
    """The meaning of the figures of the table of bodies, in a line."""
    if answers.motions.kind == "sequence":
        return words("legend.sequence")
    what = words("legend.probability" if answers.probable else "legend.share")
    return words("legend.words", what=what, factor=words(f"legend.{answers.factor}"), **_levels(words))


def counted_by(words: Words, answers: Answers) -> str:
    """Sentences on what the words of the verdict mean."""
    model = model_words(words, answers.model)
    if answers.motions.kind == "sequence":
        return words("counted.sequence", model=model)
    what = words("counted.probability") if answers.probable else words("counted.share", model=model)
    told = words("counted.words", what=what, **_levels(words))
    if answers.demands:
        low, high = (words.number(f"{end:g}") for end in FARTHEST)
        told += " " + words("counted.demand", low=low, high=high)
    return told


def _levels(words: Words) -> dict[str, str]:
    """The probabilities from which on the verdict is another one."""
    return {"overturns": words.number(f"{OVERTURNS:g}"), "may": words.number(f"{MAY_OVERTURN:g}")}


def of_unknown_event(words: Words, motions: Motions) -> str:
    """A sentence on the motions whose earthquake is unknown; empty where all are known."""
    count = motions.events.count(UNKNOWN)
    if not count:
        return ""
    key = "unknown_event.as_one" if count == len(motions.events) else "unknown_event.not_counted"
    return words(key, motions=words.several(count, "motion"))


def model_words(words: Words, model: str) -> str:
    """A model by its name, an upper bound with what it is."""
    return words("model.upper_bound" if is_upper_bound(model) else "model.name", name=words.shared(model))


def acceleration(words: Words, value: float) -> str:
    """An acceleration [m/s2] in m/s² and g."""
    return f"{words.figure(value, 'm/s²')} ({words.figure(value / STANDARD_GRAVITY, 'g')})"
