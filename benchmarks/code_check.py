"""Where the kinematic check of the code is unsafe and where it is dear, against the time histories.

``python benchmarks/code_check.py FOLDER --units g [--events TABLE]``: strong channels by the protocol of the rule on
its twelve bodies (slenderness 4, 6, 8, 12 by R 1, 2, 4 m), each at half, one and twice its strength, with its own PGA
as a_g S and its own spectrum as S_e, q = 2, FC = 1. A case overturns where the probability of overturning is 0.5 or
more. Missed: cases that overturn and pass; false: cases that stand and do not. Intervals of 90 % by resampled
earthquakes (BCa).
"""

from __future__ import annotations

import argparse
import logging

import numpy as np
import pandas as pd
from scipy.stats import bootstrap

import rockpulse as rp
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.studies.accuracy.model_form import blocks
from rockpulse.studies.check.kinematic import kinematic_check
from rockpulse.studies.rule.cases import StrongMotion, strong_motions

LEVELS = (0.5, 1.0, 2.0)
CHECKS = ("linear", "nonlinear", "both")


def cases(motion: StrongMotion) -> np.ndarray:
    """(level, body, 1 + checks) of 0 and 1: whether each case overturns, and whether it passes each check."""
    bodies, record = blocks(), motion.record
    spectrum = rp.overturning_spectrum(record)
    capacity = rp.overturning_factors(spectrum, bodies)
    check = kinematic_check(
        bodies, lambda periods: np.array([spectral_acceleration(record, float(one)) for one in periods]), record.pga
    )
    found = []
    for level in LEVELS:
        falls = level >= capacity["factor_50"]
        passes = [check.linear >= level, check.nonlinear >= level]
        found.append(np.stack([falls, *passes, passes[0] & passes[1]], axis=1))
    return np.array(found, dtype=float)


def rates(sums: np.ndarray) -> tuple[float, float]:
    """Missed over overturned and false over standing, from sums (missed, overturned, false, standing)."""
    missed, fallen, false, standing = sums
    return (missed / fallen if fallen else np.nan), (false / standing if standing else np.nan)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("records", nargs="+")
    parser.add_argument("--units")
    parser.add_argument("--events", help="CSV table with the columns record, event")
    args = parser.parse_args()
    logging.disable(logging.CRITICAL)
    titles = {} if args.events is None else dict(pd.read_csv(args.events, dtype=str)[["record", "event"]].to_numpy())
    motions, _ = strong_motions(rp.read_all(args.records, units=args.units)[0], titles=titles)
    table = np.array([cases(one) for one in motions])  # channel, level, body, 4
    events = np.array([one.event for one in motions])
    names = np.unique(events)
    print(f"{len(motions)} channels, {names.size} earthquakes, {table.shape[2]} bodies")
    for place, level in enumerate((*LEVELS, None)):
        part = table if level is None else table[:, place : place + 1]
        falls = part[..., 0] > 0
        print(f"factor {'all' if level is None else f'{level:g}'}: {int(falls.sum())} of {falls.size} overturn")
        for column, name in enumerate(CHECKS, 1):
            passes = part[..., column] > 0
            counts = np.stack([falls & passes, falls, ~falls & ~passes, ~falls]).astype(float)
            of_events = np.array([counts[:, events == event].sum(axis=(1, 2, 3)) for event in names])
            told = []
            for what in (0, 1):
                value = rates(of_events.sum(axis=0))[what]

                def share(*columns, what=what):
                    return rates(np.array([np.sum(one) for one in columns]))[what]

                low, high = np.nan, np.nan
                if names.size > 3 and 0.0 < value < 1.0:
                    found = bootstrap(
                        tuple(of_events.T),
                        share,
                        paired=True,
                        vectorized=False,
                        n_resamples=1000,
                        confidence_level=0.9,
                        method="BCa",
                        rng=np.random.default_rng(0),
                    )
                    low, high = found.confidence_interval
                told.append(f"{value:.1%}" + ("" if np.isnan(low) else f" ({low:.1%} to {high:.1%})"))
            print(f"  {name:<10} missed {told[0]}, false {told[1]}")


if __name__ == "__main__":
    main()
