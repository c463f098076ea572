"""Lanes of a body's own under a record: nonlinear marches that each draw a restitution, an angle and a factor.

.. note:: Where the similarity of slender blocks does not hold, a body is marched for itself. A lane takes a factor f
   that is known exactly, a C and an alpha that are drawn, from one scrambled Sobol set for all bodies of a call; the
   uncertainty of f is a kernel in ln f afterwards (:mod:`rocking.lane_probability`) and is not drawn. A first part lies
   about a guess of the capacity, made longer where its lowest lanes overturn or its highest ones stand. A second part
   lies where verdicts differ: its density follows the standard deviation sqrt(P (1 - P)) of a verdict, P the share of
   the first part that overturns nearby. Each lane stands for 1 over the density of all lanes at its place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import count

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.special import ndtri
from scipy.stats import qmc

from rocking.block import Block
from rocking.capacity import uplift_scale
from rocking.demand import ground_demand
from rocking.fidelity import within_measured_range
from rocking.lane_probability import Shift, lane_bells, tail_masses
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rocking.uncertainty import Uncertainty

__all__ = ["REACH", "BodyLanes", "probability_lanes"]

#: Standard deviations that are drawn: no shift of the factor and no loss of the angle beyond them is looked at.
REACH = 4.0

#: A body of C = 1 never comes to rest after the record, and its lane costs twenty times one of C = 0.99.
MOST_RESTITUTION = 0.999

#: The capacity is guessed where the build-up of the ground (:mod:`rocking.demand`) is so many times what overturns.
BUILD_UP_AT_CAPACITY = 2.5

#: Lanes of the first part, over so much of ln f to either side of the guess.
FIRST, FIRST_HALF = 64, 0.8

#: Lanes of each piece that makes the first part longer, and its length in ln f.
MORE, MORE_LENGTH = 32, 0.8

#: The first part ends where no lane overturns in so much of ln f at its bottom, and none stands at its top.
QUIET = 0.2

#: Lanes of the second part, and the least density of them over that of lanes in full disagreement.
SECOND, FLOOR = 192, 0.2

#: Width in ln f over which verdicts of the first part count as neighbours, and points at which their density is known.
NEIGHBOURS, POINTS = 0.12, 201

#: Points of a Sobol set that are drawn at once: the lanes of each part are a multiple of it.
SET = 32


@dataclass(frozen=True, eq=False)
class BodyLanes:
    """Marched lanes of one body.

    Attributes
    ----------
    log_factor : (n,) ndarray
        ln of the factor on the record.
    weight : (n,) ndarray
        Stretch of ln f that a lane stands for [-].
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


@dataclass(frozen=True, eq=False)
class _Part:
    """Lanes (b, n) of (b,) bodies, with their density per unit of ln f on a grid (b, g) of it, linear between."""

    body: np.ndarray
    grid: np.ndarray
    density: np.ndarray
    log_factor: np.ndarray
    over: np.ndarray
    unresolved: np.ndarray


