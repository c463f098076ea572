"""Response to given impulses (F1, F5, F9, no-return and rest rules); a slow march is in test_impulsive_lanes.py."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.body.block import Block
from rocking.impulses.impulsive import GAINS, impulsive_response
from rocking.march.recorded import recorded_response
from rocking.response import IMPACT_CUTOFF, Outcome

PROPERTY = settings(derandomize=True, deadline=None, max_examples=30)
G = 9.81


def block(radius=2.0, restitution=0.6):
    return Block(half_width=0.5, half_height=np.sqrt(radius**2 - 0.25), restitution=restitution, gravity=G)


def random_train(seed, body, strength, count=7, length=5.0):
    rng = np.random.default_rng(seed)
    return np.sort(rng.uniform(0.0, length, count)), strength * body.critical_impulse * rng.normal(size=count)


@pytest.mark.parametrize("gain", sorted(GAINS))
def test_one_impulse_overturns_from_the_critical_one_of_its_gain(gain):  # F1
    body = block()
    ratio = {"linear": math.cos(body.alpha_c), "tangent": math.sin(body.alpha_c) / body.alpha_c}.get(gain, 1.0)
    critical = ratio * body.critical_impulse
    at = impulsive_response(body, [2.0], [critical], gain=gain)
    assert (at.outcome, at.overturning_half_cycle, at.overturning_time) == (Outcome.OVERTURNS, 1, 2.0)
    below = impulsive_response(body, [2.0], [critical * (1.0 - 1e-9)], gain=gain)
    assert below.outcome == Outcome.ROCKS
    assert below.peak_rotation_ratio == pytest.approx(1.0 - math.sqrt(2e-9), rel=1e-7)


@PROPERTY
@given(st.integers(0, 10_000), st.floats(0.05, 0.6))
def test_history_changes_nothing_and_lies_on_the_natural_motion(seed, strength):
    body = block(2.0, 0.8)
    times, impulses = random_train(seed, body, strength)
    plain = impulsive_response(body, times, impulses)
    response = impulsive_response(body, times, impulses, duration=6.0, history_dt=1e-2)
    assert plain.outcome == response.outcome
    assert plain.impacts == response.impacts
    assert plain.peak_rotation_ratio == response.peak_rotation_ratio
    assert response.time.size == 601
    if plain.outcome == Outcome.ROCKS:
        assert np.abs(response.rotation).max() <= plain.peak_rotation_ratio * body.alpha_c * (1.0 + 1e-12)
    # theta'^2 - p^2 (alpha - abs(theta))^2 is kept between impulses and impacts.
    energy = response.velocity**2 - (body.p * (body.alpha_c - np.abs(response.rotation))) ** 2
    side = np.sign(response.rotation)
    event = np.searchsorted(times, response.time)
    same = (side[1:] == side[:-1]) & (event[1:] == event[:-1]) & (side[1:] != 0) & (np.abs(energy[1:]) < 1.0)
    change = np.diff(energy)[same]
    assert np.all(change < 1e-12)  # impacts inside a step can only take energy away


def test_history_is_at_rest_before_the_first_impulse_and_gone_once_the_block_lies():
    body = block()
    response = impulsive_response(body, [1.0], [3.0 * body.critical_impulse], duration=10.0, history_dt=0.5)
    assert np.all(response.rotation[:3] == 0.0)
    assert response.velocity[2] == pytest.approx(-3.0 * body.p * body.alpha_c)
    assert np.all(np.isnan(response.rotation[-10:]))
    assert np.nanmin(response.rotation) > -0.5 * np.pi


def test_a_history_has_its_last_sample_and_ends_with_the_input():
    body = block()
    for train, duration, step, time in (
        (([0.0], [0.1]), 0.3, 0.1, [0.0, 0.1, 0.2, 0.3]),  # 0.3/0.1 is less than 3 by a bit
        (([0.2, 0.7], [0.1, 0.1]), None, 0.3, [0.0, 0.3, 0.6]),
        (([0.2, 0.7], [0.1, 0.1]), 0.4, 0.3, [0.0, 0.3]),
        (([-2.0, -1.0], [0.1, 0.1]), None, 0.8, [-2.0, -1.2, -0.4]),
        (([-0.5], [0.1]), 1.0, 0.5, [-0.5, 0.0, 0.5, 1.0]),
        (([], []), None, 0.5, [0.0]),
        (([], []), 1.2, 0.5, [0.0, 0.5, 1.0]),
    ):
        found = impulsive_response(body, *train, duration, history_dt=step)
        assert found.time == pytest.approx(time, abs=1e-12)
        assert found.rotation.shape == found.velocity.shape == (len(time),)
    assert impulsive_response(body, [0.0], [0.1]).time is None


def test_passing_the_critical_angle_is_not_overturning():
    body = block()
    unit = body.critical_impulse
    # u = 1.2 overturns alone; beyond alpha_c a push against it makes the growing mode negative: the block comes back.
    growing, decaying = 0.2 * math.exp(2.5), -2.2 * math.exp(-2.5)
    rotation = 1.0 + 0.5 * (growing + decaying)
    assert rotation > 2.0
    assert impulsive_response(body, [0.0], [1.2 * unit]).outcome == Outcome.OVERTURNS
    saved = impulsive_response(body, [0.0, 2.5 / body.p], [1.2 * unit, -(growing + 0.3) * unit])
    assert saved.outcome == Outcome.ROCKS
    assert saved.peak_rotation_ratio == pytest.approx(rotation, rel=1e-12)


def test_fast_fall_from_beyond_the_critical_angle_may_overturn_to_the_other_side():
    body = block(2.0, 0.9)
    unit = body.critical_impulse
    response = impulsive_response(body, [0.0, 2.5 / body.p], [1.2 * unit, -4.0 * unit])
    growing, decaying = 0.2 * math.exp(2.5) - 4.0, -2.2 * math.exp(-2.5) + 4.0
    speed = math.sqrt(1.0 - growing * decaying)
    assert 0.9 * speed > 1.0
    assert (response.outcome, response.overturning_half_cycle) == (Outcome.OVERTURNS, 2)
    impact = (2.5 + math.log((1.0 + speed) / -growing)) / body.p
    assert response.overturning_time == pytest.approx(impact, rel=1e-12)


def test_overturning_is_certain_only_when_later_impulses_cannot_prevent_it():
    body = block()
    unit = body.critical_impulse
    wait = 1.0 / body.p
    needed = 0.2 * math.exp(1.0)  # what takes the growing mode of u = 1.2 back to zero after that wait
    too_weak = impulsive_response(body, [0.0, wait], [1.2 * unit, -0.999 * needed * unit])
    assert (too_weak.outcome, too_weak.overturning_time) == (Outcome.OVERTURNS, 0.0)
    enough = impulsive_response(body, [0.0, wait], [1.2 * unit, -1.001 * needed * unit])
    assert enough.outcome == Outcome.ROCKS
    other_way = impulsive_response(body, [0.0, wait], [1.2 * unit, 1.001 * needed * unit])
    assert (other_way.outcome, other_way.overturning_time) == (Outcome.OVERTURNS, wait)


def test_block_whose_hops_have_died_out_starts_from_rest():
    body = block(2.0, 0.6)
    first, second = 0.5 * body.critical_impulse, 0.3 * body.critical_impulse
    alone = impulsive_response(body, [0.0], [second])
    after = impulsive_response(body, [0.0, 30.0], [first, second])
    before = impulsive_response(body, [0.0], [first])
    assert after.impacts == before.impacts + alone.impacts
    assert after.peak_rotation_ratio == before.peak_rotation_ratio


def test_empty_train_and_zero_impulses_leave_the_block_at_rest():
    for times, impulses in (([], []), ([0.0, 1.0], [0.0, -0.0])):
        response = impulsive_response(block(), times, impulses, duration=1.0, history_dt=0.5)
        assert (response.outcome, response.peak_rotation_ratio, response.impacts) == (Outcome.AT_REST, 0.0, 0)
        assert response.overturning_half_cycle == -1
        assert np.isnan(response.overturning_time)
        assert response.rotation.tolist() == [0.0, 0.0, 0.0]


def test_impulse_right_after_an_impact_is_the_resonant_one():  # section 2
    body = block(2.0, 0.6)
    unit = body.critical_impulse
    landing = 2.0 * math.atanh(0.4) / body.p
    for shift in (-0.4e-9, 0.0, 0.4e-9):
        response = impulsive_response(body, [0.0, landing + shift], [0.4 * unit, -0.3 * unit])
        assert response.peak_rotation_ratio == pytest.approx(1.0 - math.sqrt(1.0 - 0.54**2), abs=1e-8)


def test_impulse_against_the_motion_at_an_impact_acts_before_it():
    body = block(2.0, 0.6)
    unit = body.critical_impulse
    landing = 2.0 * math.atanh(0.4) / body.p
    slowed = impulsive_response(body, [0.0, landing], [0.4 * unit, 0.3 * unit])
    assert slowed.impacts == 1 + np.sum(0.1 * 0.6 ** np.arange(1, 40) > IMPACT_CUTOFF)
    thrown = impulsive_response(body, [0.0, landing], [0.4 * unit, 0.9 * unit])  # back up on the same side with u = 0.5
    assert thrown.peak_rotation_ratio == pytest.approx(1.0 - math.sqrt(0.75), rel=1e-9)


def test_order_of_impulses_at_an_impact_decides():
    body = block(2.0, 0.6)
    unit = body.critical_impulse
    landing = 2.0 * math.atanh(0.4) / body.p
    times = [0.0, landing, landing]
    before = impulsive_response(body, times, np.array([0.4, 0.2, -0.3]) * unit)  # C (0.4 - 0.2) + 0.3
    after = impulsive_response(body, times, np.array([0.4, -0.3, 0.2]) * unit)  # C 0.4 + 0.3 - 0.2
    assert before.peak_rotation_ratio == pytest.approx(1.0 - math.sqrt(1.0 - 0.42**2), rel=1e-12)
    assert after.impacts == 1 + np.sum(0.34 * 0.6 ** np.arange(40) > IMPACT_CUTOFF)


def test_scale_factors_and_blocks_are_lanes():
    bodies = Block(half_width=0.5, half_height=[2.0, 3.0, 4.0], restitution=[0.6, 0.7, 0.9], gravity=G)
    times, impulses = random_train(3, bodies.lane(0), 0.3)
    scale = np.array([0.0, 1.0, 2.5])
    response = impulsive_response(bodies, times, impulses, 6.0, scale=scale, history_dt=0.5)
    assert response.outcome.shape == (3, 3)
    assert response.rotation.shape == (3, 3, 13)
    assert np.all(response.outcome[0] == Outcome.AT_REST)
    for q in range(3):
        for m in range(3):
            single = impulsive_response(bodies.lane(m), times, scale[q] * impulses, 6.0, history_dt=0.5)
            assert response.peak_rotation_ratio[q, m] == pytest.approx(single.peak_rotation_ratio, rel=1e-9)
            assert response.rotation[q, m] == pytest.approx(single.rotation, abs=1e-9, nan_ok=True)


def pulses(times, impulses, width, dt, length):
    """Accelerogram of triangles of the given impulses centred at the given times."""
    t = dt * np.arange(round(length / dt) + 1)
    shape = np.maximum(1.0 - np.abs(np.subtract.outer(t, times)) / width, 0.0) / width
    return shape @ impulses


@pytest.mark.parametrize(("gain", "equation", "slenderness"), [("linear", "linear", 4.0), ("exact", "nonlinear", 40.0)])
def test_narrow_half_waves_tend_to_impulses(gain, equation, slenderness):  # F9
    # Slender, so that the linear natural motion between the impulses is that of the nonlinear equation as well.
    body = Block.from_parameters(p=2.0, alpha=1.0 / slenderness, restitution=0.7, gravity=G)
    times = np.array([0.2, 0.5, 1.1])
    impulses = body.critical_impulse * np.array([0.4, -0.2, -0.15])
    expected = impulsive_response(body, times, impulses, gain=gain).peak_rotation_ratio
    errors = []
    for width in (0.01, 0.005, 0.0025):
        record = pulses(times, impulses, width, width / 10.0, 1.5)
        found = recorded_response(body, record, width / 10.0, equation=equation)
        errors.append(found.peak_rotation_ratio / expected - 1.0)
    # First order: before the uplift a share g alpha of the pulse, as long as it is wide, does not push the block.
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.03)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.02)
    assert 2.0 * errors[2] - errors[1] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("times", "impulses", "options", "message"),
    [
        ([0.0, np.nan], [0.1, 0.1], {}, "times: .*index 1"),
        ([0.0, 1.0], [0.1, np.inf], {}, "impulses: .*index 1"),
        ([0.0, 1.0], [0.1], {}, "expected two"),
        (0.0, 0.1, {}, "expected two"),
        ([0.0], [0.1], {"gain": "large"}, "gain"),
        ([0.0], [0.1], {"duration": 0.0}, "duration"),
        ([0.0], [0.1], {"history_dt": 0.0}, "history_dt"),
        ([0.0], [0.1], {"scale": np.nan}, "scale"),
        ([0.0], [0.1], {"scale": [[1.0]]}, "scale"),
        ([0.0], [0.1], {"block_scale": [1.0]}, "block_scale: expected a scale factor, or an array"),
        ([0.0], [0.1], {"block_scale": np.inf}, "block_scale: expected a scale factor, finite"),
        ([0.0, 0.0, 3.0, 2.0, 1.0], [0.1] * 5, {}, r"got 3\.0 s before 2\.0 s at index 2"),
    ],
)
def test_bad_arguments_are_named(times, impulses, options, message):
    with pytest.raises(ValueError, match=message):
        impulsive_response(block(), times, impulses, **options)
