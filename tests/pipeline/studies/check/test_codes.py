"""The checks of codes against numbers worked by hand (the derivation is in the manual)."""

import math
from dataclasses import replace

import numpy as np
import pytest

import rockpulse as rp
from rockpulse.config.block_settings import FloorSettings
from rockpulse.config.study_settings import CODES, CheckSettings
from rockpulse.errors import ConfigError
from rockpulse.studies.check.codes import (
    circolare_2009,
    circolare_2019,
    code_check,
    en_1998,
    floor_peak,
    floor_spectrum,
)
from rockpulse.studies.check.mechanism import Mechanism, Weight
from rockpulse.studies.check.spectra import spectrum_of

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
    peak = floor_peak(SPECTRUM, (FLOOR,))
    assert peak == pytest.approx(8.5004, abs=5e-5)
    assert floor_spectrum(SPECTRUM, (FLOOR,), 2.0, 0.08) == pytest.approx(3.1595, abs=5e-5)
    high = 1.1 / 0.05**0.5 * (10.0 / 13.0) ** 0.5
    for period in (0.4, 0.5, 0.55):  # the plateau from a to b times T_1
        assert floor_spectrum(SPECTRUM, (FLOOR,), period, 0.08) == pytest.approx(high * peak)
    assert floor_spectrum(SPECTRUM, (FLOOR,), 0.0, 0.08) == pytest.approx(peak)  # a rigid body feels the floor's peak
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
    both = floor_peak(SPECTRUM, (one, other))
    assert both == pytest.approx(math.hypot(floor_peak(SPECTRUM, (one,)), floor_peak(SPECTRUM, (other,))))


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


def test_the_confidence_factor_takes_from_both_circulars():
    for check in (circolare_2009, circolare_2019):
        sure, unsure = (check(WALL, SPECTRUM, (), CheckSettings(confidence_factor=one)) for one in (1.0, 1.35))
        assert unsure.activation == pytest.approx(sure.activation / 1.35)
        assert unsure.period == pytest.approx(sure.period * 1.35**0.5)
    assert CheckSettings().confidence_factor == 1.35


def config(**more):
    wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    return rp.Config(blocks=(wall,), check=CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C", **more))


def test_a_dataset_holds_all_codes_with_their_units():
    found = code_check(config())
    assert found["code"].values.tolist() == list(CODES)
    assert found["activation"].attrs["units"] == "m s-2"
    assert found["activation_ratio"].sel(block="wall", code="circolare_2009").item() == pytest.approx(
        0.1 / 1.35 / 0.14375
    )
    assert "probability" not in found
    assert code_check(config(), ["en_1998"]).sizes["code"] == 1


def test_a_body_that_a_check_cannot_take_is_told_and_the_others_stand():
    held = rp.BlockSettings(
        name="held", width=0.4, height=4.0, mass=1e3, ties=(rp.TieSettings(height=3.0, stiffness=1e6, side="both"),)
    )
    wall = config().blocks[0]
    found = code_check(rp.Config(blocks=(held, wall), check=config().check))
    assert np.isnan(found["multiplier"].values[0])
    assert "tie without yield_force" in found["statement"].values[0, 0]
    assert found["multiplier"].values[1] == pytest.approx(0.1)


def test_what_cannot_be_checked_at_all_is_an_error():
    with pytest.raises(ConfigError, match="no body to check"):
        code_check(rp.Config(check=config().check))
    with pytest.raises(ConfigError, match="expected the demand of the code"):
        code_check(rp.Config(blocks=config().blocks))
    with pytest.raises(ConfigError, match="expected some of circolare_2009"):
        code_check(config(), ["asce"])


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"ag": 0.2}, "f0: ntc needs it beside ag"),
        ({"f0": 2.4, "tc_star": 0.3}, "ag: ntc needs it beside f0, tc_star"),
        ({"spectrum": "en_1998_1", "ag": 0.2, "f0": 2.4}, 'f0: it belongs to spectrum = "ntc"'),
        ({"spectrum": "en_1998_2", "ag": 0.2, "topography": "T2"}, "put its factor into ag"),
        ({"spectrum": "table", "ag": 0.2}, "are in its file; drop it"),
        ({"ag": 0.2, "file": "s.csv"}, 'file: it belongs to spectrum = "table"'),
        ({"ag": 25.0}, "ag: expected a number in g > 0 and <= 5, found 25.0"),
        ({"confidence_factor": 0.9}, "confidence_factor: expected a number >= 1"),
        ({"q": 0.5}, "q: expected a number >= 1"),
        ({"ground": "F"}, "ground: expected one of"),
    ],
)
def test_wrong_parameters_are_told(given, told):
    with pytest.raises(ConfigError, match=told):
        CheckSettings(**given)


def test_of_two_senses_the_worse_acceleration_and_the_worse_displacement_count():
    """0.8 x 4 m, 0.12 m off its middle, 6 t, under type 1, ground B, 0.3 g; a tie of 5 kN at 3.5 m breaks after 3 cm.

    Towards theta > 0 alpha_0 = 0.28/2 + 17.5/117.68 = 0.2887 and d_0 = 0.28 m (the tie is broken by then), towards
    theta < 0 alpha_0 = 0.52/2 = 0.26 and d_0 = 0.52 m: the first to open is not the one that falls first.
    """
    tie = rp.TieSettings(height=3.5, stiffness=1e6, yield_force=5e3, ultimate=0.03)
    body = rp.BlockSettings(name="a", width=0.8, height=4.0, offset=0.12, mass=6000.0, ties=(tie,))
    settings = CheckSettings(spectrum="en_1998_1", ag=0.3, ground="B", confidence_factor=1.0)
    found = code_check(rp.Config(blocks=(body,), check=settings))
    assert found["multiplier"].item() == pytest.approx(0.26)
    assert found["activation_sense"].values.tolist() == [["negative"] * 3]
    assert found["displacement_sense"].values.tolist() == [["positive", "positive", ""]]
    assert found["displacement"].values[0, :2] == pytest.approx([0.112, 0.112])
    assert np.all(found["displacement_ratio"].values[0, :2] < 0.9)
    free = replace(body, ties=(replace(tie, side="negative"),))
    other = code_check(rp.Config(blocks=(free,), check=settings))
    # The tie on the other side leaves theta > 0 at alpha_0 = 0.14, and its displacement as it was.
    assert other["multiplier"].item() == pytest.approx(0.14)
    assert other["displacement"].values[0, :2] == pytest.approx([0.112, 0.112])


def test_a_table_that_ends_early_costs_only_what_it_does_not_reach(tmp_path):
    (tmp_path / "short.csv").write_text("period [s],Sa [g]\n0,0.3\n0.2,0.7\n1,0.3\n")
    settings = CheckSettings(spectrum="table", file="short.csv", confidence_factor=1.0)
    wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    found = code_check(rp.Config(blocks=(wall,), check=settings, folder=tmp_path))
    assert found["activation_ratio"].values[0] == pytest.approx([0.1 / 0.15, 0.1 / 0.15, 0.1 / 0.3])
    assert np.isnan(found["displacement_ratio"].values).all()
    told = found["statement"].values[0].tolist()
    assert "the table ends at 1 s, and 1.24 s are asked for; continue it" in told[0]
    assert "1.95 s are asked for" in told[1]
    assert told[2] == ""
