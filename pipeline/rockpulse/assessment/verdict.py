"""The verdict on every body over all records: the probability of overturning, and its grade."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum, auto
from typing import NamedTuple

import numpy as np

from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Body, Margin, Share
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.model_table import is_upper_bound

#: Smallest probabilities for the grades "may overturn" and "overturns" [-].
MAY_OVERTURN, OVERTURNS = 0.05, 0.5
#: Smallest number of earthquakes among the records scaled to a demand for a verdict.
FEWEST_AT_DEMAND = 5
#: Rounding tolerance of a mean probability, and probability of uplift below which a body counts as at rest [-].
ROUNDING, NEVER_LIFTED = 1e-12, 1e-3


class Standing(IntEnum):
    """The result for a body under one record, from best to worst."""

    STANDS = auto()  #: neither the record nor, if searched, a scaled-down copy overturns it
    UNKNOWN = auto()  #: the model gives no result, or no reliable one
    WEAKER_OVERTURNS = auto()  #: it survives the record, but a scaled-down copy overturns it
    OVERTURNS = auto()  #: the record overturns it


class Grade(IntEnum):
    """The verdict on a body under all records, from best to worst."""

    AT_REST = auto()  #: no motion lifts it
    ROCKS = auto()  #: the probability of overturning is below 0.05
    MAY_OVERTURN = auto()  #: from 0.05 to 0.5; the worst grade for upper-bound inputs
    NOT_KNOWN = auto()  #: depends on records without a result
    OVERTURNS = auto()  #: 0.5 or more

    @property
    def word(self) -> str:
        """The verdict as shown to users."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True)
class DemandVerdict:
    """The verdict on a body under the records scaled to one demand."""

    name: str
    grade: Grade  # NOT_KNOWN for fewer earthquakes than FEWEST_AT_DEMAND
    share: Share  # probability over the earthquakes of the records that can be scaled to the demand
    earthquakes: int
    left_out: int  # number of records farther from the demand than a factor of FARTHEST
    margin: Margin  # margin in the factor over the one that scales the record to the demand

    @property
    def few(self) -> bool:
        """True if there are too few earthquakes for a verdict."""
        return self.earthquakes < FEWEST_AT_DEMAND


@dataclass(frozen=True)
class BodyVerdict:
    """The verdict on one body over all records, from the most complete model."""

    body: Body
    grade: Grade
    share: Share  # probability over earthquakes, which determines the grade
    overturned: int  # number of unscaled records that overturn it
    at_rest: int  # number of records that do not lift it
    margin: Margin  # margin in the scale factor
    governing: int  # row of /summary with the smallest factor, else of the first record that overturns it, else -1
    demands: tuple[DemandVerdict, ...]

    @property
    def deciding(self) -> DemandVerdict | None:
        """The demand with the worst grade, which determines the verdict; None without demands."""
        return max(self.demands, key=lambda one: (one.grade, one.share.value), default=None)

    @property
    def overall(self) -> Grade:
        """Worst grade over the demands of the site, or without demands the grade under the unscaled records."""
        return self.grade if self.deciding is None else self.deciding.grade

    @property
    def word(self) -> str:
        """The verdict as shown to users."""
        return "no verdict" if self.deciding is not None and self.deciding.few else self.overall.word

    @property
    def decides(self) -> Share:
        """The probability that determines the verdict."""
        return self.share if self.deciding is None else self.deciding.share


