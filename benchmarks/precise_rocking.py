"""Response of a rocking block to a record in numbers of 42 digits, written from the equations alone.

A block (p, alpha, C) stands on ground with acceleration a, linear between samples and zero after the last one. With
s = sgn theta, phi = s theta >= 0, tau = p t and G = s a/g

    linear      phi'' = phi - alpha - G
    nonlinear   phi'' = -[(1 + a_v/g) sin(alpha - phi) + G cos(alpha - phi) + kappa sin(phi) cos(phi)]

a_v is a vertical acceleration, positive upwards. kappa = K z^2/(M g R) represents elastic ties of stiffness K at a
height z above both corners, without slack at rest. A block at rest lifts if abs(a)/g exceeds alpha, or (1 + a_v/g)
tan(alpha), and to theta > 0 for a < 0. At an impact phi' becomes C phi' on the other side. A body in contact with a
wall rotates only to theta > 0, and phi' becomes C phi' on the same side. The program is written from these lines in
numbers of `BITS` bits and shares nothing with the kernels of ``models/``.

Steps are whole samples, divided if p dt > 0.08. Linear motion uses the exact exponential solution from sample to
sample. Nonlinear motion, and the inside of a sample with an event, uses a Taylor series, which ends when two of its
terms in a row are below `TERM` of the largest. Events are sign changes of the series. They are isolated between those
of its derivatives and refined by a bracketed Newton iteration to the last bits.

The numbers are those of gmpy2 if it is installed, otherwise those of mpmath (ten times slower, with equal results).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from operator import mul
from typing import Any, NamedTuple

import mpmath
import numpy as np

BITS = 140  # 42 decimal digits
TERM = 1e-38
MOST_TERMS = 60
LONGEST_STEP = 0.08  # p dt
HOP_BOUND = 100_000
IMPACT_CUTOFF = 1e-3  # impacts slower than this times p alpha are not counted (DESIGN, `impacts`)
CHATTER_HEIGHT = 1e-12  # hops are followed until they are lower than this share of the peak

try:
    import gmpy2 as numbers

    numbers.get_context().precision = BITS
    real, NUMBERS = numbers.mpfr, "gmpy2"

    def dot(one: Iterable[Real], other: Iterable[Real]) -> Real:
        """Sum of products."""
        return sum(map(mul, one, other), ZERO)

except ImportError:
    numbers = mpmath.MPContext()
    numbers.prec = BITS
    real, dot, NUMBERS = numbers.mpf, numbers.fdot, "mpmath"

Real = Any
ZERO, ONE = real(0), real(1)
HALF_PI = numbers.acos(ZERO)


class Answer(NamedTuple):
    """One motion to its end."""

    peak: Real  #: theta_max/alpha; inf when overturned, NaN when unresolved
    outcome: str  #: AT_REST, ROCKS, OVERTURNS, UNRESOLVED
    overturning_time: float  #: at abs(theta) = pi/2, nonlinear only [s]; else NaN
    impacts: int  #: faster than the cut-off; before overturning, or until the end of the free decay (-1: no end)


@dataclass
class Scene:
    """One block on one ground motion, in the units of the module docstring."""

    linear: bool
    alpha: Real
    restitution: Real
    ground: list[Real]  # a/g at the samples
    step: Real  # p dt
    vertical: list[Real] = field(default_factory=list)  # a_v/g at the samples; none without
    wall: bool = False
    kappa: Real = ZERO

    def __post_init__(self) -> None:
        self.threshold = self.alpha if self.linear else numbers.tan(self.alpha)
        self.push = ground = np.array([float(value) for value in self.ground])
        self.lift = 1.0 + np.array([float(value) for value in self.vertical or [ZERO] * len(self.ground)])
        self.rough = np.maximum(-ground, 0.0) if self.wall else np.abs(ground)  # what pushes off the ground
        self.left = np.maximum.accumulate(np.abs(ground)[::-1])[::-1]
        near = self.rough > float(self.threshold) * self.lift * (1.0 - 1e-9)
        self.strong = np.flatnonzero(near[1:] | near[:-1])  # samples in which the ground may pass the threshold
        self.cosh, self.sinh = numbers.cosh(self.step), numbers.sinh(self.step)


def value(c: Sequence[Real], t: Real) -> Real:
    """Sum of c[k] t^k."""
    total = c[-1]
    for term in reversed(c[:-1]):
        total = total * t + term
    return total


def derivative(c: Sequence[Real]) -> list[Real]:
    """Coefficients of the derivative."""
    return [k * c[k] for k in range(1, len(c))]


def bound(c: Sequence[Real], t: Real) -> float:
    """Sum of abs(c[k]) t^k over k >= 1."""
    total, power, t = 0.0, 1.0, float(t)
    for k in range(1, len(c)):
        power *= t
        total += abs(float(c[k])) * power
    return total


def sign_changes(c: Sequence[Real], end: Real) -> list[Real]:
    """Roots of sum c[k] t^k in (0, end) where it changes sign, ascending: one at most between those of c'."""
    if len(c) < 2 or abs(float(c[0])) > (1.0 + 1e-9) * bound(c, end):
        return []
    knots = [ZERO, *sign_changes(derivative(c), end), end]
    found = []
    for low, high in pairwise(knots):
        start, stop = value(c, low), value(c, high)
        if start * stop < 0:
            found.append(refined(c, low, high, start))
    return found


