"""The accuracy report: the stored reference, statistics by hand, solvers and models on small ensembles, the diagram."""

import dataclasses
import itertools
import math
from dataclasses import replace

import mpmath
import numpy as np
import pandas as pd
import pytest

from laboratory.accuracy import work_precision
from laboratory.accuracy.__main__ import QUICK, accuracy, overview
from laboratory.accuracy.bodies import DT as BODIES_DT
from laboratory.accuracy.bodies import PLAIN, SCALES, bodies_table, kinds
from laboratory.accuracy.convergence import convergence
from laboratory.accuracy.diagram import diagram
from laboratory.accuracy.model_form import (
    COMPARED,
    JUDGE,
    LEVELS,
    classifier_table,
    model_form_lanes,
    model_form_table,
    synthetic_records,
)
from laboratory.accuracy.reference import TABLE, load_reference, motion_of
from laboratory.accuracy.statistics import (
    WELL_CONDITIONED,
    answer_errors,
    error_statistics,
    observed_order,
    reference_under_perturbation,
)
from laboratory.ensemble import blocks
from rocking.body.block import Block
from rocking.march.polynomial import ORDER
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.assessment.scene import prepare
from rockpulse.config.configuration import Config
from rockpulse.errors import RockpulseError
from rockpulse.model_table import MODELS
from rockpulse.record.conditioning import condition
from rockpulse.record.synthetic import synthetic_motion

pytestmark = pytest.mark.sweep


#: Eleven survivors at rising peaks, one that overturns, one whose verdict the perturbation flips.
REFERENCE = pd.DataFrame(
    {
        "peak": [*np.linspace(0.1, 0.9, 11), np.inf, 0.5],
        "outcome": ["ROCKS"] * 11 + ["OVERTURNS", "ROCKS"],
        "spread": [1e-14] * 10 + [2.0 * WELL_CONDITIONED, 0.0, np.inf],
    },
    index=[f"case-{number}" for number in range(13)],
)


def answers(errors, **changed):
    """The reference's answers off by some errors; `changed` maps a place to another (peak, outcome)."""
    frame = REFERENCE[["peak", "outcome"]].copy()
    frame.loc[frame.index[:11], "peak"] += errors
    for place, (peak, outcome) in changed.items():
        frame.loc[place.replace("_", "-"), ["peak", "outcome"]] = peak, outcome
    return frame


def test_the_reference_itself_has_no_error_and_no_flips():
    found = error_statistics(REFERENCE[["peak", "outcome"]], REFERENCE)
    assert (found["flips"], found["unresolved"], found["max"]) == (0, 0, 0.0)
    assert (found["cases"], found["compared"], found["compared_well"]) == (13, 12, 10)


def test_quantiles_of_known_errors():
    """Errors 0, 1, ... 10 times 1e-6 on the survivors, and 0 on the last case: twelve values, 0 twice."""
    errors = 1e-6 * np.arange(11)
    found = error_statistics(answers(errors), REFERENCE)
    sizes = np.sort([*errors, 0.0])
    # Linear interpolation between the sorted values: place 5.5 of 0..11, 9.9, 10.89.
    assert found["median"] == pytest.approx(0.5 * (sizes[5] + sizes[6]))
    assert found["p90"] == pytest.approx(sizes[9] + 0.9 * (sizes[10] - sizes[9]))
    assert found["p99"] == pytest.approx(sizes[10] + 0.89 * (sizes[11] - sizes[10]))
    assert found["max"] == pytest.approx(1e-5)


def test_well_conditioned_cases_are_those_that_the_perturbation_leaves_alone():
    found = error_statistics(answers(np.r_[np.zeros(10), 0.3]), REFERENCE)
    assert found["max"] == pytest.approx(0.3)
    assert found["max_well"] == 0.0
    assert found["well_conditioned"] == pytest.approx(11 / 13)  # the overturned one stays overturned
    assert found["reference_flips"] == 1


def test_a_damaged_answer_shows_up():
    found = error_statistics(answers(np.r_[0.0, 1e-3, np.zeros(9)]), REFERENCE)
    assert found["max_well"] == pytest.approx(1e-3)
    assert found["median"] == 0.0


