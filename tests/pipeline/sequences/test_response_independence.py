"""How many independent observations a family stands for."""

import numpy as np
import pytest

from rockpulse.models import Block, Outcome
from rockpulse.sequences.response_posterior import independent_share
from rockpulse.sequences.response_targets import ResponseTargets, block_family

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
    certain = share(0.5 * np.log(FAMILY.alpha_c / 0.16))
    assert certain[1] > 0.9
    assert certain[0] == pytest.approx(0.1 / 1.9)  # no correlation above 0.9 is believed
    assert share(np.zeros(100)) == (1.0, 0.0)


def directly(blocks, residuals):
    """The share and the correlation by looking at every pair of blocks."""
    place = np.column_stack([np.log(blocks.p), np.log(blocks.alpha_c), blocks.restitution])
    deviation = np.sqrt(np.mean((place - place.mean(axis=0)) ** 2, axis=0))
    place = place / np.where(deviation > 0.0, deviation, 1.0)
    distance = np.sum((place[:, np.newaxis] - place) ** 2, axis=2)
    np.fill_diagonal(distance, np.inf)
    near = np.argmin(distance, axis=1)
    found = np.sum(residuals * residuals[near]) / np.sqrt(np.sum(residuals**2) * np.sum(residuals[near] ** 2))
    mutual = np.sum(near[near] == np.arange(near.size))
    # Under independence the sum of n products, of which some stand twice, has the variance n + their number.
    if found < 1.645 * np.sqrt(near.size + mutual) / near.size:
        return 1.0, found
    return (1.0 - min(found, 0.9)) / (1.0 + min(found, 0.9)), found


@pytest.mark.parametrize("same", [(), ("restitution",), ("p", "alpha")])
def test_the_correlation_is_that_with_the_nearest_of_the_blocks_that_are_numbers(same):
    shares = set()
    for seed in range(40):
        rng = np.random.default_rng(seed)
        known = {"p": rng.uniform(1.0, 5.0, 60), "alpha": rng.uniform(0.08, 0.32, 60)}
        known["restitution"] = rng.uniform(0.4, 0.9, 60)
        known |= {name: np.full(60, known[name][0]) for name in same}
        blocks = Block.from_parameters(**known)
        residuals = rng.normal(0.03, 0.1, 60) + (0.003 * seed) * np.sin(3.0 * np.log(known["p"]) + 5.0 * known["alpha"])
        peaks, outcomes = 0.3 * np.exp(residuals), np.full(60, Outcome.ROCKS)
        silent = rng.random(60) < 0.2
        outcomes[silent] = Outcome.AT_REST
        spoken = np.flatnonzero(~silent)
        found = independent_share(ResponseTargets(blocks, peaks, outcomes), np.full(60, 0.3))
        expected = directly(
            Block.from_parameters(**{name: values[spoken] for name, values in known.items()}), residuals[spoken]
        )
        assert found == pytest.approx(expected, rel=1e-9)
        shares.add(found[0])
    assert 1.0 in shares
    assert same or len(shares) > 5


def test_of_two_blocks_in_one_place_each_is_the_others_neighbour():
    blocks = Block.from_parameters(np.repeat(np.linspace(1.0, 3.0, 6), 2), 0.2, 0.9)
    residuals = np.repeat([0.1, -0.2, 0.3, -0.1, 0.2, -0.3], 2) + np.tile([0.01, -0.01], 6)
    targets = ResponseTargets(blocks, 0.3 * np.exp(residuals), np.full(12, Outcome.ROCKS))
    products = 2.0 * np.sum(residuals[::2] * residuals[1::2]) / np.sum(residuals**2)
    assert independent_share(targets, np.full(12, 0.3))[1] == pytest.approx(products, rel=1e-9)