def refined(c: Sequence[Real], low: Real, high: Real, start: Real) -> Real:
    """The root between low and high, where the value at low is `start`: first in floats, then to the last bits."""
    rough = newton([float(term) for term in c], float(low), float(high), float(start), float(low + high) / 2, 48)
    return newton(c, low, high, start, min(max(real(rough), low), high), BITS - 4)


def newton(c: Sequence[Real], low: Real, high: Real, start: Real, t: Real, bits: int) -> Real:
    """Newton's iteration from t, halving where it leaves the bracket, until it moves by less than 2^-bits of t."""
    slope = derivative(c)
    for _ in range(4 * bits):
        if (now := value(c, t)) == 0:
            return t
        low, high = (t, high) if now * start > 0 else (low, t)
        rate = value(slope, t)
        following = t - now / rate if rate != 0 else low
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - t) <= abs(t) * 2.0**-bits:
            return following
        t = following
    return t


def series(
    scene: Scene, phi: Real, speed: Real, ground: Real, slope: Real, length: Real, lift: Real = ONE, rise: Real = ZERO
) -> list[Real]:
    """Taylor coefficients of phi on a step; ground and lift are G and 1 + a_v/g at its start, the others per tau."""
    c, h, power, small = [phi, speed], float(length), 1.0, 0
    largest = abs(float(phi)) + abs(float(speed * length))
    if not scene.linear:
        sine, cosine = [numbers.sin(scene.alpha - phi)], [numbers.cos(scene.alpha - phi)]
        d = [speed]  # d[j - 1] = j c[j]
        twice = [numbers.sin(2 * phi)], [numbers.cos(2 * phi)]
    for k in range(MOST_TERMS):
        if scene.linear:
            push = c[k]
            if k < 2:
                push = push - slope if k else push - scene.alpha - ground
        else:
            if k:
                # (sin z)' = -cos z phi', (cos z)' = sin z phi', z = alpha - phi
                sine.append(-dot(d, reversed(cosine)) / k)
                cosine.append(dot(d, reversed(sine[:-1])) / k)
            push = -(lift * sine[k] + ground * cosine[k] + (slope * cosine[k - 1] + rise * sine[k - 1] if k else ZERO))
            if scene.kappa:
                if k:
                    following = 2 * dot(d, reversed(twice[1])) / k, -2 * dot(d, reversed(twice[0])) / k
                    for one, value_ in zip(twice, following, strict=True):
                        one.append(value_)
                push -= scene.kappa * twice[0][k] / 2
        c.append(push / ((k + 1) * (k + 2)))
        if not scene.linear:
            d.append((k + 2) * c[k + 2])
        power *= h
        term = abs(float(c[-1])) * power * h
        largest = max(largest, term)
        small = small + 1 if term < TERM * largest else 0
        if small == 2:
            return c
    raise RuntimeError(f"the Taylor series does not end at p dt = {h:g}")


