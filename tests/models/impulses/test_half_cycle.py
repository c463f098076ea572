"""Natural motion between impulses (F5, V11, V12), and half-cycles with intermediate ones (F3, F4, V8)."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.impulses import half_cycle as motion
from rocking.impulses.half_cycle import (
    CONTINUOUS,
    END,
    MIDDLE,
    OPEN,
    START,
    corrected_duration,
    first_return,
    impact_speed_after,
    peak_and_lowest,
    stays_bounded,
)

PROPERTY = settings(derandomize=True, deadline=None, max_examples=30)
HOUSNER_A = 0.90625  # VALIDATION V1, block A


@pytest.mark.parametrize(
    ("rotation", "quarter_period"),
    [(0.1, 0.4671453), (0.25, 0.7953655), (0.5, 1.3169579), (0.9, 2.9932228), (0.99, 5.2982924)],  # V11 (D)
)
def test_fall_from_rest_takes_a_quarter_period(rotation, quarter_period):
    assert motion.return_time(rotation, 0.0) == pytest.approx(quarter_period, abs=5e-8)
    assert motion.return_time(rotation, 0.0) == pytest.approx(math.acosh(1.0 / (1.0 - rotation)), rel=1e-13)


def test_free_decay_has_the_peaks_of_f5():  # V12 (D)
    speed = motion.impact_speed(0.5, 0.0)
    peaks = [motion.hop(speed * HOUSNER_A**impacts)[0] for impacts in range(5)]
    assert peaks == pytest.approx([0.5, 0.3802959, 0.2970681, 0.2354605, 0.1883527], abs=5e-8)


def test_free_decay_ends_after_infinitely_many_impacts_in_finite_time():  # V12 (D)
    speed = motion.impact_speed(0.5, 0.0)
    total = motion.return_time(0.5, 0.0) + motion.free_decay_time(HOUSNER_A * speed, HOUSNER_A)
    assert total == pytest.approx(19.812828, abs=5e-7)


@pytest.mark.parametrize(
    ("velocity", "restitution"), [(0.999, 0.95), (0.5, 0.3), (1e-6, 0.99), (0.8, 0.0), (0.9, 0.999)]
)
def test_free_decay_time_is_the_sum_over_the_hops(velocity, restitution):
    hops = velocity * restitution ** np.arange(60_000.0)
    assert motion.free_decay_time(velocity, restitution) == pytest.approx(2.0 * np.arctanh(hops).sum(), rel=1e-12)


def test_free_decay_never_ends_without_losses_or_beyond_the_critical_velocity():
    assert motion.free_decay_time(0.1, 1.0) == np.inf
    assert motion.free_decay_time(1.0, 0.5) == np.inf


def test_tiny_hop_keeps_its_digits():
    peak, duration = motion.hop(1e-9)
    assert peak == pytest.approx(5e-19, rel=1e-12)
    assert duration == pytest.approx(2e-9, rel=1e-12)
    x, v = motion.state(0.0, 1e-9, 1e-9)
    assert x == pytest.approx(5e-19, rel=1e-9)
    assert motion.return_time(x, v) == pytest.approx(1e-9, rel=1e-7)
    assert motion.return_time(5e-19, -1e-12) == pytest.approx(math.sqrt(1e-18 + 1e-24) - 1e-12, rel=1e-9)


def test_hop_with_the_critical_velocity_does_not_come_back():
    assert motion.hop(1.0) == (np.inf, np.inf)
    assert np.isfinite(motion.hop(np.nextafter(1.0, 0.0))).all()
    assert motion.return_time(0.25, 0.75) == np.inf


@pytest.mark.sweep
@PROPERTY
@given(st.floats(0.0, 1.9), st.floats(-2.0, 0.999), st.floats(1e-6, 30.0))
def test_state_agrees_with_eq_2_in_many_digits(rotation, velocity, time):
    with mpmath.workdps(50):
        x, v, t = mpmath.mpf(rotation), mpmath.mpf(velocity), mpmath.mpf(time)
        expected = 1 + (x - 1) * mpmath.cosh(t) + v * mpmath.sinh(t)
        expected_velocity = (x - 1) * mpmath.sinh(t) + v * mpmath.cosh(t)
        scale = float(mpmath.cosh(t))
        found = motion.state(rotation, velocity, time)
        assert float(abs(found[0] - expected)) <= 4e-15 * scale
        assert float(abs(found[1] - expected_velocity)) <= 4e-15 * scale


@PROPERTY
@given(st.floats(0.0, 0.95), st.floats(-1.0, 0.9))
def test_return_happens_on_the_ground_with_the_speed_of_the_energy(rotation, velocity):
    time = motion.return_time(rotation, velocity)
    if rotation - 1.0 + velocity >= 0.0:
        assert time == np.inf
        return
    with mpmath.workdps(40):
        x, v, t = mpmath.mpf(rotation), mpmath.mpf(velocity), mpmath.mpf(time)
        landing = 1 + (x - 1) * mpmath.cosh(t) + v * mpmath.sinh(t)
        speed = -((x - 1) * mpmath.sinh(t) + v * mpmath.cosh(t))
    tolerance = 1e-14 * math.cosh(time)
    assert float(landing) == pytest.approx(0.0, abs=tolerance)
    assert motion.impact_speed(rotation, velocity) == pytest.approx(float(speed), abs=2.0 * tolerance)


@PROPERTY
@given(st.floats(0.0, 0.9), st.floats(0.0, 0.9))
def test_top_is_where_the_velocity_vanishes(rotation, velocity):
    time = motion.rise_time(rotation, velocity)
    if rotation + velocity >= 1.0:
        assert time == np.inf
        return
    x, v = motion.state(rotation, velocity, time)
    assert v == pytest.approx(0.0, abs=1e-13 * math.cosh(time))
    assert motion.top(rotation, velocity) == pytest.approx(x, rel=1e-11, abs=1e-13)


@pytest.mark.parametrize("restitution", [0.1, 0.5, 0.9, 0.999])
def test_impacts_above_counts_the_powers(restitution):
    expected = int(np.sum(0.7 * restitution ** np.arange(100_000.0) > 1e-3))
    assert motion.impacts_above(0.7, restitution, 1e-3) == expected


def test_impacts_above_at_the_limits_of_restitution():
    assert motion.impacts_above(0.5, 1.0, 1e-3) == -1
    assert motion.impacts_above(0.5, 0.0, 1e-3) == 1
    assert motion.impacts_above(1e-3, 0.9, 1e-3) == 0
    assert motion.impacts_above(0.5, 0.5, 0.125) == 2  # an exact power is not above the cut-off


CASES = [END, MIDDLE, START, OPEN]


def impulse_times(total, count, spacing):
    order = np.arange(1, count + 1)
    phase = {END: 0.0, MIDDLE: 0.5, START: 1.0, OPEN: 0.0}[spacing]
    return (order - phase) * total / (count + 1 if spacing == OPEN else count)


def superposed(velocity, secondary, total, count, spacing, at):
    """Rotation and velocity by superposing the answers to every impulse (all of those up to and at the time)."""
    times = impulse_times(total, count, spacing)
    signs = np.where(np.arange(count) % 2, 1.0, -1.0)
    later = np.maximum(np.subtract.outer(np.asarray(at), times), 0.0)
    acted = np.subtract.outer(np.asarray(at), times) >= -1e-12
    x = 1.0 - np.cosh(at) + velocity * np.sinh(at) + (secondary * signs * np.sinh(later)).sum(-1)
    v = -np.sinh(at) + velocity * np.cosh(at) + (secondary * signs * np.cosh(later) * acted).sum(-1)
    return x, v


def landing(velocity, secondary, total, count, spacing):
    return superposed(velocity, secondary, total, count, spacing, np.asarray(total))[0]


@pytest.mark.parametrize(
    ("count", "spacing", "duration", "speed"),
    [  # V8 (D): u = .6, sigma u1 = .26315
        (2, END, 1.05882205, 0.33685),
        (2, MIDDLE, 1.02694216, 0.34529056),
        (2, START, 0.97965194, 0.33685),
        (2, OPEN, 1.14277391, 0.43275427),
        (6, END, 1.02981846, 0.33685),
        (6, MIDDLE, 1.01730954, None),
        (6, OPEN, 1.06933120, 0.37787883),
    ],
)
def test_half_cycle_of_v8(count, spacing, duration, speed):
    found = corrected_duration(0.6, 0.26315, count, spacing)
    assert found == pytest.approx(duration, abs=5e-9)
    if speed is not None:
        assert impact_speed_after(0.6, 0.26315, found, count, spacing) == pytest.approx(speed, abs=5e-9)


@pytest.mark.sweep
@PROPERTY
@given(st.floats(1e-3, 1.6), st.floats(0.0, 1.0), st.integers(1, 10), st.sampled_from(CASES))
def test_duration_is_the_smallest_root_and_the_speed_that_of_the_march(main, ratio, half_count, spacing):
    secondary, count = ratio * main, 2 * half_count
    total = corrected_duration(main, secondary, count, spacing)
    trials = np.geomspace(1e-3, 1.0, 100) * min(total, 25.0)
    rotations = np.array([landing(main, secondary, trial, count, spacing) for trial in trials])
    if total == np.inf:
        assert np.all(rotations > 0.0)
        return
    assert np.all(rotations[trials < total * (1.0 - 1e-6)] > 0.0)
    x, v = superposed(main, secondary, total, count, spacing, np.asarray(total))
    tolerance = 1e-13 * np.cosh(total)
    assert x == pytest.approx(0.0, abs=tolerance)
    assert impact_speed_after(main, secondary, total, count, spacing) == pytest.approx(-v, abs=2.0 * tolerance)


@PROPERTY
@given(st.floats(1e-3, 0.95), st.floats(0.0, 1.0), st.integers(1, 8), st.sampled_from(CASES))
def test_peak_is_the_largest_rotation_of_the_march(main, ratio, half_count, spacing):
    secondary, count = ratio * main, 2 * half_count
    total = corrected_duration(main, secondary, count, spacing)
    peak, lowest = peak_and_lowest(main, secondary, total, count, spacing)
    at = np.linspace(0.0, total, 1001)
    rotations = superposed(main, secondary, total, count, spacing, at)[0]
    step = total / 1000 * (main + secondary)
    assert rotations.max() <= peak * (1.0 + 1e-9) + 1e-15
    assert peak <= rotations.max() + step
    inside = impulse_times(total, count, spacing)
    inside = inside[(inside > 0.0) & (inside < total * (1.0 - 1e-9))]
    expected = superposed(main, secondary, total, count, spacing, inside)[0].min()
    assert lowest == pytest.approx(expected, abs=1e-13 * np.cosh(total))


@pytest.mark.parametrize("spacing", CASES)
@pytest.mark.parametrize(("velocity", "secondary"), [(0.6, 0.26315), (0.95, 0.3), (1.05, 0.4)])
def test_many_intermediate_impulses_tend_to_the_continuous_limit(spacing, velocity, secondary):  # F4
    limit = corrected_duration(velocity, secondary, 0, CONTINUOUS)
    errors = []
    for count in (200, 400):
        total = corrected_duration(velocity, secondary, count, spacing)
        errors.append(abs(total - limit))
        assert impact_speed_after(velocity, secondary, total, count, spacing) == pytest.approx(
            velocity - secondary, abs=5.0 * total / count
        )
    assert errors[1] < 0.02 * limit
    assert errors[0] / errors[1] > 1.8  # first order in 1/n, second for "middle"


@pytest.mark.parametrize("spacing", [END, MIDDLE, OPEN])
def test_beyond_the_critical_velocity_the_smaller_of_two_roots_is_the_motion(spacing):  # F3
    secondary, count = 0.3, 2
    total = corrected_duration(1.005, secondary, count, spacing)
    larger = np.linspace(total * 1.01, 60.0, 500)
    assert np.any(np.array([landing(1.005, secondary, trial, count, spacing) for trial in larger]) > 0.0)
    assert (
        landing(1.005, secondary, total * 1.001, count, spacing)
        < 0.0
        < landing(1.005, secondary, total * 0.999, count, spacing)
    )
    assert corrected_duration(1.4, secondary, count, spacing) == np.inf


def test_start_comes_back_from_any_velocity_below_one_plus_the_first_push():
    assert np.isfinite(corrected_duration(1.29, 0.3, 2, START))
    assert corrected_duration(1.3 + 1e-15, 0.3, 2, START) == np.inf


@PROPERTY
@given(st.floats(1e-3, 1.5), st.floats(0.0, 1.0), st.floats(0.02, 3.0), st.sampled_from(CASES))
def test_trial_march_returns_where_the_superposed_motion_first_meets_the_ground(main, ratio, interval, spacing):
    secondary = ratio * main
    found = first_return(main, secondary, interval, spacing)
    horizon = min(found, 12.0)
    count = 2 * int(np.ceil(horizon / interval / 2.0 + 2.0))
    # The same impulses as a corrected march whose interval is the trial one.
    total = interval * (count + 1 if spacing == OPEN else count)
    at = np.linspace(0.0, horizon, 801)[1:]
    rotations = superposed(main, secondary, total, count, spacing, at)[0]
    assert np.all(rotations[:-2] > -1e-12 * np.cosh(horizon))
    if found < 12.0:
        landed = superposed(main, secondary, total, count, spacing, np.asarray(found))[0]
        assert landed == pytest.approx(0.0, abs=1e-12 * np.cosh(found))


def test_trial_march_with_a_longer_interval_than_the_half_cycle_is_the_natural_one():
    assert first_return(0.5, 0.2, 50.0, END) == pytest.approx(2.0 * np.arctanh(0.5), rel=1e-15)
    assert first_return(1.1, 0.2, 50.0, END) == np.inf
    assert first_return(1.1, 0.2, 5000.0, MIDDLE) == np.inf


def test_trial_march_leaves_the_unstable_equilibrium_with_the_next_impulse():
    # u = 1 takes the block to x = 1, where it waits; -0.2 then sends it back: x = 1 - 0.2 sinh t.
    assert first_return(1.0, 0.2, 50.0, END) == pytest.approx(50.0 + np.arcsinh(5.0), rel=1e-14)


@pytest.mark.parametrize(
    ("main", "ratio", "restitution", "bounded"),
    [
        (0.1, 0.0, 0.9, True),  # equality up to the rounding of 1 - 0.9
        (0.1 + 1e-9, 0.0, 0.9, False),
        (1.0, 0.0, 0.0, False),
        (np.nextafter(1.0, 0.0), 0.0, 0.0, False),
        (0.999, 0.0, 0.0, True),
        (1e-3, 0.0, 1.0, False),
        (0.5, 1.0, 1.0, True),
        (0.625, 0.5, 0.6, True),  # V10: v* = .9375
        (0.625, 0.4, 0.6, False),
    ],
)
def test_bounded_motion_is_decided_robustly(main, ratio, restitution, bounded):
    assert stays_bounded(main, ratio, restitution) is bounded
