"""The stored cases are what they are called, a wrong answer is noticed, and solve_ivp is a fair opponent."""

import math
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest
from recorded_cases import EQUATIONS, G, block_of, synthetic

from rocking.march.recorded import recorded_response
from rockpulse.cli import main
from rockpulse.models import Outcome
from rockpulse.studies.selftest import selftest
from rockpulse.studies.selftest.baseline import baseline_response
from rockpulse.studies.selftest.selftest import COLUMNS, TABLE, solve_case, stored_cases
from rockpulse.studies.selftest.selftest import synthetic_motion as parabolic_motion
from synthetic import synthetic_lanes, synthetic_motion

STORED = {one.case.case: one for one in stored_cases()}


def found(name, **changed):
    """Outcome and peak by the kernel of a stored case with other properties."""
    return solve_case(STORED[name]._replace(case=replace(STORED[name].case, **changed)))


def test_the_cases_are_of_every_kind():
    kinds = {one.case.kind for one in STORED.values()}
    assert kinds == {"plain", "near-critical", "one-sided", "tied", "vertical", "floor"}
    assert {one.outcome for one in STORED.values()} == {"AT_REST", "ROCKS", "OVERTURNS"}
    assert {one.case.equation for one in STORED.values()} == {"linear", "nonlinear"}
    assert {0.0, 1.0} <= {one.case.restitution for one in STORED.values()}
    assert min(one.case.dt for one in STORED.values()) == 1.0 / 2000.0
    rates = [float(one.case.block().p) for one in STORED.values()]
    assert min(rates) == pytest.approx(0.3, rel=1e-3)
    assert max(rates) == pytest.approx(20.0, rel=1e-3)
    assert 30 <= len(STORED) <= 40
    assert TABLE.read_text(encoding="utf-8").splitlines()[0] == ",".join(COLUMNS)


def test_every_case_is_within_its_bound():
    for stored in STORED.values():
        one = solve_case(stored)
        assert one.passed, (stored.case.case, one.error)
        assert stored.bound <= (1e-8 if stored.case.kind == "near-critical" else 1e-11)
        assert np.isnan(one.cost) == (stored.outcome == "AT_REST")


def test_the_samples_of_a_case_are_exact_in_binary():
    motion = parabolic_motion("4 -6", 32, 1)
    assert motion.size == 3 * 32 + 1
    assert (motion[16], motion[48], motion[64:].any()) == (4.0, -6.0, False)
    assert np.array_equal(motion * 2.0**12, np.round(motion * 2.0**12))


@pytest.mark.parametrize("equation", ["", ", linear"])
def test_near_critical_cases_are_on_both_sides_of_overturning(equation):
    below, above = (STORED[f"just {side} overturning{equation}"] for side in ("below", "above"))
    assert (below.outcome, above.outcome) == ("ROCKS", "OVERTURNS")
    assert 0.0 < above.case.scale / below.case.scale - 1.0 < 3e-8
    assert 0.999 < below.peak < 1


@pytest.mark.parametrize(
    ("name", "changed"),
    [
        ("before a wall", {"wall": 0}),
        ("elastic ties", {"stiffness": 0.0}),
        ("stiff ties", {"stiffness": 0.0}),
        ("vertical", {"vertical": ""}),
        ("vertical, overturned", {"vertical": ""}),
        ("vertical, ten pulses", {"vertical": ""}),
        ("on a floor", {"floor": 0.0}),
        ("2000 Hz", {"dt": 0.001}),
        ("C = 0", {"restitution": 0.1}),
        ("C = 1", {"restitution": 0.99}),
    ],
)
def test_what_a_case_is_called_after_decides_its_answer(name, changed):
    assert found(name, **changed).error > 1e-5


def test_solve_ivp_is_tried_on_short_plain_cases_only():
    one = solve_case(STORED["one pulse"])
    assert one.error < 1e-15 < one.error_of_solve_ivp < 1e-3
    assert one.cost_of_solve_ivp > 10.0 * one.cost
    assert np.isnan(solve_case(STORED["before a wall"]).cost_of_solve_ivp)


