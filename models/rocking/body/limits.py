"""The corners of a rigid body, the bounds of its restitution, and warnings of unusual sizes.

.. note:: The centre of mass lies b_1 and b_2 from the right-hand and left-hand corner and h above them. About corner i
   R_i^2 = b_i^2 + h^2, tan(alpha_i) = b_i/h and p_i^2 = g R_i/(rho^2 + R_i^2), rho the radius of gyration. An impact on
   corner 2 conserves the angular momentum about it: (rho^2 + R_2^2) theta'_after = (rho^2 + h^2 - b_1 b_2)
   theta'_before. A symmetric body has C <= 1 - 2 (p^2 R/g) sin^2(alpha); p^2 R/g = M R^2/I_0 is 3/4 for a rectangle and
   below 1 for any body.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from rocking.arguments import ArrayLike, common_shape, numbers, positive
from rocking.body.restraint import Load, Restraints, carried

#: Slenderness above which Sorrentino's rebound from a wall is valid, because 1 - 1.5 cos^2 alpha is negative.
LEAST_SLENDERNESS = np.sqrt(2.0)
#: Stress of the rectangular block at the compressed edge, divided by the compressive strength [-]: NTC 2018, 7.8.2.2.3.
STRESS_BLOCK = 0.85


class Corner(NamedTuple):
    """One corner of (m,) bodies."""

    radius: np.ndarray  #: distance R of the corner from the centre of mass [m]
    alpha: np.ndarray  #: angle between the line from the corner to the centre of mass and the vertical [rad]
    p: np.ndarray  #: frequency parameter of a rotation about the corner [1/s]
    most: np.ndarray  #: upper bound of C of the impact that ends a rotation about the corner [-]


def corner(near: np.ndarray, far: np.ndarray, height: np.ndarray, gyration: np.ndarray, gravity: float) -> Corner:
    """Return the corner at a distance `near` [m] from the centre of mass; the other corner is at the distance `far`."""
    square = near**2 + height**2
    most = (gyration**2 + height**2 - near * far) / (gyration**2 + height**2 + far**2)
    p = np.sqrt(gravity * np.sqrt(square) / (gyration**2 + square))
    return Corner(np.sqrt(square), np.arctan2(near, height), p, most)


def sorrentino(alpha: Any) -> Any:
    """Return the rebound e of a rectangle from a wall, abs((1 - 1.5 sin^2 alpha)^2 (1 - 1.5 cos^2 alpha)).

    Sorrentino, L., Kunnath, S., Monti, G., Scalora, G. (2008), Eng. Struct. 30(8), 2140-2153.
    """
    base, wall = 1.0 - 1.5 * np.sin(alpha) ** 2, 1.0 - 1.5 * np.cos(alpha) ** 2
    return np.abs(base**2 * wall)


def rebound_of(given: ArrayLike, alpha: np.ndarray, rectangle: bool) -> np.ndarray:
    """Return the rebound e [-] from a wall, given as a number in [0, 1] or as "sorrentino" (rectangles only)."""
    expected = "the ratio e in [0, 1] of the speeds after and before an impact on the wall, or 'sorrentino'"
    if isinstance(given, str):
        if given != "sorrentino":
            raise ValueError(f"rebound: expected {expected}, got {given!r}")
        if not rectangle:
            raise ValueError("rebound: 'sorrentino' is valid for rectangles only; give a number e in [0, 1]")
        if np.any(np.tan(alpha) * LEAST_SLENDERNESS >= 1.0):
            raise ValueError(
                "rebound: 'sorrentino' is valid only for a slenderness above 1.414, got "
                f"{float(np.min(1.0 / np.tan(alpha))):.3g}; give a number e in [0, 1]"
            )
        return np.asarray(sorrentino(alpha))
    return numbers("rebound", given, expected, within=(0.0, 1.0))


def both_corners(
    near: np.ndarray,
    far: np.ndarray,
    height: np.ndarray,
    gyration: np.ndarray,
    mass: ArrayLike | None,
    loads: Sequence[Load],
    gravity: float,
    hinge: ArrayLike = 0.0,
) -> tuple[Corner, Corner, Any]:
    """Return both corners and the mass of a body; loads that move with the body are included as point masses.

    `near` and `far` are the distances of the faces from the centre of mass; the corners are `hinge` inside the faces.
    """
    along = carried(loads)[0]
    if np.any(near <= 0.0) or np.any(far <= 0.0):
        raise ValueError("offset, lean: expected a centre of mass above the base, between its two corners")
    if along:
        if mass is None:
            raise ValueError("mass: expected a mass in kg, because a load moves with the body, got None")
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
    if np.any(near <= hinge) or np.any(far <= hinge):
        raise ValueError(
            f"compressive_strength: the edge would be crushed over {2.0 * float(np.max(hinge)):.3g} m, so that no base "
            "is left under the centre of mass; expected a higher strength in Pa"
        )
    near, far, height, gyration = common_shape(near=near - hinge, far=far - hinge, height=height, gyration=gyration)
    return corner(near, far, height, gyration, gravity), corner(far, near, height, gyration, gravity), mass


#: Limits of full sizes [m]; a size outside them is probably in a wrong unit and gives a warning.
LARGEST_SIZE, LEAST_HEIGHT, LEAST_WIDTH = 30.0, 0.05, 0.001
#: Frequency parameters of an overturning spectrum [1/s]: 24 from 0.5 to 8, each 1.128 times the one before, for
#: rectangles with R from 29 m down to 0.11 m.
RATES = np.geomspace(0.5, 8.0, 24)


def radius_of_rectangle(p: float | np.ndarray, gravity: float) -> Any:
    """Return the radius R [m] of the rectangle with the frequency parameter p [1/s]: 3 g/(4 p^2)."""
    return 3.0 * gravity / (4.0 * p**2)


def most_restitution(p: np.ndarray, alpha: np.ndarray, radius: np.ndarray | None, gravity: float) -> np.ndarray:
    """Return the upper bound of C from conservation of angular momentum; without `radius`, the bound of a rectangle."""
    if radius is None:
        return 1.0 - 1.5 * np.sin(alpha) ** 2
    share = p**2 * radius / gravity
    if np.any(share >= 1.0):
        worst = np.unravel_index(np.argmax(share), share.shape)
        raise ValueError(
            f"radius: no body with p = {p[worst]:.6g} 1/s has R = {radius[worst]:.6g} m: its moment of inertia about "
            f"the corner, M g R/p^2, would be below M R^2; expected less than g/p^2 = {gravity / p[worst] ** 2:.4g} m, "
            "from the corner to the centre of mass (a rectangle has 3/4 of that)"
        )
    return 1.0 - 2.0 * share * np.sin(alpha) ** 2


def restitution_of(given: ArrayLike, most: np.ndarray, own: bool) -> np.ndarray:
    """Return C from a number or "housner" (the bound `most`); `own` is True if p and radius are given."""
    if isinstance(given, str):
        if given != "housner":
            raise ValueError(f"restitution: expected a number in [0, 1] or 'housner', got {given!r}")
        if np.any(most < 0.0):
            why = "Housner's formula is negative below a slenderness of 0.707"
            if own:
                why = "1 - 2 (p^2 R/g) sin^2(alpha) is negative for this p, alpha and radius"
            raise ValueError(f"restitution: {why}; give a number in [0, 1]")
        return most
    return numbers("restitution", given, "the velocity ratio C in [0, 1] or 'housner'", within=(0.0, 1.0))


def restitutions_of(
    given: ArrayLike, most: tuple[np.ndarray, np.ndarray], wall: tuple[bool, Any], alpha: np.ndarray, shape: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return C for both corners, or the rebound e for a body beside a wall.

    `most` holds the largest C allowed at each corner, `wall` is (one_sided, rebound), `shape` is as in `Block._finish`.
    """
    one_sided, rebound = wall
    if not isinstance(one_sided, bool | np.bool_):
        raise ValueError(f"one_sided: expected True or False, got {one_sided!r}")
    if not one_sided:
        if rebound is not None:
            raise ValueError(f"rebound: expected one_sided=True as well, got {rebound!r} alone; leave rebound out")
        first, second = (restitution_of(given, one, own=shape == "own") for one in most)
        return first, second
    if not (isinstance(given, str) and given == "housner"):
        raise ValueError(f"restitution: a one-sided body has none, got {given!r}; give its rebound from the wall")
    share = rebound_of("sorrentino" if rebound is None else rebound, alpha, shape == "rectangle")
    return share, share


