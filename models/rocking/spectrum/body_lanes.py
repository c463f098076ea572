"""Random samples of bodies: each lane is a body with random C and angle under one scale factor.

.. note:: All bodies of a call share one scrambled Sobol set, so that the result of a body does not depend on the
   others. Free flight is UNRESOLVED and counts as overturning. Without vertical acceleration, and for bodies in the
   measured range, the computation of a lane ends as soon as its outcome is certain (docs/decisions/006).

The first stage of lanes surrounds an estimate of the capacity and is extended while its lowest lanes overturn or its
highest lanes survive. The density of the second stage is proportional to the standard deviation sqrt(P (1 - P)) of an
outcome, with P the share of nearby lanes of the first stage that overturn. The uncertainty of the scale factor is not
sampled, but applied afterwards as a smoothing kernel in ln f (:mod:`rocking.spectrum.probability`).
"""

import math
from dataclasses import dataclass, field
from itertools import count
from typing import Any

import numpy as np
from scipy.special import ndtri

from rocking.body.block import Block
from rocking.march.demand import ground_demand, within_measured_range
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rocking.search.capacity import uplift_scale
from rocking.spectrum.probability import Uncertainty, lane_bells, tail_masses

#: Truncation of the random shift of the factor and reduction of the angle, in standard deviations.
REACH = 4.0
#: Number of Sobol points drawn at once: the number of lanes in each part is a multiple of this.
SET = 32
#: Build-up (demand.py) at the estimated capacity, divided by the build-up that overturns.
BUILD_UP_AT_CAPACITY = 2.5
#: Number of lanes of the first stage, and its extent in ln f on each side of the estimate.
FIRST, FIRST_HALF = 64, 0.8
#: Number of lanes of each extension of the first stage, and its length in ln f.
MORE, MORE_LENGTH = 32, 0.8
#: The first stage is complete if all lanes within this length in ln f survive at its bottom and overturn at its top.
QUIET = 0.2
#: Number of lanes of the second stage, and their smallest density divided by the density at P = 0.5.
SECOND, FLOOR = 768, 0.2
#: Width in ln f over which the outcomes of the first stage are averaged, and number of points of the density.
NEIGHBOURS, POINTS = 0.12, 201


@dataclass(frozen=True, eq=False)
class LanePart:
    """Samples (b, n) of b bodies, computed together, and their number per unit of ln f on a grid (b, g) of ln f."""

    body: np.ndarray
    grid: np.ndarray
    density: np.ndarray
    log_factor: np.ndarray
    over: np.ndarray
    unresolved: np.ndarray


@dataclass(frozen=True, eq=False)
class BodyLanes:
    """The samples of one body: their scale factors, weights and outcomes."""

    log_factor: np.ndarray  #: (n,) ln of the factor on the record
    weight: np.ndarray  #: (n,) width in ln f that each lane represents [-]: 1 over the density of lanes at its factor
    over: np.ndarray  #: (n,) of bool, True if the lane overturns or is UNRESOLVED
    unresolved: np.ndarray  #: (n,) of bool, True if it is UNRESOLVED (free flight)
    bottom: float  #: ends of the range of ln f of the lanes
    top: float
    open: bool  #: True if lanes survive the largest factor, so that outcomes above it are unknown

    def sums(self, log_level: np.ndarray, shift: Uncertainty) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """Return weights (n, k) of n samples at k levels, and probabilities of a shift below and above all samples."""
        bells = lane_bells(self.log_factor, self.weight, log_level, shift)
        return bells, tail_masses(self.bottom, self.top, log_level, shift)


