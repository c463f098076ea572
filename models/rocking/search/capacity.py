"""Factors on a ground motion at which a block overturns, by the models that follow the motion itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from rocking.arguments import ArrayLike, numbers
from rocking.body.block import Block
from rocking.impulses.impulsive import impulsive_response
from rocking.march.corner_response import rest_levels
from rocking.march.recorded import recorded_response
from rocking.response import Outcome, Response
from rocking.search.factors import ScaleIntervals, exceedance_intervals

__all__ = ["POINTS", "critical_scale", "impulsive_critical_scale"]

#: Factors of the scan of one block.
POINTS = 64

#: The largest number below one: how near a block has come that passes alpha_c and comes back.
BELOW = float(np.nextafter(1.0, 0.0))

#: The search begins this share below the factor that lifts the block, which rounding must not put above it.
ROUNDING = 1e-12


def critical_scale(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    equation: Literal["nonlinear", "linear"] = "nonlinear",
    vertical: ArrayLike | None = None,
    level: float | None = None,
    factor_max: float = 10.0,
    points: int = POINTS,
    threads: int | None = None,
) -> ScaleIntervals:
    """Factors on a record at which a block overturns, or rotates beyond a level, by the linear or nonlinear equation.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    acceleration : (n,) array_like
        Horizontal ground acceleration a_g [m/s2], as for :func:`~rocking.recorded_response`.
    dt : float
        Sampling interval [s].
    equation : {"nonlinear", "linear"}
        The full equation, or its limit for slender blocks and small rotations.
    vertical : (n,) array_like, optional
        Vertical ground acceleration a_v [m/s2], positive up; nonlinear equation only. The factor is on the whole
        input: on both.
    level : float, optional
        theta_max/alpha_c [-], positive, that is reached or passed; None for overturning.
    factor_max : float
        End of the search [-].
    points : int
        Factors of the scan of each block, at least 2.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The factors do not depend on it.

    Returns
    -------
    ScaleIntervals
        Of (m,) lanes.

    Raises
    ------
    ValueError
        For a level that is not positive, and what :func:`~rocking.recorded_response` and
        :func:`~rocking.search.factors.exceedance_intervals` refuse.

    Notes
    -----
    The scan of a block begins where its record starts to lift it: g alpha/max|a_g| (linear), or the smallest f with
    f |a_g| = (g + f a_v) tan(alpha), that is g tan(alpha)/max(|a_g| - a_v tan(alpha)), at a sample because both records
    are linear between them. Every verdict is that of the whole equation; a factor at which it cannot answer
    (UNRESOLVED: free flight, impacts without number) counts as exceeding, so nothing is called safe that was not
    computed.

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> found = critical_scale(block, sine, 0.01)
    >>> found.safety_factor.round(4), found.lower.round(2), found.upper.round(2)  # safe again from 7.35 to 7.52
    (array([3.2132]), array([3.21, 7.52]), array([ 7.35, 10.  ]))
    """
    if level is not None:
        reached = float(numbers("level", level, "a positive theta_max/alpha_c", lanes=False))
        if reached <= 0.0:
            raise ValueError(f"level: expected a positive theta_max/alpha_c, got {level!r}")
    blocks = block if block.shape else block.lanes(1)
    # A record at factor zero lifts nothing: this has the arguments checked before anything is made of them.
    recorded_response(blocks, acceleration, dt, equation, scale=0.0, vertical=vertical, threads=threads)
    ground = np.ascontiguousarray(acceleration, dtype=float)
    up = None if vertical is None else np.ascontiguousarray(vertical, dtype=float)

    def respond(part: Block, factors: np.ndarray) -> Response:
        return recorded_response(part, ground, dt, equation, vertical=up, block_scale=factors, threads=threads)

    start = uplift_scale(blocks, ground, equation, up) * (1.0 - ROUNDING)
    return _search(blocks, respond, start, level, factor_max, points)


def impulsive_critical_scale(
    block: Block,
    times: ArrayLike,
    impulses: ArrayLike,
    gain: str = "paper",
    factor_max: float = 10.0,
    points: int = POINTS,
    threads: int | None = None,
) -> ScaleIntervals:
    """Factors on given impulses, such as the half-waves of a record, at which a block overturns.

    Parameters
    ----------
    block : Block
        One block, which counts as (1,), or (m,) of them.
    times, impulses : (k,) array_like
        Times [s] and signed impulses [m/s], as for :func:`~rocking.impulsive_response`.
    gain : str
        As there.
    factor_max, points, threads
        As for :func:`critical_scale`.

    Returns
    -------
    ScaleIntervals
        Of (m,) lanes.

    Notes
    -----
    An impulse lifts a block however small it is, so the scan begins at a bound of its own. An impulse dx' at the
    rotation 0 <= x <= 2 turns the speed u with which the motion left, or would have left, the ground into at most u +
    |dx'|, as x'^2 = u^2 - 1 + (1 - x)^2 <= u^2 there, and an impact takes from it. Overturning needs u >= 1 and with
    dx' <= p I/(g alpha_c) a factor of at least g alpha_c/(p sum |I_i|).

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> found = impulsive_critical_scale(block, [0.0], [0.5 * block.critical_impulse])
    >>> found.safety_factor.round(5)
    array([2.])
    """
    blocks = block if block.shape else block.lanes(1)
    impulsive_response(blocks, times, impulses, gain=gain, scale=0.0, threads=threads)
    total = float(np.sum(np.abs(impulses)))
    if total == 0.0:
        start = np.full(blocks.shape, np.inf)
    else:
        start = np.asarray(blocks.gravity * blocks.alpha_c / (blocks.p * total) * (1.0 - ROUNDING))

    def respond(part: Block, factors: np.ndarray) -> Response:
        return impulsive_response(part, times, impulses, gain=gain, block_scale=factors, threads=threads)

    return _search(blocks, respond, start, None, factor_max, points)


def uplift_scale(
    block: Block, acceleration: np.ndarray, equation: str = "nonlinear", vertical: np.ndarray | None = None
) -> np.ndarray:
    """Factor on a record above which it lifts each of (m,) blocks, inf where none does.

    The threshold is (g + f a_v) tan(alpha), or g alpha with the linear equation, and for a body that something else
    acts on, g times :func:`rocking.march.corner_response.rest_levels` beside.
    """
    found = np.full(np.shape(block.p), np.inf)
    more = rest_levels(block)
    for side, alpha, extra in ((1, block.alpha_c, more[0]), (-1, block.alpha_2, more[1])):
        threshold = np.asarray(alpha if equation == "linear" else np.tan(alpha))
        strongest = np.full(threshold.shape, np.max(-side * acceleration))
        if vertical is not None:
            strongest = np.array([np.max(-side * acceleration - slope * vertical) for slope in threshold])
        lifted = (strongest > 0.0) & (np.asarray(block.side) != -side)
        level = block.gravity * (threshold + extra)
        found = np.minimum(found, np.divide(level, strongest, out=np.full(threshold.shape, np.inf), where=lifted))
    return found


def _search(
    blocks: Block,
    respond: Callable[[Block, np.ndarray], Response],
    start: np.ndarray,
    level: float | None,
    factor_max: float,
    points: int,
) -> ScaleIntervals:
    def answers(lanes: np.ndarray, factors: np.ndarray) -> Response:
        return respond(blocks.chosen(lanes), factors)

    unresolved = False

    def exceeds(lanes: np.ndarray, factors: np.ndarray) -> np.ndarray:
        nonlocal unresolved
        # Lanes of one block stand together: the impulsive kernel shares a table among those of one p.
        response = answers(np.repeat(lanes, factors.shape[0]), factors.T.reshape(-1))
        if level is None:
            reach = np.where(
                response.outcome >= Outcome.OVERTURNS, np.inf, np.minimum(response.peak_rotation_ratio, BELOW)
            )
        else:
            reach = np.asarray(response.peak_rotation_ratio) / level
        # A lane that is UNRESOLVED exceeds: its peak is NaN.
        unresolved |= bool(np.any(response.outcome == Outcome.UNRESOLVED))
        return reach.reshape(factors.shape[1], factors.shape[0]).T

    found = exceedance_intervals(exceeds, start, factor_max, points)
    if not unresolved:
        return found
    return replace(found, resolved=np.asarray(answers(found.lane, found.lower).outcome) != Outcome.UNRESOLVED)
