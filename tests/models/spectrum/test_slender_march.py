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
MOTION = synthetic_motion(3, pga=3.0)[:900]
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


@pytest.mark.parametrize("wall", [False, True])
@pytest.mark.parametrize("ground", [RECORD, WAVES], ids=["samples", "half-waves"])
@pytest.mark.parametrize("p", [0.8, 3.0])
def test_a_march_from_impact_to_impact_ends_as_one_in_short_steps(ground, p, wall):
    times, motion = ground
    seconds = np.diff(times)
    pieces = seconds[seconds > 0.0], motion[:-1][seconds > 0.0], motion[1:][seconds > 0.0]
    rng = np.random.default_rng(5)
    log_x = math.log(p / np.max(np.abs(motion))) + rng.uniform(0.0, 2.5, 40)
    restitution = rng.uniform(0.3, 0.5, 40) if wall else rng.uniform(0.7, 0.92, 40)
    march = SlenderGround(pieces, p, wall)
    found = march_one_rate(march, log_x, restitution, rotations=True, threads=1)
    verdicts = march_one_rate(march, log_x, restitution, rotations=False, threads=1)
    # Twenty units of tau on still ground follow, in parts like those of the motion.
    seconds, first, last = (np.append(values, end) for values, end in zip(pieces, (20.0 / p, 0.0, 0.0), strict=True))
    parts = np.maximum(np.ceil(p * seconds / 0.125), 1.0).astype(int)
    begin = np.concatenate([np.arange(n) / n for n in parts])
    rise = np.repeat(last - first, parts)
    starts = np.repeat(first, parts) + begin * rise
    ends = starts + rise / np.repeat(parts, parts)
    lanes = zip(np.exp(log_x) / p, restitution, strict=True)
    expected = np.array(
        [step_by_step(np.repeat(p * seconds / parts, parts), starts, ends, *one, wall) for one in lanes]
    )
    assert np.array_equal(np.isinf(verdicts), np.isinf(found))
    assert np.array_equal(np.isinf(found), np.isinf(expected))
    assert 1 < np.sum(np.isinf(found)) < 39
    survives = np.isfinite(found)
    # Hops of u' up to 1e-3, and those that end within a piece, are left out by the march.
    assert found[survives] == pytest.approx(expected[survives], abs=5e-5)


def test_an_impact_and_a_new_fall_within_one_piece_are_found():
    """A push that lifts at the start of a piece and not at its end: u falls, hits the ground, rises and falls again."""
    rng = np.random.default_rng(8)
    ground = rng.normal(size=60) * 4.0
    lengths, p = np.full(59, 0.1), 1.2
    log_x, restitution = rng.uniform(0.0, 2.0, 60), rng.uniform(0.3, 0.6, 60)
    coarse, fine = (
        march_one_rate(
            SlenderGround(divided(lengths, ground, parts), p, True), log_x, restitution, rotations=True, threads=1
        )
        for parts in (1, 8)
    )
    assert np.array_equal(np.isinf(coarse), np.isinf(fine))
    survives = np.isfinite(fine)
    assert coarse[survives] == pytest.approx(fine[survives], abs=1e-4)


def divided(lengths, ground, parts):
    """Lengths and accelerations at both ends of the pieces of a ground motion, each in equal parts."""
    times = np.append(0.0, np.cumsum(lengths))
    fine = np.interp(np.linspace(0.0, lengths.size, parts * lengths.size + 1), np.arange(lengths.size + 1), times)
    values = np.interp(fine, times, ground)
    return np.diff(fine), values[:-1], values[1:]
