"""The methods of a site on made-up records, of which the spectrum tells the capacity exactly."""

import numpy as np
import pytest

from laboratory.site.judgement import Site, judge, overturning_factor
from laboratory.site.records import BODIES
from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.storage.variables.probability import RESTITUTIONS


def site(earthquakes=10, records=2):
    """Spectra of one size for all p and C, the same for the records of an earthquake; no sequences."""
    size = np.repeat(np.exp(np.random.default_rng(1).normal(-1.0, 0.5, earthquakes)), records)
    spectra = size[:, np.newaxis, np.newaxis] * np.ones((RATES.size, RESTITUTIONS.size))
    capacity = BODIES.gravity * np.tan(BODIES.alpha_c) / BODIES.p / size[:, np.newaxis]
    none = np.full((size.size, 5), np.nan), np.full(capacity.shape, np.nan)
    return Site(np.repeat(np.arange(earthquakes), records), capacity, spectra, 2.0 * spectra, *none)


@pytest.mark.slow
def test_an_exact_spectrum_has_the_share_of_its_order_statistic_and_a_doubled_one_less():
    table = judge(site(), draws=1, resamples=4).set_index(["left_out", "method", "quantile"]).sort_index()
    exact, doubled = (table.loc["one", f"spectrum, {name}"] for name in ("rule", "nonlinear"))
    np.testing.assert_allclose(exact["share"], exact["expected"])
    np.testing.assert_allclose(exact["expected"], [0.5, 0.2, 0.1])
    np.testing.assert_allclose(doubled["factor"], 0.5 * exact["factor"])
    assert doubled["share"].sum() < 0.5 * exact["share"].sum()
    assert (exact["low"] < exact["share"]).all()
    assert table.loc["one", "response"]["share"].isna().all()


def test_a_sequence_of_one_impulse_overturns_at_its_critical_impulse():
    one = ImpulseSequence(0.5, 0.0, 1.0, np.inf, main_count=1)
    assert overturning_factor(one) == pytest.approx(np.asarray(BODIES.critical_impulse) / 0.5, rel=0.012)
