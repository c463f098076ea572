"""Response to a sampled accelerogram; an independent integrator is in test_body_reference.py."""

import numpy as np
import pytest
from recorded_cases import EQUATIONS, G, block_a, block_b, synthetic

from rocking import Block, Outcome, Reason, ground_demand, recorded_response


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


@pytest.mark.parametrize("equation", EQUATIONS)
def test_threshold_of_any_block_is_not_passed_by_rounding(equation):
    half_widths = np.linspace(0.1, 1.5, 40)
    blocks = Block(half_width=half_widths, half_height=2.5)
    thresholds = blocks.gravity * (blocks.alpha_c if equation == "linear" else np.tan(blocks.alpha_c))
    for lane, threshold in enumerate(thresholds):
        for factor in (1.0, 0.7, 1.3):
            record = np.full(5, threshold / factor)
            at = recorded_response(blocks.lane(lane), record, 0.01, equation, scale=[factor, factor * (1 + 1e-12)])
            assert at.outcome.tolist() == [Outcome.AT_REST, Outcome.ROCKS]


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


def test_scale_acts_on_the_vertical_as_well():
    record, up = synthetic(6, peak=2.0), synthetic(2, peak=3.0)
    block = block_b()
    scaled = recorded_response(block, record, 0.01, scale=1.3, vertical=up, history=True)
    direct = recorded_response(block, 1.3 * record, 0.01, vertical=1.3 * up, history=True)
    assert np.max(np.abs(direct.rotation)) > 0.1 * block.alpha_c
    assert scaled.rotation == pytest.approx(direct.rotation, abs=1e-9)


def test_free_flight_on_the_very_last_sample_is_seen():
    lift = np.zeros(20)
    lift[-1] = -1.01 * G
    response = recorded_response(block_a(), np.zeros(20), 0.01, vertical=lift)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.FREE_FLIGHT)
    assert response.impacts == -1


def test_linear_block_beyond_return_overturns_at_once():
    block = block_b()
    response = recorded_response(block, np.zeros(20), 0.01, "linear", initial_rotation=3.0 * block.alpha_c)
    assert (response.outcome, response.overturning_time, response.overturning_half_cycle) == (Outcome.OVERTURNS, 0.0, 1)


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
        ({"equation": "cubic"}, "equation"),
        ({"vertical": [0.0, 0.0]}, "vertical: expected 3 samples"),
        ({"vertical": [0.0, 0.0, 0.0], "equation": "linear"}, "vertical"),
        ({"initial_rotation": np.nan}, "initial_rotation"),
        (
            {"initial_rotation": [0.0, 0.1], "block": Block(half_width=[0.5, 0.6, 0.7], half_height=2.0)},
            "one for each of the blocks",
        ),
        ({"acceleration": ["a", "b"]}, "acceleration: expected"),
        ({"scale": "a"}, "scale: expected"),
        ({"scale": [1.0, 1e300]}, "m/s2"),
        ({"dt": "a"}, "dt: expected"),
        ({"block": 3.0}, "block: expected"),
        ({"gain": "paper"}, "gain"),
        ({"gain": "tangent"}, "gain: expected 'linear', or 'tangent' with equation='linear'"),
        ({"step": 0.0}, "step"),
        ({"threads": 0}, "threads"),
        ({"equation": ["linear"]}, "equation"),
    ],
)
def test_wrong_arguments_are_named(change, message):
    arguments = {"block": block_a(), "acceleration": [0.0, 1.0, 0.0], "dt": 0.01, **change}
    with pytest.raises(ValueError, match=message):
        recorded_response(**arguments)


def test_tangent_gain_is_a_factor_on_the_record_and_brings_the_linear_equation_near_the_nonlinear_one():
    block = Block.from_parameters(p=np.linspace(1.0, 4.0, 40), alpha=0.2, restitution=0.85)
    motion = synthetic(peak=4.0)
    tangent = recorded_response(block, motion, 0.01, "linear", gain="tangent").peak_rotation_ratio
    scaled = recorded_response(block, motion, 0.01, "linear", scale=0.2 / np.tan(0.2)).peak_rotation_ratio
    assert tangent == pytest.approx(scaled, rel=1e-9)
    plain = recorded_response(block, motion, 0.01, "linear").peak_rotation_ratio
    truth = recorded_response(block, motion, 0.01, "nonlinear").peak_rotation_ratio
    rocks = np.isfinite(tangent) & np.isfinite(plain) & np.isfinite(truth) & (truth > 0.05)
    assert np.count_nonzero(rocks) > 10
    far, near = (np.median(np.abs(np.log(model[rocks] / truth[rocks]))) for model in (plain, tangent))
    assert near < 0.3 * far


