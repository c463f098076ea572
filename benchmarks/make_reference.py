"""Make the stored reference table: ``python benchmarks/make_reference.py``. The command continues an interrupted run.

:mod:`precise_rocking` solves every case three times: unchanged, with C multiplied by 1 - 1e-13, and with the record
scaled by 1 + 1e-13. The table therefore shows how well a case is conditioned.

The cases are synthetic motions with synthetic blocks, and the sample records of ``data/samples`` (conditioned with the
default options, rounded as in ``sample_motion``) with the bodies of ``site.toml`` and some more.
"""

import argparse
import csv
import datetime
import math
from collections.abc import Iterator
from decimal import Decimal, localcontext
from pathlib import Path
from typing import NamedTuple

import numpy as np
from precise_rocking import BITS, LONGEST_STEP, ONE, TERM, Real, respond

from laboratory.accuracy.reference import COLUMNS, SYNTHETIC, TABLE, motion_sha256, sample_motion
from rocking.body.block import Block
from rockpulse.config.configuration import load_config
from rockpulse.readers import read
from rockpulse.record.conditioning import condition
from rockpulse.record.record import STANDARD_GRAVITY
from synthetic import synthetic_lanes, synthetic_motion

TOP = Path(__file__).parents[1]
PERTURBATION = ONE / 10**13
DIGITS = 24
MOTIONS = 20
MOTION_PGA = 3.0  # of the synthetic motions [m/s2]
LANES_SEED = 2026
LINEAR_LANES, NONLINEAR_LANES = 400, 320
AT_REST_LANES = 4  # lanes that never lift off are of little use
SAMPLE_FILES = ("CICCC.RAW", "CICLC.v1", "CITOW2.RAW")
MORE_BODIES = {  # width and height [m]
    "figurine": (0.06, 0.24),
    "shelf": (0.3, 1.9),
    "pier": (1.0, 5.0),
    "tower": (6.0, 40.0),
}


class Case(NamedTuple):
    """One lane and the motion it stands on."""

    name: str
    motion: str
    acceleration: np.ndarray  # (n,) [m/s2]
    dt: float
    scale: float
    equation: str
    p: float
    alpha: float
    restitution: float


def synthetic_cases() -> Iterator[Case]:
    """Lane after lane, linear and nonlinear; C = 0.9, with 0.98 and Housner's among them."""
    lanes = synthetic_lanes(LANES_SEED, 2 * LINEAR_LANES)
    motions = {seed: synthetic_motion(seed, pga=MOTION_PGA) for seed in range(MOTIONS)}
    taken = at_rest = 0
    for p, alpha, _, pga in zip(*(values.tolist() for values in lanes), strict=True):
        if pga <= math.tan(alpha) * STANDARD_GRAVITY:
            at_rest += 1
            if at_rest > AT_REST_LANES:
                continue
        seed = taken % MOTIONS
        # 7 and 12 have no factor in common with the number of motions, so that every motion meets both.
        restitution = 0.98 if taken % 27 == 7 else 1.0 - 1.5 * math.sin(alpha) ** 2 if taken % 27 == 12 else 0.9
        for equation, count in (("linear", LINEAR_LANES), ("nonlinear", NONLINEAR_LANES)):
            if taken < count:
                yield Case(
                    f"synthetic-{taken:03d}-{equation}",
                    f"{SYNTHETIC}{seed}",
                    motions[seed],
                    0.01,
                    pga / MOTION_PGA,
                    equation,
                    p,
                    alpha,
                    restitution,
                )
        taken += 1
        if taken == LINEAR_LANES:
            return


def sample_cases() -> Iterator[Case]:
    """Every horizontal channel of the strong sample records, every body, both equations."""
    folder = TOP / "data" / "samples" / "records"
    bodies = {block.name: block.block() for block in load_config(folder.parent / "site.toml").bodies}
    bodies |= {
        name: Block(half_width=0.5 * width, half_height=0.5 * height) for name, (width, height) in MORE_BODIES.items()
    }
    for file in SAMPLE_FILES:
        for record in read(folder / file):
            if record.orientation != "horizontal":
                continue
            motion = sample_motion(condition(record))
            for body, block in bodies.items():
                for equation in ("linear", "nonlinear"):
                    yield Case(
                        f"{record.id}-{body.replace(' ', '_')}-{equation}",
                        record.id,
                        motion,
                        record.dt,
                        1.0,
                        equation,
                        block.p,
                        block.alpha_c,
                        block.restitution,
                    )


def row(case: Case) -> list[object]:
    """The case and its three answers as a row of the table."""
    given = (case.p, case.alpha, case.restitution, case.acceleration, case.dt, case.equation, case.scale)
    exact = respond(*given)
    lowered = respond(*given, restitution_factor=ONE - PERTURBATION)
    scaled = respond(*given, record_factor=ONE + PERTURBATION)
    named = case.name, case.motion, motion_sha256(case.acceleration), *case[3:], STANDARD_GRAVITY
    changed = [value for one in (lowered, scaled) for value in (text(one.peak), one.outcome, one.impacts)]
    return [*named, text(exact.peak), exact.outcome, exact.overturning_time, exact.impacts, *changed]


def text(peak: Real) -> str:
    """A peak in `DIGITS` digits, the same text for a number of gmpy2 and of mpmath."""
    if not math.isfinite(peak):
        return str(float(peak))
    numerator, denominator = (int(part) for part in peak.as_integer_ratio())
    with localcontext(prec=4 * BITS):  # more than the digits of any quotient here: it is exact, and rounded once
        mantissa, exponent = f"{Decimal(numerator) / Decimal(denominator):.{DIGITS - 1}e}".split("e")
    return f"{mantissa}e{int(exponent) if numerator else 0:+03d}"


def head() -> str:
    """Where the numbers come from."""
    today = datetime.date.today().isoformat()
    return (
        "# Reference response of rocking blocks to ground motions, made by benchmarks/make_reference.py.\n"
        f"# {today}: {BITS}-bit numbers (gmpy2 or mpmath), steps p dt <= {LONGEST_STEP}, Taylor terms\n"
        f"# down to {TERM:g} of the largest (order 9 to 27), linear samples by the exact exponential map.\n"
        "# peak_text: theta_max/alpha_c, inf when overturned; under lowered_ C times 1 - 1e-13 and\n"
        "# under scaled_ the record times 1 + 1e-13.\n"
        "# overturning_time [s]: nonlinear, theta = pi/2; impacts: faster than 1e-3 p alpha_c, before overturning.\n"
    )


def main() -> None:
    """Write the rows that the table does not have yet."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--output", type=Path, default=TABLE, help="table to write or to go on with")
    parser.add_argument("--most", type=int, default=10**6, help="rows to add in this run")
    options = parser.parse_args()
    done: set[str] = set()
    if options.output.exists():
        lines = options.output.read_text().splitlines()
        done = {line.split(",", 1)[0] for line in lines if not line.startswith("#")}
    else:
        options.output.write_text(head() + ",".join(COLUMNS) + "\n")
    added = 0
    with options.output.open("a", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for case in (*synthetic_cases(), *sample_cases()):
            if case.name in done or added == options.most:
                continue
            writer.writerow(row(case))
            file.flush()
            added += 1
    print(f"{options.output}: {added} rows added")


if __name__ == "__main__":
    main()
