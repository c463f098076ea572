"""A conventional solver, used to compare errors and run times: scipy's ``solve_ivp``, restarted after each impact.

It is tuned for speed: while the block is at rest, the solver skips to the next sample that lifts the block; a run ends
when the block overturns; the first step of a very short free motion is as long as the motion; and the peak after the
end of the record is computed from the energy. ``max_step`` is dt, as longer steps would miss changes of slope in the
record.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

__all__ = ["Baseline", "baseline_response"]
MOST_HOPS = 100_000


class Baseline(NamedTuple):
    """The result of the conventional solver."""

    peak_rotation_ratio: float  #: theta_max/alpha [-], inf when overturned
    outcome: str  #: AT_REST, ROCKS, OVERTURNS or UNRESOLVED
    active_samples: int  #: number of samples in which the block moves


def baseline_response(
    p: float,
    alpha: float,
    restitution: float,
    acceleration: np.ndarray,
    dt: float,
    equation: str = "nonlinear",
    scale: float = 1.0,
    gravity: float = 9.80665,
    method: str = "RK45",
    rtol: float = 1e-6,
    atol: float | None = None,
    rest_speed: float = 1e-4,
) -> Baseline:
    """Compute the rocking response of one block to a record (n,) [m/s2] with ``solve_ivp``.

    `p` is the frequency parameter [1/s], `alpha` the critical angle [rad], `restitution` the velocity ratio C [-]. The
    tolerance atol [rad, rad/s] is rtol x alpha/1000 by default. The block comes to rest after an impact slower than
    `rest_speed` times p alpha while the ground acceleration is below the threshold of uplift. The motion that is then
    neglected reaches rotations of 1e-8 alpha, less than the error of RK45 at rtol 1e-6.
    """
    linear = equation == "linear"
    threshold = alpha if linear else math.tan(alpha)
    array = np.asarray(acceleration, dtype=float) * (scale / gravity)
    strong = np.flatnonzero(np.abs(array) > threshold)
    left = np.maximum.accumulate(np.abs(array)[::-1])[::-1] / alpha
    record = [*array.tolist(), 0.0]
    end = (array.size - 1) * dt
    moving = np.zeros(array.size - 1, dtype=bool)
    atol = 1e-3 * rtol * alpha if atol is None else atol
    square = p * p

    def ground(t: float) -> float:
        place = t / dt
        k = int(place)
        return record[k] + (record[k + 1] - record[k]) * (place - k)

    def rate(t: float, y: np.ndarray, side: int, reach: float) -> tuple[float, float]:
        theta, speed = y.tolist()
        if linear:
            return speed, square * (theta - side * alpha - ground(t))
        angle = side * alpha - theta
        return speed, -square * (math.sin(angle) + ground(t) * math.cos(angle))

    def impact(t: float, y: np.ndarray, side: int, reach: float) -> float:
        return side * y[0]

    def turn(t: float, y: np.ndarray, side: int, reach: float) -> float:
        return side * y[1]

    def overturned(t: float, y: np.ndarray, side: int, reach: float) -> float:
        if linear:
            return side * (y[0] + y[1] / p) / alpha - 1.0 - reach
        return side * y[0] - 0.5 * math.pi

    events: tuple[Any, ...] = (impact, turn, overturned)
    for event, terminal, direction in zip(events, (True, False, True), (-1, -1, 1), strict=True):
        event.terminal, event.direction = terminal, direction
    integrate: Any = solve_ivp

    t, theta, speed, side, peak, after = 0.0, 0.0, 0.0, 0, 0.0, -1
    for _ in range(MOST_HOPS):
        if side == 0:
            # Search after the last event; by rounding, the motion could restart at the same instant again and again.
            k = int(np.searchsorted(strong, max(math.ceil(t / dt - 1e-9), after + 1)))
            if k == strong.size:
                return Baseline(peak, "ROCKS" if moving.any() else "AT_REST", int(moving.sum()))
            after = int(strong[k])
            side = -1 if record[after] > 0.0 else 1
            if after:
                before = -side * record[after - 1]
                share = (threshold - before) / (abs(record[after]) - before)
                t = max(t, (after - 1 + share) * dt)
            theta, speed = 0.0, 0.0
        if t >= end:
            break
        braking = square * (threshold + side * ground(t)) * math.cos(alpha)
        first = min(dt, abs(speed) / braking, end - t) if theta == 0.0 and speed != 0.0 and braking > 0.0 else None
        solution = integrate(
            rate,
            (t, end),
            (theta, speed),
            method,
            events=events,
            args=(side, left[min(int(t / dt), array.size - 1)]),
            rtol=rtol,
            atol=atol,
            max_step=dt,
            first_step=first,
        )
        moving[int(t / dt) : math.ceil(solution.t[-1] / dt)] = True
        t = float(solution.t[-1])
        theta, speed = solution.y[:, -1].tolist()
        if solution.t_events[2].size:
            return Baseline(math.inf, "OVERTURNS", int(moving.sum()))
        tops = solution.y_events[1][:, 0] if solution.y_events[1].size else ()
        peak = max(peak, abs(theta) / alpha, *(abs(top) / alpha for top in tops))
        if not solution.t_events[0].size:
            break
        theta, speed, side = 0.0, restitution * speed, -side
        if abs(speed) < rest_speed * p * alpha and abs(ground(t)) < threshold:
            side = 0
    else:
        return Baseline(math.nan, "UNRESOLVED", int(moving.sum()))
    last, over = afterwards(side * theta / alpha, side * speed / (p * alpha), alpha, restitution, linear)
    return Baseline(max(peak, last), "OVERTURNS" if over else "ROCKS", int(moving.sum()))


def afterwards(x: float, u: float, alpha: float, restitution: float, linear: bool) -> tuple[float, bool]:
    """Return the peak of theta/alpha in the free motion after the record, and whether the block overturns.

    At the end of the record theta/alpha is `x` > 0, and its time derivative divided by p is `u`.
    """

    def potential(x: float) -> float:
        return -0.5 * (1.0 - x) ** 2 if linear else (math.cos(alpha * (1.0 - x)) - 1.0) / alpha**2

    def top(energy: float) -> float:
        return 1.0 - (math.sqrt(-2.0 * energy) if linear else math.acos(1.0 + energy * alpha**2) / alpha)

    energy = 0.5 * u * u + potential(x)
    if (u >= 0.0 or energy <= 0.0) if x >= 1.0 else (u > 0.0 and energy >= 0.0):
        return math.inf, True
    peak = top(energy) if u > 0.0 else x
    energy = restitution**2 * (energy - potential(0.0)) + potential(0.0)
    if energy >= 0.0 and u < 0.0:
        return math.inf, True
    return (max(peak, top(energy)) if energy < 0.0 else peak), False
