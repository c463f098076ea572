"""Bodies with two corners and before a wall: closed forms, limits, and what they share with the plain body."""

import math

import numpy as np
import pytest
from recorded_cases import synthetic

from rocking import Load, Outcome, OverturningSpectrum, Thrust, Tie, critical_scale, recorded_response, static_capacity
from rocking.body.block import Block
from rocking.march.corner_response import uplift_additions
from rocking.search.capacity import uplift_scale
from rocking.spectrum.body_probability import overturning_probability
from rocking.spectrum.slender_lanes import spectrum_lanes

G = 9.81
STILL = np.zeros(2)


@pytest.mark.parametrize("rebound", [0.3, 0.6, 0.9])
def test_free_rocking_before_a_wall_takes_its_time(rebound):
    block = Block(width=0.8, height=8.0, one_sided=True, rebound=rebound, gravity=G)
    u = 0.8
    times = 1e-3 * np.arange(40_000)
    response = recorded_response(
        block, np.zeros(times.size), 1e-3, "linear", initial_velocity=u * block.p * block.alpha_c, history=True
    )
    total = sum(2.0 * math.atanh(u * rebound**k) for k in range(400)) / block.p
    last = times[np.flatnonzero(response.rotation > 1e-9 * block.alpha_c)[-1]]
    assert last == pytest.approx(total, abs=2e-3 + 3.0 * math.sqrt(2e-9) / block.p / (1.0 - rebound))
    assert np.all(response.rotation >= 0.0)
    # The speeds at the returns are u e^k.
    assert response.impacts == 1 + math.floor(math.log(1e-3 / u) / math.log(rebound))


@pytest.mark.parametrize(("share", "outcome"), [(0.99, Outcome.ROCKS), (1.01, Outcome.OVERTURNS)])
@pytest.mark.parametrize("equation", ["linear", "nonlinear"])
def test_a_single_pulse_overturns_at_the_speed_of_housner(share, outcome, equation):
    block = Block(width=0.8, height=8.0, one_sided=True, gravity=G)
    critical = block.p * (block.alpha_c if equation == "linear" else 2.0 * math.sin(0.5 * block.alpha_c))
    response = recorded_response(block, STILL, 0.01, equation, initial_velocity=share * critical)
    assert response.outcome == outcome


@pytest.mark.parametrize("equation", ["linear", "nonlinear"])
def test_a_wall_and_mirrored_pulses_are_a_free_block_with_its_restitution(equation):
    """Pulses that vanish at the impacts and change sign there do to a free block what equal ones do before a wall."""
    e, dt = 0.6, 1e-3
    wall = Block(width=0.8, height=8.0, one_sided=True, rebound=e, gravity=G)
    free = Block(width=0.8, height=8.0, restitution=e, gravity=G)
    start = 0.7 * wall.p * wall.alpha_c
    alone = recorded_response(wall, np.zeros(9000), dt, equation, initial_velocity=start, history=True)
    landing = int(np.argmin(alone.rotation[100:])) + 100  # the sample next to the first return
    pulse = np.zeros(9000)
    pulse[landing + 100 : landing + 250] = -0.5 * np.sin(np.linspace(0.0, np.pi, 150))
    one = recorded_response(wall, pulse, dt, equation, initial_velocity=start, history=True)
    other = recorded_response(free, -pulse, dt, equation, initial_velocity=start, history=True)
    assert np.abs(other.rotation) == pytest.approx(one.rotation, abs=1e-12)
    assert other.rotation.min() < -0.05 * free.alpha_c
    assert one.peak_rotation_ratio == pytest.approx(other.peak_rotation_ratio, rel=1e-12)