@pytest.mark.parametrize(("case", "answer"), [("case_3", (np.inf, "OVERTURNS")), ("case_11", (0.8, "ROCKS"))])
def test_another_verdict_is_a_flip_and_no_error(case, answer):
    found = error_statistics(answers(np.zeros(11), **{case: answer}), REFERENCE)
    assert found["flips"] == 1
    assert found["max"] == 0.0
    assert found["compared"] == (11 if case == "case_3" else 12)


def test_an_unresolved_answer_is_a_flip_of_its_own_kind():
    found = error_statistics(answers(np.zeros(11), case_0=(np.nan, "UNRESOLVED")), REFERENCE)
    assert (found["unresolved"], found["flips"], found["compared"]) == (1, 1, 11)


def test_without_any_survivor_the_errors_are_absent():
    fallen = REFERENCE.loc[["case-11"]]
    found = error_statistics(fallen[["peak", "outcome"]], fallen)
    assert found["compared"] == 0
    assert np.isnan([found[name] for name in ("median", "p90", "p99", "max", "max_well")]).all()


def test_errors_are_absent_unless_both_survive():
    errors = answer_errors(answers(np.full(11, 1e-9), case_0=(np.inf, "OVERTURNS")), REFERENCE)
    assert np.isnan(errors[["case-0", "case-11"]]).all()
    assert errors["case-1"] == pytest.approx(1e-9)


def test_the_reference_under_its_perturbation_is_its_spread():
    found = reference_under_perturbation(REFERENCE)
    assert found["flips"] == found["reference_flips"] == 1
    assert found["compared"] == 11  # neither the overturned nor the flipping one
    assert (found["median"], found["max"]) == (1e-14, 2.0 * WELL_CONDITIONED)
    assert found["max_well"] == 1e-14


@pytest.mark.parametrize("order", [1, 2, 7])
def test_the_order_is_read_from_errors_that_follow_a_power(order):
    factor = np.array([1.0, 3.0, 0.2, 5.0])
    coarse = pd.DataFrame({"error": factor * 0.3**order, "step": 0.3})
    fine = pd.DataFrame({"error": factor * 0.1**order, "step": 0.1})
    assert observed_order(coarse, fine) == (pytest.approx(order), 4)


def test_no_order_is_read_from_rounding_or_from_one_step():
    coarse = pd.DataFrame({"error": [1e-9, 1e-15, np.nan], "step": 0.2})
    fine = pd.DataFrame({"error": [1e-15, 1e-15, 1e-9], "step": 0.1})
    assert observed_order(coarse, fine)[1] == 0
    assert np.isnan(observed_order(coarse, fine)[0])
    assert observed_order(coarse, coarse)[1] == 0


@pytest.fixture(scope="module")
def stored():
    return load_reference()


@pytest.fixture(scope="module")
def conditioned(ridgecrest):
    return {record.id: condition(record) for record in ridgecrest if record.orientation == "horizontal"}


def first(table, **wanted):
    """The first row with these values."""
    for name, value in wanted.items():
        table = table[table[name] == value]
    return next(table.itertuples())


def test_table_has_enough_cases_of_every_kind(stored):
    synthetic = stored[stored["motion"].str.startswith("synthetic-")]
    assert synthetic["motion"].nunique() >= 20
    assert np.count_nonzero(synthetic["equation"] == "linear") >= 200
    assert np.count_nonzero(synthetic["equation"] == "nonlinear") >= 120
    assert set(stored["outcome"]) == {"AT_REST", "ROCKS", "OVERTURNS"} < set(Outcome.__members__)
    assert np.mean(synthetic["outcome"] == "AT_REST") < 0.05
    assert stored["case"].is_unique
    assert TABLE.stat().st_size < 300_000


def test_columns_are_consistent(stored):
    assert np.array_equal(np.isinf(stored["peak"]), stored["outcome"] == "OVERTURNS")
    assert np.array_equal(stored["peak"] == 0.0, stored["outcome"] == "AT_REST")
    nonlinear_overturns = (stored["outcome"] == "OVERTURNS") & (stored["equation"] == "nonlinear")
    assert np.array_equal(np.isfinite(stored["overturning_time"]), nonlinear_overturns)
    assert stored["impacts"].dtype.kind == "i"
    assert not stored["spread"].isna().any()
    flips = (stored["outcome"] != stored["lowered_outcome"]) | (stored["outcome"] != stored["scaled_outcome"])
    assert np.array_equal(np.isinf(stored["spread"]), flips)
    assert "140-bit numbers" in stored.attrs["provenance"]


