"""What a rigid body can be: corners, rebound and restitution by angular momentum, against bodies of points."""

import logging
import math

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.body.block_lanes import STANDARD_GRAVITY
from rocking.body.limits import both_corners, corner, rebound_of, restitution_of, size_problem, sorrentino
from rocking.body.restraint import Load, Thrust, Tie

GRAVITY = 9.7


def test_a_corner_is_that_of_its_closed_forms():
    """R^2 = b^2 + h^2, tan alpha = b/h, p^2 = g R/(rho^2 + R^2), and C by angular momentum."""
    near, far, height, gyration = (np.array(pair) for pair in ((0.3, 0.5), (0.2, 0.1), (1.1, 1.3), (0.6, 0.8)))
    found = corner(near, far, height, gyration, GRAVITY)
    radius = np.hypot(near, height)
    assert found.radius == pytest.approx(radius, rel=1e-14)
    assert found.alpha == pytest.approx(np.arctan(near / height), rel=1e-14)
    assert found.p == pytest.approx(np.sqrt(GRAVITY * radius / (gyration**2 + radius**2)), rel=1e-14)
    most = (gyration**2 + height**2 - near * far) / (gyration**2 + np.hypot(far, height) ** 2)
    assert found.most == pytest.approx(most, rel=1e-14)


def test_loads_that_are_carried_are_points_of_the_body():
    """Moments of a body and of two points about its right-hand corner; one stands on the middle of the base."""
    loads = [Load(200.0 * GRAVITY, 1.8, distance=0.1), Load(150.0 * GRAVITY, 2.3), Load(99.0, 1.0, friction=0.5)]
    own, near, far, height, gyration = np.array([800.0, 600.0]), 0.35, 0.2, 1.1, 0.6
    first, second, mass = both_corners(*(np.array(one) for one in (near, far, height, gyration)), own, loads, GRAVITY)
    points = ((own, near, height, gyration), (200.0, 0.1, 1.8, 0.0), (150.0, 0.275, 2.3, 0.0))
    total = sum(m for m, *_ in points)
    b = sum(m * x for m, x, *_ in points) / total
    h = sum(m * z for m, _, z, _ in points) / total
    inertia = sum(m * (x**2 + z**2 + r**2) for m, x, z, r in points)
    assert mass == pytest.approx(total, rel=1e-14)
    assert first.alpha == pytest.approx(np.arctan(b / h), rel=1e-13)
    assert second.alpha == pytest.approx(np.arctan((near + far - b) / h), rel=1e-13)
    assert first.radius == pytest.approx(np.hypot(b, h), rel=1e-13)
    assert first.p == pytest.approx(np.sqrt(total * GRAVITY * np.hypot(b, h) / inertia), rel=1e-13)
    block = Block.from_corners(near, far, height, gyration, mass=own, loads=loads, gravity=GRAVITY)
    assert block.p.tolist() == first.p.tolist()
    assert [held.loads for held in block.restraints] == [(loads[2],)] * 2
    carrying = Block(width=0.5, height=3.0, mass=500.0, loads=loads[:1], gravity=GRAVITY)
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
        ([0.5, 1.01], alpha, True, "expected the ratio e"),
        ([-0.01, 0.5], alpha, True, "expected the ratio e"),
        ("half", alpha, True, "'half'"),
        ("sorrentino", alpha, False, "'sorrentino' is valid for rectangles only"),
        ("sorrentino", squat, True, r"slenderness above 1\.414, got 1\.41; "),
    ):
        with pytest.raises(ValueError, match=f"^rebound: .*{words}"):
            rebound_of(given, slender, rectangle)


@pytest.mark.parametrize("restitution", ["elastic", 0.9, [0.5, 0.6], None])
def test_a_wall_has_no_restitution_of_impacts_on_the_base(restitution):
    with pytest.raises(ValueError, match="restitution: a one-sided body has none"):
        Block(width=0.5, height=3.0, one_sided=True, restitution=restitution)


def test_a_wall_asks_for_the_rebound_of_bodies_that_are_no_rectangles():
    with pytest.raises(ValueError, match="'sorrentino' is valid for rectangles only"):
        Block.from_corners(0.2, 0.3, 1.0, 0.6, one_sided=True)
    with pytest.raises(ValueError, match="'sorrentino' is valid for rectangles only"):
        Block.from_parameters(2.0, 0.2, "housner", one_sided=True)
    assert Block.from_parameters(2.0, 0.2, "housner", one_sided=np.True_, rebound=0.4).restitution_2 == 0.4


