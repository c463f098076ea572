"""The reference of the benchmark of probabilities: draws of the nonlinear equation, without an isotonic fit of P."""

import math

import numpy as np
import pytest

import rockpulse as rp
from laboratory.ensemble import StrongMotion
from rocking import Block, Uncertainty, critical_scale

BODY = Block(0.4, 3.2, log=False)


@pytest.fixture(scope="module")
def pulse():
    """Half a sine, under which a slender block overturns above one factor, whatever its restitution."""
    samples = np.append(np.sin(np.linspace(0.0, np.pi, 51)), np.zeros(50))
    return StrongMotion(rp.Record(samples, dt=0.01, id="pulse"), "none")


def test_the_reference_of_one_edge_is_the_distribution_of_the_shift(overturning_probability, pulse):
    """tan(alpha exp(-g N)) is not tan(alpha) exp(-g N), and overturning takes the angle beside uplift: 2 %."""
    edge = float(critical_scale(BODY, pulse.record.acceleration, 0.01, factor_max=100.0).lower[0])
    found, plain = overturning_probability.reference(pulse, BODY, math.log(edge), 1)
    shift = np.linspace(-1.0, 1.0, 20001)
    for name, share in (("factor_10", 0.9), ("factor_50", 0.5)):
        exact = edge * math.exp(-np.interp(share, Uncertainty().below(shift), shift))
        assert found[name] == pytest.approx(exact, rel=0.02)
    assert found["factor_mean"] == pytest.approx(edge * math.exp(-0.05 * math.sqrt(2.0 / math.pi)), rel=0.02)
    for at in (-0.1, 0.0, 0.1):
        exact = 1.0 - float(Uncertainty().below(-at))
        assert plain(math.log(edge) + at) == pytest.approx(exact, abs=0.05)


@pytest.mark.slow
def test_the_slender_limit_of_a_body_is_within_five_standard_errors(overturning_probability, ridgecrest):
    motion = StrongMotion(rp.condition(ridgecrest[0]), "Ridgecrest")
    rows = np.array([overturning_probability.pair_errors(motion, {}, pair, False) for pair in range(3)])
    assert np.all(np.abs(rows[:, 0, 0]) < 0.1)
