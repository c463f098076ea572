"""Arias intensity, PGV and intense phase: closed forms, and exactness for a record that is linear between samples."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.record.intensity import (
    INTENSE_PHASES,
    IntensePhase,
    arias_intensity,
    fajfar_index,
    intense_phase,
    largest_change,
    pgv,
    spectral_acceleration,
    spectrum_intensity,
)
from rockpulse.record.record import STANDARD_GRAVITY, Record

properties = settings(derandomize=True, deadline=None, max_examples=20)
samples = st.lists(st.integers(-9, 9), min_size=2, max_size=40)


def record(values, dt=1.0):
    return Record(values, dt=dt, id="test")


def sine(frequency, cycles, dt=0.01, amplitude=3.0):
    count = round(cycles / frequency / dt)
    return record(amplitude * np.sin(2.0 * np.pi * frequency * dt * np.arange(count + 1)), dt)


def refined(values, parts):
    """The same lines with more samples on them."""
    fine = np.interp(np.arange((len(values) - 1) * parts + 1) / parts, np.arange(len(values)), values)
    return record(fine, 1.0 / parts)


@pytest.mark.parametrize(("frequency", "cycles"), [(0.5, 5), (1.0, 10), (2.5, 50)])
def test_arias_intensity_of_a_sampled_sine(frequency, cycles):  # VALIDATION V17, D
    motion = sine(frequency, cycles)
    continuous = math.pi * 3.0**2 * (cycles / frequency) / (4.0 * STANDARD_GRAVITY)
    chords = (2.0 + math.cos(2.0 * math.pi * frequency * motion.dt)) / 3.0
    assert arias_intensity(motion) == pytest.approx(continuous * chords, rel=1e-12)


@pytest.mark.parametrize(("frequency", "cycles"), [(0.5, 5), (1.0, 10), (2.5, 50)])
def test_significant_duration_of_whole_sine_cycles(frequency, cycles):  # VALIDATION V17, D
    phase = intense_phase(sine(frequency, cycles))
    assert abs(phase.duration - 0.9 * cycles / frequency) < 0.5 / frequency
    # 5 % of ten cycles is at a zero crossing, where the time is the cube root of the energy and its rounding.
    assert phase.start + phase.end == pytest.approx(cycles / frequency, abs=1e-5)


def test_significant_duration_of_a_constant_is_a_share_of_its_length():
    assert intense_phase(record([2.0] * 11)) == IntensePhase(
        pytest.approx(0.5, rel=1e-14), pytest.approx(9.5, rel=1e-14)
    )
    assert intense_phase(record([2.0] * 11), "D5-75").end == pytest.approx(7.5, rel=1e-14)


@pytest.mark.parametrize("count", [2, 3, 101])
def test_significant_duration_of_a_ramp_follows_its_cubic(count):
    phase = intense_phase(record(np.linspace(0.0, 7.0, count), 10.0 / (count - 1)))
    assert phase.start == pytest.approx(10.0 * 0.05 ** (1.0 / 3.0), rel=1e-12)
    assert phase.end == pytest.approx(10.0 * 0.95 ** (1.0 / 3.0), rel=1e-12)


def test_level_reached_beyond_a_zero_crossing_in_one_interval():
    # a = 1 - 2 t: the energy (1 - (1 - 2 t)^3)/6 of 1/3 is at 95 % where (1 - 2 t)^3 = -0.9
    phase = intense_phase(record([1.0, -1.0]))
    assert phase.end == pytest.approx(0.5 * (1.0 + 0.9 ** (1.0 / 3.0)), rel=1e-12)
    assert phase.start == pytest.approx(0.5 * (1.0 - 0.9 ** (1.0 / 3.0)), rel=1e-12)


def test_nearly_constant_interval_keeps_its_digits():
    phase = intense_phase(record([1.0, 1.0 + 1e-13]))
    assert (phase.start, phase.end) == (pytest.approx(0.05, rel=1e-11), pytest.approx(0.95, rel=1e-11))


@properties
@given(samples, st.integers(2, 5), st.sampled_from(["D5-95", "D5-75"]))
def test_more_samples_on_the_same_lines_change_nothing(values, parts, method):
    assume(any(values))
    coarse, fine = record(values), refined(values, parts)
    assert arias_intensity(fine) == pytest.approx(arias_intensity(coarse), rel=1e-12)
    assert pgv(fine) == pytest.approx(pgv(coarse), rel=1e-12)
    # The time is as good as the cube root of the energy's rounding where the acceleration vanishes.
    expected, found = intense_phase(coarse, method), intense_phase(fine, method)
    assert (found.start, found.end) == (pytest.approx(expected.start, abs=1e-4), pytest.approx(expected.end, abs=1e-4))


@properties
@given(samples, st.floats(0.1, 8.9))
def test_bracketed_phase_does_not_depend_on_the_sampling(values, level):
    assume(max(map(abs, values)) > level)
    coarse = intense_phase(record(values), "bracketed", level=level)
    fine = intense_phase(refined(values, 4), "bracketed", level=level)
    assert (fine.start, fine.end) == (pytest.approx(coarse.start, abs=1e-12), pytest.approx(coarse.end, abs=1e-12))


@properties
@given(samples, st.sampled_from(list(INTENSE_PHASES)))
def test_mirrored_and_scaled_records_have_the_same_phase(values, method):
    assume(max(map(abs, values)) >= 1)
    phase = intense_phase(record(values), method)
    assert intense_phase(record(np.negative(values)), method) == phase
    scaled = intense_phase(
        record(np.multiply(values, 4.0)), method, level=0.2 * STANDARD_GRAVITY if method == "bracketed" else None
    )
    assert (scaled.start, scaled.end) == (pytest.approx(phase.start, rel=1e-9), pytest.approx(phase.end, rel=1e-9))
    assert arias_intensity(record(np.multiply(values, 4.0))) == pytest.approx(16.0 * arias_intensity(record(values)))
    assert pgv(record(np.multiply(values, -4.0))) == pytest.approx(4.0 * pgv(record(values)))


def test_velocity_peaks_at_the_zero_crossing_inside_an_interval():
    assert pgv(record([3.0, -1.0])) == pytest.approx(0.5 * 3.0 * 0.75)
    assert pgv(record([-3.0, 1.0, 1.0, 1.0])) == pytest.approx(0.5 * 3.0 * 0.75)


def test_bracket_is_interpolated_at_both_ends():
    assert intense_phase(record([0.0, 4.0, 0.0, -2.0, 0.0]), "bracketed", level=1.0) == IntensePhase(0.25, 3.5)


def test_default_bracket_is_five_percent_of_gravity():
    peak = 0.1 * STANDARD_GRAVITY
    assert intense_phase(record([0.0, peak, 0.0]), "bracketed") == IntensePhase(pytest.approx(0.5), pytest.approx(1.5))


def test_record_below_the_bracket_is_refused():
    with pytest.raises(RecordRefused, match=r"test: the acceleration never exceeds level = 1 m/s2 \(PGA 1 m/s2\)"):
        intense_phase(record([0.0, 1.0, 0.0]), "bracketed", level=1.0)


@pytest.mark.parametrize("method", ["D5-95", "D5-75", "bracketed", "window"])
def test_record_of_zeros_is_refused(method):
    with pytest.raises(RecordRefused, match="test: "):
        intense_phase(record(np.zeros(100)), method)


@pytest.mark.parametrize("period", [0.3, 0.5, 1.1])
def test_spectral_acceleration_ends_with_the_record(period):
    """A ramp that ends at its highest: against the exact answer to it at 5 % damping."""
    ramp = record(np.arange(20.0), 0.1)
    rate, times = 2.0 * np.pi / period, np.linspace(0.0, 1.9, 4001)
    damped = rate * np.sqrt(1.0 - 0.05**2)
    decay = np.exp(-0.05 * rate * times)
    swing = decay * (0.1 / rate * np.cos(damped * times) - (1.0 - 2.0 * 0.05**2) / damped * np.sin(damped * times))
    expected = np.abs(10.0 * (times - 0.1 / rate + swing)).max()
    assert spectral_acceleration(ramp, period) == pytest.approx(expected, rel=5e-3)


def test_window_is_as_given():
    assert intense_phase(sine(1.0, 60), "window", start_s=3.0, end_s=11.5) == IntensePhase(3.0, 11.5)
    assert intense_phase(sine(1.0, 60), "window", start_s=0.0, end_s=0.5) == IntensePhase(0.0, 0.5)
    assert intense_phase(sine(1.0, 60), "window", start_s=3.0) == IntensePhase(3.0, 23.0)
    assert intense_phase(sine(1.0, 10), "window", start_s=3.0) == IntensePhase(3.0, pytest.approx(10.0))


@pytest.mark.parametrize("seed", range(4, 8))
def test_strongest_window_is_the_best_of_all_that_begin_at_a_sample(seed):
    values = np.random.default_rng(seed).normal(size=150) * np.hanning(150) ** 0.25
    motion = record(values, 0.3)  # 20 s are 66.67 intervals

    def content(start):
        ends = np.concatenate(
            ([start], motion.time[(motion.time > start) & (motion.time < start + 20.0)], [start + 20.0])
        )
        left, right = (np.interp(edge, motion.time, values) for edge in (ends[:-1], ends[1:]))
        return np.sum(np.diff(ends) * (left**2 + left * right + right**2))

    starts = [start for start in motion.time if start + 20.0 <= motion.duration]
    assert intense_phase(motion, "window").start == pytest.approx(max(starts, key=content))


def test_first_of_equal_windows_is_taken():
    assert intense_phase(sine(1.0, 60), "window") == IntensePhase(0.0, 20.0)


def test_record_shorter_than_the_window_is_all_intense():
    assert intense_phase(sine(1.0, 10), "window") == IntensePhase(0.0, pytest.approx(10.0))
    assert intense_phase(record(np.arange(21.0)), "window") == IntensePhase(0.0, 20.0)
    # One interval longer: the strong last sample is inside the second of two windows.
    assert intense_phase(record(np.arange(22.0)), "window") == IntensePhase(1.0, 21.0)


def test_a_level_that_lies_on_a_sample_is_reached_there():
    """Energy 1 in each of twenty intervals: 5 % are reached after one of them, 95 % after nineteen."""
    phase = intense_phase(record([1.0] * 21, 0.5))
    assert (phase.start, phase.end) == (pytest.approx(0.5, rel=1e-12), pytest.approx(9.5, rel=1e-12))
    # A record whose energy begins after a rest: the first 5 % are in the second of the intervals.
    assert intense_phase(record([0.0, 0.0, 3.0, 3.0, 3.0])).start == pytest.approx(1.0 + (0.05 * 7.0) ** (1 / 3))
    # 5 % of the smallest number is zero, which is reached at once.
    assert intense_phase(record([0.0, 0.0, 2e-162, 2e-162])).start == 0.0


def test_the_change_of_velocity_is_over_the_nearest_number_of_samples():
    ramp = record(np.arange(11.0), dt=0.1)
    velocity = 5.0 * ramp.time**2
    for within, steps in ((0.26, 3), (0.24, 2), (0.04, 1), (0.99, 10), (5.0, 10)):
        assert largest_change(ramp, within) == pytest.approx(velocity[-1] - velocity[-1 - steps])


def test_window_after_the_record_is_refused():
    with pytest.raises(RecordRefused, match="after the end of the record"):
        intense_phase(sine(1.0, 10), "window", start_s=10.0)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"method": "D5-50"}, "method: expected one of D5-95, D5-75, bracketed, window, got 'D5-50'"),
        ({"method": "D5-95", "start_s": 1.0}, "apply only to method 'window'"),
        ({"method": "bracketed", "end_s": 1.0}, "apply only to method 'window'"),
        ({"method": "window", "level": 1.0}, "level applies only to method 'bracketed'"),
        ({"method": "bracketed", "level": 0.0}, "level: expected a positive acceleration"),
        ({"method": "bracketed", "level": math.nan}, "level: expected a positive acceleration"),
        ({"method": "window", "end_s": 3.0}, "end_s needs start_s"),
        ({"method": "window", "start_s": -0.001}, "expected 0 <= start_s < end_s"),
        ({"method": "window", "start_s": 3.0, "end_s": math.inf}, "expected 0 <= start_s < end_s"),
        ({"method": "window", "start_s": 3.0, "end_s": 3.0}, "expected 0 <= start_s < end_s"),
    ],
)
def test_wrong_arguments_are_named(wrong, message):
    with pytest.raises(ConfigError, match=message):
        intense_phase(sine(1.0, 10), **wrong)


def test_significant_duration_of_a_real_record_holds_its_stated_peak(ccc):
    phase = intense_phase(ccc[0])
    assert phase.start < 39.410 < phase.end  # "Max  =  -.567 g, at   39.410 sec."
    assert 5.0 < phase.duration < 30.0
    assert np.abs(ccc[0].acceleration).argmax() * ccc[0].dt == pytest.approx(39.41)


@pytest.mark.sweep
@pytest.mark.parametrize(("period", "dt"), [(0.8, 0.01), (0.1, 0.02), (2.5, 0.02)])
def test_the_pseudo_acceleration_is_that_of_an_oscillator(period, dt):
    """Against the equation of motion integrated step by step, also where a period has five samples."""
    time = np.arange(0.0, 4.0, dt)
    motion = record(3.0 * np.sin(4.0 * time) * np.exp(-0.2 * time), dt)
    rate = 2.0 * np.pi / period

    def oscillator(t, state):
        return [state[1], -2.0 * 0.05 * rate * state[1] - rate**2 * state[0] - np.interp(t, time, motion.acceleration)]

    found = solve_ivp(oscillator, (0.0, time[-1]), [0.0, 0.0], max_step=dt / 4, rtol=1e-9, atol=1e-12)
    assert spectral_acceleration(motion, period) == pytest.approx(rate**2 * np.max(np.abs(found.y[0])), rel=5e-3)


def test_housners_intensity_of_an_impulse_is_its_velocity_but_for_damping():
    """v exp(-xi/sqrt(1 - xi2) atan(sqrt(1 - xi2)/xi)) at every period that is long for the impulse."""
    push = record([0.0, 1000.0] + [0.0] * 1500, dt=0.002)  # 2 m/s
    root = math.sqrt(1.0 - 0.05**2)
    left = 2.0 * math.exp(-0.05 / root * math.atan(root / 0.05))
    assert spectrum_intensity(push) == pytest.approx(left, rel=2e-3)


@pytest.mark.sweep
def test_housners_intensity_is_over_periods_of_a_tenth_to_two_and_a_half_seconds():
    motion = sine(0.7, 2, dt=0.02)
    periods = 0.1 + 0.05 * np.arange(49)
    velocities = [spectral_acceleration(motion, period) * period / (2.0 * np.pi) for period in periods]
    area = 0.05 * (sum(velocities) - 0.5 * (velocities[0] + velocities[-1]))
    assert spectrum_intensity(motion) == pytest.approx(area / 2.4, rel=1e-9)


def test_a_period_with_fewer_than_sixteen_samples_is_looked_at_between_them():
    motion = refined(np.sin(2.3 * np.arange(40)), 1)
    halves = refined(motion.acceleration, 2)
    assert spectral_acceleration(motion, 15.5) == pytest.approx(spectral_acceleration(halves, 15.5), rel=1e-12)
    assert spectral_acceleration(motion, 16.1) != pytest.approx(spectral_acceleration(halves, 16.1), rel=1e-9)


def test_fajfars_index_of_a_sine():
    """A is uniform but for its ripple: D5-95 is 0.9 of the length."""
    motion = sine(2.0, 80)
    assert fajfar_index(motion) == pytest.approx(pgv(motion) * (0.9 * 40.0) ** 0.25, rel=1e-3)
