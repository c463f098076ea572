"""The rigid block: geometry, restitution and constants of its rocking motion (Casapulla & Maione 2017, section 3)."""

import logging
import math
from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from rocking.arguments import ArrayLike, common_shape, numbers, positive
from rocking.body import limits
from rocking.body.block_lanes import SLENDERNESS_RANGE, STANDARD_GRAVITY, BlockLanes
from rocking.body.restraint import Load, Restraints, Thrust, Tie, carried

logger = logging.getLogger("rockpulse")


class Block(BlockLanes):
    """A rigid block or an array of m blocks, with full or half sizes; its fields are broadcast to the shape () or (m,).

    Parameters
    ----------
    width, height : float or (m,) array_like
        2b and 2a, the full base in the plane of rocking and the full height [m].
    restitution : "housner", float or (m,) array_like
        Velocity ratio C = theta'(after)/theta'(before) of an impact [-], 0 <= C <= 1. "housner" is 1 - 1.5
        sin^2(alpha_c), the upper bound from conservation of angular momentum (Housner's r is its square).
    gravity : float
        Acceleration of gravity at the block [m/s2].
    offset, lean : float or (m,) array_like
        Distance of the centre of mass from the middle of the base, positive towards the right-hand corner [m]; tilt of
        a body whose base is cut horizontally, positive to the same side [rad].
    half_width, half_height : float or (m,) array_like
        b and a, half the base and half the height [m], instead of the full sizes; by keyword only.
    one_sided : bool
        Whether the body leans on a wall and turns towards theta > 0 only, away from it.
    rebound : "sorrentino", float or (m,) array_like, optional
        For a one-sided body, in place of the restitution: e = -theta'(after)/theta'(before) of an impact on the wall
        [-]; by default :func:`rocking.body.limits.sorrentino`.
    ties, loads, thrusts : sequence of Tie, Load, Thrust
        Restraints, the same for all blocks of an array.
    mass, density, length : float or (m,) array_like, optional
        Mass [kg], or density [kg/m3] and length across the plane of rocking [m]; needed with restraints.
    compressive_strength : float, optional
        Strength f of the masonry [Pa], with density and length: the corners of rotation move inwards to the resultant
        of a rectangular block of stresses, N/(1.7 f length) with the weight N of body and loads (NTC 2018, 7.8.2.2.3).
    log : bool
        Whether the warnings are also logged, by the logger "rockpulse".

    Attributes
    ----------
    alpha_c, p, radius : float or (m,) ndarray
        For the right-hand corner (theta > 0): angle between the vertical and the line to the centre of mass [rad],
        frequency parameter [1/s], distance R from the centre of mass [m] (the value of a rectangle if unknown).
    alpha_2, p_2, radius_2, restitution_2 : float or (m,) ndarray
        The same for the left-hand corner (theta < 0), and C of the impact that ends a rotation about this corner, or e
        of an impact on a wall.
    slenderness : float or (m,) ndarray
        a/b = 1/tan(alpha_c) [-].
    critical_impulse : float or (m,) ndarray
        I_1c = g alpha_c/(p cos alpha_c), the impulse that overturns the resting block at once (Eq. 9 with i = 1) [m/s].
    side : int or (m,) ndarray
        1 for a body that turns towards theta > 0 only, -1 for its mirror image, 0 for a body that turns both ways.
    hinge : float or (m,) ndarray
        Distance of the corners of rotation from the faces [m]; 0 without a compressive strength.
    mass : float or (m,) ndarray
        Mass including the loads that move with the body [kg]; NaN if it was not given.
    restraints : Restraints, (m,) ndarray of them, or None
        Ties, loads and thrusts.
    warnings : tuple of str
        Warnings of a restitution above its bound, a slenderness below the paper's range, or an unusual size.

    Raises
    ------
    ValueError
        For sizes or gravity that are not positive and finite, only one size, a half size together with a full one, a
        restitution outside [0, 1], or "housner" with a slenderness below 0.707, for which it is negative; for a centre
        of mass outside the base, a rebound without `one_sided` or a restitution with it, and for restraints without a
        mass, above the body or so strong that they overturn the resting body; for a compressive strength that leaves no
        base, or without density and length.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, doi:10.7712/120117.5612.17190.
    Housner, G. W. (1963), Bull. Seismol. Soc. Am. 53(2), 403-417.
    Circolare 7/2019, C8.7.1.2.1: hinges inside the edge; NTC 2018, 7.8.2.2.3: block of stresses of 0.85 f.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.93649167, gravity=9.81)
    >>> round(float(block.p), 7), round(float(block.restitution), 5)
    (1.9180068, 0.90625)
    >>> wall = Block(0.25, 2.2)
    >>> wall.half_width, wall.half_height, wall.width, wall.height
    (0.125, 1.1, 0.25, 2.2)
    """

    def __init__(
        self,
        width: ArrayLike | None = None,
        height: ArrayLike | None = None,
        restitution: ArrayLike = "housner",
        gravity: float = STANDARD_GRAVITY,
        *,
        half_width: ArrayLike | None = None,
        half_height: ArrayLike | None = None,
        offset: ArrayLike = 0.0,
        lean: ArrayLike = 0.0,
        one_sided: bool = False,
        rebound: ArrayLike | None = None,
        ties: Sequence[Tie] = (),
        loads: Sequence[Load] = (),
        thrusts: Sequence[Thrust] = (),
        mass: ArrayLike | None = None,
        density: ArrayLike | None = None,
        length: ArrayLike | None = None,
        compressive_strength: float | None = None,
        log: bool = True,
    ) -> None:
        sizes = {"width": width, "height": height, "half_width": half_width, "half_height": half_height}
        given = {name: positive(name, value, "m") for name, value in sizes.items() if value is not None}
        if set(given) not in ({"half_width", "half_height"}, {"width", "height"}):
            found = " and ".join(given) or "no size"
            raise ValueError(f"block: expected width and height, or half_width and half_height, in m; got {found}")
        base, rise = common_shape(**given)
        if "width" in given:
            base, rise = base / 2.0, rise / 2.0
        if (density is None) != (length is None) or (density is not None and mass is not None):
            raise ValueError("mass: expected mass in kg, or density in kg/m3 and length in m")
        if density is not None and length is not None:
            mass = 4.0 * base * rise * positive("density", density, "kg/m3") * positive("length", length, "m")
        options = {"offset": numbers("offset", offset, "a distance in m"), "lean": numbers("lean", lean, "an angle")}
        shift = options["offset"] + rise * np.sin(options["lean"])
        gravity = float(positive("gravity", gravity, "m/s2", lanes=False))
        radius = np.hypot(base, rise)
        plain, hinge = not np.any(shift) and not carried(loads)[0], np.zeros(())
        if compressive_strength is not None:
            strength = float(positive("compressive_strength", compressive_strength, "Pa", lanes=False))
            if density is None or length is None:
                raise ValueError("compressive_strength: needs density in kg/m3 and length in m as well")
            pressed = np.asarray(mass) * gravity + sum(one.weight for one in loads)
            hinge = 0.5 * pressed / (limits.STRESS_BLOCK * strength * np.asarray(length, dtype=float))
        if plain and compressive_strength is None:
            p = np.sqrt(3.0 * gravity / (4.0 * radius))
            alpha = np.arctan2(base, rise)
            first = limits.Corner(radius, alpha, p, limits.most_restitution(p, alpha, None, gravity))
            second, shape = first, "rectangle"
        else:
            body = base - shift, base + shift, rise * np.cos(options["lean"]), radius / math.sqrt(3.0)
            first, second, mass = limits.both_corners(*body, mass, loads, gravity, hinge)
            shape = "rectangle" if plain else "general"
        acting = Restraints(tuple(ties), tuple(carried(loads)[1]), tuple(thrusts), float(np.max(hinge, initial=0.0)))
        if acting and np.any(hinge != acting.hinge):
            raise ValueError("compressive_strength: bodies with ties, loads or thrusts must be of equal size")
        held, wall = (acting, mass), (one_sided, rebound)
        self._finish((base, rise), first, second, restitution, gravity, shape, wall, held, log, hinge)

    @classmethod
    def from_parameters(
        cls,
        p: ArrayLike,
        alpha: ArrayLike,
        restitution: ArrayLike,
        gravity: float = STANDARD_GRAVITY,
        *,
        radius: ArrayLike | None = None,
        one_sided: bool = False,
        rebound: ArrayLike | None = None,
        log: bool = True,
    ) -> Self:
        """Create a symmetric body of any shape from its frequency parameter and critical angle; its sizes are NaN.

        Parameters
        ----------
        p : float or (m,) array_like
            Frequency parameter sqrt(M g R/I_0) [1/s].
        alpha : float or (m,) array_like
            Angle between the vertical and the line from the corner to the centre of mass [rad], below pi/2.
        restitution : float, (m,) array_like or "housner"
            As for :class:`Block`. "housner" is the upper bound from angular momentum: 1 - 2 (p^2 R/g) sin^2(alpha) with
            a `radius`, else 1 - 1.5 sin^2(alpha), the bound of the rectangle with the same alpha.
        radius : float or (m,) array_like, optional
            R, from the corner to the centre of mass [m]; used only for the bound of the restitution.
        gravity, one_sided, rebound, log
            As for :class:`Block`; the rebound is a number.

        Raises
        ------
        ValueError
            For p, alpha, radius or gravity that are not positive and finite, an alpha of pi/2 or more, a restitution
            outside [0, 1], "housner" if the bound is negative, or a radius that no body of this p can have: p^2 R/g = M
            R^2/I_0 < 1.

        Examples
        --------
        A solid cylinder of diameter 0.5 m and height 2 m, rocking in one plane: I_0 = M (r^2/4 + H^2/12 + R^2).

        >>> radius, inertia = np.hypot(0.25, 1.0), 0.25**2 / 4 + 2.0**2 / 12 + 0.25**2 + 1.0**2
        >>> p = np.sqrt(STANDARD_GRAVITY * radius / inertia)
        >>> column = Block.from_parameters(p, np.arctan(0.25), "housner", radius=radius)
        >>> round(column.restitution, 4), round(Block(0.5, 2.0).restitution, 4)
        (0.9114, 0.9118)
        """
        given = {"p": positive("p", p, "1/s"), "alpha": positive("alpha", alpha, "rad")}
        if radius is not None:
            given["radius"] = positive("radius", radius, "m")
        p_, alpha_, *own = common_shape(**given)
        if np.any(alpha_ >= np.pi / 2):
            raise ValueError(
                f"alpha: expected an angle below pi/2 rad, got {alpha!r}; it is given in radians, not degrees"
            )
        weight = float(positive("gravity", gravity, "m/s2", lanes=False))
        most = limits.most_restitution(p_, alpha_, own[0] if own else None, weight)
        first = limits.Corner(own[0] if own else limits.radius_of_rectangle(p_, weight), alpha_, p_, most)
        block, unknown = object.__new__(cls), np.full(p_.shape, np.nan)
        half, shape, wall = (unknown, unknown), "own" if own else "unknown", (one_sided, rebound)
        block._finish(half, first, first, restitution, weight, shape, wall, (Restraints(), None), log)
        return block

    @classmethod
    def from_corners(
        cls,
        b_1: ArrayLike,
        b_2: ArrayLike,
        height: ArrayLike,
        gyration: ArrayLike,
        restitution: ArrayLike = "housner",
        gravity: float = STANDARD_GRAVITY,
        *,
        one_sided: bool = False,
        rebound: ArrayLike | None = None,
        ties: Sequence[Tie] = (),
        loads: Sequence[Load] = (),
        thrusts: Sequence[Thrust] = (),
        mass: ArrayLike | None = None,
        log: bool = True,
    ) -> Self:
        """Create an asymmetric body from its corners and its centre of mass; `width` is its base, `height` is NaN.

        Parameters
        ----------
        b_1, b_2 : float or (m,) array_like
            Horizontal distances of the right-hand and of the left-hand corner from the centre of mass [m].
        height, gyration : float or (m,) array_like
            Height of the centre of mass above the corners, and radius of gyration sqrt(I_G/M) about it [m].
        restitution : "housner", float or (m,) array_like
            C of both impacts; "housner" is the upper bound from angular momentum, (rho^2 + h^2 - b_1 b_2)/(rho^2 +
            R^2), R the distance from the corner that hits the ground to the centre of mass.
        gravity, one_sided, rebound, ties, loads, thrusts, mass, log
            As for :class:`Block`; the rebound is a number.

        Examples
        --------
        >>> block = Block.from_corners(0.25, 0.25, 1.0, np.hypot(0.25, 1.0) / np.sqrt(3.0))  # a rectangle, 0.5 x 2 m
        >>> round(block.p - Block(width=0.5, height=2.0).p, 12)
        0.0
        """
        sizes = {"b_1": b_1, "b_2": b_2, "height": height, "gyration": gyration}
        near, far, rise, rho = common_shape(**{name: positive(name, value, "m") for name, value in sizes.items()})
        weight = float(positive("gravity", gravity, "m/s2", lanes=False))
        first, second, mass = limits.both_corners(near, far, rise, rho, mass, loads, weight)
        acting = Restraints(tuple(ties), tuple(carried(loads)[1]), tuple(thrusts))
        block = object.__new__(cls)
        half = 0.5 * (near + far), np.full(near.shape, np.nan)
        block._finish(half, first, second, restitution, weight, "general", (one_sided, rebound), (acting, mass), log)
        return block

    def _finish(
        self,
        half: tuple[np.ndarray, np.ndarray],
        first: limits.Corner,
        second: limits.Corner,
        restitution: ArrayLike,
        gravity: float,
        shape: str,
        wall: tuple[bool, Any],
        restraints_and_mass: tuple[Restraints, Any],
        log: bool,
        hinge: ArrayLike = 0.0,
    ) -> None:
        """Set all fields; `shape` is "rectangle", "general", "own" (p and radius given) or "unknown" (only p given)."""
        ratios = limits.restitutions_of(restitution, (first.most, second.most), wall, first.alpha, shape)
        restraints, mass = restraints_and_mass
        alone = {"size": first.alpha, "restitution": ratios[0]}
        known = np.asarray(np.nan) if mass is None else positive("mass", mass, "kg")
        lanes = common_shape(**alone, mass=known)[0].shape
        values = {
            "half_width": half[0],
            "half_height": half[1],
            "restitution": ratios[0],
            "alpha_c": first.alpha,
            "p": first.p,
            "radius": first.radius,
            "slenderness": 1.0 / np.tan(first.alpha),
            "critical_impulse": gravity * first.alpha / (first.p * np.cos(first.alpha)),
            "alpha_2": second.alpha,
            "p_2": second.p,
            "radius_2": second.radius,
            "restitution_2": ratios[1],
            "side": np.array(1.0 if wall[0] else 0.0),
            "mass": known,
            "hinge": np.asarray(hinge),
        }
        for name, value in values.items():
            values[name] = value = np.array(np.broadcast_to(value, lanes), dtype=np.int64 if name == "side" else float)
            value.setflags(write=False)
        one = {name: value.item() if value.ndim == 0 else value for name, value in values.items()}
        vars(self).update(one | {"gravity": gravity, "restraints": None})
        if restraints:
            limits.check_restraints(restraints, first, second, self)
            whole = np.empty(lanes, dtype=object)
            whole[...] = restraints
            vars(self)["restraints"] = whole if lanes else restraints
        warnings = limits.block_warnings(half, (first, second), ratios, shape, one_sided=wall[0])
        if not np.all(self.slender):
            warnings.append(
                f"slenderness {np.min(values['slenderness']):.3g} is below {SLENDERNESS_RANGE:g}: "
                "the models with linear motion (resonance, sequence, impulsive, linear) are outside their range"
            )
        vars(self)["warnings"] = tuple(warnings)
        if log:
            for warning in self.warnings:
                logger.warning("block: %s", warning)
