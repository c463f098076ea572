"""Errors of the impulse models against the nonlinear equation, and of the corrections that were tried.

    python benchmarks/effective_impulse.py [--motions N] [--seed S] [--records FOLDER ...]

Blocks of slenderness 4, 6, 8, 12 and R = 1, 2, 4 m with Housner's restitution; seeded synthetic motions of 30 s (PGA
0.15 to 0.6 g) and the horizontal channels above 0.12 g of the folders given, each at factors 0.5, 0.7, 1 and 1.4.

Columns: median of the peak ratio to the nonlinear model; standard deviation of its logarithm, and half the distance of
its 16th and 84th percentile (both survive, nonlinear peak above 0.05; peaks below 0.01 count as 0.01); overturnings
missed, and false ones; processor time per lane.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rocking.effective_impulse import effective_impulse_response
from rockpulse import read
from rockpulse.errors import RockpulseError
from rockpulse.models import Block, Outcome, Response, impulsive_response, recorded_response
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.record.synthetic import synthetic_motion

SLENDERNESS = np.array([4.0, 6.0, 8.0, 12.0])
RADIUS = np.array([1.0, 2.0, 4.0])
SCALE = np.array([0.5, 0.7, 1.0, 1.4])
ALPHA = np.repeat(np.arctan(1.0 / SLENDERNESS), RADIUS.size)
BLOCKS = Block(
    np.tile(RADIUS, SLENDERNESS.size) * np.sin(ALPHA), np.tile(RADIUS, SLENDERNESS.size) * np.cos(ALPHA), "housner"
)

#: Peak and outcome, (q, m) each.
Answer = tuple[np.ndarray, np.ndarray]


def answer(response: Response) -> Answer:
    return np.asarray(response.peak_rotation_ratio), np.asarray(response.outcome)


def by_block(model: Callable[[Block, int], Response]) -> Answer:
    parts = [answer(model(BLOCKS.lane(lane), lane)) for lane in range(ALPHA.size)]
    return np.stack([part[0] for part in parts], axis=1), np.stack([part[1] for part in parts], axis=1)


def nonlinear(record: Record) -> Answer:
    return answer(recorded_response(BLOCKS, record.acceleration, record.dt, scale=SCALE, threads=1))


def linear(record: Record) -> Answer:
    return answer(recorded_response(BLOCKS, record.acceleration, record.dt, "linear", scale=SCALE, threads=1))


def linear_tangent(record: Record) -> Answer:
    """The linear equation lifted at g tan(alpha): it depends on scale/alpha only (F9)."""

    def model(block: Block, lane: int) -> Response:
        share = ALPHA[lane] / np.tan(ALPHA[lane])
        return recorded_response(block, record.acceleration, record.dt, "linear", scale=share * SCALE, threads=1)

    return by_block(model)


def impulsive(gain: str) -> Callable[[Record], Answer]:
    def run(record: Record) -> Answer:
        waves = half_waves(record)
        return answer(impulsive_response(BLOCKS, waves.centroid, waves.impulse, gain=gain, scale=SCALE, threads=1))

    return run


def pieces(record: Record, parts: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Impulses and centroids of equal parts in time of every half-wave, and the number of its half-wave."""
    waves = half_waves(record)
    edges = waves.start[:, None] + (waves.end - waves.start)[:, None] * np.arange(parts + 1) / parts
    times = record.dt * np.arange(record.acceleration.size)
    points = np.unique(np.concatenate([times, edges.ravel()]))
    values, steps = np.interp(points, times, record.acceleration), np.diff(points)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * steps * (values[1:] + values[:-1]))])
    moved = steps * velocity[:-1] + steps**2 * (values[:-1] / 3.0 + values[1:] / 6.0)
    displacement = np.concatenate([[0.0], np.cumsum(moved)])
    begin, end = np.searchsorted(points, edges[:, :-1].ravel()), np.searchsorted(points, edges[:, 1:].ravel())
    impulse = velocity[end] - velocity[begin]
    moment = displacement[end] - displacement[begin] - velocity[begin] * (points[end] - points[begin])
    kept = np.abs(impulse) > 1e-12
    lever = np.clip(moment[kept] / impulse[kept], 0.0, (points[end] - points[begin])[kept])
    return impulse[kept], points[end][kept] - lever, np.repeat(np.arange(len(waves)), parts)[kept]


def split(parts: int) -> Callable[[Record], Answer]:
    """Every half-wave as several impulses."""

    def run(record: Record) -> Answer:
        impulse, centroid, _ = pieces(record, parts)
        return answer(impulsive_response(BLOCKS, centroid, impulse, gain="tangent", scale=SCALE, threads=1))

    return run


