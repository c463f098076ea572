"""The estimator of a probability from lanes: against integrals in closed form."""

import numpy as np
import pytest
from scipy.special import ndtr

from rocking.body.block import Block
from rocking.spectrum.body_lanes import LaneMarch
from rocking.spectrum.probability import Uncertainty, lane_bells, lane_probability, lane_sums, tail_masses

LEVELS = np.linspace(-0.6, 0.6, 25)
NORMAL = Uncertainty(geometry=0.0)
SKEW = Uncertainty(geometry=0.2)


def estimate(lanes, weight, over, bottom, top, shift):
    bell = lane_bells(lanes, weight, LEVELS, shift)
    return lane_probability(over @ bell, bell.sum(axis=0), *tail_masses(bottom, top, LEVELS, shift))


@pytest.mark.parametrize("kind", [bool, np.int64, float])
def test_sums_over_the_lanes_are_those_of_the_matrix_product(kind):
    rng = np.random.default_rng(5)
    counted, bells = rng.integers(0, 3, (20, 70)).astype(kind), rng.random((70, 33))
    np.testing.assert_allclose(lane_sums(counted, bells), counted.astype(float) @ bells, rtol=1e-14)
    np.testing.assert_allclose(lane_sums(counted[:, ::2], bells[::2]), counted[:, ::2].astype(float) @ bells[::2])
    # One lane after the other, so that any part of the sums has the bits of the whole.
    assert np.array_equal(lane_sums(counted, bells)[3:4, 5:9], lane_sums(counted[3:4], bells[:, 5:9]))


def test_two_sets_of_factors_that_overturn():
    """Overturning from -0.2 to 0 and from 0.1 on: P is the mass of the shift over both."""
    lanes = np.arange(-0.9995, 1.0, 0.001)
    over = ((lanes > -0.2) & (lanes < 0.0)) | (lanes > 0.1)
    found = estimate(lanes, np.full(lanes.size, 0.001), over, -1.0, 1.0, SKEW)
    exact = SKEW.below(-LEVELS) - SKEW.below(-0.2 - LEVELS) + 1.0 - SKEW.below(0.1 - LEVELS)
    assert np.allclose(found, exact, atol=1e-4)


def test_lanes_of_uneven_density_weigh_by_what_they_stand_for():
    place = (np.arange(4000) + 0.5) / 4000
    lanes = np.sign(place - 0.5) * (2.0 * place - 1.0) ** 2  # density 4000/(4 sqrt(abs(ln f)))
    weight = 4.0 * np.sqrt(np.abs(lanes)) / 4000
    found = estimate(lanes, weight, lanes > 0.05, -1.0, 1.0, NORMAL)
    assert np.allclose(found, ndtr((LEVELS - 0.05) / 0.1), atol=2e-3)


def test_outside_the_lanes_the_verdict_is_known():
    """Lanes over 0.1 of ln f, half of which overturn: far below them P is 0, far above it is 1."""
    lanes = np.linspace(-0.05, 0.05, 50)
    found = estimate(lanes, np.full(50, 0.002), np.arange(50) % 2 == 0, -0.05, 0.05, NORMAL)
    above, inside = ndtr((LEVELS - 0.05) / 0.1), ndtr((LEVELS + 0.05) / 0.1) - ndtr((LEVELS - 0.05) / 0.1)
    assert np.allclose(found, above + 0.5 * inside, atol=2e-3)
    assert found[0] < 1e-7
    assert found[-1] > 1.0 - 1e-7


def test_weights_in_another_unit_change_nothing():
    rng = np.random.default_rng(5)
    lanes, over = rng.uniform(-0.8, 0.8, 64), rng.random(64) < 0.5
    one, thousand = (estimate(lanes, np.full(64, unit), over, -0.8, 0.8, SKEW) for unit in (1.0, 1000.0))
    assert np.allclose(one, thousand, atol=1e-12)


def test_no_lane_near_a_level():
    """The middle of two distant groups: no weight there, and no division by it."""
    lanes = np.array([-8.0, 8.0])
    found = estimate(lanes, np.full(2, 1.0), np.array([False, True]), -9.0, 9.0, NORMAL)
    assert np.array_equal(found, np.zeros(LEVELS.size))


def test_the_draws_of_lanes_do_not_go_with_their_factors(monkeypatch):
    """A lane's factor, restitution and loss of angle are three columns of one net: none tells another."""
    drawn = []
    varied = Block.varied
    monkeypatch.setattr(Block, "varied", lambda self, *own: drawn.append(own) or varied(self, *own))
    body = Block(width=np.array([0.5]), height=np.array([3.0]))
    low, high = np.array([0.6]), np.array([0.9])
    march = LaneMarch(body, np.array([0.0, 0.1, 0.0]), 0.01, None, Uncertainty(), low, high, 1, 1)
    march.evenly(np.array([0]), np.array([-1.0]), np.array([1.0]), 256, 0)
    ((loss, restitution),) = drawn
    told = np.corrcoef([march.parts[0].log_factor[0], loss, restitution])
    assert np.abs(told[~np.eye(3, dtype=bool)]).max() < 0.1
