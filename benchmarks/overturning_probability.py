"""Error and run time of the probability of overturning, compared with plain draws of the nonlinear equation.

``python benchmarks/overturning_probability.py FOLDER [--units g] [--pairs 500]`` uses the strong horizontal channels of
a folder, by the protocol of the rule (docs/decisions/009), and random bodies of slenderness 3.5 to 18, R 0.3 to 8 m and
C of 0.93 to 1 times Housner's. Four computations are compared: a body's own marches in the limit of slender blocks
(the default), its own marches by the nonlinear equation, the overturning spectrum of the record, and a spectrum that
many bodies share.

The reference has other random numbers and no isotonic fit of P. P at one scale factor near the capacity is the share of
4096 plain draws of scale factor, C and alpha that overturn (its standard error is at most 0.008). `factor_10` and
`factor_50` are crossings of P from 2048 marches in a scrambled Sobol set over (C, alpha, ln f) that covers the
crossings by 0.7 on both sides, with the uncertainty of the scale factor as a normal kernel; 512 marches from uplift to
3 above the capacity in ln f show where they are and complete the mean.

``--wall`` draws bodies in contact with a wall, with Sorrentino's rebound.
"""

import argparse
import logging
import math
from collections.abc import Callable

import numpy as np
from scipy.stats import norm, qmc

from laboratory.ensemble import StrongMotion, add_record_arguments, read_strong
from rocking import Block, OverturningSpectrum, Uncertainty, overturning_probability, recorded_response, spectrum_lanes
from rocking.body.limits import sorrentino
from rocking.march.demand import ground_demand, within_measured_range
from rocking.response import Outcome
from rocking.search.capacity import uplift_scale
from rocking.spectrum.probability import MOST_RESTITUTION, factor_at, rising
from rocking.spectrum.sharing import FEWEST_SHARING, SHARED_INTERPOLATION, shared_groups
from rockpulse.assessment.probability import SHARED_DENSITY

UNCERTAINTY = Uncertainty()
#: Draws of one body for P, marches for the crossings, and marches that show where these are.
DRAWS, CURVE, WIDE = 4096, 2048, 512
#: How far the marches reach beyond both crossings and the capacity, in ln f, and the part without levels at both ends.
REACH, ABOVE, EDGE = 0.7, 3.0, 0.3
#: Distance of levels in ln f.
STEP = 0.02
#: Standard deviation in ln f of the scale factor at which P is compared, about the median one.
NEAR = 0.25
KINDS = ("own, slender limit", "own, nonlinear", "spectrum of the record", "shared spectrum")
QUANTITIES = ("factor_10", "factor_50", "factor_mean")


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


def overturned(motion: StrongMotion, body: Block, log_factor: np.ndarray, ranks: np.ndarray) -> np.ndarray:
    """Whether marches (n,) of a body with the quantiles (n, 2) of C and alpha overturn."""
    least, most = UNCERTAINTY.restitution
    restitution = np.minimum(body.restitution * (least + (most - least) * ranks[:, 0]), MOST_RESTITUTION)
    alpha = body.alpha_c * np.exp(-UNCERTAINTY.geometry * norm.ppf(0.5 + 0.5 * ranks[:, 1]))
    wall = {"restitution": "housner", "one_sided": True, "rebound": restitution}
    how = wall if body.side else {"restitution": restitution}
    lanes = Block.from_parameters(np.full(alpha.size, body.p), alpha, gravity=body.gravity, log=False, **how)
    lanes = lanes.mirrored() if body.side < 0 else lanes
    record = motion.record
    verdict = None
    if np.all(within_measured_range(lanes, record.dt)):
        verdict = ground_demand(lanes, record.acceleration, record.dt)  # ends a march whose outcome is certain
    found = recorded_response(
        lanes, record.acceleration, record.dt, block_scale=np.exp(log_factor), verdict=verdict, threads=1
    )
    return (found.outcome == Outcome.OVERTURNS) | (found.outcome == Outcome.UNRESOLVED)


class Curve:
    """P from marches with ln f evenly from `bottom` to `top`, at levels that lie inside by `EDGE`."""

    def __init__(self, motion: StrongMotion, body: Block, ends: tuple[float, float], count: int, seed: int) -> None:
        self.bottom, self.top = ends
        draws = qmc.Sobol(3, seed=seed).random(count)
        self.log_factor = self.bottom + (self.top - self.bottom) * draws[:, 2]
        self.over = overturned(motion, body, self.log_factor, draws)
        self.level = np.arange(self.bottom + EDGE, self.top - EDGE, STEP)
        bells = norm.pdf((self.log_factor - self.level[:, np.newaxis]) / UNCERTAINTY.factor)
        self.probability = bells @ self.over / np.maximum(bells.sum(axis=1), 1e-300)

    def log_factor_at(self, share: float) -> float:
        """Return the logarithm of the scale factor at a probability."""
        found = float(factor_at(share, np.exp(self.level), rising(self.probability)))
        return math.log(found) if found < math.inf else math.inf

    def safe(self, low: float, high: float) -> float:
        """Return the length of ln f between two ends in which marches survive."""
        here = (self.log_factor >= low) & (self.log_factor < high)
        return (high - low) * (1.0 - np.mean(self.over[here])) if np.any(here) else 0.0


