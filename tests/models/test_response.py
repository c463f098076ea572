"""Responses of lanes that a model does not answer, alone and among others."""

import numpy as np
import pytest

from rocking import Block, Outcome, Reason, recorded_response, resonance
from rocking.response import spread, unresolved

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