def modes_kept(record: Record) -> Answer:
    """One impulse a half-wave that gives both modes what the half-wave gives them in flight."""
    impulse, centroid, wave = pieces(record, 16)

    def model(block: Block, lane: int) -> Response:
        first = np.flatnonzero(np.append(True, wave[1:] != wave[:-1]))
        middle = np.repeat(centroid[first], np.diff(np.append(first, wave.size)))
        growing = np.add.reduceat(impulse * np.exp(-block.p * (centroid - middle)), first)
        decaying = np.add.reduceat(impulse * np.exp(block.p * (centroid - middle)), first)
        size = np.sign(growing) * np.sqrt(growing * decaying)
        times = centroid[first] + 0.5 * np.log(decaying / growing) / block.p
        order = np.argsort(times, kind="stable")
        return impulsive_response(block, times[order], size[order], gain="tangent", scale=SCALE, threads=1)

    return by_block(model)


def effective(gain: str, longest: float) -> Callable[[Record], Answer]:
    def run(record: Record) -> Answer:
        return answer(
            effective_impulse_response(
                BLOCKS, record.acceleration, record.dt, gain=gain, scale=SCALE, longest=longest, threads=1
            )
        )

    return run


MODELS: dict[str, Callable[[Record], Answer]] = {
    "linear": linear,
    "linear, lifted at g tan(alpha)": linear_tangent,
    **{f"impulsive, gain {gain}": impulsive(gain) for gain in ("paper", "linear", "exact", "tangent")},
    "impulsive, both modes kept": modes_kept,
    **{f"impulsive, half-waves in {parts}": split(parts) for parts in (2, 4)},
    **{f"effective, gain {gain}, longest 0.1": effective(gain, 0.1) for gain in ("paper", "linear")},
    **{f"effective, longest {longest:g}": effective("tangent", longest) for longest in (np.inf, 0.5, 0.2, 0.1, 0.05)},
}


def motions(count: int, seed: int) -> list[Record]:
    strengths = np.random.default_rng(seed).uniform(0.15, 0.6, count) * STANDARD_GRAVITY
    return [
        Record(synthetic_motion(seed + i, duration=30.0, pga=strengths[i]), dt=0.01, id=f"synthetic{i}")
        for i in range(count)
    ]


def channels(folders: list[Path]) -> list[Record]:
    """Horizontal channels of the readable files, mean removed, 0.1 to 25 Hz, from 25 s before the peak for 60 s."""
    found = []
    for path in sorted(path for folder in folders for path in folder.rglob("*") if path.is_file()):
        try:
            records = read(path)
        except RockpulseError as error:
            print(f"skipped {path.name}: {str(error).splitlines()[0][:80]}")
            continue
        for record in records:
            if record.component.lower() in ("up", "v") or record.pga < 0.12 * STANDARD_GRAVITY:
                continue
            clean = condition(record, baseline="mean", highpass_hz=0.1, lowpass_hz=25.0)
            first = max(0, int(np.argmax(np.abs(clean.acceleration))) - int(25.0 / clean.dt))
            cut = clean.acceleration[first : first + int(60.0 / clean.dt)]
            found.append(Record(np.append(cut, np.zeros(int(8.0 / clean.dt))), dt=clean.dt, id=record.id))
    return found


def report(title: str, records: list[Record]) -> None:
    truth = [nonlinear(record) for record in records]
    peak, outcome = (np.concatenate([part[i].ravel() for part in truth]) for i in range(2))
    over = outcome == Outcome.OVERTURNS
    print(f"\n{title}: {len(records)} motions, {over.size} lanes, {over.sum()} overturn")
    print(f"{'model':34}  median  st.dev  half 16-84  missed  false  us/lane")
    for name, model in MODELS.items():
        model(records[0])  # compiled, caches warm
        began = time.process_time()
        parts = [model(record) for record in records]
        spent = time.process_time() - began
        found, verdict = (np.concatenate([part[i].ravel() for part in parts]) for i in range(2))
        falls = verdict == Outcome.OVERTURNS
        kept = ~over & ~falls & (peak > 0.05)
        logs = np.log(np.maximum(found[kept], 0.01) / peak[kept])
        low, median, high = np.percentile(logs, [16, 50, 84])
        print(
            f"{name:34}  {np.exp(median):6.3f}  {logs.std():6.3f}  {0.5 * (high - low):10.3f}  "
            f"{np.sum(over & ~falls):6d}  {np.sum(~over & falls):5d}  {1e6 * spent / over.size:7.1f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--records", type=Path, nargs="*", default=[])
    options = parser.parse_args()
    report("synthetic", motions(options.motions, options.seed))
    if options.records:
        report("records", channels(options.records))


if __name__ == "__main__":
    main()
