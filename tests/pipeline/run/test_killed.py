"""Runs that are killed, interrupted or cut off, and resumed: the results are those of an undisturbed run."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from file_contents import assert_contents, contents
from random_kills import members
from record_writers import at2, pulse

from rockpulse.cli import main
from rockpulse.run import journal as file_lock
from rockpulse.run.frames import unpack
from rockpulse.run.journal import Journal, journal_path

TESTS = Path(__file__).parents[2]
RECORDS = 6
CONFIGURATION = """
[models]
use = ["sequence", "linear"]
[search]
models = ["sequence"]
points = 16
[fragility]
data = "ida"
factors = [0.01, 100.0]
limit_states = [0.4, "overturning"]
measures = ["pga", "velocity_ratio"]
[[block]]
name = "wall"
width = 0.4
height = 3.0
[[block]]
name = "pier"
width = 1.0
height = 3.0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Six good records, a damaged one, and a configuration."""
    folder = tmp_path_factory.mktemp("killed")
    for number in range(RECORDS):
        peak = 0.2 + 0.05 * number
        (folder / f"r{number}.at2").write_bytes(at2(pulse(400, peak), title=f"Event, 1/2/2003, Station {number}, 090"))
    (folder / "cut.at2").write_bytes(at2(pulse(400, 0.3), title="Event, 1/2/2003, Cut, 090")[:900])
    (folder / "site.toml").write_text(CONFIGURATION)
    return folder


def alone(verb, folder, target):
    """What comes of it when nothing happens."""
    assert main(command(folder, target, "--workers", "1", verb=verb)) == 1  # one file is damaged
    return contents(target)


@pytest.fixture(scope="module")
def undisturbed(folder, tmp_path_factory):
    """What comes of an assessment when nothing happens."""
    return alone("assess", folder, tmp_path_factory.mktemp("undisturbed") / "results.h5")


def command(folder, target, *options, verb="assess"):
    return [verb, str(folder), "--config", str(folder / "site.toml"), "-o", str(target), "--quiet", *options]


def start(folder, target, point, number, *options, verb="assess", **settings):
    """The run in a process group of its own, as a terminal starts one."""
    given = command(folder, target, *options, verb=verb)
    arguments = [sys.executable, TESTS / "killed_run.py", point, str(number), *given]
    return subprocess.Popen(arguments, start_new_session=True, text=True, stderr=subprocess.PIPE, **settings)


def assert_nobody_is_left(group, seconds=300.0):
    end = time.monotonic() + seconds
    while members(group) and time.monotonic() < end:
        time.sleep(0.05)
    assert members(group) == []


def assert_resumed(folder, target, undisturbed, *options, verb="assess"):
    """The same command with --resume completes the run and leaves the results alone in their folder."""
    assert main(command(folder, target, "--resume", *options, verb=verb)) == 1
    assert_contents(target, undisturbed)
    assert [path.name for path in target.parent.iterdir()] == [target.name]


@pytest.mark.sweep
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_run_killed_between_two_records_goes_on_with_what_is_missing(folder, tmp_path, undisturbed, workers):
    target, log = tmp_path / "out" / "results.h5", tmp_path / "log"
    target.parent.mkdir()
    process = start(folder, target, "record", 3, "--workers", str(workers))
    assert process.wait(300) == -signal.SIGKILL
    process.stderr.close()
    assert_nobody_is_left(process.pid)
    assert not target.exists()
    assert_resumed(folder, target, undisturbed, "--workers", "1", "--log-file", str(log))
    assert "assessing 3 records; finished before: 3, of another state: 0" in log.read_text()


@pytest.mark.sweep
@pytest.mark.parametrize("workers", [1, 2])
def test_fragility_that_was_killed_goes_on_with_what_is_missing(folder, tmp_path, workers):
    (tmp_path / "out").mkdir()
    target, log = tmp_path / "out" / "fragility.h5", tmp_path / "log"
    process = start(folder, target, "record", 3, "--workers", str(workers), verb="fragility")
    assert process.wait(300) == -signal.SIGKILL
    process.stderr.close()
    assert_nobody_is_left(process.pid)
    assert not target.exists()
    with Journal.open(target, resume=True) as kept:
        parts = [part for key in kept.finished() for part in kept.parts(key)]
        assert len(parts) == 3
        assert all({"record", "factors", "measures"} < set(unpack(part)) for part in parts)  # arrays, no pickle
    expected = alone("fragility", folder, tmp_path / "alone.h5")
    assert_resumed(folder, target, expected, "--workers", str(workers), "--log-file", str(log), verb="fragility")
    assert "scaling 3 records; finished before: 3, of another state: 0" in log.read_text()


# A kill in the middle of the assembly itself: test_assembly.py.
POINTS = [
    pytest.param("rename", 1, marks=pytest.mark.sweep),
    pytest.param("assembly", 40, marks=pytest.mark.slow),
    pytest.param("renamed", 1, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("point", "number"), POINTS)
def test_a_run_killed_while_it_writes_the_results_goes_on(folder, tmp_path, undisturbed, point, number):
    target = tmp_path / "results.h5"
    process = start(folder, target, point, number, "--workers", "1")
    assert process.wait(300) == -signal.SIGKILL
    process.stderr.close()
    assert journal_path(target).exists()
    assert target.exists() == (point == "renamed")
    assert_resumed(folder, target, undisturbed, "--workers", "1")


INTERRUPTIONS = [
    pytest.param("interrupt", 1, marks=pytest.mark.sweep),
    pytest.param("interrupt", 2, marks=pytest.mark.slow),
    pytest.param("terminate", 1, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("point", "workers"), INTERRUPTIONS)
def test_an_interrupted_run_says_how_to_go_on(folder, tmp_path, undisturbed, point, workers):
    target = tmp_path / "results.h5"
    process = start(folder, target, point, 2, "--workers", str(workers))
    assert process.wait(300) == 130
    said = process.stderr.read()
    process.stderr.close()
    assert re.fullmatch(
        r"rockpulse: interrupted; [2-6] finished records are kept in .*results.h5.journal: the same command with "
        r"--resume goes on from there\n",
        said,
    )
    assert_nobody_is_left(process.pid)
    assert not target.exists()
    assert_resumed(folder, target, undisturbed, "--workers", "1")


def kill_a_worker(folder, target, seconds):
    """Run with two workers, one of which is killed when it has worked so long on records; whether it came to that."""
    log = target.with_suffix(".log")
    process = start(folder, target, "record", 1000, "--workers", "2", "--log-file", str(log))
    while process.poll() is None and not (log.is_file() and "INFO assessing" in log.read_text()):
        time.sleep(0.01)
    begun = {one: spent(one) for one in members(process.pid) if is_worker(one)}
    busy = []
    while process.poll() is None and not busy:
        busy = [one for one, before in begun.items() if spent(one) - before >= seconds]
        time.sleep(0.01)
    if busy and process.poll() is None:
        os.kill(busy[0], signal.SIGKILL)
    code = process.wait(300)
    process.stderr.close()
    assert code == 1  # as ever: one file is damaged
    return bool(busy)


def is_worker(process):
    try:
        return "spawn_main" in Path(f"/proc/{process}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def spent(process):
    """Time of the processor that a process has had [s]; none when it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except (FileNotFoundError, ProcessLookupError):
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.sweep
def test_a_worker_that_is_killed_at_work_changes_nothing(folder, tmp_path, undisturbed):
    target = tmp_path / "results.h5"
    assert kill_a_worker(folder, target, 0.1)
    assert_contents(target, undisturbed)


