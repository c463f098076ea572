"""A body and its pedestal as one rigid body, and the motion of a floor as the sum of its modes."""

import math
from typing import NamedTuple

import numpy as np

from rocking.arguments import ArrayLike, common_shape, numbers, positive, record_samples
from rocking.body.block import Block
from rocking.pictures import short_repr


def with_pedestal(block: Block, width: float, height: float, mass: float, restitution: ArrayLike = "housner") -> Block:
    """Combine a block and the homogeneous rectangular pedestal under its centre into one rigid body.

    Parameters
    ----------
    block : Block
        One body with a mass, without a wall or restraints.
    width, height, mass : float
        Full size of the pedestal in the plane of rocking [m], and its mass [kg].
    restitution : float, list of float or "housner"
        Velocity ratio of an impact of the combined body.

    Returns
    -------
    Block
        A body that turns about the corners of the pedestal. Check the block alone too: it may rock on the pedestal.

    Raises
    ------
    ValueError
        For a block without a mass, with a wall or restraints, or wider at its base than the pedestal; for sizes or a
        mass that are not positive; or if the centre of mass of the combined body is outside its base.

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
        raise ValueError("block: expected a free-standing block on the pedestal, got a block with a wall or restraints")
    if math.isnan(own):
        raise ValueError("block: expected a block with a mass, like the pedestal; give mass, or density and length")
    right, left = float(one.radius * np.sin(one.alpha_c)), float(one.radius_2 * np.sin(one.alpha_2))
    if right + left > width:
        raise ValueError(
            f"pedestal width: expected at least the width of the block on it, {right + left:g} m, got {width:g} m"
        )
    whole = own + mass
    x, z = 0.5 * (left - right), height + float(one.radius * np.cos(one.alpha_c))
    centre_x, centre_z = own * x / whole, (own * z + 0.5 * mass * height) / whole
    # About the centre of mass of the block: p^2 (I + M R^2) = M g R.
    inertia = own * float(one.gravity * one.radius / one.p**2 - one.radius**2)
    inertia += own * ((x - centre_x) ** 2 + (z - centre_z) ** 2)
    inertia += mass * ((width**2 + height**2) / 12.0 + centre_x**2 + (0.5 * height - centre_z) ** 2)
    near, far = 0.5 * width - centre_x, 0.5 * width + centre_x
    body = near, far, centre_z, math.sqrt(inertia / whole), restitution, float(block.gravity)
    return Block.from_corners(*body, mass=whole, log=False)


#: Number of samples of the floor motion in the shortest period.
SAMPLES = 40
#: Upper bound of the duration computed after the end of the ground motion, in periods of each mode.
MOST_PERIODS = 1000.0


class FloorMotion(NamedTuple):
    """The motion of a floor.

    Attributes
    ----------
    acceleration, dt : (n,) ndarray, float
        Horizontal acceleration of the floor [m/s2], linear between samples, and its sampling interval [s], which is the
        interval of the ground motion divided by a whole number.
    amplification : float
        Peak acceleration of the floor divided by that of the ground [-].

    Examples
    --------
    >>> round(rocking.floor_motion(record.acceleration, record.dt, period=0.4).amplification, 2)
    1.21
    """

    acceleration: np.ndarray
    dt: float
    amplification: float

    def __repr__(self) -> str:
        return short_repr(self)


def floor_motion(
    acceleration: ArrayLike,
    dt: float,
    period: ArrayLike,
    damping: ArrayLike = 0.05,
    participation: ArrayLike = 1.0,
    quiet: float = 1e-3,
) -> FloorMotion:
    """Compute the motion of a floor under a ground motion as the sum of its modes.

    Each mode is y'' + 2 zeta omega y' + omega^2 y = -a_g, and a_f = a_g + sum of Gamma phi y'' (Chopra 2012, sections
    5.2 and 13.1), computed with the recurrence that is exact for a ground motion linear between samples.

    Parameters
    ----------
    acceleration : (n,) array_like
        Horizontal ground acceleration a_g [m/s2], linear between samples and zero after them.
    dt : float
        Sampling interval [s].
    period, damping, participation : float or (k,) array_like
        For each mode: period [s], damping ratio [-] in (0, 1), and participation factor Gamma times mode shape phi at
        the floor [-], which may be negative; 1 for a building with a single mode.
    quiet : float
        Acceleration [m/s2] below which the oscillations after the record are cut off; at a thousandth of g tan(alpha)
        of a body, no motion that could lift the body is cut off.

    Returns
    -------
    FloorMotion
        The motion from the first sample of the ground motion on, sampled at a fortieth of the shortest period or less.

    Raises
    ------
    ValueError
        For periods that are not positive, a damping outside (0, 1), arguments of different lengths, and a record that
        :func:`~rocking.recorded_response` rejects.

    Examples
    --------
    >>> sine = np.sin(2.0 * np.pi * np.arange(0.0, 4.005, 0.01) / 0.4)
    >>> top = floor_motion(sine, 0.01, period=0.4)
    >>> round(top.amplification, 1), top.dt
    (9.6, 0.01)
    """
    from scipy.signal import cont2discrete, lfilter  # imported late, as its import is slow

    ground = record_samples("acceleration", acceleration)
    step = float(positive("dt", dt, "s", lanes=False))
    given = {"period": positive("period", period, "s")}
    given["damping"] = numbers("damping", damping, "a share of critical damping")
    given["participation"] = numbers("participation", participation, "Gamma phi of each mode")
    periods, dampings, shares = (np.atleast_1d(values) for values in common_shape(**given))
    if not np.all((dampings > 0.0) & (dampings < 1.0)):
        raise ValueError(f"damping: expected shares of critical damping above 0 and below 1, got {damping!r}")
    quiet = float(positive("quiet", quiet, "m/s2", lanes=False))
    parts = math.ceil(step * SAMPLES / float(np.min(periods)) * (1.0 - 1e-9))
    fine = step / parts
    times = step * np.arange(ground.size)
    rates = 2.0 * np.pi / periods
    # A mode's acceleration is at most omega^2 times its largest displacement, which is at most max a_g t/omega.
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
