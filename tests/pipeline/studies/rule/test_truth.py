"""The nonlinear capacity under the stated uncertainty, against a closed form and the estimator of the library."""

import math

import numpy as np
import pytest

from rocking import Block, Uncertainty, critical_scale
from rocking.spectrum.body_probability import overturning_probability
from rockpulse.record.synthetic import synthetic_motion
from rockpulse.studies.rule.truth import FACTOR_MAX, nonlinear_capacity

BODIES = Block(half_width=[0.1, 0.2], half_height=[0.8, 1.6])


def test_one_half_sine_has_the_capacity_of_its_safety_factor():
    # Without an impact C has no part: what is left is the factor, and the loss of the angle.
    time = np.arange(0.0, 0.8, 0.005)
    pulse = np.append(3.0 * np.sin(np.pi * time / 0.8), np.zeros(400))
    own = critical_scale(BODIES, pulse, 0.005).safety_factor
    found = nonlinear_capacity(BODIES, pulse, 0.005)
    lost = math.exp(-0.05 * math.sqrt(2.0 / math.pi))
    assert found["capacity_mean"] == pytest.approx(lost * own, rel=0.015)
    shift = np.linspace(-1.0, 1.0, 20001)
    for name, share in (("factor_10", 0.9), ("factor_50", 0.5)):
        at = np.interp(share, Uncertainty().below(shift), shift)
        assert found[name] == pytest.approx(own * math.exp(-at), rel=0.025)


def test_it_is_the_answer_of_the_librarys_own_estimator():
    motion = synthetic_motion(3, duration=12.0, pga=5.0)
    found = nonlinear_capacity(BODIES, motion, 0.01)
    other = overturning_probability(BODIES, motion, 0.01, seed=4)
    for name, apart in (("capacity_mean", 0.1), ("factor_10", 0.2)):
        assert found[name] == pytest.approx(getattr(other, name), rel=apart)


def test_what_is_not_reached_is_known_from_below():
    weak = 0.01 * synthetic_motion(3, duration=12.0, pga=5.0)
    found = nonlinear_capacity(BODIES, weak, 0.01)
    assert np.isinf(found["capacity_mean"]).all()
    assert np.isinf(found["factor_10"]).all()
    assert found["capacity_mean_low"] == pytest.approx(np.full(2, FACTOR_MAX))
    assert np.all(found["probability_one"] < 1e-12)
