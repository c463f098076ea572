"""Statistics over earthquakes: resamples, intervals and quantiles."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.stats import beta

from rockpulse.earthquakes import (
    bootstrap_interval,
    draw_earthquakes,
    jackknife_half_width,
    lognormal_mean_half_width,
    probability_interval,
    record_quantiles,
    weighted_quantile,
)


def test_an_event_that_outweighs_the_others_counts_for_them():
    values, resampled = 0.2, np.random.default_rng(0).normal(0.2, 0.1, 500)
    even, uneven = (
        bootstrap_interval(values, resampled, np.array(sizes), 0.9) for sizes in ([1.0] * 5, [8.0, 1, 1, 1, 1])
    )
    assert uneven[1] - uneven[0] > 2.0 * (even[1] - even[0])
    assert np.isnan(bootstrap_interval(values, resampled, np.array([3.0, 0.0]), 0.9)).all()


def test_resamples_without_bound_leave_the_interval_open():
    draws = draw_earthquakes(5, 1000, 0)
    rare, common = draws[:, 0] > 4, draws[:, 0] > 0
    for where, bounded in ((rare, True), (common, False)):
        lower, upper = bootstrap_interval(0.1, np.where(where, np.inf, 0.1 * draws[:, 1]), np.ones(5), 0.9)
        assert lower < 0.1 < upper
        assert np.isfinite(upper) == bounded


def test_draws_hold_as_many_events_as_there_are_and_depend_on_the_seed_alone():
    draws = draw_earthquakes(7, 50, 4)
    assert (draws.sum(axis=1) == 7).all()
    np.testing.assert_array_equal(draws, draw_earthquakes(7, 50, 4))
    assert (draws != draw_earthquakes(7, 50, 5)).any()


@pytest.mark.parametrize(
    ("level", "expected"), [(0.0, 1.0), (0.1, 1.0), (0.11, 2.0), (0.5, 2.0), (0.61, 5.0), (1.0, 5.0)]
)
def test_weighted_quantiles_are_values_that_occur(level, expected):
    assert weighted_quantile(np.array([5.0, 1.0, np.nan, 2.0]), level, np.array([4.0, 1.0, 9.0, 5.0])) == expected


def test_weighted_quantiles_are_those_of_exact_fractions():
    """Weights 1/n of events: sums that are exactly a share of the total come out a bit off in floats."""
    generator = np.random.default_rng(0)
    for _ in range(150):
        sizes = generator.integers(1, 12, generator.integers(1, 30))
        exact = [Fraction(1, int(size)) for size in sizes]
        for percent in (16, 50, 84):
            least = Fraction(percent, 100) * sum(exact)
            expected = next(place for place in range(sizes.size) if sum(exact[: place + 1]) >= least)
            assert weighted_quantile(np.arange(sizes.size, dtype=float), percent / 100.0, 1.0 / sizes) == expected


def test_half_width_of_a_sum_over_events_is_exact():
    values = np.array([1.0, 2.0, 4.0, 7.0])
    estimates = np.array([values.mean(), *(np.delete(values, k).mean() for k in range(4))])[:, None]
    assert jackknife_half_width(estimates, 0.9)[0] == pytest.approx(2.3533634 * values.std(ddof=1) / 2.0)


@pytest.mark.parametrize("earthquakes", [8, 14, 30])
@pytest.mark.parametrize("scatter", [0.5, 1.0, 1.5])
def test_the_interval_of_an_inventory_covers_what_it_says(earthquakes, scatter):
    """4000 sets of lognormal frequencies, drawn with another seed than those on which the interval was chosen."""
    random = np.random.default_rng([2026, earthquakes])
    drawn = np.exp(scatter * random.standard_normal((4000, earthquakes)))
    middle, half = np.log(drawn.mean(axis=1)), lognormal_mean_half_width(drawn, 0.9)
    inside = np.mean(np.abs(middle - 0.5 * scatter**2) <= half)
    assert 0.85 <= inside <= 0.93


def test_the_interval_of_certain_answers_is_that_of_jeffreys():
    low, high = probability_interval(np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert (low, high) == pytest.approx(beta.ppf([0.05, 0.95], 2.5, 6.5))


@pytest.mark.parametrize("count", [1, 5, 13])
def test_where_all_earthquakes_agree_one_end_is_theirs_and_the_other_is_not(count):
    none, all_of = (probability_interval(np.full(count, value)) for value in (0.0, 1.0))
    assert none == (0.0, pytest.approx(beta.ppf(0.95, 0.5, count + 0.5)))
    assert all_of == (pytest.approx(1.0 - none[1]), 1.0)


def test_the_interval_narrows_with_equal_values_and_contains_the_mean():
    values = np.array([[0.3, 0.9, 0.02, np.nan], [0.3, 0.0, 0.0, np.nan], [0.3, 0.0, 0.01, np.nan]])
    low, high = probability_interval(values)
    mean = values.mean(axis=0)
    assert np.all(low[:3] <= mean[:3])
    assert np.all(mean[:3] <= high[:3])
    assert high[0] - low[0] < high[1] - low[1]
    assert np.isnan([low[3], high[3]]).all()
    more, fewer = (probability_interval(values[:, 0], count) for count in (3, 2))
    assert more == (pytest.approx(low[0]), pytest.approx(high[0]))
    assert fewer[1] > more[1]


@pytest.mark.slow
@pytest.mark.parametrize("count", [5, 9, 13])
def test_the_interval_covers_the_mean_probability_of_other_earthquakes(count):
    rng = np.random.default_rng(5)
    # Probabilities of a body whose median capacity is 1.5, with a log-dispersion of 0.6 between earthquakes.
    pool = 1.0 / (1.0 + np.exp((np.log(1.5) + 0.6 * rng.standard_normal(200_000)) / 0.08))
    low, high = probability_interval(rng.choice(pool, size=(count, 4000)))
    assert 0.86 <= np.mean((low <= pool.mean()) & (pool.mean() <= high)) <= 0.96


def predictive(values, level, events, draws=None):
    weights = 1.0 / np.bincount(events)[events]
    known = {"weights": weights, "events": events, "confidence": 0.9}
    (found,) = record_quantiles(
        values, [level], True, **known, draws=np.zeros((0, events.max() + 1)) if draws is None else draws
    )
    return found


def test_a_predictive_quantile_lies_between_order_statistics_at_i_over_g_plus_one():
    values = np.exp([0.0, 1.0, 3.0, 7.0])[:, np.newaxis]
    events = np.arange(4)
    for level, expected in ((0.2, 0.0), (0.4, 1.0), (0.5, 2.0), (0.7, 5.0), (0.8, 7.0), (0.99, 7.0), (0.01, 0.0)):
        assert np.log(predictive(values, level, events).value) == pytest.approx([expected], abs=1e-12)
    # Copies within an earthquake leave a level between the others where it is.
    twice = np.repeat(np.arange(4), 2)
    assert np.log(predictive(np.repeat(values, 2, axis=0), 0.5, twice).value) == pytest.approx([2.0])


@pytest.mark.parametrize(
    ("level", "count"),
    [
        pytest.param(level, count, marks=pytest.mark.sweep if (level, count) == (0.84, 7) else pytest.mark.slow)
        for level in (0.5, 0.84)
        for count in (7, 13)
    ],
)
def test_a_further_earthquake_exceeds_the_predictive_quantile_with_the_stated_probability(level, count):
    random = np.random.default_rng(3)
    values = np.exp(random.standard_normal((count, 8000)) * 0.5)
    found = predictive(values, level, np.arange(count)).value
    assert np.mean(np.exp(random.standard_normal(8000) * 0.5) > found) == pytest.approx(1.0 - level, abs=0.013)


def test_resamples_of_a_predictive_quantile_are_those_of_the_drawn_earthquakes():
    values = np.exp(np.random.default_rng(5).standard_normal((6, 1)))
    draws = np.array([[2, 2, 2, 0, 0, 0], [0, 2, 0, 2, 2, 0]])
    found = predictive(values, 0.5, np.arange(6), draws)
    # Three earthquakes of weight 2 each: the middle one.
    middle = [np.median(np.log(values[own])) for own in ([0, 1, 2], [1, 3, 4])]
    whole = np.log(found.value[0])
    assert whole == pytest.approx(np.median(np.log(values)))
    expected = bootstrap_interval(whole, np.array(middle), np.ones(6), 0.9)
    assert np.log([found.lower[0], found.upper[0]]) == pytest.approx(expected)
