"""Lanes over threads: every lane once, whatever the number of threads."""

import threading

import numpy as np
import pytest
from recorded_cases import synthetic

from rockpulse.models import Block, recorded_response
from rockpulse.models.threads import available_cores, split_lanes


@pytest.mark.parametrize("threads", [None, 1, 2, 5])
@pytest.mark.parametrize("lanes", [0, 1, 7, 128, 1001])
def test_every_lane_is_answered_once(threads, lanes):
    times = np.zeros(lanes, dtype=int)

    def call(first, last):
        times[first:last] += 1

    split_lanes(call, lanes, threads, smallest=8)
    assert np.all(times == 1)


def test_work_runs_in_other_threads_and_their_errors_come_back():
    names = set()

    def call(first, last):
        names.add(threading.current_thread().name)
        if first > 0:
            raise ZeroDivisionError("lane")

    with pytest.raises(ZeroDivisionError):
        split_lanes(call, 1000, 2)
    assert threading.main_thread().name not in names


@pytest.mark.parametrize("threads", [0, -1, 1.5, True])
def test_number_of_threads_is_a_whole_number_of_at_least_one(threads):
    with pytest.raises(ValueError, match="threads"):
        split_lanes(lambda first, last: None, 10, threads)
    assert available_cores() >= 1


@pytest.mark.parametrize("equation", ["linear", "nonlinear"])
def test_answers_do_not_depend_on_threads_or_neighbours(equation):
    rng = np.random.default_rng(8)
    lanes = 400
    block = Block.from_parameters(p=rng.uniform(1, 8, lanes), alpha=rng.uniform(0.05, 0.3, lanes), restitution=0.9)
    motion = synthetic(seed=5)
    one = recorded_response(block, motion, 0.01, equation, threads=1)
    for threads in (2, 3, 7):
        more = recorded_response(block, motion, 0.01, equation, threads=threads)
        for name in ("peak_rotation_ratio", "outcome", "overturning_time", "impacts", "active_samples"):
            assert np.array_equal(getattr(one, name), getattr(more, name), equal_nan=True), name
    for lane in range(0, lanes, 40):
        alone = recorded_response(block.lane(lane), motion, 0.01, equation)
        assert alone.peak_rotation_ratio == one.peak_rotation_ratio[lane]
