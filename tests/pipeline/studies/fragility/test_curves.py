"""One fragility curve: closed forms, and statements where there is no number."""

import math
import re

import numpy as np
import pytest
from scipy.stats import norm, t

from rockpulse.errors import ConfigError
from rockpulse.storage.variables.fragility import Band, Extrapolated, Status
from rockpulse.studies.fragility import curves
from rockpulse.studies.fragility.curves import fit_capacities, fit_stripes
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, Observations

EVENTS = np.repeat([f"event {k}" for k in range(6)], 3)
CAPACITIES = np.exp(np.random.default_rng(5).normal(0.3, 0.5, EVENTS.size))


def numbers(curve):
    return [curve.median, curve.beta, curve.median_low, curve.median_high, curve.beta_low, curve.beta_high]


@pytest.mark.parametrize("confidence", [0.9, 0.5])
def test_the_bands_are_the_jackknife_over_events_of_the_logarithms(confidence):
    """Of known capacities mean and deviation of the logarithms are the estimates, and z is (x - mean)/deviation."""
    x, levels = np.log(CAPACITIES), np.log([0.7, 1.5, 3.0])

    def estimates(own):
        mean, deviation = np.mean(x[own]), np.std(x[own])
        return np.concatenate([[mean, np.log(deviation)], (levels - mean) / deviation])

    every = [estimates(EVENTS == EVENTS), *(estimates(name != EVENTS) for name in np.unique(EVENTS))]
    whole, half = every[0], np.sqrt(5.0 / 6.0 * np.sum((np.array(every[1:]) - every[0]) ** 2, axis=0))
    half *= t(5).ppf(0.5 + 0.5 * confidence)
    curve = fit_capacities(CAPACITIES, EVENTS, confidence=confidence)
    assert (curve.median, curve.beta) == pytest.approx((np.exp(whole[0]), np.exp(whole[1])), rel=1e-10)
    assert (curve.status, curve.band, curve.statement) == (Status.FITTED, Band.GIVEN, "")
    low, high = np.exp(whole - half), np.exp(whole + half)
    assert (curve.median_low, curve.median_high) == pytest.approx((low[0], high[0]), rel=1e-7)
    assert (curve.beta_low, curve.beta_high) == pytest.approx((low[1], high[1]), rel=1e-7)
    for found, z in zip(
        curve.probability(np.exp(levels)), (whole[2:], (whole - half)[2:], (whole + half)[2:]), strict=True
    ):
        np.testing.assert_allclose(found, norm.cdf(z), rtol=1e-7)
    assert curve.log_beta == pytest.approx([one[1] for one in every], abs=1e-8)
    assert curve.confidence == confidence
    assert (curve.records, curve.events, curve.observations, curve.reached) == (18, 6, 18, 18)


def test_symmetric_stripes_have_the_median_in_the_middle_and_the_slope_of_their_quantiles():
    measure = np.repeat([0.5, 1.0, 2.0], 100)
    exceeded = np.concatenate([np.arange(100) < share for share in (16, 50, 84)])
    curve = fit_stripes(measure, exceeded)
    assert curve.median == pytest.approx(1.0, rel=1e-9)
    assert curve.beta == pytest.approx(math.log(2.0) / 0.9944579, rel=1e-6)  # the 84 % quantile of the normal
    assert curve.probability([0.5, 1.0, 2.0])[0] == pytest.approx([0.16, 0.5, 0.84])


def test_a_logistic_curve_states_the_deviation_of_its_logarithms():
    measure = np.repeat([0.5, 1.0, 2.0], 100)
    exceeded = np.concatenate([np.arange(100) < share for share in (20, 50, 80)])
    curve = fit_stripes(measure, exceeded, model="logistic")
    slope = math.log(4.0) / math.log(2.0)  # odds of 4 at twice the median
    assert curve.beta == pytest.approx(math.pi / math.sqrt(3.0) / slope, rel=1e-9)


def test_censoring_far_above_the_capacities_changes_nothing_and_within_them_little():
    full = fit_capacities(CAPACITIES, EVENTS)
    far = fit_capacities(CAPACITIES, EVENTS, limits=np.full(CAPACITIES.size, 1e6))
    assert numbers(far) == numbers(full)
    limit = np.quantile(CAPACITIES, 0.7)
    beyond = np.greater(CAPACITIES, limit)
    cut = fit_capacities(np.where(beyond, np.inf, CAPACITIES), EVENTS, np.full(CAPACITIES.size, limit))
    assert cut.reached == cut.observations - np.count_nonzero(beyond) < cut.observations
    assert (cut.records, cut.events) == (18, 6)
    assert cut.median == pytest.approx(full.median, rel=0.1)
    assert cut.beta == pytest.approx(full.beta, rel=0.3)


