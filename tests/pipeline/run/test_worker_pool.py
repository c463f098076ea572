"""The pool: every item answered once, whoever works and whoever dies; nobody left behind."""

import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

import pool_functions as toys
import pytest

from rockpulse.run import processes
from rockpulse.run.processes import ALGEBRA, WorkerProcesses
from rockpulse.run.worker_pool import WorkerLost, WorkerPool

#: How long a busy machine may take for what it does at once when it is idle [s].
PATIENCE = 300.0


@pytest.fixture(scope="module")
def pair():
    """Two worker processes for several tests: what one test kills is there again for the next."""
    with WorkerPool.local(2) as pool:
        yield pool


def alive(process):
    """Whether the process runs, or is a dead child of this one that was not collected (a zombie)."""
    try:
        # After the name in brackets: state, parent.
        state, parent = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[:2]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z" or int(parent) == os.getpid()


def group_runs(group):
    """Whether any process of the group is left, and be it a helper of Python's own."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


@pytest.mark.sweep
def test_every_item_is_answered_once_whoever_works(pair):
    with WorkerPool.inline() as alone:
        for pool, workers in ((alone, 1), (pair, 2)):
            assert pool.size == workers
            assert sorted(pool.run(toys.square, range(23))) == [(number, number**2) for number in range(23)]
            assert list(pool.run(toys.square, [])) == []


def test_results_come_in_order_of_completion(pair, tmp_path):
    go = tmp_path / "go"
    results = pair.run(toys.wait_for_file, [(0, go), (1, None), (2, None)])
    assert {next(results)[1], next(results)[1]} == {1, 2}  # either first, where both are ready at once
    go.touch()
    assert [number for _, number in results] == [0]


def test_items_are_taken_a_few_ahead_only(pair):
    taken = 0

    def endless():
        nonlocal taken
        while True:
            taken += 1
            yield taken

    results = pair.run(toys.square, endless())
    for done in range(1, 20):
        next(results)
        assert taken - done < 2 * 2 + 1
    results.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("function", "reason"),
    [(toys.killed_while_answering, "killed by signal 9 (Killed)"), (toys.leave, "ended itself with exit code 7")],
)
def test_an_item_that_always_kills_its_worker_is_lost_and_no_other(pair, function, reason):
    answers = dict(pair.run(function, range(2, 6)))
    lost = answers.pop(3)
    assert isinstance(lost, WorkerLost)
    assert reason in lost.reason
    assert answers == {number: function(number) for number in (2, 4, 5)}


@pytest.mark.sweep
def test_a_worker_that_is_killed_from_outside_while_idle_changes_nothing(pair):
    victims = {process for _, process in pair.run(toys.process_id, range(6))}
    for victim in victims:
        os.kill(victim, signal.SIGKILL)
    assert dict(pair.run(toys.square, range(6))) == {number: number**2 for number in range(6)}
    assert not victims & {process for _, process in pair.run(toys.process_id, range(6))}


def test_what_the_function_raises_is_raised_with_the_traceback_of_the_worker(pair):
    with pytest.raises(KeyError, match="three") as caught:
        list(pair.run(toys.refuse, range(8)))
    assert "pool_functions.py" in caught.value.__notes__[0]
    assert "in refuse" in caught.value.__notes__[0]
    assert dict(pair.run(toys.square, [5])) == {5: 25}


def test_exceptions_and_results_that_do_not_pickle_are_told_all_the_same(pair):
    with pytest.raises(RuntimeError, match="Awkward: 1 and 2") as caught:
        list(pair.run(toys.refuse_awkwardly, [1]))
    assert "in refuse_awkwardly" in caught.value.__notes__[0]
    with pytest.raises(SystemExit, match="enough"):
        list(pair.run(toys.stop_the_interpreter, [1]))
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        list(pair.run(toys.unpicklable, [1]))
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        list(pair.run(lambda item: item, [1]))


def test_workers_run_kernels_on_one_thread_and_this_process_on_all(pair):
    assert list(pair.run(toys.kernel_threads, [0])) == [(0, 1)]
    with WorkerPool.inline() as pool:
        assert list(pool.run(toys.kernel_threads, [0])) == [(0, 6)]


def test_a_worker_is_light_until_it_has_work(pair):
    ((_, loaded),) = pair.run(toys.modules, [0])
    assert not loaded & {"numba", "xarray", "obspy", "scipy", "pandas", "distributed"}


def numbers_of(folder, count):
    """The processes that have left their number in the folder."""
    assert wait_for(lambda: len(list(folder.iterdir())) == count, PATIENCE), "the workers do not start"
    return [int(path.name) for path in folder.iterdir()]


@pytest.mark.sweep
def test_leaving_by_an_error_ends_busy_workers_at_once(tmp_path):
    def interrupted_with_two_at_work():
        yield from [tmp_path, tmp_path]
        numbers_of(tmp_path, 2)
        interrupted.append(time.monotonic())
        raise KeyboardInterrupt

    interrupted = []
    with pytest.raises(KeyboardInterrupt), WorkerPool.local(2) as pool:
        list(pool.run(toys.report_and_doze, interrupted_with_two_at_work()))
    assert time.monotonic() - interrupted[0] < 30.0  # of the minute that they would have slept
    assert not any(alive(process) for process in numbers_of(tmp_path, 2))


SCRIPT = """
import signal
import sys
from pathlib import Path
from pool_functions import report_and_doze
from rockpulse.run.worker_pool import WorkerPool

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # tests in the background of a shell have it ignored
    Path(sys.argv[2]).touch()
    with WorkerPool.local(2) as pool:
        list(pool.run(report_and_doze, [sys.argv[1]] * 6))
