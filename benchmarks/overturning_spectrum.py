"""Error of the overturning spectrum compared with marches of each body, and its run time.

``python benchmarks/overturning_spectrum.py FOLDER [--units g] [--pairs 500]`` uses the strong horizontal channels of a
folder, by the protocol of the rule (docs/decisions/009). It draws bodies of slenderness 3.5 to 18, R 0.3 to 8 m (p
inside the default grid) and C of 0.93 to 1 times Housner's. The values of a body from the spectrum are compared with
those from separate marches of the body: 4096 draws of (C, alpha) in a scrambled Sobol set, with exact scale factors on
levels that cover 2.2 in ln f about the capacity, and the uncertainty of the scale factor as a normal kernel. ``--wall``
draws bodies in contact with a wall, with Sorrentino's rebound. ``--cost`` compares the time of the spectrum of one
record with that of the marches alone.
"""

import argparse
import itertools
import logging
import math
import statistics
import time
from dataclasses import replace

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.stats import norm, qmc

import rockpulse as rp
from laboratory.ensemble import StrongMotion, strong_motions
from rocking import Block, OverturningSpectrum, Uncertainty, recorded_response, spectrum_lanes
from rocking.body.limits import RATES, sorrentino
from rocking.spectrum.half_waves import half_wave_lanes
from rocking.spectrum.probability import factor_at, mean_capacity, rising
from rockpulse.storage.variables.probability import RESTITUTIONS, ROTATIONS

UNCERTAINTY = Uncertainty()

#: Draws of one body, and how far its levels reach on both sides of the capacity, in ln f.
DRAWS, REACH = 4096, 1.1

#: Quantities that are compared.
QUANTITIES = ("capacity_mean", "factor_10", "factor_50")


def own_lanes(
    motion: StrongMotion, body: Block, centre: float, reach: float, draws: int, seed: int, rotation: float = np.inf
) -> dict[str, float]:
    """The quantities of one body from lanes of its own, and P at a factor of one; of reaching a rotation if given."""
    drawn = qmc.Sobol(3, seed=seed).random(draws)
    least, most = UNCERTAINTY.restitution
    restitution = np.minimum(body.restitution * (least + (most - least) * drawn[:, 0]), 0.999)
    alpha = body.alpha_c * np.exp(-UNCERTAINTY.geometry * norm.ppf(0.5 + 0.5 * drawn[:, 1]))
    logs = centre + reach * (2.0 * drawn[:, 2] - 1.0)
    wall = (
        {"restitution": "housner", "one_sided": True, "rebound": restitution}
        if body.side
        else {"restitution": restitution}
    )
    lanes = Block.from_parameters(np.full(draws, body.p), alpha, gravity=body.gravity, log=False, **wall)
    lanes = lanes.mirrored() if body.side < 0 else lanes
    record = motion.record
    peak = recorded_response(lanes, record.acceleration, record.dt, block_scale=np.exp(logs)).peak_rotation_ratio
    over = np.where(np.isnan(peak), np.inf, peak) >= rotation
    spread = UNCERTAINTY.factor
    levels = np.arange(centre - reach - 5 * spread, centre + reach + 5 * spread, 0.02)
    bell = norm.pdf((logs - levels[:, np.newaxis]) / spread)
    above = norm.sf((centre + reach - levels) / spread)
    inside = 1.0 - above - norm.cdf((centre - reach - levels) / spread)
    probability = inside * (bell @ over) / np.maximum(bell.sum(axis=1), 1e-300) + above
    fitted, factors = rising(probability), np.exp(levels)
    return {
        "capacity_mean": float(mean_capacity(factors, probability)),
        "factor_10": float(factor_at(0.1, factors, fitted)),
        "factor_50": float(factor_at(0.5, factors, fitted)),
        "at_one": float(np.interp(0.0, levels, fitted)),
    }


