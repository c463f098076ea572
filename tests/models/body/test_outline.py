"""Outlines of bodies about the centre of mass, and what blocks show of themselves."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking import Block, Load, Thrust, Tie
from rocking.body.outline import Outline


def test_a_body_without_symmetry_is_the_triangle_of_its_corners_and_its_centre():
    body = Outline.of(Block.from_corners(0.2, 0.4, 1.0, 0.6))
    assert body.corners == [pytest.approx(one) for one in ((-0.4, 0.0), (0.2, 0.0), (0.0, 1.0))]
    assert (body.width, body.top) == (pytest.approx(0.6), pytest.approx(1.0))
    assert math.isnan(body.height)


def test_of_a_body_without_symmetry_things_act_behind_its_own_corners():
    """The right-hand corner is 0.3 and the left-hand one 0.2 beside the centre of mass."""
    ties = [Tie(height=0.8, stiffness=1e6, side="both", distance=0.1), Tie(height=0.7, stiffness=1e6, side="negative")]
    loads = [Load(200.0, 0.9, friction=0.4), Load(100.0, 0.8, friction=0.4, distance=0.05)]
    body = Outline.of(
        Block.from_corners(
            0.3, 0.2, 1.0, 0.6, mass=8000.0, ties=ties, loads=loads, thrusts=[Thrust(50.0, 0.5, 0.12)], log=False
        )
    )
    assert (body.left, body.right, body.centre) == tuple(map(pytest.approx, (0.2, 0.3, 1.0)))
    assert [tuple(one) for one in body.ties] == [
        tuple(map(pytest.approx, one)) for one in ((0.2, -0.2, -1, 0.8), (-0.1, 0.3, 1, 0.8), (-0.2, 0.3, 1, 0.7))
    ]
    assert body.loads == (pytest.approx((0.05, 0.9)), pytest.approx((0.25, 0.8)))
    assert body.thrusts == (pytest.approx((0.18, 0.5, 50.0)),)


SVG = "{http://www.w3.org/2000/svg}"


def drawn(block):
    return ET.fromstring(block._repr_html_()).find(f".//{SVG}svg")


def test_a_block_is_told_in_a_line():
    told = "<Block width 0.25 m, height 2.2 m, p 2.578 1/s, alpha_c 0.1132 rad, C 0.9809>"
    assert repr(Block(width=0.25, height=2.2)) == told


def test_several_blocks_are_told_by_their_ranges():
    told = repr(Block(width=[0.25, 0.4], height=2.2, restitution=0.9))
    assert told.startswith("<Block of 2 bodies, width 0.25 to 0.4 m, height 2.2 m, p ")
    assert told.endswith("C 0.9>")


def test_sizes_that_are_not_known_are_not_told():
    assert repr(Block.from_parameters(2.0, 0.2, 0.9)) == "<Block p 2 1/s, alpha_c 0.2 rad, C 0.9>"


def test_what_holds_a_block_is_told_and_drawn():
    held = Block(
        width=0.5,
        height=6.0,
        one_sided=True,
        mass=8000.0,
        ties=[Tie(height=5.5, stiffness=1e6)],
        loads=[Load(2000.0, 6.0, friction=0.4)],
        thrusts=[Thrust(500.0, 5.0)],
        log=False,
    )
    assert "rebound 0.4796, wall behind it, ties 1, loads 1" in repr(held)
    assert "wall behind it, restr" in repr(Block.stack([held, held]))
    lines = len(drawn(held).findall(f"{SVG}polyline"))
    assert lines - len(drawn(Block(width=0.5, height=6.0)).findall(f"{SVG}polyline")) == 4  # wall, tie, load, thrust


def test_outlines_have_the_proportions_of_the_bodies():
    outlines = drawn(Block(width=[0.5, 1.0], height=[2.0, 4.0])).findall(f"{SVG}polygon")
    corners = [
        np.array([[float(n) for n in pair.split(",")] for pair in one.attrib["points"].split()]) for one in outlines
    ]
    sizes = [np.ptp(one, axis=0) for one in corners]
    assert [size[1] / size[0] for size in sizes] == pytest.approx([4.0, 4.0], rel=0.02)
    assert sizes[1][1] / sizes[0][1] == pytest.approx(2.0, rel=0.01)


def test_a_body_without_a_height_is_a_triangle_over_its_corners():
    outline = drawn(Block.from_corners(0.2, 0.4, 1.0, 0.6)).find(f"{SVG}polygon").attrib["points"].split()
    (left, _), (right, _), (top, _) = ([float(number) for number in pair.split(",")] for pair in outline)
    assert (top - left) / (right - top) == pytest.approx(2.0, rel=0.02)


def test_of_many_bodies_the_first_eight_are_drawn():
    block = Block(width=np.linspace(0.2, 0.5, 500), height=2.0)
    assert len(drawn(block).findall(f"{SVG}polygon")) == 8
    assert len(block._repr_html_()) < 10_000
