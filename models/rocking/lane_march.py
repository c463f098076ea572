"""Nonlinear marches of bodies in lanes that each take one factor on the record and draw a restitution and an angle.

.. note:: The draws of a part of lanes are one scrambled Sobol set, the same for all bodies of a call: the answer of a
   body does not depend on the others. A free flight cannot be answered and counts as overturning, as in
   :func:`rocking.critical_scale`. Where no vertical acts and the body lies in the range in which that was measured, a
   march ends as soon as its verdict is settled (docs/decisions/006).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtri

from rocking.block import Block
from rocking.demand import ground_demand, within_measured_range
from rocking.lane_probability import Shift, lane_bells, tail_masses
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rocking.uncertainty import Uncertainty

__all__ = ["REACH", "BodyLanes", "LaneMarch", "LanePart"]

#: Standard deviations that are drawn: no shift of the factor and no loss of the angle beyond them is looked at.
REACH = 4.0

#: A body of C = 1 never comes to rest after the record, and its lane costs twenty times one of C = 0.99.
MOST_RESTITUTION = 0.999

#: Points of a Sobol set that are drawn at once: the lanes of each part are a multiple of it.
SET = 32


@dataclass(frozen=True, eq=False)
class LanePart:
    """Lanes (b, n) of some bodies (b,), with their density per unit of ln f on a grid (b, g) of it, linear between."""

    body: np.ndarray
    grid: np.ndarray
    density: np.ndarray
    log_factor: np.ndarray
    over: np.ndarray
    unresolved: np.ndarray


@dataclass(frozen=True, eq=False)
class BodyLanes:
    """Marched lanes of one body.

    Attributes
    ----------
    log_factor : (n,) ndarray
        ln of the factor on the record.
    weight : (n,) ndarray
        Stretch of ln f that a lane stands for [-]: 1 over the density of all lanes at its place.
    over, unresolved : (n,) ndarray of bool
        True where the lane overturns or cannot be answered; where it cannot be answered (free flight).
    bottom, top : float
        ln f between which the lanes lie.
    open : bool
        True where lanes still stand at the largest factor asked for: what is above it is not known.
    """

    log_factor: np.ndarray
    weight: np.ndarray
    over: np.ndarray
    unresolved: np.ndarray
    bottom: float
    top: float
    open: bool

    def sums(self, log_level: np.ndarray, shift: Shift) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """What each lane counts at each level (n, k), and the mass of the shift below and above the lanes (k,)."""
        bells = lane_bells(self.log_factor, self.weight, log_level, shift)
        return bells, tail_masses(self.bottom, self.top, log_level, shift)


@dataclass(eq=False)
class LaneMarch:
    """The march of (m,) bodies under a record, part by part.

    Attributes
    ----------
    block : Block
        (m,) nominal bodies.
    acceleration, vertical : (n,) ndarray
        a_g and a_v [m/s2]; None for no vertical one.
    dt : float
        Sampling interval [s].
    uncertainty : Uncertainty
        Of factor and geometry.
    least, most : (m,) ndarray
        C between which that of a draw is uniform [-].
    seed : int
        Of the draws.
    threads : int or None
        As for :func:`~rocking.recorded_response`.
    parts : list of LanePart
        What is marched so far.
    """

    block: Block
    acceleration: np.ndarray
    dt: float
    vertical: np.ndarray | None
    uncertainty: Uncertainty
    least: np.ndarray
    most: np.ndarray
    seed: int
    threads: int | None
    parts: list[LanePart] = field(default_factory=list)

    def evenly(self, body: np.ndarray, bottom: np.ndarray, top: np.ndarray, number: int, part: int) -> None:
        """March lanes of one density between the (b,) `bottom` and `top` of (b,) bodies."""
        self.add(body, np.stack([bottom, top], axis=1), np.ones((body.size, 2)), number, part)

    def add(self, body: np.ndarray, grid: np.ndarray, wanted: np.ndarray, number: int, part: int) -> None:
        """March `number` lanes for each of (b,) bodies, their density on a grid (b, g) of ln f as `wanted` (b, g) is.

        Each `part` has draws of its own, so that those of a body do not depend on how many parts others need.
        """
        from scipy.stats import qmc  # half a second, and a spectrum answers for most bodies

        points = qmc.Sobol(3, seed=np.random.default_rng([self.seed, part]))
        place = np.concatenate([points.random(SET) for _ in range(number // SET)])
        parts = 0.5 * (wanted[:, 1:] + wanted[:, :-1]) * np.diff(grid, axis=1)
        filled = np.concatenate([np.zeros((body.size, 1)), np.cumsum(parts, axis=1)], axis=1)
        log_factor = np.array(
            [np.interp(place[:, 0] * one[-1], one, own) for one, own in zip(filled, grid, strict=True)]
        )
        most = np.minimum(self.most[body], MOST_RESTITUTION)[:, np.newaxis]
        least = np.minimum(self.least[body][:, np.newaxis], most)
        chance = 0.5 + 0.5 * math.erf(REACH / math.sqrt(2.0)) * place[:, 2]
        loss = self.uncertainty.geometry * ndtri(chance)
        drawn = np.tile(loss, body.size), (least + (most - least) * place[:, 1]).reshape(-1)
        lanes = self.block.chosen(np.repeat(body, number)).varied(*drawn)
        outcome = self._outcome(lanes, np.exp(log_factor).reshape(-1)).reshape(log_factor.shape)
        unresolved = outcome == Outcome.UNRESOLVED
        over = (outcome == Outcome.OVERTURNS) | unresolved
        density = number * wanted / filled[:, -1:]
        self.parts.append(LanePart(body, grid, density, log_factor, over, unresolved))

    def lanes(self, body: int, standing: bool) -> BodyLanes:
        """All lanes of a body so far; `standing` where those at the largest factor do not all overturn."""
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
        """Outcome of (l,) lanes."""
        early = np.zeros(factor.size, dtype=bool)
        if self.vertical is None and self.acceleration.any():
            early = within_measured_range(lanes, self.dt)
        outcome = np.empty(factor.size, dtype=np.int64)
        for settled in (True, False):
            places = np.flatnonzero(early == settled)
            if places.size == 0:
                continue
            some = lanes.chosen(places)
            outcome[places] = recorded_response(
                some,
                self.acceleration,
                self.dt,
                vertical=self.vertical,
                block_scale=factor[places],
                verdict=ground_demand(some, self.acceleration, self.dt) if settled else None,
                threads=self.threads,
            ).outcome
        return outcome
