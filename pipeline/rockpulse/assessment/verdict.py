"""The verdict on every body over all records, from its probability of overturning.

A "motion" is a record, or a pair of channels if it is assessed in several directions. It counts for the verdict, unless
it cannot be scaled to the demand, or lifts no body.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum, auto
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from rocking.body.restraint import Restraints, Tie, TieState
from rocking.response import Outcome, Reason
from rockpulse.assessment.answers import Answers, Body, Margin, Share
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.model_table import is_full, is_upper_bound
from rockpulse.record.measures import UPLIFT_RATIO

#: Smallest probabilities for the grades "may overturn" and "overturns" [-].
MAY_OVERTURN, OVERTURNS = 0.05, 0.5
#: Smallest number of earthquakes among the records scaled to a demand for a verdict.
FEWEST_AT_DEMAND = 5
#: Largest ratio of PGA to uplift PGA at which the uplift of a body is negligible: exp(-4 s), where s = 0.11 is the
#: standard deviation of the logarithm of this ratio under the default uncertainty.
WEAK = 0.64
#: Tolerance of a mean probability, and probability of uplift below which a body counts as at rest [-].
ROUNDING, NEVER_LIFTED = 1e-12, 1e-3


#: Words for verdicts whose name alone is not clear.
_WORDS = {"no_margin": "rocks, no margin"}


class Standing(IntEnum):
    """The result for a body under one record, from best to worst."""

    STANDS = auto()  #: neither the record nor, as far as computed, a scaled-down copy overturns the body
    UNKNOWN = auto()  #: the result is missing or unreliable
    WEAKER_OVERTURNS = auto()  #: the body survives the record, but a scaled-down copy overturns it
    OVERTURNS = auto()  #: the record overturns the body


class Grade(IntEnum):
    """The verdict on a body over all records, from best to worst."""

    AT_REST = auto()  #: no ground motion lifts the body
    ROCKS = auto()  #: the probability of overturning is less than 0.05
    MAY_OVERTURN = auto()  #: the probability is 0.05 to 0.5, or higher under a model with an upper-bound input
    NO_VERDICT = auto()  #: there is no demand, or too few earthquakes
    NOT_KNOWN = auto()  #: the grade depends on records without a result
    SLIDES_FIRST = auto()  #: the friction is too small for the body to rock; there is no verdict on rocking
    OVERTURNS = auto()  #: the probability of overturning is 0.5 or more


@dataclass(frozen=True)
class Finding:
    """The results for one body under all records, as recorded or scaled to one demand."""

    demand: str  # name of the demand; empty for the records as recorded
    grade: Grade
    share: Share  # probability over the earthquakes of the counted motions
    earthquakes: int  # number of earthquakes of the counted motions
    motions: int  # number of counted motions
    left_out: int  # number of motions that cannot be scaled to the demand within FARTHEST
    weak: int  # number of other motions that lift no body, which are not counted
    overturned: int  # number of motions that overturn the nominal body
    at_rest: int  # number of motions that do not lift the nominal body
    median_rotation: float  # median over the motions of the peak rotation over alpha_c; inf if overturning
    largest_rotation: float  # largest peak rotation over alpha_c; inf if a motion overturns the body
    others_rotation: float  # largest peak rotation over alpha_c under motions that do not overturn the body
    margin: Margin  # scale factor, divided by the scale factor to the demand if there is one
    sliding: float  # largest share of a motion that requires more friction than the body has; NaN if unknown
    slides_first: bool  # whether the body slides before it rocks
    governing: int  # row of the most severe record in /summary; -1 if there is none

    @property
    def status(self) -> str:
        """The grade as a lower-case name; at a demand, ROCKS may be replaced by "no_margin" or "not_lifted".

        "no_margin": capacity/demand is below 1; "not_lifted": no record lifts the nominal body.
        """
        if self.grade == Grade.ROCKS and self.demand:
            if self.margin.smallest < 1.0:
                return "no_margin"
            if self.largest_rotation == 0.0:
                return "not_lifted"
        return self.grade.name.lower()

    @property
    def word(self) -> str:
        """The verdict in words; empty without a verdict."""
        return "" if self.grade == Grade.NO_VERDICT else _WORDS.get(self.status, self.status.replace("_", " "))

    @property
    def severity(self) -> float:
        """The grade as a number; "no_margin" is half a grade worse, "not_lifted" half a grade better than ROCKS."""
        return self.grade + {"not_lifted": -0.5, "no_margin": 0.5}.get(self.status, 0.0)

    @property
    def few(self) -> bool:
        """True if there are too few earthquakes for a verdict."""
        return self.earthquakes < FEWEST_AT_DEMAND


@dataclass(frozen=True)
class BodyVerdict:
    """The verdict on one body over all records, from the most complete model."""

    body: Body
    recorded: Finding
    demands: tuple[Finding, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The results at each demand of the site or, without demands, under the records as recorded."""
        return self.demands or (self.recorded,)

    @property
    def deciding(self) -> Finding:
        """The worst of the findings, which determines the verdict."""
        return max(self.findings, key=lambda one: (one.severity, one.share.value))

    @property
    def grade(self) -> Grade:
        """The worst verdict at any demand of the site."""
        return self.deciding.grade

    @property
    def share(self) -> Share:
        """The probability that determines the verdict."""
        return self.deciding.share


