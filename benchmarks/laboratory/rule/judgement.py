"""Fit of the rule to nonlinear capacities, and its test against other measures by the same protocol.

.. note:: Each measure and target has one coefficient: the most likely centre of ln(measure x capacity), with equal
   weights of earthquakes. Capacities that were not reached are known only from below. "Left out" means that the
   coefficient of a case is fitted without its earthquake. Without uplift no body overturns, so no measure gives an
   alarm there. The best possible measure is the probability of overturning by the nonlinear equation under the same
   uncertainty.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from laboratory.ensemble import StrongMotion, blocks
from laboratory.rule.measures import MEASURES, other_measures
from laboratory.rule.statistics import (
    RESAMPLES,
    alike,
    between,
    coefficient,
    dispersion,
    false_at,
    missed_and_false,
    resampled,
    weighted_median,
)
from laboratory.rule.truth import FACTOR_MAX, nonlinear_capacity
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rocking.spectrum.half_waves import demand_of_half_waves
from rockpulse.record.half_wave import half_waves
from rockpulse.sequences.rule import POINTS, Rule, traits

#: An ensemble that a rule is fitted on or judged by has at least so many earthquakes with capacities that are reached,
#: and so many of these in all.
FEWEST_EVENTS, FEWEST_CASES = 4, 20
#: Missed shares at which false alarms are compared [-].
MISSED_SHARES = (0.01, 0.05)
#: The score that tells the limit, beside the measures.
LIMIT = "limit"
#: Scores that are verdicts as published: an alarm at 1 and above.
PUBLISHED = ("uplift_ratio", "ishiyama_ratio")
#: Factors on each record at which verdicts are compared [-], by name.
SCALES = {"half": 0.5, "one": 1.0}


def motion_cases(motion: StrongMotion) -> pd.DataFrame:
    """The cases of one motion, one row a body.

    Columns: record, event, source (the file of the record), slenderness, radius [m]; the demands [-] of
    :data:`laboratory.rule.measures.MEASURES`; the capacities of :func:`~laboratory.rule.truth.nonlinear_capacity`;
    `overturns_half` and `overturns_one`, the nonlinear verdicts at the factors :data:`SCALES` without uncertainty.
    Raises ValueError where a model refuses the numbers of the record.
    """
    bodies, record = blocks(), motion.record
    waves = half_waves(record)
    asked = demand_of_half_waves(bodies, waves.start, waves.centroid, waves.end, waves.impulse)
    verdict = recorded_response(bodies, record.acceleration, record.dt, scale=np.array(list(SCALES.values()))).outcome
    return pd.DataFrame(
        {
            "record": record.id,
            "event": motion.event,
            "source": record.source,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            "march": asked.march,
            "march_10": asked.march_10,
            **other_measures(bodies, record, waves),
            **nonlinear_capacity(bodies, record.acceleration, record.dt),
            **{
                f"overturns_{name}": (row == Outcome.OVERTURNS) | (row == Outcome.UNRESOLVED)
                for name, row in zip(SCALES, np.asarray(verdict), strict=True)
            },
        }
    )


def too_few(cases: pd.DataFrame) -> str:
    """The reason why an ensemble of :func:`motion_cases` is too small; empty if it is not."""
    reached = np.isfinite(cases["factor_mean"].to_numpy(dtype=float))
    within = cases["event"][reached].nunique()
    if within >= FEWEST_EVENTS and reached.sum() >= FEWEST_CASES:
        return ""
    return (
        f"{int(reached.sum())} of {reached.size} capacities are reached by a factor of {FACTOR_MAX:g}, in {within} "
        f"earthquakes; a rule is fitted and judged on at least {FEWEST_CASES} in {FEWEST_EVENTS} earthquakes"
    )


def fit_rules(cases: pd.DataFrame) -> dict[str, Rule]:
    """The rule at each of its working points, unbiased on the cases, with the range of their bodies."""
    within = {name: (float(values.min()), float(values.max())) for name, values in traits(blocks()).items()}
    return {
        point: Rule(point, float(np.exp(-coefficient(*_errors(cases, measure, target))[0])), within)
        for point, (measure, target) in POINTS.items()
    }


def judge_rules(
    cases: pd.DataFrame, given: Mapping[str, Rule], seed: int = 0, resamples: int = RESAMPLES
) -> dict[str, pd.DataFrame]:
    """How well the rule predicts nonlinear capacities and verdicts, left out and as given.

    The cases are those of :func:`motion_cases`, of several motions below each other; `given` is
    a stored rule, by working point; `seed` and `resamples` are those of the bootstrap. The tables are `capacities`
    (bias and scatter of every measure), `rates` (missed and false alarms), `at_missed` (false alarms at a missed
    share), each with intervals of 95 % over earthquakes, and `cases` with the demands of the rules fitted without the
    earthquake.
    """
    targets = [target for _, target in POINTS.values()]
    left_out = {(measure, target): _left_out(cases, measure, target) for target in targets for measure in MEASURES}
    own = {point: -left_out[of_point] for point, of_point in POINTS.items()}  # ln of the coefficient
    cases = cases.assign(
        **{f"left_out_{point}": cases[POINTS[point][0]] * np.exp(values) for point, values in own.items()}
    )
    capacities = [
        _capacity_row(cases, measure, target, centre, seed, resamples) for (measure, target), centre in left_out.items()
    ]
    for point, rule in given.items():
        of_given = np.full(len(cases), -np.log(rule.factor))
        capacities.append(_capacity_row(cases, *POINTS[point], of_given, seed, resamples, kind="as-given"))
    verdicts = _verdicts(cases)
    alarms = {(f"left_out_{point}", point, "left-out"): f"left_out_{point}" for point in POINTS}
    rows = []
    for point, rule in given.items():
        verdicts[f"given_{point}"] = rule.factor * verdicts[POINTS[point][0]]
        alarms[POINTS[point][0], point, "as-given"] = f"given_{point}"
    alarms |= {(score, "", "as published"): score for score in PUBLISHED}
    over, events = verdicts["overturns"].to_numpy(dtype=bool), verdicts["event"].to_numpy(dtype=str)
    lifted = verdicts["uplift_ratio"].to_numpy(dtype=float) > 1.0
    for (_, point, kind), column in alarms.items():
        alarm = lifted & (verdicts[column].to_numpy(dtype=float) >= 1.0)
        score = POINTS[point][0] if point else column
        rows.append({"score": score, "point": point, "kind": kind, **_rates(alarm, over, events, seed, resamples)})
    at_missed = []
    for score in (*MEASURES, LIMIT):
        values = np.where(lifted, verdicts[score].to_numpy(dtype=float), 0.0)
        for share in MISSED_SHARES:
            low, high = between(resampled(events, partial(_false_at, values, over, share), seed, resamples))
            row = {"score": score, "missed_share": share, "false_share": false_at(values, over, share)}
            at_missed.append(row | {"false_low": low, "false_high": high})
    return {
        "capacities": pd.DataFrame(capacities),
        "rates": pd.DataFrame(rows),
        "at_missed": pd.DataFrame(at_missed),
        "cases": cases,
    }


def _errors(cases: pd.DataFrame, measure: str, target: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """ln(measure x capacity) (n,), whether the capacity is known from below only, and the weight of each case."""
    capacity = cases[target].to_numpy(dtype=float)
    beyond = ~np.isfinite(capacity)
    censored = cases[f"{target}_low"].to_numpy(dtype=float) if f"{target}_low" in cases else FACTOR_MAX
    # A measure of 0 is a scale factor beyond the largest one.
    least = 1.0 / FACTOR_MAX if measure in ("single_ratio", "spectrum", "spectrum_10") else 1e-12
    demand = np.maximum(cases[measure].to_numpy(dtype=float), least)
    return np.log(demand * np.where(beyond, censored, capacity)), beyond, alike(cases["event"].to_numpy(dtype=str))


def _left_out(cases: pd.DataFrame, measure: str, target: str) -> np.ndarray:
    """Centre (n,) of ln(measure x capacity) on the cases of all other earthquakes."""
    errors = _errors(cases, measure, target)
    events = cases["event"].to_numpy(dtype=str)
    centre = np.empty(events.size)
    for event in np.unique(events):
        out = events == event
        centre[out] = coefficient(*(values[~out] for values in errors))[0]
    return centre


def _capacity_row(
    cases: pd.DataFrame,
    measure: str,
    target: str,
    centre: np.ndarray,
    seed: int,
    resamples: int,
    kind: str = "left-out",
) -> dict[str, Any]:
    """Bias and scatter of a measure with a coefficient of exp(-centre), on the capacities that are reached."""
    error, beyond, _ = _errors(cases, measure, target)
    known = ~beyond
    error, events = (error - centre)[known], cases["event"].to_numpy(dtype=str)[known]
    bodies = cases.groupby(["slenderness", "radius"]).ngroup().to_numpy()[known]
    weight = alike(events)
    spread = resampled(events, lambda drawn: dispersion(error[drawn], weight[drawn], bodies[drawn]), seed, resamples)
    biases = resampled(events, lambda drawn: weighted_median(error[drawn], weight[drawn]), seed, resamples)
    low, high = between(spread)
    bias_low, bias_high = between(biases)
    return {
        "measure": measure,
        "target": target,
        "kind": kind,
        "coefficient": float(np.exp(-np.median(centre))),
        # Predicted capacity over the nonlinear one.
        "bias": float(np.exp(-weighted_median(error, weight))),
        "bias_low": float(np.exp(-bias_high)),
        "bias_high": float(np.exp(-bias_low)),
        "dispersion": dispersion(error, weight),
        "within": dispersion(error, weight, bodies),
        "within_low": low,
        "within_high": high,
        "reached": int(known.sum()),
        "censored_share": float(np.mean(beyond)),
    }


def _verdicts(cases: pd.DataFrame) -> pd.DataFrame:
    """The cases at every factor of SCALES: demands times the factor, the nonlinear verdict and its probability."""
    demands = [*MEASURES, *(str(name) for name in cases if str(name).startswith("left_out_"))]
    frames = []
    for name, scale in SCALES.items():
        frame = scale * cases[demands]
        frame["event"], frame["overturns"] = cases["event"], cases[f"overturns_{name}"]
        frame[LIMIT] = cases[f"probability_{name}"]
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def _rates(alarm: np.ndarray, over: np.ndarray, events: np.ndarray, seed: int, resamples: int) -> dict[str, Any]:
    missed, false = missed_and_false(alarm, over)
    row = {
        "overturnings": int(over.sum()),
        "survivors": int(np.sum(~over)),
        "missed": int(np.sum(over & ~alarm)),
        "false": int(np.sum(~over & alarm)),
        "missed_share": missed,
        "false_share": false,
    }
    for place, name in enumerate(("missed", "false")):
        spread = resampled(events, partial(_rate, alarm, over, place), seed, resamples)
        row[f"{name}_low"], row[f"{name}_high"] = between(spread)
    return row


def _false_at(scores: np.ndarray, over: np.ndarray, share: float, drawn: np.ndarray) -> float:
    return false_at(scores[drawn], over[drawn], share)


def _rate(alarm: np.ndarray, over: np.ndarray, place: int, drawn: np.ndarray) -> float:
    return missed_and_false(alarm[drawn], over[drawn])[place]
