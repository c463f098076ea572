"""A batch of thousands of records, from files to one results file: ``python benchmarks/batch.py --records 5000``.

Synthetic records (with a seed; PEER AT2 files of 6,000 samples, 0.2 to 0.6 g, 20 earthquakes x stations) are assessed
by :func:`rockpulse.run.batch.assess_files`, each run in a new process. The output gives the records per second, the
memory of the parent process during the run, the time for reading, conditioning and writing compared with that of the
solvers, two workers compared with one, and the time of ``inspect``, ``export`` and ``diff``. In addition to the default
configuration, an inventory of ``--inventory`` bodies and a configuration with every model and its safety factors are
measured.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from record_writers import at2

from rocking.lanes import available_cores
from rockpulse import BlockSettings, ModelSettings, SearchSettings, SequenceSettings, UncertaintySettings
from rockpulse.cli import main as rockpulse
from rockpulse.config.configuration import Config
from rockpulse.model_table import ALL_MODELS
from rockpulse.run.batch import assess_files
from rockpulse.run.options import BatchOptions, BatchReport
from synthetic import synthetic_motion

SAMPLES = 6000
DT = 0.01  # s
GRAVITY = 9.80665  # m/s2
EVENTS = 20
#: Parts of the records after which the memory of the parent is noted.
MARKS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)


def write_record(number: int, folder: Path) -> None:
    """One record of the ensemble, the same wherever it is made."""
    peak = np.random.default_rng(number).uniform(0.2, 0.6)
    motion = synthetic_motion(number, (SAMPLES - 1) * DT, DT, peak * GRAVITY) / GRAVITY
    event, station = number % EVENTS, number // EVENTS
    title = f"Synthetic-{event:02d}, 1/{event + 1}/2003, Station {station:03d}, {90 * (number % 4)}"
    (folder / f"SYN{number:05d}.AT2").write_bytes(at2(motion, title=title))


def write_records(folder: Path, count: int) -> None:
    """The first records of the ensemble, those that are there already aside."""
    for number in range(count):
        if not (folder / f"SYN{number:05d}.AT2").exists():
            write_record(number, folder)


def configuration(blocks: int, everything: bool = False, inventory: bool = False) -> Config:
    """Blocks of 0.2 to 2 m, four to eight times as high, by default or by every model with its safety factors.

    An inventory uses the nonlinear model alone, and P from the spectrum of the record, so that the solver takes little.
    """
    sizes = np.random.default_rng(0).uniform(size=(blocks, 2))
    bodies = [
        BlockSettings(
            name=f"block {k:03d}", width=round(0.2 * 10.0**u, 3), height=round(0.2 * 10.0**u * (4 + 4 * v), 3)
        )
        for k, (u, v) in enumerate(sizes.tolist())
    ]
    if inventory:
        spectrum = UncertaintySettings(spectrum="all")
        return Config(models=ModelSettings(use=("nonlinear",)), uncertainty=spectrum, bodies=tuple(bodies))
    if not everything:
        return Config(bodies=tuple(bodies))
    return Config(
        models=ModelSettings(use=ALL_MODELS),
        sequence=SequenceSettings(method="statistics"),
        search=SearchSettings(intervals=True),
        uncertainty=UncertaintySettings(probability=False),
        bodies=tuple(bodies),
    )


def resident(line: str = "VmRSS") -> float:
    """Memory of this process [MB]; its largest so far for the line "VmHWM"."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(status.partition(f"{line}:")[2].split()[0]) / 1024.0


