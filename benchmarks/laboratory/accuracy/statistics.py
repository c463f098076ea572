"""Error statistics for a chaotic problem: quantiles of the error and changed outcomes compared with a reference.

.. note:: Errors are abs(theta_max/alpha_c - reference) for the cases that survive in both. A verdict is the
   :class:`Outcome`, and a flip is a verdict that differs from that of the reference. Near overturning a result is not
   meaningful beyond the change of the reference when its input changes in the 13th digit. This change is given beside
   the errors.

   Results and reference have a row for each case with `peak` (theta_max/alpha_c [-]) and `outcome` (name of an
   Outcome), and a common index. `spread` of the reference is the larger change of the peak under its stored
   perturbations [-]: 0 if the block overturns in all cases, inf if a verdict flips.
"""

import time
from collections.abc import Callable

import numpy as np
import pandas as pd

from laboratory.accuracy.reference import SYNTHETIC
from rocking.response import Outcome, Response

#: A case is well conditioned where the reference moves by less than this under the stored perturbations [-].
WELL_CONDITIONED = 1e-10
#: Smaller errors are rounding, of which no order of convergence can be read [-].
ROUNDING = 1e-13
#: Restitution of the synthetic grid that is summed up by itself [-].
GRID_RESTITUTION = 0.9
PERCENTILES = {"median": 50.0, "p90": 90.0, "p99": 99.0, "max": 100.0}


def timed(call: Callable[[], list[Response]], repeats: int) -> tuple[list[Response], float]:
    """The responses of a call, and the median time of `repeats` calls after one that is not counted [s]."""
    responses, seconds = call(), []
    for _ in range(repeats):
        start = time.perf_counter()
        responses = call()
        seconds.append(time.perf_counter() - start)
    return responses, float(np.median(seconds))


def active_samples(responses: list[Response]) -> int:
    """Number of samples in which the blocks move."""
    return sum(int(np.sum(np.asarray(one.active_samples))) for one in responses)


def answer_errors(answers: pd.DataFrame, reference: pd.DataFrame) -> pd.Series:
    """abs(peak - reference) [-] of each case where both survive, else NaN."""
    both = np.isfinite(answers["peak"]) & np.isfinite(reference["peak"])
    return (answers["peak"].where(both) - reference["peak"].where(both)).abs()


def reference_under_perturbation(reference: pd.DataFrame) -> dict[str, float]:
    """The numbers of :func:`error_statistics` for the reference itself under its stored perturbations of 1e-13.

    An answer that is no worse is as good as the problem allows in double precision.
    """
    steady = np.isfinite(reference["spread"])
    survives = steady & np.isfinite(reference["peak"])
    return _statistics(reference, reference["spread"].where(survives), flips=int((~steady).sum()), unresolved=0)


def error_statistics(answers: pd.DataFrame, reference: pd.DataFrame) -> dict[str, float]:
    """Verdict flips, and quantiles of the error of theta_max/alpha_c.

    Returns
    -------
    dict of str to float
        `cases`; `unresolved` answers; `flips`, other verdicts than the reference's, the unresolved ones included;
        `reference_flips`, cases whose verdict flips in the reference itself; `well_conditioned`, the share of cases
        whose spread is below 1e-10 [-]; `compared`, cases in which both survive, with `median`, `p90`, `p99`, `max`
        of their errors [-]; and the same names with `_well` for those of them that are well conditioned. NaN where
        there are none.
    """
    return _statistics(
        reference,
        answer_errors(answers, reference),
        flips=int((answers["outcome"] != reference["outcome"]).sum()),
        unresolved=int((answers["outcome"] == Outcome.UNRESOLVED.name).sum()),
    )


def grid_statistics(answers: pd.DataFrame, reference: pd.DataFrame, step: float) -> pd.DataFrame:
    """The kernels at one step (p dt [-]) on the synthetic grid, C = 0.9, beside the effect of 1e-13 on the reference.

    The answers are those of :class:`~laboratory.accuracy.work_precision.WorkPrecision`, the reference has all
    cases.

    Returns
    -------
    DataFrame
        One row per equation: `restitution`, `step`, `cases`, `compared`, `median`, `p99`, `flips` as in
        :func:`error_statistics`, and `reference_p99`, `reference_flips`, those of :func:`reference_under_perturbation`.
        No row for an equation without such a case or without answers at this step.
    """
    kernel = answers[(answers["method"] == "rockpulse") & (answers["call"] == "lanes") & (answers["setting"] == step)]
    on_grid = reference["motion"].str.startswith(SYNTHETIC) & (reference["restitution"] == GRID_RESTITUTION)
    rows = []
    for equation, cases in reference[on_grid].groupby("equation", sort=False):
        given = kernel[kernel["equation"] == equation].set_index("case")
        if given.empty:
            continue
        found = error_statistics(given.loc[cases["case"]].set_axis(cases.index), cases)
        itself = reference_under_perturbation(cases)
        rows.append(
            {
                "equation": equation,
                "restitution": GRID_RESTITUTION,
                "step": step,
                **{name: found[name] for name in ("cases", "compared", "median", "p99", "flips")},
                "reference_p99": itself["p99"],
                "reference_flips": itself["flips"],
            }
        )
    return pd.DataFrame(rows)


def observed_order(coarse: pd.DataFrame, fine: pd.DataFrame) -> tuple[float, int]:
    """Order of convergence between two settings of a step, and the number of cases behind it.

    Both tables have `error` [-] and `step`, the step that was really taken, of the same cases. The order is the median
    of log(error ratio)/log(step ratio) [-] over the cases with different steps and both errors above rounding (1e-13);
    NaN without any case.
    """
    usable = (coarse["error"] > ROUNDING) & (fine["error"] > ROUNDING) & (coarse["step"] > 1.01 * fine["step"])
    if not usable.any():
        return float("nan"), 0
    ratio = coarse[usable] / fine[usable]
    order = np.log(ratio["error"].to_numpy()) / np.log(ratio["step"].to_numpy())
    return float(np.median(order)), int(usable.sum())


def _statistics(reference: pd.DataFrame, error: pd.Series, flips: int, unresolved: int) -> dict[str, float]:
    well_conditioned = reference["spread"] < WELL_CONDITIONED
    compared, well = error.notna(), error.notna() & well_conditioned
    return {
        "cases": len(reference),
        "unresolved": unresolved,
        "flips": flips,
        "reference_flips": int(np.isinf(reference["spread"]).sum()),
        "well_conditioned": float(well_conditioned.mean()),
        "compared": int(compared.sum()),
        **_percentiles(error[compared], ""),
        "compared_well": int(well.sum()),
        **_percentiles(error[well], "_well"),
    }


def _percentiles(errors: pd.Series, suffix: str) -> dict[str, float]:
    if errors.empty:
        return {name + suffix: float("nan") for name in PERCENTILES}
    values = np.percentile(errors, list(PERCENTILES.values()))
    return {name + suffix: float(value) for name, value in zip(PERCENTILES, values, strict=True)}