def rotation_error(motions: list[StrongMotion], pairs: int) -> None:
    """Print bias and dispersion of the mean factors at which bodies reach rotations, read from S of each of them."""
    tables = []
    for one in motions:
        spectrum = OverturningSpectrum(spectrum_lanes(one.record.acceleration, one.record.dt), UNCERTAINTY)
        tables.append([np.log(spectrum.spectrum(RESTITUTIONS, rotation)) for rotation in ROTATIONS])
    logs = np.empty((pairs, ROTATIONS.size))
    for pair in range(pairs):
        motion, body = motions[pair % len(motions)], drawn_body(np.random.default_rng([17, pair]))
        speed = math.log(body.gravity * math.tan(body.alpha_c) / body.p)
        for place, rotation in enumerate(ROTATIONS):
            table = RegularGridInterpolator((np.log(RATES), RESTITUTIONS), tables[pair % len(motions)][place])
            read = speed - table([[math.log(body.p), body.restitution]])[0]
            truth = own_lanes(motion, body, read, 2.5, DRAWS, pair, rotation)["capacity_mean"]
            logs[pair, place] = read - math.log(truth)
    for rotation, values in zip(ROTATIONS, logs.T, strict=True):
        print(f"rotation {rotation:g}: median {np.exp(np.median(values)):.3f} dispersion {np.std(values):.3f}")


def drawn_body(random: np.random.Generator, wall: bool = False) -> Block:
    """One body, whose p lies in the default grid of the spectrum; before a wall on either side of the record."""
    slenderness = random.choice([3.5, 4.0, 5.0, 6.0, 8.0, 12.0, 18.0])
    radius, share = np.exp(random.uniform(math.log(0.3), math.log(8.0))), random.choice([1.0, 0.97, 0.93])
    alpha = math.atan(1.0 / slenderness)
    housner = Block(half_width=radius * math.sin(alpha), half_height=radius * math.cos(alpha), log=False)
    if wall:
        body = Block.from_parameters(
            float(housner.p), alpha, "housner", one_sided=True, rebound=share * sorrentino(alpha), log=False
        )
        return body if random.uniform() < 0.5 else body.mirrored()
    return Block.from_parameters(
        p=float(housner.p), alpha=alpha, restitution=share * float(housner.restitution), log=False
    )


