"""The slow reference solver against closed forms, published cases and itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
import rocking_reference
from rocking_reference import block_of, reference, shaking

from rocking.body.block import Block
from rocking.response import Outcome

BLOCK_A = Block(half_width=0.5, half_height=math.sqrt(3.75), gravity=9.81)
BLOCK_B = Block(half_width=0.5, half_height=math.sqrt(15.75), gravity=9.81)
EQUATIONS = ("linear", "nonlinear")


@pytest.mark.parametrize(
    ("equation", "start", "quarter"),
    [
        ("linear", 0.1, 0.4671453 / 1.9180068),
        ("linear", 0.25, 0.7953655 / 1.9180068),
        ("linear", 0.5, 1.3169579 / 1.9180068),
        ("linear", 0.9, 2.9932228 / 1.9180068),
        ("linear", 0.99, 5.2982924 / 1.9180068),
        ("nonlinear", 0.25, 0.4160771),
        ("nonlinear", 0.5, 0.6879163),
        ("nonlinear", 0.9, 1.5613433),
    ],
)
def test_released_block_touches_down_after_a_quarter_period(equation, start, quarter):  # VALIDATION V11 (D)
    answer = reference(BLOCK_A, np.zeros(2), quarter, equation=equation, initial_rotation=start * BLOCK_A.alpha_c)
    assert abs(answer.rotation[-1]) / BLOCK_A.alpha_c < 2e-7


@pytest.mark.parametrize(("number", "peak"), [(1, 0.3802959), (2, 0.2970681), (3, 0.2354605), (4, 0.1883527)])
def test_peaks_of_the_free_decay(number, peak):  # VALIDATION V12 (D); F5
    p, restitution = BLOCK_A.p, BLOCK_A.restitution
    quarters = [math.acosh(1.0 / (1.0 - x)) for x in (0.5, 0.3802959, 0.2970681, 0.2354605, 0.1883527)[: number + 1]]
    to_peak = (quarters[0] + 2.0 * sum(quarters[1:-1]) + quarters[-1]) / p
    assert restitution == pytest.approx(0.90625)
    answer = reference(BLOCK_A, np.zeros(2), to_peak, equation="linear", initial_rotation=0.5 * BLOCK_A.alpha_c)
    assert (-1) ** number * answer.rotation[-1] / BLOCK_A.alpha_c == pytest.approx(peak, abs=1e-7)


@pytest.mark.parametrize(
    ("block", "critical", "touchdown"), [(BLOCK_A, 0.698343, 0.611518), (BLOCK_B, 0.461962, 0.823083)]
)
def test_critical_double_impulse(block, critical, touchdown):  # VALIDATION V4 (P), Nabeshima et al. 2016
    gain = block.p**2 * math.cos(block.alpha_c) / block.gravity
    landing = reference(block, np.zeros(2), touchdown, initial_velocity=gain * critical)
    assert abs(landing.rotation[-1]) / block.alpha_c < 1e-6
    for factor, outcome in ((1.0 - 2e-6, Outcome.ROCKS), (1.0 + 2e-6, Outcome.OVERTURNS)):
        velocity = gain * critical * factor * (1.0 + block.restitution)  # after touch-down and the second impulse
        assert reference(block, np.zeros(2), 1e-3, initial_velocity=-velocity).outcome == outcome


@pytest.mark.sweep
@pytest.mark.parametrize("equation", EQUATIONS)
def test_free_rocking_loses_energy_only_in_impacts(equation):
    block, dt = BLOCK_A, 0.01
    answer = reference(
        block, np.zeros(1000), dt, equation=equation, initial_rotation=0.7 * block.alpha_c, initial_velocity=0.1
    )
    x, u = np.abs(answer.rotation) / block.alpha_c, answer.velocity / (block.p * block.alpha_c)
    if equation == "linear":
        height = x - 0.5 * x * x
    else:
        height = (np.cos(block.alpha_c * (1.0 - x)) - math.cos(block.alpha_c)) / block.alpha_c**2
    energy = 0.5 * u * u + height
    passed = np.concatenate(([0], np.cumsum(np.diff(np.sign(answer.rotation)) != 0)))
    early = passed <= 6  # one touch-down at most between these samples
    assert passed[-1] > 6
    np.testing.assert_allclose(energy[early] / block.restitution ** (2 * passed[early]), energy[0], rtol=1e-11)


@pytest.mark.parametrize("side", [1, -1])
def test_one_sample_of_the_linear_equation_is_its_closed_form(side):
    block, dt, ground, rotation, velocity = BLOCK_A, 0.37, np.array([0.4, -1.1]), 0.3, 0.2  # ground over g alpha
    answer = reference(
        block,
        ground * block.gravity * block.alpha_c,
        dt,
        equation="linear",
        initial_rotation=side * rotation * block.alpha_c,
        initial_velocity=side * velocity * block.p * block.alpha_c,
    )
    still = 1.0 + side * ground  # x'' = p^2 (x - still(t)), still linear in t
    rate = (still[1] - still[0]) / (block.p * dt)
    t = block.p * dt
    expected = still[1] + (rotation - still[0]) * math.cosh(t) + (velocity - rate) * math.sinh(t)
    assert answer.rotation[-1] == pytest.approx(side * expected * block.alpha_c, rel=1e-13)


@pytest.mark.parametrize(
    ("duration", "threshold"),
    [
        (1.0, 1.5819767),
        *(pytest.param(*case, marks=pytest.mark.sweep) for case in ((0.5, 2.5414941), (2.0, 1.1565176))),
    ],
)
def test_rectangular_pulse_overturns_at_its_threshold(duration, threshold):  # VALIDATION V13, V22 (D); F6
    def least(count):
        dt = duration / BLOCK_A.p / count
        pulse = np.concatenate((np.ones(count), [0.0]))
        return overturning_amplitude(lambda amplitude: amplitude * pulse, dt, threshold)

    coarse, fine = least(40), least(80)
    assert 2.0 * fine - coarse == pytest.approx(threshold, rel=5e-4)  # a jump: first order, extrapolated


@pytest.mark.parametrize(("frequency", "threshold"), [(1.0, 1.322397), (2.0, 1.800724), (4.0, 2.790798)])
def test_half_sine_pulse_overturns_at_its_threshold(frequency, threshold):  # VALIDATION V13, V22 (D); F7
    def least(count):
        dt = math.pi / (frequency * BLOCK_A.p) / count
        pulse = np.sin(np.pi * np.arange(count + 1) / count)
        return overturning_amplitude(lambda amplitude: amplitude * pulse, dt, threshold)

    coarse, fine = least(20), least(40)
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(threshold, rel=2e-5)  # a kinked sine: second order


def overturning_amplitude(pulse, dt, guess):
    """Smallest amplitude over g alpha at which block A overturns in the linear equation, by bisection about a guess."""
    low, high = 0.9 * guess, 1.1 * guess
    for _ in range(17):  # to 1.5e-6
        middle = 0.5 * (low + high)
        ground = pulse(middle) * BLOCK_A.gravity * BLOCK_A.alpha_c
        if reference(BLOCK_A, ground, dt, equation="linear").outcome == Outcome.OVERTURNS:
            high = middle
        else:
            low = middle
    assert low > 0.9 * guess
    assert high < 1.1 * guess
    return 0.5 * (low + high)


@pytest.mark.parametrize(
    ("amplitude", "outcome"),
    [(1.38, 1), (1.43, 2), (3.44, 2), (3.52, 1), (3.60, 1), (3.67, 2)],
)
def test_one_sine_overturns_in_two_bands(amplitude, outcome):  # VALIDATION V15, V14 (D), w/p = 3, C = 0.9
    block = block_of(2.0, 4.0, 0.9)
    dt = 2.0 * math.pi / (3.0 * block.p) / 160
    ground = np.sin(2.0 * np.pi * np.arange(161) / 160) * amplitude * block.gravity * block.alpha_c
    assert reference(block, ground, dt, equation="linear").outcome == outcome


@pytest.mark.parametrize("equation", EQUATIONS)
def test_reference_is_mirror_symmetric(equation):
    block, ground = block_of(1.0, 5.0), shaking(3, 400, 0.01) * 5.0
    right, left = reference(block, ground, 0.01, equation=equation), reference(block, -ground, 0.01, equation=equation)
    np.testing.assert_array_equal(right.rotation, -left.rotation)
    assert right[:1] + right[3:4] == left[:1] + left[3:4]
    assert right.peak_rotation_ratio > 0.0


@pytest.mark.parametrize("equation", EQUATIONS)
def test_reference_does_not_depend_on_how_the_same_motion_is_cut(equation):
    block, ground = block_of(0.5, 4.0, 0.7), shaking(5, 120, 0.05) * 4.0
    fine = np.interp(np.arange(119 * 8 + 1) / 8.0, np.arange(120.0), ground)
    whole, cut = reference(block, ground, 0.05, equation=equation), reference(block, fine, 0.05 / 8, equation=equation)
    assert cut.peak_rotation_ratio == pytest.approx(whole.peak_rotation_ratio, rel=1e-12)
    assert cut.impacts == whole.impacts > 10
    np.testing.assert_allclose(cut.rotation[::8], whole.rotation, atol=1e-12)


@pytest.mark.sweep
@pytest.mark.parametrize("equation", EQUATIONS)
def test_reference_does_not_depend_on_its_own_settings(monkeypatch, equation):
    block, ground = block_of(1.5, 5.0, 0.9), shaking(8, 600, 0.02) * 4.0
    before = reference(block, ground, 0.02, equation=equation)
    for name, value in (("STEP", 0.0125), ("CHATTER", 1e-9), ("RTOL", 3e-14)):
        with monkeypatch.context() as patch:
            patch.setattr(rocking_reference, name, value)
            after = reference(block, ground, 0.02, equation=equation)
        assert after.peak_rotation_ratio == pytest.approx(before.peak_rotation_ratio, rel=1e-11), name
        assert after.impacts == before.impacts, name
        np.testing.assert_allclose(after.rotation, before.rotation, atol=1e-11, err_msg=name)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in (1, 2)), 3])
@pytest.mark.parametrize("equation", EQUATIONS)
def test_motion_after_the_record_is_the_motion_on_zeros(equation, seed):
    block, ground = block_of(2.0, 6.0, 0.85), shaking(20 + seed, 400, 0.02)
    ground = np.concatenate((ground[:250] * (2.5 + 1.5 * seed), [0.0]))  # cut in full motion
    longer = np.concatenate((ground, np.zeros(1500)))
    cut, padded = reference(block, ground, 0.02, equation=equation), reference(block, longer, 0.02, equation=equation)
    assert (cut.outcome, cut.impacts) == (padded.outcome, padded.impacts)
    assert cut.peak_rotation_ratio == pytest.approx(padded.peak_rotation_ratio, rel=1e-11)