def standings(answers: Answers) -> np.ndarray:
    """Return the :class:`Standing` (records, bodies) of every body under every record."""
    factor = answers["safety_factor"]
    found = np.full(factor.shape, Standing.STANDS, dtype=np.int8)
    for doubtful, _ in _doubts(answers):
        found[doubtful] = Standing.UNKNOWN
    found[(factor < 1.0) & (answers["factor_resolved"] != 0)] = Standing.WEAKER_OVERTURNS
    found[answers["outcome"] == Outcome.OVERTURNS] = Standing.OVERTURNS
    return found


#: Verdicts that were computed before, as a view needs them several times.
_FOUND: WeakKeyDictionary[Answers, list[BodyVerdict]] = WeakKeyDictionary()


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
    """Return the verdict on every body over all records of the results."""
    if answers not in _FOUND:
        recorded = _findings(answers, None)
        of_demands = [_findings(answers, demand) for demand in answers.demands]
        _FOUND[answers] = [
            BodyVerdict(body, recorded[lane], tuple(every[lane] for every in of_demands))
            for lane, body in enumerate(answers.bodies)
        ]
    return list(_FOUND[answers])


def _grade(share: Share, bound: bool) -> Grade:
    """Return the verdict for P, at most MAY_OVERTURN if P is an upper bound; NOT_KNOWN if missing results matter."""
    worst = Grade.MAY_OVERTURN if bound else Grade.OVERTURNS
    low, high = (
        worst if value >= OVERTURNS else Grade.MAY_OVERTURN if value >= MAY_OVERTURN else Grade.ROCKS
        for value in (share.least + ROUNDING, share.most + ROUNDING)
    )
    return low if low == high and not math.isnan(share.least) else Grade.NOT_KNOWN


def _findings(answers: Answers, demand: str | None) -> list[Finding]:
    """Return the results for every body under all records, as recorded or scaled to one demand."""
    motions, far = answers.motions, too_far(answers, demand)
    left_out = far | weak(answers, demand)[:, np.newaxis]
    kept, near = motions.kept(left_out), motions.kept(far)
    shares = motions.shares(overturning_probabilities(answers, demand), left_out)
    ratio = np.where(left_out, np.nan, answers.ratios(demand))
    fallen, rotation = nominal_motion(answers, demand)
    severity = np.where(fallen, np.inf, rotation)
    if demand is None:
        single = standings(answers)
        severity = np.where(single >= Standing.UNKNOWN, single.astype(float), 0.0)
    fallen, lifted = motions.in_any_direction(fallen) & kept, motions.in_any_direction(_lifts(answers, demand), True)
    largest = np.where(kept, np.fmax.reduce(motions.over(rotation, np.nan), axis=1), np.nan)
    stays = kept.any(axis=0) & ~(lifted & kept).any(axis=0)
    sliding, first = _sliding(answers, demand, kept), slides_first(answers)
    margins, events = answers.margins(demand=demand, left_out=left_out), motions.event_counts(kept).tolist()
    severity, idle, at_rest = np.where(left_out, 0.0, severity), near & ~kept, kept & ~lifted
    found = []
    for lane, (share, margin) in enumerate(zip(shares, margins, strict=True)):
        grade = Grade.AT_REST if stays[lane] else _grade(share, is_upper_bound(answers.model))
        if motions.kind != "sequence" and (demand is None or events[lane] < FEWEST_AT_DEMAND):
            grade = Grade.NO_VERDICT
        if first[lane] and (demand is not None or motions.kind == "sequence"):
            grade = Grade.SLIDES_FIRST
        over = np.where(fallen[:, lane], np.inf, largest[:, lane])
        known = over[~np.isnan(over)]
        found.append(
            Finding(
                demand=demand or "",
                grade=grade,
                share=share,
                earthquakes=events[lane],
                motions=int(kept[:, lane].sum()),
                left_out=int((~near[:, lane]).sum()),
                weak=int(idle[:, lane].sum()),
                overturned=int(fallen[:, lane].sum()),
                at_rest=int(at_rest[:, lane].sum()),
                median_rotation=float(np.median(known)) if known.size else math.nan,
                largest_rotation=float(known.max(initial=-math.inf)) if known.size else math.nan,
                others_rotation=float(np.fmax.reduce(known[np.isfinite(known)], initial=math.nan)),
                margin=margin,
                sliding=float(sliding[lane]),
                slides_first=bool(first[lane]),
                governing=_governing(ratio[:, lane], severity[:, lane]),
            )
        )
    return found


