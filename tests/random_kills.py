"""Runs with two workers, killed at random moments and resumed: ``random_kills.py RECORDS PLACE COUNT SEED``.

Each run is a fork of this process, which has all modules and kernels, in a process group of its own. Half of them are
killed at a moment of the whole run, half at one after its first record was kept, in the time that an undisturbed run
takes. Nobody of the group may be left after that, and the same command with ``--resume`` has to end in a file equal to
that of an undisturbed run by ``rockpulse diff``, with nothing left beside it. A JSON document is printed: how many of
the runs were killed before their end, with how many records kept, and what went wrong.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sys
import time
from collections import Counter
from pathlib import Path

from io_fault_runs import in_a_fork

from rockpulse.cli import main
from rockpulse.run.frames import MARK

#: How long everybody of a group may take to end when one of it was killed [s].
PATIENCE = 60.0


def members(group: int) -> list[int]:
    """Process ids of a group that live, other than zombies."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text()
        except (FileNotFoundError, ProcessLookupError):
            continue  # it has ended meanwhile
        state, _, pgrp = text.rpartition(")")[2].split()[:3]
        if int(pgrp) == group and state != "Z":
            found.append(int(stat.parent.name))
    return found


def kept(target: Path) -> int:
    """How many records the journal of an output keeps; -1 where there is none."""
    journal = target / "results.h5.journal"
    try:
        return max(journal.read_bytes().count(MARK) - 1, 0)
    except FileNotFoundError:
        return -1


def begun(command) -> int:
    """The id of a fork of this process, and of its group, that gives a command."""
    child = os.fork()
    if not child:
        code = 99
        try:
            os.setsid()
            code = main(command)
        finally:
            os._exit(code)
    return child


def until(passed, child: int) -> float:
    """When something has happened, or the child has ended [s]."""
    while not passed() and os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
        time.sleep(0.002)
    return time.monotonic()


def run(records: Path, place: Path, count: int, seed: int) -> dict[str, object]:
    """All runs."""
    place.mkdir(exist_ok=True)

    def command(target: Path, *options: str) -> list[str]:
        given = ["--config", str(records / "site.toml"), "--quiet", *options]
        return ["assess", str(records), *given, "-o", str(target / "results.h5")]

    whole = place / "whole"
    whole.mkdir()
    assert main(command(whole, "--workers", "1")) == 0
    shutil.rmtree(whole)
    whole.mkdir()
    start = time.monotonic()
    child = begun(command(whole, "--workers", "2"))
    first = until(lambda: kept(whole) > 0, child) - start
    end = until(lambda: False, child) - start
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0

    draw, wrong, killed = random.Random(seed), [], Counter()
    for number in range(count):
        target = place / str(number)
        target.mkdir()
        child = begun(command(target, "--workers", "2"))
        if number % 2:
            until(lambda: kept(target) > 0, child)  # noqa: B023 - called at once
            moment = draw.uniform(0.0, end - first)
        else:
            moment = draw.uniform(0.0, end)
        time.sleep(moment)
        os.kill(child, signal.SIGKILL)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        late = time.monotonic() + PATIENCE
        while (orphans := members(child)) and time.monotonic() < late:
            time.sleep(0.02)
        if code:
            killed[kept(target)] += 1
        after = in_a_fork(lambda: main(command(target, "--workers", "1", "--resume")))  # noqa: B023 - as above
        names = sorted(one.name for one in target.iterdir())
        both = [str(whole / "results.h5"), str(target / "results.h5")]
        differs = in_a_fork(lambda: main(["diff", *both]))  # noqa: B023 - as above
        if code not in (0, -signal.SIGKILL) or orphans or after or differs or names != ["results.h5"]:
            wrong.append([number, moment, code, orphans, after, differs, names])
        shutil.rmtree(target)
    return {"seconds": end, "killed": sum(killed.values()), "kept": dict(sorted(killed.items())), "wrong": wrong}


if __name__ == "__main__":
    records, place, count, seed = sys.argv[1:]
    print(json.dumps(run(Path(records), Path(place), int(count), int(seed))))
