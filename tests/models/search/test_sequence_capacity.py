"""Critical scales of the sequences: the closed form against the model and the search, the search against the model."""

from dataclasses import replace

import numpy as np
import pytest

from rocking import (
    Block,
    ImpulseSequence,
    Outcome,
    resonance,
    resonance_critical_scale,
    sequence_critical_scale,
    sequence_response,
)
from rocking.impulses.sequence import scaled_outcomes
from rocking.search.factors import exceedance_intervals

BLOCKS = Block(half_width=[0.25, 0.5, 0.8], half_height=[2.0, 2.0, 3.0], restitution=0.9, gravity=9.81)
UNIT = Block.from_parameters(p=1.0, alpha=0.1, restitution=0.6, gravity=9.81)


def outcome(block, sequence, factor):
    return sequence_response(block, sequence.scaled(factor), table_rows=0, threads=1).outcome


def random_case(rng, count=6):
    block = Block.from_parameters(
        p=rng.uniform(0.7, 6.0, count), alpha=rng.uniform(0.05, 0.3, count), restitution=rng.uniform(0.3, 1.0, count)
    )
    main = rng.uniform(0.05, 0.5)
    sigma = rng.choice([0.0, rng.uniform(0.0, 1.0), 1.0])
    most = rng.choice([None, 2, 5, 30])
    sequence = ImpulseSequence(main, sigma * main, 0.1, rng.uniform(0.3, 8.0), most, spacing="continuous")
    return block, sequence


@pytest.mark.parametrize("seed", range(2))
def test_closed_form_overturns_at_its_edges_and_not_beside_them(seed):
    block, sequence = random_case(np.random.default_rng(seed))
    found = sequence_critical_scale(block, sequence)
    assert np.array_equal(found.safe_up_to, np.minimum(found.safety_factor, 10.0))
    assert found.lane.size > 0
    for lane, low, high, opened in zip(found.lane, found.lower, found.upper, found.open, strict=True):
        one = block.lane(lane)
        inside = [low * (1 + 1e-9), high * (1 - 1e-9)]
        outside = [low * (1 - 1e-7)] if opened else [low * (1 - 1e-7), high * (1 + 1e-7)]
        assert all(outcome(one, sequence, factor) == Outcome.OVERTURNS for factor in inside)
        assert all(outcome(one, sequence, factor) != Outcome.OVERTURNS for factor in outside)


@pytest.mark.parametrize("seed", range(8, 10))
def test_closed_form_and_search_agree(seed):
    block, sequence = random_case(np.random.default_rng(seed))
    found = sequence_critical_scale(block, sequence)
    start = np.minimum(0.5 * found.safety_factor, 5.0)
    searched = exceedance_intervals(
        lambda lanes, factors: scaled_outcomes(block, sequence, lanes, factors) == Outcome.OVERTURNS, start, 10.0, 3000
    )
    assert np.array_equal(np.isfinite(found.safety_factor), np.isfinite(searched.safety_factor))
    finite = np.isfinite(found.safety_factor)
    late = searched.safety_factor[finite] / found.safety_factor[finite]
    step = searched.step[finite]
    assert np.all((late > 1.0 - 1e-9) & (late < step**8))  # it may miss bands narrower than its step
    same = finite & (found.count == searched.count)
    assert same.any()
    mine, theirs = np.isin(found.lane, np.flatnonzero(same)), np.isin(searched.lane, np.flatnonzero(same))
    assert searched.lower[theirs] == pytest.approx(found.lower[mine], rel=2e-6)
    assert searched.upper[theirs] == pytest.approx(found.upper[mine], rel=2e-6)


@pytest.mark.parametrize(("sigma", "half_cycle"), [(0.3, 2), (0.5, 3), (0.7, 6), (1.0, 1)])
def test_critical_main_impulse_of_the_continuous_limit(sigma, half_cycle):
    # v_i = u_1 [(1 - sigma) S_i + sigma/2] (F4): by hand for C = 0.6; sigma = 1 overturns at once or never.
    u, speeds = 1.0, []
    for _ in range(half_cycle):
        speeds.append(u - sigma / 2.0)
        u = 0.6 * (u - sigma) + 1.0
    main = 0.1 * UNIT.critical_impulse
    sequence = ImpulseSequence(main, sigma * main, np.nan, np.inf, half_cycle, spacing="continuous")
    assert sequence_critical_scale(UNIT, sequence, 100.0).safety_factor == pytest.approx(
        [10.0 / max(speeds)], rel=1e-14
    )