def processor_time() -> float:
    """Processor time of this process and of those that it has waited for [s]."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


@dataclass
class Watched:
    """What is seen of a run as its steps begin and end."""

    begun: float = field(default_factory=time.perf_counter)
    steps: dict[str, tuple[float, float]] = field(default_factory=dict)
    memory: dict[int, float] = field(default_factory=dict)  #: after so many percent of the records [MB]

    def bar(self, total: int, initial: int, desc: str, unit: str) -> Bar:
        """In place of a progress bar."""
        return Bar(self, desc, total)


@dataclass
class Bar:
    """Notes when a step begins and ends, and the memory meanwhile."""

    watched: Watched
    step: str
    total: int
    done: int = 0

    def __enter__(self) -> Self:
        self.start = time.perf_counter()
        self.note()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.watched.steps[self.step] = (self.start, time.perf_counter())

    def update(self, n: int) -> None:
        self.done += n
        self.note()

    def note(self) -> None:
        if self.step == "assessing" and self.done in {round(mark * self.total) for mark in MARKS}:
            self.watched.memory[round(100.0 * self.done / self.total)] = resident()


@dataclass(frozen=True)
class Run:
    """What one run has taken."""

    records: int
    size: float  #: of the results [MB]
    total: float  #: by the clock [s], kernels loaded
    processor: float  #: of this process and its workers, all threads [s]
    survey: float
    work: float
    assembly: float
    seconds: dict[str, float]  #: of the workers [s]
    memory: dict[int, float]  #: of the parent after so many percent of the records [MB]
    peak: float  #: of the parent [MB]

    @property
    def rate(self) -> float:
        """Records a second."""
        return self.records / self.total


def run(paths: list[str], config: Config, output: str, workers: int, scheduler: str | None = None) -> Run:
    """Assess the files in this process, which does nothing else, with workers of its own or those of a scheduler."""
    watched, begun = Watched(), processor_time()
    own = None if scheduler else workers
    options = BatchOptions(workers=own, scheduler=scheduler, overwrite=True, bar=watched.bar)
    report: BatchReport = assess_files(paths, config, output, options)
    end = time.perf_counter()
    (survey, surveyed), (_, worked) = watched.steps["reading"], watched.steps["assessing"]
    return Run(
        records=report.records,
        size=Path(output).stat().st_size / 1e6,
        total=end - survey,
        processor=processor_time() - begun,
        survey=surveyed - survey,
        work=worked - surveyed,
        assembly=end - worked,
        seconds=report.seconds,
        memory=watched.memory,
        peak=resident("VmHWM"),
    )


def fresh(function: Callable[..., Any], *arguments: object) -> Any:
    """Call the function in a process of its own."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as alone:
        return alone.submit(function, *arguments).result()


def told(one: Run, workers: int, what: str, blocks: int) -> None:
    """Print the figures of a run."""
    core = one.processor / one.records
    marks = ", ".join(f"{percent} % {memory:.0f}" for percent, memory in one.memory.items())
    steps = ", ".join(f"{step} {seconds:.1f}" for step, seconds in one.seconds.items())
    print(f"{workers} worker{'s' * (workers > 1)}, {what}: {one.rate:.1f} records/s; {one.size:.0f} MB of results")
    print(
        f"  {one.records} records in {one.total:.1f} s: survey {one.survey:.1f}, work {one.work:.1f}, assembly "
        f"{one.assembly:.1f}; in the work, of all workers: {steps}"
    )
    print(
        f"  {core:.2f} s of a core a record of {SAMPLES * DT:g} s, {1e9 * core / (SAMPLES * blocks):.1f} ns a sample "
        f"and body; 1000 records on two cores in {1000.0 * core / 120.0:.0f} minutes"
    )
    print(f"  memory of the parent [MB]: after {marks} of the records; peak {one.peak:.0f}", flush=True)
    if workers == 1:
        solve = one.seconds["solve"]
        print(f"  all but the solver: {(one.total - solve) / solve:.2f} times the solver", flush=True)


def looked_at(results: str, folder: Path) -> None:
    """Time of the verbs that look into the file, whole and in steps [s]."""
    calls = {
        "inspect": ["inspect", results],
        "inspect --worst 20": ["inspect", results, "--worst", "20"],
        "inspect --outcome overturns --sort safety_factor": [
            *("inspect", results, "--outcome", "overturns", "--sort", "safety_factor", "--limit", "20")
        ],
        "export --limit 1000": ["export", results, "-o", str(folder / "table.csv"), "--limit", "1000", "--overwrite"],
        "diff with itself": ["diff", results, results],
        "verify --no-inputs": ["verify", results, "--no-inputs"],
    }
    for name, arguments in calls.items():
        times = []
        for _ in range(2):  # the first one imports
            start = time.perf_counter()
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                code = rockpulse(arguments)
            times.append(time.perf_counter() - start)
        print(f"{name}: {times[1]:.2f} s (first call, with imports {times[0]:.2f} s), exit code {code}", flush=True)


