"""Work and precision: run time of the models under a record, and their error compared with the stored reference.

.. note:: A case is one block, motion and scale factor. In an active sample the block moves, that is, it is neither at
   rest nor overturned. "lanes": a call of the kernel takes all blocks and scale factors of a motion, as an assessment
   does; the cases are among them. "single": one call for each of the cases that solve_ivp computes too, including the
   cost of the call itself.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from laboratory.accuracy.statistics import (
    active_samples,
    answer_errors,
    error_statistics,
    reference_under_perturbation,
    timed,
)
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.studies.selftest.baseline import baseline_response

#: Longest step of the kernels, as p dt [-]; a sample that is shorter is one step.
STEPS = (0.02, 0.04, 0.08, 0.16, 0.3)
#: That of :func:`recorded_response` unless asked otherwise.
DEFAULT_STEP = 0.08
#: Methods of ``scipy.integrate.solve_ivp`` with their relative tolerances [-].
TOLERANCES = (("RK45", 1e-3), ("RK45", 1e-6), ("RK45", 1e-9), ("DOP853", 1e-12))
#: The method to whose cost all others are compared: the solver that a user would write.
BASELINE = ("RK45", 1e-6)
#: Whole calls whose median is the cost of a kernel, after one that is not counted.
REPEATS = 5
#: From a row of the reference to its ground acceleration (n,) [m/s2] and sampling interval [s].
Ground = Callable[[Any], tuple[np.ndarray, float]]
KERNEL, PERTURBED = "rockpulse", "reference"
LANES, SINGLE = "lanes", "single"


@dataclass(frozen=True)
class Method:
    """A solver and its setting."""

    equation: Any  # "linear" or "nonlinear"
    name: str  # "rockpulse", or a method of ``scipy.integrate.solve_ivp``
    setting: float  # longest step as p dt [-], or relative tolerance [-]
    call: str  # "lanes": all cases with many lanes in a call; "single": the shared ones with one call each

    @property
    def option(self) -> str:
        """The name of the option that the setting stands for."""
        return "step" if self.name == KERNEL else "rtol"


@dataclass(frozen=True, eq=False)
class WorkPrecision:
    """The measured costs and errors.

    Attributes
    ----------
    rows : DataFrame
        One row per method: the numbers of ``error_statistics`` beside `lanes`,
        `active_samples` and `samples` (blocks times samples) of the whole work, `seconds`, `ns_per_active_sample`,
        `ns_per_sample`, and `times_faster`, the nanoseconds per active sample of RK45 at 1e-6 over those of this row.
        Rows of method "reference" hold the effect of the stored perturbations on the reference itself.
    answers : DataFrame
        One row per method and case: `equation`, `method`, `option`, `setting`, `call`, `case`, `peak`, `outcome`,
        `error` [-].
    """

    rows: pd.DataFrame
    answers: pd.DataFrame


class _Group(NamedTuple):
    """One call of the kernel: blocks and factors of one motion, and the places of the cases among the lanes."""

    block: Block
    scales: np.ndarray
    acceleration: np.ndarray
    dt: float
    cases: pd.Index
    place: tuple[np.ndarray, np.ndarray]


def shared_cases(reference: pd.DataFrame, count: int) -> pd.DataFrame:
    """The cases that solve_ivp computes as well: of each equation one that overturns for every two that rock.

    There are `count` of each equation, or fewer, evenly spread in the order of the table.
    """
    over = count // 3
    chosen = []
    for _, cases in reference.groupby("equation", sort=False):
        for outcome, wanted in ((Outcome.ROCKS, count - over), (Outcome.OVERTURNS, over)):
            members = cases[cases["outcome"] == outcome.name]
            chosen.append(members.iloc[evenly_spread(len(members), wanted)])
    return pd.concat(chosen)


def evenly_spread(length: int, count: int) -> np.ndarray:
    """At most `count` places among `length`, evenly spread, each in the middle of its share."""
    count = min(length, count)
    return ((np.arange(count) + 0.5) * length / max(count, 1)).astype(int)


def work_precision(
    reference: pd.DataFrame,
    ground: Ground,
    shared: pd.DataFrame,
    steps: Sequence[float] = STEPS,
    tolerances: Sequence[tuple[str, float]] = TOLERANCES,
    repeats: int = REPEATS,
) -> WorkPrecision:
    """Error and cost of every recorded model and setting, and of solve_ivp, against the reference.

    `ground` gives the acceleration (n,) [m/s2] and sampling interval [s] for a row of the reference; `shared` are the
    rows that solve_ivp computes too (:func:`shared_cases`); `steps` are the longest steps of the kernels, as p dt [-];
    `tolerances` are methods of solve_ivp with relative tolerances [-]; the cost of a kernel is the median of `repeats`
    whole calls.
    """
    methods = []
    for equation in reference["equation"].unique():
        methods += [Method(equation, KERNEL, step, LANES) for step in steps]
        methods.append(Method(equation, KERNEL, DEFAULT_STEP, SINGLE))
        methods += [Method(equation, name, rtol, SINGLE) for name, rtol in tolerances]
    rows = [_perturbed_row(equation, cases) for equation, cases in reference.groupby("equation", sort=False)]
    answers = []
    for method in methods:
        frame = reference if method.call == LANES else shared
        cases = frame[frame["equation"] == method.equation]
        answer, cost = _measured(method, cases, ground, repeats)
        head = {
            "equation": method.equation,
            "method": method.name,
            "option": method.option,
            "setting": method.setting,
            "call": method.call,
        }
        rows.append({**head, **error_statistics(answer, cases), **cost})
        described = pd.DataFrame(head, index=cases.index)
        answers.append(described.join(answer).assign(case=cases["case"], error=answer_errors(answer, cases)))
    return WorkPrecision(_with_ratios(pd.DataFrame(rows)), pd.concat(answers, ignore_index=True))


def _measured(
    method: Method, cases: pd.DataFrame, ground: Ground, repeats: int
) -> tuple[pd.DataFrame, dict[str, float]]:
    """Answers of one method, and their cost."""
    if method.name != KERNEL:
        return _by_solve_ivp(method, cases, ground)
    groups = _groups(cases, ground, method.call == SINGLE)

    def call() -> list[Any]:
        return [
            recorded_response(
                group.block,
                group.acceleration,
                group.dt,
                equation=method.equation,
                scale=group.scales,
                step=method.setting,
                threads=1,
            )
            for group in groups
        ]

    responses, seconds = timed(call, repeats)
    names = np.array([outcome.name for outcome in Outcome])
    answers = [
        pd.DataFrame(
            {"peak": found.peak_rotation_ratio[group.place], "outcome": names[found.outcome[group.place]]}, group.cases
        )
        for group, found in zip(groups, responses, strict=True)
    ]
    lanes = [found.outcome.size for found in responses]
    cost = {
        "lanes": sum(lanes),
        "active_samples": active_samples(responses),
        "samples": sum(count * group.acceleration.size for count, group in zip(lanes, groups, strict=True)),
        "seconds": seconds,
    }
    return pd.concat(answers).loc[cases.index], cost


def _by_solve_ivp(method: Method, cases: pd.DataFrame, ground: Ground) -> tuple[pd.DataFrame, dict[str, float]]:
    answers, seconds, active, samples = [], 0.0, 0, 0
    row: Any
    for row in cases.itertuples():
        acceleration, dt = ground(row)
        start = time.perf_counter()
        found = baseline_response(
            row.p,
            row.alpha,
            row.restitution,
            acceleration,
            dt,
            equation=method.equation,
            scale=row.scale,
            gravity=row.gravity,
            method=method.name,
            rtol=method.setting,
            # Hops of half a hundredth of the tolerance are given up: they cost more than they are worth at it.
            rest_speed=0.1 * math.sqrt(method.setting),
        )
        seconds += time.perf_counter() - start
        active += found.active_samples
        samples += acceleration.size
        answers.append({"peak": found.peak_rotation_ratio, "outcome": found.outcome})
    cost = {"lanes": len(cases), "active_samples": active, "samples": samples, "seconds": seconds}
    return pd.DataFrame(answers, cases.index), cost


def _groups(cases: pd.DataFrame, ground: Ground, single: bool) -> list[_Group]:
    """The calls that answer some cases: one each, or one per motion with all its blocks under all its factors."""
    keys = ["case"] if single else ["motion", "dt", "gravity"]
    groups = []
    for _, members in cases.groupby(keys, sort=False):
        acceleration, dt = ground(next(members.itertuples()))
        block = Block.from_parameters(
            members["p"].to_numpy(),
            members["alpha"].to_numpy(),
            members["restitution"].to_numpy(),
            gravity=float(members["gravity"].iloc[0]),
            log=False,
        )
        scales, place = np.unique(members["scale"], return_inverse=True)
        groups.append(_Group(block, scales, acceleration, dt, members.index, (place, np.arange(len(members)))))
    return groups


def _perturbed_row(equation: Any, cases: pd.DataFrame) -> dict[str, Any]:
    head = {"equation": equation, "method": PERTURBED, "option": "perturbation", "setting": 1e-13, "call": LANES}
    nothing = {"lanes": 0, "active_samples": 0, "samples": 0, "seconds": np.nan}
    return {**head, **reference_under_perturbation(cases), **nothing}


def _with_ratios(rows: pd.DataFrame) -> pd.DataFrame:
    """The rows with costs per sample, and how many times faster each is than the baseline on the same equation."""
    for kind, column in (("active_samples", "ns_per_active_sample"), ("samples", "ns_per_sample")):
        rows[column] = 1e9 * rows["seconds"] / rows[kind]
    name, rtol = BASELINE
    baseline = rows[(rows["method"] == name) & (rows["setting"] == rtol)].set_index("equation")["ns_per_active_sample"]
    rows["times_faster"] = rows["equation"].map(baseline) / rows["ns_per_active_sample"]
    return rows
