"""Median, largest and smallest over the directions of a pair."""

import numpy as np
import pytest

from rockpulse.assessment.direction_statistics import largest_over, median_over, smallest_over

INF, NAN = np.inf, np.nan


@pytest.mark.parametrize(
    ("values", "median", "largest", "place"),
    [
        ([0.1, 0.4, 0.2], 0.2, 0.4, 1),
        ([0.1, 0.4, 0.2, 0.3], 0.25, 0.4, 1),
        ([0.1, INF, 0.2], 0.2, INF, 1),
        ([INF, 0.1, INF], INF, INF, 0),
        ([INF, 0.1], INF, INF, 0),
        ([0.0, 0.0, 0.0], 0.0, 0.0, 0),
        ([0.1, NAN, 0.2], NAN, NAN, -1),
        ([0.2, NAN, 0.2], 0.2, NAN, -1),
        ([INF, NAN, INF, INF], INF, INF, 0),
        ([NAN, NAN], NAN, NAN, -1),
    ],
)
def test_median_and_largest_with_overturning_and_without_an_answer(values, median, largest, place):
    row = np.array([values])
    assert median_over(row) == pytest.approx([median], nan_ok=True)
    found, at = largest_over(row)
    assert found == pytest.approx([largest], nan_ok=True)
    assert at == [place]


@pytest.mark.parametrize(
    ("values", "smallest", "place"),
    [([2.0, 0.5, 1.0], 0.5, 1), ([INF, 3.0], 3.0, 1), ([INF, INF], INF, -1), ([NAN, 0.5], NAN, -1)],
)
def test_smallest_safety_factor(values, smallest, place):
    found, at = smallest_over(np.array([values]))
    assert found == pytest.approx([smallest], nan_ok=True)
    assert at == [place]