"""


@pytest.fixture
def batch(tmp_path):
    """A process of its own with two workers, and the folder where they leave their numbers."""
    script, folder, begun = tmp_path / "batch.py", tmp_path / "workers", tmp_path / "begun"
    script.write_text(SCRIPT)
    folder.mkdir()
    places = filter(None, (str(Path(toys.__file__).parent), os.environ.get("PYTHONPATH")))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(places)}
    process = subprocess.Popen(
        [sys.executable, script, folder, begun],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert wait_for(begun.exists, PATIENCE)
    yield process, folder
    process.kill()
    process.communicate()


@pytest.mark.slow
def test_no_worker_outlives_a_parent_that_is_killed(batch):
    process, folder = batch
    workers = numbers_of(folder, 2)
    assert all(alive(worker) for worker in workers)
    process.kill()
    process.wait()
    assert wait_for(lambda: not any(alive(worker) for worker in workers), PATIENCE)


@pytest.mark.parametrize(
    "moment", [pytest.param("starting", marks=pytest.mark.slow), pytest.param("working", marks=pytest.mark.sweep)]
)
def test_an_interrupt_from_the_keyboard_ends_all_and_only_the_parent_says_so(batch, moment):
    process, folder = batch
    workers = numbers_of(folder, 2) if moment == "working" else []
    if not workers:
        time.sleep(0.1)  # the workers are importing
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == -signal.SIGINT
    assert said.count("Traceback") == 1, said
    assert said.rstrip().endswith("KeyboardInterrupt")
    assert not any(alive(worker) for worker in workers)
    assert wait_for(lambda: not group_runs(process.pid), PATIENCE)


@pytest.mark.sweep
def test_a_worker_that_is_killed_while_it_starts_is_started_again(monkeypatch, tmp_path):
    monkeypatch.setenv("CREW_TEST_FILE", str(tmp_path / "seen"))
    monkeypatch.setattr(processes, "serve", toys.serve_at_the_second_start)
    with WorkerPool.local(1) as pool:
        assert list(pool.run(toys.square, [3])) == [(3, 9)]
    assert (tmp_path / "seen").exists()


@pytest.mark.parametrize(
    ("start", "message"),
    [
        pytest.param(toys.stop_the_interpreter, r"exit code 1 while it started.*__main__", marks=pytest.mark.sweep),
        (toys.always_killed, r"killed by signal 9 \(Killed\) during its start, 2 times; .*memory"),
    ],
)
def test_a_worker_that_cannot_start_is_an_error_that_says_what_to_do(monkeypatch, start, message):
    monkeypatch.setattr(processes, "serve", start)
    monkeypatch.setattr(processes, "STARTS", 2)
    with pytest.raises(ChildProcessError, match=message), WorkerPool.local(1) as pool:
        list(pool.run(toys.square, [3]))


def test_work_that_is_cancelled_from_outside_is_an_error():
    class Gone(Executor):
        def submit(self, fn, /, *args, **kwargs):
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(ConnectionError, match="cancelled from outside"):
        list(WorkerPool(Gone(), lambda: 1).run(toys.square, [1]))


def test_a_pool_has_at_least_one_worker():
    with pytest.raises(ValueError, match="workers"):
        WorkerPool.local(0)


@pytest.mark.sweep
def test_workers_do_linear_algebra_on_one_thread_unless_the_user_says_otherwise(monkeypatch):
    for name in ALGEBRA:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    before = dict(os.environ)
    with WorkerProcesses(1) as pool:
        found = {name: pool.submit(os.getenv, name).result() for name in ALGEBRA}
    assert found == dict.fromkeys(ALGEBRA, "1") | {"OPENBLAS_NUM_THREADS": "3"}
    assert dict(os.environ) == before


def test_a_group_that_is_given_up_costs_each_of_its_items_a_second_try_and_no_neighbour():
    with toys.Cluster() as cluster, WorkerPool(cluster, lambda: 1, (toys.Died,), ahead=1, group_seconds=60.0) as pool:
        answers = dict(pool.run(toys.square, [0, 1, 2, *range(4, 40), 3, *range(40, 60)]))
    lost = answers.pop(3)
    assert isinstance(lost, WorkerLost)
    assert answers == {number: number**2 for number in range(60) if number != 3}
    assert cluster.groups[0] == [0]  # alone, as its time is not known yet
    assert max(map(len, cluster.groups)) > 10
    given = [number for group in cluster.groups for number in group]
    assert {number for number in given if given.count(number) == 2} == {*max(cluster.groups, key=lambda g: 3 in g)}


@pytest.fixture
def large_letters(monkeypatch):
    """The sizes of what this process sends to workers, from half a megabyte on [bytes]."""
    sizes, send = [], Connection.send_bytes

    def counted(pipe, letter):
        if len(letter) > 500_000:
            sizes.append(len(letter))
        send(pipe, letter)

    monkeypatch.setattr(Connection, "send_bytes", counted)
    return sizes


def test_a_function_is_pickled_once_and_sent_once_to_each_worker(pair, large_letters):
    before = toys.Counted.pickled
    answers = dict(pair.run(toys.Counted(), range(40)))
    assert toys.Counted.pickled == before + 1
    assert {unpickled for _, unpickled in answers.values()} == {1}
    assert len(large_letters) == len({process for process, _ in answers.values()})


@pytest.mark.sweep
def test_a_worker_that_replaces_a_dead_one_is_sent_the_function_again(tmp_path, large_letters):
    jobs = [(number, tmp_path) for number in (1, 2, 3, 4, 5)]
    with WorkerPool.local(1) as pool:
        for deaths in (1, 0):  # of the item 3, the first time only
            answers = list(pool.run(partial(toys.killed_once, constant=bytes(1_000_000)), jobs))
            assert sorted(answers) == [(job, job[0]) for job in jobs]
            assert len(large_letters) == 1 + deaths
            large_letters.clear()
