"""Response to a train of impulses, such as the half-waves of a record (Casapulla & Maione 2017, section 2, Eqs. 1-3).

.. note:: An impulse I of the ground is positive to the right and changes theta' by -gain I, since theta'' contains
   -a_g; theta > 0 is a rotation about the right-hand corner.
"""

from typing import Any

import numpy as np

from rocking.arguments import ArrayLike, numbers
from rocking.body.block import Block
from rocking.impulses.impulsive_kernel import (
    EXACT,
    LINEAR,
    PAPER,
    TANGENT,
    History,
    ImpulsiveLanes,
    Train,
    impulsive_lanes,
)
from rocking.lanes import split_lanes
from rocking.response import Response, empty_results, response_of

#: Change of theta' per impulse: "paper" p^2 cos(alpha_c)/g (Eq. 3), "linear" p^2/g, the limit of a narrow pulse in the
#: linear equation, "exact" p^2 cos(s alpha_c - theta)/g, the same limit in the nonlinear equation, "tangent" p^2
#: alpha_c/(g tan(alpha_c)), with which the linear equation lifts the block at the nonlinear threshold g tan(alpha_c).
GAINS = {"paper": PAPER, "linear": LINEAR, "exact": EXACT, "tangent": TANGENT}


def impulsive_response(
    block: Block,
    times: ArrayLike,
    impulses: ArrayLike,
    duration: float | None = None,
    gain: str = "paper",
    scale: ArrayLike = 1.0,
    history_dt: float | None = None,
    block_scale: ArrayLike = 1.0,
    threads: int | None = None,
) -> Response:
    """Compute the response to impulses of the ground with natural motion between them.

    Parameters
    ----------
    block : Block
        One block, or an array of m blocks.
    times, impulses : (k,) array_like
        Times [s], not decreasing, and signed impulses [m/s]. Simultaneous impulses act in the given order.
    duration : float, optional
        Time at which the history ends [s], by default the time of the last impulse. All impulses act in any case, and
        the motion is computed until rest or overturning is certain.
    gain : {"paper", "linear", "exact", "tangent"}
        See :data:`GAINS`.
    scale : float or (q,) array_like
        Scale factor on the impulses [-], finite.
    history_dt : float, optional
        Step of the history [s], which starts at time 0 or at an earlier first impulse; None for no history.
    block_scale : float or (m,) array_like
        Additional scale factor on the impulses for each block, finite [-].
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    Response
        Arrays (q, m), without the axis of a scalar argument; a history has `time` (h,), `rotation` and `velocity` (q,
        m, h), NaN once the block lies on the ground. UNRESOLVED after 100 000 impacts between two impulses.
        With `gain="exact"` an impulse may bring back a falling block: passing alpha_c is not overturning.

    Raises
    ------
    ValueError
        For arrays that are not finite, differ in length or are out of order, an unknown gain, or an invalid step or
        duration.

    Notes
    -----
    Overturning is certain from the first impulse or impact after which y(t) > sum over the later impulses of
    abs(dy_i) exp(-p (t_i - t)), or y >= 0 after the last one, with y = s theta/alpha_c - 1 + s theta'/(p alpha_c) the
    growing mode. A block whose half-cycles all end before the next impulse (sum of 2 atanh(C^k u)/p) is at rest there.
    Within 1e-9/p of an impact, an impulse that drives the block into the ground acts after the impact ("right after
    the impact", section 2); an impulse that opposes the motion acts before.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> response = impulsive_response(block, [0.0], [0.5 * block.critical_impulse])
    >>> round(response.peak_rotation_ratio, 6)
    0.133975
    """
    times, impulses, scale = _checked(times, impulses, scale)
    own = numbers("block_scale", block_scale, "a scale factor")
    if own.shape not in ((), block.shape):
        raise ValueError(
            f"block_scale: expected a scale factor, or an array {block.shape} of them, got {block_scale!r:.80}"
        )
    if gain not in GAINS:
        raise ValueError(f"gain: expected one of {', '.join(GAINS)}, got {gain!r}")
    grid = _grid(times, duration, history_dt)
    alpha, p, restitution = (
        np.ascontiguousarray(value.reshape(-1))
        for value in np.broadcast_arrays(
            *(np.asarray(value, dtype=float) for value in (block.alpha_c, block.p, block.restitution))
        )
    )
    factors = np.multiply.outer(scale.reshape(-1), np.broadcast_to(own, alpha.shape))
    sizes = np.abs(impulses)
    train = Train(times, impulses, sizes, np.cumsum(sizes[::-1])[::-1].copy())
    lanes = ImpulsiveLanes(factors, alpha, p, restitution, block.gravity, GAINS[gain])
    results = empty_results(factors.size)
    history = History(grid, np.zeros((factors.size, grid.size, 2)))

    def kernel_call(first: int, last: int) -> None:
        impulsive_lanes(first, last, train, lanes, np.empty((3, times.size)), results, history)

    split_lanes(kernel_call, factors.size, threads)
    motion: dict[str, Any] = {} if history_dt is None else {"motion": history.motion, "time": grid}
    return response_of(results, factors.shape, **motion).squeezed((scale.ndim == 0, block.shape == ()))


def _checked(times: ArrayLike, impulses: ArrayLike, scale: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    times, impulses = np.asarray(times, dtype=float), np.asarray(impulses, dtype=float)
    scale = np.asarray(scale, dtype=float)
    if times.ndim != 1 or times.shape != impulses.shape:
        raise ValueError(f"times and impulses: expected two (k,) arrays, got shapes {times.shape} and {impulses.shape}")
    for name, array, unit in (("times", times, "s"), ("impulses", impulses, "m/s")):
        if not np.all(np.isfinite(array)):
            where = int(np.flatnonzero(~np.isfinite(array))[0])
            raise ValueError(f"{name}: expected finite numbers [{unit}], got {array[where]} at index {where}")
    if np.any(np.diff(times) < 0.0):
        where = int(np.flatnonzero(np.diff(times) < 0.0)[0])
        raise ValueError(
            f"times: expected ascending times, got {times[where]} s before {times[where + 1]} s at index {where}; "
            "sort times and impulses together"
        )
    if scale.ndim > 1 or not np.all(np.isfinite(scale)):
        raise ValueError(f"scale: expected a finite number or a (q,) array, got {scale!r}")
    return times, impulses, scale


def _grid(times: np.ndarray, duration: float | None, step: float | None) -> np.ndarray:
    if duration is not None and not (np.isfinite(duration) and duration > 0.0):
        raise ValueError(f"duration: expected a positive, finite time [s], got {duration!r}")
    if step is None:
        return np.empty(0)
    if not (np.isfinite(step) and step > 0.0):
        raise ValueError(f"history_dt: expected a positive, finite step [s], got {step!r}")
    first = min(0.0, times[0]) if times.size else 0.0
    end = (max(times[-1], 0.0) if times.size else 0.0) if duration is None else duration
    # Rounding must not drop the last sample if the duration is a whole number of steps.
    return first + step * np.arange(int((end - first) / step * (1.0 + 1e-12)) + 1)
