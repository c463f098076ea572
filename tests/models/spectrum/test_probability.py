"""The shift of ln f, isotonic fits and their crossings, and the estimator from lanes, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ndtr
from scipy.stats import norm

from rocking.spectrum.probability import (
    Uncertainty,
    factor_at,
    lane_bells,
    lane_probability,
    lane_sums,
    mean_capacity,
    rising,
    tail_masses,
)

SHIFTS = (-0.35, 0.0, 0.5)
KNOWN = [Uncertainty(), Uncertainty(factor=0.02, geometry=0.3), Uncertainty(factor=0.5, geometry=0.05)]


def over_the_loss(inner, known):
    """Mean over g abs(N) of a function of it, by quadrature."""
    return quad(lambda n: inner(known.geometry * n) * 2.0 * norm.pdf(n), 0.0, 12.0, epsabs=1e-12, limit=400)[0]


@pytest.mark.parametrize("known", KNOWN)
@pytest.mark.parametrize("shift", SHIFTS)
def test_density_is_the_convolution_of_a_normal_and_a_half_normal(known, shift):
    exact = over_the_loss(lambda loss: norm.pdf(shift - loss, scale=known.factor), known)
    assert known.density(shift) == pytest.approx(exact, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("known", KNOWN)
@pytest.mark.parametrize("shift", SHIFTS)
def test_distribution_is_that_of_the_sum(known, shift):
    exact = over_the_loss(lambda loss: norm.cdf(shift - loss, scale=known.factor), known)
    assert known.below(shift) == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("known", KNOWN)
def test_spread_is_the_standard_deviation_of_the_density(known):
    shifts = np.linspace(-8.0, 8.0, 400001) * math.hypot(known.factor, known.geometry)
    mass = known.density(shifts) * (shifts[1] - shifts[0])
    mean = np.sum(mass * shifts)
    assert np.sum(mass) == pytest.approx(1.0, abs=1e-9)
    assert mean == pytest.approx(known.geometry * math.sqrt(2.0 / math.pi), abs=1e-7)
    assert math.sqrt(np.sum(mass * (shifts - mean) ** 2)) == pytest.approx(known.spread, rel=1e-6)


def test_without_geometry_the_shift_is_normal():
    known, shifts = Uncertainty(factor=0.2, geometry=0.0), np.linspace(-1.0, 1.0, 41)
    assert np.allclose(known.density(shifts), norm.pdf(shifts, scale=0.2), rtol=1e-12)
    assert np.allclose(known.below(shifts), norm.cdf(shifts, scale=0.2), rtol=1e-12)
    assert known.spread == 0.2


BAD = {
    "factor": [math.nan, "10 %", [0.1, 0.2]],
    "restitution": [(0.0, 1.0), (0.9, 2.0 + 1e-9), (0.9, math.nan), (0.9,), 0.9, (0.9, 1.0, -0.1)],
    "geometry": [[0.1, 0.2], math.inf],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in BAD.items() for value in values])
def test_a_value_out_of_range_is_named(name, value):
    with pytest.raises(ValueError, match=name):
        Uncertainty(**{name: value})


@pytest.mark.parametrize(("name", "least", "most"), [("factor", 0.02, 1.0), ("geometry", 0.0, 1.0)])
def test_the_ends_of_a_range_belong_to_it(name, least, most):
    for value in (least, most):
        assert getattr(Uncertainty(**{name: value}), name) == value
    for value in (least - 1e-6, most + 1e-6):
        with pytest.raises(ValueError, match=name):
            Uncertainty(**{name: value})


def test_by_default_a_factor_of_10_percent_5_percent_of_restitution_to_both_sides_and_5_percent_of_the_angle():
    known = Uncertainty()
    assert (known.factor, known.restitution, known.geometry) == (0.1, (0.95, 1.05), 0.05)
    for ends in ((1e-6, 1e-6), (2.0, 2.0), (1.0, 0.9)):
        assert Uncertainty(restitution=ends).restitution == ends


def test_two_restitutions_are_the_limits_of_a_uniform_distribution_and_a_restitution_above_1_counts_as_1():
    """Of the nominal 0.8 and 0.98: 0.76 to 0.84, and 0.931 to 1.029, of which ranks above 0.694 exceed 0.999."""
    found = Uncertainty().restitutions([0.8, 0.98], np.array([0.0, 0.25, 0.69, 0.7, 1.0]))
    assert found[0] == pytest.approx([0.76, 0.78, 0.76 + 0.69 * 0.08, 0.76 + 0.7 * 0.08, 0.84], rel=1e-12)
    assert found[1] == pytest.approx([0.931, 0.931 + 0.25 * 0.098, 0.931 + 0.69 * 0.098, 0.999, 0.999], rel=1e-12)
    assert Uncertainty(restitution=(1.05, 0.95)).restitutions(0.8, np.array([0.25])) == pytest.approx([0.78])


def test_more_restitutions_are_measured_values_whose_quantiles_are_linear_between_them():
    """Five values, in any order: a quarter of the ranks lies between two of them; their mean is that of trapezia."""
    measured = Uncertainty(restitution=(0.97, 0.90, 1.10, 1.00, 0.99))
    found = measured.restitutions(0.9, np.array([0.0, 0.125, 0.25, 0.5, 0.75, 0.9, 1.0]))
    expected = 0.9 * np.array([0.90, 0.935, 0.97, 0.99, 1.00, 1.06, 1.10])
    assert found == pytest.approx(expected, rel=1e-12)
    mean = measured.restitutions(0.9, (np.arange(4000) + 0.5) / 4000).mean()
    assert mean == pytest.approx(0.9 * (0.5 * 0.90 + 0.97 + 0.99 + 1.00 + 0.5 * 1.10) / 4.0, rel=1e-6)


def test_beyond_eight_scales_the_density_is_zero():
    """One scale is the hypotenuse of both spreads, 0.5."""
    known = Uncertainty(factor=0.3, geometry=0.4)
    inside, outside = known.density(np.array([[-3.99, 3.99], [1.0, -1.0]])), known.density([-4.0, 4.0, 9.0])
    assert inside.shape == (2, 2)
    assert inside[0, 1] == pytest.approx(2.0 / 0.5 * norm.pdf(7.98) * norm.cdf(4.0 / 3.0 * 7.98), rel=1e-9, abs=0.0)
    assert outside.tolist() == [0.0, 0.0, 0.0]


LEVELS = np.exp(np.linspace(-3.0, 3.0, 301))


def fitted(values):
    """The isotonic fit by its definition: the largest over i <= k of the smallest over j >= k of the mean of i to j."""
    n = len(values)
    return [max(min(np.mean(values[i : j + 1]) for j in range(k, n)) for i in range(k + 1)) for k in range(n)]


@settings(derandomize=True, deadline=None, max_examples=25)
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=12))
def test_rising_is_the_isotonic_fit(values):
    assert np.allclose(rising(np.array(values)), fitted(values), atol=1e-9)


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


@pytest.mark.parametrize(("probability", "mean"), [([0.0, 0.0, 1.0], 4.0), ([0.0, 1.0, 1.0], 2.0**0.5)])
def test_mean_capacity_of_one_step_is_the_middle_of_its_levels(probability, mean):
    assert mean_capacity(np.array([1.0, 2.0, 8.0]), np.array(probability)) == pytest.approx(mean, rel=1e-12)


def test_mean_capacity_is_the_same_of_p_and_of_its_fit():
    """The fit keeps the mean of what it pools, and with it the area on even levels."""
    noisy = np.clip(norm.cdf(np.log(LEVELS) / 0.3) + 0.2 * np.sin(40.0 * np.log(LEVELS)), 0.0, 1.0)
    noisy[:50], noisy[-50:] = 0.0, 1.0
    assert mean_capacity(LEVELS, rising(noisy)) == pytest.approx(float(mean_capacity(LEVELS, noisy)), rel=1e-12)


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


LOGS = np.linspace(-0.6, 0.6, 25)
NORMAL = Uncertainty(geometry=0.0)
SKEW = Uncertainty(geometry=0.2)


def estimate(lanes, weight, over, bottom, top, shift):
    bell = lane_bells(lanes, weight, LOGS, shift)
    return lane_probability(over @ bell, bell.sum(axis=0), *tail_masses(bottom, top, LOGS, shift))


@pytest.mark.parametrize("kind", [bool, np.int64, float])
def test_sums_over_the_lanes_are_those_of_the_matrix_product(kind):
    rng = np.random.default_rng(5)
    counted, bells = rng.integers(0, 3, (20, 70)).astype(kind), rng.random((70, 33))
    np.testing.assert_allclose(lane_sums(counted, bells), counted.astype(float) @ bells, rtol=1e-14)
    np.testing.assert_allclose(lane_sums(counted[:, ::2], bells[::2]), counted[:, ::2].astype(float) @ bells[::2])
    # One lane after the other, so that any part of the sums has the bits of the whole.
    assert np.array_equal(lane_sums(counted, bells)[3:4, 5:9], lane_sums(counted[3:4], bells[:, 5:9]))


def test_two_sets_of_factors_that_overturn():
    """Overturning from -0.2 to 0 and from 0.1 on: P is the mass of the shift over both."""
    lanes = np.arange(-0.9995, 1.0, 0.001)
    over = ((lanes > -0.2) & (lanes < 0.0)) | (lanes > 0.1)
    found = estimate(lanes, np.full(lanes.size, 0.001), over, -1.0, 1.0, SKEW)
    exact = SKEW.below(-LOGS) - SKEW.below(-0.2 - LOGS) + 1.0 - SKEW.below(0.1 - LOGS)
    assert np.allclose(found, exact, atol=1e-4)


def test_lanes_of_uneven_density_weigh_by_what_they_stand_for():
    place = (np.arange(4000) + 0.5) / 4000
    lanes = np.sign(place - 0.5) * (2.0 * place - 1.0) ** 2  # density 4000/(4 sqrt(abs(ln f)))
    weight = 4.0 * np.sqrt(np.abs(lanes)) / 4000
    found = estimate(lanes, weight, lanes > 0.05, -1.0, 1.0, NORMAL)
    assert np.allclose(found, ndtr((LOGS - 0.05) / 0.1), atol=2e-3)


def test_outside_the_lanes_the_verdict_is_known():
    """Lanes over 0.1 of ln f, half of which overturn: far below them P is 0, far above it is 1."""
    lanes = np.linspace(-0.05, 0.05, 50)
    found = estimate(lanes, np.full(50, 0.002), np.arange(50) % 2 == 0, -0.05, 0.05, NORMAL)
    above, inside = ndtr((LOGS - 0.05) / 0.1), ndtr((LOGS + 0.05) / 0.1) - ndtr((LOGS - 0.05) / 0.1)
    assert np.allclose(found, above + 0.5 * inside, atol=2e-3)
    assert found[0] < 1e-7
    assert found[-1] > 1.0 - 1e-7


def test_no_lane_near_a_level():
    """The middle of two distant groups: no weight there, and no division by it."""
    lanes = np.array([-8.0, 8.0])
    found = estimate(lanes, np.full(2, 1.0), np.array([False, True]), -9.0, 9.0, NORMAL)
    assert np.array_equal(found, np.zeros(LOGS.size))
