"""Runs that are killed, interrupted or cut off, and resumed: the results are those of an undisturbed run."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from batch_runs import records_in
from file_contents import assert_contents, contents
from killed_run import in_a_fork, run
from record_writers import at2, pulse

from rockpulse.cli import main
from rockpulse.run.journal import journal_path

TESTS = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Six good records, a damaged one, and a configuration."""
    folder = records_in(tmp_path_factory.mktemp("killed"), 6)
    (folder / "cut.at2").write_bytes(at2(pulse(400, 0.3), title="Event, 1/2/2003, Cut, 090")[:900])
    return folder


@pytest.fixture(scope="module")
def undisturbed(folder, tmp_path_factory):
    """What comes of an assessment when nothing happens."""
    target = tmp_path_factory.mktemp("undisturbed") / "results.h5"
    assert main(command(folder, target, "--workers", "1")) == 1  # one file is damaged
    return contents(target)


@pytest.fixture
def target(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out" / "results.h5"


def command(folder, target, *options):
    return ["assess", str(folder), "--config", str(folder / "site.toml"), "-o", str(target), "--quiet", *options]


def struck(folder, target, point, number, workers=1):
    """Exit code and messages of a run that is struck at a point.

    A run with one worker is a fork of this process. One with more is in a process group of its own, as a terminal
    starts one, and no process of the group is left.
    """
    given = command(folder, target, "--workers", str(workers))
    if workers == 1:
        return in_a_fork(lambda: run(point, number, given), target)
    arguments = [sys.executable, TESTS / "killed_run.py", point, str(number), *given]
    process = subprocess.Popen(arguments, start_new_session=True, text=True, stderr=subprocess.PIPE)
    _, said = process.communicate(timeout=300)
    end = time.monotonic() + 300.0
    while members(process.pid) and time.monotonic() < end:
        time.sleep(0.05)
    assert members(process.pid) == []
    return process.returncode, said


def members(group):
    """Process ids of a group that live, other than zombies."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text()
        except (FileNotFoundError, ProcessLookupError):
            continue  # it has ended meanwhile
        state, _, own = text.rpartition(")")[2].split()[:3]
        if int(own) == group and state != "Z":
            found.append(int(stat.parent.name))
    return found


def assert_resumed(folder, target, undisturbed, *options):
    """The same command with --resume completes the run and leaves the results alone in their folder."""
    assert main(command(folder, target, "--resume", *options)) == 1
    assert_contents(target, undisturbed)
    assert [path.name for path in target.parent.iterdir()] == [target.name]


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.sweep), pytest.param(2, marks=pytest.mark.slow)])
def test_a_run_killed_between_two_records_goes_on_with_what_is_missing(folder, target, tmp_path, undisturbed, workers):
    log = tmp_path / "log"
    assert struck(folder, target, "record", 3, workers)[0] == -signal.SIGKILL
    assert not target.exists()
    assert_resumed(folder, target, undisturbed, "--workers", "1", "--log-file", str(log))
    assert "assessing 3 records; finished before: 3, to be repeated: 0" in log.read_text()


# A kill in the middle of the assembly itself: test_assembly.py.
POINTS = [
    pytest.param("rename", 1, marks=pytest.mark.sweep),
    pytest.param("assembly", 40, marks=pytest.mark.slow),
    pytest.param("renamed", 1, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("point", "number"), POINTS)
def test_a_run_killed_while_it_writes_the_results_goes_on(folder, target, undisturbed, point, number):
    assert struck(folder, target, point, number)[0] == -signal.SIGKILL
    assert journal_path(target).exists()
    assert target.exists() == (point == "renamed")
    assert_resumed(folder, target, undisturbed, "--workers", "1")


INTERRUPTIONS = [
    pytest.param("interrupt", 1, marks=pytest.mark.sweep),
    pytest.param("interrupt", 2, marks=pytest.mark.slow),
    pytest.param("terminate", 1, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("point", "workers"), INTERRUPTIONS)
def test_an_interrupted_run_says_how_to_go_on(folder, target, undisturbed, point, workers):
    code, said = struck(folder, target, point, 2, workers)
    assert code == 130
    assert re.fullmatch(
        r"rockpulse: interrupted; [2-6] finished records are kept in .*results.h5.journal: the same command with "
        r"--resume continues from there\n",
        said,
    )
    assert not target.exists()
    assert_resumed(folder, target, undisturbed, "--workers", "1")


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
    (tmp_path / "records").mkdir()
    return records_in(tmp_path / "records", 10)


@pytest.mark.parametrize(
    ("first", "every"), [pytest.param(7, 400, marks=pytest.mark.sweep), pytest.param(1, 1, marks=pytest.mark.slow)]
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