def test_spread_keeps_the_digits_that_a_difference_of_floats_loses(stored):
    rocks = stored[(stored["outcome"] == "ROCKS") & np.isfinite(stored["spread"])]
    assert np.min(rocks["spread"]) < 1e-17 < np.max(rocks["spread"])
    assert np.median(rocks["spread"]) > 0.0


def test_synthetic_motions_are_those_of_the_reference(stored):
    """Twenty motions, each checked by its SHA-256 in `motion_of`."""
    for row in stored.drop_duplicates("motion").itertuples():
        if row.motion.startswith("synthetic-"):
            acceleration, dt = motion_of(row)
            assert (acceleration.size, dt) == (6001, 0.01)


def test_sample_motions_are_those_of_the_reference(stored, conditioned):
    rows = [row for row in stored.drop_duplicates("motion").itertuples() if not row.motion.startswith("synthetic-")]
    assert {row.motion for row in rows} == set(conditioned)
    for row in rows:
        acceleration, dt = motion_of(row, conditioned)
        assert acceleration == pytest.approx(conditioned[row.motion].acceleration, abs=1e-9)
        assert dt == conditioned[row.motion].dt


def test_record_that_is_missing_is_named(stored):
    row = next(row for row in stored.itertuples() if not row.motion.startswith("synthetic-"))
    with pytest.raises(RockpulseError, match="which is not among those given") as raised:
        motion_of(row)
    assert row.motion in str(raised.value)


def test_other_samples_than_those_of_the_reference_are_refused(stored, conditioned):
    row = next(row for row in stored.itertuples() if row.motion in conditioned)
    record = conditioned[row.motion]
    changed = {row.motion: replace(record, acceleration=record.acceleration * 1.001)}
    with pytest.raises(RockpulseError, match="the reference does not apply"):
        motion_of(row, changed)


@pytest.mark.parametrize(
    ("equation", "outcome"),
    [
        ("linear", "OVERTURNS"),
        *(pytest.param(*case, marks=pytest.mark.sweep) for case in (("linear", "ROCKS"), ("nonlinear", "OVERTURNS"))),
    ],
)
def test_script_makes_the_stored_answer_again(stored, make_reference, equation, outcome):
    """To all stored digits but the last few, whichever library of numbers is installed."""
    # The earliest fall is the shortest computation; rows without a time of falling stay in their order.
    row = first(stored.sort_values("overturning_time", kind="stable"), equation=equation, outcome=outcome)
    case = next(case for case in make_reference.synthetic_cases() if case.name == row.case)
    made = dict(zip(make_reference.COLUMNS, make_reference.row(case), strict=True))
    for name in ("motion_sha256", "dt", "scale", "p", "alpha", "restitution", "outcome", "lowered_outcome", "impacts"):
        assert made[name] == getattr(row, name)
    assert made["overturning_time"] == pytest.approx(row.overturning_time, rel=1e-15, nan_ok=True)
    for name in ("peak_text", "lowered_peak_text", "scaled_peak_text"):
        assert_same_digits(made[name], getattr(row, name))


def assert_same_digits(made, stored):
    if not math.isfinite(float(stored)):
        assert made == stored
        return
    context = mpmath.MPContext()
    context.dps = 40
    assert abs(context.mpf(made) - context.mpf(stored)) <= context.mpf(10) ** -21 * context.mpf(stored)


def test_run_goes_on_where_the_last_one_stopped(make_reference, tmp_path, monkeypatch):
    cases = list(make_reference.synthetic_cases())[:3]
    monkeypatch.setattr(make_reference, "synthetic_cases", lambda: cases)
    monkeypatch.setattr(make_reference, "sample_cases", list)
    monkeypatch.setattr(make_reference, "row", lambda case: [case.name] + ["0"] * 17)
    path = tmp_path / "table.csv"
    for most in ("1", "5"):
        monkeypatch.setattr("sys.argv", ["make_reference.py", "--output", str(path), "--most", most])
        make_reference.main()
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    assert lines[0] == ",".join(make_reference.COLUMNS)
    assert [line.split(",")[0] for line in lines[1:]] == [case.name for case in cases]


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


