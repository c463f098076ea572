"""Ties, loads and thrusts: energy, limits, and what they leave behind."""

import math

import numpy as np
import pytest
from recorded_cases import synthetic

from rocking import Outcome, Thrust, Tie, recorded_response
from rocking.body.block import Block

SIZES = {"width": 0.8, "height": 9.0, "mass": 12960.0}
STILL = np.zeros(4001)
DT = 1e-3


def energy(block, response, rest=0.0):
    """Kinetic energy, that of the weight and of an elastic tie, over the samples with theta > 0 [J]."""
    theta, speed = response.rotation, response.velocity
    inertia = block.mass * block.gravity * block.radius / block.p**2
    found = 0.5 * inertia * speed**2
    found += block.mass * block.gravity * block.radius * (np.cos(block.alpha_c - theta) - math.cos(block.alpha_c))
    for tie in block.restraints.ties:
        out = tie.height * np.sin(theta) + tie.distance * (1.0 - np.cos(theta))
        found += 0.5 * tie.stiffness * np.maximum(out - tie.gap - rest, 0.0) ** 2
    for one in block.restraints.thrusts:
        found -= one.force * (one.height * np.sin(theta) + one.distance * (1.0 - np.cos(theta)))
    return found


@pytest.mark.parametrize(
    "tie",
    [Tie(8.0, 6.3e6), Tie(8.0, 2e5, gap=0.02), Tie(6.0, 1e6, gap=0.005, distance=0.8), Tie(8.0, 5e7, distance=0.8)],
)
def test_an_elastic_tie_keeps_the_energy(tie):
    block = Block(**SIZES, ties=[tie], thrusts=[Thrust(800.0, 5.0)])
    start = 0.7 * 2.0 * block.p * math.sin(0.5 * block.alpha_c)
    response = recorded_response(block, STILL, DT, initial_velocity=start, history=True)
    first = slice(0, int(np.argmax(response.rotation < 0.0)) - 1)
    kept = energy(block, response)[first]
    assert kept.size > 30
    assert kept == pytest.approx(np.full(kept.size, kept[0]), rel=1e-9)


def test_a_tie_that_yields_takes_its_work():
    tie = Tie(8.0, 6.3e6, yield_force=7.4e4)
    block = Block(**SIZES, ties=[tie], one_sided=True)
    start = 0.9 * 2.0 * block.p * math.sin(0.5 * block.alpha_c)
    response = recorded_response(block, STILL, DT, initial_velocity=start, history=True)
    top = int(np.argmax(response.rotation))
    out = 8.0 * math.sin(float(response.peak_rotation_ratio) * block.alpha_c)
    lengthened = out - tie.yield_force / tie.stiffness
    assert lengthened > 0.0
    # On the way back the tie is without force at what it has lengthened by, and the body as fast as the rest allows.
    before, after = energy(block, response)[0], energy(block, response, rest=lengthened)[top + 2 : top + 40]
    assert after == pytest.approx(np.full(after.size, before - tie.yield_force * lengthened), rel=1e-9)


def test_a_broken_tie_is_gone():
    tie = Tie(8.0, 6.3e6, ultimate=0.001)
    block = Block(**SIZES, ties=[tie], one_sided=True)
    start = 0.9 * 2.0 * block.p * math.sin(0.5 * block.alpha_c)
    response = recorded_response(block, STILL, DT, initial_velocity=start, history=True)
    inertia = block.mass * block.gravity * block.radius / block.p**2
    left = math.sqrt(start**2 - tie.stiffness * tie.ultimate**2 / inertia)
    free = Block(width=0.8, height=9.0, one_sided=True)
    peak = recorded_response(free, STILL, DT, initial_velocity=left).peak_rotation_ratio
    assert response.peak_rotation_ratio == pytest.approx(peak, rel=1e-9)


def test_many_ties_in_one_place_are_one_with_the_sum_of_their_stiffness_and_strength():
    motion, peaks = synthetic(seed=2, n=800), []
    for count in (1, 24):
        block = Block(**SIZES, ties=[Tie(8.0, 6e6 / count, yield_force=4e4 / count)] * count)
        peaks.append(recorded_response(block, motion, 0.01, scale=(1.0, 1.5, 2.0)).peak_rotation_ratio)
    assert 0.2 < peaks[0][0] < peaks[0][1] < peaks[0][2] == np.inf
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-6)


def test_with_the_stiffness_the_peak_falls_as_its_root():
    start = 0.2
    peaks = []
    for stiffness in (1e9, 1e11):
        block = Block(**SIZES, ties=[Tie(8.0, stiffness, side="both")])
        peaks.append(recorded_response(block, STILL[:100], DT, initial_velocity=start).peak_rotation_ratio)
    assert peaks[0] / peaks[1] == pytest.approx(10.0, rel=2e-3)
    inertia = block.mass * block.gravity * block.radius / block.p**2
    assert peaks[1] * block.alpha_c == pytest.approx(start * math.sqrt(inertia / (1e11 * 64.0)), rel=2e-3)


def test_steps_are_as_short_as_the_tie_asks_for():
    """A bar of 20 mm and 10 m has 34 rad/s on the façade; the answer does not depend on the sampling."""
    bar = Tie(8.0, 200e9 * math.pi * 0.01**2 / 10.0)
    block = Block(**SIZES, ties=[bar], one_sided=True)
    inertia = block.mass * block.gravity * block.radius / block.p**2
    assert math.sqrt(bar.stiffness * 64.0 / inertia) == pytest.approx(34.0, abs=0.5)
    coarse = np.interp(np.arange(0.0, 8.0, 0.05), [0.0, 1.0, 1.5, 2.0, 8.0], [0.0, -2.0, 2.0, 0.0, 0.0])
    fine = np.interp(np.arange(0.0, 7.9501, 0.005), np.arange(0.0, 8.0, 0.05), coarse)
    one, other = recorded_response(block, coarse, 0.05), recorded_response(block, fine, 0.005)
    assert one.peak_rotation_ratio == pytest.approx(other.peak_rotation_ratio, rel=1e-7)


def test_a_thrust_lifts_one_side_sooner():
    pushed = Block(**SIZES, thrusts=[Thrust(1000.0, 8.0)])
    level = pushed.gravity * (math.tan(pushed.alpha_c) - 8e3 / (pushed.mass * pushed.gravity * pushed.radius)
                              / math.cos(pushed.alpha_c))  # fmt: skip
    for share, outcome in ((0.999, Outcome.AT_REST), (1.001, Outcome.ROCKS)):
        ramp = -share * level * np.minimum(np.linspace(0.0, 2.0, 201), 1.0)
        assert recorded_response(pushed, ramp, 0.01).outcome == outcome
