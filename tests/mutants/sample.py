"""Change one operator or constant at a time, and see whether the module's own tests notice: ``make mutants``.

A sample is drawn from the mutants of the modules below, each is run against the tests of its module, and those that
survive are told with their change. A test is written for a survivor, the code that it changes is taken away as
needless, or it is named in equivalent.toml with the reason why the program does the same. The command fails on a
survivor that is not named there, and on a name there that fits no mutant or one that dies.

The tests of a module are those of its mirror, tests/.../test_<module>.py, and those that tests.toml adds to it or to
its folder. The draw depends on the seed and on each mutant alone, so that it stays the same where other lines change.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path

from mutants import TOP, Mutant, mutants_of
from trial import run

HERE = Path(__file__).parent
MODULES = (
    *(f"pipeline/rockpulse/{room}/**/*.py" for room in ("record", "readers", "calibration", "assessment")),
    "pipeline/rockpulse/studies/fragility/*.py",
    "pipeline/rockpulse/views/report/statements.py",
    "pipeline/rockpulse/run/tasks.py",
    "models/rocking/*.py",
)
PICTURES = ("models/rocking/*_picture.py", "models/rocking/svg_lines.py")
ADDED = tomllib.loads((HERE / "tests.toml").read_text())

#: Time that a mutant gets: this, or as many times the time that the tests take without it, and what these may take [s].
SHORTEST, TIMES, LONGEST = 20.0, 3.0, 600.0


def tests_of(module: str) -> list[str]:
    """Test files of a module, as paths below the top folder."""
    below = Path(module).relative_to("models/rocking" if module.startswith("models") else "pipeline/rockpulse")
    folder = "tests/models" if module.startswith("models") else "tests/pipeline"
    mirror = Path(folder, below.parent, f"test_{below.name}").as_posix()
    added = [test for place, tests in ADDED.items() if module.startswith(place) for test in tests]
    return [*([mirror] if (TOP / mirror).is_file() else []), *added]


@cache
def limit_of(tests: tuple[str, ...]) -> float:
    """The time that a mutant gets in these tests [s]; ends the command where they fail without one."""
    fate, seconds = run(list(tests), LONGEST, "", "")
    if fate != "survived":
        sys.exit(f"these tests fail on the sources as they are: {' '.join(tests)}")
    return max(SHORTEST, TIMES * seconds)


def shuffled(seed: int, only: str) -> list[Mutant]:
    """Every mutant, in the order of their digests: the first of them are the sample."""
    paths = {path for pattern in MODULES for path in TOP.glob(pattern) if not any(map(path.match, PICTURES))}
    modules = sorted(path.relative_to(TOP).as_posix() for path in paths)
    every = [one for module in modules if only in module for one in mutants_of(module)]
    print(f"{len(every)} mutants in {len(modules)} modules")
    return sorted(every, key=lambda one: hashlib.sha256(f"{seed} {one.key}".encode()).digest())


def main() -> int:
    """Run the sample; 0 if every survivor is named as equivalent."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=400, help="mutants drawn (400)")
    parser.add_argument("--skip", type=int, default=0, help="leave out the first of them: the sample in parts (0)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--only", default="", metavar="TEXT", help="modules whose path has this text")
    given = parser.parse_args()
    listed = {
        (one["module"], one["line"], one["operator"], one["occurrence"]): one["reason"]
        for one in tomllib.loads((HERE / "equivalent.toml").read_text())["mutant"]
    }
    every = shuffled(given.seed, given.only)
    stale = {key for key in listed if given.only in key[0]} - {one.key for one in every}
    for key in sorted(stale):
        print(f"equivalent.toml names what is no mutant: {', '.join(map(str, key))}")
    counts, wrong = Counter[str](), len(stale)
    for number, one in enumerate(every[given.skip : given.count], given.skip + 1):
        tests = tests_of(one.module)
        fate = "untested"
        if tests:
            limit = limit_of(tuple(tests))
            with tempfile.TemporaryDirectory() as folder:
                mutant = Path(folder, "mutant.py")
                mutant.write_text(one.text())
                fate, _ = run(tests, limit, str(TOP / one.module), str(mutant))
        if fate == "survived" and one.key in listed:
            fate = "equivalent"
        counts[fate] += 1
        wrong += fate in ("survived", "untested") or (one.key in listed and fate != "equivalent")
        print(f"{number:4} {fate:10} {one.module}:{one.number} {one.operator} {one.occurrence}", flush=True)
        if fate in ("survived", "untested") or one.key in listed:
            print(f"       - {one.line}\n       + {one.changed_line()}", flush=True)
    print(", ".join(f"{count} {fate}" for fate, count in sorted(counts.items())))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
