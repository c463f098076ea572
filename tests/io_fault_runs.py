"""Runs with a fault in one step of input or output: ``io_fault_runs.py LIBRARY RECORDS PLACE FIRST EVERY``.

With the library of ``io_faults.c`` preloaded. Each run is a fork of this process, which has all modules and kernels.
For every step FIRST, FIRST + EVERY, ... the run is killed there, and in a second run the call fails, which is told in
words (exit code 2) or harms nothing; then the same command with ``--resume`` has to end in a file equal to that of an
undisturbed run, with nothing left beside it. A JSON document is printed: the number of steps of an undisturbed run, of
cases, and what went wrong.
"""

import ctypes
import json
import os
import shutil
import signal
import sys
from pathlib import Path

from file_contents import assert_contents, contents
from killed_run import in_a_fork

from rockpulse.cli import main


def run(library: str, records: Path, place: Path, first: int, every: int) -> dict[str, object]:
    """All cases."""
    faults = ctypes.CDLL(library)
    faults.io_calls.restype = ctypes.c_long
    faults.io_faults.argtypes = [ctypes.c_char_p, ctypes.c_long, ctypes.c_int]
    place.mkdir(exist_ok=True)

    def command(target: Path, *options: str) -> int:
        given = ["--config", str(records / "site.toml"), "--workers", "1", "--quiet", *options]
        return main(["assess", str(records), *given, "-o", str(target / "results.h5")])

    whole = place / "whole"
    whole.mkdir()
    faults.io_faults(os.fsencode(whole), 0, 0)
    assert command(whole) == 0
    steps = faults.io_calls()
    faults.io_faults(b"", 0, 0)
    expected = contents(whole / "results.h5")
    wrong, cases = [], 0

    def struck(target: Path, step: int, deadly: bool) -> int:
        faults.io_faults(os.fsencode(target), step, int(deadly))
        return command(target)

    def resumed(target: Path) -> int:
        code = command(target, "--resume")
        if not code:
            assert_contents(target / "results.h5", expected)
        return code

    for step in range(first, steps + 1, every):
        for deadly in (True, False):
            cases += 1
            target = place / f"{step}{'k' if deadly else 'f'}"
            target.mkdir()
            before, _ = in_a_fork(lambda: struck(target, step, deadly), whole)  # noqa: B023 - called at once
            left = sorted(one.name for one in target.iterdir())
            after, _ = in_a_fork(lambda: resumed(target), whole)  # noqa: B023 - called at once
            names = sorted(one.name for one in target.iterdir())
            ended_well = before in ((-signal.SIGKILL,) if deadly else (0, 2))
            if not ended_well or after or names != ["results.h5"]:
                wrong.append([step, "kill" if deadly else "fail", before, left, after, names])
            shutil.rmtree(target)
    return {"steps": steps, "cases": cases, "wrong": wrong}


if __name__ == "__main__":
    library, records, place, first, every = sys.argv[1:]
    print(json.dumps(run(library, Path(records), Path(place), int(first), int(every))))