G = 9.81


def cloud(seed):
    """A symmetric body of points: places, masses and half of its base."""
    rng = np.random.default_rng(seed)
    x, z, mass = rng.uniform(0.0, 0.3, 40), rng.uniform(0.0, 2.4, 40), rng.uniform(0.5, 2.0, 40)
    return np.append(x, -x), np.tile(z, 2), np.tile(mass, 2), 0.3


def numerical(x, z, mass, edge):
    """p, alpha and R of a body of points, and the velocity ratio of its impact by angular momentum, point by point.

    Before the impact the body turns about the corner (-edge, 0), after it about (edge, 0): of each point the moment of
    momentum about the new corner is r x (omega x r_old), summed up over the mass.
    """
    total = mass.sum()
    centre = (mass @ z) / total
    radius, alpha = np.hypot(edge, centre), np.arctan2(edge, centre)
    about_new = mass @ ((x - edge) ** 2 + z**2)
    before = mass @ ((x - edge) * (x + edge) + z * z)
    return np.sqrt(total * G * radius / about_new), alpha, radius, before / about_new


@pytest.mark.parametrize("seed", range(3))
def test_housner_with_a_radius_is_angular_momentum_of_the_body_itself(seed):
    p, alpha, radius, ratio = numerical(*cloud(seed))
    found = Block.from_parameters(p, alpha, "housner", gravity=G, radius=radius)
    assert found.restitution == pytest.approx(ratio, abs=1e-12)
    assert abs(found.restitution - (1.0 - 1.5 * np.sin(alpha) ** 2)) > 1e-4  # the rectangle's is another one
    assert found.radius == radius
    assert not any("restitution" in warning for warning in found.warnings)


def test_statue_of_the_sample_is_judged_by_its_own_angular_momentum():  # V23 (D)
    own = Block.from_parameters(2.385, 0.2445, "housner", radius=1.136)
    like_rectangle = Block.from_parameters(2.385, 0.2445, "housner")
    assert (own.restitution, like_rectangle.restitution) == pytest.approx((0.9228, 0.9121), abs=5e-5)
    assert Block.from_parameters(2.385, 0.2445, 0.92, radius=1.136).warnings == ()
    (without,) = Block.from_parameters(2.385, 0.2445, 0.92).warnings
    assert "Housner's 0.9121 of a rectangle with this alpha" in without
    assert "give its radius" in without
    (above,) = Block.from_parameters(2.385, 0.2445, 0.93, radius=1.136).warnings
    assert "restitution 0.93 is above 0.9228, the bound for its p, alpha and radius" in above
    assert "conservation of angular momentum" in above


@pytest.mark.parametrize(
    ("size", "doubt"),
    [
        ((0.6, 2.4), ""),
        ((30.0, 30.0), ""),
        ((0.05, 0.05), ""),
        ((0.001, 2.0), ""),
        ((1.0 + 1e-12, 1.0), ""),
        ((1.0, 30.001), "larger than 30 m"),
        ((600.0, 1.7), "larger than 30 m"),
        ((0.01, 0.0499), "less than 5 cm high"),
        ((0.0009, 2.0), "less than 1 mm wide"),
        ((2.4, 2.3), "wider than high"),
        ((1.0 + 1e-11, 1.0), "wider than high"),
    ],
)
def test_sizes_that_are_doubted(size, doubt):
    assert size_problem(*size) == doubt
    if not doubt:
        assert not any("check" in warning for warning in Block(width=size[0], height=size[1]).warnings)
        return
    assert doubt in Block(width=size[0], height=size[1], restitution=0.5).warnings[0]
    assert doubt in Block(half_width=size[0] / 2.0, half_height=size[1] / 2.0, restitution=0.5).warnings[0]


