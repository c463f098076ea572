"""Sliding of a rocking body, as a check: the friction that its motion without sliding asks for.

.. note:: The centre of mass of a body that has turned by theta is at x = -s R sin(alpha - abs(theta)), z = R cos(alpha
   - abs(theta)) from its corner. Its base has to carry M (a_g + x'') across and M (g + a_v + z'') up: it asks for a
   coefficient mu = abs(a_g + x'')/(g + a_v + z''), at rest abs(a_g)/(g + a_v).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rocking.arguments import ArrayLike, Floats, numbers, record_samples
from rocking.body.block import Block
from rocking.march.recorded import recorded_response

__all__ = ["SlidingDemand", "impact_friction", "sliding_demand"]


class SlidingDemand(NamedTuple):
    """The friction that the motion of (m,) bodies asks for, at the samples of the record until overturning.

    Attributes
    ----------
    required : (m,) ndarray
        Largest coefficient of friction [-]; inf where the normal force vanishes.
    share : (m,) ndarray
        Share of the samples at which it is above the one that is there [-]; NaN where none was given.
    loses_contact : (m,) ndarray of bool
        True where the normal force vanishes.
    """

    required: np.ndarray
    share: np.ndarray
    loses_contact: np.ndarray


def sliding_demand(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    friction: ArrayLike = np.nan,
    vertical: ArrayLike | None = None,
    scale: float = 1.0,
) -> SlidingDemand:
    """The friction that a rocking motion without sliding asks for, by the nonlinear equation.

    Parameters
    ----------
    block : Block
        One body, which counts as (1,), or (m,) of them.
    acceleration, dt, vertical, scale
        As for :func:`~rocking.recorded_response`, with one factor.
    friction : float or (m,) array_like
        Coefficient at the base [-]; NaN where it is not known.

    Returns
    -------
    SlidingDemand
        NaN, and False, for bodies before a wall and for those with ties, loads or thrusts, whose forces on the base
        this does not know. Impacts ask for more, see :func:`impact_friction`.

    Raises
    ------
    ValueError
        What :func:`~rocking.recorded_response` refuses.

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = 3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> sliding_demand(block, sine, 0.01, friction=0.2).required.round(2).tolist()
    [0.26]
    """
    bodies = block if block.shape else block.lanes(1)
    ground = float(scale) * record_samples("acceleration", acceleration)
    up = np.zeros(ground.size) if vertical is None else float(scale) * record_samples("vertical", vertical)
    response = recorded_response(bodies, ground, dt, vertical=None if vertical is None else up, history=True)
    assert response.rotation is not None
    assert response.velocity is not None
    theta, speed = np.atleast_2d(response.rotation), np.atleast_2d(response.velocity)
    given = np.broadcast_to(np.asarray(friction, dtype=float), bodies.shape)
    if np.any(given <= 0.0):
        raise ValueError(f"friction: expected coefficients above 0, got {friction!r}")
    left = theta < 0.0
    side = np.where(left, -1.0, 1.0)

    def by_side(first: Any, second: Any) -> np.ndarray:
        return np.where(left, np.asarray(second)[:, np.newaxis], np.asarray(first)[:, np.newaxis])

    angle = by_side(bodies.alpha_c, bodies.alpha_2) - np.abs(theta)
    rate, radius = by_side(bodies.p, bodies.p_2), by_side(bodies.radius, bodies.radius_2)
    gravity = bodies.gravity
    turning = -(rate**2) * ((1.0 + up / gravity) * np.sin(angle) + side * ground / gravity * np.cos(angle))
    turning = np.where((theta == 0.0) & (speed == 0.0), 0.0, turning)
    across = ground + side * radius * (np.sin(angle) * speed**2 + np.cos(angle) * turning)
    normal = gravity + up + radius * (np.sin(angle) * turning - np.cos(angle) * speed**2)
    moving = np.isfinite(theta)
    lost = moving & (normal <= 0.0)
    asked = np.where(lost, np.inf, np.abs(across) / np.where(normal > 0.0, normal, 1.0))
    known = np.asarray((np.asarray(bodies.side) == 0) & ~np.asarray(bodies.restrained))
    above = np.sum(moving & (asked > given[:, np.newaxis]), axis=1) / np.sum(moving, axis=1)
    return SlidingDemand(
        required=np.where(known, np.max(np.where(moving, asked, 0.0), axis=1), np.nan),
        share=np.where(known & ~np.isnan(given), above, np.nan),
        loses_contact=known & np.any(lost, axis=1),
    )


def impact_friction(block: Block, restitution: ArrayLike | None = None) -> Floats:
    """Ratio of the impulses across and up of an impact that ends the rotation about the right-hand corner [-].

    h (1 - C)/(b_1 + C b_2), of a body whose centre of mass lies h above its corners: what an impact asks of friction if
    it does not slide. Information, no verdict: it lasts an instant.

    Parameters
    ----------
    block : Block
        Bodies.
    restitution : float or (m,) array_like, optional
        C; that of the body without.

    Examples
    --------
    >>> pier = Block(half_width=1.0, half_height=8.0)
    >>> [round(float(impact_friction(pier, share * pier.restitution)), 2) for share in (1.0, 0.9)]
    [0.09, 0.51]
    """
    share = block.restitution if restitution is None else numbers("restitution", restitution, "C from 0 to 1")
    height = block.radius * np.cos(block.alpha_c)
    first, second = block.radius * np.sin(block.alpha_c), block.radius_2 * np.sin(block.alpha_2)
    return height * (1.0 - share) / (first + share * second)