def calibrated(paths: list[str], output: str) -> None:
    """Print the time of ``rockpulse calibrate`` on two workers, for a record."""
    start, begun = time.perf_counter(), processor_time()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        code = rockpulse(["calibrate", *paths, "-o", output, "--workers", "2", "--overwrite"])
    wall, core = (time.perf_counter() - start) / len(paths), (processor_time() - begun) / len(paths)
    print(
        f"calibrate, two workers: {core:.2f} s of a core a record of {SAMPLES * DT:g} s, their start included; 1000 "
        f"records in {1000.0 * wall:.0f} s, exit code {code}",
        flush=True,
    )


def many_bodies(path: str, output: str) -> None:
    """Print the time of one record on many bodies, which share their marches or not, from its file to the results."""
    for count, spectrum in ((100, "none"), (100, "all"), (100, "auto"), (1_000, "auto"), (10_000, "auto")):
        config = replace(configuration(count), uncertainty=UncertaintySettings(spectrum=spectrum))
        times = []
        for _ in range(6):
            start, begun = time.perf_counter(), processor_time()
            assess_files(path, config, output, BatchOptions(overwrite=True))
            times.append((time.perf_counter() - start, processor_time() - begun))
        wall, core = np.median(times[1:], axis=0)
        print(f"one record, {count} bodies, spectrum = {spectrum}: {wall:.2f} s, {core:.2f} s of a core", flush=True)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=5000)
    parser.add_argument("--blocks", type=int, default=100)
    parser.add_argument("--workers", type=int, default=min(2, available_cores()), help="of the run on all records")
    parser.add_argument("--compare", type=int, default=300, help="records of the runs with one worker and with two")
    parser.add_argument("--inventory", type=int, default=10_000, help="bodies of a large inventory, on --few records")
    parser.add_argument("--few", type=int, default=10, help="records of the large inventory, and of every model")
    parser.add_argument("--folder", type=Path, help="where files and results go, and stay")
    parser.add_argument("--bodies", action="store_true", help="one record on 100, 1,000 and 10,000 bodies instead")
    args = parser.parse_args()
    with contextlib.ExitStack() as left:
        folder = args.folder or Path(left.enter_context(tempfile.TemporaryDirectory()))
        (folder / "records").mkdir(parents=True, exist_ok=True)
        if args.bodies:
            write_record(7, folder / "records")
            many_bodies(str(folder / "records"), str(folder / "bodies.h5"))
            return
        start = time.perf_counter()
        write_records(folder / "records", args.records)
        print(f"{args.records} files: {time.perf_counter() - start:.0f} s; load {os.getloadavg()[0]:.1f}", flush=True)
        paths = [str(folder / "records" / f"SYN{number:05d}.AT2") for number in range(args.records)]
        config = configuration(args.blocks)
        some = paths[: args.compare]
        fresh(run, some[:4], config, str(folder / "warm.h5"), 1)  # compiles the kernels
        runs = {workers: fresh(run, some, config, str(folder / f"{workers}.h5"), workers) for workers in (1, 2)}
        for workers, one in runs.items():
            told(one, workers, f"{args.blocks} bodies", args.blocks)
        print(
            f"two workers against one: {runs[1].total / runs[2].total:.2f} times as fast, their start included "
            f"({runs[1].work / runs[2].work:.2f} in the work alone); load {os.getloadavg()[0]:.1f}",
            flush=True,
        )
        few = paths[: args.few]
        for what, blocks, other in (
            (f"{args.inventory} bodies", args.inventory, configuration(args.inventory, inventory=True)),
            (f"{args.blocks} bodies, every model and safety factor", args.blocks, configuration(args.blocks, True)),
        ):
            told(fresh(run, few, other, str(folder / "other.h5"), 1), 1, what, blocks)
        fresh(calibrated, some, str(folder / "design.h5"))
        results = str(folder / "results.h5")
        told(fresh(run, paths, config, results, args.workers), args.workers, "all records", args.blocks)
        looked_at(results, folder)


if __name__ == "__main__":
    main()
