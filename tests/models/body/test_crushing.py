"""Bodies whose corners move inwards, because the edge is crushed."""

import math

import numpy as np
import pytest

from rocking import Load, Thrust, Tie
from rocking.body.block import Block
from rocking.body.limits import sorrentino
from rocking.body.outline import Outline
from rocking.march.corner_response import uplift_additions

WALL = {"width": 0.6, "height": 4.0, "density": 1800.0, "length": 2.0, "gravity": 10.0, "log": False}
#: N = 0.6 x 4 x 2 x 1800 x 10 = 86 400 N; at 1.2 MPa the depth N/(0.85 f length) is 42.35 mm, the corner at half of it.
INSIDE = 86400.0 / (1.7 * 1.2e6 * 2.0)


def test_corner_angle_and_frequency_by_hand():
    body = Block(**WALL, compressive_strength=1.2e6)
    assert body.hinge == pytest.approx(0.0211765, abs=1e-7) == INSIDE
    near = 0.3 - INSIDE
    radius = math.hypot(near, 2.0)
    assert (body.alpha_c, body.alpha_2) == pytest.approx((math.atan(near / 2.0),) * 2)
    assert body.p == pytest.approx(math.sqrt(10.0 * radius / ((0.6**2 + 4.0**2) / 12.0 + radius**2)))
    assert (body.width, body.height, body.mass) == (0.6, 4.0, 8640.0)
    assert body.symmetric
    # Angular momentum about the corner that hits the ground.
    gyration = (0.6**2 + 4.0**2) / 12.0
    assert body.restitution == pytest.approx((gyration + 4.0 - near**2) / (gyration + radius**2))


def test_a_strong_body_is_the_rigid_one_and_the_loss_follows_the_strength():
    rigid = Block(**WALL)
    strong = Block(**WALL, compressive_strength=1e15)
    for name in ("alpha_c", "p", "restitution", "critical_impulse"):
        assert getattr(strong, name) == pytest.approx(getattr(rigid, name), rel=1e-9)
    losses = [math.tan(rigid.alpha_c) - math.tan(Block(**WALL, compressive_strength=f).alpha_c) for f in (1e6, 2e6)]
    assert losses[0] == pytest.approx(2.0 * losses[1])


def test_loads_press_the_edge_whether_they_move_with_the_body_or_not():
    for friction in (None, 0.3):
        body = Block(**WALL, compressive_strength=1.2e6, loads=[Load(43200.0, 4.0, friction=friction)])
        assert body.hinge == pytest.approx(1.5 * INSIDE)


def test_distances_of_restraints_are_measured_from_the_faces():
    """Uplift at abs(a_g)/g, with N = 2 W: (W (0.3 - u) + N_2 (0.1 - u) + F z - T z_T)/(W 2)."""
    weight, load, inside = 86400.0, 86400.0, 2.0 * INSIDE
    parts = {
        "loads": [Load(load, 4.0, friction=0.3, distance=0.1)],
        "thrusts": [Thrust(500.0, 3.0)],
        "ties": [Tie(3.0, 1e6, distance=0.6)],
    }
    body = Block(**WALL, compressive_strength=1.2e6, **parts)
    assert body.hinge == pytest.approx(inside)
    at_rest = (weight * (0.3 - inside) + load * (0.1 - inside) - 500.0 * 3.0) / (weight * 2.0)
    # From behind: the load is 0.5 m from the other face; the thrust helps, the tie does not act.
    behind = (weight * (0.3 - inside) + load * (0.5 - inside) + 500.0 * 3.0) / (weight * 2.0)
    for seen, expected in ((body, (at_rest, behind)), (body.mirrored(), (behind, at_rest))):
        levels = np.tan([[seen.alpha_c], [seen.alpha_2]]) + uplift_additions(seen.lanes(1))
        assert levels.ravel() == pytest.approx(expected)
    # A tie on the inner face lengthens by z sin(phi) + (0.6 - u)(1 - cos(phi)).
    moved = 3.0 * math.sin(0.02) + (0.6 - inside) * (1.0 - math.cos(0.02))
    assert body.restraints.tie_demand([0.02, 0.0]).elongation == pytest.approx([moved])
    assert type(body.restraints).from_text(body.restraints.as_text()) == body.restraints


def test_a_wall_of_masonry_keeps_its_rebound_and_its_drawing():
    body = Block(**WALL, compressive_strength=1.2e6, one_sided=True)
    assert body.restitution == pytest.approx(float(sorrentino(body.alpha_c)))
    drawn = Outline.of(body)
    assert (drawn.left, drawn.right, drawn.height) == pytest.approx((0.3, 0.3, 4.0))
    assert "crushed edge" in repr(body)


def test_arrays_of_bodies_are_crushed_each_by_its_weight():
    many = Block(**{**WALL, "height": [2.0, 4.0]}, compressive_strength=1.2e6)
    assert many.hinge == pytest.approx([0.5 * INSIDE, INSIDE])
    assert Block.stack([many, Block(0.6, 4.0, gravity=10.0, log=False)]).hinge == pytest.approx([*many.hinge, 0.0])
    with pytest.raises(ValueError, match="bodies with ties"):
        Block(**{**WALL, "height": [2.0, 4.0]}, compressive_strength=1.2e6, ties=[Tie(1.0, 1e5)])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"compressive_strength": 80e3}, r"crushed over 0\.635 m, so that no base is left"),
        ({"compressive_strength": 0.0}, "compressive_strength: expected"),
        ({"compressive_strength": math.nan}, "compressive_strength: expected"),
        ({"compressive_strength": 1e6, "density": None, "length": None}, "density in kg/m3 and length in m"),
        ({"compressive_strength": 120e3, "offset": 0.2}, "no base is left"),
    ],
)
def test_what_cannot_be(change, said):
    with pytest.raises(ValueError, match=said):
        Block(**WALL | change)
    assert np.isfinite(Block(**WALL, compressive_strength=90e3).p)