def test_the_unit_of_the_measure_scales_the_median_alone():
    one, other = fit_capacities(CAPACITIES, EVENTS), fit_capacities(9.81 * CAPACITIES, EVENTS)
    factors = [9.81, 1.0, 9.81, 9.81, 1.0, 1.0]
    np.testing.assert_allclose(numbers(other), np.multiply(numbers(one), factors), rtol=1e-9)


@pytest.mark.parametrize("model", ["lognormal", "logistic"])
def test_the_order_of_the_rows_does_not_matter_to_the_last_digit(model):
    order = np.random.default_rng(0).permutation(CAPACITIES.size)
    here, there = (fit_capacities(CAPACITIES[o], EVENTS[o], model=model) for o in (slice(None), order))
    assert numbers(here) == numbers(there)


def test_correlated_records_of_few_events_widen_the_band():
    shared = np.repeat(np.exp([-0.6, -0.2, 0.1, 0.2, 0.5]), 8)
    own = np.exp(np.random.default_rng(1).normal(0.0, 0.05, shared.size))
    known, unknown = fit_capacities(shared * own, np.repeat(list("abcde"), 8)), fit_capacities(shared * own)
    assert known.median == unknown.median
    assert math.log(known.median_high / known.median) > 3.0 * math.log(unknown.median_high / unknown.median)


@pytest.mark.parametrize(
    ("curve", "status", "words"),
    [
        (lambda: fit_capacities([]), Status.NO_RECORD, "no record"),
        (lambda: fit_capacities([1.3]), Status.ONE_RECORD, "only one record (limit state reached at 1.3)"),
        (
            lambda: fit_capacities([np.inf], limits=[3.0]),
            Status.ONE_RECORD,
            "only one record (limit state not reached at 3)",
        ),
        (
            lambda: fit_capacities(np.full(4, np.inf), limits=[1.0, 2.0, 3.0, 2.5]),
            Status.NOTHING_REACHED,
            "none of 4 records reached the limit state, although their highest levels are 1 to 3",
        ),
        (
            lambda: fit_capacities([1.2, np.inf, np.inf], limits=[5.0, 5.0, 5.0]),
            Status.ONE_REACHED,
            "only one of 3 records reached the limit state (at 1.2)",
        ),
        (
            lambda: fit_stripes([1, 2, 4] * 4, [0, 1, 1, *[0] * 9], records=np.repeat(list("abcd"), 3)),
            Status.ONE_REACHED,
            "only one of 4 records reached the limit state (at 2 to 4); at least two are needed",
        ),
        (
            lambda: fit_stripes([1.0, 2.0, 1.0, 2.0], [1, 1, 1, 1]),
            Status.EVERYTHING_REACHED,
            "the limit state was reached by each of 4 records at every level, from 1; add lower levels",
        ),
        (
            lambda: fit_stripes([1.0, 1.5, 2.0, 3.0], [0, 0, 1, 1]),
            Status.SEPARATED,
            "no motion up to 1.5 and every motion from 2 reached",
        ),
        (
            lambda: fit_stripes([1.0, 2.0, 2.0, 3.0], [0, 0, 1, 1]),
            Status.SEPARATED,
            "no motion below 2 and every motion above it reached",
        ),
        (lambda: fit_stripes([1.0, 1.5, 2.0, 3.0], [1, 1, 0, 0]), Status.SEPARATED, "are no stronger than the others"),
        (lambda: fit_stripes([1.0, 1.0, 1.0], [1, 0, 1]), Status.SEPARATED, "all motions have the same level, 1"),
        (lambda: fit_stripes([1, 2, 3, 4], [1, 0, 1, 0]), Status.NOT_INCREASING, "not reached more often"),
    ],
)
def test_what_makes_no_curve_is_said_and_no_number_is_given(curve, status, words):
    found = curve()
    assert found.status == status
    assert words in found.statement
    assert found.band == Band.NO_CURVE
    assert np.all(np.isnan(numbers(found)))
    assert np.all(np.isnan(found.probability([0.5, 1.0, 2.0])))


