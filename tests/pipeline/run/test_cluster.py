"""The pool on a real dask scheduler: the same answers, whichever worker dies; clear words where there is no cluster."""

import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time

import pool_functions as toys
import pytest
import xarray as xr
from batch_runs import bar_of
from dask_cluster import dask_cluster, wait_for_workers
from nominal import Config
from record_writers import at2, pulse

import rockpulse as rp
from rockpulse import BlockSettings, ModelSettings, SearchSettings
from rockpulse.errors import ConfigError
from rockpulse.run import worker_pool
from rockpulse.run.worker_pool import WorkerPool

SQUARES = [(number, number**2) for number in range(40)]


class PatientEvent(threading.Event):
    """One that waits for the event loop of distributed as long as a busy machine may take, not just 10 s."""

    def wait(self, timeout=None):
        return super().wait(300.0 if timeout == 10 else timeout)


@pytest.fixture
def needs_distributed(monkeypatch):
    pytest.importorskip("distributed", reason="the extra [distributed] is not installed")
    monkeypatch.setattr("distributed.utils.threading.Event", PatientEvent)


@pytest.mark.sweep
@pytest.mark.usefixtures("needs_distributed")
def test_two_workers_answer_like_one_process_and_one_that_is_killed_half_way_changes_nothing(tmp_path, monkeypatch):
    with dask_cluster(tmp_path) as (address, _, _):
        with WorkerPool.scheduler(address, timeout=300.0) as pool:
            wait_for_workers(pool, 2)
            assert sorted(pool.run(toys.square, range(40))) == SQUARES
            # Equal items are answered as often as they are given.
            assert list(pool.run(toys.square, [7, 7, 7])) == [(7, 49)] * 3
            assert list(pool.run(toys.kernel_threads, [0])) == [(0, 1)]
            with pytest.raises(KeyError, match="three"):
                list(pool.run(toys.refuse, range(8)))
            workers = {process for _, process in pool.run(toys.process_id, range(8))}
            assert len(workers) == 2

            # The function is sent to the scheduler once, and from there once to each worker.
            with monkeypatch.context() as patch:
                submit, sizes = pool.executor._executor.submit, []
                patch.setattr(
                    pool.executor._executor,
                    "submit",
                    lambda *given: sizes.append(len(pickle.dumps(given))) or submit(*given),
                )
                assert {times for _, (_, times) in pool.run(toys.Counted(), range(40))} == {1}
            assert max(sizes) < 2000

            answers = []
            for answer in pool.run(toys.slow_square, range(40)):
                answers.append(answer)
                if len(answers) == 10:
                    os.kill(workers.pop(), signal.SIGKILL)
            assert sorted(answers) == SQUARES
            wait_for_workers(pool, 1)
        with WorkerPool.scheduler(address, timeout=300.0) as pool:  # the cluster is still there for the next
            assert sorted(pool.run(toys.square, range(40))) == SQUARES
        monkeypatch.setattr(worker_pool, "__version__", "99.0")
        with pytest.raises(ConfigError, match=r"dask worker tcp://.* expected rockpulse 99\.0, found '\d"):
            WorkerPool.scheduler(address, timeout=300.0)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", pytest.param("cdp://127.0.0.1:8786", marks=pytest.mark.slow)])
@pytest.mark.usefixtures("needs_distributed")
def test_an_address_where_no_scheduler_answers_is_a_clear_error(address):
    with pytest.raises(
        ConfigError, match=rf"--scheduler {address}: expected .* none answers within 0\.5 s .*dask worker"
    ):
        WorkerPool.scheduler(address, timeout=0.5)


def test_without_the_package_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r'pip install "rockpulse\[distributed\]"'):
        WorkerPool.scheduler("tcp://127.0.0.1:8786")


@pytest.mark.slow
@pytest.mark.usefixtures("needs_distributed")
def test_an_assessment_on_a_cluster_is_that_of_one_process_also_when_a_worker_is_killed(samples, tmp_path):
    config = Config(
        bodies=(BlockSettings(name="wall", width=0.4, height=3.0),),
        models=ModelSettings(use=("sequence", "nonlinear")),
        search=SearchSettings(models=()),
    )
    rp.assess_files(str(samples), config, tmp_path / "here.h5", rp.BatchOptions(workers=1))
    with dask_cluster(tmp_path, workers=2) as (address, _, workers):

        def kill(desc):
            if desc == "assessing" and workers[0].poll() is None:
                workers[0].kill()
                workers[0].wait()

        options = rp.BatchOptions(scheduler=address, bar=bar_of(kill))
        rp.assess_files(str(samples), config, tmp_path / "there.h5", options)
        assert workers[0].returncode == -signal.SIGKILL
    here, there = rp.load(tmp_path / "here.h5"), rp.load(tmp_path / "there.h5")
    for group in ("summary", "half_cycles", "overturning_intervals", "failures", "records"):
        xr.testing.assert_identical(here[group].to_dataset(), there[group].to_dataset())


@pytest.mark.slow
@pytest.mark.usefixtures("needs_distributed")
def test_a_scheduler_that_dies_is_told_in_one_line(tmp_path):
    (tmp_path / "records").mkdir()
    for number in range(60):
        title = f"Event, 1/2/2003, Station {number}, 090"
        (tmp_path / "records" / f"r{number}.AT2").write_bytes(at2(pulse(4000, 0.2 + 0.01 * number), title=title))
    target = tmp_path / "results.h5"
    journal = tmp_path / "results.h5.journal"
    with dask_cluster(tmp_path, workers=1) as (address, scheduler, _):
        given = ["assess", tmp_path / "records", "--block", "w=0.4x3", "--scheduler", address, "-o", target]
        run = subprocess.Popen([sys.executable, "-m", "rockpulse", *given], stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 300.0
        while run.poll() is None and time.monotonic() < end:
            if journal.exists() and journal.stat().st_size > 20_000:
                break
            time.sleep(0.02)
        scheduler.kill()
        _, said = run.communicate(timeout=300)
    assert run.returncode == 2
    assert re.fullmatch(
        r"(rockpulse: assessing: 60 records\n)?rockpulse: (the dask scheduler at|the work was cancelled) .*\n", said
    )
    assert re.search(rf"\d+ finished records? (is|are) kept in {re.escape(str(journal))}: the same command with", said)
