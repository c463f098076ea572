"""The targets of a response calibration: which are numbers, how far a sequence is from them, and families of blocks."""

import numpy as np
import pytest

from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block, ImpulseSequence, Outcome, recorded_response, sequence_response
from rockpulse.record.record import Record
from rockpulse.sequences.response_targets import (
    ResponseTargets,
    TooWeak,
    block_family,
    describe_family,
    motion_family,
    recorded_family,
    recorded_targets,
)

NUMBERS = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]


def targets(peaks=(), outcomes=(), **options):
    """Six numbers, then what is given."""
    every = [*NUMBERS, *peaks]
    blocks = Block.from_parameters(np.full(len(every), 2.0), 0.2, 0.9)
    return ResponseTargets(blocks, every, [*[Outcome.ROCKS] * 6, *outcomes], **options)


FOUR = targets(
    [np.inf, 0.02, 0.0, np.nan], [Outcome.OVERTURNS, Outcome.ROCKS, Outcome.AT_REST, Outcome.UNRESOLVED], smallest=0.05
)


def test_every_target_is_of_one_kind():
    kinds = np.stack([FOUR.number, FOUR.overturned, FOUR.small, FOUR.silent])
    assert np.all(kinds.sum(axis=0) == 1)
    assert np.argmax(kinds, axis=0).tolist() == [0, 0, 0, 0, 0, 0, 1, 2, 3, 3]


def test_residuals_by_hand():
    peaks = np.full((4, 10), 0.2)
    peaks[1], peaks[2] = np.inf, 0.01
    found = FOUR.residuals(peaks)
    assert found[0, :6] == pytest.approx(np.log(np.array(NUMBERS) / 0.2))
    # Overturned and 0.2: short of 1. Small and 0.2: above 0.05.
    assert found[0, 6:8] == pytest.approx([-np.log(0.2), np.log(0.05 / 0.2)])
    # A sequence that overturns a block is known to reach 1.
    assert found[1, :6] == pytest.approx(np.log(NUMBERS))
    assert found[1, 6:8] == pytest.approx([0.0, np.log(0.05)])
    assert found[2, 7] == 0.0
    assert np.all(np.isnan(found[:, 8:]))
    peaks[0], peaks[1] = 1.3, 0.0
    found = FOUR.residuals(peaks)
    # Beyond alpha_c and back, a block has reached 1 as well.
    assert found[0, :6] == pytest.approx(np.log(np.array(NUMBERS) / 1.3))
    assert found[0, 6:8] == pytest.approx([0.0, np.log(0.05)])
    assert np.all(np.isfinite(found[1, :8]))
    assert np.all(found[1, :7] > 600.0)
    assert found[1, 7] == 0.0


def test_the_misfit_is_the_rms_residual_of_those_that_speak():
    peaks = np.full((2, 10), 0.2)
    peaks[1] = 0.4
    squares = [*(np.log(np.array(NUMBERS) / 0.2) ** 2).tolist(), np.log(0.2) ** 2, np.log(0.05 / 0.2) ** 2]
    doubled = [*(np.log(np.array(NUMBERS) / 0.4) ** 2).tolist(), np.log(0.4) ** 2, np.log(0.05 / 0.4) ** 2]
    assert FOUR.misfit(peaks) == pytest.approx([np.sqrt(np.sum(squares) / 8.0), np.sqrt(np.sum(doubled) / 8.0)])


def test_the_unsafe_side_is_below_the_target_and_silent_blocks_do_not_count():
    peaks = np.array([[0.1, 0.1, 0.4, 0.4, 0.4, 0.6, 0.9, 0.02, 5.0, 5.0]])
    # 0.1 < 0.2, 0.4 < 0.5 and 0.9 where the block overturns.
    assert FOUR.short_of(peaks) == pytest.approx([3.0 / 8.0])
    # The target itself is reached; a small one is short of 0.02, and what overturns is not.
    peaks = np.array([[*NUMBERS, np.inf, 0.019, 0.0, 0.0], [0.1, 0.2, 0.3, 0.4, 0.5, 0.59, 1.5, 0.02, 0.0, 0.0]])
    assert FOUR.short_of(peaks) == pytest.approx([1.0 / 8.0, 2.0 / 8.0])


