"""The friction that a motion asks for."""

import math

import numpy as np
import pytest
from recorded_cases import synthetic

from rocking import Tie, impact_friction, recorded_response, sliding_demand
from rocking.block import Block


def test_a_resting_body_asks_for_what_the_ground_does():
    motion = synthetic(seed=1, peak=1.0)
    block = Block(width=1.0, height=2.0)
    found = sliding_demand(block, motion, 0.01, friction=0.05)
    assert found.required[0] == pytest.approx(1.0 / block.gravity)
    assert found.share[0] == np.mean(np.abs(motion) / block.gravity > 0.05)
    up = np.full(motion.size, -2.0)
    assert sliding_demand(block, motion, 0.01, vertical=up).required[0] == pytest.approx(1.0 / (block.gravity - 2.0))


def test_it_is_that_of_the_accelerations_of_the_centre_of_mass():
    motion, dt = synthetic(seed=2, n=6000, dt=0.0025, peak=3.0), 0.0025
    block = Block(width=0.5, height=2.5)
    response = recorded_response(block, motion, dt, history=True)
    side, angle = np.sign(response.rotation), block.alpha_c - np.abs(response.rotation)
    x, z = -side * block.radius * np.sin(angle), block.radius * np.cos(angle)
    across, up = (np.gradient(np.gradient(values, dt), dt) for values in (x, z))
    turning = np.abs(np.convolve(side, [1.0, 0.0, 0.0, 0.0, -1.0], "same")) == 0.0  # away from impacts
    inside = turning & (side != 0.0)
    asked = np.abs(motion + across)[inside] / (block.gravity + up)[inside]
    found = sliding_demand(block, motion, dt).required[0]
    assert found >= 0.98 * np.max(asked)
    assert found <= 1.1 * np.max(asked)


def test_nothing_is_said_of_walls_and_ties():
    motion = synthetic(seed=1, peak=2.0)
    bodies = Block.stack(
        [
            Block(width=0.5, height=2.0, one_sided=True),
            Block(width=0.5, height=2.0, mass=100.0, ties=[Tie(1.0, 1e4)]),
            Block.from_corners(0.2, 0.3, 1.0, 0.6),
        ]
    )
    found = sliding_demand(bodies, motion, 0.01, friction=0.3)
    assert np.isnan(found.required[:2]).all()
    assert np.isfinite(found.required[2])
    with pytest.raises(ValueError, match="friction: expected coefficients above 0"):
        sliding_demand(bodies, motion, 0.01, friction=0.0)


def test_impacts_ask_for_the_stated_ratio():
    pier = Block(half_width=1.0, half_height=8.0)
    assert impact_friction(pier) == pytest.approx(0.09, abs=5e-3)
    assert impact_friction(pier, 0.9 * pier.restitution) == pytest.approx(0.51, abs=5e-3)
    assert math.isclose(impact_friction(Block.from_corners(0.2, 0.3, 1.0, 0.6), 1.0), 0.0)


@pytest.mark.parametrize("lift", [-2.0, 3.0])
def test_a_steady_vertical_acceleration_is_gravity(lift):
    motion = synthetic(seed=2, n=3000, dt=0.005, peak=3.0)
    size = {"width": 0.5, "height": 2.5, "restitution": 0.9}
    found = sliding_demand(Block(**size), motion, 0.005, friction=0.2, vertical=np.full(motion.size, lift))
    heavier = sliding_demand(Block(**size, gravity=Block(**size).gravity + lift), motion, 0.005, friction=0.2)
    assert found.required == pytest.approx(heavier.required, rel=1e-3)
    assert found.share == pytest.approx(heavier.share, abs=5e-3)