def error(motions: list[StrongMotion], pairs: int, wall: bool) -> None:
    """Print bias and dispersion of the quantities, over all pairs and by slenderness, p and C, or the rebound e."""
    rows, covered = [], []
    spectra = [
        {
            side: OverturningSpectrum(spectrum_lanes(one.record.acceleration, one.record.dt, side=side), UNCERTAINTY)
            for side in ((1, -1) if wall else (0,))
        }
        for one in motions
    ]
    for pair in range(pairs):
        motion, spectrum = motions[pair % len(motions)], spectra[pair % len(motions)]
        random = np.random.default_rng([17, pair])
        body = drawn_body(random, wall)
        read = spectrum[int(body.side)].factors(body.lanes(1))
        centre = math.log(read.capacity_mean[0])
        # The whole range first: what the spectrum says must not decide where the truth is looked for.
        wide = own_lanes(motion, body, centre, 3.0, DRAWS // 4, pair)
        truth = own_lanes(motion, body, math.log(wide["capacity_mean"]), REACH, DRAWS, pair)
        if not all(np.isfinite(truth[name]) for name in QUANTITIES):
            truth = wide
        logs = [math.log(getattr(read, name)[0] / truth[name]) for name in QUANTITIES]
        rows.append(
            [*logs, read.at_one[0] - truth["at_one"], body.slenderness, body.p, body.restitution, truth["at_one"]]
        )
        covered.append(
            [getattr(read, f"{name}_low")[0] <= truth[name] <= getattr(read, f"{name}_high")[0] for name in QUANTITIES]
        )
    table = np.array(rows, dtype=float)
    print(f"{len(motions)} channels, {len({one.event for one in motions})} earthquakes, {pairs} pairs")
    _print("all", table)
    for name, column, edges in (
        ("slenderness", 4, (0, 4.5, 7, 20)),
        ("p", 5, (0, 1.5, 2.5, 9)),
        ("e", 6, (0, 0.4, 0.45, 0.6)) if wall else ("C", 6, (0, 0.9, 0.95, 1.01)),
    ):
        for low, high in itertools.pairwise(edges):
            chosen = (table[:, column] >= low) & (table[:, column] < high)
            _print(f"{name} {low:g} to {high:g}", table[chosen])
    unsure = (table[:, 7] > 0.02) & (table[:, 7] < 0.98)
    print(
        f"P at 1 within 0.1: {np.mean(np.abs(table[:, 3]) <= 0.1):.1%} of all, "
        f"{np.mean(np.abs(table[unsure, 3]) <= 0.1):.1%} of the {unsure.sum()} with P of 0.02 to 0.98"
    )
    shares = ", ".join(f"{name} {share:.3f}" for name, share in zip(QUANTITIES, np.mean(covered, axis=0), strict=True))
    print(f"intervals of 90 % cover: {shares}")


def _print(name: str, table: np.ndarray) -> None:
    words = []
    for place, quantity in enumerate(QUANTITIES):
        values = table[:, place]
        low, high = np.quantile(values, [0.16, 0.84])
        words.append(
            f"{quantity} median {np.exp(np.median(values)):.3f} dispersion {np.std(values):.3f} "
            f"(half of 16-84 %: {0.5 * (high - low):.3f}, worst {np.max(np.abs(values)):.2f})"
        )
    print(f"{name} ({len(table)}): " + "; ".join(words))


def cost(motion: StrongMotion, runs: int) -> None:
    """Print the time of a spectrum, of what it does beside the solver, of a body that reads it, and of the rule's."""
    record = motion.record
    acceleration, dt = record.acceleration[: round(60.0 / record.dt)], record.dt

    def median(call):
        call()
        times = []
        for _ in range(runs):
            start = time.thread_time()
            call()
            times.append(time.thread_time() - start)
        return statistics.median(times)

    lanes = spectrum_lanes(acceleration, dt, threads=1)
    marched = median(lambda: spectrum_lanes(acceleration, dt, threads=1))
    summed = median(lambda: OverturningSpectrum(lanes))
    spectrum, random = OverturningSpectrum(lanes), np.random.default_rng(0)
    bodies = Block.from_parameters(
        p=np.exp(random.uniform(math.log(0.6), math.log(7.0), 1000)),
        alpha=random.uniform(0.06, 0.25, 1000),
        restitution=random.uniform(0.85, 1.0, 1000),
        log=False,
    )
    read = median(lambda: spectrum.factors(bodies)) / 1000
    blocks = Block.from_parameters(p=np.repeat(lanes.p, 36), alpha=0.125, restitution=0.9, log=False)
    factors = (
        np.tile(np.geomspace(0.5, 4.0, 36), lanes.p.size)
        * np.exp(np.repeat(lanes.bottom, 36))
        / np.repeat(lanes.p, 36)
        * 9.80665
        * math.tan(0.125)
    )
    plain = median(lambda: recorded_response(blocks, acceleration, dt, block_scale=factors, threads=1)) / blocks.p.size
    waves = rp.half_waves(replace(record, acceleration=acceleration))
    parts = waves.start, waves.centroid, waves.end, waves.impulse
    by_rule = median(lambda: half_wave_lanes(*parts, threads=1))
    count = lanes.log_x.size
    print(
        f"{record.id}, {acceleration.size} samples of {dt:g} s: {count} lanes in {marched:.2f} s, "
        f"{marched / count * 1e6:.0f} us a lane, {marched / count / acceleration.size * 1e9:.1f} ns a lane-sample "
        f"({marched / count / plain:.2f} times a lane of C = 0.9); sums {summed:.2f} s; a body {read * 1e6:.0f} us; "
        f"through its {len(waves)} half-waves {by_rule:.2f} s, {by_rule / count * 1e6:.0f} us a lane"
    )


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("records", nargs="+", help="folders or archives of records")
    parser.add_argument("--units", help="unit of files that do not name one")
    parser.add_argument("--dt", type=float, help="interval of files that do not name one [s]")
    parser.add_argument("--pairs", type=int, default=500, help="pairs of record and body")
    parser.add_argument("--cost", action="store_true", help="time it instead")
    parser.add_argument("--rotation", action="store_true", help="the limit states of rotation instead")
    parser.add_argument("--wall", action="store_true", help="bodies before a wall")
    parser.add_argument("--runs", type=int, default=5, help="calls of which the median is taken")
    args = parser.parse_args()
    logging.disable(logging.CRITICAL)
    records, _ = rp.read_all(args.records, units=args.units)
    motions, _ = strong_motions(records)
    if args.cost:
        cost(motions[0], args.runs)
    elif args.rotation:
        rotation_error(motions, args.pairs)
    else:
        error(motions, args.pairs, args.wall)


if __name__ == "__main__":
    main()
