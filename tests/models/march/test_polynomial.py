"""Events of a motion inside one step, on polynomials whose roots are known."""

import numpy as np
import pytest
from numpy.polynomial import polynomial as P

from rocking.march.polynomial import ORDER, first_impact, value, velocity


def coefficients(*roots, factor=1.0):
    """factor (tau - r1)(tau - r2)... as the coefficients of a step."""
    c = np.zeros(ORDER + 1)
    found = factor * P.polyfromroots(roots)
    c[: found.size] = found
    return c


def test_value_and_velocity_are_those_of_the_polynomial():
    c = np.arange(1.0, ORDER + 2.0)
    assert value(c, 0.3) == pytest.approx(P.polyval(0.3, c), rel=1e-15)
    assert velocity(c, 0.3) == pytest.approx(P.polyval(0.3, P.polyder(c)), rel=1e-15)


@pytest.mark.parametrize(
    ("roots", "factor", "h", "impact", "largest"),
    [
        ((0.0, 0.06), -1.0, 0.1, 0.06, 0.03**2),  # a hop from the ground
        ((0.0, 1e-8), -1.0, 0.1, 1e-8, 0.25e-16),
        ((0.0, 1e-13), -1.0, 0.1, 1e-13, 0.25e-26),  # a tiny one keeps its digits
        ((0.0, 0.3), -1.0, 0.1, -1.0, 0.1 * 0.2),  # one longer than the step
        ((0.0, 0.125), -1.0, 0.125, 0.125, 0.0625**2),  # the last instant belongs to the step
        ((0.04, -1.0), -1.0, 0.1, 0.04, 0.04),  # a fall
        ((0.04, 0.05), 1.0, 0.1, 0.04, 0.002),  # a dip between two points above the ground
        ((0.02, 0.05, 0.09), -1.0, 0.1, 0.02, 9e-5),  # the first of three, across the inflection
    ],
)
def test_first_impact_and_largest_rotation_before_it(roots, factor, h, impact, largest):
    found = first_impact(coefficients(*roots, factor=factor), h, 0.0)
    assert found == (pytest.approx(impact, rel=1e-12), pytest.approx(largest, rel=1e-12))


def test_dip_that_stays_above_the_ground_is_none():
    c = coefficients(0.04, 0.05)
    c[0] += 1e-4
    impact, largest = first_impact(c, 0.1, 0.0)
    assert impact == -1.0
    assert largest == pytest.approx(max(c[0], value(c, 0.1)))


def test_grazing_the_ground_from_above_is_an_impact_without_speed():
    c = coefficients(0.0625, 0.0625)  # exact in binary
    impact, _ = first_impact(c, 0.125, 0.0)
    assert impact == pytest.approx(0.0625, abs=1e-9)
    assert abs(velocity(c, impact)) < 1e-8


def test_peak_between_falling_pieces_counts():
    # Falls, rises above its start, falls again without touching the ground.
    c = coefficients(0.02, 0.05, 0.2, factor=-1.0)
    c[0] += 5e-4
    grid = np.linspace(0.0, 0.1, 20001)
    impact, largest = first_impact(c, 0.1, 0.0)
    assert impact == -1.0
    assert np.min(P.polyval(grid, c)) > 0.0
    assert largest == pytest.approx(np.max(P.polyval(grid, c)), rel=1e-8)
