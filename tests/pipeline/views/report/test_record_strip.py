"""The small picture of a record."""

import re

import numpy as np
from report_cases import WORDS

from rockpulse.views.report.record_strip import HEIGHT, LEFT, WIDTH, strip


def points(drawn):
    path = re.search(r'class="trace" d="M([^"]+)"', drawn).group(1)
    return np.array([[float(part) for part in point.split()] for point in path.split("L")])


def test_long_records_keep_their_extremes_in_few_points():
    numbers = np.random.default_rng(1)
    acceleration = 0.1 * numbers.normal(size=200_000)
    acceleration[1234], acceleration[150_000] = 3.0, -2.5
    drawn = strip(WORDS, acceleration, 0.01, (10.0, 20.0))
    found = points(drawn)
    assert len(drawn) < 20_000
    assert len(found) <= 2 * (WIDTH - LEFT)
    middle, half = (found[:, 1].min() + HEIGHT - 20) / 2, (HEIGHT - 28) / 2
    assert np.isclose(found[:, 1].min(), middle - half, atol=0.2)
    lowest = found[np.argmax(found[:, 1])]
    assert np.isclose(lowest[1], middle + half * 2.5 / 3.0, atol=0.2)
    assert np.isclose(lowest[0], LEFT + (WIDTH - LEFT) * 0.75, atol=1.5)


def test_short_and_still_records_are_drawn():
    assert len(points(strip(WORDS, np.array([0.0, 1.0, -1.0]), 0.01, (0.0, 0.02)))) == 3
    assert "nan" not in strip(WORDS, np.zeros(50), 0.01, (np.nan, np.nan)).lower()
