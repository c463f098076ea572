"""Statistics of the rule by hand: false alarms, coefficients, earthquakes."""

import numpy as np
import pytest
from scipy.stats import norm

from laboratory.rule.statistics import between, coefficient, dispersion, false_at, resampled, weighted_median

pytestmark = pytest.mark.slow


def scores(seed, n=200):
    random = np.random.default_rng(seed)
    over = random.uniform(size=n) < 0.3
    return np.round(random.normal(size=n) + over, 1), over  # with ties


@pytest.mark.parametrize("share", [0.0, 0.01, 0.05, 0.1, 0.5])
def test_false_alarms_are_those_of_the_highest_limit_that_misses_no_more(share):
    values, over = scores(1)
    limits = [one for one in np.unique(values) if np.mean(values[over] < one) <= share]
    assert false_at(values, over, share) == np.mean(values[~over] >= max(limits))


def test_a_share_that_is_a_whole_number_of_cases_may_be_missed_in_full():
    values = np.append(np.arange(100.0), [6.5, 7.5])
    over = np.arange(102) < 100
    assert false_at(values, over, 0.07) == 0.5  # 0.07 * 100 is 7.000000000000001
    assert false_at(values, over, 0.29) == 0.0  # 0.29 * 100 is 28.999999999999996


def test_errors_known_from_below_count_by_what_they_may_be():
    random = np.random.default_rng(3)
    error = random.normal(0.1, 0.4, 4000)
    end = 0.3
    beyond = error > end
    cut = np.where(beyond, end, error)
    centre, spread = coefficient(cut, beyond, np.ones(4000))
    assert (centre, spread) == pytest.approx((0.1, 0.4), abs=0.02)

    # The most likely pair: any other is less so.
    def likelihood(at, width):
        return np.sum(np.where(beyond, norm.logsf(end, at, width), norm.logpdf(cut, at, width)))

    best = likelihood(centre, spread)
    for step in (-0.01, 0.01):
        assert likelihood(centre + step, spread) < best
        assert likelihood(centre, spread + step) < best


def test_weights_are_copies():
    random = np.random.default_rng(4)
    error, beyond = random.normal(size=60), random.uniform(size=60) < 0.2
    weight = random.integers(1, 4, 60)
    copied = np.repeat(np.arange(60), weight)
    assert coefficient(error, beyond, weight) == pytest.approx(
        coefficient(error[copied], beyond[copied], np.ones(copied.size)), abs=1e-3
    )
    odd = np.repeat(np.arange(61), np.append(weight, 1 + (np.sum(weight) % 2)))
    values = np.append(error, 9.0)
    assert weighted_median(values, np.append(weight, 1 + (np.sum(weight) % 2))) in (
        np.sort(values[odd])[odd.size // 2 - 1],
        np.sort(values[odd])[odd.size // 2],
    )


def test_the_scatter_within_bodies_knows_nothing_of_their_means():
    random = np.random.default_rng(5)
    bodies = np.repeat(np.arange(5), 200)
    error = random.normal(0.0, 0.2, 1000) + 3.0 * bodies
    assert dispersion(error, np.ones(1000), bodies) == pytest.approx(0.2, rel=0.05)
    assert dispersion(error, np.ones(1000)) > 4.0
    assert np.isnan(dispersion(error[:1], np.ones(1)))


def test_earthquakes_are_resampled_whole():
    events = np.repeat(["a", "b", "c"], [4, 6, 10])
    sizes = {"a": 4, "b": 6, "c": 10}

    def seen(drawn):
        for event in "abc":
            times = np.bincount(drawn, minlength=20)[events == event]
            assert np.all(times == times[0])
        return float(drawn.size)

    values = resampled(events, seen, resamples=50)
    assert set(values) <= {float(i + j + k) for i in sizes.values() for j in sizes.values() for k in sizes.values()}
    assert np.array_equal(values, resampled(events, seen, resamples=50))
    assert not np.array_equal(values, resampled(events, seen, seed=1, resamples=50))
    low, high = between(values)
    assert np.mean((values >= low) & (values <= high)) >= 0.95