def test_the_kernel_agrees_with_a_finer_step(measured):
    rows = measured.rows[(measured.rows["method"] == "rockpulse") & (measured.rows["call"] == "lanes")]
    assert rows["cases"].sum() == 24
    assert (rows["flips"] == 0).all()
    assert (rows["median"] < 1e-10).all()  # every step is good to 1e-13 of alpha_c, and the motion makes it grow


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


def test_costs_belong_to_what_was_computed(measured, small):
    for row in measured.rows[measured.rows["method"] != "reference"].itertuples():
        assert row.ns_per_active_sample == pytest.approx(1e9 * row.seconds / row.active_samples)
        assert row.ns_per_sample == pytest.approx(1e9 * row.seconds / row.samples)
        assert 0 < row.active_samples < row.samples
    lanes = measured.rows[measured.rows["call"] == "lanes"].set_index(["method", "equation"])
    for equation, cases in small.groupby("equation"):
        counts = cases["motion"].value_counts()
        assert lanes.loc[("rockpulse", equation), "lanes"] == (counts**2).sum()  # every block under every factor
        assert lanes.loc[("rockpulse", equation), "samples"] == sum(
            count**2 * MOTIONS[motion].size for motion, count in counts.items()
        )


def test_seconds_are_those_of_all_cases_and_of_one_repetition(small, monkeypatch):
    """With a clock that ticks once a look: one second a case of solve_ivp, one a repetition of the kernel."""
    ticks = itertools.count()
    monkeypatch.setattr(work_precision.time, "perf_counter", lambda: float(next(ticks)))
    shared = work_precision.shared_cases(small, 3)
    rows = work_precision.work_precision(
        small, ground, shared, steps=(0.08,), tolerances=(("RK45", 1e-3),), repeats=3
    ).rows
    counts = shared["equation"].value_counts()
    assert counts.min() >= 2
    for row in rows[rows["method"] != "reference"].itertuples():
        assert row.seconds == (1.0 if row.method == "rockpulse" else counts[row.equation])


def test_the_baseline_is_once_as_fast_as_itself(measured):
    rows = measured.rows
    itself = rows[(rows["method"] == "RK45") & (rows["setting"] == 1e-6)]
    assert itself["times_faster"].tolist() == [1.0, 1.0]
    faster = rows.loc[(rows["method"] == "rockpulse") & (rows["call"] == "lanes"), "times_faster"]
    assert (faster > 50.0).all()  # thousands on a quiet machine


def test_the_first_rows_say_what_the_perturbation_does(measured):
    rows = measured.rows[measured.rows["method"] == "reference"]
    assert rows["equation"].nunique() == 2
    assert (rows["max"] == 1e-14).all()
    assert rows["ns_per_active_sample"].isna().all()


def test_shared_cases_hold_one_that_overturns_for_two_that_rock():
    outcomes = ["ROCKS"] * 9 + ["OVERTURNS"] * 9 + ["AT_REST"] * 9
    frame = pd.DataFrame({"equation": "linear", "outcome": outcomes})
    chosen = work_precision.shared_cases(frame, 6)
    assert chosen["outcome"].value_counts().to_dict() == {"ROCKS": 4, "OVERTURNS": 2}
    assert chosen.index.is_unique
    assert len(work_precision.shared_cases(frame, 1000)) == 18


@pytest.mark.parametrize(("length", "count"), [(10, 3), (3, 10), (0, 4), (5, 0), (1, 1)])
def test_evenly_spread_places_are_different_and_inside(length, count):
    places = work_precision.evenly_spread(length, count)
    assert places.size == min(length, count)
    assert np.unique(places).size == places.size
    assert np.all((places >= 0) & (places < length))


def test_the_nonlinear_kernel_converges_with_the_order_of_its_series():
    """Series of phi to order N: the rate is wrong by h^N after a step, the motion by h^(N - 1) after a time."""
    rows = convergence(seed=0, motions=6, divisions=(1, 2, 3), repeats=1)
    assert rows["step"].tolist() == pytest.approx([0.3, 0.15, 0.1])
    assert rows["order_cases"].iloc[1:].min() >= 10
    assert rows["order"].iloc[1:].tolist() == pytest.approx([ORDER - 1, ORDER - 1], abs=1.0)
    assert rows["median"].is_monotonic_decreasing


@pytest.fixture(scope="module")
def by_kind():
    return bodies_table(seed=3, motions=2, repeats=1).set_index("kind")