@pytest.mark.parametrize("equation", EQUATIONS)
@pytest.mark.parametrize("excess", [1.0001, 1.001, 1.01, 1.05])
def test_small_motion_with_hardly_any_loss_is_resolved_with_and_without_history(equation, excess):
    block = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9999, gravity=G)
    threshold = 0.1 if equation == "linear" else np.tan(0.1)
    pulse = np.zeros(3000)
    pulse[1] = excess * threshold * G
    plain = recorded_response(block, pulse, 0.01, equation)
    traced = recorded_response(block, pulse, 0.01, equation, history=True)
    assert plain.outcome == traced.outcome == Outcome.ROCKS
    assert plain.peak_rotation_ratio == traced.peak_rotation_ratio
    assert plain.impacts == traced.impacts


@pytest.mark.parametrize(
    ("name", "kept", "refused"),
    [
        ("step", 0.3, 0.3001),
        ("last_term", 1e-17, 0.9e-17),
        ("last_term", np.inf, -1.0),
        ("dt", 0.9999e4 / 2.0, 1.0001e4 / 2.0),
        ("dt", 1e-9, 0.0),
        ("initial_velocity", 0.9999e3 * 2.0, 1.0001e3 * 2.0),
        ("initial_velocity", -0.9999e3 * 2.0, -1.0001e3 * 2.0),
        ("acceleration", [0.0, 0.9999e7 * 9.80665], [0.0, 1.0001e7 * 9.80665]),
        ("acceleration", [0.0, -0.9999e7 * 9.80665], [0.0, -1.0001e7 * 9.80665]),
        ("vertical", [0.0, 0.9999e7 * 9.80665], [0.0, 1.0001e7 * 9.80665]),
        ("vertical", [0.0, -0.9999e7 * 9.80665], [0.0, -1.0001e7 * 9.80665]),
        ("scale", [0.0, 0.9999e7 * 9.80665 / 3.0], [0.0, 1.0001e7 * 9.80665 / 3.0]),
        ("block_scale", 0.9999e7 * 9.80665 / 3.0, 1.0001e7 * 9.80665 / 3.0),
        ("scale", 0.0, -1e-12),
        ("block_scale", 0.0, -1e-12),
    ],
)
def test_arguments_are_taken_up_to_their_limits(name, kept, refused):
    """Of a body of p = 2, of the ground up to 10^7 g with its factors, of a sample up to p dt = 10^4."""
    given = {"block": Block.from_parameters(2.0, 0.2, 0.5, log=False), "acceleration": [0.0, 3.0], "dt": 0.01}
    assert np.isin(recorded_response(**given | {name: kept}).outcome, list(Outcome)).all()
    with pytest.raises(ValueError, match=f"{name}: |acceleration, scale: expected at most 1e\\+07 times gravity"):
        recorded_response(**given | {name: refused})


def test_a_weak_record_may_have_a_large_factor():
    """A thousandth of 1 m/s2 times 10^9, with a vertical of as much or without."""
    body = Block.from_parameters(2.0, 0.2, 0.5, log=False)
    for up in (None, [0.0, 1e-3], [0.0, -1e-3]):
        assert recorded_response(body, [0.0, 1e-3], 0.01, scale=1e9, vertical=up).outcome in list(Outcome)


def test_a_factor_of_a_block_below_one_leaves_the_limit_of_the_record():
    """The record itself has to be one of a ground: 10^7 g times a thousandth are refused, too."""
    body = Block.from_parameters(2.0, 0.2, 0.5, log=False)
    with pytest.raises(ValueError, match="acceleration, scale"):
        recorded_response(body, [0.0, 1.0001e7 * 9.80665], 0.01, block_scale=1e-3)


def test_a_verdict_is_that_of_this_record_on_these_free_blocks_at_rest():
    record = synthetic(4, peak=3.0)
    blocks = Block.from_parameters([1.5, 3.0, 5.0], 0.2, 0.9, log=False)
    demand = ground_demand(blocks, record, 0.01)
    early, whole = (
        recorded_response(blocks, record, 0.01, block_scale=[0.5, 1.0, 4.0], verdict=one) for one in (demand, None)
    )
    assert early.outcome.tolist() == whole.outcome.tolist()
    assert len(set(whole.outcome.tolist())) > 1
    wall = Block.stack([blocks.lane(0), blocks.lane(1), Block(width=0.5, height=2.0, one_sided=True)])
    for change, message in (
        (
            {"acceleration": record[:-1]},
            f"this record .{record.size - 1} samples. on these 3 blocks, got that of {record.size}",
        ),
        ({"block": blocks.take(np.array([0, 1]))}, "on these 2 blocks, got that of .* on 3 blocks"),
        ({"block": wall}, "free-standing symmetric blocks"),
        ({"vertical": 0.0 * record}, "without vertical and without history"),
        ({"history": True}, "without vertical and without history"),
        ({"equation": "linear"}, "without vertical and without history"),
        ({"initial_rotation": [0.0, 0.0, 0.01]}, "at rest"),
        ({"initial_velocity": [0.0, 0.0, 0.01]}, "at rest"),
        ({"verdict": 3.0}, "expected a rocking.Demand"),
    ):
        given = {"block": blocks, "acceleration": record, "dt": 0.01, "verdict": demand}
        with pytest.raises(ValueError, match=message):
            recorded_response(**given | change)
