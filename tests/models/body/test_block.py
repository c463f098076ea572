"""Geometry and constants of the block (F1, V1, V2) and its ranges."""

import dataclasses

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.body.block_lanes import STANDARD_GRAVITY


def block(radius, **options):
    return Block(half_width=0.5, half_height=np.sqrt(radius**2 - 0.25), gravity=9.81, **options)


@pytest.mark.parametrize(
    ("radius", "half_height", "alpha", "p", "restitution"),
    [(2.0, 1.936492, 0.25268026, 1.9180068, 0.90625), (4.0, 3.968627, 0.12532783, 1.3562356, 0.9765625)],  # V1 (D)
)
def test_constants_of_blocks_a_and_b(radius, half_height, alpha, p, restitution):
    body = block(radius)
    assert body.half_height == pytest.approx(half_height, abs=5e-7)
    assert body.alpha_c == pytest.approx(alpha, abs=5e-9)
    assert body.p == pytest.approx(p, abs=5e-8)
    assert body.restitution == pytest.approx(restitution, abs=1e-14)
    assert body.radius == pytest.approx(radius, rel=1e-14)
    assert body.slenderness == pytest.approx(half_height / 0.5, rel=1e-6)


@pytest.mark.parametrize(
    ("radius", "critical", "energy"), [(2.0, 1.334764, 1.331216), (4.0, 0.913695, 0.913097)]
)  # V2 (D)
def test_critical_impulse_is_that_of_eq_9_and_near_that_of_the_energy(radius, critical, energy):
    body = block(radius)
    assert body.critical_impulse == pytest.approx(critical, abs=5e-7)
    nonlinear = 2.0 * 9.81 * np.sin(0.5 * body.alpha_c) / (body.p * np.cos(body.alpha_c))  # F1
    assert nonlinear == pytest.approx(energy, abs=5e-7)


def test_gain_of_the_paper_is_that_of_its_geometry():  # F1: Eq. (3) with (4) is p^2 cos(alpha)/g
    body = block(2.0)
    ground = 0.75 * 0.5 / body.radius**2 * 9.81
    gain = body.slenderness * ground / 9.81
    assert gain == pytest.approx(body.p**2 * np.cos(body.alpha_c) / 9.81, rel=1e-13)
    assert gain * body.critical_impulse == pytest.approx(body.p * body.alpha_c, rel=1e-13)


def test_gravity_of_a_block_is_standard_unless_given_and_one_number():
    assert Block(half_width=0.5, half_height=2.0).gravity == STANDARD_GRAVITY == 9.80665
    assert Block(half_width=0.5, half_height=2.0).side == 0
    for make, numbers in ((Block, (0.5, 2.0)), (Block.from_parameters, (2.0, 0.2)), (Block.from_corners, [0.3] * 4)):
        with pytest.raises(ValueError, match=r"^gravity: .*not an array"):
            make(*numbers, 0.9, [9.81])


def test_fields_broadcast_to_the_lanes():
    body = Block(half_width=0.5, half_height=[2.0, 3.0, 4.0], restitution=0.9)
    assert body.shape == (3,)
    assert body.restitution.tolist() == [0.9] * 3
    assert body.half_width.tolist() == [0.5] * 3
    assert Block(half_width=0.5, half_height=2.0, restitution=[0.8, 0.9]).shape == (2,)
    assert Block(half_width=0.5, half_height=2.0).shape == ()
    assert isinstance(Block(half_width=0.5, half_height=2.0).p, float)


def test_full_sizes_are_twice_the_halves():
    full, halves = Block(width=0.6, height=[2.4, 3.0]), Block(half_width=0.3, half_height=[1.2, 1.5])
    for name in ("half_width", "half_height", "width", "height", "p", "alpha_c", "restitution", "radius"):
        assert np.array_equal(getattr(full, name), getattr(halves, name))
    assert full.width.tolist() == [0.6, 0.6]
    assert full.lane(1).height == 3.0
    assert np.isnan(Block.from_parameters(2.0, 0.2, 0.9).width)