def test_every_kind_is_there_and_judged(by_kind):
    assert [*by_kind.index] == [*kinds()] == [PLAIN, *[*kinds()][1:]]
    assert (by_kind["cases"] == 2 * len(SCALES) * kinds()[PLAIN].shape[0]).all()
    assert (by_kind["compared"] > 0).all()
    assert by_kind.loc[PLAIN, "times_plain"] == 1.0


def test_shorter_steps_change_less_than_the_last_digits_of_the_record(by_kind):
    # What is more than rounding is the sensitivity of the motion itself.
    assert (by_kind["max"] < 10.0 * by_kind["max_perturbed"] + 1e-12).all()
    assert (by_kind["median"] < 1e-11).all()


def test_the_kinds_move_unlike_free_blocks():
    record = synthetic_motion(3, dt=BODIES_DT)
    peaks = {kind: recorded_response(block, record, BODIES_DT).peak_rotation_ratio for kind, block in kinds().items()}
    for kind, own in peaks.items():
        if kind != PLAIN:
            assert not np.array_equal(own, peaks[PLAIN]), kind


REST, ROCKS, OVER, UNRESOLVED = (int(outcome) for outcome in Outcome)


def made_up(rows):
    """Lanes of one model "cheap" from (demand, judge's peak, judge's outcome, model's peak, model's outcome)."""
    frame = pd.DataFrame(
        rows, columns=["velocity_ratio", f"peak {JUDGE}", f"outcome {JUDGE}", "peak cheap", "outcome cheap"]
    )
    other = {"ensemble": "made up", "uplift_ratio": -frame["velocity_ratio"], "impulse_ratio": 1.0}
    return frame.assign(**other)


LANES = made_up(
    [
        (0.1, 0.10, ROCKS, 0.20, ROCKS),  # ratio 2
        (0.1, 0.20, ROCKS, 0.10, ROCKS),  # ratio 1/2
        (0.3, 0.10, ROCKS, 0.40, ROCKS),  # ratio 4
        (0.3, 0.01, ROCKS, 0.50, ROCKS),  # too small a peak
        (0.3, 0.30, ROCKS, 0.00, REST),  # at rest in the model
        (0.7, 0.30, ROCKS, np.inf, OVER),  # false
        (0.7, np.inf, OVER, 0.50, ROCKS),  # missed
        (0.7, np.inf, OVER, 0.20, ROCKS),  # missed
        (3.0, np.inf, OVER, np.inf, OVER),
        (3.0, np.inf, OVER, np.nan, UNRESOLVED),
        (3.0, np.nan, UNRESOLVED, np.inf, OVER),
    ]
)


def level(demand_low, demand_high):
    table = model_form_table(LANES, models=("cheap",))
    return table[(table["demand_low"] == demand_low) & (table["demand_high"] == demand_high)].iloc[0]


def test_all_lanes_together():
    whole = level(0.0, np.inf)
    assert whole[["lanes", "unresolved", "overturn", "missed", "false"]].tolist() == [9, 2, 3, 2, 1]
    assert whole[["survivors", "at_rest"]].tolist() == [4, 1]
    assert whole["bias"] == pytest.approx(2.0)
    logs = np.log([2.0, 0.5, 4.0])
    assert whole["dispersion"] == pytest.approx(np.sqrt(np.sum((logs - logs.mean()) ** 2) / 2.0))


def test_lanes_are_counted_at_their_level():
    assert level(0.0, 0.25)["bias"] == pytest.approx(1.25)  # median of 2 and 1/2
    assert level(0.25, 0.5)["at_rest"] == 1
    assert level(0.5, 1.0)[["missed", "false"]].tolist() == [2, 1]
    assert level(2.0, np.inf)[["lanes", "unresolved", "overturn", "missed"]].tolist() == [1, 2, 1, 0]


def test_the_levels_hold_every_lane_once():
    table = model_form_table(LANES, models=("cheap",))
    for column in ("lanes", "unresolved", "overturn", "missed", "false", "survivors"):
        assert table[column].iloc[1:].sum() == table[column].iloc[0], column
    assert len(table) == 1 + len(LEVELS)


def test_a_model_that_is_the_judge_has_no_error():
    same = LANES.assign(**{"peak cheap": LANES[f"peak {JUDGE}"], "outcome cheap": LANES[f"outcome {JUDGE}"]})
    whole = model_form_table(same, models=("cheap",)).iloc[0]
    assert whole[["missed", "false"]].tolist() == [0, 0]
    assert (whole["bias"], whole["dispersion"]) == (1.0, 0.0)


