"""The kinematic check of Italian practice for a free or one-sided block on the ground, from its geometry alone.

.. note:: Circolare 2 February 2009 n. 617, C8A.4. With the weights P_i, their virtual horizontal displacements d_i and
   the multiplier alpha_0 of the horizontal forces that opens the mechanism: participating mass M* = (sum P_i d_i)^2/(g
   sum P_i d_i^2) (C8A.4.3), its share e* = g M*/sum P_i, spectral acceleration of activation a_0* = alpha_0 g/(e* FC)
   (C8A.4.4). One block is one weight: e* = 1 and alpha_0 = tan(alpha_c). Linear: a_0* >= a_g S/q. Nonlinear: a* = a_0*
   (1 - d*/d_0*), d_u* = 0.4 d_0*, secant period T_s = 2 pi sqrt(d_s*/a_s*) at d_s* = 0.4 d_u*, d_u* >= S_De(T_s).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from rocking.block import Block

__all__ = ["KinematicCheck", "kinematic_check"]

#: d_u* over d_0*, and d_s* over d_u* [-].
ULTIMATE, SECANT = 0.4, 0.4


class KinematicCheck(NamedTuple):
    """The kinematic check of (m,) blocks.

    Attributes
    ----------
    activation : (m,) ndarray
        a_0*, spectral acceleration that opens the mechanism [m/s2].
    linear : (m,) ndarray
        a_0* over a_g S/q [-]; at least 1 passes.
    ultimate : (m,) ndarray
        d_u*, the displacement of the centre of mass that is allowed [m].
    secant_period : (m,) ndarray
        T_s [s].
    nonlinear : (m,) ndarray
        d_u* over S_De(T_s) [-]; at least 1 passes.
    """

    activation: np.ndarray
    linear: np.ndarray
    ultimate: np.ndarray
    secant_period: np.ndarray
    nonlinear: np.ndarray


def kinematic_check(
    block: Block,
    spectrum: Callable[[np.ndarray], np.ndarray],
    ground: float,
    behaviour: float = 2.0,
    confidence_factor: float = 1.0,
) -> KinematicCheck:
    """Check blocks on the ground by the linear and the nonlinear kinematic analysis.

    Parameters
    ----------
    block : Block
        (m,) blocks, free or before a wall, without ties, loads or thrusts; with unlike corners the weaker one counts.
    spectrum : callable
        Elastic spectrum S_e of 5 % damping [m/s2] at (k,) periods [s].
    ground : float
        a_g S, the peak of the ground's acceleration on its soil [m/s2].
    behaviour : float
        q; 2 in the circular.
    confidence_factor : float
        FC, by how well the building is known: 1 or more.

    Returns
    -------
    KinematicCheck

    Raises
    ------
    ValueError
        For restrained blocks, or numbers out of range.

    Examples
    --------
    A free rectangle of 0.4 x 4 m: a_0* = g b/h, d_0* = b/2 at mid-height.

    >>> found = kinematic_check(Block(width=[0.4], height=[4.0]), lambda periods: 2.5 / periods, ground=2.0)
    >>> [round(float(values[0]), 4) for values in found]
    [0.9807, 0.9807, 0.08, 1.2384, 1.0201]
    """
    if not (math.isfinite(ground) and ground > 0.0 and behaviour >= 1.0 and confidence_factor >= 1.0):
        raise ValueError(
            "ground, behaviour, confidence_factor: expected a_g S above 0, q and FC of at least 1, got "
            f"{ground!r}, {behaviour!r}, {confidence_factor!r}"
        )
    lanes = (block if block.shape else block.lanes(1)).weaker
    if np.any(lanes.restrained):
        raise ValueError("block: the check is of blocks without ties, loads and thrusts")
    activation = lanes.gravity * np.tan(lanes.alpha_c) / confidence_factor
    # The centre of mass has no couple left when it stands above the corner.
    furthest = lanes.radius * np.sin(lanes.alpha_c)
    ultimate = ULTIMATE * furthest
    slowest = SECANT * ultimate
    period = 2.0 * np.pi * np.sqrt(slowest / (activation * (1.0 - slowest / furthest)))
    demand = np.asarray(spectrum(period), dtype=float) * (period / (2.0 * np.pi)) ** 2
    return KinematicCheck(activation, activation / (ground / behaviour), ultimate, period, ultimate / demand)
