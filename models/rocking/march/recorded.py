"""Linear or nonlinear response of blocks to a record times scale factors, and the friction that the motion requires.

.. note:: Rotations theta > 0 are about the right-hand corner. The centre of mass is at x = -s R sin(alpha -
   abs(theta)), z = R cos(alpha - abs(theta)) from the corner of rotation; the required friction coefficient is
   abs(a_g + x'')/(g + a_v + z'').
"""

from typing import Any, Literal, NamedTuple

import numpy as np

from rocking.arguments import ArrayLike, Floats, numbers, positive, read_only, record_samples
from rocking.body.block import Block
from rocking.march.corner_response import march_bodies, run_kernel
from rocking.march.demand import Demand
from rocking.march.event import LINEAR, NONLINEAR
from rocking.march.kernel import MarchLanes, Options, march_lanes
from rocking.march.slots import Accelerogram, empty_slots, extremes
from rocking.pictures import short_repr
from rocking.response import Response

#: Largest acceleration divided by gravity that is accepted in a record [-].
STRONGEST = 1e7
EQUATIONS = {"linear": LINEAR, "nonlinear": NONLINEAR}
#: Largest last term of the Taylor series of a step, divided by alpha_c [-]; a step that exceeds it is halved.
LAST_TERM = 1e-14
#: Smallest value accepted for that limit [-]: below it rounding errors govern.
SMALLEST_LAST_TERM = 1e-17
#: Longest sample, as p dt [-], and fastest start, as theta'/p [rad], that are accepted.
LONGEST_SAMPLE, FASTEST_START = 1e4, 1e3
#: Longest step allowed, as p dt [-].
LONGEST_STEP = 0.3


