"""Lanes of blocks: both corners, a wall and what holds a body, seen from behind, varied, chosen and stacked."""

import math

import numpy as np
import pytest

from rocking import Block, Load, Thrust, Tie
from rocking.body.block_lanes import FEATURES

G = 9.7
LEFT = Block.from_corners(0.35, 0.2, 1.1, 0.6, gravity=G)  # weaker about its left-hand corner
RIGHT = Block.from_corners(0.2, 0.35, 1.1, 0.6, gravity=G)
PLAIN = Block(width=0.5, height=3.0, gravity=G)
WALL = Block(width=0.5, height=3.0, one_sided=True, gravity=G)
TIED = Block(width=0.5, height=3.0, mass=2000.0, ties=[Tie(2.0, 1e6)], gravity=G)
SKEW_TIED = Block.from_corners(0.35, 0.2, 1.1, 0.6, mass=900.0, ties=[Tie(2.0, 1e6)], gravity=G)
BEHIND = WALL.mirrored()
EVERY = Block.stack([PLAIN, LEFT, WALL, BEHIND, TIED, SKEW_TIED])
CORNERS = (("alpha_c", "alpha_2"), ("p", "p_2"), ("radius", "radius_2"), ("restitution", "restitution_2"))


def impulse(alpha, p):
    """I_1c = g alpha/(p cos alpha)."""
    return G * alpha / (p * math.cos(alpha))


def test_which_bodies_are_symmetric_restrained_and_free():
    assert EVERY.symmetric.tolist() == [True, False, True, True, True, False]
    assert EVERY.restrained.tolist() == [False, False, False, False, True, True]
    assert EVERY.free.tolist() == [True, False, False, False, False, False]
    assert EVERY.side.tolist() == [0, 0, 1, -1, 0, 0]
    for place, body in enumerate((PLAIN, LEFT, WALL, BEHIND, TIED, SKEW_TIED)):
        for name in ("symmetric", "restrained", "free"):
            assert np.shape(getattr(body, name)) == ()
            assert bool(getattr(body, name)) == getattr(EVERY, name)[place]


@pytest.mark.parametrize("name", ["alpha_2", "p_2", "restitution_2"])
def test_each_constant_of_the_corners_may_break_the_symmetry(name):
    values = {one: getattr(PLAIN, one) for corner in CORNERS for one in corner}
    assert Block.restored(G, **values).symmetric
    assert not Block.restored(G, **values | {name: 1.01 * values[name]}).symmetric


@pytest.mark.parametrize(
    ("features", "known"),
    [
        (FEATURES, [True] * 6),
        (("corners", "wall"), [True, True, True, True, False, False]),
        (("wall",), [True, False, True, True, False, False]),
        (("restraints",), [True, False, False, False, True, False]),
        ((), [True, False, False, False, False, False]),
    ],
)
def test_what_a_model_knows_of_bodies(features, known):
    assert EVERY.known_to(features).tolist() == known


def test_angles_are_over_that_of_the_corner_that_the_body_turns_about():
    rotation = np.array([-0.1, -1e-9, 0.0, 0.1])
    assert LEFT.ratio(rotation) == pytest.approx(rotation / np.array([*[LEFT.alpha_2] * 2, *[LEFT.alpha_c] * 2]))
    for side in (1, -1):
        wall = Block.from_corners(0.35, 0.2, 1.1, 0.6, one_sided=True, rebound=0.4, gravity=G)
        wall = wall if side == 1 else wall.mirrored()
        assert wall.ratio(rotation) == pytest.approx(rotation / wall.alpha_c)


def test_a_body_seen_from_behind_has_its_corners_exchanged():
    seen = LEFT.mirrored()
    for one, other in CORNERS:
        assert getattr(LEFT, one) != getattr(LEFT, other)
        assert (getattr(seen, one), getattr(seen, other)) == (getattr(LEFT, other), getattr(LEFT, one))
    assert (seen.side, WALL.mirrored().side, BEHIND.mirrored().side) == (0, -1, 1)
    assert seen.restraints is None
    assert LEFT.alpha_c == pytest.approx(math.atan2(0.35, 1.1))


def test_what_holds_a_body_is_seen_from_behind_on_the_whole_base():
    """A body 0.55 m wide: 0.1 m behind the right-hand corner is 0.45 m behind the left-hand one."""
    held = Block.from_corners(
        0.35, 0.2, 1.1, 0.6, mass=900.0, thrusts=[Thrust(70.0, 1.5, 0.1)], loads=[Load(80.0, 1.2, 0.3, 0.15)], gravity=G
    )
    for seen in (held.mirrored(), Block.stack([PLAIN, held]).mirrored().lane(1)):
        (thrust,), (load,) = seen.restraints.thrusts, seen.restraints.loads
        assert (thrust.force, thrust.height, load.weight, load.height, load.friction) == (-70.0, 1.5, 80.0, 1.2, 0.3)
        assert (thrust.distance, load.distance) == pytest.approx((0.45, 0.4))
    both = Block.stack([PLAIN, TIED]).mirrored()
    assert both.restraints[0] is None
    assert both.restraints[1].ties[0].side == "negative"


