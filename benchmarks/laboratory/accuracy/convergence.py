"""Order of convergence of the nonlinear kernel, on a record so coarse that every step option divides its samples.

.. note:: The samples of real records are shorter than the longest step, and the kernel halves a step whose last Taylor
   term is too large. The step option then has no effect. Here this control is switched off and p dt is 0.3. The
   reference is the same kernel with steps of 0.01, whose own error is rounding.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from laboratory.accuracy.statistics import active_samples, observed_order, timed
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.response import Response
from synthetic import synthetic_motion

#: Steps per sample.
DIVISIONS = (1, 2, 3, 4, 6)
JUDGE = 30
#: Sampling interval [s] and p dt of the undivided sample; a hair below 0.3, so that rounding adds no step.
INTERVAL, LONGEST = 0.1, 0.3 * (1.0 - 1e-9)
#: Lanes per motion: critical angles [rad] and factors [-]; C = 0.9.
ANGLES = np.linspace(0.08, 0.3, 12)
SCALES = np.linspace(0.4, 1.4, 6)
#: Smaller peaks are left out, theta_max/alpha_c [-].
SMALLEST_PEAK = 0.01


def convergence(seed: int, motions: int, divisions: Sequence[int] = DIVISIONS, repeats: int = 5) -> pd.DataFrame:
    """Error and cost of the nonlinear kernel by its step, one row per step.

    `divisions` are the steps per sample, rising; `motions` synthetic motions are drawn from `seed` on; the cost is the
    median of `repeats` whole calls, after one that is not counted. Columns: `step` (p dt [-]), `cases` that survive
    with every step, `median` and `p90` of their errors of theta_max/alpha_c [-], `ns_per_active_sample`, and `order`,
    that of :func:`laboratory.accuracy.statistics.observed_order` against the row before, from `order_cases`
    cases.

    The series of phi goes to order N and that of its rate to order N - 1: the rate is wrong by h^N after a step, and
    the motion by h^(N - 1) after a time.
    """
    records = [synthetic_motion(number, dt=INTERVAL) for number in range(seed, seed + motions)]
    truth, _ = _peaks(records, JUDGE, 1)
    peaks, costs = zip(*(_peaks(records, count, repeats) for count in divisions), strict=True)
    survive = np.isfinite(truth) & (truth > SMALLEST_PEAK) & np.all(np.isfinite(peaks), axis=0)
    rows = []
    before: pd.DataFrame | None = None
    for count, peak, cost in zip(divisions, peaks, costs, strict=True):
        error = np.abs(peak[survive] - truth[survive])
        cases = pd.DataFrame({"error": error, "step": LONGEST / count})
        order, used = (np.nan, 0) if before is None else observed_order(before, cases)
        rows.append(
            {
                "step": LONGEST / count,
                "cases": error.size,
                "median": np.median(error) if error.size else np.nan,
                "p90": np.percentile(error, 90.0) if error.size else np.nan,
                "ns_per_active_sample": cost,
                "order": order,
                "order_cases": used,
            }
        )
        before = cases
    return pd.DataFrame(rows)


def _peaks(records: list[np.ndarray], division: int, repeats: int) -> tuple[np.ndarray, float]:
    """theta_max/alpha_c of all lanes [-], and the cost of an active sample [ns]."""
    block = Block.from_parameters(LONGEST / INTERVAL, ANGLES, 0.9, log=False)
    step = LONGEST / division * (1.0 + 1e-10)

    def call() -> list[Response]:
        return [
            recorded_response(
                block, record, INTERVAL, "nonlinear", scale=SCALES, step=step, last_term=np.inf, threads=1
            )
            for record in records
        ]

    responses, seconds = timed(call, repeats)
    peaks = np.concatenate([np.ravel(response.peak_rotation_ratio) for response in responses])
    return peaks, 1e9 * seconds / max(active_samples(responses), 1)