@pytest.mark.parametrize("sigma", [0.5, 0.6, 0.7])
def test_what_stabilises_has_an_infimum_above_one(sigma):  # V9, V10: v* <= 1
    main = UNIT.critical_impulse / 1.6
    sequence = ImpulseSequence(main, sigma * main, np.nan, np.inf, spacing="continuous")
    steady = (1.0 - 0.6 * sigma) / 0.4 / 1.6 - sigma / 3.2
    found = sequence_critical_scale(UNIT, sequence)
    assert found.safety_factor == pytest.approx([1.0 / steady], rel=1e-14)
    assert found.open.all()
    assert found.count[0] == 1


def test_a_short_input_leaves_safe_windows_between_the_half_cycles():
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9)
    main = 0.2 * block.critical_impulse
    sequence = ImpulseSequence(main, 0.0, np.nan, 0.9, spacing="continuous")
    found = resonance_critical_scale(block, sequence)
    assert found.count[0] >= 2
    assert np.all(found.upper[:-1] < found.lower[1:])
    assert found.open[-1]
    assert found.lower[-1] == pytest.approx(5.0)  # at once
    for low, high in zip(found.upper[:-1], found.lower[1:], strict=True):
        middle = 0.5 * (low + high)
        assert resonance(block, main * middle, 1000, duration=0.9).outcome == Outcome.ROCKS


@pytest.mark.parametrize("spacing", ["end", "middle", "start", "open"])
def test_searched_factor_is_an_edge_and_no_smaller_than_that_of_resonance(spacing):
    sequence = ImpulseSequence(main=0.2, secondary=0.1, interval=0.3, duration=15.0, main_count=5, spacing=spacing)
    found = sequence_critical_scale(BLOCKS, sequence, step=1.02)
    assert np.all(found.step <= 1.02)
    assert np.all(found.safety_factor >= resonance_critical_scale(BLOCKS, sequence).safety_factor)
    for lane in range(3):
        assert outcome(BLOCKS.lane(lane), sequence, found.safety_factor[lane]) == Outcome.OVERTURNS
        assert outcome(BLOCKS.lane(lane), sequence, found.safe_up_to[lane]) == Outcome.ROCKS
    for lane, low, high in zip(found.lane, found.lower, found.upper, strict=True):
        assert outcome(BLOCKS.lane(lane), sequence, low) == outcome(BLOCKS.lane(lane), sequence, high) == 2


@pytest.mark.parametrize("spacing", ["end", "continuous"])
def test_no_impulse_never_overturns(spacing):
    sequence = ImpulseSequence(main=0.0, secondary=0.0, interval=0.3, duration=15.0, spacing=spacing)
    found = sequence_critical_scale(BLOCKS, sequence)
    assert np.all(found.safety_factor == np.inf)
    assert np.all(found.safe_up_to == 10.0)
    assert found.lane.size == 0


@pytest.mark.parametrize("threads", [1, 2])
def test_factors_of_many_blocks_are_those_of_each_alone(threads):
    rng = np.random.default_rng(6)
    many = Block(
        half_width=rng.uniform(0.2, 0.8, 30),
        half_height=rng.uniform(1.5, 4.0, 30),
        restitution=rng.uniform(0.5, 0.85, 30),
    )
    sequence = ImpulseSequence(main=0.2, secondary=0.08, interval=0.2, duration=15.0, main_count=6)
    found = sequence_critical_scale(many, sequence, 4.0, 1.05, threads=threads)
    assert np.any(np.isinf(found.safety_factor))
    assert np.any(np.isfinite(found.safety_factor))
    for lane in range(0, 30, 7):
        alone = sequence_critical_scale(many.lane(lane), sequence, 4.0, 1.05)
        assert found.safety_factor[lane] == alone.safety_factor[0]
        assert np.array_equal(found.upper[found.lane == lane], alone.upper)


def test_what_the_model_cannot_resolve_is_not_called_safe():
    island = Block.from_parameters(p=1e-5, alpha=0.1, restitution=0.9)
    sequence = ImpulseSequence(
        main=0.2 * island.critical_impulse, secondary=0.1, interval=0.2, duration=15.0, main_count=6
    )
    found = sequence_critical_scale(island, sequence)
    assert not found.resolved.any()
    assert found.safe_up_to[0] == found.lower[0]


