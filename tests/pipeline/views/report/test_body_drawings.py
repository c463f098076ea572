"""The drawing of a body: to scale, with what holds it, and the numbers of its sizes; the small picture of a record."""

import re

import numpy as np
import pytest

from rocking.body.outline import Outline, TieLine
from rockpulse.views.report.body_drawings import HEIGHT, LEFT, SIDE, WIDTH, Support, body_drawing, strip
from rockpulse.views.shared.formatting import three_digits

WALL = Outline(left=0.4, right=0.4, centre=4.5, height=9.0)


def drawn(body, **support):
    return body_drawing(body, Support(**support), "a body", lambda value: three_digits(value, "m"))


def boxes(svg, kind):
    found = re.findall(rf'<rect class="{kind}" x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"/>', svg)
    return [tuple(map(float, box)) for box in found]


def body_of(svg):
    """Left, top, width and height of the outline of the body."""
    path = re.search(r'<path class="body" d="M([^Z]+)Z"/>', svg)[1]
    corners = np.array([[float(one) for one in pair.split()] for pair in path.split("L")])
    return (*corners.min(axis=0), *np.ptp(corners, axis=0))


def test_a_wall_is_to_scale_and_has_its_sizes():
    svg = drawn(WALL)
    _, _, width, height = body_of(svg)
    assert height / width == pytest.approx(9.0 / 0.8, rel=0.02)
    assert ">9 m<" in svg
    assert ">0.8 m<" in svg
    assert 'aria-label="a body"' in svg


def test_what_holds_a_body_is_drawn_where_it_acts():
    held = Outline(0.4, 0.4, 4.5, 9.0, 1, (TieLine(0.4, -0.4, -1.0, 8.0),), ((0.0, 8.5),), ((0.4, 6.0, 5e3),))
    svg = drawn(held, floor=True)
    for kind in ("wall", "floor", "tie", "load", "thrust"):
        assert f'class="{kind}"' in svg
    left, top, _, height = body_of(svg)
    level = float(re.search(r'class="tie" d="M[\d.]+ ([\d.]+)H', svg).group(1))
    assert level == pytest.approx(top + height / 9.0, abs=0.2)
    assert "ground" not in svg
    ((at, _, width, _),) = boxes(svg, "wall")
    assert at + width == pytest.approx(left, abs=0.11)


def test_a_pedestal_stands_below_and_as_one_body_is_part_of_it():
    statue = Outline(0.25, 0.25, 0.9, 1.8)
    alone, joined = (drawn(statue, pedestals=[(0.9, 1.2)], joined=count) for count in (0, 1))
    ((_, top, width, _),) = boxes(alone, "pedestal")
    _, above, narrow, height = body_of(alone)
    assert top == pytest.approx(above + height, abs=0.2)
    assert width / narrow == pytest.approx(1.8, rel=0.02)
    assert boxes(joined, "pedestal") == []
    assert len(boxes(joined, "body")) == 1


def test_every_shape_stays_within_the_drawing():
    flat = Outline(5.0, 5.0, 0.5, 1.0)
    by_numbers = Outline(0.3, 0.3, 1.1)
    for body in (flat, by_numbers, WALL):
        svg = drawn(body)
        left, top, width, height = body_of(svg)
        numbers = [float(one) for one in re.findall(r'[xy]="([\d.-]+)"', svg)]
        numbers += [left, top, left + width, top + height]
        assert min(numbers) >= 0.0
        assert max(numbers) <= SIDE
    assert ">↕ 1.1 m<" in drawn(by_numbers)


def points(drawn):
    path = re.search(r'class="trace" d="M([^"]+)"', drawn).group(1)
    return np.array([[float(part) for part in point.split()] for point in path.split("L")])


def test_long_records_keep_their_extremes_in_few_points():
    numbers = np.random.default_rng(1)
    acceleration = 0.1 * numbers.normal(size=200_000)
    acceleration[1234], acceleration[150_000] = 3.0, -2.5
    drawn = strip(acceleration, 0.01, (10.0, 20.0))
    found = points(drawn)
    assert len(drawn) < 20_000
    assert len(found) <= 2 * (WIDTH - LEFT)
    middle, half = (found[:, 1].min() + HEIGHT - 20) / 2, (HEIGHT - 28) / 2
    assert np.isclose(found[:, 1].min(), middle - half, atol=0.2)
    lowest = found[np.argmax(found[:, 1])]
    assert np.isclose(lowest[1], middle + half * 2.5 / 3.0, atol=0.2)
    assert np.isclose(lowest[0], LEFT + (WIDTH - LEFT) * 0.75, atol=1.5)
    assert len(points(strip(np.array([0.0, 1.0, -1.0]), 0.01, (0.0, 0.02)))) == 3
    assert "nan" not in strip(np.zeros(50), 0.01, (np.nan, np.nan)).lower()