@pytest.mark.parametrize("equation", ["linear", "nonlinear"])
def test_a_body_seen_from_behind_moves_as_its_mirror_image(equation):
    body = Block.from_corners(0.2, 0.3, 1.2, 0.7)
    motion = synthetic(seed=3, peak=3.0)
    one = recorded_response(body, motion, 0.01, equation, history=True)
    other = recorded_response(body.mirrored(), -motion, 0.01, equation, history=True)
    same = recorded_response(body, -motion, 0.01, equation, history=True)
    assert np.array_equal(one.rotation, -other.rotation, equal_nan=True)
    assert one.peak_rotation_ratio == other.peak_rotation_ratio
    # The body itself is not symmetric: a mirrored motion moves it in another way.
    assert not np.allclose(one.rotation, -same.rotation, rtol=1e-3, atol=1e-4, equal_nan=True)


def test_a_wall_answers_for_one_sense_only():
    wall = Block(width=0.4, height=4.0, one_sided=True)
    push = np.concatenate([np.zeros(5), np.full(12, 2.0), np.zeros(5)])
    assert recorded_response(wall, push, 0.01).outcome == Outcome.AT_REST
    assert recorded_response(wall, -push, 0.01).outcome == Outcome.ROCKS
    assert recorded_response(wall.mirrored(), push, 0.01).outcome == Outcome.ROCKS


@pytest.mark.sweep
def test_lanes_do_not_change_each_other():
    motion = synthetic(seed=5, peak=4.0)
    tie = Tie(1.0, 1e5, gap=0.001)
    bodies = [
        Block(width=0.4, height=2.0),
        Block(width=0.4, height=2.0, one_sided=True),
        Block.from_corners(0.15, 0.25, 1.0, 0.6),
        Block(width=0.4, height=2.0, mass=1000.0, ties=[tie]),
        Block(width=0.4, height=2.0, mass=1000.0, loads=[Load(500.0, 2.0, friction=0.02)]),
    ]
    together = recorded_response(Block.stack(bodies), motion, 0.01, scale=[0.7, 1.0, 1.4], history=True)
    for place, body in enumerate(bodies):
        alone = recorded_response(body, motion, 0.01, scale=[0.7, 1.0, 1.4], history=True)
        for name in ("peak_rotation_ratio", "outcome", "impacts", "overturning_time"):
            assert np.array_equal(getattr(together, name)[:, place], getattr(alone, name), equal_nan=True)
        assert np.array_equal(together.rotation[:, place], alone.rotation, equal_nan=True)
    threads = recorded_response(Block.stack(bodies * 40), motion, 0.01, threads=2)
    assert np.array_equal(threads.peak_rotation_ratio, np.tile(together.peak_rotation_ratio[1], 40))


def test_uplift_is_where_the_motion_begins():
    motion = synthetic(seed=7, peak=1.0)
    held = {"width": 0.5, "height": 3.0, "mass": 2000.0}
    bodies = [
        Block(width=0.5, height=3.0, one_sided=True),
        Block(width=0.5, height=3.0, one_sided=True).mirrored(),
        Block.from_corners(0.2, 0.3, 1.5, 0.9),
        Block(**held, thrusts=[Thrust(800.0, 2.0)]),
        Block(**held, thrusts=[Thrust(-800.0, 2.0)], loads=[Load(3000.0, 3.0, friction=0.1)]),
    ]
    for body in bodies:
        lifting = uplift_scale(body.lanes(1), motion)[0]
        assert recorded_response(body, motion, 0.01, scale=lifting * (1.0 - 1e-9)).outcome == Outcome.AT_REST
        assert recorded_response(body, motion, 0.01, scale=lifting * (1.0 + 1e-9)).outcome == Outcome.ROCKS


@pytest.mark.sweep
def test_capacities_and_probabilities_are_those_of_single_runs():
    motion = synthetic(seed=11, peak=2.0)
    bodies = Block.stack(
        [
            Block(width=0.4, height=2.0, one_sided=True, log=False),
            Block.from_corners(0.15, 0.25, 1.0, 0.6, log=False),
            Block(width=0.4, height=2.0, mass=1000.0, ties=[Tie(1.0, 2e4, gap=0.001)], log=False),
        ]
    )
    found = critical_scale(bodies, motion, 0.01, factor_max=8.0)
    finite = np.isfinite(found.safety_factor)
    assert finite.any()
    for place in np.flatnonzero(finite):
        edge = found.safety_factor[place]
        assert recorded_response(bodies.lane(place), motion, 0.01, scale=edge).outcome == Outcome.OVERTURNS
        below = edge * (1.0 - 3e-6)
        assert recorded_response(bodies.lane(place), motion, 0.01, scale=below).outcome == Outcome.ROCKS
    probability = overturning_probability(bodies, motion, 0.01, factor_max=8.0)
    near = probability.factor_50[finite] / found.safety_factor[finite]
    assert np.all((near > 0.6) & (near < 1.6))