def test_a_peak_of_just_the_smallest_one_is_a_number_and_the_arrays_are_closed():
    found = targets([0.25, 0.2499, 0.7], [Outcome.ROCKS] * 3, smallest=0.25)
    assert found.number.tolist() == [False, False, True, True, True, True, True, False, True]
    assert found.small.tolist() == [True, True, False, False, False, False, False, True, False]
    for array in (found.peaks, found.outcomes):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_too_few_numbers_are_refused_with_the_counts():
    blocks = Block.from_parameters(np.full(7, 2.0), 0.2, 0.9)
    peaks = [0.1, 0.2, 0.3, 0.4, 0.5, np.inf, 0.0]
    outcomes = [Outcome.ROCKS] * 5 + [Outcome.OVERTURNS, Outcome.AT_REST]
    with pytest.raises(RecordRefused, match=r"5 of 7 blocks .* \(1 overturn, 1 stay at rest\)"):
        ResponseTargets(blocks, peaks, outcomes)


@pytest.mark.parametrize(
    ("peaks", "outcomes", "options", "message"),
    [
        ([0.1], [], {}, "shapes"),
        ([], [Outcome.ROCKS], {}, "shapes"),
        ([np.inf], [Outcome.ROCKS], {}, "finite peak"),
        ([], [], {"smallest": 1.0}, "smallest"),
        ([np.nan], [Outcome.ROCKS], {}, "finite peak"),
        ([0.0], [Outcome.ROCKS], {}, "positive"),
        ([], [], {"smallest": 0.0}, "smallest"),
    ],
)
def test_targets_that_make_no_sense_are_refused(peaks, outcomes, options, message):
    with pytest.raises(ConfigError, match=message):
        targets(peaks, outcomes, **options)


def test_one_block_without_lanes_is_refused():
    with pytest.raises(ConfigError, match=r"shapes \(\), \(\) and \(\)"):
        ResponseTargets(Block.from_parameters(2.0, 0.2, 0.9), 0.3, Outcome.ROCKS)


@pytest.mark.parametrize(
    ("others", "weak"),
    [
        ([0.02], True),  # five of six move
        ([], False),  # five blocks are too few, whatever the motion
        ([np.inf, 0.0, 0.0, 0.0, 0.0, 0.0], False),  # six of eleven move, if one to overturn
        ([0.02, 0.0, 0.0, 0.0, 0.0, 0.0], True),
    ],
)
def test_a_motion_is_too_weak_where_five_of_enough_blocks_move(others, weak):
    peaks = np.array([*NUMBERS[:5], *others])
    outcomes = np.where(np.isinf(peaks), Outcome.OVERTURNS, np.where(peaks > 0.0, Outcome.ROCKS, Outcome.AT_REST))
    with pytest.raises(RecordRefused) as refusal:
        ResponseTargets(Block.from_parameters(np.full(peaks.size, 2.0), 0.2, 0.9), peaks, outcomes)
    assert isinstance(refusal.value, TooWeak) is weak


def test_the_family_is_even_in_size_and_angle():
    family = block_family()
    assert np.unique(family.p.round(12)) == pytest.approx(np.geomspace(1.0, 5.0, 5))
    assert np.unique(family.alpha_c.round(12)) == pytest.approx(np.geomspace(0.08, 0.32, 5))
    share = family.restitution / (1.0 - 1.5 * np.sin(family.alpha_c) ** 2)
    assert np.unique(share.round(12)).tolist() == [0.6, 0.75, 0.9, 1.0]


