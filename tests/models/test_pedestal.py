"""A body and its pedestal as one."""

import numpy as np
import pytest

from rocking.block import Block
from rocking.pedestal import with_pedestal


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
