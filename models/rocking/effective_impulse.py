"""Response to the half-waves of a record as impulses, of which only the part after lift-off or landing counts.

.. note:: An impulse of the ground is positive to the right; a block at rest is lifted towards theta > 0 when a_g is
   negative. The kernel is :mod:`rocking.effective_impulse_kernel`.
"""

from __future__ import annotations

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.effective_impulse_kernel import GroundMotion, Lanes, Waves, effective_lanes
from rocking.lanes import split_lanes
from rocking.response import Response, empty_results, response_of

__all__ = ["effective_impulse_response"]

#: Reciprocal of the acceleration that lifts a block, times gravity, by gain: theta' changes by p^2 alpha_c times this
#: times the impulse over gravity, as in :data:`rocking.impulses.impulsive.GAINS`.
FORCES = {
    "tangent": lambda alpha: 1.0 / np.tan(alpha),
    "linear": lambda alpha: 1.0 / alpha,
    "paper": lambda alpha: np.cos(alpha) / alpha,
}


def effective_impulse_response(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    boundaries: ArrayLike | None = None,
    gain: str = "tangent",
    scale: ArrayLike = 1.0,
    longest: float = 0.1,
    threads: int | None = None,
) -> Response:
    """Response to a record taken as impulses, each the part of a half-wave that acts on one motion of the block.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    acceleration : (n,) array_like
        Ground acceleration a_g [m/s2], n >= 2, linear between samples; zero after the last one.
    dt : float
        Sampling interval [s].
    boundaries : (k,) array_like, optional
        Ends of the half-waves [s] from the first sample, increasing. Default: the changes of sign of the record.
    gain : {"tangent", "linear", "paper"}
        Change of theta' per impulse, see :data:`rocking.impulses.impulsive.GAINS`. It also sets the acceleration that
        lifts the block: g tan(alpha_c), g alpha_c, or g alpha_c/cos(alpha_c).
    scale : float or (q,) array_like
        Factor on the record, not negative [-].
    longest : float
        Longest stretch that is taken as one impulse, times p [-]; inf keeps every half-wave whole that the block
        neither lifts off nor lands in.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The results do not depend on it.

    Returns
    -------
    Response
        Lanes (q, m), a scalar axis dropped. AT_REST where the record never exceeds the threshold. UNRESOLVED
        (IMPACT_LIMIT) after 10 000 impacts in one half-wave.

    Raises
    ------
    ValueError
        For samples, times or factors that are not finite or out of range, or an unknown gain.

    Notes
    -----
    The linear equation x'' = x - 1 + A, A = -s a_g/threshold, gives y = x - 1 + x' and z = x - 1 - x' the changes J
    e^(p r) and -J e^(-p r) over a stretch of impulse J that ends r after its centroid: exactly so if the impulse stands
    there, and to the second moment of the stretch for any other shape. A block at rest (y = z = -1) leaves the ground
    when A exceeds one, and only what the half-wave has left from that instant acts on it. So the motion is (x, x') = (1
    - cosh T + J sinh(p r), J cosh(p r) - sinh T) at the end of it, T = p times its length: the ground's pull during the
    wave is kept, and a wave that never exceeds the threshold is no impulse at all. A landing inside a half-wave, the
    root of x, splits it in the same way, for from there it acts on a block that rocks about the other corner. Impulse
    and centroid of every part follow from the ground velocity and displacement at its ends. Landings in quick
    succession that end inside the half-wave end in rest.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, section 2, doi:10.7712/120117.5612.17190.
    Housner, G. W. (1963), Bull. Seismol. Soc. Am. 53(2), 403-417.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.9365)
    >>> sine = 3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> effective_impulse_response(block, sine, 0.01).impacts > 0
    True
    """
    record = np.ascontiguousarray(acceleration, dtype=float)
    if record.ndim != 1 or record.size < 2 or not np.all(np.isfinite(record)):
        raise ValueError(
            f"acceleration: expected a (n,) array of at least 2 finite samples [m/s2], got shape {record.shape}"
        )
    if not (np.ndim(dt) == 0 and np.isfinite(dt) and dt > 0.0):
        raise ValueError(f"dt: expected a positive sampling interval [s], got {dt!r}")
    factors = np.asarray(scale, dtype=float)
    if factors.ndim > 1 or not np.all(np.isfinite(factors) & (factors >= 0.0)):
        raise ValueError(f"scale: expected a factor >= 0 or a (q,) array of them, got {scale!r}")
    if gain not in FORCES:
        raise ValueError(f"gain: expected one of {', '.join(FORCES)}, got {gain!r}")
    if not longest > 0.0:
        raise ValueError(f"longest: expected a positive length times p, or inf, got {longest!r}")
    alpha, p, restitution = (
        np.asarray(value, dtype=float).reshape(-1) for value in (block.alpha_c, block.p, block.restitution)
    )
    shape = (factors.size, alpha.size)
    force = np.multiply.outer(factors.reshape(-1), FORCES[gain](alpha) / block.gravity).reshape(-1)
    lanes = Lanes(force, np.tile(p, factors.size), np.tile(restitution, factors.size))
    bounds = _bounds(record, dt, boundaries)
    peaks = _peaks(record, dt, bounds)
    later = np.append(np.maximum.accumulate(peaks[::-1])[::-1][1:], 0.0)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * dt * (record[1:] + record[:-1]))])
    steps = dt * velocity[:-1] + dt**2 * (record[:-1] / 3.0 + record[1:] / 6.0)
    displacement = np.concatenate([[0.0], np.cumsum(steps)])
    ground = GroundMotion(record, velocity, displacement, float(dt))
    waves = Waves(bounds, peaks, later)
    results = empty_results(force.size)

    def kernel_call(first: int, last: int) -> None:
        effective_lanes(first, last, ground, waves, lanes, float(longest), results)

    split_lanes(kernel_call, force.size, threads)
    return response_of(results, shape, (factors.ndim == 0, block.shape == ()))


