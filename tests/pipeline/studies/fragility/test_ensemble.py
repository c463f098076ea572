"""Efficiency and sufficiency on capacities that are made to have them, or not."""

from dataclasses import replace

import numpy as np
import pytest
from nominal import ida
from scipy.special import ndtr
from scipy.stats import t

from rockpulse.config.configuration import Config, SearchSettings
from rockpulse.studies.fragility.curves import fit_curve
from rockpulse.studies.fragility.ensemble import Ensemble, dispersion_ratio, sufficiency
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, NOT_ABOVE, Observations

EVENT = np.repeat([f"event {k:02d}" for k in range(12)], 4)
RNG = np.random.default_rng(7)
QUALITY = np.exp(RNG.normal(0.0, 0.6, EVENT.size))
SCATTER = np.exp(RNG.normal(0.0, 0.3, EVENT.size))


def rows(capacity, limit=np.inf):
    kind = np.where(capacity > limit, ABOVE, EXACT)
    return Observations.of(np.minimum(capacity, limit), kind, EVENT, qualities=QUALITY[:, None])


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
    assert (slope, p_value) == sufficiency(observed.only(observed.qualities[:, 0] > 0.0), 0)
    assert sufficiency(by_magnitude(np.random.default_rng(3), 16, 12, 0.0), 0)[1] > 0.05


@pytest.mark.parametrize("stated", [0, 1, 2])
def test_magnitudes_of_fewer_than_three_earthquakes_are_no_test(stated):
    assert np.isnan(sufficiency(by_magnitude(np.random.default_rng(3), 16, stated, -0.5), 0)[1])


def test_one_magnitude_that_differs_is_no_test():
    event = np.repeat(np.arange(4), 3)
    magnitude = np.where(event == 0, 6.0, 7.0)
    observed = Observations.of(SCATTER[:12], np.full(12, EXACT), event, qualities=np.exp(magnitude)[:, None])
    assert np.isnan(sufficiency(observed, 0)[1])


@pytest.mark.slow
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


def by_hand(kind, **known):
    """Capacities of three records and two lanes, in two measures, for two limit states."""
    facts = {name: np.full(3, np.nan) for name in ("magnitude", "epicentral_distance", "vs30")}
    facts["magnitude"] = np.array([6.0, np.nan, 7.0])
    facts["vs30"] = np.array([300.0, 0.0, 500.0])
    measures = np.array([[[2.0, 3.0], [20.0, 30.0]], [[4.0, 5.0], [40.0, 50.0]], [[6.0, 7.0], [60.0, 70.0]]])
    qualities = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, np.nan]])
    return Ensemble(
        **{
            "ids": ["a", "b", "c"],
            "clusters": ["x", "y", "x"],
            "measures": measures,
            "qualities": qualities,
            "facts": facts,
            "reached": None,
            "weight": None,
            "config": Config(
                fragility=ida(
                    data=kind, factors=(0.5, 8.0), limit_states=(0.4, "overturning"), measures=("pga", "velocity_ratio")
                ),
                search=SearchSettings(factor_max=30.0),
            ),
        }
        | known
    )


def rows_of(found):
    kinds = {EXACT: "=", ABOVE: ">", NOT_ABOVE: "<"}
    return {
        (found.events[cluster], record, round(level, 9)): kinds[kind]
        for level, kind, cluster, record in zip(found.level, found.kind, found.cluster, found.record, strict=True)
    }


def test_rows_of_an_incremental_analysis_end_with_the_search():
    """Below the least factor a capacity is not above it, and what is not reached is above the largest."""
    factors = np.array([[[0.5, 9.0], [2.0, 3.0]], [[0.4, 1.0], [5.0, 6.0]], [[np.inf, 7.0], [8.0, np.inf]]])
    ensemble = by_hand("ida", factors=factors)
    found = ensemble.observations(0, 0, [0])
    assert rows_of(found) == {("x", 0, 1.0): "=", ("y", 1, 2.0): "<", ("x", 2, 48.0): ">"}
    assert found.weight.tolist() == [1.0] * 3
    found = ensemble.observations(1, 1, [1, 0])
    assert rows_of(found) == {
        ("x", 0, 40.0): "=",
        ("x", 0, 90.0): "=",
        ("y", 1, 200.0): "=",
        ("y", 1, 300.0): "=",
        ("x", 2, 480.0): "=",
        ("x", 2, 560.0): ">",
    }
    # Qualities, the measure of the record as it is, and what the files state, a magnitude as its exponential.
    first = found.qualities[found.level.tolist().index(40.0)]
    assert first.tolist() == pytest.approx([1.0, 2.0, 3.0, 20.0, np.exp(6.0), np.nan, 300.0], nan_ok=True)
    last = found.qualities[-1]
    assert last.tolist() == pytest.approx([7.0, 8.0, np.nan, 70.0, np.exp(7.0), np.nan, 500.0], nan_ok=True)
    assert ensemble.quality_counts() == ([3, 3, 2, 3, 2, 0, 2], [2, 2, 2, 2, 1, 0, 1])
    assert ensemble.observations(0, 0, []).level.size == 0
    short = replace(ensemble, config=replace(ensemble.config, search=SearchSettings(factor_max=6.0)))
    assert rows_of(short.observations(0, 0, [0]))["x", 2, 36.0] == ">"


def test_rows_of_stripes_are_those_that_were_looked_at():
    factors = np.array([[[1.0, 2.0], [3.0, 4.0]], [[1.5, 2.5], [0.0, 4.5]], [[1.2, 2.2], [np.nan, 4.2]]])
    reached = np.zeros((3, 2, 2, 2), dtype=int)
    reached[0, 0, 1, 0], reached[1, 0, 0, 0], reached[0, 1, 0, 1], reached[2, 0, 0, 0] = 1, -1, 1, 1
    weight = np.array([[1.0, 3.0], [1.0, 1.0], [2.0, 0.0]])
    ensemble = by_hand("stripes", factors=factors, reached=reached, weight=weight)
    found = ensemble.observations(0, 0, [0])
    # Records are numbered as they have rows; an event of none is none.
    assert found.events == ("x",)
    assert rows_of(found) == {("x", 0, 2.0): ">", ("x", 0, 6.0): "<", ("x", 1, 7.2): "<"}
    assert found.weight.tolist() == [0.5, 1.5, 1.0]
    assert rows_of(ensemble.observations(1, 1, [1])) == {
        ("x", 0, 60.0): "<",
        ("x", 0, 120.0): ">",
        ("y", 1, 125.0): ">",
        ("y", 1, 225.0): ">",
        ("x", 2, 154.0): ">",
        ("x", 2, 294.0): ">",
    }
