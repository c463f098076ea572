"""The limits of ``models.fidelity``, measured: every screen against the nonlinear equation, also on lanes kept aside.

    ROCKPULSE_RECORDS=FOLDER python benchmarks/measure_fidelity.py [--lanes SHARE]

Motions: the horizontal channels of data/samples and, where ROCKPULSE_RECORDS names a folder, of every record in it that
can be read; seeded synthetic motions; pulses of half a cycle to three; sine trains of five to twenty-five. Blocks are
drawn within ``MEASURED_RANGE``, factors such that PGA is 0.1 to 1.2 g. The limits come from the fitting half (every
other synthetic motion, pulse and train, and the records of every event but Ridgecrest); the other half counts the
verdicts that they would get wrong.
"""

from __future__ import annotations

import argparse
import logging
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rocking import fidelity
from rocking.body.block import Block
from rocking.impulses.impulsive import impulsive_response
from rocking.march.demand import SETTLED, ground_demand
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.readers.folders import read_all
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.record.synthetic import synthetic_motion

SAMPLES = Path(__file__).parents[1] / "data" / "samples" / "records"
PEAKS = STANDARD_GRAVITY * np.array([0.1, 0.2, 0.35, 0.5, 0.8, 1.2])
SEED = 20170615

#: Sums of speed and build-up left at which the verdict of a lane is tried as settled.
SETTLED_TRIED = (0.6, SETTLED, 0.8, 0.9, 1.0, 1.2)


class Motion(NamedTuple):
    """A ground motion of the ensemble."""

    kind: str
    fitting: bool
    record: Record


