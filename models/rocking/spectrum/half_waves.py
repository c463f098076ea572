"""Overturning spectrum and demand computed from the half-waves of a record instead of its accelerations.

.. note:: A half-wave is replaced by the triangle with the same ends, impulse and centroid. `march` is the reciprocal of
   the factor at which the linear equation (Eqs. 1-2), with uplift at g tan(alpha), overturns under the half-waves. The
   result of a single response is erratic; with the uncertainty of body and strength this factor has a distribution
   (:class:`rocking.OverturningSpectrum`), whose mean logarithm and value at P = 10 % are used. The lobes of the
   weighted impulse E (demand.py) give the number of effective impulses.
"""

import math
from dataclasses import dataclass

import numpy as np

from rocking.arguments import ArrayLike, positive
from rocking.body.block import STANDARD_GRAVITY, Block
from rocking.kernel_cache import njit
from rocking.lanes import split_lanes, spread
from rocking.pictures import short_repr
from rocking.spectrum.body_lanes import REACH
from rocking.spectrum.body_probability import lane_capacity
from rocking.spectrum.overturning import OverturningSpectrum
from rocking.spectrum.probability import Uncertainty
from rocking.spectrum.sharing import shared_groups
from rocking.spectrum.slender_ground import weighted_lobes
from rocking.spectrum.slender_lanes import (
    FIRST,
    LEAST_RESTITUTION,
    RATES,
    SpectrumLanes,
    body_piece_lanes,
    check_strength,
    piece_lanes,
)

#: Number of points on each side of a triangle at which E is computed.
POINTS = 8
#: Lobes of E above this share of the largest one are main impulses.
MAIN_SHARE = 0.5
#: Number of lanes in the second stage of a single block, and per unit of C at each p of a spectrum that many blocks
#: share; g tan(alpha)/p of the slender blocks that are computed [m/s].
SECOND, SHARED_DENSITY, SPEED = 320, 3300.0, 0.01


def triangles(start: np.ndarray, centroid: np.ndarray, end: np.ndarray, impulse: np.ndarray) -> np.ndarray:
    """Return the times [s] and ground accelerations [m/s2] of the corners of half-waves as triangles, (2, 3 k).

    The centroid is at (start + top + end)/3; a top outside the half-wave is moved to the nearer end.
    """
    corners = np.zeros((2, impulse.size, 3))
    corners[0, :, 0], corners[0, :, 2] = start, end
    np.clip(3.0 * centroid - start - end, start, end, out=corners[0, :, 1])
    length = end - start
    np.divide(2.0 * impulse, length, out=corners[1, :, 1], where=length > 0.0)
    return corners.reshape(2, -1)


def half_wave_lanes(
    start: ArrayLike,
    centroid: ArrayLike,
    end: ArrayLike,
    impulse: ArrayLike,
    p: ArrayLike = RATES,
    between: tuple[float, float] = (LEAST_RESTITUTION, 1.0),
    threads: int | None = None,
    *,
    rotations: bool = True,
) -> SpectrumLanes:
    """Compute the responses of slender blocks (lanes) for the overturning spectrum of half-waves."""
    times, ground = triangles(*checked_half_waves(start, centroid, end, impulse))
    return piece_lanes(times, ground, p, between, threads, rotations=rotations)


