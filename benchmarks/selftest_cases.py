"""Make the stored cases of ``rockpulse selftest``: ``python benchmarks/selftest_cases.py`` (``make selftest-cases``).

:mod:`precise_rocking` solves every case with 42 digits: unchanged, with C reduced by 1e-13, and with the record
increased by 1e-13. The allowed error is three times the effect of these changes, at least 1e-12, rounded up to a power
of ten.
"""

import csv
import math
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from itertools import pairwise
from typing import Any

from make_reference import PERTURBATION, text
from precise_rocking import HALF_PI, ONE, Answer, Real, numbers, real, respond

from rocking.body.supports import SAMPLES
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.studies.selftest.selftest import COLUMNS, TABLE, Case

PULSE, TWO, MANY = "-4", "4 -6", "2 -3 4 -5 6 -4 3 -5 4 -2"
STRONG = "3 -5 7 -6 8 -7 5 -4 6 -3 2 -1"
#: Cases by name; what is not named is as in DEFAULT. The near-critical ones get their factor by bisection.
DEFAULT = {"kind": "plain", "equation": "nonlinear", "width": 0.5, "height": 2.0, "restitution": 0.9, "dt": 1 / 64}
DEFAULT |= {"samples": 32, "ground": TWO, "quiet": 1, "vertical": "", "scale": 1.0, "wall": 0, "floor": 0.0}
DEFAULT |= {"stiffness": 0.0, "tie_height": 0.0}
CASES: dict[str, dict[str, Any]] = {
    "one pulse": {"ground": PULSE, "quiet": 0},
    "one pulse, linear": {"ground": PULSE, "quiet": 0, "equation": "linear"},
    "two pulses": {},
    "two pulses, linear": {"equation": "linear"},
    "ten pulses": {"ground": MANY, "samples": 16},
    "ten pulses, linear": {"ground": MANY, "samples": 16, "equation": "linear"},
    "ten pulses, overturned": {"ground": MANY, "samples": 32},
    "ten pulses, overturned, linear": {"ground": MANY, "samples": 32, "equation": "linear"},
    "at rest": {"ground": "1 -2 1", "samples": 16},
    "slender": {"ground": "1 -1.5 2 -1", "width": 0.5, "height": 5.0, "restitution": 0.98, "samples": 16},
    "squat": {"ground": "8 -10 9", "width": 1.2, "height": 2.0, "restitution": 0.6, "samples": 16},
    "C = 0": {"ground": MANY, "samples": 16, "restitution": 0.0},
    "C = 0, linear": {"ground": MANY, "samples": 16, "restitution": 0.0, "equation": "linear"},
    "C = 1": {"ground": "3 -4 3", "samples": 16, "restitution": 1.0},
    "C = 1, linear": {"ground": "3 -4 3", "samples": 16, "restitution": 1.0, "equation": "linear"},
    "p = 0.3": {"ground": "1 -2 2 -1", "width": 24.0, "height": 161.65, "samples": 128},
    "p = 0.3, linear": {"ground": "1 -2 2 -1", "width": 24.0, "height": 161.65, "samples": 128, "equation": "linear"},
    "p = 20": {"ground": "3 -5 4 -3", "width": 0.009, "height": 0.03566, "dt": 1 / 1024},
    "p = 20, long samples": {"ground": "3 -5 4", "width": 0.009, "height": 0.03566, "dt": 1 / 64, "samples": 4},
    "2000 Hz": {"ground": "4 -6 5", "dt": 0.0005, "samples": 512},
    "2000 Hz, linear": {"ground": "4 -6 5", "dt": 0.0005, "samples": 512, "equation": "linear"},
    "just below overturning": {"kind": "near-critical", "ground": TWO, "quiet": 4, "scale": -1e-8},
    "just above overturning": {"kind": "near-critical", "ground": TWO, "quiet": 4, "scale": 1e-8},
    "just below overturning, linear": {"kind": "near-critical", "quiet": 4, "scale": -1e-8, "equation": "linear"},
    "just above overturning, linear": {"kind": "near-critical", "quiet": 4, "scale": 1e-8, "equation": "linear"},
    "before a wall": {"kind": "one-sided", "ground": "4 -6 4 -5 4", "samples": 16, "restitution": 0.6, "wall": 1},
    "before a wall, overturned": {"kind": "one-sided", "ground": "-8", "samples": 64, "restitution": 0.6, "wall": 1},
    "elastic ties": {
        "kind": "tied",
        "ground": "6 -8 7",
        "quiet": 8,
        "restitution": 0.5,
        "stiffness": 4000.0,
        "tie_height": 1.5,
    },
    "stiff ties": {
        "kind": "tied",
        "ground": STRONG,
        "samples": 16,
        "quiet": 8,
        "restitution": 0.6,
        "stiffness": 40000.0,
        "tie_height": 1.75,
    },
    "vertical": {"kind": "vertical", "ground": "2.5 -3.5 2", "vertical": "-3 4 -2", "quiet": 0},
    "vertical, overturned": {"kind": "vertical", "ground": "2.5 -3.5 2", "vertical": "-4 4 -4", "quiet": 0},
    "vertical, ten pulses": {"kind": "vertical", "ground": MANY, "vertical": "2 -3 4 -4 3 -2 2 -3 2 -1", "samples": 16},
    "on a floor": {"kind": "floor", "ground": "1.5 -2 1.5", "floor": 0.5, "samples": 16},
}
DAMPING = 0.05


