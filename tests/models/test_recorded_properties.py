"""What holds for every response to a sampled accelerogram: symmetries, limits, conservation, convergence."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded_cases import EQUATIONS, G, block_b, synthetic

from rocking import Block, Outcome, recorded_response


@pytest.mark.parametrize("equation", EQUATIONS)
@pytest.mark.parametrize("seed", range(4))
def test_mirrored_record_gives_the_mirrored_motion(equation, seed):
    block, record = block_b(), synthetic(seed, peak=2.5)
    one = recorded_response(block, record, 0.01, equation, history=True)
    other = recorded_response(block, -record, 0.01, equation, history=True)
    assert np.array_equal(one.rotation, -other.rotation, equal_nan=True)
    assert (one.peak_rotation_ratio, one.impacts) == (other.peak_rotation_ratio, other.impacts)


@pytest.mark.parametrize("equation", EQUATIONS)
@pytest.mark.parametrize("peak", [2.0, 4.0])
def test_waiting_before_the_record_only_shifts_the_motion(equation, peak):
    block, record = block_b(), synthetic(3, peak=peak)
    one = recorded_response(block, record, 0.01, equation, history=True)
    late = recorded_response(block, np.concatenate([np.zeros(77), record]), 0.01, equation, history=True)
    # The one sample before the record is a ramp from zero instead of a jump; it stays below the threshold.
    assert abs(record[0]) < 0.1
    assert np.array_equal(one.rotation, late.rotation[77:], equal_nan=True)
    assert late.peak_rotation_ratio == one.peak_rotation_ratio
    assert late.overturning_time == pytest.approx(one.overturning_time + 0.77, rel=1e-12, nan_ok=True)


@pytest.mark.parametrize("equation", EQUATIONS)
@pytest.mark.parametrize("cut", [500, 600, 700])
def test_motion_after_the_record_equals_the_march_through_silence(equation, cut):
    blocks = Block(half_width=np.linspace(0.15, 0.6, 8), half_height=2.0, gravity=G)
    record = synthetic(5, peak=3.0)[:cut]
    record = np.append(record, 0.0)
    closed = recorded_response(blocks, record, 0.01, equation)
    marched = recorded_response(blocks, np.concatenate([record, np.zeros(6000)]), 0.01, equation)
    assert np.array_equal(closed.outcome, marched.outcome)
    assert len(set(closed.outcome)) > 1
    assert closed.peak_rotation_ratio == pytest.approx(marched.peak_rotation_ratio, rel=1e-10)
    assert np.array_equal(closed.impacts, marched.impacts)
    assert np.array_equal(closed.overturning_half_cycle, marched.overturning_half_cycle)
    if equation == "nonlinear":  # the linear criterion is looked at once a step, so its time is that of a step
        assert closed.overturning_time == pytest.approx(marched.overturning_time, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_refining_the_sampling_of_a_piecewise_linear_record_changes_nothing(equation):
    blocks = Block(half_width=np.linspace(0.15, 0.6, 6), half_height=2.0, restitution=0.8, gravity=G)
    record = synthetic(7, n=800, peak=3.0)
    times = 0.01 * np.arange(record.size)
    fine = np.interp(np.arange(5 * (record.size - 1) + 1) / 5, np.arange(record.size), record)
    coarse_response = recorded_response(blocks, record, times[1], equation)
    fine_response = recorded_response(blocks, fine, times[1] / 5, equation)
    assert np.array_equal(coarse_response.outcome, fine_response.outcome)
    rocks = coarse_response.outcome == Outcome.ROCKS
    assert rocks.sum() >= 3
    assert coarse_response.peak_rotation_ratio[rocks] == pytest.approx(
        fine_response.peak_rotation_ratio[rocks], rel=1e-9
    )


def test_small_block_on_a_coarse_record_is_subdivided():
    block = Block(0.02, 0.05, gravity=G)
    assert block.p * 0.02 > 0.3
    record = synthetic(2, n=400, dt=0.02, peak=5.2)
    fine = np.interp(np.arange(8 * (record.size - 1) + 1) / 8, np.arange(record.size), record)
    one = recorded_response(block, record, 0.02, history=True)
    other = recorded_response(block, fine, 0.0025, history=True)
    assert np.nanmax(np.abs(one.rotation)) > 0.3 * block.alpha_c
    assert one.impacts > 3
    assert one.rotation == pytest.approx(other.rotation[::8], abs=1e-9, nan_ok=True)


def test_linear_response_depends_only_on_p_restitution_and_scale_over_alpha():  # VALIDATION F9
    record = synthetic(4, peak=3.0)
    one = Block.from_parameters(p=1.7, alpha=0.2, restitution=0.9, gravity=G)
    two = Block.from_parameters(p=1.7, alpha=0.1, restitution=0.9, gravity=G)
    factors = np.array([0.5, 0.8, 1.0, 1.4])
    wide = recorded_response(one, record, 0.01, "linear", scale=factors)
    narrow = recorded_response(two, record, 0.01, "linear", scale=factors / 2)
    assert wide.peak_rotation_ratio == pytest.approx(narrow.peak_rotation_ratio, rel=1e-9)
    assert np.array_equal(wide.outcome, narrow.outcome)
    assert np.any(wide.outcome == Outcome.ROCKS)


@pytest.mark.parametrize("lift", [-3.0, -0.5, 2.0])
def test_constant_vertical_acceleration_is_another_gravity(lift):  # VALIDATION V21
    record = synthetic(6, peak=3.5)
    block = Block(0.8, 4.0, restitution=0.9, gravity=G)
    other = Block(0.8, 4.0, restitution=0.9, gravity=G + lift)
    lifted = recorded_response(block, record, 0.01, vertical=np.full(record.size, lift), history=True)
    heavier = recorded_response(other, record, 0.01, history=True)
    part = slice(0, 700)
    assert np.nanmax(np.abs(heavier.rotation[part])) > 0.01
    assert lifted.rotation[part] == pytest.approx(heavier.rotation[part], abs=1e-10, nan_ok=True)


@pytest.mark.sweep
@settings(derandomize=True, deadline=None, max_examples=40)
@given(
    share=st.floats(0.01, 0.98),
    speed=st.floats(-0.6, 0.6),
    restitution=st.floats(0.3, 1.0),
    slenderness=st.floats(1.5, 9.0),
    equation=st.sampled_from(EQUATIONS),
)
def test_energy_is_kept_between_impacts_and_never_grows(share, speed, restitution, slenderness, equation):
    block = Block(half_width=0.4, half_height=0.4 * slenderness, restitution=restitution, gravity=G)
    start = {"initial_rotation": share * block.alpha_c, "initial_velocity": speed * block.p * block.alpha_c}
    free = recorded_response(block, np.zeros(600), 0.01, equation, history=True, **start)
    moving = np.isfinite(free.rotation) & (free.rotation != 0.0)
    phi, spin = np.abs(free.rotation[moving]) / block.alpha_c, free.velocity[moving] / (block.p * block.alpha_c)
    if equation == "linear":
        energy = 0.5 * spin**2 - 0.5 * (1.0 - phi) ** 2
    else:
        angle = block.alpha_c * (1.0 - phi)
        energy = 0.5 * spin**2 - 2.0 * np.sin(0.5 * angle) ** 2 / block.alpha_c**2
    assert np.all(np.diff(energy) <= 1e-12 * (1.0 + np.abs(energy[:-1])))
    side = np.sign(free.rotation[moving])
    together = side[1:] == side[:-1]
    steps = np.diff(energy)[together]
    # Two impacts may fall between two samples and keep the side; then energy falls by a finite share.
    kept = np.abs(steps) <= 1e-12 * (1.0 + np.abs(energy[:-1][together]))
    assert kept.sum() >= min(10, together.sum() // 3)


@pytest.mark.parametrize("ratio", [0.2, 0.6, 0.9])
def test_narrow_pulse_tends_to_the_impulse_of_the_linear_gain(ratio):  # VALIDATION F9
    block = block_b()
    impulse = ratio * G * block.alpha_c / block.p  # gain p^2/g
    exact = 1.0 - np.sqrt(1.0 - ratio**2)
    errors = []
    for width in (4e-3, 2e-3, 1e-3):
        triangle = np.array([0.0, impulse / width, 0.0])
        response = recorded_response(block, triangle, width, "linear")
        errors.append(abs(response.peak_rotation_ratio - exact))
    assert errors[2] < 0.02 * exact
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)  # first order in the width
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.1)


def test_smooth_motion_converges_with_the_square_of_the_sampling():  # VALIDATION V22
    block = block_b()
    duration = 1.0

    def peak(n):
        t = np.linspace(0.0, duration, n + 1)
        return recorded_response(block, 2.2 * np.sin(2 * np.pi * t), t[1], "nonlinear").peak_rotation_ratio

    fine = peak(3200)
    errors = [abs(peak(n) - fine) for n in (50, 100, 200)]
    assert errors[0] > 1e-6
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
