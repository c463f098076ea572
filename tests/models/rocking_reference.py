"""A slow rocking solver, written from the equations alone, by which the kernels of ``recorded_response`` are judged.

A block with critical angle alpha and frequency parameter p stands on ground with acceleration a (a_v up), linear
between samples. While it turns about one corner, s = sgn theta, x = s theta/alpha >= 0 and u = s theta'/(p alpha)
obey

    linear      x' = p u,   u' = p (x - 1 - s a/(g alpha))
    nonlinear   x' = p u,   u' = -(p/alpha) [(1 + a_v/g) sin(alpha (1 - x)) + s (a/g) cos(alpha (1 - x))]

Each piece of a sample is one run of scipy's DOP853 at its tightest useful tolerance; no closed form is used while the
ground moves. Events are roots of the dense output, found in the order u' = 0, u = 0, x = 0: between the roots of one
the next is monotone, so that a touch-down hidden between two outputs is not missed. Pieces are at most `STEP`/p long,
and an impact is polished by a run that ends there. Halving `STEP` moves an answer about a hundredth as far as a 1e-13
change of C does.

After the last sample the ground is at rest: peak, outcome and impacts follow from energy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.signal import butter, sosfilt

from rocking.body.block import Block
from rocking.response import IMPACT_CUTOFF, Outcome

RTOL, ATOL = 5e-14, 1e-17
#: Longest piece of one integration, times p.
STEP = 0.05
#: Hops slower than this (u after the impact), and lower than its square, may be ended by `settles`.
CHATTER = 1e-6
#: Hops one motion may have; more is a fault of the solver.
HOP_BOUND = 200_000


class Answer(NamedTuple):
    """What the reference answers; rotation and velocity at the samples, NaN after overturning."""

    peak_rotation_ratio: float
    outcome: Outcome
    overturning_time: float
    impacts: int
    rotation: np.ndarray
    velocity: np.ndarray


class Scene(NamedTuple):
    """One block, one ground motion; accelerations over g [-]."""

    p: float
    alpha: float
    restitution: float
    horizontal: Sequence[float]
    vertical: Sequence[float]
    dt: float
    linear: bool

    def ground(self, k: int, tau: float) -> tuple[float, float]:
        """a/g and a_v/g at time `tau` after sample `k`."""
        part = tau / self.dt
        return (
            self.horizontal[k] * (1.0 - part) + self.horizontal[k + 1] * part,
            self.vertical[k] * (1.0 - part) + self.vertical[k + 1] * part,
        )

    def threshold(self, vertical: float) -> float:
        """|a|/g above which the block at rest uplifts."""
        return self.alpha if self.linear else (1.0 + vertical) * math.tan(self.alpha)

    def excess(self, ground: tuple[float, float], side: int) -> float:
        """How far the ground is above the threshold of uplift to `side` (theta > 0 for a < 0)."""
        return -side * ground[0] - self.threshold(ground[1])

    def equation(self, k: int, tau: float, side: int) -> Callable[[float, Sequence[float]], tuple[float, float]]:
        """The right-hand side in the time t since `tau` after sample `k`."""
        h0, v0 = self.ground(k, tau)
        dh = (self.horizontal[k + 1] - self.horizontal[k]) / self.dt
        dv = (self.vertical[k + 1] - self.vertical[k]) / self.dt
        p, alpha = self.p, self.alpha
        if self.linear:
            return lambda t, y: (p * y[1], p * (y[0] - 1.0 - side * (h0 + dh * t) / alpha))

        def nonlinear(t: float, y: Sequence[float]) -> tuple[float, float]:
            angle = alpha * (1.0 - y[0])
            push = (1.0 + v0 + dv * t) * math.sin(angle) + side * (h0 + dh * t) * math.cos(angle)
            return p * y[1], -p / alpha * push

        return nonlinear

    @property
    def fallen(self) -> float:
        """The x at which the block lies on its side; none in the linear equation."""
        return math.inf if self.linear else 0.5 * math.pi / self.alpha


def uplift(scene: Scene, k: int, tau: float) -> tuple[float, int] | None:
    """Time in sample `k`, not before `tau`, at which the resting block uplifts, and the side; None if it does not."""
    start, end = scene.ground(k, tau), scene.ground(k, scene.dt)
    found = []
    for side in (1, -1):
        before, after = scene.excess(start, side), scene.excess(end, side)
        if before > 0.0:
            found.append((tau, side))
        elif after > 0.0:
            found.append((tau + (scene.dt - tau) * before / (before - after), side))
    return min(found, default=None)


def sign_changes(function: Callable[[float], float], knots: list[float]) -> list[float]:
    """Roots of a function that is monotone between the knots."""
    values = [function(t) for t in knots]
    return [
        brentq(function, knots[i], knots[i + 1], xtol=1e-30, rtol=1e-15)
        for i in range(len(knots) - 1)
        if values[i] * values[i + 1] < 0.0
    ]


def integrate(rate: Callable, start: Sequence[float], length: float) -> Any:
    """One run of DOP853 from time 0, in a single step where the tolerance allows it."""
    solution = solve_ivp(
        rate, (0.0, length), start, "DOP853", rtol=RTOL, atol=ATOL, first_step=length, dense_output=True
    )
    if not solution.success:
        raise RuntimeError(solution.message)
    return solution


def polished(rate: Callable, start: Sequence[float], hit: float) -> tuple[float, float]:
    """Time and speed of an impact from a step that ends there: the interpolant is only of seventh order."""
    x, u = integrate(rate, start, hit).y[:, -1].tolist()
    velocity, acceleration = rate(hit, (x, u))
    late = x / velocity
    return hit - late, -(u - late * acceleration)


def settles(scene: Scene, k: int, tau: float, u: float) -> bool:
    """Whether the chatter after an impact, speed `u`, certainly ends before the ground can lift the block again.

    Over a window let D be the least deceleration at x = 0 on either side, D - K x a bound of it up to the height x,
    m the largest drift of the driving terms, for x'' with time in s; w = p u. From energy a hop stays below w^2/D,
    so that it lasts T <= 2 w/d, d = D - K w^2/D. The drift, at most m T, changes w^2 by at most 2 m T times the
    path 2 w^2/D: the next hop starts with at most q = C (1 + 2 m T/D) times the speed. If q < 1 all hops together
    last at most T/(1 - q); if that is inside the window, the block comes to rest there, whatever the details, and
    the next lift-off is from exact rest. Only the heights of these hops, below `CHATTER`^2 alpha, are lost.
    """
    p, alpha = scene.p, scene.alpha
    if scene.restitution >= 1.0:
        return False
    now = scene.ground(k, tau)
    brake = -p * p / alpha * max(scene.excess(now, 1), scene.excess(now, -1))
    if brake <= 0.0:
        return False
    window = 8.0 * p * u / (brake * (1.0 - scene.restitution))
    last = tau + window
    knots = [now]
    j = k
    while last > scene.dt:
        j, last = j + 1, last - scene.dt
        if j >= len(scene.horizontal) - 1:
            return False
        knots.append(scene.ground(j, 0.0))
    knots.append(scene.ground(j, last))
    slope = max(
        max(abs(values[i + 1] - values[i]) for i in range(k, j + 1)) / scene.dt
        for values in (scene.horizontal, scene.vertical)
    )
    m = p * p * 2.0 * slope / alpha
    least = p * p / alpha * min(-scene.excess(ground, side) for ground in knots for side in (1, -1))
    least *= 1.0 if scene.linear else math.cos(alpha)
    stiffness = p * p * (1.0 if scene.linear else max(1.0 + v + abs(h) for h, v in knots))
    if least <= 0.0:
        return False
    decel = least - stiffness * (p * u) ** 2 / least
    if decel <= 0.0 or (p * u) ** 2 / least > CHATTER**2:
        return False
    hop = 2.0 * p * u / decel
    shrink = scene.restitution * (1.0 + 2.0 * m * hop / least)
    return shrink < 1.0 and hop / (1.0 - shrink) < window


def afterwards(scene: Scene, x: float, u: float) -> tuple[float, Outcome, int]:
    """Peak, outcome and counted impacts on ground at rest, from x > 0 or u > 0, by energy u^2/2 + V(x).

    Linear: V = -(1 - x)^2/2, where x - 1 + u >= 0 is the motion that leaves over the top, V(1).
    Nonlinear: V = (cos(alpha (1 - x)) - 1)/alpha^2.
    """
    alpha = scene.alpha

    def depth(x: float) -> float:
        """V(1) - V(x), without cancellation near the top."""
        return 0.5 * (1.0 - x) ** 2 if scene.linear else 2.0 * (math.sin(0.5 * alpha * (1.0 - x)) / alpha) ** 2

    def peak(energy: float) -> float:
        """The height x < 1 at which a motion `energy` below the top turns."""
        if scene.linear:
            return 1.0 - math.sqrt(2.0 * energy)
        return 1.0 - 2.0 * math.asin(alpha * math.sqrt(0.5 * energy)) / alpha

    below = depth(x) - 0.5 * u * u  # energy missing to reach the top
    beyond = x >= 1.0
    if (u >= 0.0 and (beyond or below <= 0.0)) or (beyond and below > 0.0):
        return math.inf, Outcome.OVERTURNS, 0
    top = max(x, peak(below)) if u >= 0.0 else x
    speed = math.sqrt(2.0 * max(depth(0.0) - below, 0.0))
    for impacts in range(HOP_BOUND):
        if speed < IMPACT_CUTOFF:
            return top, Outcome.ROCKS, impacts
        speed *= scene.restitution
        below = depth(0.0) - 0.5 * speed * speed
        if below <= 0.0:
            return math.inf, Outcome.OVERTURNS, impacts + 1
        top = max(top, peak(below))
    raise RuntimeError("the free decay does not end: restitution too close to one for this reference")


def reference(
    block: Block,
    acceleration: np.ndarray,
    dt: float,
    *,
    equation: str = "nonlinear",
    vertical: np.ndarray | None = None,
    initial_rotation: float = 0.0,
    initial_velocity: float = 0.0,
) -> Answer:
    """Rocking response to a piecewise-linear accelerogram, slowly.

    Parameters
    ----------
    block : Block
        A single one, with a restitution below one.
    acceleration, vertical : (n,) ndarray
        Ground acceleration [m/s2], theta > 0 for a negative one; vertical positive up.
    dt : float
        Sampling interval [s].
    equation : {"nonlinear", "linear"}
        The linear one takes no vertical acceleration.
    initial_rotation, initial_velocity : float
        theta [rad] and theta' [rad/s] at the first sample.

    Returns
    -------
    Answer
    """
    p, alpha, restitution, gravity = block.p, block.alpha_c, block.restitution, block.gravity
    n = len(acceleration)
    up = np.zeros(n) if vertical is None else np.asarray(vertical, dtype=float)
    horizontal = (np.asarray(acceleration, dtype=float) / gravity).tolist()
    scene = Scene(p, alpha, restitution, horizontal, (up / gravity).tolist(), dt, equation == "linear")
    left = np.maximum.accumulate(np.abs(horizontal)[::-1])[::-1] / alpha  # max |a|/(g alpha) of what is left
    rotation, velocity = np.full(n, np.nan), np.full(n, np.nan)

    side = int(np.sign(initial_rotation) or np.sign(initial_velocity))
    resting = side == 0
    x, u = abs(initial_rotation) / alpha, side * initial_velocity / (p * alpha)
    top, impacts, hops, moved = x, 0, 0, not resting

    for k in range(n - 1):
        rotation[k], velocity[k] = side * alpha * x, side * p * alpha * u
        if scene.linear and not resting and x - 1.0 + u > left[k]:
            return Answer(math.inf, Outcome.OVERTURNS, k * dt, impacts, rotation, velocity)
        tau = 0.0
        while tau < dt:
            if resting:
                start = uplift(scene, k, tau)
                if start is None:
                    break
                (tau, side), x, u, resting, moved = start, 0.0, 0.0, False, True
                if tau >= dt:
                    break

            rate = scene.equation(k, tau, side)
            whole = dt - tau
            length = min(whole, STEP / p)
            braking = -rate(0.0, (x, u))[1]
            if x == 0.0 and u > 0.0 and braking > 0.0:
                length = min(length, 3.0 * u / braking)  # where a hop is but a part of the sample, the hop alone
            solution = integrate(rate, (x, u), length)
            state = solution.sol
            knots = solution.t.tolist()

            def position(t: float) -> float:
                return float(state(t)[0])  # noqa: B023 (used before the next piece begins)

            def speed(t: float) -> float:
                return float(state(t)[1])  # noqa: B023

            # Uplift starts from u' = 0 to rounding: a root next to the start is none.
            turns = [t for t in sign_changes(lambda t: rate(t, state(t))[1], knots) if t > 1e-9 * length]  # noqa: B023
            knots = sorted(knots + turns)
            extremes = sign_changes(speed, knots)
            knots = sorted(knots + extremes)

            hit = fallen = None
            grounded = False
            for before, after in pairwise(knots):
                end = position(after)
                top = max(top, end) if end < scene.fallen else top
                if end >= scene.fallen:
                    fallen = brentq(lambda t: position(t) - scene.fallen, before, after, xtol=1e-30, rtol=1e-15)
                    break
                if end < 0.0:
                    # Where it does not fall from a height, the lift-off was a matter of rounding: still at rest.
                    hit = brentq(position, before, after, xtol=1e-30, rtol=1e-15) if position(before) > 0.0 else after
                    grounded = position(before) <= 0.0
                    break
            if fallen is not None:
                time = k * dt + tau + fallen
                return Answer(math.inf, Outcome.OVERTURNS, time, impacts, rotation, velocity)
            if hit is None:
                x, u = solution.y[:, -1].tolist()
                tau = dt if length == whole else tau + length
                continue

            hops += 1
            if hops > HOP_BOUND:
                raise RuntimeError(f"sample {k}: the impacts do not end")
            impact_speed = 0.0
            if not grounded:
                hit, impact_speed = polished(rate, (x, u), hit)
            impacts += impact_speed >= IMPACT_CUTOFF
            x, u, side = 0.0, restitution * impact_speed, -side
            tau = min(tau + hit, dt)
            resting = u == 0.0 or (u < CHATTER and settles(scene, k, tau, u))
            if resting:
                u = 0.0

    rotation[-1], velocity[-1] = side * alpha * x, side * p * alpha * u
    if resting:
        return Answer(top, Outcome.ROCKS if moved else Outcome.AT_REST, math.nan, impacts, rotation, velocity)
    last, outcome, more = afterwards(scene, x, u)
    return Answer(max(top, last), outcome, math.nan, impacts + more, rotation, velocity)


def block_of(radius: float, slenderness: float, restitution: float | str = "housner", gravity: float = 9.81) -> Block:
    """A rectangle by its half-diagonal [m] and slenderness."""
    alpha = math.atan(1.0 / slenderness)
    return Block(radius * math.sin(alpha), radius * math.cos(alpha), restitution, gravity)


def shaking(seed: int, count: int, dt: float, low: float = 0.3, high: float = 8.0) -> np.ndarray:
    """(n,) Noise filtered from `low` to `high` [Hz] under a half-sine envelope, peak 1; always the same for a seed."""
    noise = np.random.default_rng(seed).standard_normal(count)
    band = butter(2, [low, min(high, 0.4 / dt)], "bandpass", fs=1.0 / dt, output="sos")
    motion = sosfilt(band, noise) * np.sin(np.pi * np.arange(count) / (count - 1))
    return motion / np.max(np.abs(motion))
