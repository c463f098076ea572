"""One run of pytest in a copy of this process: a mutant costs its tests, not another import of numpy and numba."""

import os
import resource
import runpy
import signal
import sys
from pathlib import Path

import hypothesis  # noqa: F401
import numba  # noqa: F401
import obspy  # noqa: F401
import pytest
import scipy.optimize
import scipy.signal
import scipy.stats  # noqa: F401
import xarray  # noqa: F401
from mutants import TOP

HERE = Path(__file__).parent
SOURCES = [str(TOP / "pipeline"), str(TOP / "models")]

#: Time on the clock for each second of the processor that a run is given: others may keep it busy.
PATIENCE = 15


def run(tests: list[str], marked: str, limit: float, mutated: str, mutant: str) -> tuple[str, float]:
    """Whether tests see a module read from another file: "died", "survived" or "timed out"; and the time they took.

    Of the tests those run that are `marked`, a marker expression of pytest. Time and limit are those of the processor
    [s]; a run that waits for something ends, too.
    """
    child = os.fork()
    if child == 0:
        signal.alarm(round(PATIENCE * limit))
        resource.setrlimit(resource.RLIMIT_CPU, (round(limit), resource.RLIM_INFINITY))
        os.environ.update(MUTATED=mutated, MUTANT=mutant, PYTHONPATH=os.pathsep.join([str(HERE), *SOURCES]))
        sys.path[:0] = SOURCES
        os.chdir(TOP)
        silence = os.open(os.devnull, os.O_WRONLY)
        for stream in (1, 2):
            os.dup2(silence, stream)
        runpy.run_path(str(HERE / "sitecustomize.py"))
        options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", "-m", marked]
        ended = pytest.main([*options, *tests])
        os._exit(0 if ended == pytest.ExitCode.NO_TESTS_COLLECTED else ended)
    _, status, used = os.wait4(child, 0)
    ended_by_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGALRM)
    fate = "timed out" if ended_by_time else "survived" if status == 0 else "died"
    return fate, used.ru_utime + used.ru_stime