def test_the_weaker_body_stands_on_the_smaller_angle_that_it_turns_about():
    for body, first in ((LEFT, False), (RIGHT, True)):
        found = body.weaker
        for one, other in CORNERS:
            assert getattr(found, one) == getattr(body, one if first else other)
        assert found.slenderness == pytest.approx(1.1 / 0.2)
        assert found.critical_impulse == pytest.approx(impulse(found.alpha_c, found.p), rel=1e-14)
    assert RIGHT.weaker is RIGHT
    assert PLAIN.weaker is PLAIN
    many = Block.stack([LEFT, RIGHT, PLAIN])
    assert many.weaker.alpha_c.tolist() == [LEFT.alpha_2, RIGHT.alpha_c, PLAIN.alpha_c]
    assert many.weaker.restitution.tolist() == [LEFT.restitution_2, RIGHT.restitution, PLAIN.restitution]
    assert many.weaker.lane(0).critical_impulse == LEFT.weaker.critical_impulse
    assert type(LEFT.weaker.p) is np.float64
    # Before a wall the body turns about one corner only, the stronger one as it may be.
    strong = Block.from_corners(0.35, 0.2, 1.1, 0.6, one_sided=True, rebound=0.4, gravity=G)
    assert strong.weaker is strong
    assert strong.mirrored().weaker.alpha_c == strong.alpha_c
    weak = Block.from_corners(0.2, 0.35, 1.1, 0.6, one_sided=True, rebound=0.4, gravity=G)
    assert weak.weaker is weak
    assert weak.mirrored().weaker.alpha_c == weak.alpha_c


def test_varied_bodies_have_other_angles_and_restitutions():
    """alpha exp(-loss); the second restitution keeps its share of the first, but for the bound of 1."""
    bodies = Block.stack([LEFT, RIGHT, PLAIN, WALL])
    loss, restitution = np.array([0.1, -0.2, 0.3, 0.0]), np.array([0.5 * LEFT.restitution, 0.99, 0.7, 0.2])
    found = bodies.varied(loss, restitution)
    assert found.alpha_c == pytest.approx(bodies.alpha_c * np.exp(-loss), rel=1e-14)
    assert found.alpha_2 == pytest.approx(bodies.alpha_2 * np.exp(-loss), rel=1e-14)
    assert found.restitution.tolist() == restitution.tolist()
    assert RIGHT.restitution_2 > RIGHT.restitution  # its share of 0.99 is above 1
    assert found.restitution_2 == pytest.approx([0.5 * LEFT.restitution_2, 1.0, 0.7, 0.2], rel=1e-14)
    for name in ("p", "p_2", "radius", "radius_2", "half_width", "side", "gravity"):
        assert np.array_equal(getattr(found, name), getattr(bodies, name), equal_nan=True)
    for lane in range(4):
        alpha = float(found.alpha_c[lane])
        assert found.slenderness[lane] == pytest.approx(1.0 / math.tan(alpha), rel=1e-14)
        assert found.critical_impulse[lane] == pytest.approx(impulse(alpha, bodies.p[lane]), rel=1e-14)
    assert bodies.alpha_c[0] == LEFT.alpha_c


def test_a_stack_keeps_every_remark_once_and_what_holds_each_body():
    squat, short = (Block(1.0, 2.0, log=False), Block(0.02, 0.04, log=False))
    stacked = Block.stack([squat, squat, short])
    assert len(squat.warnings) == 1
    assert len(short.warnings) == 2
    assert stacked.warnings == (*squat.warnings, short.warnings[0])
    assert stacked.shape == (3,)
    assert stacked.restraints is None
    two = Block.stack([PLAIN, Block.stack([TIED, PLAIN]), TIED])
    assert two.restrained.tolist() == [False, True, False, True]
    assert np.isnan(two.mass).tolist() == [True, False, True, False]
    assert two.shape == (4,)
    with pytest.raises(ValueError, match=r"expected one gravity for all blocks of a stack, found \[\]"):
        Block.stack([])


def test_chosen_lanes_keep_gravity_remarks_and_what_holds_them():
    for places, expected in (([4, 1, 4], [4, 1, 4]), (slice(4, None), [4, 5]), (EVERY.side != 0, [2, 3])):
        some = EVERY.take(places)
        assert some.alpha_2.tolist() == EVERY.alpha_2[expected].tolist()
        assert (some.gravity, some.warnings) == (G, EVERY.warnings)
        assert some.restrained.tolist() == EVERY.restrained[expected].tolist()
    assert EVERY.take([0, 1]).restraints is None
    assert EVERY.lane(0).restraints is None
    assert EVERY.lane(4).restraints == TIED.restraints
    assert TIED.lanes(3).restraints.tolist() == [TIED.restraints] * 3
    assert type(EVERY.lane(2).side) is int
    assert type(TIED.mirrored().mirrored().mass) is float


def test_a_body_is_restored_with_what_holds_it():
    values = {"alpha_c": 0.2, "p": 1.7, "half_width": 0.4}
    body, held = Block.restored(G, **values), Block.restored(G, TIED.restraints, **values)
    assert (body.restraints, body.warnings, body.gravity, body.half_width) == (None, (), G, 0.4)
    assert held.restraints is TIED.restraints
    assert body.slenderness == pytest.approx(1.0 / math.tan(0.2), rel=1e-14)
    assert body.critical_impulse == pytest.approx(impulse(0.2, 1.7), rel=1e-14)