def lift_off(scene: Scene, k: int, passed: Real) -> tuple[Real, int] | None:
    """Time in sample k, from `passed` on, at which the resting block lifts off, and the side; None if it stays."""
    part = passed / scene.step
    found = []
    for side in (1,) if scene.wall else (1, -1):
        start, after = (
            -side * scene.ground[j] - scene.threshold * (1 + scene.vertical[j] if scene.vertical else 1)
            for j in (k, k + 1)
        )
        before = start + (after - start) * part
        if before > 0:
            found.append((passed, side))
        elif after > 0:
            found.append((passed + (scene.step - passed) * before / (before - after), side))
    return min(found, default=None)


def settles(scene: Scene, k: int, passed: Real, speed: Real, peak: Real) -> bool:
    """Whether all hops after an impact, phi' = `speed`, end before the ground can lift the block again.

    In a window let D be the least deceleration at phi = 0, m the largest slope of abs(G) and K = 1 + max abs(G), which
    bounds the change of the deceleration with phi. If w^2 K/D <= D/2 then d = D - K w^2/D >= D/2, a hop stays below
    w^2/(2 d) <= w^2/D, where the deceleration is above d, and lasts at most T = 2 w/d. The drift of the ground, at most
    m T, over a path of at most w^2/d, changes w^2 by at most 2 m T w^2/d: the next hop starts with at most q = C (1 + m
    T/d) times the speed. If q < 1 all that is left to come lasts at most T/(1 - q); if that is inside the window the
    block comes to rest in it, and the motion after that does not depend on the hops. Not followed are only hops lower
    than w^2/D < `CHATTER_HEIGHT` of the peak and impacts that are not counted.
    """
    w, step, alpha, restitution = map(float, (speed, scene.step, scene.alpha, scene.restitution))
    if restitution >= 1.0 or w >= 0.5 * IMPACT_CUTOFF * alpha:
        return False

    def least(strongest: float, lift: float) -> float:
        return alpha - strongest if scene.linear else lift * math.sin(alpha) - strongest * math.cos(alpha)

    def at(values: np.ndarray, place: float) -> float:
        return float(np.interp(place, (j := min(int(place), len(values) - 2), j + 1), values[j : j + 2]))

    start = k + float(passed / scene.step)

    def rough(place: float) -> float:  # not between the samples' own: the ground may pass through 0
        return max(-at(scene.push, place), 0.0) if scene.wall else abs(at(scene.push, place))

    now = least(rough(start), at(scene.lift, start))
    if now <= 0.0:
        return False
    window = 8.0 * w / (now * (1.0 - restitution))
    end = start + window / step
    if end > len(scene.ground) - 1:
        return False
    last = max(math.ceil(end), k + 1)
    changes = (abs(float(scene.ground[j + 1] - scene.ground[j])) for j in range(k, last))
    slope = (max(changes) + float(np.max(np.abs(np.diff(scene.lift[k : last + 1]))))) / step
    strongest = max(rough(start), rough(end), *scene.rough[k + 1 : last], 0.0)
    lightest = float(min(scene.lift[k : last + 1]))
    least_left = least(strongest, lightest) * (1.0 - 1e-6)
    if least_left <= 0.0 or w * w / least_left >= CHATTER_HEIGHT * float(peak):
        return False
    largest = max(abs(float(one)) for one in scene.ground[k : last + 1])
    d = least_left - (float(max(scene.lift[k : last + 1])) + largest) * w * w / least_left
    if d < 0.5 * least_left:
        return False
    q = restitution * (1.0 + slope * 2.0 * w / (d * d))
    return q < 1.0 and 2.0 * w / d < (1.0 - q) * window


