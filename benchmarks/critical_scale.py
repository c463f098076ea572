"""Cost and error of the critical scale factors, all in one run: ``python benchmarks/critical_scale.py``.

100 blocks (p 1 to 8 1/s, alpha 0.05 to 0.3, C = 0.9) are computed under seeded synthetic motions of 60 s at 0.01 s, PGA
3 m/s2. Times are medians of whole calls in processor time of one thread. The reference for time and intervals is a scan
without refinement, 16 times as fine, on the same blocks in the same run. ``--motions`` and ``--runs`` set the number of
motions and calls.
"""

import argparse
import logging
import statistics
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from speed import median

from rocking.search.capacity import POINTS, uplift_scale
from rockpulse.models import (
    Block,
    ImpulseSequence,
    Outcome,
    ScaleIntervals,
    critical_scale,
    impulsive_critical_scale,
    recorded_response,
    resonance_critical_scale,
    sequence_critical_scale,
)
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from synthetic import synthetic_lanes, synthetic_motion

DT = 0.01  # s
FACTOR_MAX = 10.0
FINER = 16
REFERENCE = 1e-9  # relative width of the brackets of the reference edges


def overturns(blocks: Block, motion: np.ndarray, lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Whether each lane overturns at its factor: (n,) ndarray of bool."""
    part = blocks.take(lanes)
    return recorded_response(part, motion, DT, block_scale=factors, threads=1).outcome == Outcome.OVERTURNS


def fine_scan(blocks: Block, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Factors (q, m) of the brute-force scan, and whether the block overturns."""
    start = uplift_scale(blocks, motion)
    factors = np.geomspace(start, FACTOR_MAX, FINER * (POINTS - 1) + 1)
    lanes = np.tile(np.arange(start.size), factors.shape[0])
    return factors, overturns(blocks, motion, lanes, factors.reshape(-1)).reshape(factors.shape)


def edge_error(found: ScaleIntervals, blocks: Block, motion: np.ndarray) -> float:
    """Largest relative distance of a safety factor from its edge, followed to 1e-9."""
    lanes = np.flatnonzero(np.isfinite(found.safety_factor))
    low, high = found.safe_up_to[lanes].copy(), found.safety_factor[lanes].copy()
    while np.any(high - low > REFERENCE * high):
        middle = 0.5 * (low + high)
        over = overturns(blocks, motion, lanes, middle)
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return float(np.max(found.safety_factor[lanes] / high - 1.0))


def missed(found: ScaleIntervals, factors: np.ndarray, over: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Intervals of the fine scan (wide, wide not found, narrow, narrow not found), and safety factors over its own."""
    counts = np.zeros(4, dtype=int)
    for lane in range(over.shape[1]):
        edges = np.flatnonzero(np.diff(over[:, lane].astype(int), prepend=0, append=0))
        mine = found.lane == lane
        for begin, end in zip(edges[::2], edges[1::2] - 1, strict=True):
            seen = np.any(
                (found.lower[mine] <= factors[end, lane] * 1.000001) & (found.upper[mine] >= factors[begin, lane])
            )
            counts += np.array([1, not seen, 0, 0]) if end - begin >= FINER else np.array([0, 0, 1, not seen])
    first = factors[np.argmax(over, axis=0), np.arange(over.shape[1])]
    known = over.any(axis=0)
    return counts, found.safety_factor[known] / first[known]


def searches(blocks: Block, motion: np.ndarray) -> dict[str, Callable[[], object]]:
    """What is timed, by name; the brute-force scan first."""
    waves = half_waves(Record(motion, DT, id="synthetic", processed=True))
    sequence = ImpulseSequence(0.2, 0.08, 0.15, 20.0, main_count=5)
    limit = replace(sequence, spacing="continuous")
    return {
        f"brute-force scan, {FINER * (POINTS - 1) + 1} factors": lambda: fine_scan(blocks, motion),
        "nonlinear": lambda: critical_scale(blocks, motion, DT, threads=1),
        "nonlinear, 100 calls of one block": lambda: [
            critical_scale(blocks.lane(k), motion, DT, threads=1) for k in range(blocks.shape[0])
        ],
        "nonlinear, theta_max/alpha_c of 0.4": lambda: critical_scale(blocks, motion, DT, level=0.4, threads=1),
        "linear": lambda: critical_scale(blocks, motion, DT, "linear", threads=1),
        "impulsive": lambda: impulsive_critical_scale(blocks, waves.centroid, waves.impulse, threads=1),
        "sequence, end": lambda: sequence_critical_scale(blocks, sequence, threads=1),
        "sequence, continuous (closed form)": lambda: sequence_critical_scale(blocks, limit),
        "resonance (closed form)": lambda: resonance_critical_scale(blocks, sequence),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=6)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    logging.getLogger("rockpulse").setLevel(logging.ERROR)
    times: dict[str, list[float]] = {}
    counts, late, errors = np.zeros(4, dtype=int), [], []
    for seed in range(options.motions):
        drawn = synthetic_lanes(seed, 100)
        blocks = Block.from_parameters(drawn.p, drawn.alpha, 0.9)
        motion = synthetic_motion(seed, pga=3.0)
        for name, call in searches(blocks, motion).items():
            times.setdefault(name, []).append(median(options.runs, call))
        found = critical_scale(blocks, motion, DT, threads=1)
        errors.append(edge_error(found, blocks, motion))
        ours, ratio = missed(found, *fine_scan(blocks, motion))
        counts += ours
        late.append(ratio)
    base = next(iter(times.values()))
    print(f"100 blocks on one record of 60 s, one core, {options.motions} motions; s")
    print(f"  {'':38} {'median':>8} {'largest':>8}  times faster")
    for name, spent in times.items():
        faster = statistics.median(b / s for b, s in zip(base, spent, strict=True))
        print(f"  {name:38} {statistics.median(spent):8.3f} {max(spent):8.3f} {faster:8.1f}")
    ratios = np.concatenate(late)
    print(f"nonlinear: safety factors at most {max(errors):.1e} above their edges (followed to {REFERENCE:g})")
    print(f"  intervals of the brute-force scan wider than the step of the search: {counts[0]}, not found {counts[1]}")
    print(f"  narrower ones: {counts[2]}, not found {counts[3]}")
    above = ", ".join(f"> {share:.0%} in {np.mean(ratios > 1.0 + share):.1%}" for share in (0.01, 0.05, 0.1))
    print(f"  safety factor above that of the brute-force scan: by {above} of the blocks")
    print(f"  below it: by > 1% in {np.mean(ratios < 1.0 / 1.01):.1%} of the blocks")


if __name__ == "__main__":
    main()
