"""Efficiency and sufficiency on capacities that are made to have them, or not."""

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import t

from rockpulse.studies.fragility.curves import fit_curve
from rockpulse.studies.fragility.ensemble import dispersion_ratio, sufficiency
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, NOT_ABOVE, Observations

EVENT = np.repeat([f"event {k:02d}" for k in range(12)], 4)
RNG = np.random.default_rng(7)
QUALITY = np.exp(RNG.normal(0.0, 0.6, EVENT.size))
SCATTER = np.exp(RNG.normal(0.0, 0.3, EVENT.size))


def rows(capacity, limit=np.inf):
    kind = np.where(capacity > limit, ABOVE, EXACT)
    return Observations.of(np.minimum(capacity, limit), kind, EVENT, qualities=QUALITY[:, None])


def test_the_slope_is_that_of_least_squares_where_all_capacities_are_known():
    capacity = SCATTER * QUALITY**0.4
    slope = np.polyfit(np.log(QUALITY), np.log(capacity), 1)[0]
    assert sufficiency(rows(capacity), 0)[0] == pytest.approx(slope, rel=1e-6)


def jackknifed(estimate, events):
    """An estimate from a mask of rows, and its standard error over the events, by leaving each of them out."""
    whole, names = estimate(np.ones(events.size, dtype=bool)), np.unique(events)
    without = np.array([estimate(events != name) for name in names])
    return whole, np.sqrt((names.size - 1) / names.size * np.sum((without - whole) ** 2)), names.size - 1


@pytest.mark.parametrize("events", [3, 12])
def test_the_p_value_is_that_of_the_jackknifed_least_squares_slope(events):
    kept = slice(0, 4 * events)
    event, quality, capacity = EVENT[kept], QUALITY[kept], SCATTER[kept] * QUALITY[kept] ** 0.2
    rows = Observations.of(capacity, np.full(event.size, EXACT), event, qualities=quality[:, None])
    fitted, error, free = jackknifed(lambda own: np.polyfit(np.log(quality[own]), np.log(capacity[own]), 1)[0], event)
    slope, p_value = sufficiency(rows, 0)
    assert slope == pytest.approx(fitted, rel=1e-6)
    assert p_value == pytest.approx(2.0 * t(free).sf(abs(fitted) / error), rel=1e-5)
    assert 0.001 < p_value < 0.9


@pytest.mark.parametrize("limit", [np.inf, 1.5])
def test_a_measure_that_leaves_a_quality_out_is_not_sufficient(limit):
    slope, p_value = sufficiency(rows(SCATTER * QUALITY**0.5, limit), 0)
    assert slope == pytest.approx(0.5, abs=0.15)
    assert p_value < 0.001
    assert sufficiency(rows(SCATTER, limit), 0)[1] > 0.05


def test_a_quality_that_all_records_share_says_nothing():
    capacity = Observations.of(SCATTER, np.full(SCATTER.size, EXACT), EVENT, qualities=np.ones((SCATTER.size, 1)))
    slope, p_value = sufficiency(capacity, 0)
    assert np.isnan(slope)
    assert np.isnan(p_value)


def probit(level, quality, share, events):
    """Rows of stripes, 40 of each level and quality, of which this share reached the limit state."""
    reached = np.concatenate([np.arange(40) < np.rint(40.0 * one) for one in share])
    columns = [np.repeat(values, 40) for values in (level, events, quality)]
    return Observations.of(columns[0], np.where(reached, NOT_ABOVE, ABOVE), columns[1], qualities=columns[2][:, None])


def test_a_measure_that_falls_with_capacity_once_the_quality_is_known_is_no_test():
    """The quality rises with the level, and the share that reached with the quality alone."""
    x, u = np.array([-0.6, -0.1, 0.0, 0.4, 0.7]), np.array([-0.6, 0.0, -0.1, 0.6, 0.4])
    rows = probit(np.exp(x), np.exp(u), ndtr(3.0 * u - x), list("abcde"))
    assert fit_curve(rows).median > 0.0
    slope, p_value = sufficiency(rows, 0)
    assert np.isnan(slope)
    assert np.isnan(p_value)