class _March:
    """The march of parts of lanes of all bodies, and what it takes."""

    def __init__(
        self,
        block: Block,
        ground: np.ndarray,
        dt: float,
        vertical: np.ndarray | None,
        uncertainty: Uncertainty,
        least: np.ndarray,
        most: np.ndarray,
        seed: int,
        threads: int | None,
    ) -> None:
        self.block, self.ground, self.dt, self.vertical = block, ground, dt, vertical
        self.uncertainty, self.least, self.most = uncertainty, least, np.minimum(most, MOST_RESTITUTION)
        self.seed, self.threads = seed, threads
        self.parts: list[_Part] = []

    def add(self, body: np.ndarray, grid: np.ndarray, wanted: np.ndarray, number: int, part: int) -> None:
        """March `number` lanes for each of (b,) bodies, their density on a grid (b, g) of ln f as `wanted` (b, g) is.

        Each `part` has draws of its own, so that those of a body do not depend on the other bodies.
        """
        points = qmc.Sobol(3, seed=np.random.default_rng([self.seed, part]))
        place = np.concatenate([points.random(SET) for _ in range(number // SET)])
        filled = cumulative_trapezoid(wanted, grid, axis=1, initial=0.0)
        log_factor = np.array(
            [np.interp(place[:, 0] * one[-1], one, own) for one, own in zip(filled, grid, strict=True)]
        )
        density = number * wanted / filled[:, -1:]
        reached = 2.0 * _normal_below(REACH) - 1.0
        loss = self.uncertainty.geometry * ndtri(0.5 + 0.5 * reached * place[:, 2])
        least, most = np.minimum(self.least[body], MOST_RESTITUTION), self.most[body]
        lanes = Block.from_parameters(
            p=np.repeat(np.asarray(self.block.p)[body], number),
            alpha=(np.asarray(self.block.alpha_c)[body][:, np.newaxis] * np.exp(-loss)).reshape(-1),
            restitution=(least[:, np.newaxis] + (most - least)[:, np.newaxis] * place[:, 1]).reshape(-1),
            gravity=self.block.gravity,
            log=False,
        )
        outcome = self._outcome(lanes, np.exp(log_factor).reshape(-1)).reshape(log_factor.shape)
        unresolved = outcome == Outcome.UNRESOLVED
        over = (outcome == Outcome.OVERTURNS) | unresolved
        self.parts.append(_Part(body, grid, density, log_factor, over, unresolved))

    def _outcome(self, lanes: Block, factor: np.ndarray) -> np.ndarray:
        """Outcome of each lane; without vertical and within the measured range a march ends where it is settled."""
        early = np.zeros(factor.size, dtype=bool)
        if self.vertical is None and self.ground.any():
            early = within_measured_range(lanes, self.dt)
        outcome = np.empty(factor.size, dtype=np.int64)
        for chosen in (np.flatnonzero(early), np.flatnonzero(~early)):
            if chosen.size == 0:
                continue
            some = lanes._with(lambda values, chosen=chosen: np.ascontiguousarray(values[chosen]))
            outcome[chosen] = recorded_response(
                some,
                self.ground,
                self.dt,
                vertical=self.vertical,
                block_scale=factor[chosen],
                verdict=ground_demand(some, self.ground, self.dt) if early[chosen[0]] else None,
                threads=self.threads,
            ).outcome
        return outcome

    def lanes(self, body: int, open_top: bool) -> BodyLanes:
        """All lanes of a body so far."""
        own = [(part, np.flatnonzero(part.body == body)) for part in self.parts]
        own = [(part, int(row[0])) for part, row in own if row.size]
        log_factor, over, unresolved = (
            np.concatenate([getattr(part, name)[row] for part, row in own])
            for name in ("log_factor", "over", "unresolved")
        )
        density = np.zeros(log_factor.size)
        for part, row in own:
            density += np.interp(log_factor, part.grid[row], part.density[row], left=0.0, right=0.0)
        bottom, top = (pick([part.grid[row, end] for part, row in own]) for pick, end in ((min, 0), (max, -1)))
        return BodyLanes(log_factor, 1.0 / density, over, unresolved, float(bottom), float(top), open_top)

    def evenly(self, body: np.ndarray, bottom: np.ndarray, top: np.ndarray, number: int, part: int) -> None:
        """March lanes of one density between the (b,) `bottom` and `top` of (b,) bodies."""
        self.add(body, np.stack([bottom, top], axis=1), np.ones((body.size, 2)), number, part)


def probability_lanes(
    block: Block,
    acceleration: np.ndarray,
    dt: float,
    vertical: np.ndarray | None,
    uncertainty: Uncertainty,
    least: np.ndarray,
    most: np.ndarray,
    log_max: float,
    guess: np.ndarray | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> tuple[np.ndarray, list[BodyLanes | None]]:
    """Lanes of bodies under a record.

    Parameters
    ----------
    block : Block
        (m,) bodies.
    acceleration, vertical : (n,) ndarray
        a_g and a_v [m/s2]; None for no vertical one.
    dt : float
        Sampling interval [s].
    uncertainty : Uncertainty
        Of factor and geometry.
    least, most : (m,) ndarray
        C between which that of a draw is uniform [-].
    log_max : float
        ln of the largest factor of a lane.
    guess : (m,) ndarray, optional
        Factor at which a body may overturn [-], about which the first lanes lie; by the build-up of the ground without.
    seed : int
        Of the Sobol sets.
    threads : int, optional
        As for :func:`~rocking.recorded_response`.

    Returns
    -------
    bottom : (m,) ndarray
        ln of the factor at which the weakest draw lifts off: no draw moves below it. inf where none ever does.
    lanes : list of BodyLanes or None
        Of each body; None where no draw lifts off by the largest factor.
    """
    weakest = Block.from_parameters(
        p=block.p,
        alpha=block.alpha_c * math.exp(-REACH * uncertainty.geometry),
        restitution=0.0,
        gravity=block.gravity,
        log=False,
    )
    bottom = np.log(uplift_scale(weakest, acceleration, vertical=vertical))
    some = np.flatnonzero(bottom < log_max)
    found: list[BodyLanes | None] = [None] * bottom.size
    if some.size == 0:
        return bottom, found
    march = _March(block, acceleration, dt, vertical, uncertainty, least, most, seed, threads)
    if guess is None:
        demand = ground_demand(block, acceleration, dt).build_up
        guess = np.divide(BUILD_UP_AT_CAPACITY, demand, out=np.full(demand.shape, np.inf), where=demand > 0.0)
    centre = np.clip(np.log(guess[some]), bottom[some], log_max)
    low = np.maximum(np.minimum(centre - FIRST_HALF, log_max - 2.0 * FIRST_HALF), bottom[some])
    high = np.minimum(low + 2.0 * FIRST_HALF, log_max)
    march.evenly(some, low, high, FIRST, 0)
    standing = _lengthen(march, some, bottom, log_max)
    pilot = [march.lanes(body, bool(standing[body])) for body in some]
    second = [(body, *_where_verdicts_differ(one)) for body, one in zip(some, pilot, strict=True) if one.over.any()]
    if second:
        body, grid, wanted = (np.array(column) for column in zip(*second, strict=True))
        march.add(body, grid, wanted, SECOND, 1)
    for body in some:
        found[body] = march.lanes(body, bool(standing[body]))
    return bottom, found


def _lengthen(march: _March, some: np.ndarray, bottom: np.ndarray, log_max: float) -> np.ndarray:
    """Make the first part longer, down to uplift and up to the largest factor; (m,), where lanes stand up there."""
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


def _where_verdicts_differ(lanes: BodyLanes) -> tuple[np.ndarray, np.ndarray]:
    """A grid (g,) of ln f, and the density of the second part on it, in a unit of its own."""
    grid = np.linspace(lanes.bottom, lanes.top, POINTS)
    near = np.exp(-0.5 * ((lanes.log_factor - grid[:, np.newaxis]) / NEIGHBOURS) ** 2) * lanes.weight
    share = np.clip(near @ lanes.over / np.maximum(np.sum(near, axis=1), 1e-300), 0.0, 1.0)
    return grid, np.sqrt(share * (1.0 - share)) + FLOOR * 0.5


def _normal_below(deviations: float) -> float:
    return 0.5 * (1.0 + math.erf(deviations / math.sqrt(2.0)))
