"""Ties, loads and thrusts as the kernel reads them, seen from behind, as text; and what is none of them."""

import math

import numpy as np
import pytest

from rocking import Load, Thrust, Tie
from rocking.body.restraint import Restraints, carried

BASE = 0.8
HELD = Restraints(
    ties=(Tie(2.5, 3e6, 0.01, 4e4, 0.02, "both", 0.1), Tie(1.5, 2e6, side="negative"), Tie(1.2, 1e6)),
    loads=(Load(2000.0, 3.0, friction=0.4, distance=0.3), Load(500.0, 2.0, friction=0.2)),
    thrusts=(Thrust(-700.0, 2.2, 0.15), Thrust(300.0, 3.5)),
)


def test_elements_are_a_row_for_each_rotation_of_a_tie_and_for_the_friction_of_a_load():
    """Kind, side, height, distances behind both corners, stiffness, gap, yield force, ultimate elongation.

    Friction is fully there after 1 mm.
    """
    inf = math.inf
    assert HELD.elements(BASE).tolist() == [
        pytest.approx(row)
        for row in (
            [0.0, 1.0, 2.5, 0.1, 0.1, 3e6, 0.01, 4e4, 0.02],
            [0.0, -1.0, 2.5, 0.1, 0.1, 3e6, 0.01, 4e4, 0.02],
            [0.0, -1.0, 1.5, 0.0, 0.0, 2e6, 0.0, inf, inf],
            [0.0, 1.0, 1.2, 0.0, 0.0, 1e6, 0.0, inf, inf],
            [1.0, 0.0, 3.0, 0.3, 0.5, 8e5, 0.0, 800.0, inf],
            [1.0, 0.0, 2.0, 0.4, 0.4, 1e5, 0.0, 100.0, inf],
        )
    ]
    assert Restraints(loads=(Load(1.0, 1.0),)).elements(BASE).shape == (0, 9)


def test_weights_and_thrusts_restore_by_their_arms():
    """A weight W at (xi, z): W xi cos(phi) - W z sin(phi); a thrust F towards theta > 0 takes F (z cos + xi sin)."""
    right = np.array([2000.0 * 0.3, -2000.0 * 3.0]) + np.array([500.0 * 0.4, -500.0 * 2.0])
    left = np.array([2000.0 * 0.5, -2000.0 * 3.0]) + np.array([500.0 * 0.4, -500.0 * 2.0])
    right += 700.0 * np.array([2.2, 0.15]) - 300.0 * np.array([3.5, 0.0])
    left += -700.0 * np.array([2.2, 0.65]) + 300.0 * np.array([3.5, 0.8])
    np.testing.assert_allclose(HELD.constant(BASE), [right, left], rtol=1e-12)
    assert Restraints().constant(BASE).tolist() == [[0.0, 0.0], [0.0, 0.0]]


def test_from_behind_the_corners_change_places():
    behind = HELD.mirrored(BASE)
    np.testing.assert_allclose(behind.constant(BASE), HELD.constant(BASE)[::-1], rtol=1e-12)
    front, back = HELD.elements(BASE), behind.elements(BASE)
    front[:, 1] *= -1.0
    front[:, [3, 4]] = front[:, [4, 3]]
    order = [1, 0, 2, 3, 4, 5]  # of one tie for both rotations that against theta > 0 comes first
    np.testing.assert_allclose(back, front[order], rtol=1e-12)
    assert [tie.side for tie in behind.ties] == ["both", "positive", "negative"]
    assert [one.force for one in behind.thrusts] == [700.0, -300.0]


def test_restraints_are_told_as_text_and_read_again():
    assert Restraints.from_text(HELD.as_text()) == HELD
    assert Restraints.from_text("") is None
    assert HELD.highest == 3.5
    assert Restraints(ties=HELD.ties).highest == 2.5
    assert [bool(one) for one in (Restraints(), HELD, Restraints(thrusts=HELD.thrusts))] == [False, True, True]


def test_loads_without_friction_are_carried():
    loose, held = Load(100.0, 1.0), Load(100.0, 1.0, friction=0.3)
    assert carried([held, loose, held]) == ([loose], [held, held])


GIVEN = {Tie: {"height": 1.0, "stiffness": 1e6}, Load: {"weight": 1e3, "height": 1.0}}
GIVEN[Thrust] = {"force": 1e3, "height": 1.0}


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        *((Tie, name) for name in ("height", "stiffness", "yield_force", "ultimate")),
        *((Load, name) for name in ("weight", "height", "friction")),
        (Thrust, "height"),
    ],
)
def test_what_has_to_be_above_zero(kind, name):
    assert getattr(kind(**GIVEN[kind] | {name: 1e-9}), name) == 1e-9
    for value in (0.0, -1e-9, math.nan, "much", [1.0], *(() if name in ("yield_force", "ultimate") else (math.inf,))):
        with pytest.raises(ValueError, match=f"{kind.__name__.lower()} {name}: expected a number above 0"):
            kind(**GIVEN[kind] | {name: value})


@pytest.mark.parametrize(("kind", "name"), [(Tie, "gap"), (Tie, "distance"), (Load, "distance"), (Thrust, "distance")])
def test_what_may_be_zero(kind, name):
    for value in (0, 0.5):
        found = getattr(kind(**GIVEN[kind] | {name: value}), name)
        assert (found, type(found)) == (value, float)
    for value in (-1e-9, math.nan, math.inf):
        with pytest.raises(ValueError, match=f"{kind.__name__.lower()} {name}: expected a number of at least 0"):
            kind(**GIVEN[kind] | {name: value})


def test_a_tie_acts_on_one_side_or_on_both_and_a_thrust_has_a_force():
    sides, plain = ["positive", "negative", "both"], Tie(1.0, 1.0)
    assert [Tie(1.0, 1.0, side=one).side for one in sides] == sides
    assert (plain.side, plain.gap, plain.distance, Thrust(1, 1.0).distance) == ("positive", 0, 0, 0)
    with pytest.raises(ValueError, match="tie side"):
        Tie(1.0, 1.0, side="left")
    for force in (math.nan, math.inf, [1.0]):
        with pytest.raises(ValueError, match="thrust force"):
            Thrust(force, 1.0)
