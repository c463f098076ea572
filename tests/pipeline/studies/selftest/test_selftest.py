"""The stored cases are what they are called, and an answer that is not theirs is noticed."""

from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from rocking.body.supports import floor_motion
from rocking.march.recorded import recorded_response
from rockpulse.cli import main
from rockpulse.studies.selftest import selftest
from rockpulse.studies.selftest.selftest import COLUMNS, TABLE, solve_case, stored_cases, synthetic_motion

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
    motion = synthetic_motion("4 -6", 32, 1)
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


def test_a_floor_shakes_harder_than_its_ground():
    case = STORED["on a floor"].case
    ground, _ = case.motions()
    assert recorded_response(case.block(), ground, case.dt).peak_rotation_ratio == 0.0
    assert floor_motion(ground, case.dt, case.floor).amplification > 1.5


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
