"""Errors and costs of solvers on a small ensemble."""

import dataclasses

import numpy as np
import pandas as pd
import pytest

from laboratory.accuracy import work_precision
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from synthetic import synthetic_motion

pytestmark = pytest.mark.slow


DT, GRAVITY = 0.02, 9.81
MOTIONS = {"one": synthetic_motion(1, duration=6.0, dt=DT), "two": synthetic_motion(2, duration=8.0, dt=DT)}


def ground(row):
    return MOTIONS[row.motion], DT


def kernel(row, step=0.08):
    block = Block.from_parameters(row.p, row.alpha, row.restitution, gravity=row.gravity)
    return recorded_response(block, MOTIONS[row.motion], DT, row.equation, scale=row.scale, step=step, threads=1)


@pytest.fixture(scope="module")
def small():
    """Twenty-four cases in no order, blocks and factors all different; the kernel at a finer step is the judge."""
    random = np.random.default_rng(3)
    rows = pd.DataFrame(
        {
            "case": [f"case-{number}" for number in range(24)],
            "motion": random.permutation(["one", "two"] * 12),
            "equation": random.permutation(["linear", "nonlinear"] * 12),
            "scale": random.uniform(0.4, 2.0, 24),
            "p": random.uniform(1.5, 4.0, 24),
            "alpha": random.uniform(0.08, 0.25, 24),
            "restitution": random.uniform(0.8, 0.9, 24),
            "dt": DT,
            "gravity": GRAVITY,
            "spread": 1e-14,
        },
        index=random.permutation(100)[:24],
    )
    answers = [kernel(row, step=0.04) for row in rows.itertuples()]
    rows["peak"] = [answer.peak_rotation_ratio for answer in answers]
    rows["outcome"] = [Outcome(answer.outcome).name for answer in answers]
    assert set(rows["outcome"]) >= {"ROCKS", "OVERTURNS"}
    return rows


def measure(small, **options):
    shared = work_precision.shared_cases(small, 1)
    given = {"steps": (0.08,), "tolerances": (("RK45", 1e-3), ("RK45", 1e-6)), "repeats": 1, **options}
    return work_precision.work_precision(small, ground, shared, **given)


@pytest.fixture(scope="module")
def measured(small):
    return measure(small)


def test_every_case_gets_its_own_answer_whatever_call_it_was_in(measured, small):
    answers = measured.answers[measured.answers["method"] == "rockpulse"]
    lanes = answers[answers["call"] == "lanes"].set_index("case")
    assert len(lanes) == 24
    for row in small.itertuples():
        alone = kernel(row)
        assert lanes.loc[row.case, "outcome"] == Outcome(alone.outcome).name
        assert lanes.loc[row.case, "peak"] == alone.peak_rotation_ratio


def test_solve_ivp_is_near_and_nearer_at_the_smaller_tolerance(measured):
    rows = measured.rows[measured.rows["method"] == "RK45"].set_index(["equation", "setting"])
    for equation in ("linear", "nonlinear"):
        loose, tight = rows.loc[(equation, 1e-3), "max"], rows.loc[(equation, 1e-6), "max"]
        assert tight < 1e-3
        assert tight < loose


def test_a_damaged_lane_shows_up_in_error_and_verdict(small, monkeypatch):
    honest = work_precision.recorded_response

    def damaged(block, *given, **options):
        response = honest(block, *given, **options)
        peak, outcome = response.peak_rotation_ratio.copy(), response.outcome.copy()
        peak[np.isfinite(peak)] += 1e-3
        peak[outcome == Outcome.OVERTURNS] = 0.5
        outcome[outcome == Outcome.OVERTURNS] = Outcome.ROCKS
        return dataclasses.replace(response, peak_rotation_ratio=peak, outcome=outcome)

    monkeypatch.setattr(work_precision, "recorded_response", damaged)
    rows = measure(small).rows
    lanes = rows[(rows["method"] == "rockpulse") & (rows["call"] == "lanes")]
    np.testing.assert_allclose(lanes["median"], 1e-3, rtol=1e-6)
    assert lanes["flips"].sum() == (small["outcome"] == "OVERTURNS").sum()
