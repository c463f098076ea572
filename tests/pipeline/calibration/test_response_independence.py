"""How many independent observations a family stands for."""

import numpy as np
import pytest

from rockpulse.calibration.response_independence import independent_share
from rockpulse.calibration.response_targets import ResponseTargets, block_family
from rockpulse.models import Outcome

FAMILY = block_family()


def share(residuals):
    targets = ResponseTargets(FAMILY, 0.3 * np.exp(residuals), np.full(100, Outcome.ROCKS))
    return independent_share(targets, np.full(100, 0.3))


def test_noise_is_independent_in_nineteen_cases_of_twenty():
    found = [share(0.1 * np.random.default_rng(seed).standard_normal(100))[0] for seed in range(200)]
    assert np.mean(np.array(found) < 1.0) < 0.12


def test_a_trend_over_the_family_leaves_little_information():
    found, correlation = share(0.5 * np.log(FAMILY.p / 2.2) + 0.3 * (FAMILY.restitution - 0.8))
    assert correlation > 0.8
    assert found < 0.12


def test_the_share_is_that_of_a_chain():
    rng = np.random.default_rng(4)
    found, correlation = share(0.2 * (FAMILY.alpha_c - 0.18) / 0.08 + 0.2 * rng.standard_normal(100))
    assert found == pytest.approx((1.0 - correlation) / (1.0 + correlation))
