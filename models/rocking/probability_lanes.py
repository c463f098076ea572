"""Where the lanes of a body's own lie under a record: about its capacity, and where verdicts differ.

.. note:: A first part lies about a guess of the capacity, made longer where its lowest lanes overturn or its highest
   ones stand. A second part lies where verdicts differ: its density follows the standard deviation sqrt(P (1 - P)) of a
   verdict, P the share of the first part that overturns nearby. The factors are known exactly; their uncertainty is a
   kernel in ln f afterwards (:mod:`rocking.lane_probability`) and is not drawn.
"""

from __future__ import annotations

from itertools import count

import numpy as np

from rocking.capacity import uplift_scale
from rocking.demand import ground_demand
from rocking.lane_march import REACH, BodyLanes, LaneMarch

__all__ = ["probability_lanes"]

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


def probability_lanes(
    march: LaneMarch, log_max: float, guess: np.ndarray | None = None
) -> tuple[np.ndarray, list[BodyLanes | None]]:
    """March the lanes of bodies under a record.

    Parameters
    ----------
    march : LaneMarch
        Of (m,) bodies, without any part so far.
    log_max : float
        ln of the largest factor of a lane.
    guess : (m,) ndarray, optional
        Factor at which a body may overturn [-], about which the first lanes lie; by the build-up of the ground without.

    Returns
    -------
    bottom : (m,) ndarray
        ln of the factor at which the weakest draw lifts off: no draw moves below it. inf where none ever does.
    lanes : list of BodyLanes or None
        Of each body; None where no draw lifts off by the largest factor.
    """
    block, ground = march.block, march.acceleration
    weakest = block.varied(REACH * march.uncertainty.geometry, block.restitution)
    bottom = np.log(uplift_scale(weakest, ground, vertical=march.vertical))
    some = np.flatnonzero(bottom < log_max)
    found: list[BodyLanes | None] = [None] * bottom.size
    if some.size == 0:
        return bottom, found
    if guess is None:
        demand = ground_demand(block.weaker, ground, march.dt).build_up
        guess = np.divide(BUILD_UP_AT_CAPACITY, demand, out=np.full(demand.shape, np.inf), where=demand > 0.0)
    centre = np.clip(np.log(guess[some]), bottom[some], log_max)
    low = np.maximum(np.minimum(centre - FIRST_HALF, log_max - 2.0 * FIRST_HALF), bottom[some])
    march.evenly(some, low, np.minimum(low + 2.0 * FIRST_HALF, log_max), FIRST, 0)
    standing = _lengthen(march, bottom, log_max).tolist()
    first = [(body, march.lanes(body, standing[body])) for body in some.tolist()]
    second = [(body, *_where_verdicts_differ(lanes)) for body, lanes in first if lanes.over.any()]
    if second:
        bodies, grids, wanted = (np.array(column) for column in zip(*second, strict=True))
        march.add(bodies, grids, wanted, SECOND, 1)
    for body in some.tolist():
        found[body] = march.lanes(body, standing[body])
    return bottom, found


def _lengthen(march: LaneMarch, bottom: np.ndarray, log_max: float) -> np.ndarray:
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
    share = np.sum(near * lanes.over, axis=1) / np.sum(near, axis=1)
    return grid, np.sqrt(share * (1.0 - share)) + FLOOR * 0.5
