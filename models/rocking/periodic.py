"""The periodic motion to which an endless sequence tends (Casapulla & Maione 2017, Eq. 10 and section 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rocking.half_cycle import stays_bounded
from rocking.half_cycle_table import combined
from rocking.impulse_sequence import ImpulseSequence
from rocking.motion import hop
from rocking.quantities import Booleans, Floats
from rocking.response import squeezed

__all__ = ["SteadyState", "steady_state"]


@dataclass(frozen=True, eq=False)
class SteadyState:
    """Limit of the half-cycles of an endless sequence; arrays (q, m), or scalars for one lane.

    Attributes
    ----------
    start_velocity : float or ndarray
        u* = u_1 (1 - C I_s/I)/(1 - C), theta'/(p alpha_c) right after the main impulse [-]; inf where the motion only
        grows.
    effective_velocity : float or ndarray
        v* = u* - u_1 I_s/(2 I), what the secondary impulses leave of it [-].
    peak : float or ndarray
        x* = 1 - sqrt(1 - v*^2), largest theta/alpha_c [-]; inf where the motion does not stabilise.
    half_period : float or ndarray
        2 atanh(v*)/p [s]; inf where the motion does not stabilise, or only just (v* = 1).
    stable : bool or ndarray
        Whether the motion stabilises, v* <= 1 (at v* = 1 the limit is never reached).
    """

    start_velocity: Floats
    effective_velocity: Floats
    peak: Floats
    half_period: Floats
    stable: Booleans


def steady_state(block: Block, sequence: ImpulseSequence) -> SteadyState:
    """Steady state under a main sequence without end, with a continuous secondary sequence or none.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    sequence : ImpulseSequence
        One sequence, or (q,), of spacing "continuous" or without secondary impulses; its duration and main count play
        no part.

    Returns
    -------
    SteadyState
        Lanes (q, m), a scalar axis dropped.

    Raises
    ------
    ValueError
        For another spacing with secondary impulses, whose number may change from one half-cycle to the next.

    Notes
    -----
    The recurrence u_{i+1} = C (u_i - u_1 I_s/I) + u_1 has the fixed point u*. Without secondary impulses it is Eq.
    (10).

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.6, gravity=9.81)
    >>> impulse = 0.3 * block.critical_impulse
    >>> steady = steady_state(block, ImpulseSequence(impulse, 0.0, np.nan, np.inf, spacing="continuous"))
    >>> round(steady.start_velocity, 6), round(steady.peak, 6)
    (0.75, 0.338562)
    """
    if sequence.spacing != "continuous" and np.any(np.asarray(sequence.secondary) > 0.0):
        raise ValueError(f"spacing: expected 'continuous' (or no secondary impulses), got {sequence.spacing!r}")
    blocks = (block.p, block.restitution, block.critical_impulse)
    shape, drop, flat = combined((sequence.main, sequence.secondary), blocks)
    main, secondary, p, restitution, critical = flat
    u1, a = main / critical, secondary / critical
    ratio = np.divide(a, u1, out=np.zeros_like(a), where=u1 > 0.0)
    growth, loss = u1 - restitution * a, 1.0 - restitution
    # Without losses and without gain every velocity is a fixed point: the motion keeps its first one.
    limit = np.divide(growth, loss, out=np.where(growth > 0.0, np.inf, u1), where=loss > 0.0)
    effective = limit - 0.5 * a
    stable = np.array([stays_bounded(*lane) for lane in zip(u1, ratio, restitution, strict=True)], dtype=bool)
    hops = np.array([hop(velocity) for velocity in np.where(stable, np.minimum(effective, 1.0), np.inf)]).reshape(-1, 2)
    peak = np.where(stable & (effective >= 1.0), 1.0, hops[:, 0])
    values = (limit, effective, peak, hops[:, 1] / p, stable)
    return SteadyState(*(squeezed(value.reshape(shape), drop) for value in values))
