"""The checks of codes against numbers worked by hand (the derivation is in the manual)."""

import math
from dataclasses import replace

import pytest

from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.config.study_settings import CheckSettings
from rockpulse.studies.check.code_spectra import spectrum_of
from rockpulse.studies.check.codes import circolare_2009, circolare_2019, circolare_2019_frame, en_1998, floor_spectrum
from rockpulse.studies.check.mechanism import Mechanism, Weight

G = 9.80665
WALL = Mechanism((Weight(1.0, 0.2, 2.0, True),))  # 0.4 x 4 m
SURE = CheckSettings(confidence_factor=1.0)
SPECTRUM = spectrum_of(CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C"))  # a_g S 0.2875 g, plateau 0.71875 g
FLOOR = FloorSettings(period=0.5, participation=1.2, level=0.8)


def test_circolare_2009_on_the_ground():
    """a_0* = 0.1 g against 0.14375 g; d_u* 0.08 m; T_s = 1.2384 s; S_De = 0.71875 g x 0.6/T_s (T_s/2 pi)^2."""
    found = circolare_2009(WALL, SPECTRUM, (), SURE)
    assert found.activation == pytest.approx(0.1 * G)
    assert found.activation_ratio == pytest.approx(0.1 / 0.14375)
    assert (found.displacement, found.period) == (pytest.approx(0.08), pytest.approx(1.2384, abs=5e-5))
    assert found.displacement_demand == pytest.approx(0.71875 * G * 0.6 * 1.2384 / (2.0 * math.pi) ** 2, rel=1e-4)
    assert found.displacement_ratio == pytest.approx(0.08 / found.displacement_demand)


def test_circolare_2009_aloft_asks_for_the_first_mode_too():
    """S_e(0.5) = 0.71875 g, times psi gamma 1.2, over q 2: 0.43125 g; the displacement is left out."""
    found = circolare_2009(WALL, SPECTRUM, (FLOOR,), SURE)
    assert found.activation_demand == pytest.approx(0.43125 * G)
    assert math.isnan(found.displacement_ratio)
    assert "could not be established" in found.statement
    near = circolare_2009(WALL, SPECTRUM, (FloorSettings(period=0.5, participation=0.1),), SURE)
    assert near.activation_demand == pytest.approx(0.14375 * G)  # not less than on the ground


@pytest.mark.parametrize(
    ("state", "allowed", "period", "damping"),
    [("slv", 0.08, 1.68 * math.pi * (0.08 / (0.06 * G)) ** 0.5, 0.08), ("slc", 0.12, 2.71066, 0.10)],
)
def test_circolare_2019_on_the_ground(state, allowed, period, damping):
    """a(0.4 d_0) = 0.06 g and T_SLV = 1.9461 s; a(0.6 d_0) = 0.04 g and T_SLC = 2.7107 s."""
    found = circolare_2019(WALL, SPECTRUM, (), CheckSettings(confidence_factor=1.0, limit_state=state))
    assert found.displacement == pytest.approx(allowed)
    assert found.period == pytest.approx(period, rel=1e-5)
    eta = (10.0 / (5.0 + 100.0 * damping)) ** 0.5
    falling = 0.6 / found.period * min(1.0, 2.0 / found.period)
    assert found.displacement_demand == pytest.approx(
        0.71875 * G * eta * falling * (found.period / (2.0 * math.pi)) ** 2
    )
    assert math.isnan(found.activation_demand) == (state == "slc")


def test_what_does_not_open_passes_by_circolare_2019():
    """A squat body 0.4 m wide and 0.6 m high: 2/3 g against 0.2875 g, more than its displacements are apart."""
    found = circolare_2019(Mechanism((Weight(1.0, 0.2, 0.3, True),)), SPECTRUM, (), SURE)
    assert found.displacement_ratio == pytest.approx(2.0 / 3.0 / 0.2875)
    assert found.displacement_ratio > found.displacement / found.displacement_demand


def test_circolare_2019_aloft():
    """a_Z = 0.71875 g x 1.2 sqrt(1.01) = 8.5004 m/s2; S_eZ(2 s, 8 %) = 3.1595 m/s2."""
    peak = floor_spectrum(SPECTRUM, (FLOOR,), 0.0, 0.08)  # a rigid body feels the floor's peak
    assert peak == pytest.approx(8.5004, abs=5e-5)
    assert floor_spectrum(SPECTRUM, (FLOOR,), 2.0, 0.08) == pytest.approx(3.1595, abs=5e-5)
    high = 1.1 / 0.05**0.5 * (10.0 / 13.0) ** 0.5
    for period in (0.4, 0.5, 0.55):  # the plateau from a to b times T_1
        assert floor_spectrum(SPECTRUM, (FLOOR,), period, 0.08) == pytest.approx(high * peak)
    found = circolare_2019(WALL, SPECTRUM, (FLOOR,), SURE)
    assert found.activation_demand == pytest.approx(peak / 2.0)
    asked = floor_spectrum(SPECTRUM, (FLOOR,), found.period, 0.08) * (found.period / (2.0 * math.pi)) ** 2
    assert found.displacement_demand == pytest.approx(asked)


def test_displacements_aloft_do_not_fall_beyond_the_mode_and_long_periods_follow_the_ground():
    """With a mode at 1.5 s S_eZ b^2 T_1^2/4 pi^2 at T_1 is more than what the falling branch asks at 1.946 s."""
    slow = FloorSettings(period=1.5, participation=1.0)
    found = circolare_2019(WALL, SPECTRUM, (slow,), SURE)
    at_mode = floor_spectrum(SPECTRUM, (slow,), 1.5, 0.08)
    assert found.displacement_demand == pytest.approx(at_mode * (1.1 * 1.5 / (2.0 * math.pi)) ** 2)
    faint = FloorSettings(period=0.3, participation=0.01)
    assert floor_spectrum(SPECTRUM, (faint,), 2.0, 0.08) == pytest.approx(SPECTRUM(2.0, 0.08))


def test_modes_add_as_squares():
    one, other = FLOOR, FloorSettings(period=0.15, participation=-0.4)
    both, *each = (floor_spectrum(SPECTRUM, modes, 0.0, 0.05) for modes in ((one, other), (one,), (other,)))
    assert both == pytest.approx(math.hypot(*each))


def test_en_1998():
    """At z/H 0.8: S_a = 0.2875 g (3 x 1.8/2 - 0.5) = 0.6325 g; gamma_a 1.5, q_a 2: 0.474375 g against 0.1 g."""
    settings = CheckSettings(gamma_a=1.5, q_a=2.0)
    found = en_1998(WALL, SPECTRUM, (FLOOR,), settings)
    assert found.activation_demand == pytest.approx(0.474375 * G)
    assert found.activation_ratio == pytest.approx(0.1 / 0.474375)  # no FC
    assert en_1998(WALL, SPECTRUM, (), CheckSettings()).activation_demand == pytest.approx(0.2875 * G)
    without = en_1998(WALL, SPECTRUM, (FloorSettings(period=0.5),), settings)
    assert math.isnan(without.activation_demand)
    assert "level" in without.statement


def test_an_element_free_to_vibrate_opens_at_its_period():
    """Ground C, T_B 0.2 s: S_e(0.04 s) = 0.2875 g (1 + 0.2 x 1.5) = 0.37375 g; aloft S_eZ(0.04 s, 5 %)."""
    free = replace(WALL, initial_period=0.04)
    ground = circolare_2019(free, SPECTRUM, (), SURE)
    assert ground.activation_demand == pytest.approx(0.37375 * G / 2.0)
    assert ground.displacement_demand == circolare_2019(WALL, SPECTRUM, (), SURE).displacement_demand
    # A_k = 1.1/sqrt(0.05) = 4.9193 times a_Z = 8.5004 m/s2, over 1 + 3.9193 x (1 - 0.04/0.4)^1.6.
    aloft = circolare_2019(free, SPECTRUM, (FLOOR,), SURE).activation_demand
    assert aloft == pytest.approx(4.91935 * 8.5004 / (1.0 + 3.91935 * 0.9**1.6) / 2.0, rel=1e-4)
    # EN 1998-1: S_a = 0.2875 g (3 x 1.8/(1 + 0.92^2) - 0.5).
    asked = en_1998(free, SPECTRUM, (FLOOR,), CheckSettings()).activation_demand
    assert asked == pytest.approx(0.2875 * G * (5.4 / (1.0 + 0.92**2) - 0.5))


@pytest.mark.parametrize(
    ("first", "period", "amplification"),
    [
        (0.4, 0.0, 1.8),
        (0.4, 0.16, 1.8 * 5.0 / (1.0 + 4.0 * 0.5**2)),  # a T_1 = 0.32 s
        (0.4, 0.4, 9.0),
        (0.5, 0.2, 7.2),  # 0.15 to 0.6 s
        (1.0, 1.8, 1.8 * 4.0 / (1.0 + 3.0 * 0.5**2)),  # b T_1 = 1.2 s
        (1.1, 0.5, 4.5),
        (0.4, 2.0, 1.0),  # not less than on the ground
    ],
)
def test_an_element_of_a_framed_building(first, period, amplification):
    """C7.2.11 at z/H 0.8 and alpha S 0.2875, without FC; q_a 2."""
    floor = FloorSettings(period=first, level=0.8)
    found = circolare_2019_frame(replace(WALL, initial_period=period), SPECTRUM, (floor,), CheckSettings(q_a=2.0))
    assert found.activation_demand == pytest.approx(0.2875 * G * amplification / 2.0)
    assert found.activation == pytest.approx(0.1 * G)
    assert "with its level" in circolare_2019_frame(WALL, SPECTRUM, (), CheckSettings()).statement


def test_the_confidence_factor_takes_from_both_circulars():
    for check in (circolare_2009, circolare_2019):
        sure, unsure = (check(WALL, SPECTRUM, (), CheckSettings(confidence_factor=one)) for one in (1.0, 1.35))
        assert unsure.activation == pytest.approx(sure.activation / 1.35)
        assert unsure.period == pytest.approx(sure.period * 1.35**0.5)
    assert CheckSettings().confidence_factor == 1.35
