"""Lanes over threads: every lane once, whatever the number of threads."""

import threading
from concurrent.futures import ThreadPoolExecutor as Pool

import numpy as np
import pytest
from recorded_cases import synthetic

from rocking import Block, recorded_response
from rocking.lanes import available_cores, split_lanes, spread, thread_limit


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


def threads_used(threads, monkeypatch):
    """How many threads one call asks for on a machine of six cores."""
    monkeypatch.setattr("rocking.lanes.available_cores", lambda: 6)
    asked = []
    monkeypatch.setattr("rocking.lanes.ThreadPoolExecutor", lambda n: asked.append(n) or Pool(n))
    split_lanes(lambda first, last: None, 1000, threads)
    return asked[0] if asked else 1


def test_without_a_number_there_are_at_most_as_many_threads_as_the_limit(monkeypatch):
    assert threads_used(None, monkeypatch) == 6
    with thread_limit(3):
        assert threads_used(None, monkeypatch) == 3
        assert threads_used(5, monkeypatch) == 5  # who asks for a number gets it
        with thread_limit(1):
            assert threads_used(None, monkeypatch) == 1
        with thread_limit(4):
            assert threads_used(None, monkeypatch) == 3
    with thread_limit(50):
        assert threads_used(None, monkeypatch) == 6


def test_limits_end_with_their_own_block_in_any_order_and_after_an_error(monkeypatch):
    first, second = thread_limit(1), thread_limit(2)
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert threads_used(None, monkeypatch) == 2
    second.__exit__(None, None, None)
    assert threads_used(None, monkeypatch) == 6
    with pytest.raises(ZeroDivisionError), thread_limit(1):
        raise ZeroDivisionError("inside")
    assert threads_used(None, monkeypatch) == 6


def test_the_limit_holds_in_every_thread_of_the_process(monkeypatch):
    with thread_limit(2), Pool(1) as pool:
        assert pool.submit(threads_used, None, monkeypatch).result() == 2


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, None])
def test_a_number_of_threads_and_a_limit_are_whole_numbers_of_at_least_one(threads, monkeypatch):
    if threads is not None:
        with pytest.raises(ValueError, match="threads"):
            split_lanes(lambda first, last: None, 10, threads)
    with pytest.raises(ValueError, match="threads"), thread_limit(threads):
        pass
    assert threads_used(None, monkeypatch) == 6


@pytest.mark.parametrize("equation", ["linear", "nonlinear"])
def test_answers_do_not_depend_on_threads_or_neighbours(equation):
    rng = np.random.default_rng(8)
    lanes = 300
    block = Block.from_parameters(p=rng.uniform(1, 8, lanes), alpha=rng.uniform(0.05, 0.3, lanes), restitution=0.9)
    motion = synthetic(seed=5)
    one = recorded_response(block, motion, 0.01, equation, threads=1)
    for threads in (2, 7):
        more = recorded_response(block, motion, 0.01, equation, threads=threads)
        for name in ("peak_rotation_ratio", "outcome", "overturning_time", "impacts", "active_samples"):
            assert np.array_equal(getattr(one, name), getattr(more, name), equal_nan=True), name
    for lane in range(0, lanes, 40):
        alone = recorded_response(block.lane(lane), motion, 0.01, equation)
        assert alone.peak_rotation_ratio == one.peak_rotation_ratio[lane]


@pytest.mark.parametrize(
    ("lanes", "threads", "smallest", "slices"),
    [
        (1000, 2, 8, 16),  # eight slices for each thread
        (1003, 3, 8, 24),
        (60, 2, 20, 3),  # of no fewer lanes than the smallest slice
        (59, 2, 20, 2),
        (40, 2, 20, 2),
        (39, 2, 20, 1),
        (1000, 1, 8, 1),
    ],
)
def test_slices_are_alike_and_no_smaller_than_told(lanes, threads, smallest, slices):
    found = []
    split_lanes(lambda first, last: found.append((first, last)), lanes, threads, smallest)
    assert sorted(found) == [(lanes * k // slices, lanes * (k + 1) // slices) for k in range(slices)]


def test_the_cores_of_this_process_are_available_and_without_an_affinity_all(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda process: {0, 3, 5} if process == 0 else {0}, raising=False)
    assert available_cores() == 3
    monkeypatch.delattr("os.sched_getaffinity")
    for told, expected in ((6, 6), (None, 1)):
        monkeypatch.setattr("os.cpu_count", lambda told=told: told)
        assert available_cores() == expected


@pytest.mark.parametrize(("threads", "items", "inner"), [(1, 3, 1), (4, 1, 4), (4, 2, 2), (4, 3, 1), (2, 5, 1)])
def test_calls_on_items_share_the_threads_and_their_results_are_in_order(threads, items, inner):
    found = list(spread(lambda item, own: (item, own), range(items), threads))
    assert found == [(item, inner) for item in range(items)]


def test_an_error_of_one_item_comes_back_and_a_limit_holds():
    with pytest.raises(ZeroDivisionError):
        list(spread(lambda item, _: 1 / item, [1, 0, 2], 2))
    with thread_limit(1):
        names = set(spread(lambda *_: threading.current_thread().name, range(5), None))
    assert names == {threading.current_thread().name}