def after(scene: Scene, phi: Real, speed: Real) -> tuple[Real, bool, int, Real]:
    """Largest phi, overturned or not, impacts and speed of the last of them on ground at rest, by energy.

    phi'^2/2 + V is kept between impacts, V = -(alpha - phi)^2/2 or cos(alpha - phi) - 1, which is 0 at the top.
    """
    alpha = scene.alpha

    def potential(phi: Real) -> Real:
        return -((alpha - phi) ** 2) / 2 if scene.linear else -2 * numbers.sin((alpha - phi) / 2) ** 2

    def top(energy: Real) -> Real:
        return alpha - (numbers.sqrt(-2 * energy) if scene.linear else 2 * numbers.asin(numbers.sqrt(-energy / 2)))

    energy = speed * speed / 2 + potential(phi)
    if (speed >= 0 or energy <= 0) if phi >= alpha else (speed > 0 and energy >= 0):
        return real("inf"), True, 0, ZERO
    largest = max(phi, top(energy)) if speed > 0 else phi
    impact = numbers.sqrt(2 * (energy - potential(ZERO)))
    energy = (scene.restitution * impact) ** 2 / 2 + potential(ZERO)
    if energy >= 0 and speed < 0:
        return real("inf"), True, 1, impact
    return (max(largest, top(energy)) if energy < 0 else largest), False, 0, impact


def respond(
    p: float,
    alpha: float,
    restitution: float,
    acceleration: np.ndarray,
    dt: float,
    equation: str,
    scale: float = 1.0,
    gravity: float = 9.80665,
    initial_rotation: float = 0.0,
    initial_velocity: float = 0.0,
    restitution_factor: Real = ONE,
    record_factor: Real = ONE,
    vertical: Sequence[float] | None = None,
    wall: bool = False,
    kappa: Real = ZERO,
) -> Answer:
    """Response of one block to a record; every argument is taken as the exact number that the float64 is.

    Parameters
    ----------
    p, alpha, restitution, dt, scale, gravity : float
        [1/s], [rad], [-], [s], factor on the record [-], [m/s2].
    acceleration : (n,) ndarray
        Ground acceleration [m/s2], n >= 1.
    equation : {"linear", "nonlinear"}
        See the module docstring.
    initial_rotation, initial_velocity : float
        theta [rad] and theta' [rad/s] at the first sample.
    restitution_factor, record_factor : real
        Factors on C and on the record, for perturbations too small for a float64.
    vertical : (n,) sequence, optional
        Vertical acceleration [m/s2]; nonlinear equation only, and so is `kappa`. With ties the record has to go on
        until the body is at rest.
    wall : bool
        Whether the body turns to theta > 0 only; C is that of the rebound.
    """
    factor = real(scale) / real(gravity) * record_factor
    ground, up = (
        [(sample if isinstance(sample, type(ONE)) else real(float(sample))) * factor for sample in samples]
        for samples in (acceleration, () if vertical is None else vertical)
    )
    step = real(p) * real(dt)
    fixed = real(restitution) * restitution_factor
    scene = Scene(equation == "linear", real(alpha), fixed, ground, step, up, wall, real(kappa))
    cutoff = IMPACT_CUTOFF * scene.alpha
    longest = step / math.ceil(float(step) / LONGEST_STEP - 1e-9)

    side = 1 if initial_rotation > 0 or (initial_rotation == 0 and initial_velocity > 0) else -1
    phi, speed = abs(real(initial_rotation)), side * real(initial_velocity) / real(p)
    resting = phi == 0 and speed == 0
    moved = not resting
    peak, impacts, hops = phi, 0, 0
    k, passed = 0, ZERO
    while k < len(ground) - 1:
        if resting:
            following = np.searchsorted(scene.strong, k)
            if following == scene.strong.size:
                break
            if scene.strong[following] > k:
                k, passed = int(scene.strong[following]), ZERO
            found = lift_off(scene, k, passed)
            if found is None or found[0] >= step:
                k, passed = k + 1, ZERO
                continue
            passed, side = found
            phi, speed, resting, moved = ZERO, ZERO, False, True
        elif scene.linear and passed == 0 and float(phi + speed - scene.alpha) > scene.left[k] * (1.0 + 1e-12):
            # The growing mode exceeds what the ground can still do: certain, and no longer a matter of precision.
            return Answer(real("inf"), "OVERTURNS", math.nan, impacts)
        lift, rise = ONE, ZERO
        if up:
            rise = (up[k + 1] - up[k]) / step
            lift = 1 + up[k] + rise * passed
        slope = side * (ground[k + 1] - ground[k]) / step
        start = side * ground[k] + slope * passed
        remaining = step - passed
        # Pieces of a divided sample are equal; a rounding rest of the last one is part of it.
        length = remaining if remaining < longest * 1.000001 else longest
        c = series(scene, phi, speed, start, slope, length, lift, rise)
        if phi == 0 and speed == 0 and abs(float(c[2])) < 1e-36:
            c[2] = ZERO  # lifted at the threshold itself, where phi'' = 0
        hop = next(j for j, term in enumerate(c) if term != 0)  # phi = t^hop times a series without the root at 0
        if c[hop] < 0:
            raise RuntimeError(f"sample {k}: the block is pressed into the ground")
        touch = next(iter(sign_changes(c[hop:], length)), None)
        end = length if touch is None else touch
        if not scene.linear and float(c[0]) + bound(c, end) > 1.57:
            fall = next(iter(sign_changes([c[0] - HALF_PI, *c[1:]], end)), None)
            if fall is not None:
                time = (k * step + passed + fall) / real(p)
                return Answer(real("inf"), "OVERTURNS", float(time), impacts)
        if float(c[0]) + bound(c, end) > float(peak):
            rate = derivative(c)
            turns = sign_changes(rate[max(hop - 1, 0) :], end)
            peak = max(peak, value(c, end), *(value(c, t) for t in turns))
        if touch is None:
            if length == step and scene.linear:
                phi, speed = whole_sample(scene, phi, speed, start, slope)
            else:
                phi, speed = value(c, length), value(derivative(c), length)
            if length == remaining:
                k, passed = k + 1, ZERO
            else:
                passed += length
            continue
        hops += 1
        if hops > HOP_BOUND:
            return Answer(real("nan"), "UNRESOLVED", math.nan, -1)
        arrival = -value(derivative(c), touch)
        impacts += arrival >= cutoff
        passed += touch
        phi, speed, side = ZERO, scene.restitution * arrival, side if wall else -side
        resting = speed == 0 or settles(scene, k, passed, speed, peak)

    if resting:
        return Answer(peak / scene.alpha, "ROCKS" if moved else "AT_REST", math.nan, impacts)
    if scene.kappa:
        raise RuntimeError("with ties the record has to go on until the body is at rest")
    largest, over, before, impact = after(scene, phi, speed)
    if over:
        wait = real("nan") if scene.linear else falling_time(scene, phi, speed)
        time = float(((len(ground) - 1) * step + wait) / real(p))
        return Answer(real("inf"), "OVERTURNS", time, impacts + before)
    return Answer(
        max(peak, largest) / scene.alpha, "ROCKS", math.nan, decay(impacts, impact / cutoff, scene.restitution)
    )


