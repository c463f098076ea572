"""The march from impact to impact, against one that looks for an impact in 24 parts of every piece of the ground."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from rocking.spectrum.half_waves import triangles
from rocking.spectrum.slender_ground import SlenderGround
from rocking.spectrum.slender_lanes import march_one_rate
from synthetic import synthetic_motion

PARTS, SLOWEST = 24, 1e-3
MOTION = np.append(synthetic_motion(3, pga=3.0)[:899], 0.0)
RECORD = 0.01 * np.arange(MOTION.size), MOTION
WAVES = triangles(
    *np.array([[0.0, 0.4, 0.7, 1.5], [0.15, 0.5, 1.0, 1.6], [0.4, 0.7, 1.3, 2.0], [0.7, -0.5, 0.9, -1.0]])
)


def moved(tau, u, v, bend, twist):
    return u + v * tau + bend * (np.cosh(tau) - 1.0) + twist * (np.sinh(tau) - tau)


def step_by_step(lengths, starts, ends, strength, restitution, wall):
    """Largest u of a block, inf if it overturns, under accelerations (k,) that are linear over (k,) lengths in tau."""
    u, v, side, peak = 0.0, 0.0, 0.0, 0.0
    for length, start, end in zip(lengths, starts, ends, strict=True):
        done, rate = 0.0, (end - start) / length
        while done < length - 1e-13:
            push, slope, left = strength * (start + rate * done), strength * rate, length - done
            if side == 0.0:
                up = -1.0 if wall else math.copysign(1.0, push)
                if up * push <= 1.0:  # at rest until f abs(a_g) = 1
                    up = -1.0 if wall else math.copysign(1.0, slope)
                    wait = (1.0 - up * push) / (up * slope) if up * slope > 0.0 else np.inf
                    if wait >= left:
                        break
                    done += wait
                    push, left = strength * (start + rate * done), length - done
                side, u, v = -up, 0.0, 0.0
            bend, twist = u - 1.0 - side * push, v - side * slope
            taus = left * np.arange(PARTS + 1) / PARTS
            heights = moved(taus, u, v, bend, twist)
            peak = max(peak, float(np.max(heights)))
            below = np.flatnonzero(heights[1:] < -1e-15)
            tau = left
            if below.size:
                low = taus[below[0]]
                low = max(low, 1e-4 * taus[1])  # not the start of a hop
                motion = u, v, bend, twist
                tau = brentq(moved, low, taus[below[0] + 1], motion, 1e-16, 1e-14) if moved(low, *motion) > 0.0 else low
            fast = v + bend * math.sinh(tau) + twist * (math.cosh(tau) - 1.0)
            u, v, done = max(moved(tau, u, v, bend, twist), 0.0), fast, done + tau
            if u > 3.0:
                return np.inf
            if below.size:
                u, v = 0.0, restitution * abs(fast)
                side = side if wall else -side
                if v <= SLOWEST:
                    side = 0.0
    return np.inf if u - 1.0 + v > 0.0 else peak


def pieces_of(times, ground, parts=1):
    """Lengths [s], and accelerations at both ends, of the pieces of a ground motion in equal parts."""
    at = np.arange(parts * (times.size - 1) + 1) / parts
    fine, values = (np.interp(at, np.arange(times.size), column) for column in (times, ground))
    long = np.diff(fine) > 1e-12
    return np.diff(fine)[long], values[:-1][long], values[1:][long]


@pytest.mark.parametrize("wall", [False, True])
@pytest.mark.parametrize(("ground", "parts"), [(RECORD, 1), (WAVES, 8)], ids=["samples", "half-waves"])
@pytest.mark.parametrize("p", [0.8, 3.0])
def test_a_march_from_impact_to_impact_ends_as_one_in_short_steps(ground, parts, p, wall):
    rng = np.random.default_rng(5)
    log_x = math.log(p / np.max(np.abs(ground[1]))) + rng.uniform(0.0, 2.5, 40)
    restitution = rng.uniform(0.3, 0.5, 40) if wall else rng.uniform(0.7, 0.92, 40)
    march = SlenderGround(pieces_of(*ground), p, wall)
    found, verdicts = (march_one_rate(march, log_x, restitution, rotations=on, threads=1) for on in (True, False))
    still = ground[0][-1] + np.arange(1, 161) / (8.0 * p)  # twenty units of tau
    seconds, *ends = pieces_of(np.append(ground[0], still), np.append(ground[1], np.zeros(still.size)), parts)
    lanes = zip(np.exp(log_x) / p, restitution, strict=True)
    expected = np.array([step_by_step(p * seconds, *ends, *one, wall) for one in lanes])
    assert np.array_equal(np.isinf(verdicts), np.isinf(found))
    assert np.array_equal(np.isinf(found), np.isinf(expected))
    assert 1 < np.sum(np.isinf(found)) < 39
    # Hops of u' up to 1e-3, and those that end within a piece, are left out by the march.
    assert np.minimum(found, 9.0) == pytest.approx(np.minimum(expected, 9.0), abs=5e-5)


@pytest.mark.parametrize(("seed", "wall"), [(11, True), (19, False)])
def test_an_impact_and_a_new_fall_or_a_peak_within_one_piece_are_found(seed, wall):
    """Random pushes over long pieces: u falls, hits the ground and falls again, or u' is positive at both ends only."""
    rng = np.random.default_rng(seed)
    motion = 0.1 * np.arange(12), 4.0 * rng.normal(size=12)
    lanes = rng.uniform(0.0, 3.0, 400), rng.uniform(0.3, 0.6, 400) if wall else rng.uniform(0.7, 0.95, 400)
    ways = [SlenderGround(pieces_of(*motion, parts), 1.2, wall) for parts in (1, 8)]
    coarse, fine = (march_one_rate(way, *lanes, rotations=True, threads=1) for way in ways)
    assert np.minimum(coarse, 9.0) == pytest.approx(np.minimum(fine, 9.0), abs=1e-6)