def nominal_motion(answers: Answers, demand: str | None) -> tuple[np.ndarray, np.ndarray]:
    """Return whether a record overturns the nominal body, and its rotation over alpha_c; both (records, bodies)."""
    if demand is None:
        return answers["outcome"] == Outcome.OVERTURNS, answers["peak_rotation_ratio"]
    rotation, outcome = answers.of_demand("demand_rotation_ratio", demand), answers.of_demand("demand_outcome", demand)
    if is_full(answers.model):
        return outcome == Outcome.OVERTURNS, rotation
    return _overturns_at(answers, demand) == 1.0, np.full(rotation.shape, np.nan)


def _lifts(answers: Answers, demand: str | None) -> np.ndarray:
    """Return a mask (records, bodies): False if the record is certainly too weak to lift the body."""
    if demand is None:
        moved = answers["outcome"] != Outcome.AT_REST
        return ~(answers["uplift_probability"] < NEVER_LIFTED) if answers.probable else moved
    return ~(answers[UPLIFT_RATIO] * answers.of_demand("demand_factor", demand) < _weakest(answers))


def _weakest(answers: Answers) -> float:
    """Return the ratio of PGA to uplift PGA below which a record is too weak to lift a body."""
    return WEAK if answers.probable else 1.0


def weak(answers: Answers, demand: str | None) -> np.ndarray:
    """Return a mask (records,): True if the record lifts no body and has P = 0; all False if no record lifts a body."""
    if answers.motions.kind == "sequence":
        return np.zeros(len(answers.records), dtype=bool)
    far, factor = too_far(answers, demand), 1.0 if demand is None else answers.of_demand("demand_factor", demand)
    idle = (answers[UPLIFT_RATIO] * factor < _weakest(answers)) & (overturning_probabilities(answers, demand) == 0.0)
    found = np.asarray((idle | far).all(axis=1) & ~far.all(axis=1))
    return found & bool((~found & ~far.all(axis=1)).any())


def too_far(answers: Answers, demand: str | None) -> np.ndarray:
    """Return a mask (records, bodies) of records that are excluded, because their scale factor is too far from 1.

    Records that are missing in the table of selected records of the demand are excluded, too.
    """
    if demand is None:
        return np.zeros((len(answers.records), len(answers.bodies)), dtype=bool)
    factor = answers.of_demand("demand_factor", demand)
    return ~np.asarray((factor >= FARTHEST[0]) & (factor <= FARTHEST[1]))


def overturning_probabilities(answers: Answers, demand: str | None = None) -> np.ndarray:
    """Return the probability (records, bodies) of overturning, unscaled or at a demand; NaN if unknown."""
    if answers.probable:
        return answers["overturning_probability"] if demand is None else answers.of_demand("demand_probability", demand)
    if demand is not None:
        return _overturns_at(answers, demand)
    single = standings(answers)
    return np.where(single == Standing.UNKNOWN, np.nan, single >= Standing.WEAKER_OVERTURNS)


def _overturns_at(answers: Answers, demand: str) -> np.ndarray:
    """Return an array (records, bodies): 1 if the demand exceeds the safety factor, 0 if not, NaN if unknown."""
    ratio = answers.ratios(demand)
    # A search that ends below the demand gives no information on the factors up to it.
    unknown = np.isnan(ratio) | ((ratio < 1.0) & answers.bound)
    unknown |= np.isinf(ratio) & ~(answers.proven(demand) >= 1.0)
    unknown |= answers["applicable"] == 0
    return np.where(unknown, np.nan, ratio < 1.0)


def _doubts(answers: Answers) -> list[tuple[np.ndarray, str]]:
    """Return masks of doubtful results, each with the code of its reason; the most serious reason is last."""
    weaker = (answers["safety_factor"] < 1.0) & (answers["factor_resolved"] == 0)
    outside, unresolved = answers["applicable"] == 0, answers["outcome"] == Outcome.UNRESOLVED
    return [(weaker, "weaker"), (outside, "outside"), (unresolved, "unresolved")]


