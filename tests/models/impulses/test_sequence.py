"""Main and secondary sequence (F3, F4, F9, V9), the limit accelerogram and the steady state (V7, V10)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.body.block import Block
from rocking.impulses.half_cycle import first_return
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rocking.impulses.impulsive import impulsive_response
from rocking.impulses.main_sequence import resonance
from rocking.impulses.sequence import impulse_train, sequence_response, steady_state
from rocking.response import Outcome, Reason

PROPERTY = settings(derandomize=True, deadline=None, max_examples=30)


def block(radius=2.0, restitution=0.9):
    return Block(half_width=0.5, half_height=np.sqrt(radius**2 - 0.25), restitution=restitution, gravity=9.81)


def sequence(body, main, ratio, interval=0.1, duration=20.0, **options):
    """A sequence by u_1 = I/I_1c and I_s/I."""
    impulse = main * body.critical_impulse
    return ImpulseSequence(impulse, ratio * impulse, interval, duration, **options)


@pytest.mark.parametrize("radius", [2.0, 4.0])
@pytest.mark.parametrize(("restitution", "half_cycles"), [(0.9, [2, 3, 4, 4, 5, 7]), (0.6, [2, 4, 6, -1, -1, -1])])
def test_overturning_half_cycle_of_v9(radius, restitution, half_cycles):  # V9 (D), I = I_2c, n -> infinity
    body = block(radius, restitution)
    found = [
        sequence_response(
            body, sequence(body, 1.0 / (1.0 + restitution), ratio, np.nan, np.inf, spacing="continuous")
        ).overturning_half_cycle
        for ratio in (0.0, 0.3, 0.4, 0.5, 0.6, 0.7)
    ]
    assert found == half_cycles


def test_secondary_impulses_calm_the_motion_and_restitution_and_main_impulse_stir_it():  # V9, trends (P)
    ratios = np.linspace(0.3, 0.7, 9)
    peaks = {}
    for restitution in (0.5, 0.6):
        for main in (0.3, 0.4):
            body = block(2.0, restitution)
            sequences = sequence(body, np.full(9, main), ratios, np.nan, spacing="continuous")
            peaks[restitution, main] = sequence_response(body, sequences).peak_rotation_ratio
            assert np.all(np.diff(peaks[restitution, main]) < 0.0)
    assert np.all(peaks[0.6, 0.3] > peaks[0.5, 0.3])
    assert np.all(peaks[0.5, 0.4] > peaks[0.5, 0.3])


@pytest.mark.sweep
@PROPERTY
@given(st.floats(0.01, 1.2), st.sampled_from([0.0, 0.3, 0.6, 0.9, 0.97]), st.sampled_from(sorted(SPACINGS)))
def test_without_secondary_impulses_it_is_resonance(main, restitution, spacing):
    body = block(2.0, restitution)
    found = sequence_response(body, sequence(body, main, 0.0, spacing=spacing))
    expected = resonance(body, main * body.critical_impulse, None, duration=20.0)
    assert found.outcome == expected.outcome
    assert found.overturning_half_cycle == expected.overturning_half_cycle
    assert found.impacts == expected.impacts
    if found.outcome == Outcome.ROCKS:
        assert found.peak_rotation_ratio == pytest.approx(expected.peak_rotation_ratio, rel=1e-9)
    else:
        assert found.overturning_time == pytest.approx(expected.overturning_time, rel=1e-9)
        assert found.peak_rotation_ratio == np.inf


@pytest.mark.sweep
@pytest.mark.parametrize("restitution", [0.6, 0.9, "housner"])
@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.3, 0.5, 0.65])
@pytest.mark.parametrize("spacing", sorted(SPACINGS))
def test_train_fed_to_the_impulsive_model_gives_the_sequence_back(spacing, ratio, restitution):
    body = block(2.0, restitution)
    critical = 1.0 / (1.0 + body.restitution)
    for main in (0.02, 0.2, 0.35, critical, 0.8, 1.1, 1.3):
        for count in (None, 3):
            given_sequence = sequence(body, main, ratio, spacing=spacing, main_count=count)
            expected = sequence_response(body, given_sequence)
            times, impulses = impulse_train(body, given_sequence)
            found = impulsive_response(body, times, impulses)
            assert found.outcome == expected.outcome
            assert found.impacts == expected.impacts
            assert found.overturning_half_cycle == expected.overturning_half_cycle
            assert found.peak_rotation_ratio == pytest.approx(expected.peak_rotation_ratio, abs=1e-10)
            assert found.overturning_time == pytest.approx(expected.overturning_time, abs=1e-10, nan_ok=True)


def test_train_starts_with_a_positive_main_impulse_and_alternates():  # Figures 1 and 2
    body = block()
    given_sequence = sequence(body, 0.3, 0.5, duration=3.0, intermediate_count=4)
    times, impulses = impulse_train(body, given_sequence)
    table = sequence_response(body, given_sequence).half_cycles
    main = np.flatnonzero(np.abs(impulses) > 0.9 * given_sequence.main)
    assert np.array_equal(np.sign(impulses[main]), np.where(np.arange(main.size) % 2, -1.0, 1.0))
    assert impulses[:6] == pytest.approx(given_sequence.main * np.array([1.0, -0.5, 0.5, -0.5, 0.5, -1.0]))
    assert times[1:5] == pytest.approx(table.interval[0] * np.arange(1, 5))
    assert times[main] == pytest.approx(np.concatenate([[0.0], np.cumsum(table.duration)])[: main.size])
    assert np.all(np.diff(times) >= 0.0)


def test_intermediate_count_follows_from_the_trial_interval():
    body = block(2.0, 0.6)
    given_sequence = sequence(body, 0.5, 0.4, interval=0.05)
    table = sequence_response(body, given_sequence).half_cycles
    for row in range(5):
        trial = first_return(table.start_velocity[row], 0.2, 0.05 * body.p, SPACINGS["end"])
        count = max(2, 2 * round(trial / (2.0 * 0.05 * body.p)))
        assert table.impulse_count[row] == count
        assert table.interval[row] == pytest.approx(table.duration[row] / count, rel=1e-14)
    assert table.impulse_count[0] > 4


def test_half_cycles_follow_the_recurrence():  # F3: u_{i+1} = C u_r + u_1
    body = block(2.0, 0.6)
    table = sequence_response(body, sequence(body, 0.4, 0.5, spacing="open")).half_cycles
    assert table.start_velocity[1:] == pytest.approx(0.6 * table.impact_speed[:-1] + 0.4, rel=1e-14)


def test_response_depends_on_the_impulse_ratios_alone():  # F9: I cos(alpha)/alpha p, with times in 1/p
    small, large = block(2.0, 0.8), block(7.0, 0.8)
    first = sequence_response(small, sequence(small, 0.3, 0.4, 0.1, 8.0))
    second = sequence_response(large, sequence(large, 0.3, 0.4, 0.1 * small.p / large.p, 8.0 * small.p / large.p))
    assert first.peak_rotation_ratio == pytest.approx(second.peak_rotation_ratio, rel=1e-12)
    assert first.impacts == second.impacts
    assert first.half_cycles.duration * small.p == pytest.approx(second.half_cycles.duration * large.p, rel=1e-12)


def test_main_impulses_stop_at_their_count_and_at_the_duration():
    body = block(2.0, 0.6)
    assert sequence_response(body, sequence(body, 0.3, 0.4, main_count=3)).half_cycles.duration.size == 3
    durations = sequence_response(body, sequence(body, 0.3, 0.4)).half_cycles.duration
    second = float(durations[0] + durations[1])
    assert sequence_response(body, sequence(body, 0.3, 0.4, duration=second)).half_cycles.duration.size == 2
    later = sequence_response(body, sequence(body, 0.3, 0.4, duration=second * (1.0 + 1e-12)))
    assert later.half_cycles.duration.size == 3


def test_endless_motion_that_stabilises_rocks_with_endless_impacts():  # V10 (D)
    body = block(2.0, 0.6)
    response = sequence_response(body, sequence(body, 0.625, 0.5, np.nan, np.inf, spacing="continuous"))
    assert (response.outcome, response.impacts) == (Outcome.ROCKS, -1)
    assert response.peak_rotation_ratio == pytest.approx(0.652015, abs=5e-7)


def test_long_stabilised_motion_is_counted_and_not_followed():
    body = block(2.0, 0.6)
    short = sequence_response(body, sequence(body, 0.3, 0.5, duration=100.0))
    long = sequence_response(body, sequence(body, 0.3, 0.5, duration=1e9))
    assert short.peak_rotation_ratio == long.peak_rotation_ratio
    assert long.half_cycles.duration.size == short.half_cycles.duration.size < 100
    period = long.half_cycles.duration[-1]
    assert long.impacts - short.impacts == pytest.approx((1e9 - 100.0) / period, abs=2)


def test_no_main_impulse_leaves_the_block_at_rest_and_the_train_empty():
    body = block()
    response = sequence_response(body, sequence(body, 0.0, 0.0))
    assert (response.outcome, response.peak_rotation_ratio, response.impacts) == (Outcome.AT_REST, 0.0, 0)
    assert [part.size for part in impulse_train(body, sequence(body, 0.0, 0.0))] == [0, 0]


def test_equal_secondary_impulses_without_losses_repeat_the_first_half_cycle():
    body = block(2.0, 1.0)
    response = sequence_response(body, sequence(body, 0.5, 1.0, duration=np.inf, intermediate_count=4))
    assert response.half_cycles.duration.size == 1  # u_r = u - u_1, so that u_2 = u_1
    assert response.outcome == Outcome.ROCKS


@pytest.mark.parametrize("spacing", ["end", "continuous"])
def test_equal_secondary_impulses_take_the_impact_speed_away(spacing):
    body = block()
    given_sequence = sequence(body, 0.5, 1.0, np.nan, 10.0, intermediate_count=2, spacing=spacing)
    response = sequence_response(body, given_sequence)
    assert np.all(response.half_cycles.impact_speed == 0.0)
    assert response.impacts == 0
    found = impulsive_response(body, *impulse_train(body, given_sequence))
    assert found.peak_rotation_ratio == pytest.approx(response.peak_rotation_ratio, abs=1e-10)
    assert found.outcome == response.outcome


def test_critical_start_velocity_overturns_without_secondary_impulses_only():
    body = block()
    assert sequence_response(body, sequence(body, 1.0, 0.0)).overturning_half_cycle == 1
    assert sequence_response(body, sequence(body, 1.0, 0.3, main_count=1)).outcome == Outcome.ROCKS


@pytest.mark.parametrize("ratio", [1e-17, 1e-14, 1e-9])
def test_vanishing_secondary_impulses_do_not_disturb_the_critical_case(ratio):
    body = block(2.0, 1.0)
    for spacing in SPACINGS:
        response = sequence_response(body, sequence(body, 1.0, ratio, spacing=spacing, main_count=1))
        assert (response.outcome == Outcome.OVERTURNS) == np.isinf(response.peak_rotation_ratio)
        overturned = sequence_response(body, sequence(body, 1.01, ratio, spacing=spacing, main_count=1))
        assert overturned.overturning_half_cycle == 1


def test_motion_that_grows_too_slowly_is_unresolved():
    body = block(2.0, 1.0)
    given_sequence = sequence(body, 1e-7, 0.0, duration=np.inf)
    response = sequence_response(body, given_sequence, table_rows=0)
    assert (response.outcome, response.reason) == (Outcome.UNRESOLVED, Reason.HALF_CYCLE_LIMIT)
    assert np.isnan(response.peak_rotation_ratio)
    with pytest.raises(ValueError, match="duration or a main_count"):
        impulse_train(body, given_sequence)


def test_cycle_of_several_half_cycles_without_end_is_recognised():
    body = Block.from_parameters(p=2.0, alpha=0.2, restitution=0.6)
    impulses = (0.4911006424284396, 0.33667010899013655, 0.3427066743205173)
    response = sequence_response(body, ImpulseSequence(*impulses, np.inf, spacing="open"))
    assert (response.outcome, response.impacts) == (Outcome.ROCKS, -1)
    long = sequence_response(body, ImpulseSequence(*impulses, 500.0, spacing="open"))
    assert response.peak_rotation_ratio == pytest.approx(long.peak_rotation_ratio, rel=1e-12)
    counts = response.half_cycles.impulse_count[-3:]
    assert len(set(counts.tolist())) > 1  # no cycle of one half-cycle


def test_train_without_end_is_refused():
    body = block(2.0, 0.6)
    with pytest.raises(ValueError, match="shorter duration or a main_count"):
        impulse_train(body, sequence(body, 0.3, 0.5, duration=np.inf))
    with pytest.raises(ValueError, match="one block and one sequence"):
        impulse_train(Block(half_width=0.5, half_height=[2.0, 3.0], gravity=9.81), sequence(body, 0.3, 0.5))


def test_a_train_has_the_most_impulses_and_no_more(monkeypatch):
    body = block(2.0, 0.6)
    table = sequence_response(body, sequence(body, 0.3, 0.5, main_count=1000, duration=np.inf)).half_cycles
    left, each = 7, 1 + table.impulse_count[-1]  # half-cycles after those of the table, and impulses of each
    monkeypatch.setattr("rocking.impulses.sequence._TRAIN_LIMIT", left * each)
    most = table.duration.size + left
    times, _ = impulse_train(body, sequence(body, 0.3, 0.5, main_count=most, duration=np.inf))
    assert times.size == np.sum(table.impulse_count + 1) + left * each
    with pytest.raises(ValueError, match=f"more than {left * each} impulses"):
        impulse_train(body, sequence(body, 0.3, 0.5, main_count=most + 1, duration=np.inf))


def test_march_through_the_ground_is_reported(caplog):
    body = block()
    with caplog.at_level("WARNING", logger="rockpulse"):
        without = sequence_response(body, sequence(body, 0.3, 0.6, spacing="start"))
        assert not caplog.records
        through = sequence_response(body, sequence(body, 0.3, 0.9, spacing="start"))
    assert (without.ground_contact, through.ground_contact) == (False, True)
    assert "passes through the ground" in caplog.text


def test_interval_that_cannot_be_told_from_the_limit_is_refused():
    body = block()
    close = sequence(body, 0.3, 0.5, interval=1e-6)
    both = sequence_response(
        Block.stack([body, Block(half_width=5e6, half_height=4e7, restitution=0.9, gravity=9.81)]), close
    )
    for response in (sequence_response(body, close), sequence_response(Block.stack([body, body]), close), both):
        assert np.all(np.equal(response.outcome, Outcome.UNRESOLVED))
        assert np.all(np.equal(response.reason, Reason.SHORT_INTERVAL))
        assert np.all(np.isnan(response.peak_rotation_ratio))
        assert np.all(np.equal(response.impacts, -1))
    with pytest.raises(ValueError, match=r"interval.*continuous"):
        impulse_train(body, close)
    with pytest.raises(ValueError, match=r"intermediate_count.*continuous"):
        sequence_response(body, sequence(body, 0.3, 0.5, intermediate_count=2_000_000))
    one = Block.from_parameters(p=1.0, alpha=0.2, restitution=0.9)
    assert one.p == 1.0
    assert sequence_response(one, sequence(one, 0.3, 0.5, interval=1e-4)).reason != Reason.SHORT_INTERVAL
    assert sequence_response(one, sequence(one, 0.3, 0.5, interval=0.99e-4)).reason == Reason.SHORT_INTERVAL


def body_of(restitution):
    return Block(half_width=0.5, half_height=np.sqrt(3.75), restitution=restitution, gravity=9.81)


def continuous(body, main, ratio):
    impulse = np.asarray(main) * body.critical_impulse
    return ImpulseSequence(impulse, ratio * impulse, np.nan, np.inf, spacing="continuous")


@pytest.mark.parametrize(
    ("main", "ratio", "effective", "peak", "half_period"),
    [
        (0.3, 0.0, 0.75, 0.338562, 1.945910),  # V7 (D)
        (0.625, 0.5, 0.9375, 0.652015, 3.433987),  # V10 (D), I = I_2c
        (0.625, 0.7, 0.6875, 0.273816, 1.686399),
    ],
)
def test_steady_state_of_v7_and_v10(main, ratio, effective, peak, half_period):
    body = body_of(0.6)
    steady = steady_state(body, continuous(body, main, ratio))
    assert steady.stable is True
    assert steady.effective_velocity == pytest.approx(effective, abs=1e-12)
    assert steady.start_velocity == pytest.approx(effective + 0.5 * ratio * main, abs=1e-12)
    assert steady.peak == pytest.approx(peak, abs=5e-7)
    assert steady.half_period * body.p == pytest.approx(half_period, abs=5e-7)


@pytest.mark.parametrize(("main", "ratio"), [(0.3, 0.0), (0.625, 0.5), (0.5, 0.3)])
def test_response_without_end_tends_to_the_steady_state(main, ratio):
    body = body_of(0.6)
    series = continuous(body, main, ratio)
    steady, response = steady_state(body, series), sequence_response(body, series)
    assert response.half_cycles.start_velocity[-1] == pytest.approx(steady.start_velocity, rel=1e-12)
    assert response.peak_rotation_ratio == pytest.approx(steady.peak, rel=1e-10)
    assert response.half_cycles.duration[-1] == pytest.approx(steady.half_period, rel=1e-10)


def test_motion_that_overturns_has_no_steady_state():
    body = body_of(0.6)
    steady = steady_state(body, continuous(body, 0.625, 0.4))
    assert steady.stable is False
    assert (steady.peak, steady.half_period) == (np.inf, np.inf)
    assert steady.effective_velocity > 1.0


def test_critical_limit_is_stable_and_never_reached():
    body = body_of(0.6)
    steady = steady_state(body, continuous(body, 0.4, 0.0))
    assert steady.stable is True
    assert steady.peak == pytest.approx(1.0, abs=1e-6)


def test_two_sequences_on_two_blocks_have_the_closed_form_of_each_pair():
    """u* = u_1 (1 - C s)/(1 - C), v* = u* - u_1 s/2, x* = 1 - sqrt(1 - v*^2), 2 atanh(v*)/p."""
    bodies = Block(half_width=[0.5, 0.4], half_height=[2.0, 3.0], restitution=[0.6, 0.7], gravity=9.81)
    main, secondary = np.array([0.2, 0.35]), np.array([0.05, 0.2])
    steady = steady_state(bodies, ImpulseSequence(main, secondary, np.nan, np.inf, spacing="continuous"))
    for q, m in np.ndindex(2, 2):
        c, p, u1 = bodies.restitution[m], bodies.p[m], main[q] / bodies.critical_impulse[m]
        s = secondary[q] / main[q]
        start = u1 * (1.0 - c * s) / (1.0 - c)
        effective = start - u1 * s / 2.0
        assert effective < 1.0
        expected = (start, effective, 1.0 - np.sqrt(1.0 - effective**2), 2.0 * np.arctanh(effective) / p)
        names = ("start_velocity", "effective_velocity", "peak", "half_period")
        assert [getattr(steady, name)[q, m] for name in names] == pytest.approx(expected, rel=1e-9)
    assert steady.stable.all()


def test_a_spacing_does_not_matter_without_secondary_impulses():
    body, impulse = body_of(0.6), 0.3 * body_of(0.6).critical_impulse
    for spacing in ("end", "continuous"):
        series = ImpulseSequence(impulse, 0.0, 0.1, np.inf, spacing=spacing)
        assert steady_state(body, series).start_velocity == pytest.approx(0.75)
    with pytest.raises(ValueError, match="spacing"):
        steady_state(body, ImpulseSequence([impulse, impulse], [0.0, 1e-9], 0.1, np.inf))


def test_without_losses_a_motion_without_gain_keeps_its_velocity_lane_by_lane():
    bodies = Block.from_parameters(2.0, 0.2, [1.0, 0.6, 1.0], log=False)
    impulse = 0.4 * bodies.critical_impulse[0]
    steady = steady_state(bodies, ImpulseSequence(impulse, impulse, np.nan, np.inf, spacing="continuous"))
    assert steady.start_velocity == pytest.approx([0.4, 0.4, 0.4])
    assert steady.effective_velocity == pytest.approx([0.2, 0.2, 0.2])
    grows = steady_state(bodies, ImpulseSequence(impulse, 0.5 * impulse, np.nan, np.inf, spacing="continuous"))
    assert grows.start_velocity == pytest.approx([np.inf, 0.7, np.inf])