def _bounds(record: np.ndarray, dt: float, boundaries: ArrayLike | None) -> np.ndarray:
    """Ends of the half-waves, the ends of the record included."""
    end = dt * (record.size - 1)
    if boundaries is None:
        before, after = record[:-1], record[1:]
        crossing = np.flatnonzero(np.sign(before) * np.sign(after) < 0.0)
        inside = dt * (crossing + before[crossing] / (before[crossing] - after[crossing]))
        zero = record == 0.0
        still = zero & np.append(True, zero[:-1]) & np.append(zero[1:], True)
        inside = np.concatenate([inside, dt * np.flatnonzero(zero & ~still)])
    else:
        inside = np.asarray(boundaries, dtype=float)
        if inside.ndim != 1 or not np.all(np.isfinite(inside)) or np.any(np.diff(inside) <= 0.0):
            raise ValueError("boundaries: expected a (k,) array of finite, increasing times [s]")
        if inside.size and (inside[0] < 0.0 or inside[-1] > end * (1.0 + 1e-12)):
            raise ValueError(
                f"boundaries: expected times between 0 and {end:g} s, got {inside[0]:g} to {inside[-1]:g} s"
            )
    return np.unique(np.concatenate([[0.0], np.minimum(inside, end), [end]]))


def _peaks(record: np.ndarray, dt: float, bounds: np.ndarray) -> np.ndarray:
    """Largest abs(a_g) between each two bounds, both included."""
    samples = dt * np.arange(record.size)
    at_bounds = np.abs(np.interp(bounds, samples, record))
    place = np.searchsorted(samples, bounds)
    merged = np.insert(np.abs(record), place, at_bounds)
    starts = place + np.arange(bounds.size)
    return np.maximum(np.maximum.reduceat(merged, starts[:-1]), at_bounds[1:])
