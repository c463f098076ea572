"""A slow rocking solver for bodies with two corners, a wall behind them, ties, loads and thrusts, from forces alone.

A body of mass M turns about corner i (1 for theta > 0) by phi >= 0. Gravity, the ground and every restraint are forces
with arms about that corner, over the moment of inertia M g R_i/p_i^2; nothing is shared with the kernels. A tie pulls
with K times its elongation, less what it has kept, between 0 and its yield force; the friction of a load likewise
between its two bounds. What is kept changes where the body turns back or lands. Between the bends of these laws each
piece of a sample is one run of scipy's DOP853; its turning points and crossings are roots of the dense output, polished
by a run that ends there.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rocking.body.restraint import SLIP
from rocking.response import IMPACT_CUTOFF, Outcome

RTOL, ATOL = 5e-14, 1e-17
#: Longest piece, times p, and as a phase of the stiffest tie.
STEP, PHASE = 0.05, 0.1
#: Speeds over p alpha below which hops are ended where the ground cannot lift the body in the next ones.
CHATTER = 1e-6
#: Pieces of one motion; a load whose friction holds a body up makes hops without end.
MOST_PIECES = 4_000


class Answer(NamedTuple):
    peak_rotation_ratio: float
    outcome: Outcome
    overturning_time: float
    impacts: int  # those of a body without restraints after the record included
    rotation: np.ndarray
    work: float  # lost in ties, loads and impacts [J], for the balance of energy


class Element:
    """A tie (yield from 0) or the friction of a load (yield both ways), with what it has kept."""

    def __init__(self, side, height, distances, stiffness, gap, most, ultimate=math.inf, both_ways=False):
        self.side, self.height, self.distances = side, height, distances
        self.stiffness, self.gap, self.most, self.ultimate = stiffness, gap, most, ultimate
        self.both_ways, self.kept, self.broken, self.lost = both_ways, 0.0, False, 0.0

    def acts(self, side):
        return self.both_ways or (self.side == side and not self.broken)

    def out(self, phi, side):
        xi = self.distances[0 if side > 0 else 1]
        return self.height * math.sin(phi) + xi * (1.0 - math.cos(phi))

    def arm(self, phi, side):
        xi = self.distances[0 if side > 0 else 1]
        return self.height * math.cos(phi) + xi * math.sin(phi)

    def stretch(self, phi, side):
        x = self.out(phi, side)
        return x - side * self.kept if self.both_ways else x - self.gap - self.kept

    def force(self, phi, side):
        least = -self.most if self.both_ways else 0.0
        return min(max(self.stiffness * self.stretch(phi, side), least), self.most)

    def levels(self, side):
        """Displacements at which the law bends."""
        reach = self.most / self.stiffness
        if self.both_ways:
            return [side * self.kept - reach, side * self.kept + reach]
        return [self.gap + self.kept, self.gap + self.kept + reach, self.gap + self.ultimate]

    def turn(self, phi, side):
        """Keep what goes beyond the spring; and what that has cost."""
        reach, stretch = self.most / self.stiffness, self.stretch(phi, side)
        beyond = max(stretch - reach, 0.0) - (max(-stretch - reach, 0.0) if self.both_ways else 0.0)
        if beyond == 0.0 or not self.acts(side):
            return
        self.lost += abs(beyond) * self.most
        self.kept += side * beyond if self.both_ways else beyond

    def stored(self, phi, side):
        return 0.5 * self.force(phi, side) ** 2 / self.stiffness if self.acts(side) else 0.0


class Body:
    """One body with its corners and what acts on it."""

    def __init__(self, block, linear=False):
        self.g, self.linear, self.wall = block.gravity, linear, block.side
        self.corners = {
            1: (block.alpha_c, block.p, block.radius, block.restitution),
            -1: (block.alpha_2, block.p_2, block.radius_2, block.restitution_2),
        }
        base = sum(radius * math.sin(alpha) for alpha, _, radius, _ in self.corners.values())
        self.mass, self.elements, self.steady = block.mass, [], {1: [], -1: []}
        held = block.restraints
        if held is None:
            self.mass = 1.0
            return
        for tie in held.ties:
            for name, side in (("positive", 1), ("negative", -1)):
                if tie.side in (name, "both"):
                    at = (tie.distance, tie.distance)
                    law = (tie.stiffness, tie.gap, tie.yield_force, tie.ultimate)
                    self.elements.append(Element(side, tie.height, at, *law))
        for load in held.loads:
            near = 0.5 * base if load.distance is None else load.distance
            for side, xi in ((1, near), (-1, base - near)):  # (down, out, xi, height)
                self.steady[side].append((load.weight, 0.0, xi, load.height))
            if load.friction is not None:
                most = load.friction * load.weight
                law = (most / SLIP, 0.0, most)
                self.elements.append(Element(0, load.height, (near, base - near), *law, both_ways=True))
        for one in held.thrusts:
            self.steady[1].append((0.0, one.force, one.distance, one.height))
            self.steady[-1].append((0.0, -one.force, base - one.distance, one.height))

    def inertia(self, side):
        _, p, radius, _ = self.corners[side]
        return self.mass * self.g * radius / p**2

    def moment(self, phi, side, ground, lift):
        """Outward moment [N m] at accelerations over g."""
        alpha, _, radius, _ = self.corners[side]
        weight = self.mass * self.g * radius
        if self.linear:
            return weight * (phi - alpha - side * ground)
        total = -weight * (lift * math.sin(alpha - phi) + side * ground * math.cos(alpha - phi))
        for down, out, xi, z in self.steady[side]:
            total += down * (z * math.sin(phi) - xi * math.cos(phi)) + out * (z * math.cos(phi) + xi * math.sin(phi))
        for one in self.elements:
            if one.acts(side):
                total -= one.force(phi, side) * one.arm(phi, side)
        return total

    def potential(self, phi, side):
        """Of gravity, steady forces and springs [J], 0 on the ground but for the springs."""
        alpha, _, radius, _ = self.corners[side]
        energy = self.mass * self.g * radius * (math.cos(alpha - phi) - math.cos(alpha))
        for down, out, xi, z in self.steady[side]:
            energy += down * (xi * math.sin(phi) - z * (1.0 - math.cos(phi)))
            energy -= out * (z * math.sin(phi) + xi * (1.0 - math.cos(phi)))
        return energy + sum(one.stored(phi, side) for one in self.elements)

    def excess(self, side, ground, lift):
        """Outward moment at rest; none towards the wall."""
        return -math.inf if self.wall == -side else self.moment(0.0, side, ground, lift)


def reference(block, acceleration, dt, *, equation="nonlinear", vertical=None, rotation=0.0, velocity=0.0):
    """Rocking response of one body to a piecewise-linear accelerogram, slowly, and to the ground at rest after it."""
    body = Body(block, equation == "linear")
    a = np.asarray(acceleration) / block.gravity
    up = np.ones(a.size) if vertical is None else 1.0 + np.asarray(vertical) / block.gravity
    left = np.append(np.maximum.accumulate(np.abs(a)[::-1])[::-1], 0.0)
    side = int(np.sign(rotation) or np.sign(velocity))
    resting = side == 0
    phi, speed = abs(rotation), side * velocity
    peak = 0.0 if resting else phi / body.corners[side][0]
    impacts, moved, lost = 0, not resting, 0.0
    history = np.full(a.size, np.nan)
    history[0] = rotation
    tail, tops, turns, pieces = 0, 0, 0, 0
    k = 0
    while True:
        after = k >= a.size - 1
        if after and resting:
            outcome = Outcome.ROCKS if moved else Outcome.AT_REST
            return Answer(peak, outcome, math.nan, impacts, history, lost)
        ends = ((0.0, 0.0), (1.0, 1.0)) if after else ((a[k], a[k + 1]), (up[k], up[k + 1]))
        tau = 0.0
        while tau < dt:

            def ground(t):
                return tuple(one[0] + (one[1] - one[0]) * t / dt for one in ends)  # noqa: B023

            if resting:
                found = []
                for one in (1, -1):
                    now, then = body.excess(one, *ground(tau)), body.excess(one, *ground(dt))
                    if now > 0.0:
                        found.append((tau, one))
                    elif then > 0.0:
                        found.append((tau + (dt - tau) * now / (now - then), one))
                if not found:
                    break
                tau, side = min(found)
                phi = speed = 0.0
                resting, moved = False, True
            alpha, p, _, restitution = body.corners[side]
            inertia = body.inertia(side)

            def rate(t, y):
                return y[1], body.moment(y[0], side, *ground(tau + t)) / inertia  # noqa: B023

            pieces += 1
            if pieces > MOST_PIECES:
                raise RuntimeError("more hops than this reference follows")
            length = min(dt - tau, STEP / p)
            acting = [one for one in body.elements if one.acts(side)]
            stiff = sum(one.stiffness * (one.height**2 + max(one.distances) ** 2) for one in acting)
            if stiff > 0.0:
                length = min(length, PHASE / math.sqrt(stiff / inertia))
            brake = -rate(0.0, (phi, speed))[1]
            if phi == 0.0 and speed > 0.0 and brake > 0.0:
                length = min(length, 3.0 * speed / brake)
            run = solve_ivp(rate, (0.0, length), (phi, speed), "DOP853", rtol=RTOL, atol=ATOL, first_step=length,
                            dense_output=True)  # fmt: skip
            state = run.sol
            levels = [0.0, 0.5 * math.pi] if not body.linear else [0.0]
            for one in acting:
                for x in one.levels(side):
                    if math.isfinite(x) and one.out(0.0, side) < x < one.out(0.5 * math.pi, side):
                        levels.append(brentq(lambda q: one.out(q, side) - x, 0.0, 1.6, xtol=1e-16, rtol=1e-15))  # noqa: B023

            def roots(function, knots):
                values = [function(t) for t in knots]
                return [
                    brentq(function, knots[i], knots[i + 1], xtol=1e-17, rtol=1e-15, maxiter=1000)
                    for i in range(len(knots) - 1)
                    if values[i] * values[i + 1] < 0.0
                ]

            knots = run.t.tolist()
            knots = sorted(knots + [t for t in roots(lambda t: rate(t, state(t))[1], knots) if t > 1e-9 * length])  # noqa: B023
            rests = roots(lambda t: float(state(t)[1]), knots)  # noqa: B023
            events, grounded = [(t, None) for t in rests], []
            knots = sorted(knots + rests)
            for before, behind in pairwise(knots):
                low, high = float(state(before)[0]), float(state(behind)[0])
                if before == 0.0:
                    low = phi
                for level in levels:
                    near = abs(low - level) <= 1e-14 * level or (level == 0.0 and low <= 0.0)
                    if (low - level) * (high - level) < 0.0 and not near:
                        t = brentq(
                            lambda t: float(state(t)[0]) - level,  # noqa: B023
                            before,
                            behind,
                            xtol=1e-17,
                            rtol=1e-15,
                            maxiter=1000,
                        )
                        events.append((t, level))
                    elif near and level == 0.0 and high < 0.0:
                        grounded.append(behind)
            if grounded and not [event for event in events if event[0] < min(grounded)]:
                # It has not left the ground but by rounding: at rest until something lifts it.
                tau, phi, speed, resting = min(tau + min(grounded), dt), 0.0, 0.0, True
                continue
            if not events:
                phi, speed = run.y[:, -1].tolist()
                peak = max(peak, phi / alpha)
                tau = dt if length == dt - tau else tau + length
                continue
            hit, level = min(events, key=lambda event: event[0])
            phi, speed = solve_ivp(rate, (0.0, hit), (phi, speed), "DOP853", rtol=RTOL, atol=ATOL).y[:, -1].tolist()
            pull = rate(hit, (phi, speed))[1]
            if level is None:
                hit, phi, speed = hit - speed / pull, phi - 0.5 * speed**2 / pull, 0.0
            elif speed == 0.0:
                phi = level
            else:
                late = (phi - level) / speed
                hit, phi, speed = hit - late, level, speed - late * pull
            tau = min(tau + hit, dt)
            peak = max(peak, phi / alpha)
            if level is None:
                for one in acting:
                    one.turn(phi, side)
                turns += after
                if after and turns > 8:
                    return Answer(peak, Outcome.ROCKS, math.nan, impacts, history, lost)
            elif level == 0.5 * math.pi:
                return Answer(math.inf, Outcome.OVERTURNS, (k + tail) * dt + tau, impacts, history, lost)
            elif level == 0.0:
                arrival = -speed
                impacts += arrival >= IMPACT_CUTOFF * p * alpha
                lost += 0.5 * inertia * arrival**2 * (1.0 - restitution**2 * (
                    1.0 if body.wall else body.inertia(-side) / inertia))  # fmt: skip
                for one in acting:
                    if not one.both_ways or body.wall:
                        one.turn(0.0, side)
                phi, speed = 0.0, restitution * arrival
                side = side if body.wall else -side
                alpha, p, _, _ = body.corners[side]
                tops += after
                turns = 0
                if after and (tops >= 3 or speed == 0.0):
                    if not body.elements:
                        impacts += decay(body, side, speed)
                    return Answer(peak, Outcome.ROCKS, math.nan, impacts, history, lost)
                resting = speed == 0.0
                if speed < CHATTER * p * alpha:
                    push = max(body.excess(one, *ground(t)) for one in (1, -1) for t in (tau, dt))
                    least = -push / body.inertia(side)
                    share = max(body.corners[1][3], body.corners[-1][3] if not body.wall else 0.0)
                    friction = any(one.both_ways for one in body.elements)
                    if not friction and push < 0.0 and 8.0 * speed / (least * (1.0 - share)) < dt - tau:
                        resting, speed = True, 0.0
            else:
                for one in acting:
                    if not one.both_ways and speed > 0.0 and one.out(phi, side) - one.gap >= one.ultimate * (1 - 1e-12):
                        one.lost += 0.5 * one.force(phi, side) ** 2 / one.stiffness
                        one.broken = True
        k += 1
        if k > a.size - 1:
            tail += 1
            k = a.size - 1
            if tail * dt > 200.0:
                return Answer(peak, Outcome.ROCKS, math.nan, impacts, history, lost)
        elif True:
            history[k] = side * phi
        if body.linear and not resting:
            alpha, p, _, _ = body.corners[side]
            ahead = 0.0 if tail else left[k]
            if phi - alpha + speed / p > (ahead if not tail else 0.0):
                return Answer(math.inf, Outcome.OVERTURNS, (k + tail) * dt, impacts, history, lost)


def decay(body, side, speed):
    """Impacts above the cut-off of free hops, the first of which leaves the ground with a speed [rad/s]."""
    count = 0
    while True:
        alpha, p, _, restitution = body.corners[side]
        if speed < IMPACT_CUTOFF * p * alpha:
            other = body.corners[side if body.wall else -side]
            if restitution * speed < IMPACT_CUTOFF * other[1] * other[0]:
                return count
        else:
            count += 1
        speed *= restitution
        side = side if body.wall else -side