def _governing(factor: np.ndarray, severity: np.ndarray) -> int:
    """Return the index of the record with the smallest finite scale factor, else with the largest severity, else -1."""
    if np.isfinite(factor).any():
        return int(np.argmin(np.where(np.isnan(factor), np.inf, factor)))
    known = np.nan_to_num(severity, nan=0.0, posinf=np.inf)
    return int(np.argmax(known)) if known.any() else -1


def worse_with_pedestal(answers: Answers, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, BodyVerdict]]:
    """Yield, for each body assessed with and without its pedestal, its name and the worse of the verdicts."""
    whole = answers.summary["pedestal_of"].values.tolist()
    for alone in dict.fromkeys(filter(None, whole)):
        screens = [one for one in found if alone in (one.body.block, whole[one.body.place])]
        if len({one.body.block for one in screens}) > 1:
            yield alone, max(screens, key=lambda one: (one.grade, one.share.value))


def slides_first(answers: Answers) -> np.ndarray:
    """Return a mask (bodies,): True if the friction of a body is less than the acceleration [g] that lifts it.

    False for a body without friction, or with ties, loads or thrusts, whose forces on the base are unknown.
    """
    needed = answers.summary["uplift_acceleration"].values / answers.summary["gravity"].values
    found = answers.summary["friction"].values < needed * (1.0 - ROUNDING)
    found &= answers.summary["restraints"].values.astype(str) == ""
    return np.asarray(found[[body.place for body in answers.bodies]])


def _sliding(answers: Answers, demand: str | None, kept: np.ndarray) -> np.ndarray:
    """Return, for each body, the largest share of a motion in `kept` that requires more friction than the body has."""
    if np.isnan(answers.summary["friction"].values).all() or answers.motions.kind == "sequence":
        return np.full(kept.shape[1], np.nan)
    shares = answers["sliding_share"] if demand is None else answers.of_demand("demand_sliding_share", demand)
    most = np.fmax.reduce(answers.motions.over(shares, np.nan), axis=1)
    return np.asarray(np.fmax.reduce(np.where(kept, most, np.nan), axis=0, initial=np.nan))


class TieFinding(NamedTuple):
    """The results for one tie under all records at a demand, for the nominal body by the nonlinear model."""

    body: Body
    demand: str
    deciding: bool  #: whether the demand determines the verdict on the body
    number: int  #: number of the tie, from 1
    tie: Tie
    motions: int  #: number of counted motions
    elongation: float  #: largest elongation under the records that do not overturn the body [m]; NaN without any
    force: float  #: largest force under all counted records [N]
    yielded: int  #: number of motions under which the force reaches the yield force
    broken: int  #: number of motions under which the tie breaks
    governing: int  #: row of the record with the largest elongation in /summary; -1 if the tie never acts

    @property
    def share(self) -> float:
        """Largest elongation divided by the ultimate elongation [-]; NaN if the tie has no ultimate elongation."""
        return self.elongation / self.tie.ultimate if math.isfinite(self.tie.ultimate) else math.nan


def tie_findings(answers: Answers, found: Sequence[BodyVerdict]) -> list[TieFinding]:
    """Return the results for every tie at every demand of the site; empty without ties or demands."""
    if "demand_tie_elongation" not in answers.summary or not answers.motions.names:
        return []
    motions, rows = answers.motions, []
    for demand in answers.demands:
        left_out = too_far(answers, demand) | weak(answers, demand)[:, np.newaxis]
        kept = motions.kept(left_out)
        tables = [answers.of_demand(f"demand_tie_{name}", demand) for name in ("elongation", "force", "state")]
        for lane, verdict in enumerate(found):
            text = str(answers.summary["restraints"].values[verdict.body.place])
            held = Restraints.from_text(text)
            for place, tie in enumerate(held.ties if held else ()):
                elongation, force, state = (np.where(left_out[:, lane], -1.0, one[:, lane, place]) for one in tables)
                alive = np.where(np.isfinite(elongation) & (state >= 0), elongation, -1.0)
                hits = (force >= tie.yield_force, state == TieState.BROKEN)
                yielded, broken = (int((motions.in_any_direction(hit) & kept[:, lane]).sum()) for hit in hits)
                most = float(alive.max())
                finding = TieFinding(
                    body=verdict.body,
                    demand=demand,
                    deciding=demand == verdict.deciding.demand,
                    number=place + 1,
                    tie=tie,
                    motions=int(kept[:, lane].sum()),
                    elongation=math.nan if most < 0.0 else most,
                    force=float(np.nanmax(np.maximum(force, 0.0), initial=0.0)),
                    yielded=yielded,
                    broken=broken,
                    governing=int(alive.argmax()) if most > 0.0 else -1,
                )
                rows.append(finding)
    return rows
