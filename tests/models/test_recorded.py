"""Response to a sampled accelerogram. The comparison with an independent integrator is in
test_recorded_reference.py."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.models import Block, Outcome, Reason, recorded_response

G = 9.81  # VALIDATION: all numbers are for this value; blocks A and B have R = 2 m and R = 4 m
EQUATIONS = ["linear", "nonlinear"]


def block_a(**options):
    return Block(half_width=0.5, half_height=np.sqrt(3.75), gravity=G, **options)


def block_b(**options):
    return Block(half_width=0.5, half_height=np.sqrt(15.75), gravity=G, **options)


def synthetic(seed=1, n=1500, dt=0.01, peak=4.0):
    """Seeded motion of a few sines under a bell: smooth, strong enough to rock and to overturn."""
    rng = np.random.default_rng(seed)
    t = dt * np.arange(n)
    waves = sum(rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for f in (0.6, 1.1, 1.9, 3.3))
    motion = waves * np.exp(-(((t - 0.4 * t[-1]) / (0.2 * t[-1])) ** 2))
    return peak * motion / np.max(np.abs(motion))


def first_crossing(response):
    """Time of the first impact of a free motion, from the last sample before it and its velocity."""
    i = 1 + int(np.flatnonzero(np.diff(np.sign(response.rotation[1:])))[0])
    return response.time[i] - response.rotation[i] / response.velocity[i]


@pytest.mark.parametrize(
    ("share", "p_time"), [(0.1, 0.4671453), (0.25, 0.7953655), (0.5, 1.3169579), (0.9, 2.9932228), (0.99, 5.2982924)]
)
def test_quarter_period_of_the_linear_equation(share, p_time):  # VALIDATION V11 (D)
    block = block_a()
    free = recorded_response(
        block, np.zeros(40000), 1e-4, "linear", initial_rotation=share * block.alpha_c, history=True
    )
    assert block.p * first_crossing(free) == pytest.approx(p_time, abs=2e-7)


@pytest.mark.parametrize(("share", "seconds"), [(0.25, 0.4160771), (0.5, 0.6879163), (0.9, 1.5613433)])
def test_quarter_period_of_the_nonlinear_equation(share, seconds):  # VALIDATION V11 (D)
    block = block_a()
    free = recorded_response(block, np.zeros(20000), 1e-4, initial_rotation=share * block.alpha_c, history=True)
    assert first_crossing(free) == pytest.approx(seconds, abs=1e-7)


def test_free_decay_peaks_and_their_total_time():  # VALIDATION V12 (D)
    block = block_a()
    assert block.restitution == pytest.approx(0.90625, rel=1e-12)
    free = recorded_response(block, np.zeros(24000), 5e-4, "linear", initial_rotation=0.5 * block.alpha_c, history=True)
    sign_changes = np.flatnonzero(np.diff(np.sign(free.rotation))) + 1
    peaks = [np.max(np.abs(part)) / block.alpha_c for part in np.split(free.rotation, sign_changes)[:5]]
    assert peaks == pytest.approx([0.5, 0.3802959, 0.2970681, 0.2354605, 0.1883527], abs=1e-6)
    at_rest = free.time[np.flatnonzero(free.rotation != 0.0)[-1] + 1]
    assert block.p * at_rest == pytest.approx(19.812828, abs=2 * block.p * 5e-4)


@pytest.mark.parametrize(
    ("block", "velocity", "timing"), [(block_a(), 0.698343, 0.611518), (block_b(), 0.461962, 0.823083)]
)
def test_critical_double_impulse_of_nabeshima(
    block, velocity, timing
):  # VALIDATION V4 (P): doi 10.3389/fbuil.2016.00009
    kick = block.p**2 * np.cos(block.alpha_c) / G * velocity
    first = recorded_response(block, np.zeros(20000), 1e-4, initial_velocity=kick, history=True)
    impact = first_crossing(first)
    assert impact == pytest.approx(timing, abs=1e-6)
    second = (1.0 + block.restitution) * kick  # right after the impact, the second impulse on top
    spread = 2e-6  # the printed velocity has six digits
    below, above = (
        recorded_response(block, np.zeros(2), 0.01, initial_velocity=second * factor)
        for factor in (1.0 - spread, 1.0 + spread)
    )
    assert (below.outcome, above.outcome) == (Outcome.ROCKS, Outcome.OVERTURNS)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_uplift_is_strictly_above_the_threshold_and_away_from_the_push(equation):
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution=0.9, gravity=8.0)  # powers of two: exact thresholds
    threshold = 8.0 * (0.25 if equation == "linear" else np.tan(0.25))
    at = recorded_response(block, np.full(50, threshold), 0.01, equation)
    above = recorded_response(block, np.full(50, np.nextafter(threshold, 9.0)), 0.01, equation)
    assert (at.outcome, at.peak_rotation_ratio, at.impacts) == (Outcome.AT_REST, 0.0, 0)
    assert above.outcome == Outcome.ROCKS
    pushed = recorded_response(block, np.full(20, -1.2 * threshold), 0.01, equation, history=True)
    assert np.all(pushed.rotation[1:] > 0.0)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_uplift_on_a_ramp_starts_where_the_record_crosses_the_threshold(equation):
    block = block_b()
    threshold = G * (block.alpha_c if equation == "linear" else np.tan(block.alpha_c))
    ramp = np.array([0.0, 0.0, -2.0 * threshold, -2.0 * threshold])
    coarse = recorded_response(block, ramp, 0.02, equation, history=True)
    fine = recorded_response(block, np.interp(np.arange(61) / 20, np.arange(4), ramp), 0.001, equation, history=True)
    assert coarse.rotation == pytest.approx(fine.rotation[::20], rel=1e-10)
    # Close to the threshold phi'' = p^2 slope (t - t0)/g, so phi = p^2 slope (t - t0)^3/(6 g).
    slope = 2.0 * threshold / 0.02
    estimate = block.p**2 * slope * 0.01**3 / (6.0 * G)
    assert coarse.rotation[2] == pytest.approx(estimate, rel=0.02)


def test_plateau_exactly_at_the_threshold_keeps_the_block_at_rest_until_the_record_rises_again():
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution=0.9, gravity=8.0)
    record = np.array([0.0, -2.0, -2.0, -2.0, -3.0, -3.0])
    response = recorded_response(block, record, 0.01, "linear", history=True)
    assert np.all(response.rotation[:4] == 0.0)
    assert response.rotation[4] > 0.0


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
    block = Block(half_width=0.01, half_height=0.025, gravity=G)
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
    block = Block(half_width=0.4, half_height=2.0, restitution=0.9, gravity=G)
    other = Block(half_width=0.4, half_height=2.0, restitution=0.9, gravity=G + lift)
    lifted = recorded_response(block, record, 0.01, vertical=np.full(record.size, lift), history=True)
    heavier = recorded_response(other, record, 0.01, history=True)
    part = slice(0, 700)
    assert np.nanmax(np.abs(heavier.rotation[part])) > 0.01
    assert lifted.rotation[part] == pytest.approx(heavier.rotation[part], abs=1e-10, nan_ok=True)


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


def test_rectangular_pulse_overturns_from_housners_threshold():  # VALIDATION V13 (D), F6; convergence as V22
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9, gravity=G)
    threshold = {}
    for steps in (400, 800):
        dt = 1.0 / block.p / steps  # p t1 = 1
        pulse = np.concatenate([np.ones(steps + 1), np.zeros(2)])
        low, high = 1.2, 2.0
        for _ in range(40):
            middle = 0.5 * (low + high)
            over = recorded_response(block, pulse, dt, "linear", scale=middle * G * 0.1).outcome == Outcome.OVERTURNS
            low, high = (low, middle) if over else (middle, high)
        threshold[steps] = high
    extrapolated = 2.0 * threshold[800] - threshold[400]  # the falling ramp of one sample: first order
    assert extrapolated == pytest.approx(1.5819767, abs=2e-6)


def test_chatter_comes_to_rest_and_the_block_lifts_again():
    block = Block(half_width=0.3, half_height=1.5, restitution=0.5, gravity=G)
    pulse = 3.5 * np.sin(np.pi * np.arange(31) / 30)
    record = np.concatenate([pulse, np.zeros(400), pulse, np.zeros(400)])
    response = recorded_response(block, record, 0.01, history=True)
    assert response.outcome == Outcome.ROCKS
    assert response.rotation[425] == 0.0
    again = np.max(np.abs(response.rotation[431:]))
    assert again == np.max(np.abs(response.rotation[:431]))  # the second hop starts from rest, like the first


@pytest.mark.parametrize("equation", EQUATIONS)
def test_chatter_that_dies_out_in_the_sample_of_the_next_uplift(equation):
    block = Block.from_parameters(p=2.0, alpha=0.25, restitution=0.8, gravity=G)
    record = G * np.tan(0.25) * np.array([0.2, 1.2, 1.2, 0.2])
    chatter = recorded_response(block, record, 0.2, equation, initial_velocity=0.005, history=True)
    from_rest = recorded_response(block, record, 0.2, equation, history=True)
    assert from_rest.rotation[1] != 0.0
    assert chatter.impacts > from_rest.impacts
    assert chatter.rotation[1:] == pytest.approx(from_rest.rotation[1:], rel=1e-11)


def test_no_restitution_stops_at_the_first_impact():
    block = block_a(restitution=0.0)
    free = recorded_response(block, np.zeros(200), 0.01, initial_rotation=0.3 * block.alpha_c, history=True)
    assert free.impacts == 1
    assert np.all(free.rotation[60:] == 0.0)


def test_full_restitution_rocks_for_ever():
    block = block_a(restitution=1.0)
    free = recorded_response(block, np.zeros(2000), 0.01, initial_rotation=0.3 * block.alpha_c, history=True)
    assert free.outcome == Outcome.ROCKS
    assert free.impacts == -1
    assert np.max(np.abs(free.rotation[-200:])) == pytest.approx(0.3 * block.alpha_c, rel=1e-3)


def test_endless_chatter_is_unresolved_and_says_why():
    block = block_a(restitution=1.0)
    response = recorded_response(block, np.zeros(10), 0.01, "linear", initial_velocity=1e-9)
    assert response.outcome == Outcome.UNRESOLVED
    assert response.reason == Reason.IMPACT_LIMIT
    assert np.isnan(response.peak_rotation_ratio)


def test_vertical_acceleration_that_cancels_gravity_is_unresolved():
    record = np.full(20, 0.5)
    response = recorded_response(block_a(), record, 0.01, vertical=np.linspace(0.0, -12.0, 20))
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.FREE_FLIGHT)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_passing_the_critical_angle_alone_is_not_overturning(equation):
    block = block_b()
    start = {"initial_rotation": 1.05 * block.alpha_c, "initial_velocity": -0.2 * block.p * block.alpha_c}
    response = recorded_response(block, np.zeros(10), 0.01, equation, **start)
    assert response.outcome == Outcome.ROCKS
    assert response.peak_rotation_ratio == pytest.approx(1.05)


@pytest.mark.parametrize("equation", EQUATIONS)
def test_block_driven_back_too_fast_overturns_on_the_other_side(equation):
    block = block_b(restitution=0.95)
    start = {"initial_rotation": 0.5 * block.alpha_c, "initial_velocity": -1.5 * block.p * block.alpha_c}
    response = recorded_response(block, np.zeros(2), 0.01, equation, **start)
    assert response.outcome == Outcome.OVERTURNS
    assert response.overturning_half_cycle == 2
    marched = recorded_response(block, np.zeros(4000), 0.001, equation, **start)
    assert response.overturning_time == pytest.approx(
        marched.overturning_time, abs=1e-9 if equation == "nonlinear" else 2e-3
    )


def test_lanes_are_those_of_single_calls():
    blocks = Block(half_width=[0.2, 0.35, 0.5], half_height=2.0, gravity=G)
    record = synthetic(8, peak=3.0)
    factors = np.array([0.0, 0.6, 1.3])
    lanes = recorded_response(blocks, record, 0.01, scale=factors, history=True)
    assert lanes.peak_rotation_ratio.shape == (3, 3)
    assert lanes.rotation.shape == (3, 3, record.size)
    for i, factor in enumerate(factors):
        for j, half_width in enumerate((0.2, 0.35, 0.5)):
            single = recorded_response(Block(half_width, 2.0, gravity=G), record, 0.01, scale=factor, history=True)
            assert single.peak_rotation_ratio == lanes.peak_rotation_ratio[i, j]
            assert np.array_equal(single.rotation, lanes.rotation[i, j], equal_nan=True)
    assert np.all(lanes.outcome[0] == Outcome.AT_REST)
    assert recorded_response(blocks, record, 0.01).outcome.shape == (3,)
    assert recorded_response(Block(0.2, 2.0), record, 0.01, scale=factors).outcome.shape == (3,)


def test_history_after_overturning_is_nan_and_before_it_is_not():
    block = block_b()
    response = recorded_response(block, synthetic(9, peak=14.0), 0.01, history=True)
    assert response.outcome == Outcome.OVERTURNS
    before = response.time <= response.overturning_time
    assert np.all(np.isfinite(response.rotation[before]))
    assert np.all(np.isnan(response.rotation[~before]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"acceleration": [0.0]}, "at least 2 samples"),
        ({"acceleration": [0.0, np.nan, 1.0]}, "sample 1 is nan"),
        ({"acceleration": [[0.0, 1.0]]}, "shape"),
        ({"dt": 0.0}, "dt"),
        ({"dt": -0.01}, "dt"),
        ({"equation": "cubic"}, "equation"),
        ({"scale": -1.0}, "scale"),
        ({"vertical": [0.0, 0.0]}, "vertical: expected 3 samples"),
        ({"vertical": [0.0, 0.0, 0.0], "equation": "linear"}, "vertical"),
        ({"initial_rotation": np.nan}, "initial_rotation"),
    ],
)
def test_wrong_arguments_are_named(change, message):
    arguments = {"block": block_a(), "acceleration": [0.0, 1.0, 0.0], "dt": 0.01, **change}
    with pytest.raises(ValueError, match=message):
        recorded_response(**arguments)


def test_python_and_compiled_kernels_agree():
    code = (
        "import numpy as np; from rockpulse.models import Block, recorded_response\n"
        "t = np.arange(150) * 0.01; a = 3.0 * np.sin(7 * t)\n"
        "b = Block(0.3, 1.5, gravity=9.81)\n"
        "for e in ('linear', 'nonlinear'):\n"
        "    r = recorded_response(b, a, 0.01, e); print(repr(r.peak_rotation_ratio), r.outcome, r.impacts)\n"
    )
    outputs = [
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, **extra}, capture_output=True, text=True, check=True
        ).stdout.split()
        for extra in ({}, {"NUMBA_DISABLE_JIT": "1"})
    ]
    compiled, plain = outputs
    assert compiled[1::3] == plain[1::3]
    assert [float(x) for x in compiled[::3]] == pytest.approx([float(x) for x in plain[::3]], rel=1e-11)