def motions() -> Iterator[Motion]:
    """The ensemble, motion by motion."""
    folders = [SAMPLES, *([Path(os.environ["ROCKPULSE_RECORDS"])] if "ROCKPULSE_RECORDS" in os.environ else [])]
    seen = set()
    for folder in folders:
        found, _ = read_all([folder])
        for record in found:
            if record.id in seen or record.orientation in ("vertical", "structural"):
                continue
            seen.add(record.id)
            if record.pga > 0.02 * STANDARD_GRAVITY:
                yield Motion("records", "20190706" not in record.id, condition(record))
    for seed in range(120):
        yield Motion("synthetic", seed % 4 < 2, made(synthetic_motion(seed, duration=(20.0, 60.0)[seed % 2])))
    rng = np.random.default_rng(SEED)
    for k in range(90):
        cycles = (0.5, 1.0, 1.5, 2.0, 3.0)[k % 5] if k < 60 else float(rng.integers(5, 25))
        frequency = np.exp(rng.uniform(np.log(0.3), np.log(5.0)))
        t = 0.01 * np.arange(round(cycles / frequency / 0.01) + 1)
        wave = np.sin(2.0 * np.pi * frequency * t)
        if k % 2:
            wave = np.cos(2.0 * np.pi * frequency * t) * np.sin(np.pi * t / t[-1])
        wave = np.concatenate([np.zeros(20), wave, np.zeros(20)])
        kind = "pulses" if k < 60 else "trains"
        yield Motion(kind, (k // 10) % 2 == 0, made(3.0 * wave / np.max(np.abs(wave))))


def made(acceleration: np.ndarray) -> Record:
    """A record of made samples at 0.01 s."""
    return Record(acceleration, 0.01, id="made", processed=True)


def draw(rng: np.random.Generator, count: int) -> Block:
    """Blocks spread over the measured range."""
    (p_low, p_high), (a_low, a_high), (c_low, c_high) = (
        fidelity.MEASURED_RANGE[name] for name in ("p", "alpha", "restitution")
    )
    p = np.exp(rng.uniform(np.log(p_low), np.log(p_high), count))
    alpha = rng.uniform(a_low, a_high, count)
    ratio = np.where(rng.random(count) < 0.6, c_high, rng.uniform(c_low, c_high, count))
    return Block.from_parameters(p, alpha, ratio * (1.0 - 1.5 * np.sin(alpha) ** 2))


def measured(share: float) -> dict[str, np.ndarray]:
    """Every lane of the ensemble that can be lifted: its measures and what the nonlinear equation says."""
    rng = np.random.default_rng(SEED + 1)
    rows: dict[str, list[np.ndarray]] = {}
    for motion in motions():
        record = motion.record
        blocks = draw(rng, max(int(share * (400 if motion.kind == "records" else 100)), 2))
        factors = PEAKS / record.pga
        truth = recorded_response(blocks, record.acceleration, record.dt, scale=factors)
        demand = ground_demand(blocks, record.acceleration, record.dt)
        waves = half_waves(record)
        times, impulses = fidelity._strongest(waves.centroid, waves.impulse)
        count = blocks.p.size
        for row, factor in enumerate(factors):
            impulsive = impulsive_response(
                blocks,
                times,
                impulses,
                scale=factor * np.array([1.0, fidelity.RAISED]),
                gain="exact",
            )
            over = impulsive.outcome == Outcome.OVERTURNS
            lane = {
                "kind": np.full(count, motion.kind),
                "fitting": np.full(count, motion.fitting),
                "outcome": truth.outcome[row],
                "peak": truth.peak_rotation_ratio[row],
                "active": truth.active_samples[row],
                "build_up": factor * demand.build_up,
                "largest": factor * demand.largest,
                "over": over[0],
                "over_raised": over[1],
                "impulsive_peak": impulsive.peak_rotation_ratio[0],
            }
            for limit in SETTLED_TRIED:
                part = recorded_response(
                    blocks, record.acceleration, record.dt, scale=factor, verdict=replace(demand, settled=limit)
                )
                lane[f"outcome_{limit}"], lane[f"active_{limit}"] = part.outcome, part.active_samples
                lane[f"peak_{limit}"] = part.peak_rotation_ratio
            for name, values in lane.items():
                rows.setdefault(name, []).append(values)
    lanes = {name: np.concatenate(parts) for name, parts in rows.items()}
    return {name: values[lanes["outcome"] != Outcome.AT_REST] for name, values in lanes.items()}


def report(lanes: dict[str, np.ndarray]) -> None:
    """Extremes of the fitting half, and what the limits in use get wrong on the other."""
    fallen, rocks = lanes["outcome"] == Outcome.OVERTURNS, lanes["outcome"] == Outcome.ROCKS
    fitting, kinds = lanes["fitting"], ["records", "synthetic", "pulses", "trains"]
    for kind in kinds:
        here = lanes["kind"] == kind
        print(
            f"{kind:10s} {np.count_nonzero(here):7d} lanes that lift, {np.count_nonzero(here & fallen):6d} overturn; "
            f"kept aside {np.count_nonzero(here & ~fitting):7d}, {np.count_nonzero(here & fallen & ~fitting):6d}"
        )
    calm = lanes["largest"] <= fidelity.SAFE_LARGEST
    quiet = ~lanes["over"] & ~lanes["over_raised"] & calm
    rules = {
        # name: (lanes it looks at, measure, limit, side, which outcome it must not have)
        "build_up": (~lanes["over"], "build_up", fidelity.SAFE_BUILD_UP, -1, fallen, rocks),
        "build_up, raised input": (quiet, "build_up", fidelity.SAFE_BUILD_UP_RAISED, -1, fallen, rocks),
    }
    print(
        "\nrule                      extreme wrong lane by kind (fitting)        limit  wrong: fitting aside  decides"
    )
    for name, (looked_at, measure, limit, side, wrong, right) in rules.items():
        extremes = []
        for kind in kinds:
            values = side * lanes[measure][looked_at & wrong & fitting & (lanes["kind"] == kind)]
            extremes.append(f"{side * np.max(values):8.3f}" if values.size else "    none")
        taken = looked_at & (side * lanes[measure] >= side * limit)
        aside = lanes["kind"] == "records"
        print(
            f"{name:25s} {' '.join(extremes)}  {limit:7.3g}  {np.count_nonzero(taken & wrong & fitting):12d} "
            f"{np.count_nonzero(taken & wrong & ~fitting):6d}  {np.mean(taken[right & aside]):.3f} of records "
            f"({lanes['active'][taken & right & aside].sum() / lanes['active'][right & aside].sum():.3f} of samples)"
        )
    low = (lanes["build_up"] <= fidelity.SAFE_BUILD_UP) & rocks
    print(f"\nlargest peak/build_up^2 at low build_up: {np.max(lanes['peak'][low] / lanes['build_up'][low] ** 2):.3f}")
    seen = rocks & (lanes["peak"] > 0.05)
    low = ~lanes["over"] & ((lanes["build_up"] <= fidelity.SAFE_BUILD_UP_RAISED) & quiet)
    compare("the impulsive rung", lanes["impulsive_peak"][seen & low], lanes["peak"][seen & low])
    print("\nsettled at  wrong: survivors (fitting, aside), overturned (all)   samples followed: rocking, overturning")
    for limit in SETTLED_TRIED:
        outcome, active = lanes[f"outcome_{limit}"], lanes[f"active_{limit}"]
        missed, false = fallen & (outcome != Outcome.OVERTURNS), rocks & (outcome != Outcome.ROCKS)
        left = [active[kind].sum() / lanes["active"][kind].sum() for kind in (rocks, fallen)]
        print(
            f"{limit:10.2f} {np.count_nonzero(missed & fitting):14d} {np.count_nonzero(missed & ~fitting):6d} "
            f"{np.count_nonzero(false):22d} {left[0]:34.3f} {left[1]:8.3f}"
        )
    both = seen & (lanes[f"outcome_{SETTLED}"] == Outcome.ROCKS)
    compare("the settled rung", lanes[f"peak_{SETTLED}"][both], lanes["peak"][both])


def compare(rung: str, answer: np.ndarray, truth: np.ndarray) -> None:
    """Peaks of a rung beside those of the nonlinear equation."""
    ratio = np.log(np.maximum(answer, 1e-9) / truth)
    print(
        f"peak by {rung} over the nonlinear one: median {np.exp(np.median(ratio)):.3f}, log-dispersion "
        f"{np.std(ratio):.2f}, same to 1e-9 {np.mean(np.abs(ratio) < 1e-9):.2f}, "
        f"largest difference {np.max(np.abs(answer - truth)):.3f}"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--lanes", type=float, default=1.0, help="share of the blocks of every motion")
    logging.disable(logging.WARNING)
    report(measured(parser.parse_args().lanes))


if __name__ == "__main__":
    main()