def standings(answers: Answers) -> np.ndarray:
    """Return the :class:`Standing` of every body under every record, (records, bodies)."""
    factor = answers["safety_factor"]
    found = np.full(factor.shape, Standing.STANDS, dtype=np.int8)
    for doubtful, _ in _doubts(answers):
        found[doubtful] = Standing.UNKNOWN
    found[(factor < 1.0) & (answers["factor_resolved"] != 0)] = Standing.WEAKER_OVERTURNS
    found[answers["outcome"] == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


def reasons_unknown(answers: Answers) -> np.ndarray:
    """Return codes (records, bodies) of the reason for a missing or unreliable result; empty for reliable results."""
    found = np.full(answers["outcome"].shape, "", dtype=object)
    for doubtful, why in _doubts(answers):
        found[doubtful] = why
    for code in Reason:
        named = (answers["outcome"] == Outcome.UNRESOLVED) & (answers["reason"] == code)
        found[named] = "unresolved" if code == Reason.NONE else code.name.lower()
    return found.astype(str)


def verdicts(answers: Answers) -> list[BodyVerdict]:
    """Return the verdict on every body over the motions of the results."""
    motions, single = answers.motions, standings(answers)
    moved = answers["outcome"] != Outcome.AT_REST
    lifted = ~(answers["uplift_probability"] < NEVER_LIFTED) if answers.probable else moved
    lifted = motions.in_any_direction(lifted, missing=True)
    stays = np.full(len(answers.bodies), bool(motions.names)) & ~lifted.any(axis=0)
    of_demands = [_demand_verdicts(answers, demand) for demand in answers.demands]
    fallen, resting = answers.overturnings(), (~motions.in_any_direction(moved, missing=True)).sum(axis=0).tolist()
    shares = motions.shares(overturning_probabilities(answers))
    return [
        BodyVerdict(
            body=body,
            grade=Grade.AT_REST if stays[lane] else _grade(shares[lane], is_upper_bound(answers.model)),
            share=shares[lane],
            overturned=fallen[lane],
            at_rest=resting[lane],
            margin=margin,
            governing=_governing(answers[answers.factor][:, lane], single[:, lane]),
            demands=tuple(every[lane] for every in of_demands),
        )
        for lane, (body, margin) in enumerate(zip(answers.bodies, answers.margins(), strict=True))
    ]


def _grade(share: Share, bound: bool) -> Grade:
    """Grade a probability, or an upper bound; NOT_KNOWN if records without a result could change the grade."""
    worst = Grade.MAY_OVERTURN if bound else Grade.OVERTURNS
    low, high = (
        worst if value >= OVERTURNS else Grade.MAY_OVERTURN if value >= MAY_OVERTURN else Grade.ROCKS
        for value in (share.least + ROUNDING, share.most + ROUNDING)
    )
    return low if low == high and not math.isnan(share.least) else Grade.NOT_KNOWN


def _demand_verdicts(answers: Answers, demand: str) -> list[DemandVerdict]:
    """Return the verdict on every body for one demand."""
    motions, left_out = answers.motions, too_far(answers, demand)
    kept = motions.kept(left_out)
    shares, events = (
        motions.shares(overturning_probabilities(answers, demand), left_out),
        motions.event_counts(kept).tolist(),
    )
    lost = (~kept).sum(axis=0).tolist()
    found = []
    for lane, margin in enumerate(answers.margins(demand=demand)):
        few = events[lane] < FEWEST_AT_DEMAND
        grade = Grade.NOT_KNOWN if few else _grade(shares[lane], is_upper_bound(answers.model))
        found.append(DemandVerdict(demand, grade, shares[lane], events[lane], lost[lane], margin))
    return found


def too_far(answers: Answers, demand: str) -> np.ndarray:
    """Return a mask (records, bodies) of records that are too far from a demand to be scaled; they are excluded."""
    factor = answers.to_demand(demand)
    return np.asarray((factor < FARTHEST[0]) | (factor > FARTHEST[1]))


def overturning_probabilities(answers: Answers, demand: str | None = None) -> np.ndarray:
    """Return the probability (records, bodies) that a record, unscaled or at a demand, overturns a body, or NaN."""
    if answers.probable:
        return answers["overturning_probability"] if demand is None else answers.at_demand(demand)
    if demand is not None:
        return _overturns_at(answers, demand)
    single = standings(answers)
    return np.where(single == Standing.UNKNOWN, np.nan, single >= Standing.WEAKER_OVERTURNS)


def _overturns_at(answers: Answers, demand: str) -> np.ndarray:
    """Return (records, bodies) 1 if the safety factor is exceeded at the demand, 0 if not, NaN if unknown."""
    ratio = answers.ratios(demand)
    # A search that ends below the demand gives no information on the factors up to it.
    unknown = np.isnan(ratio) | ((ratio < 1.0) & answers.bound)
    unknown |= np.isinf(ratio) & ~(answers.proven(demand) >= 1.0)
    unknown |= answers["applicable"] == 0
    return np.where(unknown, np.nan, ratio < 1.0)


def _doubts(answers: Answers) -> list[tuple[np.ndarray, str]]:
    """Return masks of doubtful results, by the code of the reason, the most serious reason last."""
    weaker = (answers["safety_factor"] < 1.0) & (answers["factor_resolved"] == 0)
    outside, unresolved = answers["applicable"] == 0, answers["outcome"] == Outcome.UNRESOLVED
    return [(weaker, "weaker"), (outside, "outside"), (unresolved, "unresolved")]


def _governing(factor: np.ndarray, standing: np.ndarray) -> int:
    if np.isfinite(factor).any():
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    fallen = np.flatnonzero(standing >= Standing.UNKNOWN)
    return int(fallen[np.argmax(standing[fallen])]) if fallen.size else -1


class Sliding(NamedTuple):
    """A body that may slide: `above` of `total` records require more friction than it has; `most` is the largest."""

    body: Body
    above: int
    total: int
    most: float
    friction: float


def worse_with_pedestal(answers: Answers, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, BodyVerdict]]:
    """Return the name and the worse verdict of every body that is assessed with and without its pedestal."""
    whole = answers.summary["pedestal_of"].values.tolist()
    for alone in dict.fromkeys(filter(None, whole)):
        screens = [one for one in found if alone in (one.body.block, whole[one.body.place])]
        if len({one.body.block for one in screens}) > 1:
            yield alone, max(screens, key=lambda one: (one.overall, one.decides.value))


def sliding(answers: Answers) -> Iterator[Sliding]:
    """Return every body with less friction than some records require."""
    friction = answers.summary["friction"].values
    for lane, body in enumerate(answers.bodies):
        required, own = answers["friction_required"][:, lane], float(friction[body.place])
        if above := int(np.count_nonzero(required > own)):
            yield Sliding(body, above, required.size, float(np.nanmax(required)), own)
