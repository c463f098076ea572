"""A body and the pedestal under it as one rigid body."""

from __future__ import annotations

import math

import numpy as np

from rocking.arguments import numbers
from rocking.block import Block
from rocking.quantities import ArrayLike

__all__ = ["with_pedestal"]


def with_pedestal(block: Block, width: float, height: float, mass: float, restitution: ArrayLike = "housner") -> Block:
    """One body of a block and a homogeneous rectangular pedestal, in the middle of whose top it stands.

    Parameters
    ----------
    block : Block
        One body with a mass, without a wall or restraints.
    width, height : float
        Full size of the pedestal in the plane of rocking [m].
    mass : float
        Of the pedestal [kg].
    restitution : float, list of float or "housner"
        Velocity ratio of an impact of the whole.

    Returns
    -------
    Block
        It turns about the corners of the pedestal.

    Raises
    ------
    ValueError
        For a block without a mass, with a wall or restraints, or wider at its base than the pedestal; for sizes or a
        mass that are no positive numbers; or where the whole has its centre of mass outside its base.

    Notes
    -----
    Moments of inertia are added about the common centre of mass (Steiner). The two may also move each on its own: the
    block alone on the top of the pedestal is the other case to look at.

    Examples
    --------
    >>> statue = Block(width=0.5, height=1.8, mass=600.0)
    >>> whole = with_pedestal(statue, width=0.9, height=1.2, mass=2300.0)
    >>> round(float(whole.mass)), round(float(whole.alpha_c), 3), round(float(statue.alpha_c), 3)
    (2900, 0.459, 0.271)
    """
    for name, value in (("width", width), ("height", height), ("mass", mass)):
        if not float(numbers(f"pedestal {name}", value, "a positive number", lanes=False)) > 0.0:
            raise ValueError(f"pedestal {name}: expected a positive number, got {value!r}")
    one = block.lanes(1).lane(0) if block.shape else block
    own = float(one.mass)
    if one.side or one.restraints is not None:
        raise ValueError("block: expected a free one on the pedestal, got one with a wall or with restraints")
    if math.isnan(own):
        raise ValueError("block: one body with its pedestal needs the mass of both; give mass, or density and length")
    right, left = float(one.radius * np.sin(one.alpha_c)), float(one.radius_2 * np.sin(one.alpha_2))
    if right + left > width:
        raise ValueError(
            f"pedestal width: expected at least that of the base on it, {right + left:g} m, got {width:g} m"
        )
    whole = own + mass
    x, z = 0.5 * (left - right), height + float(one.radius * np.cos(one.alpha_c))
    centre_x, centre_z = own * x / whole, (own * z + 0.5 * mass * height) / whole
    # About the centre of mass of the block: p^2 (I + M R^2) = M g R.
    inertia = own * float(one.gravity * one.radius / one.p**2 - one.radius**2)
    inertia += own * ((x - centre_x) ** 2 + (z - centre_z) ** 2)
    inertia += mass * ((width**2 + height**2) / 12.0 + centre_x**2 + (0.5 * height - centre_z) ** 2)
    return Block.from_corners(
        0.5 * width - centre_x,
        0.5 * width + centre_x,
        centre_z,
        math.sqrt(inertia / whole),
        restitution=restitution,
        gravity=float(block.gravity),
        mass=whole,
        log=False,
    )
