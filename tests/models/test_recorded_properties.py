"""What holds for every response to a sampled accelerogram: symmetries, limits, conservation, convergence."""

import numpy as np
import pytest
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