def recorded_response(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    equation: Literal["nonlinear", "linear"] = "nonlinear",
    scale: ArrayLike = 1.0,
    vertical: ArrayLike | None = None,
    initial_rotation: ArrayLike = 0.0,
    initial_velocity: ArrayLike = 0.0,
    history: bool = False,
    gain: Literal["linear", "tangent"] = "linear",
    block_scale: ArrayLike = 1.0,
    verdict: Demand | None = None,
    step: float = 0.08,
    last_term: float = LAST_TERM,
    threads: int | None = None,
) -> Response:
    """Compute the rocking response of a block to a recorded ground acceleration.

    Parameters
    ----------
    block : Block
        One block, or an array of m blocks.
    acceleration, dt : (n,) array_like, float
        Horizontal ground acceleration a_g [m/s2], n >= 2, linear between samples, zero after the last one; its sampling
        interval [s].
    equation : {"nonlinear", "linear"}
        The full equation, or its limit for slender blocks and small rotations (Eq. 1).
    scale : float or (q,) array_like
        Scale factor on the record, horizontal and vertical, not negative [-].
    vertical : (n,) array_like, optional
        Vertical ground acceleration a_v [m/s2], positive up, on the same samples; nonlinear equation only.
    initial_rotation, initial_velocity : float or (m,) array_like
        theta [rad], positive about the right-hand corner, and theta' [rad/s] at the first sample.
    history : bool
        If True, also return time, rotation and velocity at the samples.
    gain : {"linear", "tangent"}
        Linear equation only. "linear": uplift at g alpha_c (Eq. 1). "tangent": the record is multiplied by
        alpha_c/tan(alpha_c), so that uplift is at g tan(alpha_c) as in the nonlinear equation (docs/decisions/006).
    block_scale : float or (m,) array_like
        Additional scale factor on the record for each block, times `scale`, not negative [-].
    verdict : Demand, optional
        Demand of the same ground on the same blocks (:func:`rocking.ground_demand`), if only the outcome of blocks that
        start at rest is needed. The computation of a block then ends as soon as its outcome is certain, from a bound if
        it overturns and from a measured margin if it rocks (docs/decisions/006). The peak is then the largest rotation
        up to this time, the number of impacts is -1, and the overturning time is the time at which the block passes the
        angle of no return. Only for the nonlinear equation without vertical acceleration and without history.
    step : float
        Longest step as p dt [-], at most 0.3; a sample with a larger p dt is divided.
    last_term : float
        Largest last term of the Taylor series of a step of the nonlinear equation, divided by alpha_c [-]: a step with
        a larger last term is halved; inf switches this control off.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.

    Returns
    -------
    Response
        Arrays (q, m), without the axis of a scalar argument; histories (q, m, n), NaN after overturning.

    Raises
    ------
    ValueError
        For NaN or infinite samples, fewer than two, dt <= 0, a negative scale, an unknown equation, a vertical record
        of another length or with the linear equation, a step out of range.

    Notes
    -----
    theta'' = -p^2 [(1 + a_v/g) sin(s alpha - theta) + (a_g/g) cos(s alpha - theta)], s = sgn theta, or linear
    theta'' = p^2 (theta - s alpha - a_g/g). The block lifts off strictly above (g + a_v) tan(alpha), or g alpha,
    towards theta > 0 if a_g is negative. At an impact theta' becomes C theta'. The nonlinear equation overturns at
    abs(theta) = pi/2; the linear one when its growing mode y = s theta/alpha - 1 + s theta'/(p alpha) exceeds the
    largest abs(a_g)/(g alpha) of the rest of the record. After the record the motion is computed in closed form.

    References
    ----------
    Housner, G. W. (1963), Bull. Seismol. Soc. Am. 53(2), 403-417.
    Yim, C.-S., Chopra, A. K., Penzien, J. (1980), Earthq. Eng. Struct. Dyn. 8(6), 565-587, doi:10.1002/eqe.4290080606.

    Examples
    --------
    >>> from rockpulse import models
    >>> block = models.Block(half_width=0.5, half_height=1.9365)
    >>> sine = 3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> response = models.recorded_response(block, sine, 0.01)
    >>> models.Outcome(response.outcome).name
    'ROCKS'
    """
    record = record_samples("acceleration", acceleration)
    if not isinstance(equation, str) or equation not in EQUATIONS:
        raise ValueError(f"equation: expected one of {sorted(EQUATIONS)}, got {equation!r}")
    if not isinstance(block, Block):
        raise ValueError(f"block: expected a rocking.Block, got {block!r}")
    dt = float(positive("dt", dt, "s", lanes=False))
    if gain not in ("linear", "tangent") or (gain == "tangent" and equation != "linear"):
        raise ValueError(f"gain: expected 'linear', or 'tangent' with equation='linear', got {gain!r}")
    if vertical is not None and equation == "linear":
        raise ValueError(
            "vertical: the linear equation has no vertical acceleration; use equation='nonlinear' or omit vertical"
        )
    up = read_only(np.empty(0)) if vertical is None else record_samples("vertical", vertical)
    if vertical is not None and up.size != record.size:
        raise ValueError(f"vertical: expected {record.size} samples as in acceleration, got {up.size}")
    if verdict is not None and not isinstance(verdict, Demand):
        raise ValueError(f"verdict: expected a rocking.Demand, got {verdict!r:.80}")
    if verdict is not None and (equation != "nonlinear" or vertical is not None or history):
        raise ValueError("verdict: can only be used with equation='nonlinear', without vertical and without history")
    if verdict is not None and (np.any(initial_rotation) or np.any(initial_velocity)):
        raise ValueError("verdict: expected a block at rest, got an initial rotation or velocity")
    step = float(numbers("step", step, "a positive step p dt", lanes=False))
    if not 0.0 < step <= LONGEST_STEP:
        raise ValueError(f"step: expected a positive step p dt of at most {LONGEST_STEP}, got {step!r}")
    if not (isinstance(last_term, int | float | np.floating) and last_term >= SMALLEST_LAST_TERM):
        raise ValueError(
            f"last_term: expected a share of alpha_c of at least {SMALLEST_LAST_TERM:g}, or inf, got {last_term!r}"
        )
    factors = numbers("scale", scale, "a scale factor >= 0", within=(0.0, np.inf))
    own = numbers("block_scale", block_scale, "a scale factor >= 0", within=(0.0, np.inf))
    if own.shape not in ((), block.shape):
        raise ValueError(
            f"block_scale: expected a scale factor >= 0, or an array {block.shape} of them, got {block_scale!r:.80}"
        )
    strongest = (
        max(np.max(record), -np.min(record), np.max(up, initial=0.0), -np.min(up, initial=0.0))
        * np.max(factors, initial=0.0)
        * max(np.max(own, initial=0.0), 1.0)
        / block.gravity
    )
    if not strongest <= STRONGEST:
        raise ValueError(
            f"acceleration, scale: expected at most {STRONGEST:g} times gravity, got {strongest:g} times; "
            "is the record in m/s2, and is scale a multiplier?"
        )
    start = [
        numbers("initial_rotation", initial_rotation, "an angle in rad"),
        numbers("initial_velocity", initial_velocity, "an angular velocity in rad/s"),
    ]
    try:
        lanes = np.broadcast_shapes(block.shape, *(values.shape for values in start))
    except ValueError:
        raise ValueError(
            f"initial_rotation, initial_velocity: expected one value, or one for each of the blocks {block.shape}, "
            f"got shapes {start[0].shape} and {start[1].shape}"
        ) from None
    alpha, p, restitution, rotation, spin = (
        read_only(np.ascontiguousarray(np.broadcast_to(np.asarray(values, dtype=float), lanes).reshape(-1)))
        for values in (block.alpha_c, block.p, block.restitution, *start)
    )
    if np.max(p, initial=0.0) * dt > LONGEST_SAMPLE:
        raise ValueError(f"dt: expected p dt of at most {LONGEST_SAMPLE:g}, got {np.max(p) * dt:g}; is dt in s?")
    if np.any(np.abs(spin) > FASTEST_START * p):
        raise ValueError(
            f"initial_velocity: expected at most {FASTEST_START:g} p, got {np.max(np.abs(spin) / p):g} p; "
            "is it in rad/s?"
        )
    if verdict is not None and (verdict.samples, verdict.levels.shape[0]) != (record.size, alpha.size):
        raise ValueError(
            f"verdict: expected the ground demand of this record ({record.size} samples) on these {alpha.size} blocks, "
            f"got that of {verdict.samples} samples on {verdict.levels.shape[0]} blocks"
        )
    free = np.broadcast_to(block.free, lanes).reshape(-1)
    if verdict is not None and not np.all(free):
        raise ValueError("verdict: expected free-standing symmetric blocks, got others; leave verdict out")
    if gain == "tangent" and not np.all(block.symmetric):
        raise ValueError("gain: expected 'linear' for bodies with two different corners, got 'tangent'")
    gains = np.broadcast_to(own, lanes).reshape(-1) * (alpha / np.tan(alpha) if gain == "tangent" else 1.0)
    levels, above = np.empty((alpha.size, 0)), np.empty((alpha.size, 0), dtype=np.int64)
    if verdict is not None:
        levels, above = verdict.levels * float(block.gravity), verdict.last
    ground = Accelerogram(record, up, extremes(record, up), dt)
    rows = factors.reshape(-1) / float(block.gravity)
    settled = 0.0 if verdict is None else float(verdict.settled)
    options = Options(EQUATIONS[equation], step, float(last_term), settled)
    samples = record.size if history else 0

    def march_free(some: Any) -> Response:
        angle, rate, ratio, theta, speed = (
            read_only(values[some]) for values in (alpha, p, restitution, rotation, spin)
        )
        blocks = MarchLanes(rows, gains[some], angle, rate, ratio, theta, speed, levels, above)

        def march(first: int, last: int, *found: Any) -> None:
            march_lanes(first, last, ground, blocks, options, empty_slots(), *found)

        return run_kernel(march, (rows.size, angle.size), samples, threads)

    def march_others(some: Any) -> Response:
        start = read_only(rotation[some]), read_only(spin[some])
        chosen = block if block.shape == (alpha.size,) else block.lanes(alpha.size)
        chosen = chosen if isinstance(some, slice) else chosen.take(some)
        return march_bodies(chosen, ground, rows, gains[some], start, options, samples, threads)

    restrained = np.broadcast_to(block.restrained, lanes).reshape(-1)
    kinds = ((free, march_free), (~free & ~restrained, march_others), (restrained, march_others))
    alike = [march for kind, march in kinds if np.all(kind)]
    if alike:
        response = alike[0](slice(None))
    else:
        parts = [(np.flatnonzero(kind), march) for kind, march in kinds if np.any(kind)]
        found = [march(own) for own, march in parts]
        if np.any(restrained):
            found = [
                one.changed(corner_rotation=np.full((2, *np.shape(one.outcome)), np.nan))
                if one.corner_rotation is None
                else one
                for one in found
            ]
        response = Response.join(found, [own for own, _ in parts], alpha.size)
    time = dt * np.arange(samples) if history else None
    return response.changed(time=time).squeezed((factors.ndim == 0, lanes == ()))


