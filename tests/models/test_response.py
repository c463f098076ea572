"""Responses of lanes that a model does not answer, alone and among others."""

import numpy as np
import pytest

from rocking import Block, ImpulseSequence, Outcome, Reason, recorded_response, resonance, sequence_response
from rocking.response import spread, squeezed, unresolved

BODIES = Block(0.5, [2.0, 3.0], restitution=0.9, gravity=9.81)
KNOWN = np.array([True, False, True])


def test_where_there_is_no_answer_nothing_is_said():
    found = unresolved((2, 3), Reason.FREE_FLIGHT)
    assert found.outcome.tolist() == [[Outcome.UNRESOLVED] * 3] * 2
    assert found.reason.tolist() == [[Reason.FREE_FLIGHT] * 3] * 2
    assert found.overturning_half_cycle.tolist() == found.impacts.tolist() == [[-1] * 3] * 2
    assert np.isnan([found.peak_rotation_ratio, found.overturning_time]).all()


@pytest.mark.parametrize("impulse", [0.1, [0.1, 0.2]])
def test_answers_keep_their_places_among_blocks_that_have_none(impulse):
    some = resonance(BODIES, impulse, 3, table_rows=5)
    whole = spread(some, KNOWN, Reason.FREE_FLIGHT)
    assert np.all(whole.outcome[..., 1] == Outcome.UNRESOLVED)
    assert np.all(whole.reason[..., 1] == Reason.FREE_FLIGHT)
    assert np.all(whole.overturning_half_cycle[..., 1] == -1)
    assert np.isnan(whole.peak_rotation_ratio[..., 1]).all()
    for name in ("outcome", "peak_rotation_ratio", "overturning_half_cycle", "impacts"):
        assert np.array_equal(getattr(whole, name)[..., KNOWN], getattr(some, name))
    assert np.array_equal(whole.half_cycles.start_velocity[..., KNOWN], some.half_cycles.start_velocity, equal_nan=True)
    assert np.isnan(whole.half_cycles.start_velocity[..., 1]).all()


def test_histories_keep_their_places_too():
    motion = 4.0 * np.sin(0.1 * np.arange(200))
    some = recorded_response(BODIES, motion, 0.01, history=True)
    whole = spread(some, KNOWN, Reason.FREE_FLIGHT)
    assert np.array_equal(whole.rotation[KNOWN], some.rotation, equal_nan=True)
    assert np.isnan(whole.rotation[1]).all()
    assert np.array_equal(whole.time, some.time)


def test_counts_and_flags_of_blocks_without_an_answer_say_that_there_is_none():
    motion = 4.0 * np.sin(0.1 * np.arange(200))
    some = recorded_response(BODIES, motion, 0.01, scale=[0.5, 1.0], history=True)
    whole = spread(some, KNOWN, Reason.FREE_FLIGHT)
    assert whole.active_samples[:, 1].tolist() == [0, 0]
    assert whole.impacts[:, 1].tolist() == whole.overturning_half_cycle[:, 1].tolist() == [-1, -1]
    assert whole.velocity.shape == whole.rotation.shape == (2, 3, 200)
    for name in ("rotation", "velocity"):
        assert np.array_equal(getattr(whole, name)[:, KNOWN], getattr(some, name), equal_nan=True)
        assert np.isnan(getattr(whole, name)[:, 1]).all()
    assert np.array_equal(whole.active_samples[:, KNOWN], some.active_samples)
    table = resonance(BODIES, [0.1, 0.2], 3, table_rows=5).half_cycles
    told = spread(resonance(BODIES, [0.1, 0.2], 3, table_rows=5), KNOWN, Reason.FREE_FLIGHT).half_cycles
    assert np.all(told.impulse_count[..., 1] == -1)
    assert np.array_equal(told.impulse_count[..., KNOWN], table.impulse_count)
    assert np.isnan([told.peak[..., 1], told.duration[..., 1], told.interval[..., 1], told.impact_speed[..., 1]]).all()


def test_ground_contact_of_blocks_without_an_answer_is_none():
    sequence = ImpulseSequence(0.3, 0.27, 0.1, 5.0, spacing="start")
    some = sequence_response(BODIES, sequence)
    assert np.asarray(some.ground_contact).dtype == bool
    whole = spread(some, KNOWN, Reason.NOT_MODELLED)
    assert whole.ground_contact.tolist() == [bool(some.ground_contact[0]), False, bool(some.ground_contact[1])]


@pytest.mark.parametrize(("drop", "shape"), [((False, False), (4, 2, 3)), ((True, False), (4, 3))])
def test_axes_of_scalars_are_dropped_from_the_last_two(drop, shape):
    values = np.arange(24.0).reshape(4, 2, 3)[:, : 1 if drop[0] else 2]
    assert squeezed(values, drop).shape == shape
    assert squeezed(np.ones((2, 1)), (False, True)).shape == (2,)
    assert squeezed(np.full((1, 1), 7.0), (True, True)) == 7.0


def test_a_history_loses_the_axes_of_scalars_and_keeps_that_of_time():
    motion = 4.0 * np.sin(0.1 * np.arange(200))
    every = recorded_response(BODIES, motion, 0.01, scale=[0.5, 1.0], history=True)
    for scale, block, place in (
        (1.0, BODIES, (1,)),
        ([0.5, 1.0], BODIES.lane(1), (slice(None), 1)),
        (0.5, BODIES.lane(0), (0, 0)),
    ):
        one = recorded_response(block, motion, 0.01, scale=scale, history=True)
        for name in ("rotation", "velocity"):
            assert np.array_equal(getattr(one, name), getattr(every, name)[place], equal_nan=True)
        assert one.time == pytest.approx(0.01 * np.arange(200))
    assert not np.array_equal(every.rotation, every.velocity, equal_nan=True)
