"""The demand of a ground motion on a block: its largest impulses, weighted over time by the frequency parameter p.

.. note:: The growing mode y = s theta/alpha - 1 + s theta'/(p alpha) of the linear equation obeys y' = p y - s p a_g/(g
   alpha), so an impulse at tau has exp(-p (tau - t0)) times the effect of an equal impulse at t0:

   E(t0) = integral from t0 to the end of a_g(tau) exp(-p (tau - t0)) dtau.

   A block that lifts at t0 (y = -1) overturns without an impact iff p abs(E(t0))/(g alpha) exceeds 1 in the direction
   of rotation; after an impact the next excursion starts with y = -1 + C times the impact speed. A lobe of E is an
   interval in which E keeps its sign; the build-up is the speed that resonance with the largest lobes would give.
"""

import math
from dataclasses import dataclass

import numpy as np

from rocking.arguments import ArrayLike, positive, record_samples
from rocking.body.block import Block
from rocking.kernel_cache import njit
from rocking.pictures import short_repr

#: Number of lobes of E(t0) that are kept, the largest first.
LOBES = 16
#: E is computed at this number of values of p per octave, and interpolated in log p between them.
NODES_PER_OCTAVE = 4
#: Factor on the speed of the next excursion, in addition to C: excursions are seldom in phase with the ground.
HANDED_ON = 0.9
#: If speed plus remaining build-up is below this, a block will not overturn: in the measured ensembles the lowest sum
#: of a block that later overturned was above 0.8 (docs/decisions/006).
SETTLED = 0.7
#: Relative tolerance at the ends of the measured ranges, far above the rounding error of a product.
ROUNDING = 1e-9
#: Ranges in which SETTLED was measured: p [1/s], alpha_c [rad], C divided by Housner's value [-], p dt [-].
MEASURED_RANGE = {"p": (0.7, 9.0), "alpha": (0.04, 0.32), "restitution": (0.85, 1.0), "p_dt": (0.0, 0.1)}
#: Number of levels of the build-up, 8 max abs(a_g)/p 2^(-k/4), for each of which the last sample above it is stored.
LEVELS = 56
#: Values of C for which the remaining build-up is computed; a block uses the next larger one.
RESTITUTIONS = np.array([0.85, 0.875, 0.9, 0.925, 0.95, 0.975, 1.0])


@njit()
def _lobes(
    ground: np.ndarray,
    dt: float,
    rates: np.ndarray,
    ratios: np.ndarray,
    levels: np.ndarray,
    largest: np.ndarray,
    last: np.ndarray,
) -> None:
    """Find the largest lobes of the weighted impulse E(t0), and the last sample with a build-up above each level.

    E, the integral of e^(-p (t - t0)) a_g(t) from t0 on, is exact for an a_g that is linear between samples. The
    build-up at t0 is the sum over k of r^k E_k, with r from `ratios` and E_k the lobes after t0 in descending order.
    """
    count = largest.shape[1]
    unseen = np.empty(ratios.shape[0], dtype=np.int64)
    for j in range(rates.shape[0]):
        decay = math.exp(-rates[j] * dt)
        whole = -math.expm1(-rates[j] * dt) / rates[j]
        late = (whole - dt * decay) / (rates[j] * dt)
        early = whole - late
        top = largest[j]
        top[:] = 0.0
        last[j] = -1
        unseen[:] = levels.shape[1] - 1
        weighted, lobe, sign = 0.0, 0.0, 0.0
        begun = ground.shape[0] - 1
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
                    for c in range(ratios.shape[0]):
                        build_up, weight = 0.0, 1.0
                        for k in range(count):
                            build_up += weight * top[k]
                            weight *= ratios[c]
                        while unseen[c] >= 0 and build_up > levels[j, unseen[c]]:
                            last[j, c, unseen[c]] = begun
                            unseen[c] -= 1
                lobe = 0.0
                begun = i + 1
            lobe = max(lobe, abs(weighted))
            sign = weighted


