"""The verdict on every body over all motions: the probability that they overturn it, and the words for it."""

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

#: Probabilities of overturning from which on a body may overturn, and overturns [-].
MAY_OVERTURN, OVERTURNS = 0.05, 0.5
#: Fewest earthquakes of records brought to a demand from which a verdict is given.
FEWEST_AT_DEMAND = 5
#: What the rounding of a mean may take from a probability, and that of uplift below which a body stays at rest [-].
ROUNDING, NEVER_LIFTED = 1e-12, 1e-3


class Standing(IntEnum):
    """The answer of a model for a body under one record, from best to worst."""

    STANDS = auto()  #: neither the record nor, where it was searched, a weaker copy overturns it
    UNKNOWN = auto()  #: the model cannot say, or not reliably
    WEAKER_OVERTURNS = auto()  #: it survives the record as it is, a weaker copy overturns it
    OVERTURNS = auto()  #: the record overturns it


class Grade(IntEnum):
    """The verdict on a body under all motions, from best to worst."""

    STAYS = auto()  #: no motion lifts it
    ROCKS = auto()  #: the probability of overturning is below 0.05
    MAY_OVERTURN = auto()  #: from 0.05 to 0.5; the worst that an upper-bound type input can show
    NOT_KNOWN = auto()  #: the motions that are not known decide
    OVERTURNS = auto()  #: 0.5 or more

    @property
    def word(self) -> str:
        """The verdict as it is shown."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True)
class DemandVerdict:
    """A body under the motions brought to one demand."""

    name: str
    grade: Grade  # NOT_KNOWN where the earthquakes are fewer than FEWEST_AT_DEMAND
    share: Share  # the probability over the earthquakes of the motions that can be brought to the demand
    earthquakes: int
    left_out: int  # motions that lie farther from the demand than a factor of FARTHEST
    margin: Margin  # in the factor over the one that brings the motion to the demand

    @property
    def few(self) -> bool:
        """Whether there are too few earthquakes for a verdict."""
        return self.earthquakes < FEWEST_AT_DEMAND


@dataclass(frozen=True)
class BodyVerdict:
    """One body over all motions, by the model that is counted."""

    body: Body
    grade: Grade
    share: Share  # the probability over earthquakes, which the grade follows from
    overturned: int  # motions that overturn it as they are
    at_rest: int  # motions that do not lift it
    margin: Margin  # in the factor
    governing: int  # row of /summary with the smallest factor, else of the first motion that overturns it, else -1
    demands: tuple[DemandVerdict, ...]

    @property
    def deciding(self) -> DemandVerdict | None:
        """The demand that the verdict rests on, the one of the worst grade; None where the site has none."""
        return max(self.demands, key=lambda one: (one.grade, one.share.value), default=None)

    @property
    def overall(self) -> Grade:
        """The worst grade of the demands of the site; without a demand that under the motions as they are."""
        return self.grade if self.deciding is None else self.deciding.grade

    @property
    def word(self) -> str:
        """The verdict as it is shown."""
        return "no verdict" if self.deciding is not None and self.deciding.few else self.overall.word

    @property
    def decides(self) -> Share:
        """The probability that the verdict rests on."""
        return self.share if self.deciding is None else self.deciding.share


def standings(answers: Answers) -> np.ndarray:
    """The :class:`Standing` of every body under every record, (records, bodies)."""
    factor = answers["safety_factor"]
    found = np.full(factor.shape, Standing.STANDS, dtype=np.int8)
    for doubtful, _ in _doubts(answers):
        found[doubtful] = Standing.UNKNOWN
    found[(factor < 1.0) & (answers["factor_resolved"] != 0)] = Standing.WEAKER_OVERTURNS
    found[answers["outcome"] == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


def why_unknown(answers: Answers) -> np.ndarray:
    """(records, bodies) why an answer is not known, or not to be relied on, by a code; empty without a doubt."""
    found = np.full(answers["outcome"].shape, "", dtype=object)
    for doubtful, why in _doubts(answers):
        found[doubtful] = why
    for code in Reason:
        named = (answers["outcome"] == Outcome.UNRESOLVED) & (answers["reason"] == code)
        found[named] = "unresolved" if code == Reason.NONE else code.name.lower()
    return found.astype(str)


def verdicts(answers: Answers) -> list[BodyVerdict]:
    """The verdict on every body over the motions of the answers."""
    motions, single = answers.motions, standings(answers)
    moved = answers["outcome"] != Outcome.AT_REST
    lifted = ~(answers["uplift_probability"] < NEVER_LIFTED) if answers.probable else moved
    lifted = motions.anywhere(lifted, missing=True)
    stays = np.full(len(answers.bodies), bool(motions.names)) & ~lifted.any(axis=0)
    of_demands = [_demand_verdicts(answers, demand) for demand in answers.demands]
    fallen, resting = answers.overturnings(), (~motions.anywhere(moved, missing=True)).sum(axis=0).tolist()
    shares = motions.shares(chances(answers))
    return [
        BodyVerdict(
            body=body,
            grade=Grade.STAYS if stays[lane] else _grade(shares[lane], is_upper_bound(answers.model)),
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
    """The word for a probability, perhaps of an upper bound; not known where unknown motions decide between two."""
    worst = Grade.MAY_OVERTURN if bound else Grade.OVERTURNS
    low, high = (
        worst if value >= OVERTURNS else Grade.MAY_OVERTURN if value >= MAY_OVERTURN else Grade.ROCKS
        for value in (share.least + ROUNDING, share.most + ROUNDING)
    )
    return low if low == high and not math.isnan(share.least) else Grade.NOT_KNOWN


def _demand_verdicts(answers: Answers, demand: str) -> list[DemandVerdict]:
    """The verdict on every body against one demand."""
    motions, left_out = answers.motions, too_far(answers, demand)
    kept = motions.kept(left_out)
    shares, events = motions.shares(chances(answers, demand), left_out), motions.event_counts(kept).tolist()
    lost = (~kept).sum(axis=0).tolist()
    found = []
    for lane, margin in enumerate(answers.margins(demand=demand)):
        few = events[lane] < FEWEST_AT_DEMAND
        grade = Grade.NOT_KNOWN if few else _grade(shares[lane], is_upper_bound(answers.model))
        found.append(DemandVerdict(demand, grade, shares[lane], events[lane], lost[lane], margin))
    return found


def too_far(answers: Answers, demand: str) -> np.ndarray:
    """(records, bodies) True where a record has to be scaled too far to a demand: it is left out of the verdict."""
    factor = answers.to_demand(demand)
    return np.asarray((factor < FARTHEST[0]) | (factor > FARTHEST[1]))


def chances(answers: Answers, demand: str | None = None) -> np.ndarray:
    """(records, bodies) probability that a record, as it is or at a demand, overturns a body; NaN where not known."""
    if answers.probable:
        return answers["overturning_probability"] if demand is None else answers.at_demand(demand)
    if demand is not None:
        return _overturns_at(answers, demand)
    single = standings(answers)
    return np.where(single == Standing.UNKNOWN, np.nan, single >= Standing.WEAKER_OVERTURNS)


def _overturns_at(answers: Answers, demand: str) -> np.ndarray:
    """(records, bodies) 1 where by its safety factor a body overturns at the demand, 0 where not, NaN if not known."""
    ratio = answers.ratios(demand)
    # A search that ends below the demand has shown nothing of what lies between.
    unknown = np.isnan(ratio) | ((ratio < 1.0) & answers.bound)
    unknown |= np.isinf(ratio) & ~(answers.proven(demand) >= 1.0)
    unknown |= answers["applicable"] == 0
    return np.where(unknown, np.nan, ratio < 1.0)


def _doubts(answers: Answers) -> list[tuple[np.ndarray, str]]:
    """Reasons not to rely on an answer by their codes, the gravest last."""
    weaker = (answers["safety_factor"] < 1.0) & (answers["factor_resolved"] == 0)
    outside, unresolved = answers["applicable"] == 0, answers["outcome"] == Outcome.UNRESOLVED
    return [(weaker, "weaker"), (outside, "outside"), (unresolved, "unresolved")]


def _governing(factor: np.ndarray, standing: np.ndarray) -> int:
    if np.isfinite(factor).any():
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    fallen = np.flatnonzero(standing >= Standing.UNKNOWN)
    return int(fallen[np.argmax(standing[fallen])]) if fallen.size else -1


class Sliding(NamedTuple):
    """A body whose friction does not hold it under `above` of `total` records, of which one asks for `most`."""

    body: Body
    above: int
    total: int
    most: float
    friction: float


def worse_screens(answers: Answers, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, BodyVerdict]]:
    """Every body on a pedestal that is assessed alone and as one with it: its name, and the worse verdict of both."""
    whole = answers.summary["pedestal_of"].values.tolist()
    for alone in dict.fromkeys(filter(None, whole)):
        screens = [one for one in found if alone in (one.body.block, whole[one.body.place])]
        if len({one.body.block for one in screens}) > 1:
            yield alone, max(screens, key=lambda one: (one.overall, one.decides.value))


def sliding(answers: Answers) -> Iterator[Sliding]:
    """Every body that some records ask for more friction than it has."""
    friction = answers.summary["friction"].values
    for lane, body in enumerate(answers.bodies):
        required, own = answers["friction_required"][:, lane], float(friction[body.place])
        if above := int(np.count_nonzero(required > own)):
            yield Sliding(body, above, required.size, float(np.nanmax(required)), own)