def floor_of(case: Case) -> tuple[list[Real], float]:
    """Acceleration of the floor by the exact motion of the oscillator on each sample, and its step."""
    ground, _ = case.motions()
    parts = math.ceil(case.dt * SAMPLES / case.floor * (1.0 - 1e-9))
    h = real(case.dt) / parts
    rate, ratio = 4 * HALF_PI / real(case.floor), real(DAMPING)
    damped = rate * numbers.sqrt(1 - ratio**2)
    fine = [real(g) + (real(e) - real(g)) * j / parts for g, e in pairwise(ground) for j in range(parts)]
    fine += [real(ground[-1])] + [real(0)] * int(60 * case.floor / float(h))
    y, v, found = real(0), real(0), []
    for now, then in pairwise(fine):
        found.append(now + (-now - 2 * ratio * rate * v - rate**2 * y))
        # y_p = a + b t solves the forced equation of -(now + slope t); the rest oscillates freely.
        b = -(then - now) / h / rate**2
        a = (-now - 2 * ratio * rate * b) / rate**2
        free, speed = y - a, v - b
        decay, sine, cosine = numbers.exp(-ratio * rate * h), numbers.sin(damped * h), numbers.cos(damped * h)
        other = (speed + ratio * rate * free) / damped
        y, v = (
            a + b * h + decay * (free * cosine + other * sine),
            b + decay * (speed * cosine - (ratio * rate * other + damped * free) * sine),
        )
    loud = max(k for k, value in enumerate(found) if abs(value) > 1e-3)
    count = max((ground.size - 1) * parts + 1, loud + 2)
    return found[:count], float(h)


def answered(case: Case, restitution: Real = ONE, record: Real = ONE) -> Answer:
    """The case in 42 digits: p, alpha and the tie from its sizes, with factors on C and on the record."""
    gravity, width, height = real(STANDARD_GRAVITY), real(case.width), real(case.height)
    radius = numbers.sqrt(width**2 + height**2) / 2
    ground, up = case.motions()
    motion, dt = (list(ground), case.dt) if not case.floor else floor_of(case)
    return respond(
        numbers.sqrt(3 * gravity / (4 * radius)),
        numbers.atan(width / height),
        case.restitution,
        motion,
        dt,
        case.equation,
        case.scale,
        STANDARD_GRAVITY,
        restitution_factor=restitution,
        record_factor=record,
        vertical=list(up) if case.vertical else None,
        wall=bool(case.wall),
        kappa=real(case.stiffness) * real(case.tie_height) ** 2 / (real(Case.MASS) * gravity * radius),
    )


def critical(case: Case) -> float:
    """The factor on the record at which a case overturns first, to 1e-12, between a rocking and an overturning one."""
    low, high = 0.1, 4.0
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if answered(replace(case, scale=middle)).outcome == "OVERTURNS" else (middle, high)
    return high


def row(name: str) -> dict[str, object]:
    """A case with its answer and the bound of an error."""
    case = Case(name, **(DEFAULT | CASES[name]))
    if case.kind == "near-critical":
        case = replace(case, scale=critical(replace(case, scale=1.0)) * (1.0 + case.scale))
    exact = answered(case)
    changed = [answered(case, ONE - PERTURBATION), answered(case, ONE, ONE + PERTURBATION)]
    assert {one.outcome for one in changed} == {exact.outcome}, name
    moved = 0.0 if exact.outcome == "OVERTURNS" else max(float(abs(one.peak - exact.peak)) for one in changed)
    bound = 10.0 ** math.ceil(math.log10(max(3.0 * moved, 1e-12)) - 1e-9)
    return {**asdict(case), "peak": text(exact.peak), "outcome": exact.outcome, "bound": f"{bound:.0e}"}


def main() -> None:
    """Write the table."""
    with ProcessPoolExecutor() as pool, TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for one in pool.map(row, CASES):
            writer.writerow(one)
            print(one["case"], one["outcome"], one["peak"], one["bound"], one["scale"], flush=True)


if __name__ == "__main__":
    main()
