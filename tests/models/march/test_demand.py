"""The demand of a ground motion: the impulse that a block sees."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded_cases import synthetic

from rocking import Block, Outcome, ground_demand, recorded_response
from rocking.march.demand import LOBES, within_measured_range


def demand(ground, dt=0.01, p=(2.0,), alpha=0.1, c=0.9):
    return ground_demand(Block.from_parameters(list(p), alpha, c), ground, dt)


def test_a_rectangular_pulse_has_the_demand_of_validation_f6():
    # F6: the pulse A for t1 overturns the linear block iff A/(g alpha) >= 1/(1 - exp(-p t1)), that is E = g alpha/p.
    block = Block.from_parameters([2.0], 0.1, 0.9)
    for duration, least in ((0.5, 1.5819767), (1.0, 1.1565176)):
        ground = np.full(round(duration / 0.001) + 1, least * block.gravity * np.tan(0.1))
        assert ground_demand(block, ground, 0.001).largest[0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.sweep
@settings(derandomize=True, deadline=None, max_examples=25)
@given(factor=st.floats(0.01, 100.0), seed=st.integers(0, 50))
def test_demand_grows_with_the_record_and_does_not_know_its_sign(factor, seed):
    ground = synthetic(seed, n=400)
    one, other = demand(ground, p=[1.3, 5.0]), demand(-factor * ground, p=[1.3, 5.0])
    for name in ("largest", "build_up", "levels"):
        assert getattr(other, name) == pytest.approx(factor * getattr(one, name), rel=1e-9)
    assert np.array_equal(other.last, one.last)


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


def test_a_quiet_record_asks_nothing():
    found = demand(np.zeros(100), p=[2.0, 3.0])
    assert found.largest.tolist() == found.build_up.tolist() == [0.0, 0.0]
    assert (found.lobes.shape, found.samples) == ((2, LOBES), 100)
    assert np.all(found.last == -1)
    assert np.all(found.levels == 0.0)


def test_a_single_block_counts_as_one_lane():
    one = ground_demand(Block.from_parameters(2.0, 0.1, 0.9), synthetic(2), 0.01)
    assert one.largest.shape == (1,)
    assert one.largest[0] == demand(synthetic(2)).largest[0]


@pytest.mark.parametrize(
    ("ground", "dt", "message"),
    [
        ([0.0, np.nan, 1.0], 0.01, "sample 1 is nan"),
        ([1.0], 0.01, "at least 2"),
        ([[0.0, 1.0], [1.0, 0.0]], 0.01, "at least 2"),
        ([0.0, 1.0], 0.0, "dt: expected"),
        ([0.0, 1.0], np.nan, "dt: expected"),
    ],
)
def test_what_is_no_record_is_refused(ground, dt, message):
    with pytest.raises(ValueError, match=message):
        demand(ground, dt)


def lobes_of(ground, dt, p):
    """Largest abs(E) of each stretch of one sign, with the sample before its begin, by a sum over straight pieces."""
    ends, weighted = [0.0], np.zeros(ground.size)
    for i in range(ground.size - 2, -1, -1):
        inside, weights = np.polynomial.legendre.leggauss(8)
        t = 0.5 * dt * (inside + 1.0)
        piece = 0.5 * dt * np.sum(weights * np.interp(t, [0.0, dt], ground[i : i + 2]) * np.exp(-p * t))
        weighted[i] = piece + np.exp(-p * dt) * weighted[i + 1]
        ends.append(weighted[i])
    stretches = np.split(weighted, np.flatnonzero(weighted[1:] * weighted[:-1] < 0.0) + 1)
    return np.sort([np.max(np.abs(part)) for part in stretches])[::-1]


def test_lobes_are_those_of_their_definition_and_linear_in_the_logarithm_of_p_between_nodes():
    """Nodes are powers of two of a quarter: 1.3 lies between 2^(1/4) and 2^(2/4), 5 between 2^(9/4) and 2^(10/4)."""
    ground, dt = np.random.default_rng(4).normal(size=60), 0.05
    ground *= 1.0 / np.max(np.abs(ground))  # a peak of 1 m/s2
    block = Block.from_parameters([1.3, 5.0, 2.0], [0.1, 0.2, 0.15], [0.86, 0.99, 0.5])
    found = ground_demand(block, ground, dt)
    for lane, step in enumerate((1, 9, 4)):
        share = 4.0 * np.log2(block.p[lane]) - step
        assert 0.0 <= share < 1.0
        at_nodes = [lobes_of(ground, dt, 2.0 ** ((step + more) / 4.0))[:5] for more in (0, 1)]
        over = block.p[lane] / (block.gravity * np.tan(block.alpha_c[lane]))
        expected = over * ((1.0 - share) * at_nodes[0] + share * at_nodes[1])
        assert found.lobes[lane, :5] == pytest.approx(expected, rel=1e-9)
        assert found.largest[lane] == found.lobes[lane, 0]
        kept = (0.9 * block.restitution[lane]) ** np.arange(LOBES)
        assert found.build_up[lane] == pytest.approx(np.sum(kept * found.lobes[lane]), rel=1e-12)
        levels = 8.0 / 2.0 ** (step / 4.0) * 2.0 ** (-np.arange(56) / 4.0) * over
        assert found.levels[lane] == pytest.approx(levels, rel=1e-12)
    assert found.samples == 60
    alone = [ground_demand(block.lane(lane), ground, dt) for lane in range(3)]
    for name in ("largest", "lobes", "build_up", "levels", "last"):
        assert np.array_equal(getattr(found, name), np.concatenate([getattr(one, name) for one in alone]))


def test_what_is_left_is_that_of_the_next_larger_restitution_of_the_list():
    steps = [0.85, 0.875, 0.9, 0.925, 0.95, 0.975, 1.0]
    found = demand(synthetic(9, n=2000), p=[2.0] * 7, c=steps)
    assert all(np.any(one != other) for one, other in pairwise(found.last))
    between = demand(synthetic(9, n=2000), p=[2.0] * 7, c=[0.5, *(one + 1e-9 for one in steps[:-1])])
    assert np.array_equal(between.last, found.last)
    slower = demand(synthetic(9, n=2000), p=[2.0, 2.1, 2.3])  # the slower node weighs what comes later more
    assert np.array_equal(slower.last[0], slower.last[1])
    assert np.array_equal(slower.last[0], slower.last[2])
    assert np.any(slower.last[0] != demand(synthetic(9, n=2000), p=[2.4]).last[0])


@pytest.mark.parametrize("seed", [11, 12, 13, 14])
def test_settled_verdicts_are_those_of_the_whole_motion_on_records_that_no_limit_was_measured_on(seed):
    rng = np.random.default_rng(0)
    alpha = np.tile(rng.uniform(0.05, 0.3, 120), 3)
    housner = np.tile(rng.choice([1.0, 0.95, 0.87], 120), 3) * (1.0 - 1.5 * np.sin(alpha) ** 2)
    blocks = Block.from_parameters(np.tile(np.exp(rng.uniform(0.0, np.log(8.0), 120)), 3), alpha, housner)
    ground, factor = synthetic(seed, n=2500), np.repeat([0.3, 0.6, 1.0], 120)
    assert within_measured_range(blocks, 0.01).all()
    early, whole = (
        recorded_response(blocks, ground, 0.01, block_scale=factor, verdict=one)
        for one in (ground_demand(blocks, ground, 0.01), None)
    )
    assert np.array_equal(early.outcome, whole.outcome)
    assert {Outcome.AT_REST, Outcome.ROCKS, Outcome.OVERTURNS} == set(np.unique(whole.outcome))
    fallen = whole.outcome == Outcome.OVERTURNS
    assert np.all(early.overturning_time[fallen] <= whole.overturning_time[fallen])


def test_the_ends_of_the_measured_range_belong_to_it():
    alpha = np.array([0.04, 0.32])
    housner = 1.0 - 1.5 * np.sin(alpha) ** 2
    ends = Block.from_parameters([0.7, 9.0], alpha, housner * [0.85, 1.0])
    assert within_measured_range(ends, 0.1 / 9.0).all()
    beyond = Block.from_parameters([0.699, 9.01], alpha, housner * [0.85, 1.0])
    assert not within_measured_range(beyond, 0.1 / 9.01).any()
    for p, angle, share, dt in ((3.0, 0.0399, 0.9, 0.01), (3.0, 0.3201, 0.9, 0.01), (3.0, 1.2, 0.9, 0.01),
                                (3.0, 0.1, 0.849, 0.01), (3.0, 0.1, 1.001, 0.01), (3.0, 0.1, 0.9, 0.0334)):  # fmt: skip
        housner_of = abs(1.0 - 1.5 * np.sin(angle) ** 2)
        one = Block.from_parameters([3.0, p], [0.1, angle], [0.9 * (1.0 - 1.5 * np.sin(0.1) ** 2), share * housner_of])
        assert within_measured_range(one, dt).tolist() == [dt < 0.0333, False]


def test_only_free_bodies_alike_on_both_sides_were_measured():
    plain, unlike = Block.from_parameters(3.0, 0.2, 0.9), Block.from_corners(0.2, 0.21, 1.0, 0.6, 0.9)
    wall = Block.from_parameters(3.0, 0.2, "housner", one_sided=True, rebound=0.9)
    assert within_measured_range(Block.stack([plain, unlike, wall]), 0.01).tolist() == [True, False, False]
