"""The demand of the half-waves of a record on a block: on the block's own time scale, and by marching through them.

.. note:: A half-wave is taken as the triangle that has its ends, its impulse and its centroid. Two measures of the
   motion that they make, both proportional to a factor on it (the march up to rounding: on noisy or drifting records
   a single copy may flip, which moves it by 0.7 to 1.4 %):

   *Build-up of E.* While a block rocks on the side s, the growing mode y = s theta/alpha - 1 + s theta'/(p alpha) of
   the linear equation obeys y' = p y - s p a_g/(g alpha) (:mod:`rocking.demand`): a later impulse counts
   exp(-p (t - t0)) of an earlier one, E(t0) = sum over the half-waves after t0 of I_k exp(-p (t_k - t0)) for short
   ones, and here exact for triangles. A block that lifts off at t0 overturns without an impact iff p abs(E(t0)) exceeds
   g alpha. An impact hands C of the speed w to the next excursion, y = -1 + C w: the excursions that the lobes of E
   drive build up to sum over k of (h C)^k E_k, E_k in descending order (Eq. 5 for impulses that differ), with h < 1
   because the ground is seldom in step.

   *March.* 1 over the factor at which the linear equation (Eqs. 1-2), lifted at g tan(alpha), overturns under the
   half-waves in their own order. One march is chaotic; the geometric mean over copies of the motion is taken, with
   impulses that differ by a few per cent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

from rocking.block import Block
from rocking.demand import HANDED_ON
from rocking.recorded import recorded_response
from rocking.response import Outcome

__all__ = ["HalfWaveDemand", "Lobes", "demand_of_half_waves", "impulse_lobes", "lobe_shapes"]

#: Points of each side of a triangle on which E is computed.
POINTS = 16

#: Lobes of E above this share of the largest one are main impulses.
MAIN_SHARE = 0.5

#: Copies of the motion that are marched through, and the standard deviation of the logarithm of their impulses [-].
COPIES, SPREAD = 16, 0.1

#: The copies differ in the same way for every record and block.
SEED = 2017

#: March over build-up where it is searched, and the ratio of neighbouring factors. On the 64 recorded and synthetic
#: motions and 12 blocks of docs/decisions/012 it lay between 0.14 and 0.76.
LOWEST, HIGHEST, STEP = 0.08, 1.2, 1.12


@dataclass(frozen=True, eq=False)
class Lobes:
    """Lobes of E(t0), the stretches of one sign, in order of time."""

    times: np.ndarray  # (k,) of the largest abs(E) of each [s]
    sizes: np.ndarray  # (k,) E at that time, with its sign [m/s]


@dataclass(frozen=True, eq=False)
class HalfWaveDemand:
    """Demand of half-waves on (m,) blocks, `build_up` proportional to a factor on the record, `march` up to rounding.

    Attributes
    ----------
    march : (m,) ndarray
        1 over the factor at which the march overturns [-], within 0.08 to 1.2 times the build-up.
    build_up : (m,) ndarray
        Sum over k of (0.9 C)^k p E_k/(g tan alpha), E_k the lobes in descending order [-].
    largest : (m,) ndarray
        Largest p abs(E)/(g tan alpha) [-].
    main_count : (m,) ndarray of int
        Number of lobes above half the largest one; at least 1.
    ratio : (m,) ndarray
        Root mean square of the other lobes between the first and the last of them, over the largest one [-]; 0 where
        there is none.
    interval : (m,) ndarray
        Median spacing of the lobes from the first to the last main one [s]; NaN where there is one only.
    """

    march: np.ndarray
    build_up: np.ndarray
    largest: np.ndarray
    main_count: np.ndarray
    ratio: np.ndarray
    interval: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def _weighted_impulse(times: np.ndarray, ground: np.ndarray, rate: float) -> np.ndarray:
    """E at the points of a piecewise linear ground, exact, by one backward pass."""
    weighted = np.zeros(times.shape[0])
    for i in range(times.shape[0] - 2, -1, -1):
        step = times[i + 1] - times[i]
        if step <= 0.0:
            weighted[i] = weighted[i + 1]
            continue
        decay = np.exp(-rate * step)
        whole = -np.expm1(-rate * step) / rate
        late = (whole - step * decay) / (rate * step)
        weighted[i] = decay * weighted[i + 1] + (whole - late) * ground[i] + late * ground[i + 1]
    return weighted


def impulse_lobes(start: Any, centroid: Any, end: Any, impulse: Any, rate: float) -> Lobes:
    """Lobes of the exponentially weighted impulse of half-waves.

    Parameters
    ----------
    start, centroid, end : (k,) array_like
        Times of the half-waves [s], in order, centroids inside.
    impulse : (k,) array_like
        Their signed impulses [m/s].
    rate : float
        p of the block [1/s].

    Returns
    -------
    Lobes
        Empty without half-waves.

    Examples
    --------
    >>> lobes = impulse_lobes([0.0, 1.0], [0.0005, 1.0005], [0.001, 1.001], [0.3, -0.2], rate=1.0)
    >>> lobes.sizes.round(2).tolist()  # 0.3 - 0.2/e, and the second one alone
    [0.23, -0.2]
    """
    times, ground = _triangles(*(np.asarray(values, dtype=float) for values in (start, centroid, end, impulse)))
    weighted = _weighted_impulse(times, ground, float(rate))
    present = np.flatnonzero(weighted)
    times, weighted = times[present], weighted[present]
    if not weighted.size:
        return Lobes(times, weighted)
    first = np.flatnonzero(np.concatenate(([True], np.diff(np.sign(weighted)) != 0.0)))
    tops = [
        begin + int(np.argmax(np.abs(lobe))) for begin, lobe in zip(first, np.split(weighted, first[1:]), strict=True)
    ]
    return Lobes(times[tops], weighted[tops])


def _triangles(
    start: np.ndarray, centroid: np.ndarray, end: np.ndarray, impulse: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points and ground accelerations of the half-waves as triangles.

    A triangle from start to end has its centroid at (start + apex + end)/3, in the middle third; an apex that would lie
    outside goes to the nearer end.
    """
    apex = np.clip(3.0 * centroid - start - end, start, end)
    length = end - start
    peak = np.divide(2.0 * impulse, length, out=np.zeros_like(impulse), where=length > 0.0)
    share = np.arange(POINTS) / POINTS
    rising = start[:, None] + np.outer(apex - start, share)
    falling = apex[:, None] + np.outer(end - apex, np.append(share, 1.0))
    times = np.concatenate([rising, falling], axis=1)
    ground = peak[:, None] * np.append(share, np.append(1.0 - share, 0.0))
    return times.reshape(-1), ground.reshape(-1)


