"""A body and its pedestal as one."""

import numpy as np
import pytest

from rocking import Tie
from rocking.body.block import Block
from rocking.body.supports import with_pedestal


def test_two_parts_of_one_rectangle_are_that_rectangle():
    whole = Block(width=0.6, height=3.0, mass=900.0)
    top = Block(width=0.6, height=1.2, mass=360.0)
    found = with_pedestal(top, 0.6, 1.8, 540.0)
    for name in ("p", "p_2", "alpha_c", "alpha_2", "radius", "restitution", "mass"):
        assert float(getattr(found, name)) == pytest.approx(float(getattr(whole, name)), rel=1e-12), name


def test_several_pedestals_are_put_together_in_any_grouping():
    statue = Block.from_corners(0.2, 0.25, 0.9, 0.5, mass=600.0)
    one = with_pedestal(with_pedestal(statue, 0.7, 0.5, 700.0), 0.7, 0.4, 560.0)
    both = with_pedestal(statue, 0.7, 0.9, 1260.0)
    for name in ("p", "p_2", "alpha_c", "alpha_2", "restitution", "restitution_2"):
        assert float(getattr(one, name)) == pytest.approx(float(getattr(both, name)), rel=1e-12), name
    # Its centre of mass lies towards the corner nearer to it, and so does that of the whole.
    assert one.alpha_c < one.alpha_2


def test_the_sum_of_point_masses_has_the_same_inertia():
    statue = Block(width=0.5, height=1.8, mass=600.0, offset=0.05)
    found = with_pedestal(statue, 0.9, 1.2, 2300.0)

    def cloud(width, height, mass, x, z):
        # Four points at +-size/sqrt(12) have the inertia of a rectangle.
        at = np.array([(x + sx * width / 12**0.5, z + sz * height / 12**0.5) for sx in (-1, 1) for sz in (-1, 1)])
        return at, np.full(4, mass / 4.0)

    # Offset moves the centre of mass of the statue; its own inertia stays that of the rectangle.
    parts = [cloud(0.5, 1.8, 600.0, 0.05, 1.2 + 0.9), cloud(0.9, 1.2, 2300.0, 0.0, 0.6)]
    at = np.concatenate([one[0] for one in parts])
    mass = np.concatenate([one[1] for one in parts])
    centre = mass @ at / mass.sum()
    corner = np.array([0.45, 0.0])
    inertia = mass @ np.sum((at - corner) ** 2, axis=1)
    radius = np.hypot(*(centre - corner))
    assert float(found.p) == pytest.approx(np.sqrt(mass.sum() * found.gravity * radius / inertia), rel=1e-12)
    assert float(found.alpha_c) == pytest.approx(np.arctan2(corner[0] - centre[0], centre[1]), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"block": Block(width=0.5, height=1.8)}, "needs the mass of both"),
        ({"block": Block(width=0.5, height=1.8, mass=1.0, one_sided=True)}, "expected a free one"),
        ({"width": 0.4}, "at least that of the base on it, 0.5 m, got 0.4"),
        ({"mass": 0.0}, "pedestal mass"),
    ],
)
def test_what_cannot_stand_is_refused(change, message):
    given = {"block": Block(width=0.5, height=1.8, mass=600.0), "width": 0.9, "height": 1.2, "mass": 2300.0} | change
    with pytest.raises(ValueError, match=message):
        with_pedestal(**given)


def test_a_body_without_symmetry_stands_with_the_middle_of_its_base_on_that_of_the_pedestal():
    """Steiner about the corners of the whole, both of them; at another gravity and with a restitution of its own."""
    statue = Block.from_corners(0.2, 0.3, 1.0, 0.6, gravity=9.0, mass=600.0)
    found = with_pedestal(statue.lanes(1), 0.9, 1.2, 2300.0, restitution=0.8)
    # The centre of the statue is 0.05 to the right of the middle of its base, and of that of the pedestal.
    x, z = 600.0 * 0.05 / 2900.0, (600.0 * 2.2 + 2300.0 * 0.6) / 2900.0
    for corner, alpha, p in ((0.45, found.alpha_c, found.p), (-0.45, found.alpha_2, found.p_2)):
        inertia = 600.0 * (0.6**2 + (0.05 - corner) ** 2 + 2.2**2)
        inertia += 2300.0 * ((0.9**2 + 1.2**2) / 12.0 + corner**2 + 0.6**2)
        radius = np.hypot(corner - x, z)
        assert float(alpha) == pytest.approx(np.arctan(abs(corner - x) / z), rel=1e-12)
        assert float(p) == pytest.approx(np.sqrt(2900.0 * 9.0 * radius / inertia), rel=1e-12)
    assert (float(found.mass), found.gravity) == (2900.0, 9.0)
    assert float(found.restitution) == float(found.restitution_2) == 0.8


@pytest.mark.parametrize("name", ["width", "height", "mass"])
def test_sizes_and_mass_of_a_pedestal_are_above_zero(name):
    given = {"width": 0.9, "height": 1.2, "mass": 2300.0}
    for value in (0.0, -1.0, np.nan, [1.0]):
        with pytest.raises(ValueError, match=f"pedestal {name}"):
            with_pedestal(Block(width=0.5, height=1.8, mass=600.0), **given | {name: value})
    assert (
        with_pedestal(Block(width=1e-3, height=1e-2, mass=1e-3, log=False), **given | {name: 0.1}, restitution=0.8).mass
        > 0.0
    )


def test_a_tied_body_has_no_pedestal():
    tied = Block(width=0.5, height=1.8, mass=600.0, ties=[Tie(1.0, 1e5)])
    with pytest.raises(ValueError, match="expected a free one"):
        with_pedestal(tied, 0.9, 1.2, 2300.0)


def test_two_bodies_on_one_pedestal_are_refused():
    with pytest.raises(ValueError, match="2"):
        with_pedestal(Block(width=[0.5, 0.6], height=1.8, mass=600.0), 0.9, 1.2, 2300.0)


def test_of_the_whole_nothing_is_logged(caplog):
    """It is wider than high, of which its warnings tell."""
    statue = Block(width=0.5, height=1.8, mass=600.0)
    caplog.clear()
    whole = with_pedestal(statue, 3.9, 0.2, 9000.0, restitution=0.5)
    assert whole.warnings
    assert not caplog.records