@pytest.mark.sweep
@pytest.mark.parametrize("side", [1, -1])
def test_the_spectrum_before_a_wall_meets_marches_of_its_own(side):
    motion = synthetic(seed=13, n=1200, peak=2.0)
    slender = np.array([5.0, 8.0, 12.0])
    blocks = Block(half_width=np.array([0.15, 0.3, 0.4]), half_height=slender * [0.15, 0.3, 0.4], one_sided=True)
    blocks = blocks if side > 0 else blocks.mirrored()
    spectrum = OverturningSpectrum(spectrum_lanes(motion, 0.01, side=side))
    assert spectrum.covers(blocks).all()
    assert not spectrum.covers(blocks.mirrored()).any()
    assert not spectrum.covers(Block(width=0.3, height=2.0, restitution=0.4).lanes(3)).any()
    own = overturning_probability(blocks, motion, 0.01, factor_max=20.0, slender_limit=False)
    limit = overturning_probability(blocks, motion, 0.01, factor_max=20.0)
    assert limit.slender.all()
    for read, within in ((spectrum.factors(blocks, factor_max=20.0), (0.1, 0.15)), (limit, (0.05, 0.1))):
        assert np.log(read.factor_mean / own.factor_mean) == pytest.approx(np.zeros(3), abs=within[0])
        assert np.log(read.factor_10 / own.factor_10) == pytest.approx(np.zeros(3), abs=within[1])


def test_static_capacity_is_that_of_the_weight_and_of_the_tie():
    free = Block(width=0.5, height=3.0)
    angles = np.linspace(0.0, 0.3, 7)
    assert static_capacity(free, angles) == pytest.approx(free.gravity * np.tan(free.alpha_c - angles))
    bar = Tie(2.5, 1e6, gap=0.01, yield_force=2e3, ultimate=0.2)
    tied = Block(width=0.5, height=3.0, mass=2000.0, ties=[bar])
    more = static_capacity(tied, angles) - static_capacity(free, angles)
    assert more[0] == 0.0
    out = 2.5 * np.sin(angles)
    force = np.where(out - 0.01 < 0.2, np.clip(1e6 * (out - 0.01), 0.0, 2e3), 0.0)
    expected = force * 2.5 * np.cos(angles) / (2000.0 * tied.radius) / np.cos(tied.alpha_c - angles)
    assert more == pytest.approx(expected)


