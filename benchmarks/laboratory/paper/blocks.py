"""The two blocks of Figure 5, their critical double impulse, and the counts of a motion under limited input."""

import math
from typing import Any

import numpy as np
from scipy.special import ellipkinc, ellipkm1

from rocking.body.block import Block
from rocking.response import Outcome, Response

#: Gravity that the numbers of the paper follow [m/s2].
GRAVITY = 9.81
#: 2b of both blocks [m].
WIDTH = 1.0
#: R [m]; the second block is the more slender one.
RADII = {"A": 2.0, "B": 4.0}
#: C of section 4.
RESTITUTIONS = (0.9, 0.6)
#: Length of the input [s].
DURATION = 20.0


def paper_block(name: str, restitution: Any) -> Block:
    """Block "A" or "B" of Figure 5: 2b = 1 m with R = 2 m or 4 m; the restitution is C [-] or "housner".

    Examples
    --------
    >>> round(float(paper_block("A", 0.9).p), 7)
    1.9180068
    """
    half_width = 0.5 * WIDTH
    height = math.sqrt((RADII[name] - half_width) * (RADII[name] + half_width))
    return Block(half_width=half_width, half_height=height, restitution=restitution, gravity=GRAVITY)


def half_cycle_counts(response: Response, duration: float) -> np.ndarray:
    """Number of half-cycles that a main impulse starts in every lane, up to and with the one that overturns.

    The response has the whole table, and `duration` is the finite length of the input [s]. The table ends where the
    motion repeats itself; the half-cycles from there on are as long as its last one.
    """
    assert response.half_cycles is not None
    durations = response.half_cycles.duration
    listed = np.sum(np.isfinite(durations), axis=0)
    last = np.take_along_axis(durations, np.maximum(listed - 1, 0)[None], axis=0)[0]
    with np.errstate(invalid="ignore"):
        left = np.ceil((duration - np.nansum(np.where(np.isfinite(durations), durations, 0.0), axis=0)) / last)
    repeated = listed + np.maximum(np.nan_to_num(left), 0.0)
    overturned = np.asarray(response.outcome) == Outcome.OVERTURNS
    return np.where(overturned, response.overturning_half_cycle, repeated).astype(np.int64)


def no_motion(ground_contact: Any, *peaks: Any) -> np.ndarray:
    """True where the closed form is no physical motion: through the ground, or a finite peak beyond alpha_c.

    A block whose largest theta/alpha_c is beyond 1 does not come back: with "start" x(T) = 0 has roots for velocities
    of up to 1 + I_s/I on motions that do (docs/decisions/013).

    Examples
    --------
    >>> no_motion([False, False, False, True], [0.9, 1.1, np.inf, 0.5]).tolist()
    [False, True, False, True]
    """
    flags = np.asarray(ground_contact, dtype=bool)
    for peak in peaks:
        flags = flags | (np.isfinite(peak) & (np.asarray(peak) > 1.0))
    return flags


def critical_double_impulse(block: Block) -> tuple[float, float]:
    """Critical double impulse V_c [m/s] of one block with its restitution, and the time t_0 [s] between its impulses.

    Nonlinear motion on rigid ground without damping but for Housner's restitution: an impulse V sets the resting block
    in motion, a second one in the other direction acts right after its impact, and V_c just overturns it.

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