class SlidingDemand(NamedTuple):
    """The friction required by the motion of (m,) bodies without sliding, at the samples until overturning.

    Attributes
    ----------
    required, share : (m,) ndarray
        Largest required coefficient of friction [-], inf if the normal force vanishes; share of the samples at which
        the required coefficient is above the given one [-], NaN if none is given.
    loses_contact : (m,) ndarray of bool
        True if the normal force vanishes.

    Examples
    --------
    >>> demand = rocking.sliding_demand(pier, record.acceleration, record.dt, friction=0.2)
    >>> demand.required.round(2), demand.share.round(2)
    (array([0.28]), array([0.11]))
    """

    required: np.ndarray
    share: np.ndarray
    loses_contact: np.ndarray

    def __repr__(self) -> str:
        return short_repr(self)


def sliding_demand(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    friction: ArrayLike = np.nan,
    vertical: ArrayLike | None = None,
    scale: float = 1.0,
) -> SlidingDemand:
    """Compute the friction required by a rocking motion without sliding, from the nonlinear equation.

    Parameters
    ----------
    block : Block
        One body, with results of shape (1,), or an array of m bodies.
    acceleration, dt, vertical, scale
        As for :func:`~rocking.recorded_response`, with a single scale factor.
    friction : float or (m,) array_like
        Coefficient at the base [-]; NaN if it is not known.

    Returns
    -------
    SlidingDemand
        NaN and False for bodies beside a wall or with ties, loads or thrusts, whose forces on the base are unknown.
        Impacts require more friction, see :func:`impact_friction`.

    Examples
    --------
    >>> block = Block(half_width=0.3, half_height=1.2)
    >>> sine = 3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01))
    >>> sliding_demand(block, sine, 0.01, friction=0.2).required.round(2).tolist()
    [0.26]
    """
    bodies = block.lanes()
    ground = float(scale) * record_samples("acceleration", acceleration)
    up = np.zeros(ground.size) if vertical is None else float(scale) * record_samples("vertical", vertical)
    response = recorded_response(bodies, ground, dt, vertical=None if vertical is None else up, history=True)
    assert response.rotation is not None
    assert response.velocity is not None
    theta, speed = np.atleast_2d(response.rotation), np.atleast_2d(response.velocity)
    given = np.broadcast_to(np.asarray(friction, dtype=float), bodies.shape)
    if np.any(given <= 0.0):
        raise ValueError(f"friction: expected coefficients above 0, got {friction!r}")
    left = theta < 0.0
    side = np.where(left, -1.0, 1.0)

    def by_side(first: Any, second: Any) -> np.ndarray:
        return np.where(left, np.asarray(second)[:, np.newaxis], np.asarray(first)[:, np.newaxis])

    angle = by_side(bodies.alpha_c, bodies.alpha_2) - np.abs(theta)
    rate, radius = by_side(bodies.p, bodies.p_2), by_side(bodies.radius, bodies.radius_2)
    gravity = bodies.gravity
    turning = -(rate**2) * ((1.0 + up / gravity) * np.sin(angle) + side * ground / gravity * np.cos(angle))
    turning = np.where((theta == 0.0) & (speed == 0.0), 0.0, turning)
    across = ground + side * radius * (np.sin(angle) * speed**2 + np.cos(angle) * turning)
    normal = gravity + up + radius * (np.sin(angle) * turning - np.cos(angle) * speed**2)
    moving = np.isfinite(theta)
    lost = moving & (normal <= 0.0)
    asked = np.where(lost, np.inf, np.abs(across) / np.where(normal > 0.0, normal, 1.0))
    known = np.asarray((np.asarray(bodies.side) == 0) & ~np.asarray(bodies.restrained))
    above = np.sum(moving & (asked > given[:, np.newaxis]), axis=1) / np.sum(moving, axis=1)
    return SlidingDemand(
        required=np.where(known, np.max(np.where(moving, asked, 0.0), axis=1), np.nan),
        share=np.where(known & ~np.isnan(given), above, np.nan),
        loses_contact=known & np.any(lost, axis=1),
    )


def impact_friction(block: Block, restitution: ArrayLike | None = None) -> Floats:
    """Return the horizontal divided by the vertical impulse of an impact that ends a rotation about the right corner.

    h (1 - C)/(b_1 + C b_2), with the centre of mass h above the corners, is the smallest friction coefficient
    without sliding. This is for information only, as an impact lasts an instant. `restitution` replaces C of the body.

    Examples
    --------
    >>> pier = Block(half_width=1.0, half_height=8.0)
    >>> [round(float(impact_friction(pier, share * pier.restitution)), 2) for share in (1.0, 0.9)]
    [0.09, 0.51]
    """
    share = block.restitution if restitution is None else numbers("restitution", restitution, "C from 0 to 1")
    height = block.radius * np.cos(block.alpha_c)
    first, second = block.radius * np.sin(block.alpha_c), block.radius_2 * np.sin(block.alpha_2)
    return height * (1.0 - share) / (first + share * second)
