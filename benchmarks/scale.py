"""Run time per record for 1,000 to 100,000 short records: ``python benchmarks/scale.py``.

Synthetic records of ``--seconds`` (with a seed; PEER AT2 files, 0.2 to 0.6 g, earthquakes of 20 stations) are assessed
for three bodies by the nonlinear model alone, and only the results are stored. The solvers take little time, so the
output shows the cost of everything else: survey, plan, journal, assembly and, with dask, the scheduler. Each run is a
separate process. The output gives the rates, the steps, the memory of the parent process and its slope, and an estimate
for ``--cores`` cores.
"""

import argparse
import contextlib
import tempfile
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from batch import Run, fresh, run
from record_writers import at2

from rockpulse import BlockSettings, Config, ModelSettings, RecordSettings, UncertaintySettings
from synthetic import synthetic_motion

DT = 0.02  # s
#: Synthetic motions; every record is the sum of two of them, so that none is a scaled copy of another.
SHAPES = 500
STATIONS = 20  # of an event


def write_records(first: int, folder: Path, last: int, seconds: float) -> None:
    """Records first to last, a folder for each thousand of them."""
    shapes = [synthetic_motion(number, seconds, DT, 1.0) for number in range(min(SHAPES, last))]
    for number in range(first, last):
        home = folder / f"{number // 1000:03d}"
        home.mkdir(parents=True, exist_ok=True)
        peak = np.random.default_rng(number).uniform(0.2, 0.6)
        event, station = number // STATIONS, number % STATIONS
        day = f"1/{event % 28 + 1}/{1950 + event % 70}"
        title = f"Synthetic-{event:04d}, {day}, Station {station:02d}, {90 * (number % 4)}"
        other = shapes[(number + number // len(shapes) + 1) % len(shapes)]
        motion = shapes[number % len(shapes)] + 0.7 * other
        motion *= peak / np.max(np.abs(motion))
        (home / f"S{number:06d}.AT2").write_bytes(at2(motion, dt=DT, title=title))


def configuration() -> Config:
    """Three bodies; the results hold the answers alone."""
    sizes = {"wall": (0.4, 3.0), "column": (0.8, 5.0), "statue": (0.5, 1.8)}
    blocks = tuple(BlockSettings(name=name, width=width, height=height) for name, (width, height) in sizes.items())
    return Config(
        records=RecordSettings(store="none"),
        models=ModelSettings(use=("nonlinear",)),
        uncertainty=UncertaintySettings(probability=False),
        bodies=blocks,
    )


def on_dask(paths: list[str], config: Config, output: str, workers: int) -> Run:
    """The same on a dask cluster of one thread a worker, on this machine."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
        return run(paths, config, output, workers, cluster.scheduler_address)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, nargs="+", default=[1_000, 10_000, 100_000])
    parser.add_argument(
        "--dask", type=int, nargs="*", default=[1_000, 10_000, 100_000], help="of the runs on a dask cluster"
    )
    parser.add_argument("--seconds", type=float, default=4.0, help="length of a record")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--cores", type=int, default=1000)
    parser.add_argument("--folder", type=Path, help="where files and results go, and stay")
    args = parser.parse_args()
    with contextlib.ExitStack() as left:
        folder = args.folder or Path(left.enter_context(tempfile.TemporaryDirectory()))
        most, records = max([*args.records, *args.dask]), folder / "records"
        if not (records / f"{(most - 1) // 1000:03d}" / f"S{most - 1:06d}.AT2").exists():
            with ProcessPoolExecutor() as pool:
                starts = range(0, most, 5000)
                write = partial(_written, folder=records, most=most, seconds=args.seconds)
                list(pool.map(write, starts))
        paths = [str(records / f"{number // 1000:03d}" / f"S{number:06d}.AT2") for number in range(most)]
        config, output = configuration(), str(folder / "results.h5")
        fresh(run, paths[:8], config, output, 1)  # compiles the kernels
        print(f"records of {args.seconds:g} s, 3 bodies, {args.workers} workers", flush=True)
        found: dict[str, dict[int, Run]] = {"processes": {}, "dask": {}}
        for count in sorted({*args.records, *args.dask}):  # both ways of a count in turn, on a machine in one state
            for how, counts, call in (("processes", args.records, run), ("dask", args.dask, on_dask)):
                if count in counts:
                    found[how][count] = fresh(call, paths[:count], config, output, args.workers)
                    _print_run(how, found[how][count])
        for count, one in found["dask"].items():
            if own := found["processes"].get(count):
                print(f"dask over processes, {count} records: {one.rate / own.rate:.2f} of their rate", flush=True)
        _on_paper(list(found["processes"].values()), args.workers, args.cores)


def _written(start: int, folder: Path, most: int, seconds: float) -> None:
    write_records(start, folder, min(start + 5000, most), seconds)


def _print_run(how: str, one: Run) -> None:
    """A line of the table."""
    parts = [f"{1e3 * seconds / one.records:.2f}" for seconds in (one.survey, one.work, one.assembly)]
    inside, core = sum(one.seconds.values()), 1e3 * one.processor / one.records
    print(
        f"{how} {one.records}: {one.rate:.0f} records/s, {core:.2f} ms of a core and {1e3 / one.rate:.2f} ms a record "
        f"(survey {parts[0]}, work {parts[1]}, assembly {parts[2]}; in the workers {1e3 * inside / one.records:.2f}); "
        f"peak of the parent {one.peak:.0f} MB; results {one.size:.0f} MB",
        flush=True,
    )


def _on_paper(runs: list[Run], workers: int, cores: int) -> None:
    """What the largest run says of a national inventory: a million sites under a thousand records each."""
    largest = runs[-1]
    if len(runs) > 1:
        slope = (largest.peak - runs[0].peak) * 1e3 / (largest.records - runs[0].records)
        print(f"memory of the parent: {slope:.2f} kB a record beyond {runs[0].peak:.0f} MB")
    parent = (largest.survey + largest.assembly) / largest.records
    worker = workers * largest.work / largest.records
    print(
        f"a record takes {1e3 * worker:.1f} ms of a worker and {1e3 * parent:.2f} ms of the parent alone: {cores} "
        f"cores do 1e6 such records in {1e6 * worker / cores:.0f} s and wait {1e6 * parent:.0f} s for one parent"
    )


if __name__ == "__main__":
    main()
