"""The sampler on a density whose quantiles are known, with a jump in it."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from rockpulse.calibration.response_posterior import Posterior, sample_posterior

LOW, HIGH = np.array([-5.0, 0.0, -5.0, 1.0]), np.array([5.0, 1.0, 5.0, 9.0])


class Known:
    """Independent: normal, triangular from 0 to 1, a normal cut at its median, and 3 or 4 main impulses as 1 to 3."""

    def __init__(self, rng):
        self.space = SimpleNamespace(low=LOW, high=HIGH)
        self.points = LOW + rng.random((6000, 4)) * (HIGH - LOW)
        self.points[:, 3] = rng.integers(1, 10, size=6000)
        self.likelihood = self.density(self.points)

    def density(self, points):
        count = {3.0: np.log(0.25), 4.0: np.log(0.75)}
        found = norm(1.0, 0.3).logpdf(points[:, 0]) + np.log(points[:, 1]) + norm(0.0, 0.5).logpdf(points[:, 2])
        found += [count.get(value, -50.0) for value in points[:, 3]]
        return np.where(points[:, 2] > 0.0, found - 20.0, found)

    def try_points(self, points):
        return self.density(points)


def test_quantiles_of_a_known_density():
    rng = np.random.default_rng(3)
    found = sample_posterior(Known(rng), rng)
    levels = np.array([0.05, 0.5, 0.95])
    assert found.effective > 300.0
    assert found.quantiles(found.points[:, 0], levels) == pytest.approx(norm(1.0, 0.3).ppf(levels), abs=0.08)
    assert found.quantiles(found.points[:, 1], levels) == pytest.approx(np.sqrt(levels), abs=0.06)
    assert found.quantiles(found.points[:, 2], levels) == pytest.approx(norm(0.0, 0.5).ppf(0.5 * levels), abs=0.1)
    assert found.weights[found.points[:, 3] == 4.0].sum() == pytest.approx(0.75, abs=0.07)


def test_weighted_quantiles_by_hand():
    posterior = Posterior(np.zeros((4, 4)), np.array([0.1, 0.2, 0.3, 0.4]))
    values = np.array([40.0, 30.0, 20.0, 10.0])
    assert posterior.quantiles(values, np.array([0.05, 0.5, 0.95])).tolist() == [10.0, 20.0, 40.0]
    assert posterior.effective == pytest.approx(1.0 / 0.3)
