"""The kinematic check against numbers worked by hand (the derivation is in the manual)."""

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.body.restraint import Tie
from rockpulse.studies.check.kinematic import kinematic_check


def flat(value):
    return lambda periods: np.full(np.shape(periods), value)


def test_a_free_rectangle_is_the_hand_worked_case():
    """b 0.4, h 4, FC 1: a_0* = 0.1 g; d_0* = 0.2, d_u* = 0.08, d_s* = 0.032 m; T_s = 2 pi sqrt(0.032/(0.84 a_0*))."""
    found = kinematic_check(Block(width=[0.4], height=[4.0]), flat(2.0), ground=1.5)
    assert found.activation[0] == pytest.approx(0.980665)
    assert found.linear[0] == pytest.approx(0.980665 / 0.75)
    assert found.ultimate[0] == pytest.approx(0.08)
    assert found.secant_period[0] == pytest.approx(1.2384, abs=5e-5)
    assert found.nonlinear[0] == pytest.approx(0.08 / (2.0 * (1.2384 / (2.0 * np.pi)) ** 2), rel=1e-4)


def test_the_confidence_factor_takes_from_the_activation_and_lengthens_the_period():
    body = Block(width=[0.4], height=[4.0])
    sure, unsure = (kinematic_check(body, flat(2.0), 1.5, confidence_factor=factor) for factor in (1.0, 1.35))
    assert unsure.activation == pytest.approx(sure.activation / 1.35)
    assert unsure.secant_period == pytest.approx(sure.secant_period * 1.35**0.5)
    assert unsure.linear < sure.linear
    assert unsure.nonlinear < sure.nonlinear


def test_the_weaker_corner_counts_and_a_wall_changes_nothing():
    lean = kinematic_check(Block(width=[0.4], height=[4.0], offset=[0.05]), flat(2.0), 1.5)
    assert lean.activation[0] == pytest.approx(9.80665 * 0.15 / 2.0)
    assert lean.ultimate[0] == pytest.approx(0.4 * 0.15)
    wall = kinematic_check(Block(width=[0.4], height=[4.0], one_sided=True), flat(2.0), 1.5)
    free = kinematic_check(Block(width=[0.4], height=[4.0]), flat(2.0), 1.5)
    assert all(np.array_equal(one, other) for one, other in zip(wall, free, strict=True))


@pytest.mark.parametrize("change", [{"ground": 0.0}, {"behaviour": 0.5}, {"confidence_factor": 0.9}])
def test_numbers_out_of_range_are_refused(change):
    with pytest.raises(ValueError, match="expected a_g S above 0"):
        kinematic_check(**({"block": Block(width=[0.4], height=[4.0]), "spectrum": flat(2.0), "ground": 1.0} | change))


def test_a_tie_needs_a_yield_force():
    held = Block(width=0.4, height=4.0, mass=1e3, ties=[Tie(3.0, 1e5)])
    with pytest.raises(ValueError, match="tie without yield_force"):
        kinematic_check(held, flat(2.0), 1.0)
