"""Blocks and sequences as lanes of one call: broadcasting, threads, critical impulses, restitutions at both ends."""

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rocking.impulses.main_sequence import critical_impulse, resonance
from rocking.impulses.sequence import scaled_outcomes, sequence_response
from rocking.response import Outcome, Reason

G = 9.81
FIELDS = ("peak_rotation_ratio", "outcome", "reason", "overturning_time", "overturning_half_cycle", "impacts")


def bodies(count=6, restitution=None):
    rng = np.random.default_rng(1)
    alpha, radius = np.arctan(1.0 / rng.uniform(3.0, 12.0, count)), rng.uniform(0.5, 6.0, count)
    restitution = rng.uniform(0.5, 0.9, count) if restitution is None else restitution
    return Block(
        half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha), restitution=restitution, gravity=G
    )


def sequences(count=40, spacing="end"):
    """Every lane has its own I, I_s/I, dT and main count."""
    rng = np.random.default_rng(2)
    main = rng.uniform(0.1, 0.9, count)
    return ImpulseSequence(
        main=main,
        secondary=rng.uniform(0.0, 0.7, count) * main,
        interval=rng.uniform(0.05, 0.6, count),
        duration=20.0,
        main_count=rng.integers(1, 9, count),
        spacing=spacing,
    )


def one(sequence, q):
    return ImpulseSequence(
        sequence.main[q],
        sequence.secondary[q],
        sequence.interval[q],
        sequence.duration[q],
        main_count=int(sequence.main_count[q]),
        spacing=sequence.spacing,
    )


@pytest.mark.parametrize("spacing", sorted(SPACINGS))
def test_combinations_in_one_call_answer_as_one_by_one(spacing):
    blocks, many = bodies(), sequences(spacing=spacing)
    response = sequence_response(blocks, many)
    assert response.outcome.shape == (40, 6)
    assert {Outcome.ROCKS, Outcome.OVERTURNS} <= set(response.outcome.ravel().tolist())
    for q in range(0, 40, 3):
        alone = sequence_response(blocks, one(many, q))
        for name in FIELDS:
            assert np.array_equal(getattr(response, name)[q], getattr(alone, name), equal_nan=True)
        rows = alone.half_cycles.peak.shape[0]
        assert np.array_equal(response.half_cycles.peak[:rows, q], alone.half_cycles.peak, equal_nan=True)
        assert np.all(response.half_cycles.impulse_count[rows:, q] == -1)


def test_main_count_broadcasts_with_scalar_impulses():
    blocks = bodies()
    counts = np.array([1, 2, 3, 50])
    response = sequence_response(blocks, ImpulseSequence(0.3, 0.1, 0.2, 20.0, main_count=counts))
    assert response.outcome.shape == (4, 6)
    half_cycles = np.sum(np.isfinite(response.half_cycles.start_velocity), axis=0)
    assert np.all(half_cycles <= counts[:, None])
    assert np.all(half_cycles[0] == 1)
    main = resonance(blocks, 0.3, counts)
    for q, count in enumerate(counts):
        assert np.array_equal(
            main.peak_rotation_ratio[q], resonance(blocks, 0.3, int(count)).peak_rotation_ratio, equal_nan=True
        )


@pytest.mark.parametrize("threads", [2, None])
def test_number_of_threads_changes_no_digit(threads):
    blocks, many = bodies(), sequences(100)
    first, second = (sequence_response(blocks, many, threads=number) for number in (1, threads))
    for name in FIELDS:
        assert np.array_equal(getattr(first, name), getattr(second, name), equal_nan=True)
    for name in ("start_velocity", "peak", "duration", "impulse_count", "interval", "impact_speed"):
        assert np.array_equal(getattr(first.half_cycles, name), getattr(second.half_cycles, name), equal_nan=True)
    alone = resonance(blocks, many.main, many.main_count, 20.0, threads=1)
    shared = resonance(blocks, many.main, many.main_count, 20.0, threads=threads)
    assert all(np.array_equal(getattr(alone, name), getattr(shared, name), equal_nan=True) for name in FIELDS)


