"""The rule fitted on an ensemble, and judged on it beside p PGV/(g tan alpha) by the same protocol.

.. note:: Left out: the limits that a case is judged by are fitted without its earthquake, for the rule and for p
   PGV/(g tan alpha) alike. A left-out score is the score over the balanced limit fitted without its earthquake.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from rockpulse.calibration.rule import POINTS, Rule
from rockpulse.calibration.rule_statistics import area, curve, false_at, limit, missed_bound, resampled, resampled_share
from rockpulse.calibration.rule_variables import RULE_KIND, RULE_TABLES
from rockpulse.errors import ConfigError
from rockpulse.failures import Failure

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FEWEST_EVENTS", "FEWEST_OVERTURNINGS", "fit_rules", "judge_rules", "too_few"]

#: An ensemble that a rule is fitted on or judged by has at least so many earthquakes with overturnings, and so many
#: overturnings in all: 5 % of 20 is one.
FEWEST_EVENTS, FEWEST_OVERTURNINGS = 4, 20

#: Factors are whole multiples of this [-].
FACTOR_STEP = 1e-5

#: The rule's measure, and the one that it is compared with.
SCORES = ("march", "velocity_ratio")

#: Missed shares at which false alarms are compared [-].
MISSED_SHARES = (0.0, 0.01, 0.05, 0.1)

#: Smaller nonlinear peaks are left out of bias and dispersion, as theta_max/alpha_c [-].
SMALLEST_PEAK = 0.05


def too_few(cases: pd.DataFrame) -> str:
    """Why an ensemble says nothing about a rule; empty where it is large enough.

    Parameters
    ----------
    cases : DataFrame
        As :func:`rockpulse.calibration.rule_cases.rule_cases` gives them.
    """
    over = cases["overturns"].to_numpy(dtype=bool)
    events, fallen = cases["event"].nunique(), cases["event"][over].nunique()
    if fallen >= FEWEST_EVENTS and over.sum() >= FEWEST_OVERTURNINGS and not over.all():
        return ""
    return (
        f"{cases['record'].nunique()} strong channels of {events} earthquakes, {int(over.sum())} of {over.size} cases "
        f"overturn, in {fallen} earthquakes: a rule is fitted and judged on at least {FEWEST_OVERTURNINGS} "
        f"overturnings in {FEWEST_EVENTS} earthquakes, and some that survive; add records"
    )


def fit_rules(cases: pd.DataFrame) -> dict[str, Rule]:
    """The rule's working points: each misses no more than its share of the overturnings.

    Parameters
    ----------
    cases : DataFrame
        As :func:`rockpulse.calibration.rule_cases.rule_cases` gives them.

    Returns
    -------
    dict of str to Rule
        By the names of :data:`rockpulse.calibration.rule.POINTS`.

    Raises
    ------
    ConfigError
        For an ensemble that is too small (:func:`too_few`).
    """
    if reason := too_few(cases):
        raise ConfigError(f"rule fit: {reason}")
    # Rounded up, so that the case at the limit keeps its alarm.
    return {
        point: Rule(point, np.ceil(1.0 / lowest / FACTOR_STEP) * FACTOR_STEP)
        for point, lowest in _limits(cases, "march").items()
    }


def judge_rules(
    cases: pd.DataFrame, given: Mapping[str, Rule], failures: Sequence[Failure] = (), seed: int = 0
) -> xr.DataTree:
    """How well the rule predicts the nonlinear verdict, in-sample, left out and as given.

    Parameters
    ----------
    cases : DataFrame
        As :func:`rockpulse.calibration.rule_cases.rule_cases` gives them.
    given : mapping of str to Rule
        A stored rule, by working point.
    failures : sequence of Failure
        What was left out, to be stored.
    seed : int
        Of the bootstrap.

    Returns
    -------
    xarray.DataTree
        One node per table of :data:`rockpulse.calibration.rule_variables.RULE_TABLES`. For an ensemble that is too
        small all but the cases are empty, and the attribute `statement` says why.
    """
    import xarray as xr

    statement = too_few(cases)
    tables: dict[str, pd.DataFrame] = {} if statement else _tables(cases, given, seed)
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


def _limits(cases: pd.DataFrame, score: str) -> dict[str, float]:
    fallen = cases.loc[cases["overturns"], score].to_numpy()
    return {point: limit(fallen, share) for point, share in POINTS.items()}


def _tables(cases: pd.DataFrame, given: Mapping[str, Rule], seed: int) -> dict[str, pd.DataFrame]:
    over, events = cases["overturns"].to_numpy(dtype=bool), cases["event"].to_numpy(dtype=str)
    # score over limit by (score, kind, point): an alarm at 1 and above.
    margins: dict[tuple[str, str, str], np.ndarray] = {}
    for score in SCORES:
        values = cases[score].to_numpy(dtype=float)
        for point, lowest in _limits(cases, score).items():
            margins[score, "in-sample", point] = values / lowest
            margins[score, "left-out", point] = np.empty(values.size)
        for event in np.unique(events):
            out = events == event
            for point, lowest in _limits(cases[~out], score).items():
                margins[score, "left-out", point][out] = values[out] / lowest
    for point, rule in given.items():
        margins["march", "as-given", point] = rule.factor * cases["march"].to_numpy(dtype=float)
    # Without uplift nothing overturns: part of the rule.
    for (score, _, _), margin in margins.items():
        if score == "march":
            np.minimum(margin, cases["uplift_ratio"], out=margin)
    compared = {
        kind: {score: margins[score, kind, "balanced"] for score in SCORES} for kind in ("in-sample", "left-out")
    }
    return {
        "rates": pd.DataFrame([_rates(key, margin, cases, over, events, seed) for key, margin in margins.items()]),
        "at_missed": pd.DataFrame(
            [
                _at_missed(kind, share, by, over, events, seed)
                for kind, by in compared.items()
                for share in MISSED_SHARES
            ]
        ),
        "areas": pd.DataFrame([_areas(kind, by, over, events, seed) for kind, by in compared.items()]),
        "curves": pd.concat(
            [_curve(score, kind, by[score], over) for kind, by in compared.items() for score in SCORES],
            ignore_index=True,
        ),
        "cases": cases.assign(
            left_out_march=compared["left-out"]["march"],
            left_out_velocity_ratio=compared["left-out"]["velocity_ratio"],
            **{point: margins["march", "left-out", point] >= 1.0 for point in POINTS},
        ),
    }


def _rates(
    key: tuple[str, str, str], margin: np.ndarray, cases: pd.DataFrame, over: np.ndarray, events: np.ndarray, seed: int
) -> dict[str, Any]:
    score, kind, point = key
    alarm = margin >= 1.0
    missed, false = int(np.sum(over & ~alarm)), int(np.sum(~over & alarm))
    missed_shares = resampled_share(events, over & ~alarm, over, seed)
    false_shares = resampled_share(events, ~over & alarm, ~over, seed)
    row = {
        "score": score,
        "kind": kind,
        "point": point,
        "overturnings": int(over.sum()),
        "survivors": int(np.sum(~over)),
        "missed": missed,
        "false": false,
        "missed_share": missed / over.sum(),
        "missed_bound": missed_bound(missed, int(over.sum())),
        "missed_bound_clustered": missed_shares.below(),
        "false_share": false / np.sum(~over),
    }
    row["missed_low"], row["missed_high"] = missed_shares.between()
    row["false_low"], row["false_high"] = false_shares.between()
    return row | _peaks(margin, cases, over | alarm) if score == "march" else row


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


def _at_missed(
    kind: str, share: float, by: Mapping[str, np.ndarray], over: np.ndarray, events: np.ndarray, seed: int
) -> dict[str, Any]:
    def difference(drawn: np.ndarray) -> float:
        march, velocity = (false_at(by[score][drawn], over[drawn], share) for score in SCORES)
        return march - velocity

    low, high = resampled(events, over, difference, seed).between()
    return {
        "kind": kind,
        "missed_share": share,
        **{score: false_at(by[score], over, share) for score in SCORES},
        "difference": difference(np.arange(over.size)),
        "difference_low": low,
        "difference_high": high,
    }


def _areas(kind: str, by: Mapping[str, np.ndarray], over: np.ndarray, events: np.ndarray, seed: int) -> dict[str, Any]:
    def difference(drawn: np.ndarray) -> float:
        march, velocity = (area(by[score][drawn], over[drawn]) for score in SCORES)
        return march - velocity

    low, high = resampled(events, over, difference, seed).between()
    areas = {score: area(by[score], over) for score in SCORES}
    return {"kind": kind, **areas, "difference_low": low, "difference_high": high}


def _curve(score: str, kind: str, margin: np.ndarray, over: np.ndarray) -> pd.DataFrame:
    missed, false = curve(margin, over)
    return pd.DataFrame({"score": score, "kind": kind, "missed_share": missed, "false_share": false})


def _dataset(name: str, table: pd.DataFrame) -> xr.Dataset:
    """A table with all its columns; what was not computed is NaN, -1 for integers and flags, empty for texts."""
    import xarray as xr

    columns: dict[str, Any] = {}
    for column, (kind, units, long_name) in RULE_TABLES[name].items():
        absent: Any = {float: np.nan, str: ""}.get(kind, -1)
        values = table[column].fillna(absent) if column in table else np.full(len(table), absent)
        stored = np.int8 if kind is bool else kind
        columns[column] = ("row", np.asarray(values, dtype=stored), {"units": units, "long_name": long_name})
    return xr.Dataset(columns)
