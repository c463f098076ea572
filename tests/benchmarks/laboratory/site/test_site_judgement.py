"""The design of a site on made-up records, of which the spectrum states the capacity exactly."""

import numpy as np
import pytest
from scipy.stats import beta, norm, t

from laboratory.site.judgement import BODIES, Site, judge, share_interval
from rocking.body.limits import RATES
from rockpulse.storage.variables.probability import RESTITUTIONS


def site(earthquakes=24, records=2):
    """Spectra of one size for all p and C, the same for the records of an earthquake."""
    size = np.repeat(np.exp(np.random.default_rng(1).normal(-1.0, 0.5, earthquakes)), records)
    spectra = size[:, np.newaxis, np.newaxis] * np.ones((RATES.size, RESTITUTIONS.size))
    capacity = BODIES.gravity * np.tan(BODIES.alpha_c) / BODIES.p / size[:, np.newaxis]
    return Site(np.repeat(np.arange(earthquakes), records), capacity, spectra, 2.0 * spectra)


@pytest.mark.slow
def test_an_exact_spectrum_has_the_nominal_share_and_a_doubled_one_less():
    table = judge(site(), draws=1, resamples=4).set_index(["left_out", "method", "quantile"]).sort_index()
    exact, doubled = (table.loc["one", name] for name in ("rule", "nonlinear"))
    np.testing.assert_allclose(exact["share"], exact["nominal"], atol=1.0 / 24.0)
    np.testing.assert_allclose(doubled["factor"], 0.5 * exact["factor"])
    assert doubled["share"].sum() < 0.5 * exact["share"].sum()
    assert (exact["low"] < exact["share"]).all()


def test_the_interval_of_a_share_of_independent_trials_is_clopper_and_pearsons():
    hits = np.repeat([1.0, 0.0], [150, 50])
    share, lower, upper = share_interval(hits, np.ones(200), np.arange(200), 0.9)
    trials = 199 * (norm.ppf(0.95) / t.ppf(0.95, 199)) ** 2  # s(1 - s)/var s
    assert share == 0.75
    assert lower == pytest.approx(beta.ppf(0.05, 0.75 * trials, 0.25 * trials + 1.0), rel=1e-9)
    assert upper == pytest.approx(beta.ppf(0.95, 0.75 * trials + 1.0, 0.25 * trials), rel=1e-9)


def test_copies_within_an_event_add_no_confidence_to_a_share():
    hits, events = np.array([1.0, 1.0, 0.0, 1.0, 0.0, 1.0]), np.arange(6)
    plain = share_interval(hits, np.ones(6), events, 0.9)
    copied = share_interval(np.repeat(hits, 50), np.ones(300), np.repeat(events, 50), 0.9)
    np.testing.assert_allclose(copied, plain, rtol=1e-12)


def test_full_coverage_of_few_events_is_no_certainty():
    share, lower, upper = share_interval(np.ones(60), np.ones(60), np.repeat([0, 1, 2], 20), 0.9)
    assert (share, upper) == (1.0, 1.0)
    assert lower < 0.2  # of three trials, not of sixty
    assert np.isnan(share_interval(np.ones(60), np.ones(60), np.zeros(60), 0.9)[1:]).all()