def test_sizes_by_position_are_full_ones():
    block = Block(0.9, 9.0, 0.95, 9.81)
    assert (block.half_width, block.half_height, block.restitution, block.gravity) == (0.45, 4.5, 0.95, 9.81)


def test_a_block_can_still_be_replaced_field_by_field():
    other = dataclasses.replace(Block(width=0.6, height=2.4), half_height=2.0, restitution=0.8)
    assert (other.width, other.height, other.restitution) == (0.6, 4.0, 0.8)


@pytest.mark.parametrize(
    ("sizes", "found"),
    [
        ({}, "no size"),
        ({"half_width": 0.3}, "half_width"),
        ({"width": 0.6}, "width"),
        ({"half_width": 0.3, "height": 2.4}, "height and half_width"),
        ({"half_width": 0.3, "half_height": 1.2, "width": 0.6, "height": 2.4}, "width and height and half_width and"),
    ],
)
def test_one_pair_of_sizes_is_expected(sizes, found):
    with pytest.raises(
        ValueError, match=f"expected width and height, or half_width and half_height, in m; got {found}"
    ):
        Block(**sizes)


def test_mass_is_that_of_the_full_size_or_the_one_given():
    size = {"width": 0.5, "height": 3.0}
    assert Block(**size, density=1800.0, length=2.0).mass == pytest.approx(0.5 * 3.0 * 2.0 * 1800.0)
    assert Block(**size, mass=700.0).mass == 700.0
    assert np.isnan(Block(**size).mass)
    for given in ({"density": 1800.0}, {"length": 2.0}, {"length": 2.0, "mass": 700.0}):
        with pytest.raises(ValueError, match=r"^mass: expected mass in kg, or density in kg/m3 and length in m"):
            Block(**size, **given)


def test_arrays_of_a_block_cannot_be_changed():
    body = Block(half_width=0.5, half_height=[2.0, 3.0])
    with pytest.raises(ValueError, match="read-only"):
        body.p[0] = 1.0


def test_blocks_in_different_gravity_do_not_stack():
    with pytest.raises(ValueError, match="one gravity"):
        Block.stack([Block(half_width=0.5, half_height=2.0), Block(half_width=0.5, half_height=2.0, gravity=9.81)])


def test_body_that_is_no_rectangle_has_the_constants_given():
    body = Block.from_parameters(p=1.9180068, alpha=0.25268026, restitution=0.9, gravity=9.81)
    assert body.critical_impulse == pytest.approx(1.334764, abs=1e-6)
    assert body.radius == pytest.approx(2.0, abs=1e-6)
    assert np.isnan([body.half_width, body.half_height]).all()
    assert body.warnings == ()


BAD = {
    "half_width": [0.0, np.nan],
    "half_height": [-1.0, np.inf, "tall", [[2.0]]],
    "gravity": [0.0],
    "restitution": [1.1, -0.1, np.nan, "elastic", [[0.9]]],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in BAD.items() for value in values])
def test_bad_fields_are_named(name, value):
    with pytest.raises(ValueError, match=name):
        Block(**{"half_width": 0.5, "half_height": 2.0, name: value})


@pytest.mark.parametrize(
    ("p", "alpha", "message"),
    [(0.0, 0.2, "p: "), (1.0, 0.0, "alpha: "), (1.0, 0.5 * np.pi, "radians"), (1.0, 1.6, "radians")],
)
def test_bad_parameters_are_named(p, alpha, message):
    with pytest.raises(ValueError, match=message):
        Block.from_parameters(p=p, alpha=alpha, restitution=0.9)


@pytest.mark.parametrize("width", [0.1, 0.3, 0.35, 0.5, 0.7, 1.1])
def test_block_of_exactly_the_least_slenderness_is_within_the_range(width):
    exact, below = Block(half_width=width, half_height=3.0 * width), Block(half_width=width, half_height=2.999 * width)
    assert (exact.slender, below.slender) == (True, False)
    assert not any("slenderness" in warning for warning in exact.warnings)
    assert any("slenderness" in warning for warning in below.warnings)
