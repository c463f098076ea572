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


def test_hop_from_the_ground_ends_at_its_second_root():
    impact, largest = first_impact(coefficients(0.0, 0.06, factor=-1.0), 0.1, 0.0)
    assert impact == pytest.approx(0.06, rel=1e-15)
    assert largest == pytest.approx(0.03**2, rel=1e-12)


@pytest.mark.parametrize("length", [1e-3, 1e-8, 1e-13])
def test_tiny_hop_keeps_its_digits(length):
    impact, largest = first_impact(coefficients(0.0, length, factor=-1.0), 0.1, 0.0)
    assert impact == pytest.approx(length, rel=1e-14)
    assert largest == pytest.approx(0.25 * length**2, rel=1e-12)


def test_hop_longer_than_the_step_has_no_impact():
    impact, largest = first_impact(coefficients(0.0, 0.3, factor=-1.0), 0.1, 0.0)
    assert impact == -1.0
    assert largest == pytest.approx(0.1 * 0.2)


def test_fall_onto_the_ground_is_found():
    impact, largest = first_impact(coefficients(0.04, -1.0, factor=-1.0), 0.1, 0.0)
    assert impact == pytest.approx(0.04, rel=1e-14)
    assert largest == pytest.approx(0.04)


def test_dip_below_the_ground_between_two_points_above_it_is_an_impact():
    impact, _ = first_impact(coefficients(0.04, 0.05), 0.1, 0.0)
    assert impact == pytest.approx(0.04, rel=1e-12)


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


def test_impact_on_the_last_instant_of_the_step_belongs_to_it():
    impact, _ = first_impact(coefficients(0.0, 0.125, factor=-1.0), 0.125, 0.0)
    assert impact == pytest.approx(0.125, rel=1e-15)


def test_first_of_three_roots_is_taken_across_the_inflection():
    impact, _ = first_impact(coefficients(0.02, 0.05, 0.09, factor=-1.0), 0.1, 0.0)
    assert impact == pytest.approx(0.02, rel=1e-12)


def test_peak_between_falling_pieces_counts():
    # Falls, rises above its start, falls again without touching the ground.
    c = coefficients(0.02, 0.05, 0.2, factor=-1.0)
    c[0] += 5e-4
    grid = np.linspace(0.0, 0.1, 20001)
    impact, largest = first_impact(c, 0.1, 0.0)
    assert impact == -1.0
    assert np.min(P.polyval(grid, c)) > 0.0
    assert largest == pytest.approx(np.max(P.polyval(grid, c)), rel=1e-8)
