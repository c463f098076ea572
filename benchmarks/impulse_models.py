"""Speed of the impulse models: kernels with many lanes compared with a plain march of the same equations.

    python benchmarks/impulse_models.py [--runs 5] [--seed 1]

Times are medians of whole calls in the same run. The plain march is the Python program tests/models/impulsive_march.py,
on a few of the lanes. The search for safety factors is compared with one call for each block. The input consists of the
half-waves of seeded synthetic motions, and of random impulses. Blocks and scale factors differ from lane to lane.
"""

import argparse
import logging
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from speed import median

from rocking.search.capacity import sequence_critical_scale
from rockpulse.models import Block, ImpulseSequence, impulsive_response, recorded_response, sequence_response
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from synthetic import synthetic_motion

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "models"))
from impulsive_march import march

clocked = partial(median, clock=time.perf_counter)


def bodies(count: int, seed: int) -> Block:
    rng = np.random.default_rng(seed)
    alpha, radius = np.arctan(1.0 / rng.uniform(4.0, 12.0, count)), rng.uniform(1.0, 6.0, count)
    return Block(half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha), restitution="housner")


def impulses_of_records(runs: int, seed: int) -> None:
    record = Record(synthetic_motion(seed, pga=4.0), dt=0.01, id="synthetic")
    waves = half_waves(record)
    print(f"one synthetic record of 60 s, {len(waves)} half-waves; one thread; us per lane (ns per impulse and lane)")
    few = bodies(4, seed)
    scale = np.array([0.5, 1.0])
    plain = clocked(1, lambda: [march(few.lane(m), waves.centroid, s * waves.impulse) for m in range(4) for s in scale])
    base = plain / 8
    print(f"  {'plain Python march':34} {1e6 * base:10.1f}  ({1e9 * base / len(waves):9.1f})")
    for lanes in (8, 64, 512, 4096):
        blocks, factors = bodies(lanes // 8, seed), np.linspace(0.3, 1.4, 8)
        spent = clocked(
            runs, lambda b=blocks, f=factors: impulsive_response(b, waves.centroid, waves.impulse, scale=f, threads=1)
        )
        each = spent / lanes
        print(
            f"  {f'impulsive, {lanes} lanes':34} {1e6 * each:10.2f}  ({1e9 * each / len(waves):9.1f})"
            f"  {base / each:8.0f} x the plain march"
        )
    blocks, factors = bodies(64, seed), np.linspace(0.3, 1.4, 8)
    models: dict[str, Callable[[], Any]] = {
        "linear equation": lambda: recorded_response(
            blocks, record.acceleration, record.dt, "linear", scale=factors, threads=1
        ),
        "nonlinear equation": lambda: recorded_response(
            blocks, record.acceleration, record.dt, scale=factors, threads=1
        ),
    }
    for name, call in models.items():
        print(f"  {f'{name}, 512 lanes':34} {1e6 * clocked(runs, call) / 512:10.2f}")
    for threads in (1, 2):
        spent = clocked(
            runs,
            lambda n=threads: impulsive_response(
                bodies(512, seed), waves.centroid, waves.impulse, scale=factors, threads=n
            ),
        )
        print(f"  {f'impulsive, 4096 lanes, {threads} thread(s)':34} {1e3 * spent:10.1f} ms the call")


def sequences(runs: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    blocks, count = bodies(100, seed), 200
    main = rng.uniform(0.1, 0.9, count)
    many = ImpulseSequence(
        main=main,
        secondary=rng.uniform(0.3, 0.7, count) * main,
        interval=rng.uniform(0.1, 0.6, count),
        duration=20.0,
        main_count=rng.integers(1, 12, count),
    )

    def one_by_one() -> None:
        for q in range(0, count, 20):
            for m in range(0, 100, 10):
                single = ImpulseSequence(
                    many.main[q], many.secondary[q], many.interval[q], 20.0, main_count=int(many.main_count[q])
                )
                sequence_response(blocks.lane(m), single, table_rows=0)

    base = clocked(1, one_by_one) / 100
    print("\nsequence model, 200 combinations of (I, I_s/I, dT, main count) x 100 blocks; us per lane")
    print(f"  {'one call a lane':34} {1e6 * base:10.2f}")
    for threads in (1, 2):
        each = clocked(runs, lambda n=threads: sequence_response(blocks, many, table_rows=0, threads=n)) / (100 * count)
        print(f"  {f'one call, {threads} thread(s)':34} {1e6 * each:10.2f}  {base / each:8.0f} x")
    scene = ImpulseSequence(0.3, 0.12, 0.25, 15.0, main_count=6)
    base = clocked(runs, lambda: [sequence_critical_scale(blocks.lane(m), scene, 10.0, 1.02) for m in range(100)])
    spent = clocked(runs, lambda: sequence_critical_scale(blocks, scene, 10.0, 1.02, threads=1))
    print("\nsafety factors of 100 blocks, steps of 2 %; ms")
    print(f"  {'a search for each block':34} {1e3 * base:10.1f}")
    print(f"  {'all blocks in one search':34} {1e3 * spent:10.1f}  {base / spent:8.1f} x")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    logging.getLogger("rockpulse").setLevel(logging.ERROR)
    impulses_of_records(options.runs, options.seed)
    sequences(options.runs, options.seed)


if __name__ == "__main__":
    main()
