"""Natural motion between impulses (F5, V11, V12)."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rocking.impulses import motion

PROPERTY = settings(derandomize=True, deadline=None, max_examples=200)
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


def test_half_cycle_of_the_stabilised_motion():  # V7 (D)
    peak, duration = motion.hop(0.75)
    assert peak == pytest.approx(0.338562, abs=5e-7)
    assert duration == pytest.approx(1.945910, abs=5e-7)


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


def test_waiting_for_ever_does_not_overflow():
    assert np.isfinite(motion.state(0.5, 0.4, 1e6)).all()


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


def test_no_top_is_ahead_of_a_falling_block():
    assert motion.rise_time(0.5, -0.1) == np.inf


@pytest.mark.parametrize("restitution", [0.1, 0.5, 0.9, 0.999])
def test_impacts_above_counts_the_powers(restitution):
    expected = int(np.sum(0.7 * restitution ** np.arange(100_000.0) > 1e-3))
    assert motion.impacts_above(0.7, restitution, 1e-3) == expected


def test_impacts_above_at_the_limits_of_restitution():
    assert motion.impacts_above(0.5, 1.0, 1e-3) == -1
    assert motion.impacts_above(0.5, 0.0, 1e-3) == 1
    assert motion.impacts_above(1e-3, 0.9, 1e-3) == 0
    assert motion.impacts_above(0.5, 0.5, 0.125) == 2  # an exact power is not above the cut-off