def checked_half_waves(
    start: ArrayLike, centroid: ArrayLike, end: ArrayLike, impulse: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the four arrays (k,) of half-waves; raise ValueError if they are not valid."""
    arrays = tuple(np.atleast_1d(np.asarray(values, dtype=float)) for values in (start, centroid, end, impulse))
    if len({values.shape for values in arrays}) != 1 or arrays[0].ndim != 1:
        raise ValueError(
            "start, centroid, end, impulse: expected four (k,) arrays, got shapes "
            + ", ".join(str(values.shape) for values in arrays)
        )
    if not all(np.all(np.isfinite(values)) for values in arrays):
        raise ValueError("start, centroid, end, impulse: expected finite numbers")
    first, middle, last, impulses = arrays
    if np.any(middle < first) or np.any(last < middle) or np.any(first[1:] < last[:-1] - 1e-9):
        raise ValueError("half-waves: expected start <= centroid <= end, in order and without overlap")
    check_strength(triangles(first, middle, last, impulses)[1])
    return first, middle, last, impulses


@dataclass(frozen=True, eq=False)
class Lobes:
    """The lobes of the weighted impulse E(t0), intervals in which E keeps its sign, in chronological order."""

    times: np.ndarray  # (k,) time of the largest abs(E) of each lobe [s]
    sizes: np.ndarray  # (k,) E at that time, with its sign [m/s]


@dataclass(frozen=True, eq=False)
class HalfWaveDemand:
    """Demand of half-waves on (m,) blocks; `march` and `march_10` are proportional to the scale factor on the record.

    Attributes
    ----------
    march, march_10 : (m,) ndarray
        1/(scale factor of overturning) [-], for the geometric mean of this factor and for its value at P = 10 %.
    main_count : (m,) ndarray of int
        Number of lobes of the weighted impulse E (:class:`Lobes`) above half the largest one; at least 1.
    ratio, interval : (m,) ndarray
        Root mean square of the other lobes between the first and the last main lobe, divided by the largest lobe [-], 0
        if there are none; median spacing of the lobes from the first to the last main lobe [s], NaN for one main lobe.

    Examples
    --------
    >>> demand = demand_of_half_waves(Block(1.0, 4.0), [0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.3])
    >>> demand.main_count, demand.march.round(3)
    (array([2]), array([0.184]))
    """

    __repr__ = short_repr

    march: np.ndarray
    march_10: np.ndarray
    main_count: np.ndarray
    ratio: np.ndarray
    interval: np.ndarray


def impulse_lobes(start: ArrayLike, centroid: ArrayLike, end: ArrayLike, impulse: ArrayLike, rate: float) -> Lobes:
    """Compute the lobes of the exponentially weighted impulse E of half-waves.

    Parameters
    ----------
    start, centroid, end, impulse, rate : (k,) array_like and float
        Half-waves, as for :func:`demand_of_half_waves`, and p of the block [1/s].

    Examples
    --------
    >>> lobes = impulse_lobes([0.0, 1.0], [0.0005, 1.0005], [0.001, 1.001], [0.3, -0.2], rate=1.0)
    >>> lobes.sizes.round(2).tolist()  # 0.3 - 0.2/e, and the second one alone
    [0.23, -0.2]
    """
    corners, ground = triangles(*checked_half_waves(start, centroid, end, impulse))
    times, sizes = np.empty((2, corners.size // 3 + 1))
    count = weighted_lobes(corners, ground, float(positive("rate", rate, "1/s", lanes=False)), POINTS, times, sizes)
    return Lobes(times[:count][::-1].copy(), sizes[:count][::-1].copy())


def demand_of_half_waves(
    block: Block, start: ArrayLike, centroid: ArrayLike, end: ArrayLike, impulse: ArrayLike, threads: int | None = None
) -> HalfWaveDemand:
    """Compute the demand of half-waves on blocks.

    Parameters
    ----------
    block : Block
        One block, with results of shape (1,), or an array of m blocks.
    start, centroid, end, impulse : (k,) array_like
        Times of the half-waves [s], in order, centroids inside, and their signed impulses [m/s].
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    HalfWaveDemand
        Demand on (m,) blocks. Without half-waves the measures are 0 and the main count is 1.

    Notes
    -----
    The result depends only on p, C and x = f p/(g tan alpha) of a block, so it does not change if all
    lengths are multiplied by four and all times by two. C is uniform in 0.95 to 1.05 times the block's C, at most 1.

    Examples
    --------
    >>> block = Block.from_parameters(p=[2.0], alpha=[0.1], restitution=0.9)
    >>> once = demand_of_half_waves(block, [0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.4, -0.3])
    >>> twice = demand_of_half_waves(block, [0.0, 0.5], [0.25, 0.7], [0.5, 1.0], [0.8, -0.6])
    >>> (twice.march / once.march).round(9), once.main_count
    (array([2.]), array([2]))
    """
    first, centre, last, impulses = checked_half_waves(start, centroid, end, impulse)
    block = block.lanes()
    over = np.asarray(block.p) / (block.gravity * np.tan(block.alpha_c))
    nodes, of_body = np.unique(np.asarray(block.p), return_inverse=True)
    count, ratio, interval = (column[of_body] for column in lobe_shapes(first, centre, last, impulses, nodes, threads))
    waves = first, centre, last, impulses
    mean, at_10 = _spectra(waves, block, threads) if np.any(impulses) else np.zeros((2, over.size))
    return HalfWaveDemand(march=over * mean, march_10=over * at_10, main_count=count, ratio=ratio, interval=interval)


def lobe_shapes(
    start: ArrayLike,
    centroid: ArrayLike,
    end: ArrayLike,
    impulse: ArrayLike,
    rates: ArrayLike,
    threads: int | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the number of main lobes of E, the ratio of the other lobes and the spacing of the lobes for each p.

    Parameters
    ----------
    start, centroid, end, impulse, rates : (k,) array_like and (a,) array_like
        Half-waves, as for :func:`demand_of_half_waves`, and frequency parameters p [1/s].
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

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
    corners, ground = triangles(*checked_half_waves(start, centroid, end, impulse))
    nodes = np.atleast_1d(positive("rates", rates, "1/s"))
    count, ratio, interval = np.zeros(nodes.size, dtype=np.int64), np.zeros(nodes.size), np.zeros(nodes.size)

    def some(first: int, last: int) -> None:
        own = slice(first, last)
        _find_shapes(corners, ground, nodes[own], count[own], ratio[own], interval[own])

    split_lanes(some, nodes.size, threads, smallest=1)
    return count, ratio, interval


@njit()
def _find_shapes(corners, ground, rates, count, ratio, interval):
    times, sizes = np.empty(corners.size // 3 + 1), np.empty(corners.size // 3 + 1)
    for i in range(rates.size):
        lobes = weighted_lobes(corners, ground, rates[i], POINTS, times, sizes)
        count[i], ratio[i], interval[i] = main_lobes(times[:lobes], sizes[:lobes])


@njit()
def main_lobes(times, sizes):
    """Return the number of main lobes, the rms of the others divided by the largest lobe, and the median spacing."""
    largest, count, first, last = 0.0, 0, 0, 0
    for k in range(sizes.size):
        largest = max(largest, abs(sizes[k]))
    for k in range(sizes.size):
        if abs(sizes[k]) > MAIN_SHARE * largest:
            first = k if count == 0 else first
            last, count = k, count + 1
    if count < 2:
        return 1, 0.0, np.nan
    squares, others = 0.0, 0
    for k in range(first, last):
        if abs(sizes[k]) <= MAIN_SHARE * largest:
            squares, others = squares + sizes[k] ** 2, others + 1
    ratio = math.sqrt(squares / others) / largest if others else 0.0
    return count, ratio, np.median(np.abs(times[first + 1 : last + 1] - times[first:last]))


def _spectra(
    waves: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], block: Block, threads: int | None
) -> np.ndarray:
    """Return effective impulses (2, m) of the half-waves on blocks [m/s]: the mean, and the value at P = 10 %."""
    # Each body is represented by a slender block of the same p and C with g tan(alpha)/p = SPEED.
    alpha = np.arctan(SPEED * np.asarray(block.p) / STANDARD_GRAVITY)
    slender = Block.from_parameters(p=block.p, alpha=alpha, restitution=block.restitution, log=False)
    # Divided by the largest impulse, so that the levels of P scale with the record and with sizes and times.
    start, centroid, end, impulse = waves
    largest = np.max(np.abs(impulse))
    times, ground = triangles(start, centroid, end, impulse / largest)
    uncertainty = Uncertainty()
    capacity, rest = np.zeros((2, slender.shape[0])), np.ones(slender.shape[0], dtype=bool)
    for inside, arguments in shared_groups(slender, uncertainty, FIRST + SECOND, SHARED_DENSITY):
        shared = piece_lanes(times, ground, **arguments, threads=threads, rotations=False)
        factors = OverturningSpectrum(shared, uncertainty, threads=threads).factors(slender.take(inside))
        capacity[:, inside], rest[inside] = (factors.factor_mean, factors.factor_10), False
    reach = REACH * math.hypot(uncertainty.factor, uncertainty.geometry)
    others = np.flatnonzero(rest)
    if others.size:
        lanes = body_piece_lanes(times, ground, slender.take(others), uncertainty, threads, second=SECOND)
        found = spread(lambda one, _: lane_capacity(one, uncertainty, reach), lanes, threads)
        capacity[:, others] = np.array(list(found)).T
    return largest * SPEED / capacity
