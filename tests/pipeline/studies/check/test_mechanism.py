"""Mechanisms against numbers worked by hand (the derivation is in the manual)."""

import pytest

import rockpulse as rp
from rocking.body.block import Block
from rocking.body.restraint import Thrust, Tie
from rockpulse.studies.check.mechanism import Force, Mechanism, Weight, mechanisms, senses_of

#: A body of 100 kN, 0.6 x 4 m, with a roof of 20 kN that it carries at its top.
BODY, ROOF = Weight(100.0, 0.3, 2.0, True), Weight(20.0, 0.3, 4.0, True)


def test_a_tie_that_breaks_counts_for_the_activation_but_not_for_the_displacement():
    """It breaks after 0.1 m; d_0 = (36/280) (720/280), and at 0.4 d_0 it has moved 0.154 m: alpha = 0.6 x 36/280."""
    held = Mechanism((BODY, ROOF), (Force(5.0, 3.0, 0.0, 0.1, tie=True),))
    assert not held.unlimited
    assert held.multiplier == pytest.approx(51.0 / 280.0)
    assert held.collapse_displacement == pytest.approx(36.0 / 280.0 * 720.0 / 280.0)
    assert held.capacity(0.4 * held.collapse_displacement) == pytest.approx(0.6 * 36.0 / 280.0)
    assert held.capacity(0.05) == pytest.approx((51.0 - 280.0 * 0.05 * 280.0 / 720.0) / 280.0)


def test_a_tie_with_a_gap_changes_neither_activation_nor_the_end_of_the_curve():
    slack = Mechanism((BODY,), (Force(5.0, 3.0, 0.03, tie=True),))
    assert slack.multiplier == pytest.approx(0.15)
    assert slack.at(0.02) == pytest.approx(0.15 + 0.075 - 0.02)
    assert slack.collapse_displacement == pytest.approx(0.3)


def test_the_edge_is_crushed_by_the_strength_divided_by_the_confidence_factor():
    """N = 0.6 x 4 x 1800 x 9.80665 + 20 000 = 62 364.7 N on 1 m; at 1 MPa/1.35 the corner is 0.049526 m inside."""
    wall = rp.BlockSettings(
        name="wall",
        width=0.6,
        height=4.0,
        density=1800.0,
        length=1.0,
        compressive_strength=1e6,
        loads=(rp.LoadSettings(weight=20e3, height=4.0, distance=0.2),),
        one_sided=True,
        rebound=0.4,
    )
    ((crushed,),) = mechanisms(wall, 1.35).values()
    inside, own = 62364.73 * 1.35 / 1.7e6, 42364.73
    multiplier = (own * (0.3 - inside) + 20e3 * (0.2 - inside)) / (own * 2.0 + 20e3 * 4.0)
    assert crushed.multiplier == pytest.approx(multiplier, rel=1e-6)
    assert mechanisms(wall)["wall"][0].multiplier > crushed.multiplier


def test_bodies_of_the_configuration_give_the_same_mechanisms():
    weight, gravity = 100e3, 9.80665
    common = {"width": 0.6, "height": 4.0, "mass": weight / gravity}
    roof = rp.LoadSettings(weight=20e3, height=4.0)
    tie = rp.TieSettings(height=3.0, stiffness=1e6, yield_force=5e3, ultimate=0.1, side="both")
    ((held,),) = mechanisms(rp.BlockSettings(name="a", **common, loads=(roof,), ties=(tie,))).values()
    assert held.multiplier == pytest.approx(51.0 / 280.0)
    assert held.share == pytest.approx(78400.0 / 86400.0)
    assert held.collapse_displacement == pytest.approx(36.0 / 280.0 * 720.0 / 280.0)
    sliding = rp.LoadSettings(weight=20e3, height=4.0, friction=0.4)
    ((other,),) = mechanisms(rp.BlockSettings(name="b", **common, loads=(sliding,))).values()
    assert (other.multiplier, other.share) == (pytest.approx(0.34), 1.0)


def test_each_sense_is_a_mechanism_of_its_own():
    common = {"width": 0.6, "height": 4.0, "mass": 1e4}
    weight = 9.80665e4
    assert len(senses_of(Block(**common))) == 1
    # A tie against theta > 0 leaves theta < 0 as it was, unless a wall stands there.
    tie = Tie(3.0, 1e6, yield_force=1e4)
    held, free = senses_of(Block(**common, ties=[tie]))
    assert held.multiplier == pytest.approx(0.15 + 3e4 / (2.0 * weight))
    assert free.multiplier == pytest.approx(0.15)
    (before,) = senses_of(Block(**common, ties=[tie], one_sided=True, rebound=0.5))
    assert before == held
    for force in (3e3, -3e3):  # whichever way an arch pushes, the body opens that way
        opened = [one.multiplier for one in senses_of(Block(**common, thrusts=[Thrust(force, 3.0)]))]
        assert opened[force < 0.0] == pytest.approx(0.15 - 9e3 / (2.0 * weight))


def test_a_pedestal_makes_two_bodies():
    statue = rp.BlockSettings(
        name="statue",
        width=0.5,
        height=2.0,
        mass=900.0,
        pedestals=(rp.PedestalSettings(width=1.0, height=1.0, mass=900.0),),
    )
    found = mechanisms(statue)
    assert list(found) == ["statue", "statue with pedestal"]
    assert [len(senses) for senses in found.values()] == [1, 1]
    assert found["statue"][0].multiplier == pytest.approx(0.25)
    # Its centre is midway between 0.5 and 2 m, the edge of the pedestal 0.5 m off.
    assert found["statue with pedestal"][0].multiplier == pytest.approx(0.5 / 1.25)
