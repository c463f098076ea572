"""The drawing of a body: to scale, with what holds it, and the numbers of its sizes."""

import re

import pytest

from rockpulse.views.shared.body_drawing import SIDE, Shape, drawing
from rockpulse.views.shared.terminal import figure

WALL = Shape(left=0.4, right=0.4, centre=4.5, height=9.0)


def drawn(shape):
    return drawing(shape, "a body", lambda value: figure(value, "m"))


def boxes(svg, kind):
    found = re.findall(rf'<rect class="{kind}" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"/>', svg)
    return [tuple(map(float, box)) for box in found]


def test_a_wall_is_to_scale_and_has_its_sizes():
    svg = drawn(WALL)
    ((_, _, width, height),) = boxes(svg, "body")
    assert height / width == pytest.approx(9.0 / 0.8, rel=0.02)
    assert ">9 m<" in svg
    assert ">0.8 m<" in svg
    assert 'aria-label="a body"' in svg


def test_what_holds_a_body_is_drawn_where_it_acts():
    tie = {"height": 8.0, "side": "positive", "distance": 0.0}
    svg = drawn(
        Shape(
            0.4,
            0.4,
            4.5,
            9.0,
            wall=True,
            floor=True,
            ties=[tie],
            loads=[{"height": 8.5}],
            thrusts=[{"force": 5e3, "height": 6.0}],
        )
    )
    for kind in ("wall", "floor", "tie", "load", "thrust"):
        assert f'class="{kind}"' in svg
    ((_, top, _, height),) = boxes(svg, "body")
    level = float(re.search(r'class="tie" d="M[\d.]+ ([\d.]+)H', svg).group(1))
    assert level == pytest.approx(top + height / 9.0, abs=0.2)
    assert "ground" not in svg


def test_a_pedestal_stands_below_and_as_one_body_is_part_of_it():
    statue = {"left": 0.25, "right": 0.25, "centre": 0.9, "height": 1.8, "pedestals": [(0.9, 1.2)]}
    alone, joined = drawn(Shape(**statue)), drawn(Shape(**statue, joined=1))
    ((_, top, width, _),) = boxes(alone, "pedestal")
    ((_, above, narrow, height),) = boxes(alone, "body")
    assert top == pytest.approx(above + height, abs=0.2)
    assert width / narrow == pytest.approx(1.8, rel=0.02)
    assert len(boxes(joined, "body")) == 2


def test_every_shape_stays_within_the_drawing():
    flat = Shape(5.0, 5.0, 0.5, 1.0)
    by_numbers = Shape(0.3, 0.3, 1.1, None)
    for shape in (flat, by_numbers, WALL):
        numbers = [float(one) for one in re.findall(r'[xy]="([\d.-]+)"', drawn(shape))]
        assert min(numbers) >= 0.0
        assert max(numbers) <= SIDE
    assert boxes(drawn(by_numbers), "body") == []
