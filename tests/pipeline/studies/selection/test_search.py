"""The search of a set of spectra: known sets are found, and bounds of factors and of earthquakes are kept."""

from itertools import combinations

import numpy as np
import pytest

from rockpulse.studies.selection.selection import fitting_set, own_factors

PERIODS = np.geomspace(0.15, 2.0, 24)
BOUNDS = (0.25, 4.0)


def waves(count):
    """(count, k) shapes whose mean over the periods and whose mean over the spectra are 1."""
    phase = 2.0 * np.pi * np.arange(PERIODS.size) / PERIODS.size
    turns = 2.0 * np.pi * np.arange(count) / count
    return 1.0 + 0.5 * np.sin(phase[None, :] + turns[:, None])


def others(count, seed=1):
    """(count, k) shapes with random peaks of their own."""
    random = np.random.default_rng(seed)
    centre, wide = random.uniform(0, PERIODS.size, (count, 1)), random.uniform(2.0, 5.0, (count, 1))
    return 0.5 + 2.0 * np.exp(-(((np.arange(PERIODS.size) - centre) / wide) ** 2))


def test_a_set_whose_mean_is_the_target_is_found_with_its_factors():
    strength = np.array([0.5, 1.6, 3.1, 0.8])
    ratios = np.concatenate([others(30), waves(4) / strength[:, None], others(30, seed=2)])
    found = fitting_set(ratios, [str(row) for row in range(len(ratios))], 4, BOUNDS)
    assert found.members.tolist() == [30, 31, 32, 33]
    assert found.factors == pytest.approx(strength)
    assert found.ratio == pytest.approx(np.ones(PERIODS.size))


def test_the_search_finds_the_best_of_all_sets_where_all_can_be_tried():
    ratios = others(14)
    shapes = ratios * own_factors(ratios, (1e-9, 1e9))[:, None]
    spreads = [np.ptp(np.log(shapes[list(some)].mean(axis=0))) for some in combinations(range(14), 3)]
    found = fitting_set(ratios, [*map(str, range(14))], 3, (1e-9, 1e9))
    assert np.ptp(np.log(found.ratio)) == pytest.approx(min(spreads))


def test_one_earthquake_gives_no_more_than_allowed():
    ratios = np.concatenate([waves(4), others(12)])
    events = ["one"] * 4 + [f"quake {row // 2}" for row in range(12)]
    for most in (1, 2):
        found = fitting_set(ratios, events, 4, BOUNDS, per_event=most)
        named = [events[member] for member in found.members]
        assert max(map(named.count, named)) <= most
    assert fitting_set(ratios, events, 4, BOUNDS, per_event=4).members.tolist() == [0, 1, 2, 3]


def test_factors_stay_within_their_bounds():
    shapes = others(20) / others(20).mean(axis=1, keepdims=True) / np.linspace(0.85, 1.25, 20)[:, None]
    ratios = np.concatenate([waves(4) / 6.0, shapes])  # the best set needs factors of 6
    for bounds in ((0.25, 4.0), (0.8, 1.3)):
        found = fitting_set(ratios, [*map(str, range(24))], 5, bounds)
        assert np.all((found.factors >= bounds[0]) & (found.factors <= bounds[1]))
        assert found.members.min() >= 4
    assert np.isnan(own_factors(ratios, BOUNDS)[:4]).all()


@pytest.mark.parametrize(
    ("tolerance", "low", "high"),
    [
        ((0.1, 0.3), 0.9, 1.265),
        ((0.3, 0.1), 0.78255, 1.1),
        ((0.5, 0.5), 0.83137, 1.16863),
        ((0.01, 0.02), 0.83137, 1.16863),
    ],
)
def test_the_common_factor_centres_the_deviations_unless_the_tolerance_asks_for_another(tolerance, low, high):
    shape = np.linspace(1.0, 1.40566, PERIODS.size)
    found = fitting_set(shape[None, :], ["one"], 1, BOUNDS, tolerance=tolerance)
    assert (found.ratio.min(), found.ratio.max()) == pytest.approx((low, high), abs=1e-4)


def test_the_set_does_not_depend_on_the_order_of_equal_input():
    ratios, events = others(20), [*map(str, range(20))]
    found = fitting_set(ratios, events, 5, BOUNDS)
    reverse = fitting_set(ratios[::-1], events[::-1], 5, BOUNDS)
    assert sorted(19 - reverse.members) == found.members.tolist()


def test_a_zero_spectrum_is_not_used():
    found = fitting_set(np.concatenate([np.zeros((1, PERIODS.size)), waves(2)]), ["a", "b", "c"], 2, BOUNDS)
    assert found.members.tolist() == [1, 2]
