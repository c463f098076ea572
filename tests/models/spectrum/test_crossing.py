"""Isotonic fits, their crossings and the mean capacity: against the definition, and distributions in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from rocking.spectrum.probability import factor_at, mean_capacity, rising

LEVELS = np.exp(np.linspace(-3.0, 3.0, 301))


def fitted(values, weights):
    """The isotonic fit by its definition: the largest over i <= k of the smallest over j >= k of the mean of i to j."""
    n = len(values)
    return [
        max(min(np.average(values[i : j + 1], weights=weights[i : j + 1]) for j in range(k, n)) for i in range(k + 1))
        for k in range(n)
    ]


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.1, 10.0)), min_size=1, max_size=12))
def test_rising_is_the_isotonic_fit(pairs):
    values, weights = np.array(pairs).T
    assert np.allclose(rising(values, weights), fitted(values, weights), atol=1e-9)
    assert np.allclose(rising(values), fitted(values, np.ones(values.size)), atol=1e-9)


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=30))
def test_a_fit_never_falls_keeps_the_mean_and_is_its_own_fit(values):
    found = rising(np.array(values))
    assert np.all(np.diff(found) >= 0.0)
    assert np.mean(found) == pytest.approx(np.mean(values), abs=1e-10)
    assert np.allclose(rising(found), found, atol=1e-12)


def test_rows_are_fitted_each_for_itself_and_the_input_is_kept():
    rows = np.array([[[0.0, 1.0, 0.5], [0.0, 0.5, 1.0]], [[1.0, 0.5, 0.0], [0.2, 0.2, 0.2]]])
    before = rows.copy()
    found = rising(rows)
    assert np.allclose(found, [[[0.0, 0.75, 0.75], [0.0, 0.5, 1.0]], [[0.5, 0.5, 0.5], [0.2, 0.2, 0.2]]])
    assert np.array_equal(rows, before)


def test_falls_of_rounding_are_levelled():
    found = rising(np.array([0.3, 0.3 - 1e-15, 0.6]))
    assert found.tolist() == [0.3, 0.3, 0.6]
    assert rising(np.array([1e-12, 0.0])).tolist() == [1e-12, 1e-12]
    assert rising(np.array([2e-12, 0.0])) == pytest.approx([1e-12, 1e-12], rel=1e-9)


def test_mean_capacity_counts_what_lies_below_the_first_and_above_the_last_level_at_these():
    """Half of the capacity at 2 and half between 2 and 4, or 0.0005 of it at 8, by hand."""
    rows = np.array([[0.5, 1.0], [0.0, 0.9995]])
    low, high = np.log([2.0, 4.0])
    expected = np.exp([0.5 * low + 0.5 * 0.5 * (low + high), 0.9995 * 0.5 * (low + high) + 0.0005 * high])
    assert mean_capacity(np.array([2.0, 4.0]), rows) == pytest.approx(expected, rel=1e-12)


def test_the_crossing_is_linear_in_the_logarithm_of_each_row():
    rows = np.array([[[0.0, 0.2, 0.8, 1.0], [0.1, 0.3, 0.35, 0.6]]])
    level = np.array([1.0, 3.0, 5.0, 9.0])
    expected = [3.0 * (5.0 / 3.0) ** 0.5, 5.0 * (9.0 / 5.0) ** 0.6]
    assert factor_at(0.5, level, rows) == pytest.approx(np.array([expected]), rel=1e-12)


@pytest.mark.parametrize("share", [0.05, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("spread", [0.1, 0.4])
def test_crossings_of_a_lognormal_capacity_are_its_quantiles(share, spread):
    """The error of a straight line over a step h is at most h^2/8 abs(P''/P'), here 5e-5 abs(z)/spread."""
    found = factor_at(share, LEVELS, norm.cdf(np.log(LEVELS / 1.7) / spread))
    error = 5e-5 * abs(norm.ppf(share)) / spread + 1e-4
    assert math.log(found) == pytest.approx(math.log(1.7) + spread * norm.ppf(share), abs=error)


@pytest.mark.parametrize("spread", [0.1, 0.4])
def test_mean_capacity_of_a_lognormal_is_its_median(spread):
    assert mean_capacity(LEVELS, norm.cdf(np.log(LEVELS / 1.7) / spread)) == pytest.approx(1.7, rel=1e-6)


@pytest.mark.parametrize(("probability", "mean"), [([0.0, 0.0, 1.0], 4.0), ([0.0, 1.0, 1.0], 2.0**0.5)])
def test_mean_capacity_of_one_step_is_the_middle_of_its_levels(probability, mean):
    assert mean_capacity(np.array([1.0, 2.0, 8.0]), np.array(probability)) == pytest.approx(mean, rel=1e-12)


def test_mean_capacity_of_two_capacities_is_their_weighted_geometric_mean():
    """A third overturns from 0.5 on, the others from 4 on: steps at the middle of an interval between levels."""
    half = 0.5 * math.log(LEVELS[1] / LEVELS[0])
    low, high = LEVELS[100] * math.exp(half), LEVELS[250] * math.exp(half)
    probability = np.where(high < LEVELS, 1.0, np.where(low < LEVELS, 1.0 / 3.0, 0.0))
    assert mean_capacity(LEVELS, probability) == pytest.approx(low ** (1.0 / 3.0) * high ** (2.0 / 3.0), rel=1e-12)


def test_mean_capacity_is_the_same_of_p_and_of_its_fit():
    """The fit keeps the mean of what it pools, and with it the area on even levels."""
    noisy = np.clip(norm.cdf(np.log(LEVELS) / 0.3) + 0.2 * np.sin(40.0 * np.log(LEVELS)), 0.0, 1.0)
    noisy[:50], noisy[-50:] = 0.0, 1.0
    assert mean_capacity(LEVELS, rising(noisy)) == pytest.approx(float(mean_capacity(LEVELS, noisy)), rel=1e-12)


def test_a_step_is_crossed_within_it():
    """All of a jump lies between two levels, and the crossing divides ln f as the share divides the jump."""
    assert factor_at(0.25, np.array([1.0, 16.0]), np.array([0.0, 1.0])) == pytest.approx(2.0)


def test_a_plateau_at_the_share_is_reached_at_its_begin():
    assert factor_at(0.5, np.array([1.0, 2.0, 4.0, 8.0]), np.array([0.0, 0.5, 0.5, 1.0])) == 2.0


def test_a_share_that_is_reached_at_the_lowest_level_or_nowhere():
    rows = np.array([[0.6, 0.7, 0.8], [0.0, 0.1, 0.4], [0.5, 0.5, 0.5]])
    assert factor_at(0.5, np.array([1.0, 2.0, 4.0]), rows).tolist() == [1.0, math.inf, 1.0]


def test_a_single_level():
    assert factor_at(0.5, np.array([3.0]), np.array([[1.0], [0.0]])) == pytest.approx([3.0, math.inf])
    assert rising(np.array([0.4])).tolist() == [0.4]


def test_a_capacity_beyond_the_last_level_has_no_mean():
    rows = np.array([[0.0, 0.5, 0.99], [0.0, 0.5, 0.9995], [0.0, 0.0, 0.0], [0.0, 0.5, 0.999]])
    assert np.isfinite(mean_capacity(np.array([1.0, 2.0, 4.0]), rows)).tolist() == [False, True, False, False]


def test_levels_of_no_gain_around_the_others_change_no_bit_of_the_mean():
    probability = norm.cdf(np.log(LEVELS / 1.7) / 0.3)
    probability[:60], probability[-60:] = 0.0, 1.0
    found = float(mean_capacity(LEVELS, probability))
    for first, last in ((1, 300), (17, 290), (59, 243), (33, 260)):
        part = slice(first, last)
        assert float(mean_capacity(LEVELS[part], probability[part])) == found