def check_restraints(restraints: Restraints, first: Corner, second: Corner, block: Any) -> None:
    """Raise ValueError if the body has no mass, a restraint is above the body, or the restraints overturn it."""
    if np.any(np.isnan(block.mass)):
        raise ValueError("mass: expected a mass in kg, or density and length, for a body with ties, loads or thrusts")
    top = 2.0 * np.min(block.half_height) if not np.any(np.isnan(block.half_height)) else np.inf
    if restraints.highest > top * (1.0 + 1e-9):
        raise ValueError(
            f"ties, loads, thrusts: expected heights up to that of the body, {top:g} m, got {restraints.highest:g} m"
        )
    base = np.asarray(first.radius * np.sin(first.alpha) + second.radius * np.sin(second.alpha))
    leaning = bool(np.all(np.asarray(block.side) == 1))
    for place, own in enumerate((first,) if leaning else (first, second)):
        moment = np.array([restraints.constant(float(width))[place, 0] for width in np.ravel(base)])
        if np.any(moment + np.ravel(block.mass * block.gravity * own.radius * np.sin(own.alpha)) <= 0.0):
            raise ValueError("loads, thrusts: expected forces that leave the body at rest, got forces that overturn it")


def block_warnings(
    half: tuple[np.ndarray, np.ndarray],
    corners: tuple[Corner, Corner],
    ratios: tuple[np.ndarray, np.ndarray],
    shape: str,
    one_sided: bool,
) -> list[str]:
    """Return warnings of unusual sizes and of restitutions above their bounds; `half` is half width and height [m]."""
    first = corners[0]
    across, along = 2.0 * first.radius * np.sin(first.alpha), 2.0 * first.radius * np.cos(first.alpha)
    if shape in ("rectangle", "general"):
        across = 2.0 * half[0]
        along = 2.0 * half[1] if shape == "rectangle" else along
    warnings = [size_warning(across, along, shape)]
    if not one_sided:
        warnings += [restitution_warning(ratio, one.most, shape) for ratio, one in zip(ratios, corners, strict=True)]
    return list(dict.fromkeys(warning for warning in warnings if warning))