@pytest.mark.slow
def test_twenty_killed_workers_change_nothing(folder, tmp_path, undisturbed):
    draw = np.random.default_rng(0)
    killed = runs = 0
    while killed < 20:
        runs += 1
        assert runs <= 60
        target = tmp_path / f"{runs}.h5"
        killed += kill_a_worker(folder, target, draw.uniform(0.0, 1.5))
        assert_contents(target, undisturbed)


def kill_slowly(folder, tmp_path, undisturbed, point, numbers, workers):
    """How often the kill came before the end."""
    kills = 0
    for count, number in enumerate(numbers):
        target = tmp_path / f"{count}" / "results.h5"
        target.parent.mkdir()
        process = start(folder, target, point, number, "--workers", str(workers))
        code = process.wait(300)
        process.stderr.close()
        assert_nobody_is_left(process.pid)
        if code == 1:  # it was done before the moment came
            assert_contents(target, undisturbed)
        else:
            assert code == -signal.SIGKILL
            kills += 1
            assert_resumed(folder, target, undisturbed, "--workers", "1")
    return kills


def milliseconds(folder, target, workers):
    """How long a run takes that nobody kills."""
    began = time.monotonic()
    process = start(folder, target, "record", 1000, "--workers", str(workers))
    assert process.wait(300) == 1
    process.stderr.close()
    return 1000 * (time.monotonic() - began)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("point", ["record", "assembly", "rename", "renamed", "moment"])
