"""The rule fitted on an ensemble, and judged on it beside p PGV/(g tan alpha) by the same protocol.

.. note:: Left out: the limits that a case is judged by are fitted without its earthquake, for the rule and for p
   PGV/(g tan alpha) alike. A left-out score is the score over the balanced limit fitted without its earthquake. Without
   uplift nothing overturns: neither score raises an alarm there; p PGV without that condition is judged as well.
   Intervals: earthquakes are resampled and the limits fitted anew in each resample, all copies of an earthquake left
   out together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from rockpulse.calibration.rule import POINTS, Rule
from rockpulse.errors import ConfigError
from rockpulse.failures import Failure
from rockpulse.storage.rule_variables import RULE_KIND, RULE_TABLES
from rockpulse.studies.rule.cases import TRUTH, fitted_range
from rockpulse.studies.rule.statistics import (
    RESAMPLES,
    Resampled,
    area,
    curve,
    false_at,
    left_out,
    limit,
    missed_bound,
    over_limit,
    resampled,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FEWEST_EVENTS", "FEWEST_OVERTURNINGS", "fit_rules", "judge_rules", "too_few"]

#: An ensemble that a rule is fitted on or judged by has at least so many earthquakes with overturnings, and so many
#: overturnings in all: 5 % of 20 is one.
FEWEST_EVENTS, FEWEST_OVERTURNINGS = 4, 20

#: Factors are whole multiples of this [-].
FACTOR_STEP = 1e-5

#: The rule's measure, the one that it is compared with, and that one with alarms even where nothing lifts.
SCORES = ("march", "velocity_ratio", "velocity_alone")

#: Kinds of comparison: the scores as they are, and over the limits fitted without the earthquake.
KINDS = ("in-sample", "left-out")

#: Missed shares at which false alarms are compared [-].
MISSED_SHARES = (0.0, 0.01, 0.05, 0.1)

#: Smaller nonlinear peaks are left out of bias and dispersion, as theta_max/alpha_c [-].
SMALLEST_PEAK = 0.05


def too_few(cases: pd.DataFrame) -> str:
    """The reason why an ensemble, as :func:`rule_cases` gives it, is too small; empty if it is not."""
    over = cases["overturns"].to_numpy(dtype=bool)
    events, fallen = cases["event"].nunique(), cases["event"][over].nunique()
    if fallen >= FEWEST_EVENTS and over.sum() >= FEWEST_OVERTURNINGS and not over.all():
        return ""
    return (
        f"{_several(cases['record'].nunique(), 'strong channel')} of {_several(events, 'earthquake')}, "
        f"{int(over.sum())} of {_several(over.size, 'case')} {'overturns' if over.sum() == 1 else 'overturn'}, in "
        f"{_several(fallen, 'earthquake')}: a rule is fitted and judged on at least {FEWEST_OVERTURNINGS} "
        f"overturnings in {FEWEST_EVENTS} earthquakes, and some that survive; add records"
    )


def _several(count: int, word: str) -> str:
    return f"{count} {word}{'' if count == 1 else 's'}"


def fit_rules(cases: pd.DataFrame) -> dict[str, Rule]:
    """The rule at each of its working points, where it misses no more than the stated share of overturnings.

    The points are :data:`rockpulse.calibration.rule.POINTS`, the cases those of
    :func:`~rockpulse.studies.rule.cases.rule_cases`. Raises ConfigError where they are :func:`too_few`.
    """
    if reason := too_few(cases):
        raise ConfigError(f"rule fit: {reason}")
    fallen = cases.loc[cases["overturns"], "march"].to_numpy()
    # Rounded up, so that the case at the limit keeps its alarm.
    return {
        point: Rule(point, float(np.ceil(1.0 / limit(fallen, share) / FACTOR_STEP) * FACTOR_STEP), fitted_range())
        for point, share in POINTS.items()
    }


def judge_rules(
    cases: pd.DataFrame,
    given: Mapping[str, Rule],
    failures: Sequence[Failure] = (),
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> xr.DataTree:
    """Judge how well the rule predicts the nonlinear verdict, in-sample, left out and as given.

    The cases are those of :func:`~rockpulse.studies.rule.cases.rule_cases`; `given` is a stored rule, by working point;
    `seed` and `resamples` are those of the bootstrap. The tree has one node per table of
    :data:`rockpulse.storage.rule_variables.RULE_TABLES`, the failures among them. For an ensemble that is too small all
    but the cases are empty, and the attribute `statement` says why.
    """
    import xarray as xr

    statement = too_few(cases)
    tables: dict[str, pd.DataFrame] = {} if statement else _tables(cases, given, seed, resamples)
    tables["failures"] = pd.DataFrame([asdict(row) for row in failures])
    tree = xr.DataTree.from_dict(
        {
            f"/{name}": _dataset(name, tables.get(name, cases if name == "cases" else pd.DataFrame()))
            for name in RULE_TABLES
        }
    )
    tree.attrs["kind"] = RULE_KIND
    tree.attrs["title"] = "Verdicts of the rule beside p PGV/(g tan alpha), against the nonlinear model"
    tree.attrs["statement"] = statement
    tree.attrs["rule"] = ", ".join(f"{point}: factor {rule.factor:.6g}" for point, rule in given.items())
    tree.attrs["channels"] = int(cases["record"].nunique())
    tree.attrs["earthquakes"] = int(cases["event"].nunique())
    tree.attrs["seed"] = seed
    return tree


#: score, kind, point.
_Key = tuple[str, str, str]


def _tables(cases: pd.DataFrame, given: Mapping[str, Rule], seed: int, resamples: int) -> dict[str, pd.DataFrame]:
    over = cases["overturns"].to_numpy(dtype=bool)
    events = np.unique(cases["event"].to_numpy(dtype=str), return_inverse=True)[1]
    lifted = cases["uplift_ratio"].to_numpy(dtype=float) > 1.0
    march, velocity = (cases[name].to_numpy(dtype=float) for name in SCORES[:2])
    scores = dict(zip(SCORES, (np.where(lifted, march, 0.0), np.where(lifted, velocity, 0.0), velocity), strict=True))

    def drawn_statistics(drawn: np.ndarray) -> dict[tuple[Any, ...], float]:
        part = {score: values[drawn] for score, values in scores.items()}
        return _statistics(_margins(part, over[drawn], events[drawn], given), over[drawn])

    margins = _margins(scores, over, events, given)
    measured, spread = _statistics(margins, over), resampled(events, over, drawn_statistics, seed, resamples)
    truths = [cases[name].to_numpy(dtype=bool) for name in cases if str(name).startswith(TRUTH)]
    perturbed = [measured, *(_statistics(_margins(scores, truth, events, given), truth) for truth in truths)]
    return {
        "rates": pd.DataFrame([_rates(key, margin, cases, spread, perturbed) for key, margin in margins.items()]),
        "at_missed": pd.DataFrame(
            [
                {"kind": kind, "missed_share": share, **_compared(("false_at", kind, share), measured, spread)}
                for kind in KINDS
                for share in MISSED_SHARES
            ]
        ),
        "areas": pd.DataFrame([{"kind": kind, **_compared(("area", kind), measured, spread)} for kind in KINDS]),
        "curves": pd.concat(
            [_curve(score, kind, margins[score, kind, "balanced"], over) for kind in KINDS for score in SCORES],
            ignore_index=True,
        ),
        "cases": cases.assign(
            left_out_march=margins["march", "left-out", "balanced"],
            left_out_velocity_ratio=margins["velocity_ratio", "left-out", "balanced"],
            flips=np.sum([truth != over for truth in truths], axis=0, dtype=int) if truths else 0,
            **{point: margins["march", "left-out", point] >= 1.0 for point in POINTS},
        ),
    }


def _margins(
    scores: Mapping[str, np.ndarray], over: np.ndarray, events: np.ndarray, given: Mapping[str, Rule]
) -> dict[_Key, np.ndarray]:
    """Score over limit: an alarm at 1 and above, NaN where an overturning of score 0 makes the limit 0."""
    margins = {}
    for score, values in scores.items():
        for point, share in POINTS.items():
            margins[score, "in-sample", point] = over_limit(values, limit(values[over], share))
            margins[score, "left-out", point] = left_out(values, over, events, share)
    for point, rule in given.items():
        margins["march", "as-given", point] = rule.factor * scores["march"]
    return margins


def _statistics(margins: Mapping[_Key, np.ndarray], over: np.ndarray) -> dict[tuple[Any, ...], float]:
    """Rates, areas, and false alarms at missed shares; NaN where a margin is NaN."""
    found: dict[tuple[Any, ...], float] = {}
    for key, margin in margins.items():
        known = not np.isnan(margin).any()
        found["missed", *key] = float(np.mean(margin[over] < 1.0)) if known else np.nan
        found["false", *key] = float(np.mean(margin[~over] >= 1.0)) if known else np.nan
    for kind in KINDS:
        for score in SCORES:
            margin = margins[score, kind, "balanced"]
            known = not np.isnan(margin).any()
            found["area", kind, score] = area(margin, over) if known else np.nan
            for share in MISSED_SHARES:
                found["false_at", kind, share, score] = false_at(margin, over, share) if known else np.nan
    return found


def _compared(
    key: tuple[Any, ...], measured: Mapping[tuple[Any, ...], float], spread: Mapping[tuple[Any, ...], Resampled]
) -> dict[str, float]:
    """A statistic of each score, and its differences between the rule and the others, with intervals."""
    row = {score: measured[*key, score] for score in SCORES}
    for score, name in (("velocity_ratio", "difference"), ("velocity_alone", "difference_alone")):
        row[name] = row["march"] - row[score]
        row[f"{name}_low"], row[f"{name}_high"] = (spread[*key, "march"] - spread[*key, score]).between()
    return row


def _rates(
    key: _Key,
    margin: np.ndarray,
    cases: pd.DataFrame,
    spread: Mapping[tuple[Any, ...], Resampled],
    perturbed: Sequence[Mapping[tuple[Any, ...], float]],
) -> dict[str, Any]:
    score, kind, point = key
    over, alarm = cases["overturns"].to_numpy(dtype=bool), margin >= 1.0
    missed, false = int(np.sum(over & ~alarm)), int(np.sum(~over & alarm))
    row = {
        "score": score,
        "kind": kind,
        "point": point,
        "overturnings": int(over.sum()),
        "survivors": int(np.sum(~over)),
        "missed": missed,
        "false": false,
        "missed_bound": missed_bound(missed, int(over.sum())),
        "missed_bound_clustered": spread["missed", *key].below(),
    }
    for name, count, cases_of in (("missed", missed, over), ("false", false, ~over)):
        row[f"{name}_share"] = count / np.sum(cases_of)
        row[f"{name}_low"], row[f"{name}_high"] = spread[name, *key].between()
        among = [one[name, *key] for one in perturbed]
        # NaN where one of the truths has no limit: the range is not known.
        row[f"{name}_least"], row[f"{name}_most"] = float(np.min(among)), float(np.max(among))
    if score == "march":
        return row | _peaks(margin, cases, over | alarm)
    rule = ("false", "march", kind, point)
    low, high = (spread[rule] - spread["false", *key]).between()
    difference = perturbed[0][rule] - perturbed[0]["false", *key]
    return row | {"false_difference": difference, "false_difference_low": low, "false_difference_high": high}


def _peaks(margin: np.ndarray, cases: pd.DataFrame, called: np.ndarray) -> dict[str, Any]:
    """The sequence's peaks 1 - sqrt(1 - D^2) against the nonlinear ones; bodies that do not lift are left out."""
    truth = cases["peak"].to_numpy(dtype=float)
    moving = ~called & (truth > SMALLEST_PEAK)
    demand = margin[moving]
    ratio = demand**2 / (1.0 + np.sqrt(1.0 - demand**2)) / truth[moving]
    return {
        "peaks": ratio.size,
        "peak_bias": float(np.median(ratio)) if ratio.size else np.nan,
        "peak_dispersion": float(np.std(np.log(ratio), ddof=1)) if ratio.size > 1 else np.nan,
    }


def _curve(score: str, kind: str, margin: np.ndarray, over: np.ndarray) -> pd.DataFrame:
    missed, false = curve(margin, over)
    return pd.DataFrame({"score": score, "kind": kind, "missed_share": missed, "false_share": false})


def _dataset(name: str, table: pd.DataFrame) -> xr.Dataset:
    """A table with all its columns; missing values are NaN, -1 for integers and flags, empty for texts."""
    import xarray as xr

    return xr.Dataset(
        {
            column: one.variable(
                table[column].fillna(one.absent) if column in table else np.full(len(table), one.absent)
            )
            for column, one in RULE_TABLES[name].items()
        }
    )
