"""The demand of a ground motion: the impulse that a block sees."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded_cases import synthetic
from scipy.integrate import quad

from rocking import Block, ground_demand
from rocking.demand import LOBES


def demand(ground, dt=0.01, p=(2.0,), alpha=0.1, c=0.9):
    return ground_demand(Block.from_parameters(list(p), alpha, c), ground, dt)


def test_a_rectangular_pulse_has_the_demand_of_validation_f6():
    # F6: the pulse A for t1 overturns the linear block iff A/(g alpha) >= 1/(1 - exp(-p t1)), that is E = g alpha/p.
    block = Block.from_parameters([2.0], 0.1, 0.9)
    for duration, least in ((0.5, 1.5819767), (1.0, 1.1565176)):
        ground = np.full(round(duration / 0.001) + 1, least * block.gravity * np.tan(0.1))
        assert ground_demand(block, ground, 0.001).largest[0] == pytest.approx(1.0, abs=1e-3)


def test_a_node_between_is_interpolated_closely():
    ground = synthetic(2)
    p = 2.0 ** (1.0 + 0.125)
    t = 0.01 * np.arange(ground.size)
    found = demand(ground, p=[p])
    exact = max(abs(np.trapezoid(ground[k:] * np.exp(-p * (t[k:] - t[k])), t[k:])) for k in range(0, ground.size, 5))
    assert found.largest[0] * Block.from_parameters(p, 0.1, 0.9).gravity * np.tan(0.1) / p == pytest.approx(
        exact, rel=0.04
    )


def test_one_lobe_is_its_integral():
    ground = np.interp(np.arange(0.0, 1.001, 0.01), [0.0, 0.3, 1.0], [0.0, 3.0, 0.0])
    block = Block.from_parameters([4.0], 0.1, 0.9)
    exact = quad(
        lambda t: np.interp(t + 0.06, [0.0, 0.3, 1.0], [0.0, 3.0, 0.0]) * np.exp(-4.0 * t), 0.0, 0.94, limit=200
    )
    found = ground_demand(block, ground, 0.01)
    assert found.largest[0] >= 4.0 * exact[0] / (block.gravity * np.tan(0.1)) - 1e-9
    assert found.build_up[0] == pytest.approx(found.largest[0])


@settings(derandomize=True, deadline=None, max_examples=25)
@given(factor=st.floats(0.01, 100.0), seed=st.integers(0, 50))
def test_demand_grows_with_the_record_and_does_not_know_its_sign(factor, seed):
    ground = synthetic(seed, n=400)
    one, other = demand(ground, p=[1.3, 5.0]), demand(-factor * ground, p=[1.3, 5.0])
    for name in ("largest", "build_up", "levels"):
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=1e-9)
    assert np.array_equal(other.last, one.last)


def test_build_up_is_between_the_largest_lobe_and_all_of_them():
    found = demand(synthetic(7), p=[1.0, 2.0, 7.0])
    assert np.all(found.build_up > found.largest)
    assert np.all(found.build_up < LOBES * found.largest)
    assert np.all(demand(synthetic(7), p=[1.0, 2.0, 7.0], c=0.5).build_up < found.build_up)


@pytest.mark.parametrize("c", [0.85, 0.93, 1.0])
def test_build_up_left_after_the_last_sample_of_a_level_is_not_above_it(c):
    ground, p = synthetic(9, n=2000), 2.0  # a node: no interpolation in p
    found = demand(ground, p=[p], c=c)
    levels, last = found.levels[0], found.last[0]
    assert np.all(np.diff(levels) < 0.0)
    assert np.all(np.diff(last) >= 0)
    seen = 0
    for level, sample in zip(levels, last, strict=True):
        if 0 < sample < ground.size - 50:
            assert demand(ground[sample + 1 :], p=[p], c=c).build_up[0] <= level * (1.0 + 1e-9)
            seen += 1
    assert seen > 5
    assert np.all(last[levels > 1.2 * found.build_up[0]] == -1)


def test_demand_of_some_blocks_is_theirs():
    found = demand(synthetic(7), p=[1.0, 2.0, 7.0])
    some = found.of(np.array([2, 0, 2]))
    assert np.array_equal(some.build_up, found.build_up[[2, 0, 2]])
    assert np.array_equal(some.last, found.last[[2, 0, 2]])
    assert (some.samples, some.settled) == (found.samples, found.settled)


def test_a_quiet_record_asks_nothing():
    found = demand(np.zeros(100))
    assert found.largest[0] == found.build_up[0] == 0.0
    assert np.all(found.last == -1)
    assert np.all(found.levels == 0.0)


def test_a_single_block_counts_as_one_lane():
    one = ground_demand(Block.from_parameters(2.0, 0.1, 0.9), synthetic(2), 0.01)
    assert one.largest.shape == (1,)
    assert one.largest[0] == demand(synthetic(2)).largest[0]


@pytest.mark.parametrize(
    ("ground", "dt", "message"),
    [([0.0, np.nan, 1.0], 0.01, "finite samples"), ([1.0], 0.01, "at least 2"), ([0.0, 1.0], 0.0, "dt: expected")],
)
def test_what_is_no_record_is_refused(ground, dt, message):
    with pytest.raises(ValueError, match=message):
        demand(ground, dt)
