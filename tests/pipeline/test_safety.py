"""Safety factors of the sequences."""

import numpy as np
import pytest

from rockpulse.models import Block, ImpulseSequence, Outcome, resonance, sequence_response
from rockpulse.safety import (
    BLOCKS_AT_ONCE,
    EDGE_TOLERANCE,
    REFINEMENT,
    ROUNDS,
    first_overturning_factor,
    first_overturning_factors,
    resonance_safety_factor,
    sequence_safety_factor,
)

BLOCKS = Block(half_width=[0.25, 0.5, 0.8], half_height=[2.0, 2.0, 3.0], restitution=0.9, gravity=9.81)


def test_single_edge_is_found_to_its_tolerance():
    found = first_overturning_factor(lambda factors: factors >= 2.718281828, 0.1, 10.0, 1.05)
    assert found == pytest.approx(2.718281828, rel=1e-6)
    assert found >= 2.718281828


def test_first_of_several_bands_counts():
    def overturns(factors):
        return ((factors > 1.3) & (factors < 1.5)) | (factors > 4.0)

    assert first_overturning_factor(overturns, 0.1, 10.0, 1.02) == pytest.approx(1.3, rel=1e-6)


def test_nothing_up_to_the_end_of_the_search_is_infinity():
    assert first_overturning_factor(lambda factors: factors > 11.0, 0.1, 10.0, 1.02) == np.inf
    assert first_overturning_factor(lambda factors: factors > 0.0, 12.0, 10.0, 1.02) == np.inf


def test_edge_at_the_start_of_the_search_is_kept():
    found = first_overturning_factor(lambda factors: factors >= 0.5, 0.5, 10.0, 1.02)
    assert found == pytest.approx(0.5, rel=1e-6)


def test_resonance_overturns_at_its_factor_and_not_below():
    sequence = ImpulseSequence(main=0.15, secondary=0.0, interval=0.5, duration=20.0, main_count=6)
    factors = resonance_safety_factor(BLOCKS, sequence, 10.0)
    for lane, factor in enumerate(factors):
        block = BLOCKS.lane(lane)
        at = resonance(block, 0.15 * factor * (1 + 1e-9), 6, duration=20.0)
        below = resonance(block, 0.15 * factor * (1 - 1e-9), 6, duration=20.0)
        assert (at.outcome, below.outcome) == (Outcome.OVERTURNS, Outcome.ROCKS)


def test_sequence_without_secondary_impulses_has_the_factor_of_resonance():
    sequence = ImpulseSequence(main=0.15, secondary=0.0, interval=0.5, duration=20.0, main_count=4)
    searched = sequence_safety_factor(BLOCKS, sequence, 10.0, 1.02)
    assert searched == pytest.approx(resonance_safety_factor(BLOCKS, sequence, 10.0), rel=2e-6)


@pytest.mark.parametrize("spacing", ["end", "middle", "start", "open", "continuous"])
def test_sequence_factor_is_an_edge_and_no_smaller_than_that_of_resonance(spacing):
    sequence = ImpulseSequence(main=0.2, secondary=0.1, interval=0.3, duration=15.0, main_count=5, spacing=spacing)
    factors = sequence_safety_factor(BLOCKS, sequence, 10.0, 1.02)
    without_end = ImpulseSequence(main=0.2, secondary=0.0, interval=0.3, duration=np.inf, main_count=5)
    assert np.all(factors >= resonance_safety_factor(BLOCKS, without_end, 10.0) * (1 - 1e-9))
    for lane, factor in enumerate(factors):
        assert np.isfinite(factor)
        block = BLOCKS.lane(lane)
        assert sequence_response(block, sequence.scaled(factor)).outcome == Outcome.OVERTURNS
        assert sequence_response(block, sequence.scaled(factor * (1 - 3e-6))).outcome != Outcome.OVERTURNS


def test_no_impulse_never_overturns():
    sequence = ImpulseSequence(main=0.0, secondary=0.0, interval=0.3, duration=15.0)
    assert np.all(sequence_safety_factor(BLOCKS, sequence, 10.0, 1.02) == np.inf)


def searched_one_by_one(overturns, start, factor_max, step):
    """The whole scan of one block, then its edge: what the search over many blocks must give to the last digit."""
    if start > factor_max:
        return np.inf
    count = max(1 + int(np.ceil(np.log(factor_max / start) / np.log(step))), 2)
    factors, low = np.geomspace(start, factor_max, count), start / step
    for _ in range(ROUNDS):
        over = np.flatnonzero(overturns(factors))
        if over.size == 0:
            return np.inf
        high = factors[over[0]]
        low = factors[over[0] - 1] if over[0] else low
        if high - low <= EDGE_TOLERANCE * high:
            break
        factors = np.linspace(low, high, REFINEMENT)[1:]
    return high


def test_search_over_many_blocks_gives_what_each_alone_gives():
    rng = np.random.default_rng(5)
    count = 2 * BLOCKS_AT_ONCE + 7
    begin = np.geomspace(0.02, 30.0, count)
    length = rng.uniform(0.05, 0.5, count)
    start = rng.uniform(0.01, 0.9, count) * np.minimum(begin, 11.0)

    def overturns(lanes, factors):
        return ((factors >= begin[lanes]) & (factors < begin[lanes] * (1 + length[lanes]))) | (factors > 9.9)

    found = first_overturning_factors(overturns, start, 10.0, 1.02)
    for lane in range(count):
        alone = searched_one_by_one(lambda f, lane=lane: overturns(np.array([lane]), f), start[lane], 10.0, 1.02)
        assert found[lane] == alone
    assert np.any(np.isinf(found)) == np.any(start > 10.0)


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_sequence_factors_of_many_blocks_are_those_of_each_alone(threads):
    rng = np.random.default_rng(6)
    many = Block(rng.uniform(0.2, 0.8, 40), rng.uniform(1.5, 4.0, 40), restitution=rng.uniform(0.5, 0.85, 40))
    sequence = ImpulseSequence(main=0.2, secondary=0.08, interval=0.2, duration=15.0, main_count=6)
    factors = sequence_safety_factor(many, sequence, 4.0, 1.05, threads=threads)
    assert np.any(np.isinf(factors))
    assert np.any(np.isfinite(factors))
    for lane in range(0, 40, 7):
        assert factors[lane] == sequence_safety_factor(many.lane(lane), sequence, 4.0, 1.05)[0]