def decay(impacts: int, ratio: Real, restitution: Real) -> int:
    """Impacts in all, the next one `ratio` times as fast as the cut-off and each C times as fast as the one before."""
    if ratio < 1:
        return impacts
    if restitution >= 1:
        return -1
    return impacts + 1 + (int(numbers.floor(numbers.log(ratio) / -numbers.log(restitution))) if restitution > 0 else 0)


def whole_sample(scene: Scene, phi: Real, speed: Real, ground: Real, slope: Real) -> tuple[Real, Real]:
    """The linear motion over one sample: alpha + G is a solution, cosh and sinh take care of the rest."""
    rest, rate = phi - scene.alpha - ground, speed - slope
    forced = scene.alpha + ground + slope * scene.step
    return forced + rest * scene.cosh + rate * scene.sinh, slope + rest * scene.sinh + rate * scene.cosh


def falling_time(scene: Scene, phi: Real, speed: Real) -> Real:
    """tau from the end of the record until a block that overturns lies at pi/2."""
    total, length = ZERO, real(LONGEST_STEP)
    for _ in range(HOP_BOUND):
        c = series(scene, phi, speed, ZERO, ZERO, length)
        hop = next(j for j, term in enumerate(c) if term != 0)
        touch = next(iter(sign_changes(c[hop:], length)), None)
        end = length if touch is None else touch
        fall = next(iter(sign_changes([c[0] - HALF_PI, *c[1:]], end)), None)
        if fall is not None:
            return total + fall
        total += end
        phi, speed = value(c, end), value(derivative(c), end)
        if touch is not None:
            phi, speed = ZERO, -scene.restitution * speed
    raise RuntimeError("the block does not fall")