def test_twenty_kills_of_the_parent(folder, tmp_path, undisturbed, point, workers):
    draw = np.random.default_rng([workers, len(point)])
    numbers = {
        "record": 1 + draw.integers(RECORDS, size=10),
        "assembly": 1 + draw.integers(70, size=10),
        "rename": [1] * 10,
        "renamed": [1] * 10,
        "moment": [],
    }[point]
    if point == "moment":
        whole = milliseconds(folder, tmp_path / "whole.h5", workers)
        numbers = draw.integers(int(0.3 * whole), int(0.95 * whole), size=10)
    assert kill_slowly(folder, tmp_path, undisturbed, point, numbers, workers) >= 7


def test_a_second_run_on_the_same_output_is_refused(folder, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(file_lock, "PATIENCE", 0.01)
    target = tmp_path / "results.h5"
    with Journal.open(target):
        assert main(command(folder, target)) == 2
        assert f"process {os.getpid()} is writing this output" in capsys.readouterr().err
        assert main(command(folder, target, "--resume")) == 2
        assert main(command(folder, target, "--overwrite")) == 2


@pytest.fixture(scope="module")
def faults(tmp_path_factory):
    """The library that strikes at a step of input and output."""
    if shutil.which("cc") is None or not sys.platform.startswith("linux"):
        pytest.skip("needs Linux and a C compiler")
    library = tmp_path_factory.mktemp("faults") / "io_faults.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, TESTS / "io_faults.c", "-ldl"], check=True)
    return library


@pytest.fixture
def ten_records(tmp_path):
    """A folder of ten records and a configuration."""
    records = tmp_path / "records"
    records.mkdir()
    for number in range(10):
        title = f"Event, 1/2/2003, Station {number}, 090"
        (records / f"r{number}.at2").write_bytes(at2(pulse(400, 0.2 + 0.03 * number), title=title))
    (records / "site.toml").write_text(CONFIGURATION)
    return records


@pytest.mark.parametrize(
    ("first", "every"), [pytest.param(7, 40, marks=pytest.mark.sweep), pytest.param(1, 1, marks=pytest.mark.slow)]
)
def test_a_run_struck_at_a_step_of_input_or_output_resumes_to_the_same_file(
    faults, ten_records, tmp_path, first, every
):
    """Killed at each of them, and with each of them failing as on a full disk, for a run of ten records."""
    arguments = [
        sys.executable,
        TESTS / "io_fault_runs.py",
        faults,
        ten_records,
        tmp_path / "runs",
        str(first),
        str(every),
    ]
    done = subprocess.run(
        arguments, env=os.environ | {"LD_PRELOAD": str(faults)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    print(f"{found['cases']} runs of {found['steps']} steps")
    assert found["steps"] > 100
    assert found["cases"] == 2 * len(range(first, found["steps"] + 1, every))
    assert found["wrong"] == [], done.stderr[-3000:]


@pytest.mark.slow
def test_two_hundred_kills_at_random_moments_with_two_workers(ten_records, tmp_path):
    arguments = [sys.executable, TESTS / "random_kills.py", ten_records, tmp_path / "runs", "200", "1"]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    print(f"{found['killed']} killed before their end, in {found['seconds']:.1f} s; by records kept: {found['kept']}")
    assert found["killed"] >= 140
    assert found["wrong"] == [], done.stderr[-3000:]
