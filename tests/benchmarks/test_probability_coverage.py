"""The truth of the coverage study: by lanes at places of their own it is what the whole definition tells."""

import math

import numpy as np
import pytest

from rocking import Block, critical_scale


@pytest.fixture(scope="module")
def case(probability_coverage):
    """A slender block under half a sine: it overturns above one factor, whatever its restitution."""
    pulse = np.append(np.sin(np.linspace(0.0, np.pi, 51)), np.zeros(50))
    return probability_coverage.Case("none", "pulse", Block(0.4, 3.2, log=False), pulse, 0.01)


def test_the_truth_of_one_edge_is_the_distribution_of_the_shift(probability_coverage, case):
    """tan(alpha exp(-g N)) is not tan(alpha) exp(-g N), and overturning takes the angle beside uplift: 2 %."""
    edge = float(critical_scale(case.block, case.acceleration, case.dt, factor_max=100.0).lower[0])
    rng = np.random.default_rng(1)
    found = probability_coverage.estimate(case, math.log(edge) - 1.0, math.log(edge) + 1.0, 8000, rng)
    exact = 1.0 - probability_coverage.KNOWN.below(math.log(edge) - found.log_level)
    assert np.max(np.abs(found.probability - exact)) < 0.05
    assert np.all(np.isfinite(list(found.factors.values())))


@pytest.mark.slow
def test_the_truth_is_that_of_the_whole_definition(probability_coverage, case, monkeypatch):
    """P of 1024 draws of factor, C and alpha at each level: four standard errors of both at most."""
    monkeypatch.setattr(probability_coverage, "FACTOR_MAX", 100.0)
    monkeypatch.setattr(probability_coverage, "DRAWS", 1024)
    found = probability_coverage.truth(case, 0)
    whole = probability_coverage.whole_definition(case, found.factors["factor_50"], 0)
    here = np.interp(whole.log_level, found.log_level, found.probability)
    assert np.max(np.abs(here - whole.probability)) < 4.0 * math.hypot(0.5 / math.sqrt(1024), 0.01)
    assert math.log(whole.factors["factor_50"] / found.factors["factor_50"]) == pytest.approx(0.0, abs=0.02)


def test_a_case_beyond_the_largest_factor_has_no_truth(probability_coverage, case):
    """The edge lies at 2.7: at 53 with uplift at 24, and at 13 with uplift at 6."""
    assert probability_coverage.truth(case._replace(acceleration=0.05 * case.acceleration), 0) is None
    assert probability_coverage.truth(case._replace(acceleration=0.2 * case.acceleration), 0) is None