@dataclass(frozen=True, eq=False)
class Demand:
    """The demand of a ground motion on (m,) blocks, proportional to a scale factor on the record.

    Attributes
    ----------
    largest, lobes : (m,) ndarray, (m, LOBES) ndarray
        p abs(E)/(g tan alpha) of the largest lobes of the weighted impulse E, descending [-]; `largest` is the first.
    build_up : (m,) ndarray
        Sum over k of (0.9 C)^k p E_k/(g tan alpha), E_k the lobes in descending order [-]: the speed that resonance
        (Eq. 5) would build up with these impulses, the largest one last.
    levels, last : (m, LEVELS) ndarray, (m, LEVELS) ndarray of int
        Levels of the remaining build-up, descending [-], and the last sample at which the build-up of the later lobes
        is above each level; -1 if it never is.
    samples : int
        Number of samples of the record.
    settled : float
        A block will not overturn if, right after an impact, its speed divided by the speed that overturns it on still
        ground, plus the remaining build-up, is no more than this [-].

    Examples
    --------
    >>> demand = rocking.ground_demand(pier, record.acceleration, record.dt)
    >>> round(float(demand.largest[0]), 2), demand.samples
    (0.47, 800)
    """

    __repr__ = short_repr

    largest: np.ndarray
    lobes: np.ndarray
    build_up: np.ndarray
    levels: np.ndarray
    last: np.ndarray
    samples: int
    settled: float = SETTLED


def ground_demand(block: Block, acceleration: ArrayLike, dt: float) -> Demand:
    """Compute the largest impulses of a ground motion on blocks, weighted in time by the p of each block.

    E, defined in :class:`Demand`, is computed at the nodes p = 2^(k/4) 1/s that enclose the given p, and interpolated
    linearly in log p: a thousand blocks cost as much as a few.

    Parameters
    ----------
    block : Block
        One block, with results of shape (1,), or an array of m blocks.
    acceleration, dt : (n,) array_like, float
        Ground acceleration a_g [m/s2], finite, and its sampling interval [s].

    Returns
    -------
    Demand
        The demand on the m blocks.

    Examples
    --------
    >>> block = Block.from_parameters(p=[2.0], alpha=[0.1], restitution=0.9)
    >>> pulse = np.full(51, 3.0)                      # half a second
    >>> demand = ground_demand(block, pulse, 0.01)
    >>> exact = 3.0 * (1.0 - np.exp(-2.0 * 0.5)) / (block.gravity * np.tan(0.1))
    >>> bool(abs(demand.largest[0] / exact - 1.0) < 1e-6)
    True
    """
    ground, dt = record_samples("acceleration", acceleration), float(positive("dt", dt, "s", lanes=False))
    block = block.lanes()
    rates, capacity = np.asarray(block.p), block.gravity * np.tan(block.alpha_c) / block.p
    restitution = np.asarray(block.restitution)
    peak = np.max(np.abs(ground))
    place = NODES_PER_OCTAVE * np.log2(rates)
    below = np.floor(place)
    nodes = np.unique(np.concatenate([below, below + 1.0]))
    node_rates = 2.0 ** (nodes / NODES_PER_OCTAVE)
    at_levels = 8.0 * (peak / node_rates)[:, None] * 2.0 ** (-0.25 * np.arange(LEVELS))
    at_nodes, last = np.empty((nodes.size, LOBES)), np.empty((nodes.size, RESTITUTIONS.size, LEVELS), dtype=np.int64)
    _lobes(ground, dt, node_rates, HANDED_ON * RESTITUTIONS, at_levels, at_nodes, last)
    low = np.searchsorted(nodes, below)
    share = (place - below)[:, None]
    lobes = ((1.0 - share) * at_nodes[low] + share * at_nodes[low + 1]) / capacity[:, None]
    kept = (HANDED_ON * restitution)[:, None] ** np.arange(LOBES)
    return Demand(
        largest=lobes[:, 0],
        lobes=lobes,
        build_up=np.sum(kept * lobes, axis=1),
        # The smaller p of the two nodes gives later impulses more weight: its build-up stays longer above a level.
        levels=at_levels[low] / capacity[:, None],
        last=last[low, np.searchsorted(RESTITUTIONS[:-1], restitution)],
        samples=ground.size,
    )


def within_measured_range(block: Block, dt: float) -> np.ndarray:
    """Return a mask (m,) of free blocks inside :data:`MEASURED_RANGE` under a record sampled at dt [s]."""
    measured = {
        "p": block.p,
        "alpha": block.alpha_c,
        "restitution": block.restitution / (1.0 - 1.5 * np.sin(block.alpha_c) ** 2),
        "p_dt": block.p * dt,
    }
    within = np.asarray(block.free)
    for name, (low, high) in MEASURED_RANGE.items():
        # Rounding may make the ratio for Housner's own value 1 + 1e-16.
        within = within & (measured[name] >= low * (1.0 - ROUNDING)) & (measured[name] <= high * (1.0 + ROUNDING))
    return within