@pytest.mark.parametrize("place", ["first", "last"])
def test_a_slope_that_rests_on_one_event_has_no_p_value(place):
    """Among the others the share falls with the level, which no curve does."""
    x, u = np.tile([-0.5, 0.0, 0.5], 4), np.tile([0.3, -0.6, 0.3], 4) + np.repeat([-0.1, 0.0, 0.1, 0.0], 3)
    slope = np.repeat([-0.2, -0.2, -0.2, 2.0], 3)
    names = np.repeat(["b", "c", "d", "a" if place == "first" else "e"], 3)
    slope, p_value = sufficiency(probit(np.exp(x), np.exp(u), ndtr(slope * x + 0.3 * u), names), 0)
    assert np.isfinite(slope)
    assert np.isnan(p_value)


def by_magnitude(rng, events, stated, dependence):
    """Capacities of three records of each event, scaled by exp(dependence M); M is stated for the first events only."""
    event = np.repeat(np.arange(events), 3)
    magnitude = rng.uniform(5.5, 7.8, events)[event]
    noise = 0.2 * (rng.standard_normal(events)[event] + rng.standard_normal(event.size))
    known = np.where(event < stated, np.exp(magnitude), np.nan)
    kind = np.full(event.size, EXACT)
    return Observations.of(np.exp(noise + dependence * magnitude), kind, event, qualities=known[:, None])


def test_a_capacity_that_falls_with_magnitude_is_found_from_the_records_that_state_it():
    observed = by_magnitude(np.random.default_rng(3), 16, 12, -0.5)
    slope, p_value = sufficiency(observed, 0)
    assert slope == pytest.approx(-0.5, abs=0.2)
    assert p_value < 0.01
    assert (slope, p_value) == sufficiency(observed.only(observed.having(0)), 0)
    assert sufficiency(by_magnitude(np.random.default_rng(3), 16, 12, 0.0), 0)[1] > 0.05


@pytest.mark.parametrize("stated", [0, 1, 2])
def test_magnitudes_of_fewer_than_three_earthquakes_are_no_test(stated):
    assert np.isnan(sufficiency(by_magnitude(np.random.default_rng(3), 16, stated, -0.5), 0)[1])


def test_one_magnitude_that_differs_is_no_test():
    event = np.repeat(np.arange(4), 3)
    magnitude = np.where(event == 0, 6.0, 7.0)
    observed = Observations.of(SCATTER[:12], np.full(12, EXACT), event, qualities=np.exp(magnitude)[:, None])
    assert np.isnan(sufficiency(observed, 0)[1])


@pytest.mark.sweep
@pytest.mark.parametrize(("stated", "levels"), [(4, (0.05, 0.1)), (10, (0.1, 0.5, 0.9))])
def test_p_values_of_a_capacity_that_magnitude_does_not_change_are_uniform(stated, levels):
    rng = np.random.default_rng(2)
    p_values = np.array([sufficiency(by_magnitude(rng, 12, stated, 0.0), 0)[1] for _ in range(400)])
    for level in levels:  # of few earthquakes large p-values are rarer than that
        assert np.mean(p_values < level) == pytest.approx(level, abs=0.06)


def test_the_ratio_of_dispersions_is_sharper_than_the_dispersions():
    noisy = SCATTER * np.exp(RNG.normal(0.0, 0.15, EVENT.size))
    reference, other = fit_curve(rows(SCATTER)), fit_curve(rows(noisy))
    ratio, low, high = dispersion_ratio(other, reference)
    assert ratio == pytest.approx(other.beta / reference.beta)
    assert low < ratio < high
    assert np.log(high / low) < np.log(reference.beta_high / reference.beta_low)
    assert dispersion_ratio(reference, reference) == (1.0, 1.0, 1.0)


@pytest.mark.parametrize("events", [2, 3, 12])
def test_the_band_of_the_ratio_is_jackknifed_over_the_events_of_both(events):
    """Where all capacities are known ln beta is the logarithm of their standard deviation."""
    kept = slice(0, 4 * events)
    event, first = EVENT[kept], SCATTER[kept]
    second = first * QUALITY[kept] ** 0.3
    curves = [
        fit_curve(Observations.of(one, np.full(event.size, EXACT), event), confidence=0.8) for one in (second, first)
    ]
    value, error, free = jackknifed(lambda own: np.log(np.std(np.log(second[own])) / np.std(np.log(first[own]))), event)
    ratio, low, high = dispersion_ratio(*curves)
    assert ratio == pytest.approx(np.exp(value), rel=1e-6)
    if events < 3:
        assert np.isnan([low, high]).all()
    else:
        half = t(free).ppf(0.9) * error
        assert (low, high) == pytest.approx((np.exp(value - half), np.exp(value + half)), rel=1e-5)
