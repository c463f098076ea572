"""The verdict on every body over all motions: whether it may be counted as safe, by how much, and what it rests on.

.. note:: A model's outcome alone is no proof of safety. Rocking is not monotonic in the strength of the motion: a body
   may rock under a record and be overturned by a weaker copy of it. Such a body is not counted as safe.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Body, Margin
from rockpulse.motions.events import largest_share

__all__ = ["BodyVerdict", "DemandVerdict", "Grade", "Standing", "standings", "thin_margin", "verdicts", "why_unknown"]

#: A smallest factor below this is hardly a margin: on strong long records a search of the default fineness finds 6 % of
#: the factors more than a tenth too high (docs/decisions/011).
THIN_MARGIN = 1.1

#: So many steps of the search make the same margin where it is coarser: at the default fineness seven are a tenth.
THIN_STEPS = 7.0


class Standing(IntEnum):
    """The verdict on a body under one record, from best to worst."""

    STANDS = 0  #: neither the record nor a weaker copy overturns it
    THIN = 1  #: the same, but a copy hardly stronger does: the search is not that fine
    NO_MARGIN = 2  #: the record does not overturn it; weaker and stronger ones were not searched
    UNKNOWN = 3  #: the model cannot say, or not reliably
    WEAKER_OVERTURNS = 4  #: it survives the record as it is, a weaker copy overturns it
    OVERTURNS = 5  #: the record overturns it


class Grade(IntEnum):
    """The verdict on a body under all motions, from best to worst."""

    SAFE = 0
    UNTESTED = 1  #: no motion lifts it
    STANDS = 2  #: under a design sequence, which stands for other motions and does not bound them
    THIN = 3
    NO_MARGIN = 4
    NOT_KNOWN = 5
    NOT_SAFE = 6


#: What the worst standing of a body makes of it.
_GRADE = {
    Standing.STANDS: Grade.SAFE,
    Standing.THIN: Grade.THIN,
    Standing.NO_MARGIN: Grade.NO_MARGIN,
    Standing.UNKNOWN: Grade.NOT_KNOWN,
    Standing.WEAKER_OVERTURNS: Grade.NOT_SAFE,
    Standing.OVERTURNS: Grade.NOT_SAFE,
}


@dataclass(frozen=True)
class DemandVerdict:
    """A body against one ground acceleration that the site asks for, with its margin in capacity over demand.

    The grade is NOT_SAFE where a motion overturns the body below the demand, NOT_KNOWN where that cannot be excluded,
    THIN where the smallest capacity is hardly above it. ``below`` and ``unknown`` count the motions that overturn the
    body below the demand, and those of which it is not known.
    """

    name: str
    grade: Grade
    margin: Margin
    below: int
    unknown: int


@dataclass(frozen=True)
class BodyVerdict:
    """One body over all motions, by the model that is counted, with its margin in the safety factor.

    The grade is that of its worst motion, as recorded and weaker. ``counts`` are the motions by standing, ``at_rest``
    those that do not lift it, which say little of it. ``governing`` is the row of /summary with the smallest factor;
    without a finite one, of the first motion that overturns the body; -1: none. ``events_hit`` are the earthquakes with
    a motion that overturns it, as it is or weaker, or of which that is not known, ``largest_share`` the upper bound of
    the share of such earthquakes; NaN where they are too few to say anything.
    """

    body: Body
    grade: Grade
    counts: dict[Standing, int]
    at_rest: int
    margin: Margin
    governing: int
    events_hit: int
    largest_share: float
    demands: tuple[DemandVerdict, ...]

    @property
    def overall(self) -> Grade:
        """The worst of its grade and those of the demands: what fails the demand of the site is not called safe."""
        return max(self.grade, *(demand.grade for demand in self.demands), Grade.SAFE)

    @property
    def never_lifted(self) -> bool:
        """Whether no motion lifts it: it was not tested."""
        return 0 < self.at_rest == sum(self.counts.values())


def thin_margin(search_step: np.ndarray) -> np.ndarray:
    """Below which factor there is hardly a margin, by the ratio of neighbouring factors of the search.

    A finer search may find a smaller factor; the ratio is NaN where there was no search.

    Examples
    --------
    >>> thin_margin(np.array([1.0, 1.014, 1.06])).round(3).tolist()
    [1.1, 1.1, 1.42]
    """
    return np.fmax(THIN_MARGIN, 1.0 + THIN_STEPS * (np.asarray(search_step) - 1.0))


def standings(answers: Answers) -> np.ndarray:
    """The :class:`Standing` of every body under every record, (records, bodies).

    Overturning is overturning; a safety factor below 1 at which the model answers is overturning by a weaker record;
    one below :func:`thin_margin` is hardly a margin, nor is a search that ended below it. Unresolved, outside the range
    of the model, not predictable, or a factor below 1 at which the model cannot answer: not known. A body at rest
    without a factor stands without a margin like any other.
    """
    factor = answers["safety_factor"]
    found = np.full(factor.shape, Standing.STANDS, dtype=np.int8)
    found[np.isnan(factor)] = Standing.NO_MARGIN
    found[~np.isnan(factor) & _thin(answers, factor, answers.proven())] = Standing.THIN
    for doubtful, _ in _doubts(answers):
        found[doubtful] = Standing.UNKNOWN
    found[(factor < 1.0) & (answers["factor_resolved"] != 0)] = Standing.WEAKER_OVERTURNS
    found[answers["outcome"] == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


def why_unknown(answers: Answers) -> np.ndarray:
    """(records, bodies) why an answer is not known, or not to be relied on; empty where there is no doubt."""
    found = np.full(answers["outcome"].shape, "", dtype=object)
    for doubtful, words in _doubts(answers):
        found[doubtful] = words
    for code in Reason:
        named = (answers["outcome"] == Outcome.UNRESOLVED) & (answers["reason"] == code)
        found[named] = "unresolved" if code == Reason.NONE else code.name.lower().replace("_", " ")
    return found.astype(str)


def verdicts(answers: Answers) -> list[BodyVerdict]:
    """The verdict on every body over the motions of the answers."""
    motions = answers.motions
    single = standings(answers)
    worst = motions.over(single, Standing.UNKNOWN).max(axis=1)
    resting = ~motions.anywhere(answers["outcome"] != Outcome.AT_REST)
    of_demands = [_demand_verdicts(answers, demand) for demand in answers.demands]
    events = np.array(motions.events)
    found = []
    for lane, (body, margin) in enumerate(zip(answers.bodies, answers.margins(), strict=True)):
        own = worst[:, lane]
        hit = min(len(set(events[own >= Standing.UNKNOWN].tolist())), motions.event_count)
        at_rest = int(np.count_nonzero(resting[:, lane]))
        best = Grade.UNTESTED if at_rest == own.size else Grade.SAFE
        best = Grade.STANDS if motions.kind == "sequence" else best
        found.append(
            BodyVerdict(
                body=body,
                grade=max(best, _GRADE[Standing(int(own.max()))]) if own.size else Grade.NOT_KNOWN,
                counts={kind: int(np.count_nonzero(own == kind)) for kind in Standing},
                at_rest=at_rest,
                margin=margin,
                governing=_governing(answers["safety_factor"][:, lane], single[:, lane]),
                events_hit=hit,
                largest_share=math.nan if motions.kind == "sequence" else largest_share(hit, motions.event_count),
                demands=tuple(every[lane] for every in of_demands),
            )
        )
    return found


def _demand_verdicts(answers: Answers, demand: str) -> list[DemandVerdict]:
    """The verdict on every body against one demand."""
    ratio, proven = answers.ratios(demand), answers.proven(demand)
    bound = answers["factor_resolved"] == 0
    below = (ratio < 1.0) & ~bound
    # A search that ends below the demand has shown nothing of what lies between.
    unknown = np.isnan(ratio) | ((ratio < 1.0) & bound) | (np.isinf(ratio) & ~(proven >= 1.0))
    unknown |= (answers["applicable"] == 0) | (answers["predictable"] == 0)
    failed = answers.motions.anywhere(below)
    open_ = answers.motions.anywhere(unknown & ~below, missing=True)
    thin = _thin(answers, ratio, proven)
    found = []
    for lane, margin in enumerate(answers.margins(demand=demand)):
        enough = Grade.THIN if thin[:, lane].any() else Grade.SAFE
        certain = len(open_) > 0 and not open_[:, lane].any()
        grade = Grade.NOT_SAFE if failed[:, lane].any() else enough if certain else Grade.NOT_KNOWN
        counts = (int(np.count_nonzero(one[:, lane])) for one in (failed, open_ & ~failed))
        found.append(DemandVerdict(demand, grade, margin, *counts))
    return found


def _thin(answers: Answers, ratio: np.ndarray, proven: np.ndarray) -> np.ndarray:
    """True where a factor, or the end of a search that found none, is hardly a margin."""
    return ~(np.where(np.isinf(ratio), proven, ratio) >= thin_margin(answers["search_step"]))


def _doubts(answers: Answers) -> list[tuple[np.ndarray, str]]:
    """Reasons not to rely on an answer, the gravest last."""
    weaker = (answers["safety_factor"] < 1.0) & (answers["factor_resolved"] == 0)
    return [
        (weaker, "a weaker copy may overturn it, no answer from there on"),
        (answers["applicable"] == 0, "outside the range of the model"),
        (answers["predictable"] == 0, "not predictable: changes with the ninth digit"),
        (answers["outcome"] == Outcome.UNRESOLVED, "unresolved"),
    ]


def _governing(factor: np.ndarray, standing: np.ndarray) -> int:
    if np.isfinite(factor).any():
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    fallen = np.flatnonzero(standing >= Standing.UNKNOWN)
    return int(fallen[np.argmax(standing[fallen])]) if fallen.size else -1
