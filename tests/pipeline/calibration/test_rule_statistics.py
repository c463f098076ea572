"""Rates and curves of a score against counting by hand; earthquakes resampled."""

import numpy as np
import pytest
from scipy.stats import binom, mannwhitneyu

from rockpulse.calibration.rule_statistics import area, curve, false_at, limit, missed_bound, resampled, resampled_share


def scores(seed, n=200):
    random = np.random.default_rng(seed)
    over = random.uniform(size=n) < 0.3
    return np.round(random.normal(size=n) + over, 1), over  # with ties


@pytest.mark.parametrize("share", [0.0, 0.01, 0.05, 0.1, 0.5])
def test_the_limit_is_the_highest_that_misses_no_more(share):
    values, over = scores(1)
    lowest = limit(values[over], share)
    assert np.mean(values[over] < lowest) <= share
    higher = np.min(values[over][values[over] > lowest])
    assert np.mean(values[over] < higher) > share
    assert false_at(values, over, share) == np.mean(values[~over] >= lowest)


def test_a_share_that_is_a_whole_number_of_cases_may_be_missed_in_full():
    assert limit(np.arange(20.0), 0.05) == 1.0
    assert limit(np.arange(100.0), 0.07) == 7.0  # 0.07 * 100 is 7.000000000000001
    assert limit(np.arange(100.0), 0.29) == 29.0  # 0.29 * 100 is 28.999999999999996


def test_the_curve_is_that_of_every_limit():
    values, over = scores(2)
    missed, false = curve(values, over)
    for level, gone, wrong in zip(np.sort(values[over])[::-1], missed, false, strict=True):
        assert gone == pytest.approx(np.mean(values[over] < level))
        assert wrong == pytest.approx(np.mean(values[~over] >= level))
    assert missed[-1] == 0.0


def test_the_area_is_the_mann_whitney_statistic():
    values, over = scores(3)
    expected = mannwhitneyu(values[over], values[~over]).statistic / (np.sum(over) * np.sum(~over))
    assert area(values, over) == pytest.approx(expected)


def test_the_bound_of_the_missed_share_is_exact():
    bound = missed_bound(3, 80)
    assert binom.cdf(3, 80, bound) == pytest.approx(0.05)


def test_earthquakes_are_resampled_whole():
    events = np.repeat(["a", "b", "c"], [4, 6, 10])
    over = np.tile([True, False], 10)
    sizes = {"a": 4, "b": 6, "c": 10}

    def seen(drawn):
        for event in "abc":
            times = np.bincount(drawn, minlength=20)[events == event]
            assert np.all(times == times[0])
        return float(drawn.size)

    found = resampled(events, over, seen, resamples=50)
    assert set(found.values) <= {
        float(i + j + k) for i in sizes.values() for j in sizes.values() for k in sizes.values()
    }
    assert np.array_equal(found.values, resampled(events, over, seen, resamples=50).values)
    assert not np.array_equal(found.values, resampled(events, over, seen, seed=1, resamples=50).values)
    low, high = found.between()
    assert low < found.below(0.9) <= high


def test_a_share_is_resampled_like_everything_else():
    values, over = scores(4)
    events = np.repeat(list("abcdefghij"), 20)
    alarm = values > 0.5
    slow = resampled(events, over, lambda drawn: np.mean(alarm[drawn][over[drawn]]), resamples=30)
    assert resampled_share(events, over & alarm, over, resamples=30).values == pytest.approx(slow.values)


def test_resamples_of_one_verdict_have_no_value():
    events = np.array(["a", "b"])
    found = resampled(events, np.array([True, False]), lambda drawn: 1.0, resamples=200)
    assert 0.3 < np.mean(np.isnan(found.values)) < 0.7  # both draws the same earthquake
    none = resampled(events, np.array([True, True]), lambda drawn: 1.0, resamples=20)
    assert np.isnan(none.between()).all()