def test_a_motion_too_weak_for_the_family_is_refused_by_name():
    weak = Record(0.01 * np.sin(np.arange(200.0)), dt=0.01, id="weak")
    with pytest.raises(RecordRefused, match=r"weak: 0 of 100 blocks .* 100 stay at rest"):
        recorded_targets(weak, block_family(), threads=1)


def test_the_vertical_acceleration_acts_on_the_targets():
    time = np.arange(0.0, 4.0, 0.01)
    record = Record(4.0 * np.sin(2.0 * np.pi * time), dt=0.01, id="sine", processed=True)
    blocks = Block.from_parameters(np.linspace(1.0, 3.0, 12), 0.25, 0.9)
    up = 3.0 * np.cos(5.0 * np.pi * time)
    lifted = recorded_targets(record, blocks, vertical=up)
    direct = recorded_response(blocks, record.acceleration, record.dt, vertical=up)
    assert np.array_equal(lifted.peaks, direct.peak_rotation_ratio)
    assert not np.array_equal(lifted.peaks, recorded_targets(record, blocks).peaks)


def motion(main, main_count=1, ratio=0.0):
    sequence = ImpulseSequence(main, ratio * main, 0.2, np.inf, main_count=main_count)
    return lambda blocks: sequence_response(blocks, sequence, table_rows=0, threads=1)


def shake(size, seconds=8.0):
    return Record(size * np.sin(2.0 * np.pi * np.arange(0.0, seconds, 0.01)), dt=0.01, id="shake")


def test_one_impulse_has_its_edge_where_the_critical_impulse_is():
    # Eq. 9: overturned where I > I_1c; elsewhere the peak is 1 - sqrt(1 - (I/I_1c)^2), at least 0.057 up to 3 I_1c.
    answer = motion(0.5)
    family = motion_family(answer)
    impulses = family.critical_impulse
    assert family.shape == (100,)
    # The edge is an I_1c of the pool, whose blocks of one restitution lie within 10 %.
    assert 0.8 * 0.5 <= impulses.min() < 0.8 * 0.55
    assert 2.5 * 0.5 < impulses.max() <= 3.0 * 0.55
    response = answer(family)
    assert np.array_equal(response.outcome == Outcome.OVERTURNS, impulses < 0.5)
    number = (response.outcome == Outcome.ROCKS) & (response.peak_rotation_ratio >= 0.05)
    assert np.count_nonzero(number) >= 75
    assert np.count_nonzero(response.outcome == Outcome.OVERTURNS) >= 5


def test_where_more_impulses_push_a_better_restitution_moves_the_edge_up():
    family = motion_family(motion(0.2, main_count=5, ratio=0.3)).critical_impulse.reshape(4, 25)
    assert np.all(np.diff(family.min(axis=1)) < 0.0)


@pytest.mark.parametrize("main", [1e-3, 0.05, 0.3, 1.0, 30.0])
def test_from_the_weakest_to_the_strongest_motion_the_blocks_are_of_engineering_size_and_all_different(main):
    family = motion_family(motion(main, main_count=4))
    assert np.unique([family.p, family.alpha_c, family.restitution], axis=1).shape == (3, 100)
    assert np.all((family.p >= 1.0) & (family.p <= 5.0))
    assert np.all((family.slenderness >= 3.0) & (family.slenderness <= 12.5))
    assert family.warnings == ()


def test_a_record_moves_every_block_of_its_family():
    record = shake(0.15 * 9.81)
    family = recorded_family(record, threads=1)
    response = recorded_response(family, record.acceleration, record.dt, threads=1)
    assert np.tan(family.alpha_c.max()) < 0.15
    assert not np.any(response.outcome == Outcome.AT_REST)
    said = describe_family(family)
    assert said.startswith("100 blocks chosen about the edge of overturning of this motion: I_1c 0.")
    low, high = family.slenderness.min(), family.slenderness.max()
    assert f", slenderness {low:.3g} to {high:.3g}, C {family.restitution.min():.3g} to " in said