def demand_of_half_waves(
    block: Block, start: Any, centroid: Any, end: Any, impulse: Any, dt: float, threads: int | None = None
) -> HalfWaveDemand:
    """Demand of half-waves on blocks.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    start, centroid, end : (k,) array_like
        Times of the half-waves [s], in order, centroids inside.
    impulse : (k,) array_like
        Their signed impulses [m/s].
    dt : float
        Interval on which the triangles are sampled for the march, that of the record [s].
    threads : int, optional
        Threads that share the lanes; None for all available cores. The results do not depend on it.

    Returns
    -------
    HalfWaveDemand
        Of (m,) lanes. Without half-waves the measures are 0 and the main count 1.

    Raises
    ------
    ValueError
        For arrays that are not finite, not of one length or out of order, or dt <= 0.

    Notes
    -----
    The march is tried at factors of 1/1.2 to 1/0.08 over the build-up, 12 % apart, and the smallest at which it
    overturns counts. A factor that it cannot answer (UNRESOLVED) counts as overturning.

    Examples
    --------
    >>> import numpy as np
    >>> block = Block.from_parameters(p=[2.0], alpha=[0.1], restitution=0.9)
    >>> once = demand_of_half_waves(block, [0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.3], dt=0.01)
    >>> twice = demand_of_half_waves(block, [0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.8, -0.6], dt=0.01)
    >>> (twice.march / once.march).round(9), once.main_count
    (array([2.]), array([2]))
    """
    start, centroid, end, impulse = _checked(start, centroid, end, impulse, dt)
    block = block if block.shape else block.lanes(1)
    lobes = [impulse_lobes(start, centroid, end, impulse, rate) for rate in np.asarray(block.p)]
    over = np.asarray(block.p) / (block.gravity * np.tan(block.alpha_c))
    descending = [np.sort(np.abs(lobe.sizes))[::-1] for lobe in lobes]
    handed = HANDED_ON * np.broadcast_to(np.asarray(block.restitution, dtype=float), over.shape)
    build_up = over * [float(np.sum(h ** np.arange(e.size) * e)) for h, e in zip(handed, descending, strict=True)]
    shape = [_main_lobes(lobe) for lobe in lobes]
    return HalfWaveDemand(
        march=_march(block, start, centroid, end, impulse, dt, build_up, threads),
        build_up=build_up,
        largest=over * [float(np.max(e, initial=0.0)) for e in descending],
        main_count=np.array([count for count, _, _ in shape], dtype=np.int64),
        ratio=np.array([ratio for _, ratio, _ in shape]),
        interval=np.array([interval for _, _, interval in shape]),
    )