def test_warnings_are_logged_unless_that_is_declined(caplog):
    with caplog.at_level(logging.WARNING, logger="rockpulse"):
        body = Block(width=600.0, height=1700.0, restitution=0.99)
        assert [record.getMessage() for record in caplog.records] == [f"block: {text}" for text in body.warnings]
        assert len(body.warnings) == 3
        caplog.clear()
        assert Block(width=600.0, height=1700.0, restitution=0.99, log=False).warnings == body.warnings
        assert Block.from_parameters(0.01, 0.2, 0.99, log=False).warnings != ()
        assert Block.from_corners(30.0, 30.0, 90.0, 40.0, 0.5, log=False).warnings != ()
        assert caplog.records == []
        made = Block.from_parameters(0.01, 0.2, 0.99), Block.from_corners(30.0, 30.0, 90.0, 40.0, 0.5)
    told = [f"block: {text}" for body in made for text in body.warnings]
    assert [record.getMessage() for record in caplog.records] == told


def test_a_leaning_body_has_the_inertia_of_the_upright_one_about_its_centre():
    """I about a corner is m (R_1^2 + r^2), r^2 = (b^2 + h^2)/3 of a rectangle, however it leans."""
    lean = 0.05
    body = Block(width=0.5, height=3.0, lean=lean, gravity=9.81)
    near, rise = 0.25 - 1.5 * np.sin(lean), 1.5 * np.cos(lean)
    gyration = (0.25**2 + 1.5**2) / 3.0
    for p, alpha, base in ((body.p, body.alpha_c, near), (body.p_2, body.alpha_2, 0.5 - near)):
        radius = np.hypot(base, rise)
        assert alpha == pytest.approx(np.arctan2(base, rise), rel=1e-12)
        assert p == pytest.approx(np.sqrt(9.81 * radius / (radius**2 + gyration)), rel=1e-12)


def test_a_radius_at_its_limit_is_refused_in_the_numbers_of_its_lane():
    with pytest.raises(ValueError, match=r"p = 2 1/s has R = 2\.25 m: .* less than g/p\^2 = 2\.25 m"):  # p^2 R/g = 1
        Block.from_parameters([1.5, 2.0, 1.9], 0.2, 0.9, radius=2.25, gravity=9.0)
    assert Block.from_parameters([1.5, 2.0], 0.2, 0.9, radius=[2.25, 2.249], gravity=9.0).shape == (2,)


def test_restitutions_from_0_to_1_are_taken_and_the_most_where_it_is_not_negative():
    most = np.array([0.0, 0.5])
    assert restitution_of("housner", most, own=True).tolist() == [0.0, 0.5]
    assert restitution_of([0.0, 1.0], most, own=False).tolist() == [0.0, 1.0]
    for given in ([0.5, 1.0 + 1e-9], [-1e-9, 0.5], [0.5, np.nan], "elastic"):
        with pytest.raises(ValueError, match=r"^restitution: "):
            restitution_of(given, most, own=True)
    for own, words in ((True, "negative for this p, alpha and radius"), (False, "slenderness of 0.707")):
        with pytest.raises(ValueError, match=words):
            restitution_of("housner", np.array([0.5, -1e-9]), own=own)


def test_the_restitution_furthest_above_its_bound_is_reported():
    """Bounds of 1 - 1.5 sin^2 alpha: 0.985, 0.9408 and 0.9408."""
    (remark,) = Block.from_parameters(2.0, [0.1, 0.2, 0.2], [0.99, 0.95, 0.94]).warnings
    assert remark.startswith("restitution 0.95 is above Housner's 0.9408 of a rectangle with this alpha; ")
    # The corner that is met decides: the moment of inertia about it is the larger the further away it is.
    bounds = [(0.36 + 1.21 - 0.07) / (0.36 + 1.21 + far**2) for far in (0.35, 0.2)]
    assert [round(bound, 4) for bound in bounds] == [0.8863, 0.9317]
    for given, above in ((0.94, bounds), (0.9, bounds[:1]), (0.88, []), ("housner", [])):
        remarks = Block.from_corners(0.2, 0.35, 1.1, 0.6, given).warnings
        assert [remark.split(", the bound for its corners")[0] for remark in remarks] == [
            f"restitution {given:.4g} is above {bound:.4g}" for bound in above
        ]


def test_a_squat_body_before_a_wall_has_no_bound_on_its_rebound():
    """Housner's formula is negative for it, which a rebound of nothing is not held against."""
    for rebound in (0.0, 0.5):
        body = Block(width=2.0, height=1.2, one_sided=True, rebound=rebound, log=False)
        assert not any("restitution" in remark for remark in body.warnings)
        assert body.side == 1


