"""Change one operator or constant at a time, and see whether the module's own tests notice: ``make mutants``.

A sample is drawn from the mutants of the modules below, and each is run against the tests of its module. Survivors are
listed with their change: for each a test is written, or the code that it changes is taken away as needless, unless the
program does the same with it. The command fails where a smaller share is noticed than is asked for.

The tests of a module are those of its mirror, tests/.../test_<module>.py, the files in the folder of the mirror (for
models anywhere in tests/models) that import from the module, and those that tests.toml adds to it or to its folder. A
mutant that survives their default tests is run against all default tests of its room, the folder directly below
tests/pipeline, or of tests/models, and then against the sweeps of its own tests. A room takes 1 to 12 s, that of run
takes a minute and is left out. The draw depends on the seed and on each mutant alone, so that it stays the same where
other lines change.
"""

import argparse
import ast
import hashlib
import multiprocessing
import os
import resource
import runpy
import signal
import sys
import tempfile
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path

import hypothesis  # noqa: F401 - loaded once: a mutant costs its tests, not another import of numpy and numba
import numba  # noqa: F401
import obspy  # noqa: F401
import pytest
import scipy.optimize
import scipy.signal
import scipy.stats  # noqa: F401
import xarray  # noqa: F401
from mutants import TOP, Mutant, mutants_of

HERE = Path(__file__).parent
MODULES = (
    *(f"pipeline/rockpulse/{room}/**/*.py" for room in ("record", "readers", "sequences", "assessment")),
    "pipeline/rockpulse/studies/fragility/**/*.py",
    "pipeline/rockpulse/views/report/verdict.py",
    "pipeline/rockpulse/run/tasks.py",
    "models/rocking/**/*.py",
)
PICTURES = ("models/rocking/pictures.py",)
ADDED = tomllib.loads((HERE / "tests.toml").read_text())

#: The default tests, and those that .ci/run adds to them.
DEFAULT, SWEEP = "not slow and not sweep", "sweep and not slow"
#: A room whose tests take longer than all others together.
LONG_ROOM = "tests/pipeline/run"

#: Time that a mutant gets: this, or as many times the time of its tests without it, and what a test file may take [s].
SHORTEST, TIMES, LONGEST = 20.0, 3.0, 600.0
#: Time on the clock for each second of the processor that a run is given: others may keep it busy.
PATIENCE = 15
SOURCES = [str(TOP / "pipeline"), str(TOP / "models")]


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


def tests_of(module: str) -> list[str]:
    """Test files of a module, as paths below the top folder, its mirror first."""
    top, tests = (
        ("models/rocking", "tests/models") if module.startswith("models") else ("pipeline/rockpulse", "tests/pipeline")
    )
    below = Path(module).relative_to(top)
    mirror = TOP / tests / below.parent / f"test_{below.name}"
    folder = TOP / tests if module.startswith("models") else mirror.parent
    beside = [path for path in sorted(folder.rglob("test_*.py")) if path != mirror and dotted(module) in imported(path)]
    found = [path.relative_to(TOP).as_posix() for path in [*([mirror] if mirror.is_file() else []), *beside]]
    added = [test for place, tests in ADDED.items() if module.startswith(place) for test in tests]
    return [*found, *(test for test in dict.fromkeys(added) if test.partition("::")[0] not in found)]


def room_of(module: str) -> list[str]:
    """The folder of all tests of a module's room; none for the room that takes too long."""
    room = "tests/models" if module.startswith("models") else f"tests/pipeline/{Path(module).parts[2]}"
    return [room] if room != LONG_ROOM else []


def dotted(module: str) -> str:
    """The name by which a module is imported."""
    return ".".join(Path(module).with_suffix("").parts[1:]).removesuffix(".__init__")


@cache
def imported(path: Path) -> frozenset[str]:
    """The dotted names of all that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{one.name}" for one in node.names)}
    return frozenset(found)


@cache
def seconds_of(test: str, marked: str) -> float:
    """The time that a test file takes without a mutant [s]; RuntimeError if it fails."""
    fate, seconds = run([test], marked, LONGEST, "", "")
    if fate != "survived":
        raise RuntimeError(f"these tests fail on the sources as they are: {test}")
    return seconds


def fate_of(mutant: Mutant) -> str:
    """What becomes of a mutant under the tests of its module, of its room, and the sweeps, until one of them fails."""
    tests, fate = tests_of(mutant.module), "untested"
    with tempfile.TemporaryDirectory() as folder:
        changed = Path(folder, "mutant.py")
        changed.write_text(mutant.text())
        for asked, marked in ((tests, DEFAULT), (room_of(mutant.module), DEFAULT), (tests, SWEEP)):
            if not asked:
                continue
            limit = max(SHORTEST, TIMES * sum(seconds_of(test, marked) for test in asked))
            fate, _ = run(asked, marked, limit, str(TOP / mutant.module), str(changed))
            if fate != "survived":
                break
    return fate


def shuffled(seed: int, only: str) -> list[Mutant]:
    """Every mutant, in the order of their digests: the first of them are the sample."""
    paths = {path for pattern in MODULES for path in TOP.glob(pattern) if not any(map(path.match, PICTURES))}
    modules = sorted(path.relative_to(TOP).as_posix() for path in paths)
    every = [one for module in modules if only in module for one in mutants_of(module)]
    print(f"{len(every)} mutants in {len(modules)} modules")
    return sorted(every, key=lambda one: hashlib.sha256(f"{seed} {one.key}".encode()).digest())


def main() -> int:
    """Run the sample; 0 where the share that is noticed is large enough."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=400, help="mutants drawn (400)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--only", default="", metavar="TEXT", help="modules whose path has this text")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="mutants at a time (one a core)")
    parser.add_argument("--least", type=float, default=0.9, help="smallest share that the tests have to notice (0.90)")
    given = parser.parse_args()
    counts = Counter[str]()
    drawn = shuffled(given.seed, given.only)[: given.count]
    with multiprocessing.get_context("fork").Pool(given.workers) as pool:
        for number, (one, fate) in enumerate(zip(drawn, pool.imap(fate_of, drawn), strict=True), 1):
            counts[fate] += 1
            print(f"{number:4} {fate:10} {one.module}:{one.number} {one.operator} {one.occurrence}", flush=True)
            if fate in ("survived", "untested"):
                print(f"       - {one.line}\n       + {one.text().splitlines()[one.number - 1].strip()}", flush=True)
    share = (counts["died"] + counts["timed out"]) / max(counts.total(), 1)
    print(
        f"{', '.join(f'{count} {fate}' for fate, count in sorted(counts.items()))}: {100.0 * share:.1f} % are noticed"
    )
    return int(share < given.least)


if __name__ == "__main__":
    sys.exit(main())
