"""Outlines of bodies: corners, and where ties, loads and thrusts act, about the centre of mass."""

import math

import pytest

from rocking import Block, Load, Thrust, Tie
from rocking.outline import Outline, TieLine


def test_a_body_without_symmetry_is_the_triangle_of_its_corners_and_its_centre():
    body = Outline.of(Block.from_corners(0.2, 0.4, 1.0, 0.6))
    assert body.corners == [pytest.approx(one) for one in ((-0.4, 0.0), (0.2, 0.0), (0.0, 1.0))]
    assert (body.width, body.top) == (pytest.approx(0.6), pytest.approx(1.0))
    assert math.isnan(body.height)


def test_what_holds_a_body_acts_behind_the_corner_of_its_rotation():
    ties = [Tie(height=5.5, stiffness=1e6, side="both", distance=0.1), Tie(height=3.0, stiffness=1e6)]
    loads = [Load(2000.0, 6.0, friction=0.4), Load(1000.0, 5.0, friction=0.4, distance=0.1)]
    held = Block(
        width=0.5, height=6.0, mass=8000.0, ties=ties, loads=loads, thrusts=[Thrust(-500.0, 5.0, 0.2)], log=False
    )
    body = Outline.of(held)
    near = [
        tuple(map(pytest.approx, one))
        for one in ((0.15, -0.25, -1, 5.5), (-0.15, 0.25, 1, 5.5), (0.25, -0.25, -1, 3.0))
    ]
    assert [tuple(one) for one in body.ties] == near
    assert body.ties[0]._fields == TieLine._fields
    assert body.loads == (pytest.approx((0.0, 6.0)), pytest.approx((0.15, 5.0)))
    assert body.thrusts == (pytest.approx((0.05, 5.0, -500.0)),)


def test_a_wall_stands_on_its_side():
    assert Outline.of(Block(width=0.5, height=6.0, one_sided=True)).side == 1
    assert Outline.of(Block(width=0.5, height=6.0)).side == 0
