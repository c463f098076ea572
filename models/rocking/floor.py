"""The motion of a floor or of the top of a building from that of the ground: modes in parallel.

.. note:: Each mode is an oscillator y'' + 2 zeta omega y' + omega^2 y = -a_g, and the floor moves with a_f = a_g + sum
   of Gamma phi y''. The ground acceleration is linear between samples, for which the recurrence of an oscillator is
   exact (first-order hold).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.signal import cont2discrete, lfilter

from rocking.arguments import numbers, positive, record_samples, together
from rocking.quantities import ArrayLike

__all__ = ["FloorMotion", "floor_motion"]

#: Samples of the floor's motion in the shortest period.
SAMPLES = 40

#: Most of the time for which the floor is followed after the ground has come to rest, in periods of each mode.
MOST_PERIODS = 1000.0


class FloorMotion(NamedTuple):
    """The motion of a floor.

    Attributes
    ----------
    acceleration : (n,) ndarray
        Horizontal acceleration of the floor [m/s2], linear between samples.
    dt : float
        Sampling interval [s]: that of the ground divided by a whole number.
    amplification : float
        Peak of the floor over that of the ground [-].
    """

    acceleration: np.ndarray
    dt: float
    amplification: float


def floor_motion(
    acceleration: ArrayLike,
    dt: float,
    period: ArrayLike,
    damping: ArrayLike = 0.05,
    participation: ArrayLike = 1.0,
    quiet: float = 1e-3,
) -> FloorMotion:
    """The motion of a floor under a ground motion.

    Parameters
    ----------
    acceleration : (n,) array_like
        Horizontal ground acceleration a_g [m/s2], linear between samples and zero after them; before the first one it
        rises from zero within one interval of the answer.
    dt : float
        Sampling interval [s].
    period, damping, participation : float or (k,) array_like
        Period [s], share of critical damping [-], above 0 and below 1, and Gamma phi at the level of the floor [-] of
        each mode. An oscillator of one mode that is the whole building has 1; a mode's Gamma phi may be negative.
    quiet : float
        Acceleration [m/s2] below which the oscillations after the record are left out; a thousandth of g tan(alpha) of
        a body loses nothing that could move it.

    Returns
    -------
    FloorMotion
        From the first sample of the ground on, at a fortieth of the shortest period or less.

    Raises
    ------
    ValueError
        For periods that are not positive, a damping outside (0, 1), several lengths, and what
        :func:`~rocking.recorded_response` refuses of a record.

    References
    ----------
    Chopra, A. K. (2012), Dynamics of Structures, 4th ed., sections 5.2 and 13.1.

    Examples
    --------
    A building of 0.4 s shakes its top harder than the ground does:

    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 4.005, 0.01) / 0.4)
    >>> top = floor_motion(sine, 0.01, period=0.4)
    >>> round(top.amplification, 1), top.dt
    (9.6, 0.01)
    """
    ground = record_samples("acceleration", acceleration)
    step = float(positive("dt", dt, "s", lanes=False))
    periods, dampings, shares = (
        np.atleast_1d(values)
        for values in together(
            period=positive("period", period, "s"),
            damping=numbers("damping", damping, "a share of critical damping"),
            participation=numbers("participation", participation, "Gamma phi of each mode"),
        )
    )
    if not np.all((dampings > 0.0) & (dampings < 1.0)):
        raise ValueError(f"damping: expected shares of critical damping above 0 and below 1, got {damping!r}")
    quiet = float(positive("quiet", quiet, "m/s2", lanes=False))
    parts = math.ceil(step * SAMPLES / float(np.min(periods)) * (1.0 - 1e-9))
    fine = step / parts
    times = step * np.arange(ground.size)
    rates = 2.0 * np.pi / periods
    # Each mode is bounded by omega^2 times its largest displacement, which a_g/omega^2 dt bounds with room to spare.
    strongest = np.abs(shares) * (1.0 + rates * times[-1]) * np.max(np.abs(ground))
    decay = np.log(np.maximum(periods.size * strongest / quiet, 1.0)) / (dampings * rates)
    after = float(np.max(np.minimum(decay, MOST_PERIODS * periods)))
    count = (ground.size - 1) * parts + 1
    whole = np.zeros(count + math.ceil(after / fine))
    whole[:count] = np.interp(fine * np.arange(count), times, ground)
    floor = whole.copy()
    for rate, ratio, share in zip(rates, dampings, shares, strict=True):
        system = [-1.0, 0.0, 0.0], [1.0, 2.0 * ratio * rate, rate * rate]
        above, below, _ = cont2discrete(system, fine, method="foh")
        floor += share * lfilter(np.ravel(above), below, whole)
    loud = np.flatnonzero(np.abs(floor) > quiet)
    floor = floor[: max(count, (loud[-1] if loud.size else 0) + 2)]
    peak = np.max(np.abs(ground))
    return FloorMotion(floor, fine, float(np.max(np.abs(floor)) / peak) if peak > 0.0 else 1.0)
