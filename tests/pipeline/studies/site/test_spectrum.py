"""Quantiles over earthquakes and their intervals."""

import numpy as np
import pytest

from rockpulse.studies.site.spectrum import QuantileSample, fewest_events
from rockpulse.studies.site.statistics import bootstrap_interval, event_draws, weighted_quantile

EVENTS = np.array([0, 0, 0, 1, 2, 2, 3, 4, 5, 6, 6, 7])
WEIGHTS = 1.0 / np.bincount(EVENTS)[EVENTS]
VALUES = np.exp(np.random.default_rng(2).standard_normal((12, 2, 3)))


def sample(events=EVENTS, weights=WEIGHTS, resamples=150):
    return QuantileSample(weights, events, event_draws(int(events.max()) + 1, resamples, 0), 0.9)


@pytest.mark.parametrize("logarithmic", [True, False])
def test_quantiles_and_intervals_are_those_of_the_resamples_one_by_one(logarithmic):
    one = sample()
    found = one.quantiles(VALUES, [0.5, 0.84], logarithmic)
    change, back = (np.log, np.exp) if logarithmic else (np.array, np.array)
    for level, quantiles in zip((0.5, 0.84), found, strict=True):
        assert quantiles.value.shape == (2, 3)
        for place in np.ndindex(2, 3):
            of = VALUES[(slice(None), *place)]
            value = weighted_quantile(of, level, WEIGHTS)
            assert quantiles.value[place] == value
            # Every resample with its records written out as often as their event was drawn.
            drawn = []
            for times in one.draws:
                rows = np.repeat(np.arange(12), times[EVENTS])
                drawn.append(weighted_quantile(of[rows], level, WEIGHTS[rows]))
            ends = bootstrap_interval(change(value), change(drawn), np.ones(8), 0.9)
            np.testing.assert_allclose((quantiles.lower[place], quantiles.upper[place]), back(ends), rtol=1e-12)


def test_more_records_of_an_earthquake_count_no_more_than_one():
    twice = np.concatenate([EVENTS, EVENTS[:3]])
    values = np.concatenate([VALUES, VALUES[:3]])
    weights = 1.0 / np.bincount(twice)[twice]
    (alone,), (more,) = (
        one.quantiles(of, [0.84], logarithmic=True)
        for one, of in ((sample(), VALUES), (sample(twice, weights), values))
    )
    for name in ("value", "lower", "upper"):
        np.testing.assert_allclose(getattr(alone, name), getattr(more, name), rtol=1e-12)


def test_a_single_earthquake_has_no_interval():
    (found,) = sample(np.zeros(12, dtype=int), np.ones(12)).quantiles(VALUES, [0.5], logarithmic=True)
    assert np.isfinite(found.value).all()
    assert np.isnan(found.lower).all()
    assert np.isnan(found.upper).all()


@pytest.mark.parametrize(("quantile", "least"), [(0.5, 5), (0.8, 5), (0.84, 7), (0.9, 10), (0.95, 20), (0.1, 10)])
def test_one_earthquake_lies_beyond_a_stated_quantile(quantile, least):
    assert fewest_events(quantile) == least
