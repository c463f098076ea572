"""The two corners of a body: bodies put together from points, the rebound from a wall, and what is refused."""

import math

import numpy as np
import pytest

from rocking import Block, Load
from rocking.body.corners import both_corners, corner, rebound_of, sorrentino

G = 9.7


def test_a_corner_is_that_of_its_closed_forms():
    """R^2 = b^2 + h^2, tan alpha = b/h, p^2 = g R/(rho^2 + R^2), and C by angular momentum."""
    near, far, height, gyration = (np.array(pair) for pair in ((0.3, 0.5), (0.2, 0.1), (1.1, 1.3), (0.6, 0.8)))
    found = corner(near, far, height, gyration, G)
    radius = np.hypot(near, height)
    assert found.radius == pytest.approx(radius, rel=1e-14)
    assert found.alpha == pytest.approx(np.arctan(near / height), rel=1e-14)
    assert found.p == pytest.approx(np.sqrt(G * radius / (gyration**2 + radius**2)), rel=1e-14)
    most = (gyration**2 + height**2 - near * far) / (gyration**2 + np.hypot(far, height) ** 2)
    assert found.most == pytest.approx(most, rel=1e-14)


def test_loads_that_are_carried_are_points_of_the_body():
    """Moments of a body and of two points about its right-hand corner; one stands on the middle of the base."""
    loads = [Load(200.0 * G, 1.8, distance=0.1), Load(150.0 * G, 2.3), Load(99.0, 1.0, friction=0.5)]
    own, near, far, height, gyration = np.array([800.0, 600.0]), 0.35, 0.2, 1.1, 0.6
    first, second, mass = both_corners(*(np.array(one) for one in (near, far, height, gyration)), own, loads, G)
    points = ((own, near, height, gyration), (200.0, 0.1, 1.8, 0.0), (150.0, 0.275, 2.3, 0.0))
    total = sum(m for m, *_ in points)
    b = sum(m * x for m, x, *_ in points) / total
    h = sum(m * z for m, _, z, _ in points) / total
    inertia = sum(m * (x**2 + z**2 + r**2) for m, x, z, r in points)
    assert mass == pytest.approx(total, rel=1e-14)
    assert first.alpha == pytest.approx(np.arctan(b / h), rel=1e-13)
    assert second.alpha == pytest.approx(np.arctan((near + far - b) / h), rel=1e-13)
    assert first.radius == pytest.approx(np.hypot(b, h), rel=1e-13)
    assert first.p == pytest.approx(np.sqrt(total * G * np.hypot(b, h) / inertia), rel=1e-13)
    block = Block.from_corners(near, far, height, gyration, mass=own, loads=loads, gravity=G)
    assert block.p.tolist() == first.p.tolist()
    assert [held.loads for held in block.restraints] == [(loads[2],)] * 2
    carrying = Block(width=0.5, height=3.0, mass=500.0, loads=loads[:1], gravity=G)
    assert (carrying.mass, carrying.restraints) == (pytest.approx(700.0), None)
    assert math.tan(carrying.alpha_c) == pytest.approx((500.0 * 0.25 + 200.0 * 0.1) / (500.0 * 1.5 + 200.0 * 1.8))
    assert [held.loads for held in Block(width=0.5, height=3.0, mass=500.0, loads=loads[2:]).lanes(1).restraints] == [
        (loads[2],)
    ]


@pytest.mark.parametrize("offset", [0.25, -0.25, 0.3, -0.3])
def test_the_centre_of_mass_stands_between_the_corners(offset):
    with pytest.raises(ValueError, match="expected a centre of mass above the base, between its two corners"):
        Block(width=0.5, height=3.0, offset=offset)
    assert Block(width=0.5, height=3.0, offset=0.8 * offset).p > 0.0


def test_a_centre_of_mass_beside_the_middle_is_nearer_to_one_corner():
    body = Block(width=0.5, height=3.0, offset=0.05)
    assert np.tan([body.alpha_c, body.alpha_2]) == pytest.approx([0.2 / 1.5, 0.3 / 1.5])


def test_the_rebound_of_the_convention_is_its_formula():
    alpha = np.array([0.1, 0.4])
    expected = (1.0 - 1.5 * np.sin(alpha) ** 2) ** 2 * (1.5 * np.cos(alpha) ** 2 - 1.0)
    assert sorrentino(alpha) == pytest.approx(expected, rel=1e-13)
    assert sorrentino(1.2) == pytest.approx(
        (1.5 * math.sin(1.2) ** 2 - 1.0) ** 2 * (1.0 - 1.5 * math.cos(1.2) ** 2), rel=1e-13
    )


def test_rebounds_are_numbers_from_0_to_1_or_that_of_slender_rectangles():
    alpha = np.arctan([1.0 / 1.415, 1.0 / 5.0])
    assert rebound_of([0.0, 1.0], alpha, rectangle=False).tolist() == [0.0, 1.0]
    assert np.array_equal(rebound_of("sorrentino", alpha, rectangle=True), sorrentino(alpha))
    squat = np.arctan([1.0 / 5.0, 1.0 / 1.414])
    for given, slender, rectangle, words in (
        ([0.5, 1.01], alpha, True, "expected the share e"),
        ([-0.01, 0.5], alpha, True, "expected the share e"),
        ("half", alpha, True, "'half'"),
        ("sorrentino", alpha, False, "'sorrentino' is stated for rectangles"),
        ("sorrentino", squat, True, r"slenderness above 1\.414, got 1\.41; "),
    ):
        with pytest.raises(ValueError, match=f"^rebound: .*{words}"):
            rebound_of(given, slender, rectangle)


@pytest.mark.parametrize("restitution", ["elastic", 0.9, [0.5, 0.6], None])
def test_a_wall_has_no_restitution_of_impacts_on_the_base(restitution):
    with pytest.raises(ValueError, match="a one-sided body returns to its wall, give a rebound in its place; got"):
        Block(width=0.5, height=3.0, one_sided=True, restitution=restitution)


def test_a_wall_asks_for_the_rebound_of_bodies_that_are_no_rectangles():
    with pytest.raises(ValueError, match="'sorrentino' is stated for rectangles"):
        Block.from_corners(0.2, 0.3, 1.0, 0.6, one_sided=True)
    with pytest.raises(ValueError, match="'sorrentino' is stated for rectangles"):
        Block.from_parameters(2.0, 0.2, "housner", one_sided=True)
    assert Block.from_parameters(2.0, 0.2, "housner", one_sided=np.True_, rebound=0.4).restitution_2 == 0.4
