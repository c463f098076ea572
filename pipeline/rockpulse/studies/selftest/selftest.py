"""The stored cases of `rockpulse selftest`: reference results, and the errors and run times on this machine.

The ground motion of a case consists of parabolic half-waves with exact binary samples. ``cases.csv`` has the reference
results, computed by ``benchmarks/selftest_cases.py`` with 42 digits, and the largest allowed error of each case.
"""

from __future__ import annotations

import csv
import time
from dataclasses import dataclass, fields
from decimal import Decimal
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from rocking.body.block import Block
from rocking.body.restraint import Tie
from rocking.body.supports import floor_motion
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rockpulse.studies.selftest.baseline import baseline_response

__all__ = ["COLUMNS", "TABLE", "AnsweredCase", "Case", "CaseResult", "solve_case", "stored_cases"]
TABLE = Path(__file__).with_name("cases.csv")
#: Number of scale factors of a case that are solved in one call to measure its run time.
FACTORS = np.linspace(0.9, 1.1, 64)
#: Largest number of samples of a case that is also solved with solve_ivp, which takes 0.15 ms a sample.
FEW_SAMPLES = 200


def synthetic_motion(peaks: str, samples: int, quiet: int) -> np.ndarray:
    """Return parabolic half-waves of `samples` samples with these peaks [m/s2], then `quiet` half-waves of zeros."""
    place = np.arange(samples) / samples
    shape = 4.0 * place * (1.0 - place)
    return np.concatenate([*(float(peak) * shape for peak in peaks.split()), np.zeros(quiet * samples + 1)])


@dataclass(frozen=True)
class Case:
    """One case of the self-test: a body and the ground motion that acts on it."""

    MASS: ClassVar[float] = 1000.0  # mass of every body with ties [kg]

    case: str
    kind: str
    equation: Any  # "nonlinear" or "linear"
    width: float  # [m]
    height: float  # [m]
    restitution: float  # C, or for a body beside a wall the rebound e [-]
    dt: float  # [s]
    samples: int  # number of samples of a half-wave; a power of two
    ground: str  # peaks of the half-waves of the ground motion [m/s2]
    quiet: int  # number of half-waves of zeros at the end
    vertical: str  # peaks of as many vertical half-waves [m/s2]; empty without vertical motion
    scale: float  # scale factor [-]
    wall: int  # 1 for a body beside a wall
    floor: float  # period of the building whose top carries the body [s]; 0 on the ground
    stiffness: float  # stiffness of elastic ties on both sides [N/m]; 0 for none
    tie_height: float  # [m]

    def motions(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the horizontal and the vertical ground acceleration [m/s2]."""
        both = [synthetic_motion(one, self.samples, self.quiet) for one in (self.ground, self.vertical or self.ground)]
        return both[0], both[1] if self.vertical else np.zeros(both[0].size)

    def block(self) -> Block:
        """Return the block of the case."""
        size: dict[str, Any] = {"width": self.width, "height": self.height, "log": False}
        if self.wall:
            return Block(**size, one_sided=True, rebound=self.restitution)
        ties = [Tie(self.tie_height, self.stiffness, side="both")] if self.stiffness else []
        return Block(**size, restitution=self.restitution, ties=ties, mass=self.MASS if ties else None)


class AnsweredCase(NamedTuple):
    """A case with its reference result and the largest allowed error."""

    case: Case
    peak: Decimal
    outcome: str
    bound: float


class CaseResult(NamedTuple):
    """The result of a case on this machine."""

    stored: AnsweredCase
    outcome: str
    error: float  #: error of theta_max/alpha_c [-]; 0 if both overturn, inf if the outcomes differ
    cost: float  #: time per active sample [ns] for many scale factors in one call; NaN without active samples
    error_of_solve_ivp: float  #: NaN if the case is not solved with solve_ivp
    cost_of_solve_ivp: float

    @property
    def passed(self) -> bool:
        """True if the error does not exceed the largest allowed error."""
        return self.error <= self.stored.bound


COLUMNS = (*(one.name for one in fields(Case)), "peak", "outcome", "bound")


def stored_cases(path: Path = TABLE) -> list[AnsweredCase]:
    """Read the stored cases with their reference results, in the order of the file."""
    kinds = {one.name: {"float": float, "int": int}.get(str(one.type), str) for one in fields(Case)}
    with path.open(encoding="utf-8", newline="") as file:
        return [
            AnsweredCase(
                Case(**{name: kind(row[name]) for name, kind in kinds.items()}),
                Decimal(row["peak"]),
                row["outcome"],
                float(row["bound"]),
            )
            for row in csv.DictReader(file)
        ]


def solve_case(stored: AnsweredCase) -> CaseResult:
    """Solve a case on this machine with one thread, and compare the result with the reference."""
    case, block = stored.case, stored.case.block()
    ground, up = case.motions()
    dt = case.dt
    if case.floor:
        floor = floor_motion(ground, dt, case.floor)
        ground, dt, up = floor.acceleration, floor.dt, np.zeros(floor.acceleration.size)
    options: dict[str, Any] = {"equation": case.equation, "vertical": up if case.vertical else None, "threads": 1}
    found = recorded_response(block, ground, dt, scale=case.scale, **options)
    outcome, peak = Outcome(int(found.outcome)).name, float(found.peak_rotation_ratio)
    start = time.perf_counter()
    many = recorded_response(block, ground, dt, scale=case.scale * FACTORS, **options)
    cost = _cost(start, int(np.sum(np.asarray(many.active_samples))))
    error = _error(stored, outcome, peak)
    if case.kind != "plain" or ground.size > FEW_SAMPLES:
        return CaseResult(stored, outcome, error, cost, np.nan, np.nan)
    start = time.perf_counter()
    given = float(block.p), float(block.alpha_c), case.restitution
    other = baseline_response(*given, ground, dt, case.equation, case.scale, block.gravity)
    spent = _cost(start, other.active_samples)
    return CaseResult(stored, outcome, error, cost, _error(stored, other.outcome, other.peak_rotation_ratio), spent)


def _cost(start: float, active: int) -> float:
    """Return the time since `start` [ns] divided by `active`, the number of samples in which the block moves."""
    return 1e9 * (time.perf_counter() - start) / active if active else np.nan


def _error(stored: AnsweredCase, outcome: str, peak: float) -> float:
    """Return the error of the peak, computed with all digits of the reference; inf if the outcomes differ."""
    if outcome != stored.outcome:
        return np.inf
    return float(abs(Decimal(peak) - stored.peak)) if stored.peak.is_finite() else 0.0
