"""Half-waves as impulses of which only the part after lift-off or landing counts."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.body.block import Block
from rocking.effective_impulse import FORCES, _bounds, _peaks, effective_impulse_response
from rocking.impulses.impulsive import impulsive_response
from rocking.march.recorded import recorded_response
from rocking.response import Outcome, Reason

G = 9.81
PROPERTY = settings(derandomize=True, deadline=None, max_examples=40)
FIELDS = ("peak_rotation_ratio", "outcome", "reason", "overturning_time", "overturning_half_cycle", "impacts")


def body(restitution=0.7, slenderness=6.0, p=2.0):
    return Block.from_parameters(p=p, alpha=math.atan(1.0 / slenderness), restitution=restitution, gravity=G)


def threshold(block, gain):
    alpha = block.alpha_c
    return G * {"tangent": math.tan(alpha), "linear": alpha, "paper": alpha / math.cos(alpha)}[gain]


def half_sine(peak, length, dt, before=0.5, after=0.5):
    inside = peak * np.sin(np.pi * np.arange(1, round(length / dt)) * dt / length)
    return np.concatenate([np.zeros(round(before / dt) + 1), inside, np.zeros(round(after / dt) + 1)])


def shaking(seed, strength=4.0, length=8.0, dt=0.01):
    rng = np.random.default_rng(seed)
    time = np.arange(round(length / dt)) * dt
    waves = sum(
        rng.normal() * np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.0)) for f in rng.uniform(0.5, 4.0, 12)
    )
    waves *= np.sin(np.pi * time / length) ** 2
    return strength * waves / np.abs(waves).max()


@pytest.mark.parametrize("gain", sorted(FORCES))
def test_wave_that_never_exceeds_the_threshold_is_no_impulse(gain):
    block = body()
    level = threshold(block, gain)
    record = half_sine(level * (1.0 - 1e-9), 2.0, 0.01)
    response = effective_impulse_response(block, record, 0.01, gain=gain)
    assert (response.outcome, response.peak_rotation_ratio, response.impacts) == (Outcome.AT_REST, 0.0, 0)
    above = effective_impulse_response(block, record, 0.01, gain=gain, scale=1.01)
    assert above.outcome == Outcome.ROCKS
    assert 0.0 < above.peak_rotation_ratio < 1e-2


def test_plateau_at_the_threshold_does_not_lift_the_block():
    block = body()
    record = np.full(200, threshold(block, "tangent"))
    assert effective_impulse_response(block, record, 0.01).outcome == Outcome.AT_REST


@pytest.mark.parametrize("gain", sorted(FORCES))
def test_narrow_wave_far_above_the_threshold_tends_to_its_whole_impulse(gain):  # F9
    block = body()
    impulse = 0.6 * block.critical_impulse
    whole = impulsive_response(block, [0.0], [impulse], gain=gain).peak_rotation_ratio
    errors = []
    for length in (0.02, 0.01, 0.005):
        record = half_sine(impulse * np.pi / (2.0 * length), length, length / 200.0, 0.1, 0.1)
        response = effective_impulse_response(block, record, length / 200.0, gain=gain)
        errors.append(response.peak_rotation_ratio / whole - 1.0)
    # First order: what acts before the threshold is lost, and gravity pulls the block back as long as the wave lasts.
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.05)
    assert 2.0 * errors[2] - errors[1] == pytest.approx(0.0, abs=5e-4)


def test_lift_off_from_rest_is_that_of_the_linear_equation():
    # A triangle that rises from 0 to 2 thresholds and falls again: what the equation says at the end of the wave.
    block = body(restitution=0.0)
    level, dt = threshold(block, "linear"), 0.001
    ramp = 2.0 * level * np.concatenate([np.arange(0, 100), np.arange(100, -1, -1)]) / 100.0
    exact = recorded_response(block, np.append(ramp, np.zeros(10)), dt, equation="linear").peak_rotation_ratio
    for longest, error in ((np.inf, 2e-2), (0.1, 2e-3), (0.02, 1e-4)):
        found = effective_impulse_response(block, np.append(ramp, np.zeros(10)), dt, gain="linear", longest=longest)
        assert found.peak_rotation_ratio == pytest.approx(exact, rel=error)


def test_short_stretches_tend_to_the_linear_equation_with_second_order():
    block, ratios = body(0.8, p=1.6), []
    for seed in range(10):
        record = shaking(seed, strength=2.2)
        exact = recorded_response(block, record, 0.01, equation="linear", scale=[1.0, 1.0 + 1e-6])
        peak = exact.peak_rotation_ratio[0]
        if abs(exact.peak_rotation_ratio[1] / peak - 1.0) > 1e-3:
            continue  # a motion that a change of the record in the sixth digit turns into another one
        errors = []
        for longest in (0.02, 0.01, 0.005):
            found = effective_impulse_response(block, record, 0.01, gain="linear", longest=longest)
            assert found.outcome == exact.outcome[0]
            errors.append(abs(found.peak_rotation_ratio / peak - 1.0))
        assert errors[0] < 2e-3
        assert errors[2] < 1e-4
        ratios.append(errors[0] / errors[1])
    assert len(ratios) == 9
    assert np.median(ratios) == pytest.approx(4.0, rel=0.1)


@PROPERTY
@given(st.integers(0, 10_000), st.floats(1.8, 5.0), st.sampled_from(sorted(FORCES)))
def test_negated_record_mirrors_the_motion(seed, strength, gain):
    record = shaking(seed, strength)
    first = effective_impulse_response(body(), record, 0.01, gain=gain)
    second = effective_impulse_response(body(), -record, 0.01, gain=gain)
    assert all(np.array_equal(getattr(first, name), getattr(second, name), equal_nan=True) for name in FIELDS)


@PROPERTY
@given(st.integers(0, 10_000), st.floats(1.8, 5.0))
def test_response_depends_on_the_record_over_the_threshold_alone(seed, strength):  # F9
    record = shaking(seed, strength)
    slender, stocky = body(slenderness=10.0), body(slenderness=4.0)
    ratio = math.tan(stocky.alpha_c) / math.tan(slender.alpha_c)
    first = effective_impulse_response(slender, record, 0.01)
    second = effective_impulse_response(stocky, ratio * record, 0.01)
    assert first.outcome == second.outcome
    if first.outcome == Outcome.ROCKS and first.impacts < 20:
        assert first.peak_rotation_ratio == pytest.approx(second.peak_rotation_ratio, rel=1e-4)


def test_boundaries_at_the_changes_of_sign_are_the_default():
    record, dt = np.array([0.0, 3.0, 4.0, 3.0, -1.0, -4.0, -3.0, 0.0, 0.0]), 0.1
    crossing = 0.3 + 0.1 * 3.0 / 4.0
    default = effective_impulse_response(body(), record, dt)
    given_ = effective_impulse_response(body(), record, dt, boundaries=[0.0, crossing, 0.7])
    assert default.outcome == Outcome.ROCKS
    assert default.peak_rotation_ratio == pytest.approx(given_.peak_rotation_ratio, rel=1e-12)


def test_half_waves_end_where_the_record_changes_its_sign_and_around_its_zeros():
    record = np.array([0.0, 0.0, 3.0, 4.0, -1.0, -4.0, 0.0, 0.0, 0.0, 2.0, 0.0, -2.0, -2.0, 2.0])
    expected = [0.0, 1.0, 3.8, 6.0, 8.0, 10.0, 12.5, 13.0]
    assert _bounds(record, 0.5, None) == pytest.approx(0.5 * np.array(expected), rel=1e-14)
    assert _bounds(-record, 0.5, None) == pytest.approx(0.5 * np.array(expected), rel=1e-14)
    assert _bounds(record, 0.5, [0.0, 1.25, 6.5]).tolist() == [0.0, 1.25, 6.5]
    assert _bounds(record, 0.5, [2.0, 6.5 * (1.0 + 5e-13)]).tolist() == [0.0, 2.0, 6.5]
    assert _bounds(record, 0.5, []).tolist() == [0.0, 6.5]


def test_the_peak_of_a_half_wave_is_at_a_sample_or_at_one_of_its_ends():
    """Between samples the record is straight: at 0.25 s it is -0.5, at 1.75 s -4.5."""
    record, bounds = np.array([1.0, -2.0, 3.0, -3.0, -6.0]), np.array([0.0, 0.25, 1.0, 1.75, 2.0])
    assert _peaks(record, 0.5, bounds).tolist() == [1.0, 3.0, 4.5, 6.0]
    assert _peaks(record, 0.5, np.array([0.0, 0.5, 2.0])).tolist() == [2.0, 6.0]
    assert _peaks(record, 0.5, np.array([0.0, 2.0])).tolist() == [6.0]


def test_impulses_and_centroids_of_half_waves_are_exact_for_straight_pieces():
    """The same record at half the sampling interval, with the samples between: nothing changes but rounding."""
    record = shaking(5)
    fine = np.interp(np.arange(0.0, record.size - 0.5, 0.5), np.arange(record.size), record)
    blocks = Block(0.5, np.linspace(1.6, 5.0, 7), restitution=0.5, gravity=G)
    for scale in (0.5, 0.8):
        one = effective_impulse_response(blocks, record, 0.01, scale=scale)
        other = effective_impulse_response(blocks, fine, 0.005, scale=scale)
        assert np.array_equal(one.outcome, other.outcome)
        assert one.peak_rotation_ratio == pytest.approx(other.peak_rotation_ratio, rel=1e-6)


def test_a_block_that_falls_is_brought_back_by_the_next_half_wave():  # V13 and V14
    """At w/p = 4 a half sine overturns from 2.79 g alpha on; from 4.85 to 5.24 the second half saves the block."""
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9, gravity=G)
    sine = 5.05 * G * 0.1 * np.sin(2.0 * np.pi * np.arange(401) / 400.0)
    sine[[200, 400]] = 0.0
    dt = 0.25 * np.pi / 400.0
    for record, outcome in ((sine, Outcome.ROCKS), (sine[:201], Outcome.OVERTURNS)):
        assert recorded_response(block, record, dt, "linear").outcome == outcome
        assert effective_impulse_response(block, record, dt, gain="linear", longest=0.01).outcome == outcome


def test_overturning_is_certain_where_no_later_half_wave_can_prevent_it():
    """After a wave of 0.3 s and ten times the threshold the growing mode is above what waves of a tenth can take."""
    block, dt = body(), 0.01
    wave = 10.0 * threshold(block, "tangent") * np.sin(np.pi * np.arange(31) / 30.0)
    wave[30] = 0.0
    for after in (np.zeros(0), -0.1 * wave[1:], np.concatenate([-0.1 * wave[1:], 0.1 * wave[1:]])):
        found = effective_impulse_response(block, np.append(wave, after), dt)
        assert found.outcome == Outcome.OVERTURNS
        assert found.overturning_time <= 0.3 + 1e-12


def test_what_is_taken_unless_it_is_told():
    record = shaking(8)
    plain = effective_impulse_response(body(), record, 0.01)
    told = effective_impulse_response(body(), record, 0.01, None, "tangent", 1.0, 0.1)
    assert plain.outcome == Outcome.ROCKS
    assert plain.peak_rotation_ratio == told.peak_rotation_ratio
    for other in ({"gain": "paper"}, {"scale": 1.001}, {"longest": 0.11}):
        assert (
            plain.peak_rotation_ratio != effective_impulse_response(body(), record, 0.01, **other).peak_rotation_ratio
        )


@pytest.mark.parametrize("threads", [1, 2, 4, None])
def test_number_of_threads_changes_no_digit(threads):
    blocks = Block(0.5, np.linspace(1.6, 5.0, 80), restitution=0.9, gravity=G)
    scale, record = np.array([0.3, 1.0, 2.0, 4.0]), shaking(3)
    one = effective_impulse_response(blocks, record, 0.01, scale=scale, threads=1)
    many = effective_impulse_response(blocks, record, 0.01, scale=scale, threads=threads)
    assert one.outcome.shape == (4, 80)
    assert len(np.unique(one.outcome)) == 3
    assert all(np.array_equal(getattr(one, name), getattr(many, name), equal_nan=True) for name in FIELDS)
    alone = effective_impulse_response(blocks.lane(17), record, 0.01, scale=2.0)
    assert all(np.array_equal(getattr(one, name)[2, 17], getattr(alone, name), equal_nan=True) for name in FIELDS)


@pytest.mark.parametrize("restitution", [0.0, 1e-3, 0.9999, 1.0])
def test_restitutions_at_both_ends_give_an_answer_or_a_reason(restitution):
    for seed in range(4):
        response = effective_impulse_response(body(restitution), shaking(seed), 0.01, scale=[0.2, 0.5, 1.0, 3.0])
        unresolved = response.outcome == Outcome.UNRESOLVED
        assert np.array_equal(unresolved, response.reason == Reason.IMPACT_LIMIT)
        assert np.array_equal(unresolved, np.isnan(response.peak_rotation_ratio))
        assert response.outcome[0] == Outcome.AT_REST
        assert not np.all(unresolved[1:])


def test_long_quiet_wait_neither_overflows_nor_takes_time():  # p t > 700
    block = body(0.9)
    wave = half_sine(3.0 * threshold(block, "tangent"), 0.2, 0.01)
    record = np.concatenate([wave, np.zeros(100_000), 0.5 * wave])
    alone = effective_impulse_response(block, wave, 0.01)
    later = effective_impulse_response(block, record, 0.01)
    assert alone.outcome == later.outcome == Outcome.ROCKS
    assert later.peak_rotation_ratio == pytest.approx(alone.peak_rotation_ratio, rel=1e-9)
    assert later.impacts > alone.impacts


def test_one_strong_wave_overturns_and_says_when():
    block = body()
    record = half_sine(20.0 * threshold(block, "tangent"), 0.3, 0.01)
    response = effective_impulse_response(block, record, 0.01)
    assert (response.outcome, response.overturning_half_cycle, response.peak_rotation_ratio) == (
        Outcome.OVERTURNS,
        1,
        np.inf,
    )
    assert 0.5 < response.overturning_time <= 0.8 + 1e-9


def test_record_of_zeros_leaves_the_block_at_rest():
    response = effective_impulse_response(body(), np.zeros(2), 0.01, scale=[0.0, 5.0])
    assert response.outcome.tolist() == [Outcome.AT_REST, Outcome.AT_REST]


@pytest.mark.parametrize(
    ("record", "options", "message"),
    [
        ([1.0], {}, "acceleration"),
        ([1.0, np.nan], {}, "acceleration"),
        ([1.0, 2.0], {"gain": "exact"}, "gain: expected one of tangent"),
        ([1.0, 2.0], {"scale": -1.0}, "scale"),
        ([1.0, 2.0], {"scale": [[1.0]]}, "scale"),
        ([1.0, 2.0], {"scale": [1.0, np.inf]}, "scale"),
        ([[1.0, 2.0], [3.0, 4.0]], {}, "acceleration"),
        ([1.0, 2.0], {"boundaries": [[0.001, 0.002]]}, "boundaries"),
        ([1.0, 2.0], {"boundaries": [0.001, np.nan]}, "boundaries"),
        ([1.0, 2.0], {"boundaries": [0.001, 0.01 * (1.0 + 2e-12)]}, "boundaries: .*between 0 and 0.01"),
        ([1.0, 2.0], {"longest": 0.0}, "longest"),
        ([1.0, 2.0], {"longest": np.nan}, "longest"),
        ([1.0, 2.0], {"boundaries": [0.005, 0.005]}, "boundaries: .*increasing"),
        ([1.0, 2.0], {"boundaries": [0.0, 0.02]}, "boundaries: .*between 0 and 0.01"),
        ([1.0, 2.0], {"boundaries": [0.0, 0.002, 0.02]}, "boundaries: .*between 0 and 0.01"),
        ([1.0, 2.0], {"boundaries": [-0.001, 0.002]}, "boundaries: .*between 0 and 0.01"),
        ([1.0, 2.0], {"threads": 0}, "threads"),
    ],
)
def test_bad_arguments_are_named(record, options, message):
    with pytest.raises(ValueError, match=message):
        effective_impulse_response(body(), record, 0.01, **options)


@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf, np.array([0.01])])
def test_sampling_interval_is_checked(dt):
    with pytest.raises(ValueError, match="dt"):
        effective_impulse_response(body(), [1.0, 2.0], dt)