def test_the_verb_prints_a_table_and_ends_with_zero(monkeypatch, capsys):
    few = ("one pulse", "at rest", "before a wall")
    monkeypatch.setattr(selftest, "stored_cases", lambda: [STORED[name] for name in few])
    assert main(["selftest"]) == 0
    out = capsys.readouterr().out
    assert all(name in out for name in few)
    assert "3 cases: 0 outside their bounds" in out
    assert "threads available" in out
    assert main(["selftest", "--quiet"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("change", [{"peak": STORED["one pulse"].peak + Decimal("2e-12")}, {"outcome": "OVERTURNS"}])
def test_an_answer_that_is_not_the_stored_one_ends_with_one(change, monkeypatch, capsys):
    wrong = STORED["one pulse"]._replace(**change)
    monkeypatch.setattr(selftest, "stored_cases", lambda: [wrong, STORED["at rest"]])
    assert main(["selftest"]) == 1
    assert "2 cases: 1 outside" in capsys.readouterr().out


def answer(block, ground, dt, equation, **options):
    return baseline_response(
        block.p, block.alpha_c, block.restitution, ground, dt, equation, gravity=block.gravity, **options
    )


@pytest.mark.parametrize("peak", [8.0, *(pytest.param(peak, marks=pytest.mark.sweep) for peak in (2.4, 3.5))])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_baseline_converges_to_the_kernel(equation, peak):
    block, dt = block_of(1.0, 5.0, 0.8), 0.02
    ground = synthetic(seed=3, n=120, dt=dt, peak=peak)
    fast = recorded_response(block, ground, dt, equation=equation)
    tight = answer(block, ground, dt, equation, method="DOP853", rtol=1e-10, rest_speed=1e-6)
    loose = answer(block, ground, dt, equation)
    assert tight.outcome == loose.outcome == Outcome(fast.outcome).name
    if math.isfinite(fast.peak_rotation_ratio):
        assert tight.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-5)
        assert loose.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-2)
    else:
        assert tight.peak_rotation_ratio == math.inf


@pytest.mark.parametrize("equation", EQUATIONS)
def test_block_at_rest_costs_nothing(equation):
    block = block_of(1.0, 5.0, 0.8)
    assert answer(block, np.full(50, 1.9), 0.01, equation) == (0.0, "AT_REST", 0)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_only_samples_in_motion_are_active(equation):
    """One pulse in twenty seconds: the rest before and after it is jumped over."""
    block = block_of(1.0, 5.0, 0.5)
    ground = np.zeros(2000)
    ground[1000:1020] = 3.0 * np.sin(np.pi * np.arange(20) / 19)
    response = answer(block, ground, 0.01, equation)
    assert response.outcome == "ROCKS"
    assert 10 < response.active_samples < 200


@pytest.mark.parametrize("equation", EQUATIONS)
def test_motion_after_the_record_is_decided_by_energy(equation):
    """F6 (linear) at its limit, and the nonlinear pulse on both sides by the kernel."""
    block, samples = block_of(2.0, 4.0, 0.9, gravity=G), 40
    critical = G * block.alpha_c / -math.expm1(-1.0)
    for share in (0.95, 0.99, 1.01, 1.05):
        pulse = np.full(samples + 1, critical * share)
        dt = 1.0 / block.p / samples
        fast = recorded_response(block, pulse, dt, equation=equation)
        slow = answer(block, pulse, dt, equation)
        assert slow.outcome == Outcome(fast.outcome).name
        if slow.outcome == "ROCKS":
            assert slow.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-4)


def test_uplift_by_a_hair_does_not_repeat_itself_for_ever():
    lanes = synthetic_lanes(0, 24)
    motion = synthetic_motion(0, pga=0.3 * 9.80665)
    answer = baseline_response(lanes.p[8], lanes.alpha[8], 0.9, motion, 0.01, "linear", 0.7)
    assert answer.outcome == "ROCKS"
    assert 0.0 <= answer.peak_rotation_ratio < 1e-9
