"""`auto` against the nonlinear equation on every lane: the sample records x 400 blocks x three factors.

    python benchmarks/auto.py [--runs 5]

Prints which rung answered how many lanes, the verdicts that differ (there must be none), and the time of
``models.choose_response`` over that of ``models.recorded_response`` on the same lanes, one thread, median of the runs.
"""

from __future__ import annotations

import argparse
import logging
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.fidelity import Rung, choose_response
from rocking.march.recorded import recorded_response
from rocking.response import Outcome, Response
from rockpulse.readers.folders import read_all
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.record import Record

SAMPLES = Path(__file__).parents[1] / "data" / "samples" / "records"
FACTORS = np.array([0.5, 1.0, 2.0])
OUTPUTS = ({"output": "outcome"}, {"output": "peak", "tolerance": 0.05}, {"output": "peak", "tolerance": 1e-4})


def grid() -> Block:
    """20 x 20 blocks: p 1 to 8 1/s in equal ratios, alpha 0.05 to 0.3 rad, Housner's restitution."""
    p, alpha = np.meshgrid(np.geomspace(1.0, 8.0, 20), np.linspace(0.05, 0.3, 20))
    return Block.from_parameters(p.ravel(), alpha.ravel(), "housner")


def spent(call: Callable[[], Any]) -> tuple[float, Any]:
    """Time of a call [s], and what it returns."""
    start = time.perf_counter()
    answer = call()
    return time.perf_counter() - start, answer


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=5, help="runs of which the median is taken")
    runs = parser.parse_args().runs
    logging.disable(logging.WARNING)
    blocks = grid()
    found, _ = read_all([SAMPLES])
    records = [condition(record) for record in found if record.orientation not in ("vertical", "structural")]
    scenes = [(record, half_waves(record)) for record in records]
    print(
        f"{len(records)} records x {blocks.p.size} blocks x {FACTORS.size} factors, one thread, median of {runs} runs"
    )
    first, waves = scenes[0]
    choose_response(blocks, first.acceleration, first.dt, waves.centroid, waves.impulse, FACTORS, threads=1)
    for options in OUTPUTS:
        ratios, seconds = [], []
        # Both in turn: what else the machine does weighs on both alike.
        for _ in range(runs):
            whole, auto = 0.0, 0.0
            truths, answers = [], []
            for record, waves in scenes:
                time_of, truth = spent(partial(all_nonlinear, blocks, record))
                whole += time_of
                time_of, answer = spent(partial(chosen, blocks, record, waves, options))
                auto += time_of
                truths.append(truth)
                answers.append(answer)
            ratios.append(auto / whole)
            seconds.append((whole, auto))
        show(options, truths, answers)
        whole, auto = np.median(seconds, axis=0)
        print(f"  time: auto {auto:.3f} s, all nonlinear {whole:.3f} s; median ratio {np.median(ratios):.2f}")


def all_nonlinear(blocks: Block, record: Record) -> Response:
    """The nonlinear equation on every lane."""
    return recorded_response(blocks, record.acceleration, record.dt, scale=FACTORS, threads=1)


def chosen(blocks: Block, record: Record, waves: HalfWaves, options: dict[str, Any]) -> tuple[Response, np.ndarray]:
    """The cheapest model that answers, on every lane."""
    return choose_response(
        blocks, record.acceleration, record.dt, waves.centroid, waves.impulse, FACTORS, threads=1, **options
    )


def show(options: dict[str, Any], truths: list[Response], answers: list[tuple[Response, np.ndarray]]) -> None:
    """Lanes by rung, verdicts that differ, peaks, and whose the moving samples are."""
    used = np.stack([rungs for _, rungs in answers])
    outcome, true_outcome = (np.stack([one.outcome for one in all_]) for all_ in ([a for a, _ in answers], truths))
    peak, true_peak = (
        np.stack([one.peak_rotation_ratio for one in all_]) for all_ in ([a for a, _ in answers], truths)
    )
    active = np.stack([truth.active_samples for truth in truths])
    rocks = (outcome == Outcome.ROCKS) & (true_outcome == Outcome.ROCKS)
    print(f"\nauto, {options}")
    for rung in Rung:
        here = used == rung
        print(
            f"  {rung.name.lower():12s} {np.count_nonzero(here):6d} lanes ({np.mean(here):6.1%}), "
            f"{active[here].sum() / active.sum():6.1%} of the samples that move under the nonlinear equation"
        )
    print(f"  decided by a cheaper rung: {np.mean(used != Rung.NONLINEAR):.1%} of the lanes")
    print(f"  verdicts that differ: {np.count_nonzero(outcome != true_outcome)} of {outcome.size}")
    print(f"  largest difference of a peak of a lane that rocks: {np.max(np.abs(peak[rocks] - true_peak[rocks])):.3g}")


if __name__ == "__main__":
    main()
