"""One half-cycle with intermediate impulses (F3, F4, V8) against a march that knows no closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
from rocking.impulses.impulse_sequence import SPACINGS

PROPERTY = settings(derandomize=True, deadline=None, max_examples=150)
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


@PROPERTY
@given(st.floats(1e-3, 1.6), st.floats(0.0, 1.0), st.integers(1, 10), st.sampled_from(CASES))
def test_duration_is_the_smallest_root_and_the_speed_that_of_the_march(main, ratio, half_count, spacing):
    secondary, count = ratio * main, 2 * half_count
    total = corrected_duration(main, secondary, count, spacing)
    trials = np.geomspace(1e-3, 1.0, 400) * min(total, 25.0)
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
    at = np.linspace(0.0, total, 4001)
    rotations = superposed(main, secondary, total, count, spacing, at)[0]
    step = total / 4000 * (main + secondary)
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
    larger = np.linspace(total * 1.01, 60.0, 4000)
    assert np.any(np.array([landing(1.005, secondary, trial, count, spacing) for trial in larger]) > 0.0)
    assert (
        landing(1.005, secondary, total * 1.001, count, spacing)
        < 0.0
        < landing(1.005, secondary, total * 0.999, count, spacing)
    )
    assert corrected_duration(1.4, secondary, count, spacing) == np.inf


@pytest.mark.parametrize("spacing", CASES)
def test_without_secondary_impulses_it_is_the_natural_half_cycle(spacing):
    assert corrected_duration(0.75, 0.0, 2, spacing) == pytest.approx(2.0 * np.arctanh(0.75), rel=1e-15)
    assert corrected_duration(1.0, 0.0, 2, spacing) == np.inf


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
    at = np.linspace(0.0, horizon, 3001)[1:]
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


def test_codes_are_those_of_the_spacings():
    assert [SPACINGS[name] for name in ("end", "middle", "start", "open", "continuous")] == [
        END,
        MIDDLE,
        START,
        OPEN,
        CONTINUOUS,
    ]


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
