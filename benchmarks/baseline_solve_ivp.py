"""What a user writes today: scipy's ``solve_ivp`` with impact events (``baseline``), timed.

``python benchmarks/baseline_solve_ivp.py`` times it on cases of the stored reference and prints its error beside it.
"""

from __future__ import annotations

import argparse
import statistics
import time

from rockpulse.studies.accuracy.baseline import response
from rockpulse.studies.accuracy.reference import load_reference, motion_of


def main() -> None:
    """Time the baseline on cases of the stored reference."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--method", default="RK45", help="method of solve_ivp")
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--cases", type=int, default=6, help="cases of each equation")
    options = parser.parse_args()
    table = load_reference()
    table = table[table["motion"].str.startswith("synthetic") & (table["outcome"] != "AT_REST")]
    print(f"{'case':28} {'peak':>12} {'reference':>12} {'active':>7} {'s':>7} {'ns/sample':>10}")
    for equation in ("linear", "nonlinear"):
        costs = []
        for row in table[table["equation"] == equation].head(options.cases).itertuples():
            acceleration, dt = motion_of(row)
            start = time.perf_counter()
            answer = response(
                row.p,
                row.alpha,
                row.restitution,
                acceleration,
                dt,
                equation,
                row.scale,
                row.gravity,
                options.method,
                options.rtol,
            )
            seconds = time.perf_counter() - start
            costs.append(1e9 * seconds / answer.active_samples)
            print(
                f"{row.case:28} {answer.peak_rotation_ratio:12.9f} {row.peak:12.9f} {answer.active_samples:7} "
                f"{seconds:7.2f} {costs[-1]:10.0f}"
            )
        print(f"{equation}, {options.method}, rtol {options.rtol:g}: median {statistics.median(costs):.0f} ns")


if __name__ == "__main__":
    main()
