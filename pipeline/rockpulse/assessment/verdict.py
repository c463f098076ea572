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
#: Tolerance of a mean probability, and probability of uplift below which a body counts as at rest [-].
ROUNDING, NEVER_LIFTED = 1e-12, 1e-3


class Standing(IntEnum):
    """The result for a body under one record, from best to worst."""

    STANDS = auto()  #: neither the record nor, as far as computed, a scaled-down copy overturns the body
    UNKNOWN = auto()  #: the result is missing or unreliable
    WEAKER_OVERTURNS = auto()  #: the body survives the record, but a scaled-down copy overturns it
    OVERTURNS = auto()  #: the record overturns the body


class Grade(IntEnum):
    """The verdict on a body under all records, from best to worst."""

    AT_REST = auto()  #: no ground motion lifts the body
    ROCKS = auto()  #: the probability of overturning is less than 0.05
    MAY_OVERTURN = auto()  #: it is 0.05 to 0.5, or more under a model with an upper-bound input
    NOT_KNOWN = auto()  #: the grade depends on records without a result
    OVERTURNS = auto()  #: the probability of overturning is 0.5 or more

    @property
    def word(self) -> str:
        """The verdict in words."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True)
class DemandVerdict:
    """The verdict on a body under the records scaled to one demand."""

    name: str
    grade: Grade  # NOT_KNOWN for fewer earthquakes than FEWEST_AT_DEMAND
    share: Share  # probability over the earthquakes of the records that can be scaled to the demand
    earthquakes: int
    left_out: int  # number of motions that cannot be scaled to the demand within FARTHEST
    margin: Margin  # margin as the ratio to the demand

    @property
    def few(self) -> bool:
        """True if the earthquakes are too few for a verdict."""
        return self.earthquakes < FEWEST_AT_DEMAND


@dataclass(frozen=True)
class BodyVerdict:
    """The verdict on one body over all records, from the most complete model."""

    body: Body
    grade: Grade
    share: Share  # probability over earthquakes, which determines the grade
    overturned: int  # number of unscaled motions that overturn the body
    at_rest: int  # number of motions that do not move the body
    margin: Margin  # margin as a scale factor
    governing: int  # row of the most severe record in /summary; -1 if there is none
    demands: tuple[DemandVerdict, ...]

    @property
    def deciding(self) -> DemandVerdict | None:
        """The verdict at the worst demand, which determines the verdict on the body; None without demands."""
        return max(self.demands, key=lambda one: (one.grade, one.share.value), default=None)

    @property
    def overall(self) -> Grade:
        """The worst grade at the demands of the site; without demands, the grade under the unscaled records."""
        return self.grade if self.deciding is None else self.deciding.grade

    @property
    def word(self) -> str:
        """The verdict in words."""
        return "no verdict" if self.deciding is not None and self.deciding.few else self.overall.word

    @property
    def decides(self) -> Share:
        """The probability that determines the verdict."""
        return self.share if self.deciding is None else self.deciding.share


def standings(answers: Answers) -> np.ndarray:
    """Return the :class:`Standing` (records, bodies) of every body under every record."""
    factor = answers["safety_factor"]
    found = np.full(factor.shape, Standing.STANDS, dtype=np.int8)
    for doubtful, _ in _doubts(answers):
        found[doubtful] = Standing.UNKNOWN
    found[(factor < 1.0) & (answers["factor_resolved"] != 0)] = Standing.WEAKER_OVERTURNS
    found[answers["outcome"] == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


def reasons_unknown(answers: Answers) -> np.ndarray:
    """Return a code (records, bodies) for the reason why a result is missing or unreliable; empty if it is reliable."""
    found = np.full(answers["outcome"].shape, "", dtype=object)
    for doubtful, why in _doubts(answers):
        found[doubtful] = why
    for code in Reason:
        named = (answers["outcome"] == Outcome.UNRESOLVED) & (answers["reason"] == code)
        found[named] = "unresolved" if code == Reason.NONE else code.name.lower()
    return found.astype(str)


def verdicts(answers: Answers) -> list[BodyVerdict]:
    """Return the verdict on every body over all ground motions of the results."""
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
    """Return the grade of a probability; NOT_KNOWN if the records without a result could change the grade."""
    worst = Grade.MAY_OVERTURN if bound else Grade.OVERTURNS
    low, high = (
        worst if value >= OVERTURNS else Grade.MAY_OVERTURN if value >= MAY_OVERTURN else Grade.ROCKS
        for value in (share.least + ROUNDING, share.most + ROUNDING)
    )
    return low if low == high and not math.isnan(share.least) else Grade.NOT_KNOWN


def _demand_verdicts(answers: Answers, demand: str) -> list[DemandVerdict]:
    """Return the verdict on every body at one demand."""
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
    """Return a mask (records, bodies) of records that are excluded, as their factor to the demand is too far from 1.

    A record without a factor, which is not in the selection of the demand, is excluded too.
    """
    factor = answers.to_demand(demand)
    return ~np.asarray((factor >= FARTHEST[0]) & (factor <= FARTHEST[1]))


def overturning_probabilities(answers: Answers, demand: str | None = None) -> np.ndarray:
    """Return the probability (records, bodies) of overturning, unscaled or at a demand; NaN if unknown."""
    if answers.probable:
        return answers["overturning_probability"] if demand is None else answers.at_demand(demand)
    if demand is not None:
        return _overturns_at(answers, demand)
    single = standings(answers)
    return np.where(single == Standing.UNKNOWN, np.nan, single >= Standing.WEAKER_OVERTURNS)


def _overturns_at(answers: Answers, demand: str) -> np.ndarray:
    """Return 1 (records, bodies) if the demand exceeds the safety factor, 0 if not, and NaN if unknown."""
    ratio = answers.ratios(demand)
    # A search that ends below the demand gives no information on the factors up to it.
    unknown = np.isnan(ratio) | ((ratio < 1.0) & answers.bound)
    unknown |= np.isinf(ratio) & ~(answers.proven(demand) >= 1.0)
    unknown |= answers["applicable"] == 0
    return np.where(unknown, np.nan, ratio < 1.0)


def _doubts(answers: Answers) -> list[tuple[np.ndarray, str]]:
    """Return masks of doubtful results with the code of the reason; the most serious reason is last."""
    weaker = (answers["safety_factor"] < 1.0) & (answers["factor_resolved"] == 0)
    outside, unresolved = answers["applicable"] == 0, answers["outcome"] == Outcome.UNRESOLVED
    return [(weaker, "weaker"), (outside, "outside"), (unresolved, "unresolved")]


def _governing(factor: np.ndarray, standing: np.ndarray) -> int:
    if np.isfinite(factor).any():
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    fallen = np.flatnonzero(standing >= Standing.UNKNOWN)
    return int(fallen[np.argmax(standing[fallen])]) if fallen.size else -1


class Sliding(NamedTuple):
    """A body that may slide: `above` of `total` records require more friction than it has, at most `most`."""

    body: Body
    above: int
    total: int
    most: float
    friction: float


def worse_with_pedestal(answers: Answers, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, BodyVerdict]]:
    """Yield name and worse verdict of every body that is assessed with and without its pedestal."""
    whole = answers.summary["pedestal_of"].values.tolist()
    for alone in dict.fromkeys(filter(None, whole)):
        screens = [one for one in found if alone in (one.body.block, whole[one.body.place])]
        if len({one.body.block for one in screens}) > 1:
            yield alone, max(screens, key=lambda one: (one.overall, one.decides.value))


def sliding(answers: Answers) -> Iterator[Sliding]:
    """Yield every body that has less friction than some records require."""
    friction = answers.summary["friction"].values
    for lane, body in enumerate(answers.bodies):
        required, own = answers["friction_required"][:, lane], float(friction[body.place])
        if above := int(np.count_nonzero(required > own)):
            yield Sliding(body, above, required.size, float(np.nanmax(required)), own)
