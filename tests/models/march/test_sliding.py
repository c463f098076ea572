"""The friction that a motion asks for."""

import math

import numpy as np
import pytest
from recorded_cases import synthetic

from rocking import Tie, impact_friction, recorded_response, sliding_demand
from rocking.body.block import Block


def test_a_resting_body_asks_for_what_the_ground_does():
    motion = synthetic(seed=1, peak=1.0)
    block = Block(width=1.0, height=2.0)
    found = sliding_demand(block, motion, 0.01, friction=0.05)
    assert found.required[0] == pytest.approx(1.0 / block.gravity)
    assert found.share[0] == np.mean(np.abs(motion) / block.gravity > 0.05)
    up = np.full(motion.size, -2.0)
    assert sliding_demand(block, motion, 0.01, vertical=up).required[0] == pytest.approx(1.0 / (block.gravity - 2.0))


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


def test_of_unlike_corners_under_both_components_sample_by_sample():
    """Newton and Euler for the centre of mass at r from the corner: a = theta'' (r_z, -r_x) - theta'^2 r.

    One lane rocks, one overturns, one stays at rest; the motion is that of the solver.
    """
    motion, up = (synthetic(seed=one, n=2500, peak=peak) for one, peak in ((2, 2.4), (7, 1.5)))
    bodies = Block.stack([Block.from_corners(0.2, 0.3, 1.0, 0.6), Block(width=0.22, height=2.5), Block(2.0, 2.0)])
    friction = np.array([0.25, 0.2, np.nan])
    found = sliding_demand(bodies, motion, 0.01, friction=friction, vertical=up, scale=1.25)
    response = recorded_response(bodies, 1.25 * motion, 0.01, vertical=1.25 * up, history=True)
    assert not np.isfinite(response.rotation[1]).all()
    assert response.peak_rotation_ratio[0] > 0.0 == response.peak_rotation_ratio[2]
    for place in range(3):
        one, g, asked = bodies.lane(place), bodies.gravity, []
        rows = zip(response.rotation[place], response.velocity[place], 1.25 * motion, 1.25 * up, strict=True)
        for theta, speed, across, lift in rows:
            if not math.isfinite(theta):
                continue
            s, alpha, p, radius = (
                (1, one.alpha_c, one.p, one.radius) if theta >= 0.0 else (-1, one.alpha_2, one.p_2, one.radius_2)
            )
            x, z = -s * radius * math.sin(alpha - abs(theta)), radius * math.cos(alpha - abs(theta))
            turning = p**2 / (g * radius) * ((g + lift) * x - across * z) if theta or speed else 0.0
            normal = g + lift - turning * x - speed**2 * z
            asked.append(abs(across + turning * z - speed**2 * x) / normal if normal > 0.0 else math.inf)
        assert found.required[place] == pytest.approx(max(asked), rel=1e-9)
        assert found.loses_contact[place] == (max(asked) == math.inf)
        if place < 2:
            assert found.share[place] == pytest.approx(np.mean(np.array(asked) > friction[place]), abs=1e-12)
    assert 0.0 < found.share[0] < 1.0
    assert np.isnan(found.share[2])
    assert found.loses_contact.tolist() == [False, True, False]  # in its fall


def test_a_body_that_the_ground_nearly_lets_fall_asks_for_much():
    """At the last sample, on a body that the ground does not turn: 0.001 over 9.80665 - 9.8 m/s2."""
    motion, up = np.full(50, 0.001), np.append(np.zeros(49), -9.8)
    found = sliding_demand(Block(width=1.0, height=1.0), motion, 0.01, friction=0.01, vertical=up)
    assert found.required.tolist() == [pytest.approx(0.001 / 0.00665)]
    assert (found.share.tolist(), found.loses_contact.tolist()) == ([1 / 50], [False])


def test_a_coefficient_that_is_just_there_is_enough():
    motion = np.full(20, 0.5)
    body = Block(width=1.0, height=1.0)
    assert sliding_demand(body, motion, 0.01, friction=0.5 / body.gravity).share.tolist() == [0.0]


def test_an_impact_of_unlike_corners_asks_for_the_stated_ratio():
    """h (1 - C)/(b_1 + C b_2), the right-hand corner 0.3 and the left-hand one 0.2 beside the centre, 0.6 above."""
    body = Block.from_corners(0.3, 0.2, 1.0, 0.6)
    height, right = body.radius * math.cos(body.alpha_c), body.radius * math.sin(body.alpha_c)
    left = body.radius_2 * math.sin(body.alpha_2)
    assert impact_friction(body, 0.7) == pytest.approx(height * 0.3 / (right + 0.7 * left))
    assert impact_friction(body) == pytest.approx(height * (1 - body.restitution) / (right + body.restitution * left))
    assert right != pytest.approx(left)
