"""Computes the rotation of a block under the limit accelerogram from the table of its half-cycles.

Rotations are in units of alpha_c, velocities u = theta'/(p alpha_c); the first main impulse is positive: theta < 0.
"""

import math
from typing import NamedTuple

import numpy as np

from rocking.impulses.half_cycle import CRITICAL_TOLERANCE, state

#: phi in the times t_k = (k - phi) dT of the secondary impulses; for "open" the number of intervals is n + 1.
_PHASE = {"end": 0.0, "middle": 0.5, "start": 1.0, "open": 0.0}


class HalfCycle(NamedTuple):
    """One half-cycle of a block: initial velocity, duration, number of secondary impulses, and their interval."""

    start_velocity: float  # u_i [-]
    duration: float  # [s], inf where the block overturns
    impulse_count: int  # n_i [-]
    interval: float  # dT_i [s]


def secondary_impulses(cycle: HalfCycle, secondary: float, spacing: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and velocity changes [-] of the secondary impulses within a half-cycle."""
    if secondary == 0.0:
        return np.zeros(0), np.zeros(0)
    if spacing == "continuous":  # the limit of infinitely many is half an impulse at the start and half at the end
        return np.array([0.0, cycle.duration]), np.array([-0.5, 0.5]) * secondary
    order = np.arange(1, cycle.impulse_count + 1)
    return (order - _PHASE[spacing]) * cycle.interval, np.where(order % 2, -secondary, secondary)


def motion_samples(cycles: list[HalfCycle], p: float, secondary: float, spacing: str, times: np.ndarray) -> np.ndarray:
    """Return the signed rotation theta/alpha_c [-] at increasing times after the first main impulse [s].

    `p` is in 1/s and `secondary` is a = u_1 I_s/I [-]. A half-cycle that overturns is the last one; only its main
    impulse acts until alpha_c, and the rotation is NaN afterwards. At exactly the critical velocity a block never
    reaches alpha_c.
    """
    # Pieces of free motion: time of the start [s], x and x' there [-], and side.
    pieces: list[tuple[float, float, float, float]] = []
    start, side = 0.0, -1.0
    for cycle in cycles:
        pieces.append((start, 0.0, cycle.start_velocity, side))
        if not math.isfinite(cycle.duration):
            break
        offsets, changes = secondary_impulses(cycle, secondary, spacing)
        for offset, change in zip(offsets.tolist(), changes.tolist(), strict=True):
            begun, *last, _ = pieces[-1]
            rotation, velocity = state(*last, p * (start + offset - begun))
            pieces.append((start + offset, rotation, velocity + change, side))
        start, side = start + cycle.duration, -side
    table = np.array(pieces)
    of = np.searchsorted(table[:, 0], times, side="right") - 1
    begin, rotation, velocity, sides = table[of].T
    elapsed = p * (times - begin)
    growing = rotation - 1.0 + velocity
    growing = np.where(np.abs(growing) <= CRITICAL_TOLERANCE, 0.0, growing)
    decaying = rotation - 1.0 - velocity
    x = 1.0 + 0.5 * (growing * np.exp(np.minimum(elapsed, 700.0)) + decaying * np.exp(-elapsed))
    overturned = (of == len(pieces) - 1) & (not math.isfinite(cycles[-1].duration)) & (x > 1.0)
    return np.where(overturned, np.nan, sides * x)
