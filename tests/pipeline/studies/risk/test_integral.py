"""Fragility summed over hazard against closed forms and another quadrature."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

import rockpulse as rp
from rockpulse.studies.fragility.likelihood import FAMILIES
from rockpulse.studies.risk.integral import integrate

NORMAL, LOGISTIC = FAMILIES["lognormal"], FAMILIES["logistic"]


def closed_form(k0, k, median, beta):
    """Power law and lognormal fragility: Cornell et al. (2002), doi:10.1061/(ASCE)0733-9445(2002)128:4(526)."""
    return k0 * median**-k * math.exp(0.5 * (k * beta) ** 2)


def line(median, scale):
    return -math.log(median) / scale, 1.0 / scale


def brute(family, a, b, hazard, ends):
    """The frequency between the ends, piece by piece by adaptive quadrature."""

    def part(u):
        return math.exp(family.log_cdf(np.array(a + b * u))[0] + hazard.log_density(np.array(u)))

    pieces = itertools.pairwise(ends)
    return sum(quad(part, low, high, epsabs=0.0, epsrel=1e-11, limit=400)[0] for low, high in pieces)


@pytest.mark.parametrize("k", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("beta", [0.05, 0.4, 0.8, 1.5])
def test_a_power_law_and_a_lognormal_fragility_have_a_closed_form(k, beta):
    found = integrate(NORMAL, line(0.6, beta), rp.PowerLawHazard(1e-4, k))
    assert found.frequency == pytest.approx(closed_form(1e-4, k, 0.6, beta), rel=1e-9)
    assert found.contribution.sum() == pytest.approx(found.frequency, rel=1e-12)


def test_the_closed_form_is_the_published_number():
    assert closed_form(1e-4, 2.5, 0.6, 0.4) == pytest.approx(5.91247e-4, rel=1e-6)


@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.9, 0.999, 1.0 - 1e-6])
def test_a_power_law_and_a_logistic_fragility_have_one_too(share):
    """E[X^-k] of a capacity with a logistic logarithm of scale s: median^-k pi k s/sin(pi k s), for k s < 1."""
    k = 2.5
    scale = share / k
    found = integrate(LOGISTIC, line(0.6, scale), rp.PowerLawHazard(1e-4, k)).frequency
    assert found == pytest.approx(1e-4 * 0.6**-k * math.pi * share / math.sin(math.pi * share), rel=1e-9)


def test_a_tail_heavier_than_the_hazard_has_no_frequency():
    assert np.isinf(integrate(LOGISTIC, line(0.6, 0.5), rp.PowerLawHazard(1e-4, 2.5)).frequency)
    assert np.isfinite(integrate(LOGISTIC, line(0.6, 0.2), rp.PowerLawHazard(1e-4, 2.5)).frequency)
    # A dispersion of 1000 is infinite but in name: nothing of it lies at levels that any ground has.
    assert np.isinf(integrate(NORMAL, line(0.6, 1000.0), rp.PowerLawHazard(1e-4, 2.5)).frequency)


@pytest.mark.parametrize("family", [NORMAL, LOGISTIC])
@pytest.mark.parametrize("scale", [0.03, 0.2, 0.5])
def test_a_tabled_curve_agrees_with_another_quadrature(family, scale):
    curve = rp.HazardCurve("pga", [0.1, 0.5, 1.0, 3.0, 8.0], [0.1, 0.09, 5e-3, 2e-4, 4e-6])
    found = integrate(family, line(1.3, scale), curve).frequency
    ends = np.unique([-30.0, *curve.knots, math.log(1.3), math.log(1.3) - 4 * scale, math.log(1.3) + 4 * scale, 15.0])
    assert found == pytest.approx(brute(family, *line(1.3, scale), curve, ends), rel=1e-8)


def test_the_contributions_add_up_between_levels():
    found = integrate(NORMAL, line(0.6, 0.4), rp.PowerLawHazard(1e-4, 2.5), (math.log(0.3), math.log(0.9)))
    parts = [found.between(-math.inf, math.log(0.3)), found.between(math.log(0.3), math.log(0.9))]
    parts.append(found.between(math.log(0.9), math.inf))
    assert sum(parts) == pytest.approx(1.0)
    # Of the lognormal fragility and the power law the contributions below a level follow from the closed form:
    # integral up to x of F dH' = H-weighted F at x plus the closed form of the truncated moment.
    k, beta, u = 2.5, 0.4, (math.log(0.3) - math.log(0.6)) / 0.4
    whole = math.exp(0.5 * (k * beta) ** 2)
    below = (whole * ndtr(u + k * beta) - math.exp(-k * beta * u) * ndtr(u)) / whole
    assert parts[0] == pytest.approx(below, rel=1e-9)


@pytest.mark.parametrize("family", [NORMAL, LOGISTIC])
@pytest.mark.parametrize("scale", [0.2, 0.7])
def test_below_a_floor_nothing_contributes(family, scale):
    law, floor = rp.PowerLawHazard(1e-4, 2.5), math.log(0.35)
    found = integrate(family, line(0.6, scale), law, floor=floor)
    expected = brute(family, *line(0.6, scale), law, (floor, 0.0, 3.0, 25.0))
    assert found.frequency == pytest.approx(expected, rel=1e-8)
    assert found.log_level.min() >= floor


@pytest.mark.parametrize("family", [NORMAL, LOGISTIC])
def test_a_curve_that_hardly_falls_at_its_end_keeps_its_last_rate(family):
    """Beyond 4 m/s2, where the fragility is 1 to 1e-9, the rate 1e-3 stays in lambda however far the curve goes on."""
    flat = rp.HazardCurve("pga", [0.1, 1.0, 2.0, 4.0], [0.1, 1e-2, 1.0001e-3, 1e-3])
    a, b = line(0.6, 0.2 if family is NORMAL else 0.08)
    found = integrate(family, (a, b), flat, (math.log(4.0),))
    expected = brute(family, a, b, flat, (-8.0, *flat.knots)) + 1e-3
    assert found.frequency == pytest.approx(expected, rel=1e-8)
    assert found.between(math.log(4.0), math.inf) == pytest.approx(1e-3 / found.frequency, rel=1e-6)
    assert found.log_level.max() < 10.0


def test_the_soil_factor_is_that_of_the_levels():
    """By a power law lambda grows with S^k: 1.5^2.5."""
    whole = integrate(NORMAL, line(0.6, 0.4), rp.PowerLawHazard(1e-4, 2.5, soil_factor=1.5)).frequency
    assert whole == pytest.approx(1.5**2.5 * closed_form(1e-4, 2.5, 0.6, 0.4), rel=1e-9)
