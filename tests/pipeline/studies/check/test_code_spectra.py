"""Spectra of codes against numbers worked by hand, and tables of them."""

import itertools
import math

import numpy as np
import pytest

from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError
from rockpulse.studies.check.code_spectra import TabledSpectrum, damping_factor, spectrum_of

G = 9.80665


def test_type_1_on_ground_c():
    """S 1.15, T_B 0.2, T_C 0.6, T_D 2: a_g S = 0.2875 g, plateau 0.71875 g, at 1 s 0.43125 g, at 4 s 0.0539 g."""
    spectrum = spectrum_of(CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C"))
    assert spectrum.ground == pytest.approx(0.2875 * G)
    shown = {0.0: 0.2875, 0.1: 0.503125, 0.4: 0.71875, 1.0: 0.43125, 4.0: 0.71875 * 0.6 * 2.0 / 16.0}
    assert {period: spectrum(period) / G for period in shown} == pytest.approx(shown)


def test_type_2_on_ground_d():
    spectrum = spectrum_of(CheckSettings(spectrum="en_1998_2", ag=0.1, ground="D"))
    assert spectrum.ground == pytest.approx(0.18 * G)
    assert spectrum(0.6) == pytest.approx(0.18 * 2.5 * G * 0.3 / 0.6)
    assert spectrum(2.4) == pytest.approx(0.18 * 2.5 * G * 0.3 * 1.2 / 2.4**2)


def test_ntc_on_ground_c_and_a_ridge():
    """S_S = 1.7 - 0.6 x 2.4 x 0.25 = 1.34, S_T 1.4, T_C = 1.05 x 0.35^0.67 = 0.5197 s, T_D = 2.6 s."""
    spectrum = spectrum_of(CheckSettings(ag=0.25, f0=2.4, tc_star=0.35, ground="C", topography="T4"))
    assert spectrum.ground == pytest.approx(1.34 * 1.4 * 0.25 * G)
    assert spectrum(1.0) == pytest.approx(1.34 * 1.4 * 0.25 * G * 2.4 * 0.51966, rel=1e-4)
    assert spectrum(5.2) == pytest.approx(spectrum(2.6) / 4.0)


@pytest.mark.parametrize(
    ("ground", "weak", "strong"), [("A", 1.0, 1.0), ("B", 1.2, 1.0), ("C", 1.5, 1.0), ("D", 1.8, 0.9), ("E", 1.6, 1.0)]
)
def test_the_soil_factor_of_ntc_lies_between_its_limits(ground, weak, strong):
    for ag, factor in ((0.01, weak), (1.0, strong)):
        found = spectrum_of(CheckSettings(ag=ag, f0=2.5, tc_star=0.3, ground=ground))
        assert found.ground == pytest.approx(factor * ag * G)


def test_damping_lowers_all_but_the_ground():
    """eta(8 %) = sqrt(10/13); at T_B/2 the straight line goes to the lower plateau."""
    spectrum = spectrum_of(CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C"))
    assert damping_factor(0.08) == pytest.approx((10.0 / 13.0) ** 0.5)
    assert spectrum(0.0, 0.08) == spectrum.ground
    assert spectrum(1.0, 0.08) == pytest.approx(spectrum(1.0) * (10.0 / 13.0) ** 0.5)
    assert spectrum(0.1, 0.08) == pytest.approx(spectrum.ground * (1.0 + 0.5 * (2.5 * (10.0 / 13.0) ** 0.5 - 1.0)))


def test_displacements_do_not_fall_with_the_period():
    """A table whose S_De is 0.101 m at 1 s and 0.0101 m at 2 s: the larger one counts up to there."""
    spectrum = TabledSpectrum(np.array([0.0, 1.0, 1.02, 2.0]), np.array([1.0, 4.0, 0.1, 0.1]))
    assert spectrum.displacement(1.0) == pytest.approx(4.0 / (2.0 * math.pi) ** 2)
    assert spectrum.displacement(2.0) == pytest.approx(4.0 / (2.0 * math.pi) ** 2, rel=2e-2)
    code = spectrum_of(CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C"))
    grid = [code.displacement(0.05 * step, 0.08) for step in range(1, 120)]
    assert min(later - earlier for earlier, later in itertools.pairwise(grid)) > -1e-12
    assert grid[-1] == pytest.approx(code(5.95, 0.08) * (5.95 / (2.0 * math.pi)) ** 2)


def test_a_table_is_read_in_its_unit_and_ends_where_it_ends(tmp_path):
    path = tmp_path / "spectrum.csv"
    path.write_text("period [s],sa [g]\n0,0.2\n0.5,0.5\n2,0.1\n")
    spectrum = spectrum_of(CheckSettings(spectrum="table", file="spectrum.csv"), tmp_path)
    assert spectrum.ground == pytest.approx(0.2 * G)
    assert spectrum(1.25) == pytest.approx(0.3 * G)
    assert spectrum(1.25, 0.08) == pytest.approx(0.3 * G * (10.0 / 13.0) ** 0.5)
    with pytest.raises(ConfigError, match=r"the table ends at 2 s, but 2\.5 s is needed"):
        spectrum(2.5)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("period [s],sa [g]\n0.1,0.2\n0.5,0.5\n", "expected 0 s as the first period"),
        ("period [s],sa [g]\n0,0.2\n", "two or more"),
        ("period [s],sa [g]\n0,0.2\n0.5,-1\n", "row 2: expected an acceleration above 0, found -1"),
        ("period [s],sa [g]\n0,0.2\n0.5,1\n0.4,1\n", "row 3: expected periods in ascending order, from 0 s, found 0.4"),
        ("T,Sa\n0,0.2\n0.5,1\n", 'expected the columns "period \\[s\\]"'),
    ],
)
def test_wrong_tables_are_reported(tmp_path, text, told):
    (tmp_path / "spectrum.csv").write_text(text)
    with pytest.raises(ConfigError, match=told):
        spectrum_of(CheckSettings(spectrum="table", file="spectrum.csv"), tmp_path)


def test_no_file_and_no_demand_are_reported(tmp_path):
    with pytest.raises(ConfigError, match="no such file"):
        spectrum_of(CheckSettings(spectrum="table", file="none.csv"), tmp_path)
    with pytest.raises(ConfigError, match="no design spectrum is given"):
        spectrum_of(CheckSettings())