def reference(
    motion: StrongMotion, body: Block, centre: float, seed: int
) -> tuple[dict[str, float], Callable[[float], float]]:
    """Scale factors of one body by the nonlinear equation, and P at any scale factor by 4096 plain draws."""
    bottom = float(np.log(uplift_scale(body.lanes(1), motion.record.acceleration)[0])) - 0.2
    ends = min(bottom - EDGE, centre - 1.0), max(centre, bottom) + ABOVE
    wide = Curve(motion, body, ends, WIDE, seed)
    near = max(wide.log_factor_at(0.1) - REACH, ends[0]), min(wide.log_factor_at(0.5) + REACH, ends[1])
    own = Curve(motion, body, near, CURVE, seed + 1)
    if math.isinf(own.log_factor_at(0.5)):  # a plateau near 0.5 beyond the crossing of few marches
        near = ends
        own = Curve(motion, body, near, DRAWS, seed + 1)
    found = {f"factor_{share}": math.exp(own.log_factor_at(share / 100)) for share in (10, 50)}
    length = wide.safe(ends[0], near[0]) + own.safe(*near) + wide.safe(near[1], ends[1])
    found["factor_mean"] = math.exp(ends[0] + length)
    random = np.random.default_rng([seed, 1])

    def plain(log_factor: float) -> float:
        draws = log_factor + UNCERTAINTY.factor * random.standard_normal(DRAWS)
        return float(np.mean(overturned(motion, body, draws, random.random((DRAWS, 2)))))

    return found, plain


def pair_errors(motion: StrongMotion, spectra: dict[int, OverturningSpectrum], pair: int, wall: bool) -> np.ndarray:
    """Return the errors of every kind of :data:`KINDS` for one pair, (4, 3 + 2 quantities): of P at one scale factor,
    that P, the slenderness, and of each quantity ln of the ratio to the reference and whether its interval contains it.
    """
    random = np.random.default_rng([17, pair])
    body, record = drawn_body(random, wall).lanes(1), motion.record
    side = int(body.side[0])
    if side not in spectra:
        lanes = spectrum_lanes(record.acceleration, record.dt, side=side, threads=1)
        spectra[side] = OverturningSpectrum(lanes, UNCERTAINTY)
    answers = [
        overturning_probability(
            body, record.acceleration, record.dt, UNCERTAINTY, factor_max=1e3, slender_limit=slender, threads=1
        )
        for slender in (True, False)
    ]
    crowd = body.take(np.zeros(FEWEST_SHARING, dtype=int))
    ((_, arguments),) = shared_groups(crowd, UNCERTAINTY, own=10**9, density=SHARED_DENSITY)
    lanes = spectrum_lanes(record.acceleration, record.dt, threads=1, rotations=False, **arguments)
    both = spectra[side], OverturningSpectrum(lanes, UNCERTAINTY, SHARED_INTERPOLATION)
    read = [*answers, *(one.factors(body) for one in both)]
    truth, plain = reference(motion, body.lane(0), math.log(read[2].factor_mean[0]), 1000 * pair)
    at = truth["factor_50"] * math.exp(NEAR * random.standard_normal())
    share = plain(math.log(at))
    shares = [one.overturning([[at]])[0, 0] for one in answers] + [one.overturning(body, [[at]])[0, 0] for one in both]
    rows = []
    for own, factors in zip(shares, read, strict=True):
        row = [own - share, share, float(body.slenderness[0])]
        for name in QUANTITIES:
            value, low, high = (getattr(factors, name + end)[0] for end in ("", "_low", "_high"))
            row += [math.log(value / truth[name]), low <= truth[name] <= high]
        rows.append(row)
    return np.array(rows, dtype=float)


def error(motions: list[StrongMotion], pairs: int, wall: bool) -> None:
    """Print the errors of P and of scale factors, and how often intervals contain the reference."""
    spectra: list[dict[int, OverturningSpectrum]] = [{} for _ in motions]
    places = [pair % len(motions) for pair in range(pairs)]
    tables = np.array([pair_errors(motions[one], spectra[one], pair, wall) for pair, one in enumerate(places)])
    print(f"{len(motions)} channels, {len({one.event for one in motions})} earthquakes, {pairs} pairs")
    print_errors(tables)


def print_errors(tables: np.ndarray) -> None:
    """Print what (n, 4, k) rows of :func:`pair_errors` tell."""
    for place, kind in enumerate(KINDS):
        table = tables[:, place]
        _print(kind, table)
        for low, high in ((0.0, 4.5), (4.5, 7.0), (7.0, 20.0)):
            some = table[(table[:, 2] >= low) & (table[:, 2] < high)]
            if len(some):
                _print(f"  slenderness {low:g} to {high:g}", some)


def _print(name: str, table: np.ndarray) -> None:
    open_ = table[(table[:, 1] > 0.02) & (table[:, 1] < 0.98), 0]
    inside = [np.mean(np.abs(open_) <= limit) for limit in (0.05, 0.1)]
    print(
        f"{name} ({len(table)}): P in {len(open_)} undecided pairs: bias {np.mean(open_):+.4f}, deviation "
        f"{np.std(open_):.4f}, within 0.05 {inside[0]:.1%}, within 0.1 {inside[1]:.1%}"
    )
    for place, quantity in enumerate(QUANTITIES):
        values, covered = table[:, 3 + 2 * place], table[:, 4 + 2 * place]
        low, high = np.quantile(values, [0.16, 0.84])
        print(
            f"    {quantity}: median {np.exp(np.median(values)):.3f}, dispersion {np.std(values):.3f} "
            f"(half of 16-84 %: {0.5 * (high - low):.3f}, worst {np.max(np.abs(values)):.2f}), within 5 % "
            f"{np.mean(np.abs(values) <= 0.05):.1%}, interval covers {np.mean(covered):.3f}"
        )


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add_record_arguments(parser)
    parser.add_argument("--pairs", type=int, default=500, help="pairs of record and body")
    parser.add_argument("--wall", action="store_true", help="bodies before a wall")
    args = parser.parse_args()
    logging.disable(logging.CRITICAL)
    motions = read_strong(args)
    error(motions, args.pairs, args.wall)


if __name__ == "__main__":
    main()
