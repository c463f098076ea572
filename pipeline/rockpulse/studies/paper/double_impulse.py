"""The critical double impulse of Nabeshima et al. (2016), with which the paper compares its I_2c.

.. note:: Nonlinear motion on rigid ground without damping but for Housner's restitution: an impulse V sets the resting
   block in motion, a second one in the other direction acts right after its impact, and V_c just overturns it.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ellipkinc, ellipkm1

from rocking.body.block import Block

__all__ = ["critical_double_impulse"]


def critical_double_impulse(block: Block) -> tuple[float, float]:
    """Critical double impulse V_c [m/s] of one block with its restitution, and the time t_0 [s] between its impulses.

    Moment of momentum gives each impulse the rate w = p^2 cos(alpha_c) V/g; the rate 2 p sin(alpha_c/2) leads to
    unstable equilibrium; hence V_c = 2 g sin(alpha_c/2)/(p cos(alpha_c) (1 + C)). With phi = alpha_c - theta the motion
    is phi'' = p^2 sin(phi), whose first half-cycle lasts t_0 = (2/p) [K(m) - F(chi, m)] with m = cos^2(phi_m/2),
    sin(chi) = cos(alpha_c/2)/cos(phi_m/2), phi_m the angle that is left at the top: cos(phi_m) = cos(alpha_c) + w^2/(2
    p^2).

    References
    ----------
    Nabeshima, K., Taniguchi, R., Kojima, K., Takewaki, I. (2016), Front. Built Environ. 2:9,
    doi:10.3389/fbuil.2016.00009.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.93649167, gravity=9.81)
    >>> [round(value, 5) for value in critical_double_impulse(block)]
    [0.69834, 0.61152]
    """
    alpha, p = float(block.alpha_c), float(block.p)
    critical_rate = 2.0 * p * math.sin(0.5 * alpha)
    rate = critical_rate / (1.0 + float(block.restitution))
    impulse = rate * block.gravity / (p * p * math.cos(alpha))
    # sin^2(phi_m/2) = sin^2(alpha/2) - w^2/(4 p^2), small for slender blocks: kept as it is for the integral K.
    remaining = math.sin(0.5 * alpha) ** 2 - (0.5 * rate / p) ** 2
    chi = np.arcsin(math.cos(0.5 * alpha) / math.sqrt(1.0 - remaining))
    return float(impulse), float(2.0 / p * (ellipkm1(remaining) - ellipkinc(chi, 1.0 - remaining)))