@dataclass(eq=False)
class LaneMarch:
    """Random samples of (m,) bodies under a record, whose outcomes are computed in several parts."""

    block: Block
    acceleration: np.ndarray
    dt: float
    vertical: np.ndarray | None
    uncertainty: Uncertainty
    seed: int
    threads: int | None
    parts: list[LanePart] = field(default_factory=list)

    def evenly(self, body: np.ndarray, bottom: np.ndarray, top: np.ndarray, number: int, part: int) -> None:
        """Compute `number` samples of each of b bodies, evenly distributed in ln f from `bottom` to `top` (b,)."""
        self.add(body, np.stack([bottom, top], axis=1), np.ones((body.size, 2)), number, part)

    def add(self, body: np.ndarray, grid: np.ndarray, wanted: np.ndarray, number: int, part: int) -> None:
        """Compute `number` samples of each of b bodies, with the relative density `wanted` (b, g) on a grid of ln f."""
        from scipy.stats import qmc  # its import takes half a second and is seldom needed

        points = qmc.Sobol(3, seed=np.random.default_rng([self.seed, part]))
        place = np.concatenate([points.random(SET) for _ in range(number // SET)])
        parts = 0.5 * (wanted[:, 1:] + wanted[:, :-1]) * np.diff(grid, axis=1)
        filled = np.concatenate([np.zeros((body.size, 1)), np.cumsum(parts, axis=1)], axis=1)
        log_factor = np.array(
            [np.interp(place[:, 0] * one[-1], one, own) for one, own in zip(filled, grid, strict=True)]
        )
        restitution = self.uncertainty.restitutions(np.asarray(self.block.restitution)[body], place[:, 1])
        chance = 0.5 + 0.5 * math.erf(REACH / math.sqrt(2.0)) * place[:, 2]
        loss = self.uncertainty.geometry * ndtri(chance)
        drawn = np.tile(loss, body.size), restitution.reshape(-1)
        lanes = self.block.take(np.repeat(body, number)).varied(*drawn)
        outcome = self._outcome(lanes, np.exp(log_factor).reshape(-1)).reshape(log_factor.shape)
        unresolved = outcome == Outcome.UNRESOLVED
        over = (outcome == Outcome.OVERTURNS) | unresolved
        density = number * wanted / filled[:, -1:]
        self.parts.append(LanePart(body, grid, density, log_factor, over, unresolved))

    def lanes(self, body: int, standing: bool) -> BodyLanes:
        """Return all samples of a body; `standing` is True if some of them survive the largest scale factor."""
        own = [(part, row) for part in self.parts for row in np.flatnonzero(part.body == body)]
        log_factor, over, unresolved = (
            np.concatenate([getattr(part, name)[row] for part, row in own])
            for name in ("log_factor", "over", "unresolved")
        )
        density = np.zeros(log_factor.size)
        for part, row in own:
            density += np.interp(log_factor, part.grid[row], part.density[row], left=0.0, right=0.0)
        bottom = min(float(part.grid[row, 0]) for part, row in own)
        top = max(float(part.grid[row, -1]) for part, row in own)
        return BodyLanes(log_factor, 1.0 / density, over, unresolved, bottom, top, standing)

    def _outcome(self, lanes: Block, factor: np.ndarray) -> np.ndarray:
        """Return the outcomes of bodies `lanes` under the record; `factor` contains a scale factor for each body."""
        early = np.zeros(factor.size, dtype=bool)
        if self.vertical is None and self.acceleration.any():
            early = within_measured_range(lanes, self.dt)
        outcome = np.empty(factor.size, dtype=np.int64)
        for settled in np.unique(early)[::-1]:
            places = np.flatnonzero(early == settled)
            some = lanes.take(places)
            ground = some, self.acceleration, self.dt
            verdict = ground_demand(*ground) if settled else None
            how: dict[str, Any] = {"vertical": self.vertical, "block_scale": factor[places], "threads": self.threads}
            outcome[places] = recorded_response(*ground, verdict=verdict, **how).outcome
        return outcome


def probability_lanes(march: LaneMarch, log_max: float, guess: np.ndarray | None = None) -> list[BodyLanes | None]:
    """Return the samples of each body; None for a body that is not lifted at any scale factor below exp(`log_max`)."""
    block, ground = march.block, march.acceleration
    weakest = block.varied(REACH * march.uncertainty.geometry, block.restitution)
    bottom = np.log(uplift_scale(weakest, ground, vertical=march.vertical))
    some = np.flatnonzero(bottom < log_max)
    found: list[BodyLanes | None] = [None] * bottom.size
    if some.size == 0:
        return found
    if guess is None:
        demand = ground_demand(block.weaker, ground, march.dt).build_up
        guess = np.divide(BUILD_UP_AT_CAPACITY, demand, out=np.full(demand.shape, np.inf), where=demand > 0.0)
    centre = np.clip(np.log(guess[some]), bottom[some], log_max)
    low = np.maximum(np.minimum(centre - FIRST_HALF, log_max - 2.0 * FIRST_HALF), bottom[some])
    march.evenly(some, low, np.minimum(low + 2.0 * FIRST_HALF, log_max), FIRST, 0)
    standing = _extend_first_stage(march, bottom, log_max).tolist()
    first = [(body, march.lanes(body, standing[body])) for body in some.tolist()]
    second = [(body, *_second_stage_density(lanes)) for body, lanes in first if lanes.over.any()]
    if second:
        bodies, grids, wanted = (np.array(column) for column in zip(*second, strict=True))
        march.add(bodies, grids, wanted, SECOND, 1)
    for body in some.tolist():
        found[body] = march.lanes(body, standing[body])
    return found


def _extend_first_stage(march: LaneMarch, bottom: np.ndarray, log_max: float) -> np.ndarray:
    """Add samples until the lowest survive and the highest overturn; return which bodies may survive exp(`log_max`)."""
    low, high = np.full(bottom.size, np.inf), np.full(bottom.size, -np.inf)
    standing = np.zeros(bottom.size, dtype=bool)
    seen = 0
    for turn in count(1):
        falls, stands = np.zeros(bottom.size, dtype=bool), np.zeros(bottom.size, dtype=bool)
        for part in march.parts[seen:]:
            body = part.body
            low[body], high[body] = np.minimum(low[body], part.grid[:, 0]), np.maximum(high[body], part.grid[:, -1])
            lowest, highest = (low[body] + QUIET)[:, np.newaxis], (high[body] - QUIET)[:, np.newaxis]
            falls[body] |= np.any(part.over & (part.log_factor < lowest), axis=1)
            stands[body] |= np.any(~part.over & (part.log_factor > highest), axis=1)
        seen = len(march.parts)
        standing |= stands & (high >= log_max)
        down, up = np.flatnonzero(falls & (low > bottom)), np.flatnonzero(stands & (high < log_max))
        if down.size:
            march.evenly(down, np.maximum(low[down] - MORE_LENGTH, bottom[down]), low[down], MORE, 2 * turn)
        if up.size:
            march.evenly(up, high[up], np.minimum(high[up] + MORE_LENGTH, log_max), MORE, 2 * turn + 1)
        if seen == len(march.parts):
            break
    return standing


def _second_stage_density(lanes: BodyLanes) -> tuple[np.ndarray, np.ndarray]:
    """Return a grid (g,) of ln f, and the relative density of the samples of the second stage on it."""
    grid = np.linspace(lanes.bottom, lanes.top, POINTS)
    near = np.exp(-0.5 * ((lanes.log_factor - grid[:, np.newaxis]) / NEIGHBOURS) ** 2) * lanes.weight
    share = np.sum(near * lanes.over, axis=1) / np.sum(near, axis=1)
    return grid, np.sqrt(share * (1.0 - share)) + FLOOR * 0.5