def test_heights_of_restraints_are_those_of_the_lowest_body():
    size = {"width": 0.5, "mass": 2000.0}
    top = 3.0 * (1.0 + 1e-9)
    assert Block(**size, height=[4.0, 3.0], ties=[Tie(top, 1e6)]).shape == (2,)
    for height in (3.0 * (1.0 + 2e-9), 3.5):
        with pytest.raises(ValueError, match="expected heights up to that of the body, 3 m"):
            Block(**size, height=[4.0, 3.0], ties=[Tie(height, 1e6)])
    assert Block.from_corners(0.2, 0.3, 1.0, 0.6, mass=500.0, ties=[Tie(90.0, 1e6)]).restraints.highest == 90.0
    with pytest.raises(ValueError, match="expected a mass in kg"):
        Block(width=0.5, height=3.0, ties=[Tie(1.0, 1e6)])


@pytest.mark.parametrize("towards", [1.0, -1.0])
def test_a_thrust_that_balances_the_weight_turns_the_body_over(towards):
    """At a height of 1 m the force is the moment of the weight about the corner, m g R sin alpha."""
    for place, free in enumerate((Block(width=[0.9, 0.5], height=3.0), Block.from_corners(0.3, 0.25, 1.5, 0.9))):
        weaker = free.alpha_c if towards > 0.0 else free.alpha_2
        radius = free.radius if towards > 0.0 else free.radius_2
        force = towards * float(np.min(2000.0 * free.gravity * radius * np.sin(weaker)))

        def made(share, place=place, force=force, **more):
            held = {"mass": 2000.0, "thrusts": [Thrust(share * force, 1.0)], **more}
            if place:
                return Block.from_corners(0.3, 0.25, 1.5, 0.9, **held)
            return Block(width=[0.9, 0.5], height=3.0, **held)

        assert made(1.0 - 1e-12).shape == free.shape
        with pytest.raises(ValueError, match="expected forces that leave the body at rest"):
            made(1.0)
        if towards < 0.0:  # a wall holds it
            assert np.all(made(5.0, one_sided=True, **({"rebound": 0.5} if place else {})).side == 1)


@pytest.mark.parametrize("towards", [1.0, -1.0])
def test_what_rests_on_a_body_holds_it_against_a_thrust_on_both_sides(towards):
    """A load 0.15 m behind the right-hand corner and one on the middle of a base of 0.55 m, by their moments."""
    loads = [Load(800.0, 1.8, friction=0.2, distance=0.15), Load(300.0, 1.2, friction=0.4)]
    base, near = (0.2, 0.15) if towards > 0.0 else (0.35, 0.4)
    moment = 900.0 * G * base + 800.0 * near + 300.0 * 0.275

    def made(share):
        thrust = Thrust(towards * share * moment / 1.5, 1.5)
        return Block.from_corners(0.2, 0.35, 1.1, 0.6, mass=900.0, gravity=G, loads=loads, thrusts=[thrust])

    assert made(1.0 - 1e-9).restraints.loads == tuple(loads)
    with pytest.raises(ValueError, match="expected forces that leave the body at rest"):
        made(1.0 + 1e-9)


def test_a_body_by_p_alone_is_measured_as_its_rectangle_and_one_by_corners_by_its_own_sizes():
    """R = 3 g/(4 p^2), 2 R sin and 2 R cos of alpha; of corners their distance and twice the height of the centre."""
    radius = 3.0 * STANDARD_GRAVITY / (4.0 * 0.3**2)
    (told,) = Block.from_parameters([4.0, 0.3], [0.2, 0.15], 0.5, log=False).warnings
    wide, high = 2.0 * radius * np.sin(0.15), 2.0 * radius * np.cos(0.15)
    assert f"a rectangle with its R and alpha would be {wide:.4g} m wide and {high:.4g} m high" in told
    (own,) = Block.from_parameters(0.2, 0.1, 0.5, radius=100.0, log=False).warnings
    assert f"{200.0 * np.sin(0.1):.4g} m wide and {200.0 * np.cos(0.1):.4g} m high, larger than 30 m" in own
    (cut,) = Block.from_corners(0.0005, 0.0003, 0.02, 0.012, 0.5, log=False).warnings
    assert cut.startswith("0.0008 m wide and 0.04 m high, less than 5 cm high: ")