@pytest.mark.parametrize(
    ("curve", "side", "words"),
    [
        (
            lambda: fit_capacities([0.9, 2.9, *[np.inf] * 20], limits=[3.0] * 22),
            Extrapolated.ABOVE,
            r"extrapolated: the median, [\d.]+, lies above all levels that were analysed, up to 3; 2 records of 22",
        ),
        (
            lambda: fit_stripes(np.repeat([1.0, 2.0, 3.0], 8), [k % 8 < 5 + k // 8 for k in range(24)]),
            Extrapolated.BELOW,
            r"extrapolated: the median, 0\.[\d]+, lies below all levels that were analysed, from 1; 18 records of 24",
        ),
        (lambda: fit_capacities(CAPACITIES, EVENTS), Extrapolated.NO, "^$"),
        (lambda: fit_capacities([np.inf] * 3, limits=[1.0] * 3), Extrapolated.NO, "none of 3 records"),
    ],
)
def test_a_median_that_no_record_was_looked_at_is_extrapolated(curve, side, words):
    found = curve()
    assert found.extrapolated == side
    assert re.search(words, found.statement)
    assert (found.median > 3.0) == (side == Extrapolated.ABOVE)


def test_equal_capacities_are_a_step_without_a_band():
    curve = fit_capacities([2.0, 2.0 * (1.0 + 1e-15), np.inf], limits=[9.0, 9.0, 1.0])
    assert curve.status == Status.STEP
    assert (curve.median, curve.beta) == (pytest.approx(2.0), 0.0)
    assert curve.statement == "the curve is a step at 2: all known capacities are equal; there is no dispersion"
    assert curve.probability([1.9, 2.1])[0].tolist() == [0.0, 1.0]
    assert curve.probability([curve.median])[0].tolist() == [1.0]  # reached at the very level
    assert np.isnan(curve.probability([1.9, 2.1])[1:]).all()
    assert (curve.extrapolated, curve.reached) == (Extrapolated.NO, 2)
    assert math.isnan(curve.median_low)


@pytest.mark.parametrize(("events", "band"), [(1, Band.ONE_EVENT), (2, Band.FEW_EVENTS), (3, Band.GIVEN)])
def test_a_band_needs_three_events(events, band):
    curve = fit_capacities(CAPACITIES, np.arange(CAPACITIES.size) % events)
    assert curve.status == Status.FITTED
    assert curve.band == band
    assert math.isnan(curve.median_low) == (band != Band.GIVEN)
    assert ("no band" in curve.statement) == (band != Band.GIVEN)


def test_a_curve_that_rests_on_one_event_has_no_band():
    measure, exceeded = [1.0, 1.5, 2.0, 3.0, 1.1, 2.8, 2.5, 1.2], [0, 0, 1, 1, 0, 1, 0, 1]
    curve = fit_stripes(measure, exceeded, clusters=["a", "b", "c", "a", "b", "c", "odd", "odd"])
    assert curve.status == Status.FITTED
    assert curve.band == Band.RESTS_ON_ONE_EVENT
    assert curve.statement == "no band: without the earthquake odd there would be no curve"
    assert curve.reached == 4
    assert curve.probability([1.0, 3.0])[0] == pytest.approx(
        norm.cdf(np.log(np.array([1.0, 3.0]) / curve.median) / curve.beta)
    )
    assert np.isnan(curve.probability([1.0, 3.0])[1:]).all()


def test_a_likelihood_of_which_no_maximum_is_found_makes_no_curve(monkeypatch):
    monkeypatch.setattr(curves, "maximise", lambda family, design, kind, weights: np.full((len(weights), 2), np.nan))
    curve = fit_capacities(CAPACITIES, EVENTS)
    assert (curve.status, curve.band) == (Status.NO_MAXIMUM, Band.NO_CURVE)
    assert curve.statement == "no curve: no maximum of the likelihood was found"


def test_a_median_at_the_last_level_is_no_extrapolation():
    rows = Observations.of([2.0, 1.0, 3.0], [EXACT, ABOVE, ABOVE])
    sides = [curves.extrapolated(median, rows)[0] for median in (0.999, 1.0, 2.0, 3.0, 3.001)]
    assert sides == [Extrapolated.BELOW, *[Extrapolated.NO] * 3, Extrapolated.ABOVE]


@pytest.mark.parametrize(("slopes", "event"), [([-1.0, 0.5, 0.0, np.nan], "b"), ([1.0, 0.5, 0.2, -0.1], "c")])
def test_the_first_of_the_events_without_which_there_is_no_curve_is_named(slopes, event):
    rows = Observations.of([1.0, 2.0, 3.0], [EXACT, EXACT, EXACT], ["a", "b", "c"])
    band, (said,) = curves.band_of(rows, np.array(slopes))
    assert band == Band.RESTS_ON_ONE_EVENT
    assert said == f"no band: without the earthquake {event} there would be no curve"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_capacities([1.0, -2.0]), "positive, finite levels"),
        (lambda: fit_capacities([1.0, np.inf]), "require limits"),
        (lambda: fit_capacities([1.0, 2.0], ["a"]), "one level, kind, event and record per row"),
        (lambda: fit_capacities([1.0, 2.0], model="normal"), "expected one of lognormal, logistic"),
        (lambda: fit_capacities([1.0, 2.0], confidence=1.0), "between 0 and 1"),
        (lambda: fit_stripes([1.0, 2.0], [1]), "got 2, 1, 2 and 2"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ConfigError, match=message):
        call()