def classified(fell, stood):
    over = [(value, np.inf, OVER, 0.0, REST) for value in fell]
    still = [(value, 0.1, ROCKS, 0.0, REST) for value in stood]
    table = classifier_table(made_up([*over, *still])).set_index("demand")
    return table.loc["velocity_ratio"], table.loc["uplift_ratio"], table.loc["impulse_ratio"]


def test_a_perfect_classifier_its_mirror_image_and_none():
    perfect, mirrored, constant = classified([2.0, 3.0], [0.5, 1.0])
    assert (perfect["auc"], mirrored["auc"], constant["auc"]) == (1.0, 0.0, 0.5)
    assert (perfect["false_at_0"], mirrored["false_at_0"], constant["false_at_0"]) == (0.0, 1.0, 1.0)


def test_false_alarms_at_a_share_of_missed_overturnings():
    """Twenty overturnings at 1 to 20, four survivors between them: one may be missed at 5 %, two at 10 %."""
    found, _, _ = classified(np.arange(1.0, 21.0), [0.5, 1.5, 2.5, 30.0])
    assert [found[f"false_at_{share}"] for share in (0, 5, 10)] == [0.75, 0.5, 0.25]
    # Pairs in which the overturned lane has the larger demand: 20 + 19 + 18 + 0 of 80.
    assert found["auc"] == pytest.approx(57 / 80)


def test_one_verdict_only_is_no_classification():
    found, _, _ = classified([1.0, 2.0], [])
    assert np.isnan([found["auc"], found["false_at_0"]]).all()


@pytest.fixture(scope="module")
def lanes():
    return model_form_lanes("synthetic", synthetic_records(7, 1)[0], scales=(0.5, 1.0))


def test_the_demand_follows_the_factor(lanes):
    half, whole = (lanes[lanes["scale"] == scale] for scale in (0.5, 1.0))
    for demand in ("velocity_ratio", "uplift_ratio", "impulse_ratio"):
        np.testing.assert_allclose(2.0 * half[demand].to_numpy(), whole[demand].to_numpy(), rtol=1e-12)


def test_a_factor_is_the_same_as_a_stronger_record():
    """Half-waves, phase and sequence of the scaled scene are those that the scaled record would have given."""
    record = synthetic_records(7, 1)[0]
    stronger = replace(record, acceleration=1.4 * record.acceleration)
    scaled = model_form_lanes("a", record, scales=(1.4,))
    direct = model_form_lanes("a", stronger, scales=(1.0,))
    for model in COMPARED:
        assert (scaled[f"outcome {model}"] == direct[f"outcome {model}"]).all(), model
        np.testing.assert_allclose(scaled[f"peak {model}"], direct[f"peak {model}"], rtol=1e-6)


def test_the_models_are_those_of_an_assessment(lanes):
    scene = prepare(synthetic_records(7, 1)[0], Config())
    for model in (*COMPARED, JUDGE):
        expected = MODELS[model].respond(blocks(), scene)
        whole = lanes[lanes["scale"] == 1.0]
        np.testing.assert_array_equal(whole[f"outcome {model}"], expected.outcome)
        np.testing.assert_array_equal(whole[f"peak {model}"], expected.peak_rotation_ratio)


@pytest.fixture(scope="module")
def quick(ridgecrest):
    return accuracy(ridgecrest[:1], QUICK, seed=1)


def test_every_table_of_the_report_is_told(quick):
    told = overview(quick)
    assert set(quick["model_form"]["ensemble"]) == {"records", "synthetic"}
    for words in ("linear equation", "RK45, rtol 1e-06", "elastic ties", "impulsive, missed", "velocity_ratio"):
        assert words in told
    assert (quick["work_precision"]["flips"] == 0).all()


def test_the_diagram_has_a_line_for_every_method(quick):
    figure = diagram(quick["work_precision"])
    assert len(figure.axes) == 2
    rows = quick["work_precision"].set_index(["equation", "method", "call"])
    shown = {line.get_label(): line for line in figure.axes[0].lines}
    (line,) = (one for words, one in shown.items() if words == "solve_ivp RK45 by rtol: median")
    assert line.get_ydata() == pytest.approx(rows.loc[("linear", "RK45", "single"), "median"].to_numpy())
