"""The two corners on which a rigid body rocks, and its impact on a wall behind it.

.. note:: A body whose centre of mass lies b_1 and b_2 from its right-hand and left-hand corner and h above them turns
   about corner i with R_i^2 = b_i^2 + h^2, tan(alpha_i) = b_i/h and p_i^2 = g R_i/(rho^2 + R_i^2), rho its radius of
   gyration. An impact on corner 2 keeps the angular momentum about it: (rho^2 + R_2^2) theta'_after = (rho^2 + R_1 R_2
   cos(alpha_1 + alpha_2)) theta'_before, and R_1 R_2 cos(alpha_1 + alpha_2) = h^2 - b_1 b_2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from rocking.arguments import ArrayLike, numbers, positive, together
from rocking.body.restraint import Load, carried

__all__ = ["Corner", "both_corners", "corner", "rebound_of", "sorrentino"]

#: Slenderness above which the convention of the rebound from a wall holds: 1 - 1.5 cos^2 alpha is negative there.
LEAST_SLENDERNESS = np.sqrt(2.0)


class Corner(NamedTuple):
    """One corner of (m,) bodies."""

    radius: np.ndarray  #: R, from the corner to the centre of mass [m]
    alpha: np.ndarray  #: angle of R with the vertical [rad]
    p: np.ndarray  #: frequency parameter about it [1/s]
    most: np.ndarray  #: C at most, of the impact that ends the rotation about it [-]


def corner(near: np.ndarray, far: np.ndarray, height: np.ndarray, gyration: np.ndarray, gravity: float) -> Corner:
    """The corner `near` [m] away from the centre of mass, horizontally, of bodies with the other one `far` [m] away.

    The centre of mass is at `height` [m], the radius of gyration about it `gyration` [m].
    """
    square = near**2 + height**2
    return Corner(
        radius=np.sqrt(square),
        alpha=np.arctan2(near, height),
        p=np.sqrt(gravity * np.sqrt(square) / (gyration**2 + square)),
        most=(gyration**2 + height**2 - near * far) / (gyration**2 + height**2 + far**2),
    )


def sorrentino(alpha: Any) -> Any:
    """Rebound e of a rectangle from a wall behind it: abs((1 - 1.5 sin^2 alpha)^2 (1 - 1.5 cos^2 alpha)).

    A convention for the sequence base, wall, base, and not a sequence of impacts: one impact on the wall alone would
    give 0.5 at any slenderness.

    References
    ----------
    Sorrentino, L., Kunnath, S., Monti, G., Scalora, G. (2008), Eng. Struct. 30(8), 2140-2153.

    Examples
    --------
    >>> [round(float(sorrentino(np.arctan(1.0 / slenderness))), 3) for slenderness in (4, 8, 12)]
    [0.342, 0.455, 0.48]
    """
    base, wall = 1.0 - 1.5 * np.sin(alpha) ** 2, 1.0 - 1.5 * np.cos(alpha) ** 2
    return np.abs(base**2 * wall)


def rebound_of(given: ArrayLike, alpha: np.ndarray, rectangle: bool) -> np.ndarray:
    """Rebounds e [-] from a wall; "sorrentino", for a rectangle with the angles `alpha`, or numbers in [0, 1]."""
    expected = "the share e in [0, 1] of the speed that a return to the wall leaves, or 'sorrentino'"
    if isinstance(given, str):
        if given != "sorrentino":
            raise ValueError(f"rebound: expected {expected}, got {given!r}")
        if not rectangle:
            raise ValueError("rebound: 'sorrentino' is stated for rectangles; give a number e in [0, 1]")
        if np.any(np.tan(alpha) * LEAST_SLENDERNESS >= 1.0):
            raise ValueError(
                "rebound: 'sorrentino' is stated for a slenderness above 1.414, got "
                f"{float(np.min(1.0 / np.tan(alpha))):.3g}; give a number e in [0, 1]"
            )
        return np.asarray(sorrentino(alpha))
    share = numbers("rebound", given, expected)
    if not np.all((share >= 0.0) & (share <= 1.0)):
        raise ValueError(f"rebound: expected {expected}, got {given!r}")
    return share


def both_corners(
    near: np.ndarray,
    far: np.ndarray,
    height: np.ndarray,
    gyration: np.ndarray,
    mass: ArrayLike | None,
    loads: Sequence[Load],
    gravity: float,
) -> tuple[Corner, Corner, Any]:
    """Both corners and the mass of a body with the loads that it carries along, as point masses."""
    along = carried(loads)[0]
    if np.any(near <= 0.0) or np.any(far <= 0.0):
        raise ValueError("offset, lean: expected a centre of mass above the base, between its two corners")
    if along:
        if mass is None:
            raise ValueError("mass: expected it in kg for a body that carries a load along, got none")
        own = positive("mass", mass, "kg")
        weights = [one.weight / gravity for one in along]
        places = [near - (0.5 * (near + far) if one.distance is None else one.distance) for one in along]
        mass = own + sum(weights)
        shift = sum(m * x for m, x in zip(weights, places, strict=True)) / mass
        centre = (own * height + sum(m * one.height for m, one in zip(weights, along, strict=True))) / mass
        inertia = own * (gyration**2 + shift**2 + (height - centre) ** 2)
        for m, x, one in zip(weights, places, along, strict=True):
            inertia = inertia + m * ((x - shift) ** 2 + (one.height - centre) ** 2)
        near, far, height, gyration = near - shift, far + shift, centre, np.sqrt(inertia / mass)
    near, far, height, gyration = together(near=near, far=far, height=height, gyration=gyration)
    return corner(near, far, height, gyration, gravity), corner(far, near, height, gyration, gravity), mass