def restitution_warning(restitution: np.ndarray, most: np.ndarray, shape: str) -> str:
    """Return a warning if a restitution is above its bound `most`, else an empty string."""
    above = restitution - most
    if not np.any(above > 1e-12):
        return ""
    worst = np.unravel_index(np.argmax(above), above.shape)
    given, bound = (float(np.broadcast_to(values, above.shape)[worst]) for values in (restitution, most))
    if shape == "unknown":
        return (
            f"restitution {given:.4g} is above Housner's {bound:.4g} of a rectangle with this alpha; a body of another "
            "shape has its own bound: give its radius, from the corner to the centre of mass"
        )
    limit = {
        "rectangle": f"Housner's {bound:.4g}",
        "general": f"{bound:.4g}, the bound for its corners and radius of gyration",
    }.get(shape, f"{bound:.4g}, the bound for its p, alpha and radius")
    return (
        f"restitution {given:.4g} is above {limit}: more energy is kept in an impact than conservation of angular "
        "momentum allows"
    )


def size_problem(width: float, height: float) -> str:
    """Return what is unusual about the full sizes [m] of a body, such as "wider than high"; else an empty string."""
    if max(width, height) > LARGEST_SIZE:
        return f"larger than {LARGEST_SIZE:g} m"
    if height < LEAST_HEIGHT:
        return f"less than {100.0 * LEAST_HEIGHT:g} cm high"
    if width < LEAST_WIDTH:
        return f"less than {1000.0 * LEAST_WIDTH:g} mm wide"
    # Rounding may make a square given by p and alpha = pi/4 slightly wider than high.
    return "wider than high" if width > height * (1.0 + 1e-12) else ""


def size_warning(width: np.ndarray, height: np.ndarray, shape: str) -> str:
    """Return a warning about the first body of an unusual size; an empty string if there is no such body."""
    sizes = (values.ravel().tolist() for values in np.broadcast_arrays(width, height))
    for base, rise in zip(*sizes, strict=True):
        if doubt := size_problem(base, rise):
            subject = "" if shape in ("rectangle", "general") else "a rectangle with its R and alpha would be "
            return f"{subject}{base:.4g} m wide and {rise:.4g} m high, {doubt}: check the numbers and their units"
    return ""
