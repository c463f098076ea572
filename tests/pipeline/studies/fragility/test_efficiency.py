"""Efficiency and sufficiency on capacities that are made to have them, or not."""

import numpy as np
import pytest

from rockpulse.studies.fragility.curves import fit_curve
from rockpulse.studies.fragility.efficiency import dispersion_ratio, sufficiency
from rockpulse.studies.fragility.observations import ABOVE, EXACT, Observations

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
    assert sufficiency(rows(capacity), 0).slope == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("limit", [np.inf, 1.5])
def test_a_measure_that_leaves_a_quality_out_is_not_sufficient(limit):
    found = sufficiency(rows(SCATTER * QUALITY**0.5, limit), 0)
    assert found.slope == pytest.approx(0.5, abs=0.15)
    assert found.p_value < 0.001
    assert sufficiency(rows(SCATTER, limit), 0).p_value > 0.05


def test_a_quality_that_all_records_share_says_nothing():
    capacity = Observations.of(SCATTER, np.full(SCATTER.size, EXACT), EVENT, qualities=np.ones((SCATTER.size, 1)))
    found = sufficiency(capacity, 0)
    assert np.isnan(found.slope)
    assert np.isnan(found.p_value)


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
    found = sufficiency(observed, 0)
    assert found.slope == pytest.approx(-0.5, abs=0.2)
    assert found.p_value < 0.01
    assert found == sufficiency(observed.only(observed.having(0)), 0)
    assert sufficiency(by_magnitude(np.random.default_rng(3), 16, 12, 0.0), 0).p_value > 0.05


def test_rows_that_are_kept_know_their_own_events_only():
    observed = by_magnitude(np.random.default_rng(3), 5, 2, 0.0)
    kept = observed.only(observed.having(0))
    assert (kept.events, kept.records, kept.level.size) == (("0", "1"), 6, 6)
    np.testing.assert_array_equal(kept.level, np.sort(observed.level[observed.cluster < 2]))
    assert kept.without_each_event().shape == (3, 6)


@pytest.mark.parametrize("stated", [0, 1, 2])
def test_magnitudes_of_fewer_than_three_earthquakes_are_no_test(stated):
    assert np.isnan(sufficiency(by_magnitude(np.random.default_rng(3), 16, stated, -0.5), 0).p_value)


def test_one_magnitude_that_differs_is_no_test():
    event = np.repeat(np.arange(4), 3)
    magnitude = np.where(event == 0, 6.0, 7.0)
    observed = Observations.of(SCATTER[:12], np.full(12, EXACT), event, qualities=np.exp(magnitude)[:, None])
    assert np.isnan(sufficiency(observed, 0).p_value)


@pytest.mark.sweep
@pytest.mark.parametrize(("stated", "levels"), [(4, (0.05, 0.1)), (10, (0.1, 0.5, 0.9))])
def test_p_values_of_a_capacity_that_magnitude_does_not_change_are_uniform(stated, levels):
    rng = np.random.default_rng(2)
    p_values = np.array([sufficiency(by_magnitude(rng, 12, stated, 0.0), 0).p_value for _ in range(400)])
    for level in levels:  # of few earthquakes large p-values are rarer than that
        assert np.mean(p_values < level) == pytest.approx(level, abs=0.06)


@pytest.mark.slow
def test_p_values_of_a_sufficient_measure_are_uniform():
    rng, small, sets = np.random.default_rng(1), 0, 1000
    for _ in range(sets):
        event = np.repeat(np.arange(10), 3)
        shared = rng.standard_normal((2, 10))[:, event]
        capacity, quality = np.exp(0.3 * (shared + rng.standard_normal((2, event.size))))
        observed = Observations.of(capacity, np.full(event.size, EXACT), event, qualities=quality[:, None])
        small += sufficiency(observed, 0).p_value < 0.1
    print(f"{small} of {sets} p-values below 0.1")
    assert small / sets == pytest.approx(0.1, abs=0.03)


def test_the_ratio_of_dispersions_is_sharper_than_the_dispersions():
    noisy = SCATTER * np.exp(RNG.normal(0.0, 0.15, EVENT.size))
    reference, other = fit_curve(rows(SCATTER)), fit_curve(rows(noisy))
    ratio, low, high = dispersion_ratio(other, reference)
    assert ratio == pytest.approx(other.beta / reference.beta)
    assert low < ratio < high
    assert np.log(high / low) < np.log(reference.beta_high / reference.beta_low)
    assert dispersion_ratio(reference, reference) == (1.0, 1.0, 1.0)