@pytest.mark.parametrize(("change", "message"), [({"step": 1.0}, "step"), ({"main": [0.1, 0.2]}, "one")])
def test_what_is_out_of_range_is_refused(change, message):
    sequence = ImpulseSequence(change.pop("main", 0.2), 0.1, 0.3, 15.0)
    with pytest.raises(ValueError, match=message):
        sequence_critical_scale(BLOCKS, sequence, **change)


@pytest.mark.parametrize("interval", [None, np.array([0.3, 0.2, 0.1])])
def test_pairs_have_the_factors_of_each_block_under_its_own_sequence(interval):
    restitution, ratio, count = np.array([0.75, 0.9, 1.0]), np.array([0.0, 0.4, 0.7]), np.array([1, 4, 9])
    blocks = Block.from_parameters(p=np.array([0.6, 2.0, 7.0]), alpha=0.12, restitution=restitution, log=False)
    main = np.array([0.9, 0.3, 0.05])
    limit = ImpulseSequence(main, ratio * main, np.nan, np.inf, main_count=count, spacing="continuous")
    pairs = limit if interval is None else replace(limit, interval=interval, spacing="end")
    found = sequence_critical_scale(blocks, pairs, factor_max=1e3, paired=True).safety_factor
    for place in range(3):
        fields = {name: getattr(pairs, name)[place].item() for name in ("main", "secondary", "interval", "main_count")}
        one = replace(pairs, **fields, duration=np.inf)
        alone = sequence_critical_scale(blocks.lane(place), one, factor_max=1e3).safety_factor[0]
        assert found[place] == pytest.approx(alone, rel=0.0 if interval is None else 1e-6)
    if interval is None:
        np.testing.assert_allclose(found, blocks.critical_impulse / pairs.effective_impulse(restitution), rtol=1e-12)
    for block, wrong in ((blocks.lane(0), pairs), (blocks, replace(pairs, main_count=None))):
        with pytest.raises(ValueError, match=r"^sequence: "):
            sequence_critical_scale(block, wrong, paired=True)


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_the_largest_factor_is_a_positive_number(factor):
    sequence = ImpulseSequence(0.2, 0.1, 0.3, 15.0)
    for search in (sequence_critical_scale, resonance_critical_scale):
        with pytest.raises(ValueError, match="factor_max"):
            search(BLOCKS, sequence, factor)
    with pytest.raises(ValueError, match="step"):
        sequence_critical_scale(BLOCKS, sequence, step=np.inf)


def test_bands_that_touch_are_one_and_end_at_the_largest_factor():
    """Two half-cycles, the second of which starts before the end for every factor below that of the first."""
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9, log=False)
    main = 0.2 * block.critical_impulse
    sequence = ImpulseSequence(main, 0.0, np.nan, np.inf, 2, spacing="continuous")
    found = resonance_critical_scale(block, sequence, 5.0)
    assert found.lower == pytest.approx([5.0 / 1.9])
    assert found.upper.tolist() == [5.0]
    assert found.open.tolist() == [True]
    # The factor at which the band begins counts, and one below it does not.
    edge = float(found.lower[0])
    assert resonance_critical_scale(block, sequence, edge).count.tolist() == [1]
    nothing = resonance_critical_scale(block, sequence, edge * (1.0 - 1e-12))
    assert (nothing.count.tolist(), nothing.safety_factor.tolist()) == ([0], [np.inf])
    assert nothing.safe_up_to.tolist() == [edge * (1.0 - 1e-12)]


def test_closed_forms_of_several_blocks_are_those_of_each_alone():
    """Bands by lane, some lanes without any, with a duration that leaves windows between them."""
    blocks = Block.from_parameters(p=[2.0, 0.5, 3.0, 6.0], alpha=0.1, restitution=[0.9, 0.5, 0.8, 0.95], log=False)
    sequence = ImpulseSequence(0.12, 0.03, np.nan, 1.1, spacing="continuous")
    found = sequence_critical_scale(blocks, sequence, 6.0)
    assert set(found.count.tolist()) >= {0, 2}
    for place in range(4):
        alone, mine = sequence_critical_scale(blocks.lane(place), sequence, 6.0), found.lane == place
        for name in ("lower", "upper", "open"):
            assert getattr(found, name)[mine].tolist() == getattr(alone, name).tolist()
        assert found.safety_factor[place] == alone.safety_factor[0]
        assert found.safe_up_to[place] == alone.safe_up_to[0]
    assert found.step.tolist() == [1.0] * 4
    assert found.resolved.all()
