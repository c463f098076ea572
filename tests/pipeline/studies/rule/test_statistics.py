"""Rates and curves of a score against counting by hand; earthquakes resampled."""

import numpy as np
import pytest
from scipy.stats import binom, mannwhitneyu

from rockpulse.studies.rule.statistics import area, curve, false_at, left_out, limit, missed_bound, resampled


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


def test_left_out_scores_are_over_the_limit_of_the_other_earthquakes():
    values, over = scores(4)
    values = values + 10.0
    events = np.repeat(list("abcdefghij"), 20)
    margins = left_out(values, over, events, 0.05)
    for event in "aj":
        out = events == event
        assert np.array_equal(margins[out], values[out] / limit(values[~out][over[~out]], 0.05))
    # Copies of an earthquake leave together: drawn twice, it is judged as if drawn once.
    twice = np.concatenate([np.arange(200), np.flatnonzero(events == "c")])
    again = left_out(values[twice], over[twice], events[twice], 0.0)
    assert np.array_equal(again[200:], left_out(values, over, events, 0.0)[events == "c"])


def test_a_limit_of_zero_gives_no_number():
    values, over, events = np.array([0.0, 8.0, 4.0]), np.array([True, True, False]), np.array(["a", "b", "b"])
    with np.errstate(all="raise"):
        margins = left_out(values, over, events, 0.0)
    assert margins[0] == 0.0
    assert np.isnan(margins[1:]).all()  # the other earthquake's one overturning has score 0


def test_earthquakes_are_resampled_whole():
    events = np.repeat(["a", "b", "c"], [4, 6, 10])
    over = np.tile([True, False], 10)
    sizes = {"a": 4, "b": 6, "c": 10}

    def seen(drawn):
        for event in "abc":
            times = np.bincount(drawn, minlength=20)[events == event]
            assert np.all(times == times[0])
        return {"size": float(drawn.size), "negative": -float(drawn.size)}

    found = resampled(events, over, seen, resamples=50)
    values = found["size"].values
    assert set(values[np.isfinite(values)]) <= {
        float(i + j + k) for i in sizes.values() for j in sizes.values() for k in sizes.values()
    }
    same = resampled(events, over, seen, resamples=50)["size"]
    assert np.array_equal(values, same.values, equal_nan=True)
    assert not np.array_equal(values, resampled(events, over, seen, seed=1, resamples=50)["size"].values, True)
    low, high = found["size"].between()
    assert low < found["size"].below(0.9) <= high
    assert (found["size"] - found["negative"]).between() == (2.0 * low, 2.0 * high)


def test_resamples_of_one_verdict_or_one_earthquake_have_no_value():
    events = np.array(["a", "b", "b"])
    found = resampled(events, np.array([True, True, False]), lambda drawn: {"one": 1.0}, resamples=200)["one"]
    assert 0.3 < np.mean(np.isnan(found.values)) < 0.7  # both draws the same earthquake
    assert resampled(events, np.array([True, True, True]), lambda drawn: {"one": 1.0}, resamples=20) == {}
    rare = resampled(np.arange(30), np.arange(30) < 1, lambda drawn: {"one": 1.0}, resamples=200)
    assert rare == {}
