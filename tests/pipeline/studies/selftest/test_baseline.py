"""The baseline is a fair opponent: right where its tolerance is tight, and idle where the block rests."""

import math

import numpy as np
import pytest
from recorded_cases import EQUATIONS, G, block_of, synthetic

from rockpulse.models import Outcome, recorded_response
from rockpulse.studies.selftest import baseline
from synthetic import synthetic_lanes, synthetic_motion


def answer(block, ground, dt, equation, **options):
    return baseline.baseline_response(
        block.p, block.alpha_c, block.restitution, ground, dt, equation, gravity=block.gravity, **options
    )


@pytest.mark.parametrize("peak", [8.0, *(pytest.param(peak, marks=pytest.mark.sweep) for peak in (2.4, 3.5))])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_baseline_converges_to_the_kernel(equation, peak):
    block, dt = block_of(1.0, 5.0, 0.8), 0.02
    ground = synthetic(seed=3, n=120, dt=dt, peak=peak)
    fast = recorded_response(block, ground, dt, equation=equation)
    tight = answer(block, ground, dt, equation, method="DOP853", rtol=1e-10, rest_speed=1e-6)
    loose = answer(block, ground, dt, equation)
    assert tight.outcome == loose.outcome == Outcome(fast.outcome).name
    if math.isfinite(fast.peak_rotation_ratio):
        assert tight.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-5)
        assert loose.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-2)
    else:
        assert tight.peak_rotation_ratio == math.inf


@pytest.mark.parametrize("equation", EQUATIONS)
def test_block_at_rest_costs_nothing(equation):
    block = block_of(1.0, 5.0, 0.8)
    assert answer(block, np.full(50, 1.9), 0.01, equation) == (0.0, "AT_REST", 0)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_only_samples_in_motion_are_active(equation):
    """One pulse in twenty seconds: the rest before and after it is jumped over."""
    block = block_of(1.0, 5.0, 0.5)
    ground = np.zeros(2000)
    ground[1000:1020] = 3.0 * np.sin(np.pi * np.arange(20) / 19)
    response = answer(block, ground, 0.01, equation)
    assert response.outcome == "ROCKS"
    assert 10 < response.active_samples < 200


@pytest.mark.parametrize("equation", EQUATIONS)
def test_motion_after_the_record_is_decided_by_energy(equation):
    """F6 (linear) at its limit, and the nonlinear pulse on both sides by the kernel."""
    block, samples = block_of(2.0, 4.0, 0.9, gravity=G), 40
    critical = G * block.alpha_c / -math.expm1(-1.0)
    for share in (0.95, 0.99, 1.01, 1.05):
        pulse = np.full(samples + 1, critical * share)
        dt = 1.0 / block.p / samples
        fast = recorded_response(block, pulse, dt, equation=equation)
        slow = answer(block, pulse, dt, equation)
        assert slow.outcome == Outcome(fast.outcome).name
        if slow.outcome == "ROCKS":
            assert slow.peak_rotation_ratio == pytest.approx(fast.peak_rotation_ratio, rel=1e-4)


def test_uplift_by_a_hair_does_not_repeat_itself_for_ever():
    lanes = synthetic_lanes(0, 24)
    motion = synthetic_motion(0, pga=0.3 * 9.80665)
    answer = baseline.baseline_response(lanes.p[8], lanes.alpha[8], 0.9, motion, 0.01, "linear", 0.7)
    assert answer.outcome == "ROCKS"
    assert 0.0 <= answer.peak_rotation_ratio < 1e-9