def test_static_capacity_of_loads_and_thrusts_on_both_sides():
    """A body 0.55 m wide: moments about either corner of weights, friction and a thrust, over m R, by hand."""
    roof, beam = Load(800.0, 1.8, friction=0.2, distance=0.15), Load(300.0, 1.2, friction=0.4)
    made = Block.from_corners(
        0.2, 0.35, 1.1, 0.6, mass=900.0, gravity=G, loads=[roof, beam], thrusts=[Thrust(60.0, 1.5, 0.1)],
        ties=[Tie(2.0, 3e4, gap=0.01, ultimate=0.35, side="negative", distance=0.05), Tie(1.9, 5e4, yield_force=700.0)],
    )  # fmt: skip
    angles = np.array([0.0, 0.002, 0.05, 0.1, 0.3])
    sin, cos, versed = np.sin(angles), np.cos(angles), 1.0 - np.cos(angles)
    for side, base, radius in ((1, 0.2, made.radius), (-1, 0.35, made.radius_2)):
        total = 900.0 * G * radius * np.sin(math.atan2(base, 1.1) - angles)
        for load, near in ((roof, 0.15), (beam, 0.275)):
            xi = near if side == 1 else 0.55 - near
            total += load.weight * (xi * cos - load.height * sin)
            out = load.height * sin + xi * versed
            force = np.minimum(load.friction * load.weight, load.friction * load.weight / 1e-3 * out)
            total += force * (load.height * cos + xi * sin)
        xi = 0.1 if side == 1 else 0.45
        total -= side * 60.0 * (1.5 * cos + xi * sin)
        if side == 1:
            total += np.minimum(5e4 * 1.9 * sin, 700.0) * 1.9 * cos
        else:
            out = 2.0 * sin + 0.05 * versed - 0.01
            total += np.where(out < 0.35, 3e4 * np.maximum(out, 0.0), 0.0) * (2.0 * cos + 0.05 * sin)
        expected = total / (900.0 * radius * np.cos(math.atan2(base, 1.1) - angles))
        assert static_capacity(made, angles, side=side) == pytest.approx(expected, rel=1e-12)
    assert static_capacity(made, 0.1).shape == (1,)
    plain = Block.from_corners(0.2, 0.35, 1.1, 0.6, gravity=G)
    assert static_capacity(plain, 1.5707, side=-1).shape == (1,)
    assert uplift_additions(Block.stack([plain, made])) == pytest.approx(
        np.array(
            [
                [0.0, (800.0 * 0.15 + 300.0 * 0.275 - 60.0 * 1.5) / (900.0 * G * 1.1)],
                [0.0, (800.0 * 0.4 + 300.0 * 0.275 + 60.0 * 1.5) / (900.0 * G * 1.1)],
            ]
        ),
        rel=1e-12,
    )


@pytest.mark.parametrize(("angle", "side"), [(-0.01, 1), (math.pi / 2, 1), (0.1, 0), (0.1, 2), (-1e-9, -1)])
def test_static_capacity_outside_a_quarter_turn_is_refused(angle, side):
    with pytest.raises(ValueError, match="expected angles from 0 to pi/2 and 1 or -1"):
        static_capacity(Block(width=0.5, height=3.0), [0.0, angle], side=side)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"rebound": 0.5}, "rebound: expected one_sided=True as well"),
        ({"loads": [Load(1e3, 2.0)]}, "because a load moves with the body"),
        ({"one_sided": "yes"}, "one_sided: expected True or False"),
    ],
)
def test_wrong_bodies_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        Block(**({"width": 0.5, "height": 2.0} | given))


def test_what_a_march_cannot_do_is_refused():
    motion = synthetic(n=100)
    wall = Block(width=0.5, height=2.0, one_sided=True)
    tied = Block(width=0.5, height=2.0, mass=100.0, ties=[Tie(1.0, 1e5)])
    with pytest.raises(ValueError, match="a one-sided body has a wall behind it"):
        recorded_response(wall, motion, 0.01, initial_rotation=-0.01)
    with pytest.raises(ValueError, match="a one-sided body has a wall behind it"):
        recorded_response(wall, motion, 0.01, initial_velocity=-0.01)
    with pytest.raises(ValueError, match=r"got 0\.01 rad and 0 rad/s"):
        recorded_response(wall.mirrored(), motion, 0.01, initial_rotation=0.01)
    with pytest.raises(ValueError, match=r"got 0 rad and 0\.02 rad/s"):
        recorded_response(Block.stack([wall, wall.mirrored()]), motion, 0.01, initial_velocity=0.02)
    for held in (wall, wall.mirrored()):  # away from the wall, and towards it from where it has room
        recorded_response(held, motion, 0.01, initial_rotation=0.01 * held.side, initial_velocity=-0.01 * held.side)
        recorded_response(held, motion, 0.01, initial_velocity=0.01 * held.side)
    with pytest.raises(ValueError, match="expected 'nonlinear' for a body with ties"):
        recorded_response(tied, motion, 0.01, "linear")
    with pytest.raises(ValueError, match="two different corners"):
        recorded_response(Block.from_corners(0.2, 0.3, 1.0, 0.6), motion, 0.01, "linear", gain="tangent")
