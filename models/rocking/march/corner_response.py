"""Response of asymmetric, one-sided or restrained bodies to an accelerogram, computed by their kernel."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rocking.arguments import ArrayLike, numbers, read_only
from rocking.body.block import Block
from rocking.body.restraint import (
    COLUMNS,
    FAR,
    FRICTION,
    GAP,
    HEIGHT,
    KIND,
    NEAR,
    SIDE,
    STIFFNESS,
    ULTIMATE,
    YIELD_FORCE,
    Restraints,
)
from rocking.lanes import split_lanes
from rocking.march.corner_kernel import CornerLanes, corner_slots, march_corners
from rocking.march.event import LINEAR
from rocking.march.kernel import Options
from rocking.march.restrained import RestraintState
from rocking.march.slots import Accelerogram
from rocking.response import Outcome, Response, empty_results, response_of


def run_kernel(kernel: Callable[..., None], shape: tuple[int, int], samples: int, threads: int | None) -> Response:
    """Run a kernel for q scale factors and m bodies (`shape`); return the response, with history if `samples` > 0."""
    total = shape[0] * shape[1]
    found = empty_results(total, codes=np.int8), np.empty(total, np.int64), np.zeros((total, samples, 2))
    split_lanes(lambda first, last: kernel(first, last, *found), total, threads)
    results, active, motion = found
    return response_of(results, shape, motion if samples else None, active_samples=active)


def march_bodies(
    block: Block,
    ground: Accelerogram,
    factors: np.ndarray,
    gains: np.ndarray,
    start: tuple[np.ndarray, np.ndarray],
    options: Options,
    samples: int,
    threads: int | None,
) -> Response:
    """Compute the response of m bodies, all restrained or all unrestrained, from the state `start` (theta, theta')."""
    side = np.asarray(block.side, dtype=float)
    rotation, spin = start
    into = (side * rotation < 0.0) | ((rotation == 0.0) & (side * spin < 0.0))
    if np.any(into):
        raise ValueError(
            "initial_rotation, initial_velocity: a one-sided body has a wall behind it; expected a rotation away from "
            f"it, got {rotation[into][0]:g} rad and {spin[into][0]:g} rad/s"
        )
    restraints = None
    if block.restraints is not None:
        if options.equation == LINEAR:
            raise ValueError("equation: expected 'nonlinear' for a body with ties, loads or thrusts, got 'linear'")
        restraints = _restraint_state(block, factors.size)
    alpha, p, restitution = (
        read_only(np.array([getattr(block, name), getattr(block, other)], dtype=float))
        for name, other in (("alpha_c", "alpha_2"), ("p", "p_2"), ("restitution", "restitution_2"))
    )
    lanes = CornerLanes(factors, gains, alpha, p, restitution, read_only(side), rotation, spin)

    def march(first: int, last: int, *found: Any) -> None:
        work = None if restraints is None else corner_slots()
        march_corners(first, last, ground, lanes, options, corner_slots(), *found, restraints, work)

    response = run_kernel(march, (factors.size, side.size), samples, threads)
    if restraints is None:
        return response
    turned = np.where(
        response.outcome == Outcome.UNRESOLVED, np.nan, restraints.peak.T.reshape(2, factors.size, side.size)
    )
    return response.changed(corner_rotation=turned)


def _restraint_state(block: Block, copies: int) -> RestraintState:
    """Return the restraints of m bodies for the kernel, with arrays of their states under `copies` scale factors."""
    base = block.radius * np.sin(block.alpha_c) + block.radius_2 * np.sin(block.alpha_2)
    every: list[Restraints] = [own or Restraints() for own in np.ravel(np.array(block.restraints, dtype=object))]
    tables = [own.elements(width) for own, width in zip(every, np.ravel(base).tolist(), strict=True)]
    most = max(table.shape[0] for table in tables)
    elements = np.zeros((len(every), max(most, 1), COLUMNS))
    for place, table in enumerate(tables):
        elements[place, : table.shape[0]] = table
    mass = np.where(np.isnan(block.mass), 1.0, block.mass)  # a body without restraints
    weight = mass * block.gravity * np.array([block.radius, block.radius_2])
    distance = np.stack(
        [elements[:, :, NEAR], np.where(elements[:, :, KIND] == FRICTION, elements[:, :, FAR], elements[:, :, NEAR])],
        axis=2,
    )
    height = elements[:, :, HEIGHT, np.newaxis]
    angle = np.array([block.alpha_c, block.alpha_2]).T
    return RestraintState(
        elements=elements,
        constant=np.stack([own.constant(width) for own, width in zip(every, base.tolist(), strict=True)]),
        points=np.stack([distance, np.hypot(height, distance), np.arctan2(distance, height)], axis=3),
        weight=np.ascontiguousarray(weight.T),
        angle=np.ascontiguousarray(np.stack([np.sin(angle), np.cos(angle)], axis=2)),
        peak=np.zeros((copies * len(every), 2)),
        mode=np.zeros((copies * len(every), elements.shape[1]), dtype=np.int64),
        set=np.zeros((copies * len(every), elements.shape[1])),
    )


def uplift_additions(block: Block) -> np.ndarray:
    """Return the increase of the uplift threshold abs(a_g)/g of both corners due to loads and thrusts, (2, m)."""
    found = np.zeros((2, *np.shape(block.p)))
    if block.restraints is not None:
        restraints = _restraint_state(block, 1)
        found[:] = restraints.constant[:, :, 0].T / (restraints.weight.T * restraints.angle[:, :, 1].T)
    return found


def static_capacity(block: Block, rotation: ArrayLike, side: int = 1) -> np.ndarray:
    """Return the static capacity curve of a body: the horizontal acceleration in equilibrium at an increasing rotation.

    Parameters
    ----------
    block : Block
        One body.
    rotation, side : float or (k,) array_like, int
        abs(theta) [rad], from 0 to below pi/2; 1 for theta > 0, -1 for theta < 0.

    Returns
    -------
    (k,) ndarray
        Acceleration of the ground that drives the rotation [m/s2]: g tan(alpha - theta) for a body without restraints.

    Examples
    --------
    >>> from rocking import Tie
    >>> bar = Tie(height=8.0, stiffness=6.3e6, yield_force=74e3)
    >>> facade = Block(width=0.8, height=9.0, density=1800.0, length=1.0, one_sided=True, ties=[bar])
    >>> (static_capacity(facade, [0.0, 0.01, 0.04]) / facade.gravity).round(2).tolist()
    [0.09, 1.11, 1.08]
    """
    angles = np.atleast_1d(numbers("rotation", rotation, "an angle in rad"))
    if np.any((angles < 0.0) | (angles >= 0.5 * np.pi)) or side not in (1, -1):
        raise ValueError(f"rotation, side: expected angles from 0 to pi/2 and 1 or -1, got {rotation!r} and {side!r}")
    place, moment = (0, np.zeros(angles.shape)) if side == 1 else (1, np.zeros(angles.shape))
    if block.restraints is not None:
        restraints = _restraint_state(block.lanes(1), 1)
        factors = restraints.constant[0, place]
        moment = factors[0] * np.cos(angles) + factors[1] * np.sin(angles)
        for one in restraints.elements[0]:
            friction = one[KIND] == FRICTION
            if one[HEIGHT] == 0.0 or not (friction or one[SIDE] == side):
                continue
            xi = one[FAR] if friction and place == 1 else one[NEAR]
            out = one[HEIGHT] * np.sin(angles) + xi * (1.0 - np.cos(angles)) - one[GAP]
            force = np.clip(one[STIFFNESS] * out, 0.0, one[YIELD_FORCE]) * (out < one[ULTIMATE])
            moment = moment + force * (one[HEIGHT] * np.cos(angles) + xi * np.sin(angles))
        moment = moment / restraints.weight[0, place]
    alpha = block.alpha_c if side == 1 else block.alpha_2
    return np.asarray(block.gravity * (np.sin(alpha - angles) + moment) / np.cos(alpha - angles))