@pytest.mark.parametrize(
    ("restitution", "half_cycle"),
    [(restitution, i) for restitution in (0.0, 1e-3, 0.6, 0.9, 0.9999, 1.0) for i in (1, 2, 5, 20)],
)
def test_main_impulse_next_to_critical_on_both_sides(half_cycle, restitution):  # F2; u = 1 overturns
    block = Block.from_parameters(p=2.0, alpha=0.2, restitution=restitution, gravity=G)
    critical = critical_impulse(block, half_cycle)
    for share, overturns in ((1.0 - 1e-12, False), (1.0 + 1e-12, True)):
        main = share * critical
        sequence = ImpulseSequence(main, 0.0, np.nan, np.inf, main_count=half_cycle, spacing="continuous")
        for response in (resonance(block, main, half_cycle), sequence_response(block, sequence)):
            assert response.outcome == (Outcome.OVERTURNS if overturns else Outcome.ROCKS)
            assert np.isinf(response.peak_rotation_ratio) == overturns
            if overturns and restitution >= 0.6:
                assert response.overturning_half_cycle == half_cycle
            if not overturns:
                assert response.peak_rotation_ratio == pytest.approx(1.0 - np.sqrt(2e-12), abs=1e-9)


@pytest.mark.parametrize("restitution", [0.0, 1e-3, 0.9999, 1.0])
@pytest.mark.parametrize("spacing", sorted(SPACINGS))
def test_restitutions_at_both_ends_give_an_answer_or_a_reason(spacing, restitution):
    response = sequence_response(bodies(restitution=restitution), sequences(spacing=spacing), table_rows=0)
    unresolved = response.outcome == Outcome.UNRESOLVED
    assert not np.any(unresolved)
    assert not np.any(np.isnan(response.peak_rotation_ratio))


def test_outcomes_of_factors_that_differ_from_block_to_block():
    blocks = bodies()
    sequence = ImpulseSequence(0.3, 0.1, 0.2, 20.0, main_count=4)
    factors = np.random.default_rng(4).uniform(0.0, 5.0, (9, 3))
    chosen = np.array([4, 0, 2])
    outcomes = scaled_outcomes(blocks, sequence, chosen, factors)
    assert len(np.unique(outcomes)) == 2
    for row, column in np.ndindex(9, 3):
        alone = sequence_response(blocks.lane(chosen[column]), sequence.scaled(factors[row, column]))
        assert outcomes[row, column] == alone.outcome


def test_outcomes_of_factors_mark_intervals_that_are_too_short():
    outcomes = scaled_outcomes(bodies(), ImpulseSequence(0.3, 0.1, 1e-7, 20.0), np.array([0]), np.ones((1, 1)))
    assert outcomes.tolist() == [[Outcome.UNRESOLVED]]
    assert sequence_response(bodies(), ImpulseSequence(0.3, 0.1, 1e-7, 20.0)).reason[0] == Reason.SHORT_INTERVAL


@pytest.mark.parametrize("count", [[1.5, 2.0], [0, 1], [[1]], [True, False], ["a", "b"]])
def test_bad_counts_are_named(count):
    with pytest.raises(ValueError, match="main_count"):
        ImpulseSequence([0.3, 0.3], 0.1, 0.2, 20.0, main_count=count)
    with pytest.raises(ValueError, match="half_cycles"):
        resonance(bodies(), 0.3, count)


@pytest.mark.parametrize("spacing", ["end", "continuous"])
def test_pairs_answer_as_one_by_one(spacing):
    blocks, many = bodies(40), sequences(40, spacing=spacing)
    response = sequence_response(blocks, many, paired=True, threads=2)
    assert response.outcome.shape == (40,)
    for lane in range(0, 40, 7):
        alone = sequence_response(blocks.lane(lane), one(many, lane))
        for name in FIELDS:
            assert np.array_equal(getattr(response, name)[lane], getattr(alone, name), equal_nan=True), name
        rows = alone.half_cycles.peak.shape[0]
        assert np.array_equal(response.half_cycles.peak[:rows, lane], alone.half_cycles.peak, equal_nan=True)


def test_one_of_either_goes_with_all_of_the_other():
    blocks, many = bodies(6), sequences(6)
    assert np.array_equal(
        sequence_response(blocks, one(many, 2), paired=True).outcome, sequence_response(blocks, one(many, 2)).outcome
    )
    assert np.array_equal(
        sequence_response(blocks.lane(1), many, paired=True).outcome, sequence_response(blocks.lane(1), many).outcome
    )
    assert np.ndim(sequence_response(blocks.lane(1), one(many, 2), paired=True).outcome) == 0


def test_pairs_of_different_numbers_are_refused():
    with pytest.raises(ValueError, match="one sequence for each block, got 5 for 6"):
        sequence_response(bodies(6), sequences(5), paired=True)
