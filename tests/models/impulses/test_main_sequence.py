"""Resonance in closed form (F1, F2, V2, V3, V5-V7) with the erratum of Eqs. (5) and (9)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.body.block import Block
from rocking.impulses.half_cycle import hop
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.main_sequence import critical_impulse, critical_impulse_ratio, overturning_half_cycle, resonance
from rocking.response import IMPACT_CUTOFF, Outcome, Reason
from rocking.search.capacity import resonance_critical_scale

PROPERTY = settings(derandomize=True, deadline=None, max_examples=30)


def block(radius=2.0, restitution=0.9):
    return Block(half_width=0.5, half_height=np.sqrt(radius**2 - 0.25), restitution=restitution, gravity=9.81)


@pytest.mark.parametrize(
    ("radius", "restitution", "impulse", "time"),
    [
        (2, 0.9, 0.702507, 0.610045),
        (2, 0.6, 0.834228, 0.764511),
        (4, 0.9, 0.480892, 0.862735),
        (4, 0.6, 0.571059, 1.081182),
    ],
)
def test_second_half_cycle_has_the_critical_impulse_and_timing_of_v3(radius, restitution, impulse, time):
    body = block(radius, restitution)
    critical = critical_impulse(body, 2)
    assert critical == pytest.approx(impulse, abs=5e-7)
    response = resonance(body, critical, 5)
    assert response.overturning_half_cycle == 2  # u = 1 overturns
    assert response.overturning_time == pytest.approx(time, abs=5e-7)
    assert response.half_cycles.duration[0] == pytest.approx(time, abs=5e-7)


def test_bracket_of_eq_5_is_that_of_the_recurrence_not_the_printed_one():  # V5 (D)
    assert 1.0 / critical_impulse_ratio(np.full(1, 0.9), 1) == pytest.approx(1.0)
    brackets = [1.0 / critical_impulse_ratio(0.9, i) for i in range(1, 6)]
    assert brackets == pytest.approx([1.0, 1.9, 2.71, 3.439, 4.0951], rel=1e-14)


@pytest.mark.parametrize(
    ("restitution", "main", "half_cycle"),
    [
        (0.9, 0.3, 4),  # V6 (D)
        (0.9, 0.2, 7),
        (0.9, 0.15, 11),
        (0.9, 0.12, 18),
        (0.9, 0.11, 23),
        (0.9, 0.0999, -1),
        (0.6, 0.5, 4),
        (0.6, 0.45, 5),
        (0.6, 0.41, 8),
        (0.6, 0.3, -1),
    ],
)
def test_overturning_half_cycle_of_v6(restitution, main, half_cycle):
    assert overturning_half_cycle(main, restitution) == half_cycle
    body = block(2.0, restitution)
    response = resonance(body, main * body.critical_impulse, 40)
    assert response.overturning_half_cycle == half_cycle
    assert response.outcome == (Outcome.ROCKS if half_cycle < 0 else Outcome.OVERTURNS)


@pytest.mark.parametrize("restitution", [0.1, 0.4, 0.6, 0.9, 0.99])
def test_main_impulse_of_one_less_restitution_never_overturns_whatever_its_rounding(restitution):
    for main in (1.0 - restitution, float(f"{1.0 - restitution:.6f}"), (1.0 - restitution) * 0.999):
        assert overturning_half_cycle(main, restitution) == -1
    assert overturning_half_cycle((1.0 - restitution) * (1.0 + 1e-9), restitution) > 1


@pytest.mark.parametrize(("main", "half_cycle"), [(1.0, 1), (2.0, 1), (0.5, 2), (0.3, 4), (0.1, 10), (1e-12, 10**12)])
def test_without_losses_half_cycles_add_up(main, half_cycle):
    assert overturning_half_cycle(main, 1.0) == half_cycle


@pytest.mark.parametrize(("main", "half_cycle"), [(0.999, -1), (1.0, 1), (3.0, 1), (0.0, -1)])
def test_without_rebound_only_a_critical_impulse_overturns(main, half_cycle):
    assert overturning_half_cycle(main, 0.0) == half_cycle


@PROPERTY
@given(st.floats(0.01, 1.2), st.floats(0.0, 1.0))
def test_closed_form_agrees_with_the_recurrence(main, restitution):
    velocity, expected = main, -1
    for half_cycle in range(1, 2000):
        if velocity >= 1.0 - 1e-13:
            expected = half_cycle
            break
        velocity = restitution * velocity + main
    # Next to the limit velocity the recurrence cannot tell "never" from "late": leave it out.
    if abs(main - (1.0 - restitution)) > 1e-6 and not (expected < 0 and main > 1.0 - restitution):
        assert overturning_half_cycle(main, restitution) == expected


def test_stabilised_motion_of_v7():  # V7 (D)
    body = block(2.0, 0.6)
    response = resonance(body, 0.3 * body.critical_impulse, 200)
    assert response.outcome == Outcome.ROCKS
    assert response.peak_rotation_ratio == pytest.approx(0.338562, abs=5e-7)
    assert response.half_cycles.start_velocity[-1] == pytest.approx(0.75, abs=1e-12)
    assert response.half_cycles.duration[-1] * body.p == pytest.approx(1.945910, abs=5e-7)


def test_table_holds_the_half_cycles_of_eqs_6_and_7():
    body = block(2.0, 0.9)
    table = resonance(body, 0.2 * body.critical_impulse, 50).half_cycles
    velocities = 0.2 * (1.0 - 0.9 ** np.arange(1, 8)) / 0.1
    assert table.start_velocity == pytest.approx(velocities, rel=1e-14)
    assert table.peak[:6] == pytest.approx(1.0 - np.sqrt(1.0 - velocities[:6] ** 2), rel=1e-12)
    assert table.duration[:6] == pytest.approx(2.0 * np.arctanh(velocities[:6]) / body.p, rel=1e-13)
    assert np.isinf([table.peak[6], table.duration[6]]).all()
    assert table.impact_speed[:6] == pytest.approx(velocities[:6], rel=1e-14)
    assert np.isnan(table.impact_speed[6])
    assert table.impulse_count.tolist() == [0] * 7


def test_impacts_are_counted_down_to_the_cut_off():
    body = block(2.0, 0.6)
    response = resonance(body, 0.3 * body.critical_impulse, 3)
    last = 0.3 * (1.0 - 0.6**3) / 0.4
    assert response.impacts == 3 + np.sum(last * 0.6 ** np.arange(1, 60) > IMPACT_CUTOFF)


def test_half_cycles_start_only_before_the_duration():
    body = block(2.0, 0.9)
    impulse = 0.2 * body.critical_impulse
    starts = np.cumsum(resonance(body, impulse, 20).half_cycles.duration[:6])
    before = resonance(body, impulse, None, duration=starts[2])
    after = resonance(body, impulse, None, duration=starts[2] * (1.0 + 1e-12))
    assert before.half_cycles.start_velocity.size == 3  # a start at the duration itself is too late
    assert after.half_cycles.start_velocity.size == 4
    assert before.outcome == after.outcome == Outcome.ROCKS
    assert resonance(body, impulse, None, duration=starts[5] * (1.0 + 1e-12)).overturning_half_cycle == 7
    assert resonance(body, impulse, 6, duration=1e3).outcome == Outcome.ROCKS


def test_long_resonance_is_counted_and_not_followed():
    body = block(2.0, 0.6)
    response = resonance(body, 0.3 * body.critical_impulse, 10**15)
    assert response.impacts > 10**15
    assert response.peak_rotation_ratio == pytest.approx(hop(0.75)[0], rel=1e-12)


@pytest.mark.sweep
def test_more_half_cycles_than_can_be_added_up_are_unresolved():
    body = block(2.0, 1.0)
    response = resonance(body, 1e-9 * body.critical_impulse, 10**8, table_rows=0)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.HALF_CYCLE_LIMIT)
    assert np.isnan([response.peak_rotation_ratio, response.overturning_time]).all()
    assert (response.overturning_half_cycle, response.impacts) == (-1, -1)


def test_no_impulse_leaves_the_block_at_rest():
    response = resonance(block(), 0.0, 5)
    assert (response.outcome, response.peak_rotation_ratio, response.impacts) == (Outcome.AT_REST, 0.0, 0)
    assert response.overturning_half_cycle == -1
    assert np.isnan(response.overturning_time)


def test_small_impulse_gives_similar_blocks_the_same_top_displacement():  # V18 (P)
    sizes = np.array([1.0, 2.0, 4.0, 8.0])
    bodies = Block(half_width=0.25 * sizes, half_height=sizes, restitution=0.9, gravity=9.81)
    impulse = 0.09 * bodies.critical_impulse[0]
    response = resonance(bodies, impulse, 1)
    displacement = 2.0 * bodies.radius * response.peak_rotation_ratio * bodies.alpha_c
    assert np.ptp(displacement) < 0.01 * displacement.mean()


def test_lanes_are_every_impulse_on_every_block():
    bodies = Block(half_width=0.5, half_height=[2.0, 3.0, 4.0], restitution=[0.5, 0.7, 0.9], gravity=9.81)
    impulses = np.array([0.1, 0.4])
    response = resonance(bodies, impulses, 6)
    assert response.peak_rotation_ratio.shape == (2, 3)
    for q, impulse in enumerate(impulses):
        for m in range(3):
            single = resonance(bodies.lane(m), impulse, 6)
            assert response.peak_rotation_ratio[q, m] == single.peak_rotation_ratio
            rows = single.half_cycles.start_velocity.size
            assert np.array_equal(response.half_cycles.start_velocity[:rows, q, m], single.half_cycles.start_velocity)
    assert resonance(bodies.lane(0), impulses, 6).impacts.shape == (2,)
    assert resonance(bodies, 0.1, 6).half_cycles.peak.shape[1:] == (3,)
    assert isinstance(resonance(bodies.lane(0), 0.1, 6).peak_rotation_ratio, float)


def safety(body, half_cycles, duration):
    """The smallest scale factor on main impulses of 0.3 m/s that overturns a body."""
    sequence = ImpulseSequence(0.3, 0.0, np.nan, duration or np.inf, half_cycles, spacing="continuous")
    return resonance_critical_scale(body, sequence, 1e9).safety_factor[0]


@pytest.mark.parametrize("restitution", [0.0, 0.6, 0.9, 0.98, 1.0])
@pytest.mark.parametrize(
    ("half_cycles", "duration"), [(1, None), (4, None), (None, 3.0), (None, 20.0), (6, 5.0), (3, 20.0)]
)
def test_safety_factor_is_the_smallest_that_overturns_in_a_scan(restitution, half_cycles, duration):
    body = block(2.0, restitution)
    factor = safety(body, half_cycles, duration)
    scan = factor * np.concatenate([np.geomspace(0.02, 1.0 - 1e-9, 3000), np.linspace(1.0, 1.0 + 1e-6, 5)])
    outcome = resonance(body, 0.3 * scan, half_cycles, duration, table_rows=0).outcome
    assert np.all(outcome[:-5] == Outcome.ROCKS)
    assert outcome[-1] == Outcome.OVERTURNS


@pytest.mark.parametrize(
    ("impulse", "half_cycles", "duration", "message"),
    [
        (-0.1, 3, None, "impulse"),
        (np.nan, 3, None, "impulse"),
        ([[0.1, 0.2]], 3, None, r"impulse: expected a finite number or a \(q,\) array"),
        (0.1, 3, [[0.5]], r"duration: expected a positive number or a \(q,\) array"),
        (0.1, 0, None, "half_cycles"),
        (0.1, 2.5, None, "half_cycles"),
        (0.1, None, None, "half_cycles"),
        (0.1, None, np.inf, "half_cycles"),
        (0.1, 3, 0.0, "duration"),
        (0.1, 3, np.nan, "duration"),
    ],
)
def test_bad_arguments_are_named(impulse, half_cycles, duration, message):
    with pytest.raises(ValueError, match=message):
        resonance(block(), impulse, half_cycles, duration)


def test_negative_table_length_is_refused():
    with pytest.raises(ValueError, match="table_rows"):
        resonance(block(), 0.1, 3, table_rows=-1)
