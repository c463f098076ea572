"""The shift of ln f by factor and geometry together: against the convolution of a normal and a half-normal."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from rocking.spectrum.probability import LEAST_SPREAD, Uncertainty

SHIFTS = (-0.35, -0.1, 0.0, 0.04, 0.2, 0.5)
KNOWN = [Uncertainty(), Uncertainty(factor=0.02, geometry=0.3), Uncertainty(factor=0.5, geometry=0.05)]


def over_the_loss(inner, known):
    """Mean over g abs(N) of a function of it, by quadrature."""
    return quad(lambda n: inner(known.geometry * n) * 2.0 * norm.pdf(n), 0.0, 12.0, epsabs=1e-12, limit=400)[0]


@pytest.mark.parametrize("known", KNOWN)
@pytest.mark.parametrize("shift", SHIFTS)
def test_density_is_the_convolution_of_a_normal_and_a_half_normal(known, shift):
    exact = over_the_loss(lambda loss: norm.pdf(shift - loss, scale=known.factor), known)
    assert known.density(shift) == pytest.approx(exact, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("known", KNOWN)
@pytest.mark.parametrize("shift", SHIFTS)
def test_distribution_is_that_of_the_sum(known, shift):
    exact = over_the_loss(lambda loss: norm.cdf(shift - loss, scale=known.factor), known)
    assert known.below(shift) == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("known", KNOWN)
def test_spread_is_the_standard_deviation_of_the_density(known):
    shifts = np.linspace(-8.0, 8.0, 400001) * math.hypot(known.factor, known.geometry)
    mass = known.density(shifts) * (shifts[1] - shifts[0])
    mean = np.sum(mass * shifts)
    assert np.sum(mass) == pytest.approx(1.0, abs=1e-9)
    assert mean == pytest.approx(known.geometry * math.sqrt(2.0 / math.pi), abs=1e-7)
    assert math.sqrt(np.sum(mass * (shifts - mean) ** 2)) == pytest.approx(known.spread, rel=1e-6)


def test_drawn_shifts_follow_the_distribution():
    """Kolmogorov's distance of 20,000 draws is below 1.63/sqrt(n), its 1 % point."""
    rng, known = np.random.default_rng(11), Uncertainty(factor=0.1, geometry=0.2)
    drawn = np.sort(known.factor * rng.normal(size=20000) + known.geometry * np.abs(rng.normal(size=20000)))
    empirical = np.arange(1, drawn.size + 1) / drawn.size
    assert np.max(np.abs(known.below(drawn) - empirical)) < 1.63 / math.sqrt(drawn.size)


def test_without_geometry_the_shift_is_normal():
    known, shifts = Uncertainty(factor=0.2, geometry=0.0), np.linspace(-1.0, 1.0, 41)
    assert np.allclose(known.density(shifts), norm.pdf(shifts, scale=0.2), rtol=1e-12)
    assert np.allclose(known.below(shifts), norm.cdf(shifts, scale=0.2), rtol=1e-12)
    assert known.spread == 0.2


def test_geometry_only_ever_adds_to_the_factor():
    """A loss of angle is a larger factor: the least factor draw leaves little of the distribution below zero."""
    known = Uncertainty(factor=LEAST_SPREAD, geometry=0.5)
    assert known.below(-5.0 * LEAST_SPREAD) < 1e-7
    assert known.below(0.5 * norm.ppf(0.75)) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("factor", 0.0),
        ("factor", 0.019),
        ("factor", 10.0),
        ("factor", math.nan),
        ("factor", "10 %"),
        ("restitution", (0.0, 1.0)),
        ("restitution", (1.0, 0.9)),
        ("restitution", (0.9, 1.1)),
        ("restitution", (0.9, math.nan)),
        ("restitution", (0.9,)),
        ("restitution", 0.9),
        ("geometry", -0.05),
        ("geometry", [0.1, 0.2]),
        ("factor", [0.1, 0.2]),
        ("geometry", 5.0),
        ("geometry", math.inf),
    ],
)
def test_a_value_out_of_range_is_named(name, value):
    with pytest.raises(ValueError, match=name):
        Uncertainty(**{name: value})


def test_a_range_of_one_restitution_is_one():
    assert Uncertainty(restitution=(1.0, 1.0)).restitution == (1.0, 1.0)


@pytest.mark.parametrize(("name", "least", "most"), [("factor", 0.02, 1.0), ("geometry", 0.0, 1.0)])
def test_the_ends_of_a_range_belong_to_it(name, least, most):
    for value in (least, most):
        assert getattr(Uncertainty(**{name: value}), name) == value
    for value in (least - 1e-6, most + 1e-6):
        with pytest.raises(ValueError, match=name):
            Uncertainty(**{name: value})


def test_by_default_a_factor_of_10_percent_a_tenth_of_the_restitution_and_5_percent_of_the_angle():
    known = Uncertainty()
    assert (known.factor, known.restitution, known.geometry) == (0.1, (0.9, 1.0), 0.05)
    assert Uncertainty(restitution=(1e-6, 1e-6)).restitution == (1e-6, 1e-6)


def test_beyond_eight_scales_the_density_is_zero():
    """One scale is the hypotenuse of both spreads, 0.5."""
    known = Uncertainty(factor=0.3, geometry=0.4)
    inside, outside = known.density(np.array([[-3.99, 3.99], [1.0, -1.0]])), known.density([-4.0, 4.0, 9.0])
    assert inside.shape == (2, 2)
    assert inside[0, 1] == pytest.approx(2.0 / 0.5 * norm.pdf(7.98) * norm.cdf(4.0 / 3.0 * 7.98), rel=1e-9, abs=0.0)
    assert outside.tolist() == [0.0, 0.0, 0.0]
