"""What the likely points of a search say of its limits."""

from types import SimpleNamespace

import numpy as np
import pytest

from rockpulse.calibration.response_posterior import Posterior
from rockpulse.calibration.response_profile import correlations, flat_ends

LOW, HIGH = np.array([0.1, 0.0, 0.2, 1.0]), np.array([1.0, 1.0, 2.0, 20.0])
MIDDLE = np.array([0.5, 0.5, 1.0, 6.0])


@pytest.mark.parametrize(
    ("column", "name", "inside"), [(1, "ratio", 0.1), (2, "interval", 0.15), (3, "main_count", 1.0)]
)
def test_likely_values_at_a_limit_of_the_search_reach_it(column, name, inside):
    """Within a twenty-fourth of the range, or at the very number of main impulses."""
    for low, high in ((False, False), (True, False), (False, True), (True, True)):
        points = np.tile(MIDDLE, (5, 1))
        points[1, column] = LOW[column] + (0.0 if low else inside)
        points[2, column] = HIGH[column] - (0.0 if high else inside)
        points[3:] = LOW, HIGH  # which are not likely
        explored = SimpleNamespace(
            space=SimpleNamespace(low=LOW, high=HIGH), points=points, likelihood=np.array([0.0, -1.0, -1.0, -2.0, -2.0])
        )
        expected = dict.fromkeys(("ratio", "interval", "main_count"), (False, False)) | {name: (low, high)}
        assert flat_ends(explored, 3.0) == expected


def test_a_parameter_that_is_known_goes_with_no_other():
    space = SimpleNamespace(spacing="end", main=lambda points: np.exp(points[:, 0]))
    points = np.array([[-1.0, 0.5, 0.1, 3.0], [0.0, 0.5, 0.2, 3.0], [1.0, 0.5, 0.3, 3.0]])
    found = correlations(space, Posterior(points, np.full(3, 1.0 / 3.0)))
    assert found["main", "interval"] == pytest.approx(1.0)
    others = {pair: value for pair, value in found.items() if pair != ("main", "interval")}
    assert len(others) == 5
    assert set(others.values()) == {0.0}
