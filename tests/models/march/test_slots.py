"""Looking ahead in a record, against looking at every sample."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.march.slots import Accelerogram, extremes, largest_left, next_exceedance, next_lift

NONE = np.empty(0)


def looked_over(acceleration, vertical=NONE):
    """The accelerogram with its extremes."""
    return Accelerogram(acceleration, vertical, extremes(acceleration, vertical), 0.01)


def spiky(seed, n):
    """Quiet but for a few spikes, of either sign."""
    rng = np.random.default_rng(seed)
    return np.where(rng.random(n) < 0.02, rng.uniform(-3.0, 3.0, n), rng.uniform(-0.1, 0.1, n))


@pytest.mark.sweep
@given(st.integers(0, 10_000), st.integers(2, 200), st.floats(0.05, 3.5))
@settings(derandomize=True, deadline=None, max_examples=60)
def test_next_exceedance_is_that_of_a_plain_search(seed, n, threshold):
    samples = spiky(seed, n)
    record = looked_over(samples)
    above = np.flatnonzero(np.abs(samples) > threshold)
    for start in (0, 1, n // 3, n - 1):
        later = above[above >= start]
        expected = later[0] if later.size else n
        assert next_exceedance(start, record, 1.0, threshold) == expected
        assert next_lift(start, record, 1.0, 1.0, threshold, 0.0, threshold, 0.0) == expected
        assert largest_left(start, record) == np.max(np.abs(samples[start:]))


@given(st.integers(0, 10_000), st.integers(2, 200), st.floats(0.05, 0.6))
@settings(derandomize=True, deadline=None, max_examples=60)
def test_vertical_acceleration_moves_the_threshold_and_may_lift_the_block_off(seed, n, slope):
    samples, vertical = spiky(seed, n), spiky(seed + 1, n)
    lift = 1.0 + 0.5 * vertical
    above = np.flatnonzero((0.5 * np.abs(samples) > lift * slope) | (lift <= 0.0))
    expected = above[0] if above.size else n
    assert next_exceedance(0, looked_over(samples, vertical), 0.5, slope) == expected


@pytest.mark.parametrize("n", [2, 31, 32, 33, 64, 65])
def test_the_sample_after_a_block_of_samples_is_seen(n):
    samples = np.zeros(n)
    samples[-1] = 2.0
    record = looked_over(samples)
    assert next_exceedance(0, record, 1.0, 1.0) == n - 1
    assert next_exceedance(0, record, 0.5, 1.0) == n  # exactly at the threshold is not above it
    assert largest_left(n - 1, record) == 2.0
    assert largest_left(0, record) == 2.0
