"""The largest rotations about both corners of restrained bodies, and what they demand of ties."""

import math

import numpy as np
import pytest
from body_cases import drawn
from scipy.integrate import solve_ivp

from rocking import Outcome, Tie, recorded_response
from rocking.body.block import Block
from rocking.body.restraint import Restraints, TieState

DT = 0.01
PULSE = -2.5 * np.sin(np.pi * np.minimum(np.arange(0.0, 3.0, DT) / 0.2, 1.0))
FACADE = {"width": 0.8, "height": 9.0, "density": 1800.0, "length": 1.0, "one_sided": True, "log": False}


def test_demand_by_hand():
    """A plate on the inner face, 0.8 m from the corner: at 0.01 rad it has moved 8 sin(0.01) + 0.8 (1 - cos(0.01))."""
    tie = Tie(height=8.0, stiffness=2e6, gap=0.01, yield_force=1.5e5, ultimate=0.1, distance=0.8, side="both")
    turned = np.array([[0.001, 0.01, 0.0, 0.02, np.inf, np.nan], [0.0, 0.002, 0.005, 0.0, 0.0, np.nan]])
    found = Restraints((tie,)).tie_demand(turned)
    most = np.array([0.001, 0.01, 0.005, 0.02])
    moved = np.maximum(8.0 * np.sin(most) + 0.8 * (1.0 - np.cos(most)) - 0.01, 0.0)
    assert found.elongation[0, :4] == pytest.approx(moved, rel=1e-14)
    assert found.elongation[0, 4:].tolist() == pytest.approx([np.inf, np.nan], nan_ok=True)
    assert found.force[0, :5] == pytest.approx([0.0, 2e6 * moved[1], 2e6 * moved[2], 1.5e5, 1.5e5])
    states = [TieState.SLACK, TieState.ELASTIC, TieState.ELASTIC, TieState.BROKEN, TieState.BROKEN, -1]
    assert found.state[0].tolist() == states
    assert Restraints((Tie(8.0, 2e6, yield_force=1.5e5),)).tie_demand([np.inf, 0.0]).state == [TieState.YIELDED]
    brittle = Restraints((Tie(8.0, 2e6, yield_force=1.5e5, ultimate=0.05),)).tie_demand([0.01, 0.0])
    assert (brittle.state, brittle.force) == ([TieState.BROKEN], [1e5])


def test_a_tie_resists_the_rotations_of_its_side_only():
    turned = np.array([0.002, 0.01])
    held = Restraints((Tie(8.0, 1e6), Tie(8.0, 1e6, side="negative"), Tie(8.0, 1e6, side="both")))
    expected = 8.0 * np.sin([0.002, 0.01, 0.01])
    assert held.tie_demand(turned).elongation == pytest.approx(expected)
    assert held.mirrored(0.8).tie_demand(turned[::-1]).elongation == pytest.approx(expected)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "tie",
    [
        Tie(8.0, 6.3e6, yield_force=7.4e4),
        Tie(8.0, 6.3e6, yield_force=7.4e4, gap=0.02, distance=0.8),
        Tie(6.0, 1e6, gap=0.005),
    ],
)
def test_elongation_is_that_of_an_independent_integration(tie):
    """On its first way out the force of a tie depends on the rotation alone; solve_ivp ends where it turns back."""
    block, start = Block(**FACADE, ties=[tie]), 0.3
    alpha, p, weight = block.alpha_c, block.p, block.mass * block.gravity * block.radius
    times = DT * np.arange(PULSE.size)

    def moved(angle):
        return tie.height * math.sin(angle) + tie.distance * (1.0 - math.cos(angle)) - tie.gap

    def motion(time, state):
        angle, speed = state
        force = min(max(tie.stiffness * moved(angle), 0.0), tie.yield_force)
        arm = tie.height * math.cos(angle) + tie.distance * math.sin(angle)
        ground = np.interp(time, times, PULSE) / block.gravity
        pull = math.sin(alpha - angle) + ground * math.cos(alpha - angle) + force * arm / weight
        return [speed, -p * p * pull]

    def turns(time, state):
        return state[1]

    turns.terminal, turns.direction = True, -1.0
    run = solve_ivp(motion, (0.0, 2.0), (0.0, start), "DOP853", events=turns, max_step=1e-3, rtol=1e-11, atol=1e-14)
    assert run.t_events[0].size
    response = recorded_response(block, PULSE, DT, initial_velocity=start)
    assert response.outcome == Outcome.ROCKS
    demand = block.restraints.tie_demand(response.corner_rotation)
    assert demand.elongation[0] == pytest.approx(moved(run.y[0, -1]), rel=1e-6)
    assert demand.elongation[0] > 0.0
    assert demand.state[0] == (TieState.YIELDED if math.isfinite(tie.yield_force) else TieState.ELASTIC)


@pytest.mark.sweep
@pytest.mark.parametrize("kind", ["yielding", "brittle", "tied wall", "all", "thrust"])
def test_rotations_of_both_corners(kind):
    for number in range(8):
        block, ground, dt, _ = drawn(kind, number)
        count = 20 * (ground.size - 1) + int(400.0 / dt)
        fine = np.interp(np.arange(count) / 20.0, np.arange(ground.size), ground, right=0.0)
        response = recorded_response(block, fine, dt / 20.0, history=True)
        right, left = response.corner_rotation
        ratio = max(right / block.alpha_c, left / block.alpha_2)
        assert ratio == pytest.approx(float(response.peak_rotation_ratio), rel=1e-14, nan_ok=True)
        early = recorded_response(block, ground, dt).corner_rotation
        assert early == pytest.approx(response.corner_rotation, rel=1e-6)
        if response.outcome == Outcome.ROCKS:
            sampled = [np.max(response.rotation), -np.min(response.rotation)]
            assert [right, left] == pytest.approx(np.maximum(sampled, 0.0).tolist(), rel=2e-3, abs=1e-7)


@pytest.mark.sweep
def test_rotations_of_bodies_with_and_without_ties():
    tied = Block(0.8, 9.0, mass=12960.0, ties=[Tie(8.0, 6.3e6)], log=False)
    both = Block.stack([Block(0.8, 9.0, log=False), tied])
    found = recorded_response(both, PULSE, DT).corner_rotation
    alone = recorded_response(tied, PULSE, DT)
    assert np.isnan(found[:, 0]).all()
    assert found[:, 1].tolist() == alone.corner_rotation.tolist()
    assert recorded_response(Block(0.8, 9.0, log=False), PULSE, DT).corner_rotation is None
