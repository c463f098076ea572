"""Coverage of the band of an annual frequency, by synthetic capacities with a known distribution.

``python benchmarks/risk_coverage.py [--cases 200] [--seed 1]`` draws capacities with a lognormal scatter between and
within earthquakes of one to four records, and uses six stripes. The true frequency for a power law has a closed form.
"""

import argparse
import math

import numpy as np

import rockpulse as rp
from rockpulse.studies.fragility.likelihood import ABOVE, FAMILIES, NOT_ABOVE, Observations
from rockpulse.studies.risk.integral import band_of, fitted_lines, integrate

LEVELS = np.array([0.4, 0.6, 0.8, 1.1, 1.5, 2.2])
FAMILY = FAMILIES["lognormal"]
#: Earthquakes, slope of the hazard, and scatter of ln capacity between and within earthquakes.
SETTINGS = ((14, 2.5, 0.25, 0.35), (14, 3.0, 0.4, 0.4), (22, 2.5, 0.25, 0.35), (8, 2.5, 0.25, 0.35))


def drawn(random: np.random.Generator, earthquakes: int, between: float, within: float) -> Observations:
    """One set of observations of capacities with median 1."""
    event = np.repeat(np.arange(earthquakes), random.integers(1, 5, earthquakes))
    capacity = np.exp(
        between * random.standard_normal(earthquakes)[event] + within * random.standard_normal(event.size)
    )
    level = np.tile(LEVELS, event.size)
    kind = np.where(np.repeat(capacity, LEVELS.size) <= level, NOT_ABOVE, ABOVE)
    return Observations.of(level, kind, np.repeat(event, LEVELS.size).astype(str))


def coverage(place: int, cases: int, seed: int, resamples: int = 500) -> tuple[int, int, int, int]:
    """Of so many cases of a setting: bands, those with the truth below and above them, and those that lost draws."""
    earthquakes, k, between, within = SETTINGS[place]
    random, hazard = np.random.default_rng([seed, place]), rp.PowerLawHazard(1e-3, k)
    # In closed form for a power law and a lognormal fragility (Cornell et al. 2002).
    truth = 1e-3 * math.exp(0.5 * (k * math.hypot(between, within)) ** 2)
    bands = low = high = lossy = 0
    for case in range(cases):
        rows = drawn(random, earthquakes, between, within)
        lines = fitted_lines(rows, FAMILY)
        estimate = math.log(integrate(FAMILY, (lines[0, 0], lines[0, 1]), hazard).frequency)
        limits = band_of(rows, FAMILY, hazard, lines, estimate, 0.9, resamples, case)
        bands += math.isfinite(limits.low)
        low += truth < limits.low
        high += truth > limits.high
        lossy += limits.lost > 0.0
    return bands, low, high, lossy


def main() -> None:
    """Print the coverage for each setting."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--resamples", type=int, default=500)
    args = parser.parse_args()
    for place, (earthquakes, k, between, within) in enumerate(SETTINGS):
        bands, low, high, lossy = coverage(place, args.cases, args.seed, args.resamples)
        print(
            f"{earthquakes} earthquakes, k {k:g}, beta {math.hypot(between, within):.2f}: {bands} bands of "
            f"{args.cases}, truth inside {1.0 - (low + high) / bands:.3f}, below {low}, above {high}, "
            f"{lossy} cases lost draws",
            flush=True,
        )


if __name__ == "__main__":
    main()