def lobe_shapes(
    start: Any, centroid: Any, end: Any, impulse: Any, rates: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The shape of half-waves on the time scale of blocks: number of main lobes, ratio of the others, spacing.

    Parameters
    ----------
    start, centroid, end, impulse : (k,) array_like
        Half-waves, as for :func:`demand_of_half_waves`.
    rates : (a,) array_like
        Frequency parameters p [1/s].

    Returns
    -------
    main_count, ratio, interval : (a,) ndarray
        As in :class:`HalfWaveDemand`.

    Examples
    --------
    >>> count, ratio, _ = lobe_shapes([0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.38], [0.5, 8.0])
    >>> count.tolist(), ratio.tolist()
    ([1, 2], [0.0, 0.0])
    """
    waves = _checked(start, centroid, end, impulse, dt=1.0)
    shapes = [_main_lobes(impulse_lobes(*waves, rate)) for rate in np.atleast_1d(rates)]
    count, ratio, interval = (np.array(column) for column in zip(*shapes, strict=True))
    return count, ratio, interval


def _main_lobes(lobes: Lobes) -> tuple[int, float, float]:
    """Number of main lobes, rms of the others between them over the largest, median spacing."""
    sizes = np.abs(lobes.sizes)
    main = np.flatnonzero(sizes > MAIN_SHARE * np.max(sizes, initial=0.0))
    if main.size < 2:
        return 1, 0.0, np.nan
    within = slice(main[0], main[-1] + 1)
    others = sizes[within][sizes[within] <= MAIN_SHARE * np.max(sizes)]
    ratio = float(np.sqrt(np.mean(others**2)) / np.max(sizes)) if others.size else 0.0
    return main.size, ratio, float(np.median(np.diff(lobes.times[within])))


def _march(
    block: Block,
    start: np.ndarray,
    centroid: np.ndarray,
    end: np.ndarray,
    impulse: np.ndarray,
    dt: float,
    build_up: np.ndarray,
    threads: int | None,
) -> np.ndarray:
    if not np.any(build_up):
        return np.zeros(build_up.size)
    # RandomState, whose stream is frozen: stored factors must not change with the version of numpy.
    copies = np.exp(SPREAD * np.random.RandomState(SEED).standard_normal((impulse.size, COPIES)))
    samples = start[0] + dt * np.arange(int(np.ceil((end[-1] - start[0]) / dt)) + 2)
    factors = np.geomspace(1.0 / HIGHEST, 1.0 / LOWEST, 1 + int(np.ceil(np.log(HIGHEST / LOWEST) / np.log(STEP))))
    alpha = np.asarray(block.alpha_c)
    own = alpha / np.tan(alpha) / build_up  # lifted at g tan(alpha); the factors count from the build-up
    logs = np.zeros(build_up.size)
    for copy in copies.T:
        motion = np.interp(samples, *_triangles(start, centroid, end, impulse * copy))
        outcome = recorded_response(
            block, motion, dt, equation="linear", scale=factors, block_scale=own, threads=threads
        ).outcome
        over = (outcome == Outcome.OVERTURNS) | (outcome == Outcome.UNRESOLVED)
        logs += np.log(np.where(np.any(over, axis=0), factors[np.argmax(over, axis=0)], factors[-1]))
    return build_up * np.exp(-logs / COPIES)


def _checked(start: Any, centroid: Any, end: Any, impulse: Any, dt: float) -> tuple[np.ndarray, ...]:
    arrays = tuple(np.atleast_1d(np.asarray(values, dtype=float)) for values in (start, centroid, end, impulse))
    if len({values.shape for values in arrays}) != 1 or arrays[0].ndim != 1:
        raise ValueError(
            "start, centroid, end, impulse: expected four (k,) arrays, got shapes "
            + ", ".join(str(values.shape) for values in arrays)
        )
    if not all(np.all(np.isfinite(values)) for values in arrays):
        raise ValueError("start, centroid, end, impulse: expected finite numbers")
    first, middle, last, _ = arrays
    if np.any(middle < first) or np.any(last < middle) or np.any(first[1:] < last[:-1] - 1e-9):
        raise ValueError("half-waves: expected start <= centroid <= end, one after the other")
    if not (np.isfinite(dt) and dt > 0.0):
        raise ValueError(f"dt: expected a positive sampling interval [s], got {dt!r}")
    return arrays
