"""What a ground motion asks of a block, on the block's own time scale: the impulse measure of the fidelity ladder.

.. note:: While a block rocks on the side s, the growing mode y = s theta/alpha - 1 + s theta'/(p alpha) of the linear
   equation obeys y' = p y - s p a_g/(g alpha), so that

   y(t) = exp(p (t - t0)) [y(t0) - s p/(g alpha) (E(t0) - exp(-p (t - t0)) E(t))],

   E(t0) = integral from t0 to the end of a_g(tau) exp(-p (tau - t0)) dtau:

   a later impulse counts exp(-p (tau - t0)) of an earlier one. A block that lifts off from rest at t0 (y = -1)
   overturns without an impact iff p abs(E(t0))/(g alpha) exceeds 1 towards the right side, which makes
   p abs(E)/(g tan alpha) a natural measure; an impact starts the next excursion with y = -1 + C times the speed that
   the last one left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

from rockpulse.models.block import Block

__all__ = ["LOBES", "Demand", "ground_demand"]

#: Lobes of E(t0) that are kept, the largest ones.
LOBES = 16

#: Samples before the first and after the last one of this share of the peak acceleration are left out.
QUIET = 0.05

#: E is computed at powers of two of 1/s divided by this number, and interpolated in log p between them.
NODES_PER_OCTAVE = 4

#: Share of the speed that an excursion hands to the next one, beside C: excursions are seldom in step with the ground.
HANDED_ON = 0.9

#: Levels of E at which the last time above them is kept: max abs(a_g)/p times 2^(-k/2).
LEVELS = 24


@njit(cache=True, nogil=True, error_model="numpy")
def _lobes(ground, dt, rates, levels, largest, last):
    """Largest abs(E) of the lobes of E(t0), descending, and the last sample above each level, for every rate.

    E is exact for a piecewise linear ground and found by one backward pass.
    """
    count = largest.shape[1]
    for j in range(rates.shape[0]):
        decay = math.exp(-rates[j] * dt)
        whole = -math.expm1(-rates[j] * dt) / rates[j]
        late = (whole - dt * decay) / (rates[j] * dt)
        early = whole - late
        top = largest[j]
        top[:] = 0.0
        last[j] = -1
        unseen = levels.shape[1] - 1
        weighted, lobe, sign = 0.0, 0.0, 0.0
        for i in range(ground.shape[0] - 2, -2, -1):
            if i >= 0:
                weighted = decay * weighted + early * ground[i] + late * ground[i + 1]
            if i < 0 or weighted * sign < 0.0:
                if lobe > top[count - 1]:
                    place = count - 1
                    while place > 0 and top[place - 1] < lobe:
                        top[place] = top[place - 1]
                        place -= 1
                    top[place] = lobe
                lobe = 0.0
            lobe = max(lobe, abs(weighted))
            sign = weighted
            while unseen >= 0 and lobe > levels[j, unseen]:
                last[j, unseen] = i
                unseen -= 1


@dataclass(frozen=True, eq=False)
class Demand:
    """What a ground motion asks of (m,) blocks; all measures are proportional to a factor on the record.

    Attributes
    ----------
    largest : (m,) ndarray
        Largest p abs(E)/(g tan alpha) [-].
    build_up : (m,) ndarray
        Sum over k of (0.9 C)^k p E_k/(g tan alpha), E_k the largest lobes in descending order [-]: the speed that
        resonance (Eq. 5) would build up with the impulses that the block sees, the largest one last.
    levels : (m, LEVELS) ndarray
        Values of p abs(E)/(g tan alpha), descending [-].
    last : (m, LEVELS) ndarray of int
        Last sample at which p abs(E)/(g tan alpha) was above the level; -1 where it never was.
    samples : int
        Number of samples of the record.
    """

    largest: np.ndarray
    build_up: np.ndarray
    levels: np.ndarray
    last: np.ndarray
    samples: int

    def samples_above(self, level: float, scale: float) -> np.ndarray:
        """Number of samples up to the last one whose demand exceeds a level, for a factor on the record; (m,)."""
        place = np.sum(self.levels * scale > level, axis=1)
        known = place < LEVELS
        kept = np.take_along_axis(self.last, np.where(known, place, 0)[:, None], axis=1)[:, 0]
        return np.where(known, np.minimum(kept + 2, self.samples), self.samples)


def ground_demand(block: Block, acceleration: Any, dt: float) -> Demand:
    """Demand of a ground motion on blocks.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    acceleration : (n,) array_like
        Ground acceleration a_g [m/s2], finite.
    dt : float
        Sampling interval [s].

    Returns
    -------
    Demand

    Raises
    ------
    ValueError
        For samples that are not finite or fewer than two, or dt <= 0.

    Notes
    -----
    E is computed at p = 2^(k/4) 1/s for the nodes that enclose the given p, and interpolated linearly in log p: a pass
    costs as much for a thousand blocks as for a few. What lies before the first and after the last sample of 5 % of the
    peak acceleration is left out.

    Examples
    --------
    >>> import numpy as np
    >>> block = Block.from_parameters(p=[2.0], alpha=[0.1], restitution=0.9)
    >>> pulse = np.full(51, 3.0)                      # half a second
    >>> demand = ground_demand(block, pulse, 0.01)
    >>> exact = 3.0 * (1.0 - np.exp(-2.0 * 0.5)) / (block.gravity * np.tan(0.1))
    >>> bool(abs(demand.largest[0] / exact - 1.0) < 1e-6)
    True
    """
    ground = np.ascontiguousarray(acceleration, dtype=float)
    if ground.ndim != 1 or ground.size < 2 or not np.all(np.isfinite(ground)):
        raise ValueError(
            f"acceleration: expected a (n,) array of at least 2 finite samples in m/s2, got {acceleration!r:.80}"
        )
    if not dt > 0.0:
        raise ValueError(f"dt: expected a positive sampling interval in s, got {dt!r}")
    block = block if block.shape else block.lanes(1)
    rates, capacity = np.asarray(block.p), block.gravity * np.tan(block.alpha_c) / block.p
    restitution = np.asarray(block.restitution)
    peak = np.max(np.abs(ground))
    loud = np.flatnonzero(np.abs(ground) > QUIET * peak)
    if loud.size == 0:
        zero = np.zeros(rates.size)
        return Demand(zero, zero, np.zeros((rates.size, LEVELS)), np.full((rates.size, LEVELS), -1), ground.size)
    first, stop = max(int(loud[0]) - 1, 0), int(loud[-1]) + 2
    place = NODES_PER_OCTAVE * np.log2(rates)
    below = np.floor(place)
    nodes = np.unique(np.concatenate([below, below + 1.0]))
    node_rates = 2.0 ** (nodes / NODES_PER_OCTAVE)
    at_levels = (peak / node_rates)[:, None] * 2.0 ** (-0.5 * np.arange(LEVELS))
    at_nodes, last = np.empty((nodes.size, LOBES)), np.empty((nodes.size, LEVELS), dtype=np.int64)
    _lobes(ground[first:stop], float(dt), node_rates, at_levels, at_nodes, last)
    last = np.where(last < 0, -1, last + first)
    low = np.searchsorted(nodes, below)
    share = (place - below)[:, None]
    lobes = ((1.0 - share) * at_nodes[low] + share * at_nodes[low + 1]) / capacity[:, None]
    kept = (HANDED_ON * restitution)[:, None] ** np.arange(LOBES)
    return Demand(
        largest=lobes[:, 0],
        build_up=np.sum(kept * lobes, axis=1),
        # The slower of the two nodes weighs what comes later more: it is above a level for longer.
        levels=at_levels[low] / capacity[:, None],
        last=last[low],
        samples=ground.size,
    )
