"""Hazard: a power law, curves, and the files that they come in."""

import math

import numpy as np
import pytest

import rockpulse as rp
from rockpulse.config.configuration import Config, config_from_text
from rockpulse.config.study_settings import HazardSettings
from rockpulse.studies.risk.hazard_files import hazard_of

G = 9.80665


def written(folder, text, name="curve.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_curve_through_a_power_law_is_that_power_law():
    law = rp.PowerLawHazard(k0=2e-3, k=2.2, unit="g")
    level = G * np.array([0.05, 0.1, 0.3, 1.0])
    curve = rp.HazardCurve("pga", level, law.rate(level))
    at = G * np.array([0.01, 0.07, 0.5, 4.0])
    assert curve.rate(at) == pytest.approx(law.rate(at), rel=1e-12)
    assert curve.log_density(np.log(at)) == pytest.approx(law.log_density(np.log(at)), abs=1e-12)
    assert law.rate(G) == pytest.approx(2e-3)
    # -dH/d ln x by differences.
    slope = (law.rate(at) - law.rate(1.0001 * at)) / math.log(1.0001)
    assert np.exp(law.log_density(np.log(at))) == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "measure", "level", "rate"),
    [
        ("pga [g],rate\n0.1,1e-2\n0.4,1e-3\n", "pga", G * 0.1, 1e-2),
        ("# a warning\nPGV [cm/s], rate [1/year]\n10,1e-2\n40,1e-3\n", "pgv", 0.1, 1e-2),
        ("sa(1.0) [g];probability in 50 years\n0.1;0.5\n0.4;0.1\n0.8;0.0\n", "sa_1", G * 0.1, math.log(2.0) / 50.0),
        ("SI [m/s],probability in 1 year\n0.1,0.01\n0.4,0.001\n", "si", 0.1, -math.log1p(-0.01)),
        ("TR [years],ag [g],F0,TC*\n30,0.05,2.3,0.28\n475,0.2,2.4,0.33\n", "pga", G * 0.05, 1.0 / 30.0),
        ("TR [years],F0,ag [g/10]\n475,2.4,2.0\n30,2.3,0.5\n", "pga", G * 0.05, 1.0 / 30.0),
        (
            "#,,,,,\"generated_by='OpenQuake engine', kind='mean', investigation_time=50.0, imt='SA(0.5)'\"\n"
            "lon,lat,depth,poe-0.1000000,poe-0.4000000,poe-2.0000000\n13.4,42.35,0.0,5.0E-01,1.0E-01,0.0\n",
            "sa_0.5",
            G * 0.1,
            math.log(2.0) / 50.0,
        ),
        (
            '# investigation_time=1.0,imt="PGV"\nlon,lat,depth,poe-10,poe-40\n0,0,0,0.1,0.01\n',
            "pgv",
            0.1,
            -math.log1p(-0.1),
        ),
        (
            "# mean, investigation_time=50.0, imt=SA(0.5)\nlon,lat,depth,poe-0.1,poe-0.4\n0,0,0,0.5,0.1\n",
            "sa_0.5",
            G * 0.1,
            math.log(2.0) / 50.0,
        ),
    ],
)
def test_files_are_read_with_their_units(tmp_path, text, measure, level, rate):
    curve = rp.load_hazard(written(tmp_path, text))
    assert curve.measure == measure
    assert curve.level.size == 2
    assert curve.level[0] == pytest.approx(level)
    assert curve.rates[0] == pytest.approx(rate)


def test_a_site_is_chosen_among_several(tmp_path):
    text = "# investigation_time=1.0, imt='PGA'\nlon,lat,depth,poe-0.1,poe-0.4\n0,0,0,0.1,0.01\n13,42,0,0.2,0.02\n"
    path = written(tmp_path, text)
    with pytest.raises(rp.ConfigError, match="curves of 2 sites; select one"):
        rp.load_hazard(path)
    near = rp.load_hazard(path, (13.0, 42.1))
    assert near.rates[0] == pytest.approx(-math.log1p(-0.2))
    # A tenth of a degree of a meridian: 6371 km pi/1800.
    assert near.warnings == ("11.1 km from the site",)
    assert near.words == f"{path}, place 13 E 42 N: 2 points of pga in g"
    settings = HazardSettings(file="curve.csv", longitude=0.1, latitude=0.1)
    assert hazard_of(settings, tmp_path).rates[0] == pytest.approx(-math.log1p(-0.1))
    # Longitude and latitude the wrong way round, or a site that the file does not hold.
    with pytest.raises(rp.ConfigError, match=r"nearest to the site 42 E 13 N is .* km away; expected one within 50 km"):
        rp.load_hazard(path, (42.0, 13.0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected columns"),
        ("x,y\n1,2\n", "expected columns .* found the columns x, y"),
        ("pga [furlong],rate\n0.1,0.2\n", "expected a unit of pga among m/s2, .* found 'furlong'"),
        ("pgv [g],rate\n0.1,0.2\n", "expected a unit of pgv among m/s, cm/s"),
        ("sa(0.7) [g],rate\n0.1,0.2\n", "expected a measure among .* found 'sa_0.7'"),
        ("pga [g],rate\n0.1,0.2\n", "two or more levels at which the rate is finite and not zero, found 1 of 1"),
        ("LON,LAT,T30ag [g],T50ag [g]\n13,42,0,0\n", "place 13 E 42 N: expected positive levels in ascending order"),
        ("pga [g],rate\n0.1,0.01\n0.3,0.02\n", "positive rates that do not increase"),
        ("pga [g],rate\n0.1,0.01\n0.1,0.01\n", "positive levels in ascending order"),
        ("pga [g],rate\n0.1,0.01\n0.2,0.01\n", "the last two rates are equal"),
        ("pga [g],probability in 50 years\n0.1,1.2\n0.2,0.01\n", "probabilities from 0 to 1"),
        ("TR [years],PGA\n30,0.1\n", 'expected the column "ag'),
        ("# investigation_time=1.0, x=2\nlon,lat,poe-0.1\n0,0,0.1\n", "line 1: expected investigation_time"),
        ("# investigation_time=1.0, imt='PGA'\nlon,lat,poe-low\n0,0,0.1\n", "line 2: expected a number after poe-"),
        ("# investigation_time=1.0, imt='PGA'\nx,y\n0,0\n", "line 2: expected lon, lat and poe-LEVEL"),
    ],
)
def test_a_wrong_file_says_what_was_expected(tmp_path, text, message):
    path = written(tmp_path, text)
    with pytest.raises(rp.ConfigError, match=message) as raised:
        rp.load_hazard(path)
    assert "curve.csv" in str(raised.value)


def test_the_integral_of_a_rate_is_exact_between_the_bends_of_a_curve():
    """A piece of slope 3, one that does not fall and one of slope 2: r/3 (1 - 2^-3) and so on, by hand."""
    curve = rp.HazardCurve("pga", [1.0, 2.0, 4.0, 8.0], [8e-2, 1e-2, 1e-2, 2.5e-3])
    last = 1e-2 / 2.0
    flat = 1e-2 * math.log(2.0)
    levels = np.log([1.0, 2.0, 3.0, 4.0, 5.0, 16.0, 0.5])
    expected = [
        8e-2 / 3.0 * (1.0 - 2.0**-3) + flat + last,
        flat + last,
        1e-2 * math.log(4.0 / 3.0) + last,
        last,
        1e-2 * (4.0 / 5.0) ** 2 / 2.0,
        1e-2 / 16.0 / 2.0,
        8.0 * 8e-2 / 3.0 * (1.0 - 4.0**-3) + flat + last,
    ]
    assert curve.integral_above(levels) == pytest.approx(expected, rel=1e-12)
    assert rp.PowerLawHazard(1e-3, 2.0).integral_above(np.log([2.0])) == pytest.approx(1e-3 / 4.0 / 2.0)


def test_a_file_that_is_none_is_refused(tmp_path):
    with pytest.raises(rp.ConfigError, match="no such file; expected a hazard curve"):
        rp.load_hazard(tmp_path)
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(rp.ConfigError, match="expected a hazard curve in UTF-8"):
        rp.load_hazard(tmp_path / "binary.csv")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"k0": 1e-4}, "needs both keys"),
        ({"file": "x.csv", "k0": 1e-4, "k": 2.0}, "expected a file or the power law"),
        ({"file": "x.csv", "latitude": 2.0}, "expected both or neither"),
        ({"k0": -1.0, "k": 2.0}, "k0: expected a positive number in 1/year"),
    ],
)
def test_a_section_that_contradicts_itself_is_refused(given, message):
    with pytest.raises(rp.ConfigError, match=message):
        HazardSettings(**given)


def test_a_power_law_comes_from_the_section_and_the_section_survives_as_text():
    settings = HazardSettings(k0=1e-4, k=2.5, measure="pgv", unit="cm/s")
    config = config_from_text(Config(hazard=settings).as_text())
    assert config.hazard == settings
    assert hazard_of(config.hazard).rate(0.01) == pytest.approx(1e-4)
    with pytest.raises(rp.ConfigError, match="found none of these"):
        hazard_of(HazardSettings())
    with pytest.raises(rp.ConfigError, match="a power law has no site"):
        hazard_of(HazardSettings(k0=1e-4, k=2.5, longitude=13.0, latitude=42.0))
    with pytest.raises(rp.ConfigError, match="expected a unit of pgv"):
        hazard_of(HazardSettings(k0=1e-4, k=2.5, measure="pgv", unit="g"))
    # Without a unit it is that in SI of the measure.
    assert hazard_of(HazardSettings(k0=1e-4, k=2.5, measure="pgv")).unit == "m/s"
    assert hazard_of(HazardSettings(k0=1e-4, k=2.5)).unit == "m/s2"
    amplified = hazard_of(HazardSettings(k0=1e-4, k=2.0, soil_factor=1.5))
    assert amplified.rate(3.0) == pytest.approx(1e-4 * (3.0 / 1.5) ** -2.0)


PERIODS = (30, 50, 72, 101, 140, 201, 475, 975, 2475)
NODES = {13111: ("13,3910", "42,3730", 0.78), 13112: ("13,4590", "42,3750", 0.80)}


def grid(above):
    """Made-up numbers in the layout of annex B of NTC 2008: nine triples for each node, a_g in g/10."""
    names = [f"{'' if above else f'T{period}'}{name}" for period in PERIODS for name in ("ag", "F0", "Tc*")]
    rows = [";".join(["ID", "LON", "LAT", *names])]
    for node, (east, north, first) in NODES.items():
        triples = [f"{first * (period / 30.0) ** 0.4:.4f};2,4;0,30".replace(".", ",") for period in PERIODS]
        rows.append(";".join([str(node), east, north, *triples]))
    top = ";;;" + ";".join(f"TR = {period};;" for period in PERIODS)
    return "\n".join([top, *rows] if above else rows) + "\n"


@pytest.mark.parametrize("above", [False, True])
def test_the_grid_of_the_italian_norm_has_nine_return_periods_a_node(tmp_path, above):
    curve = rp.load_hazard(written(tmp_path, grid(above)), (13.46, 42.37), soil_factor=1.2)
    assert curve.level.size == 9
    assert curve.level[6] == pytest.approx(0.1 * G * 0.8 * (475 / 30) ** 0.4, rel=1e-4)
    assert curve.rate(1.2 * curve.level) == pytest.approx(1.0 / np.array(PERIODS), rel=1e-9)
    assert "place 13.46 E 42.38 N" in curve.words
    assert curve.warnings[1] == "a_g read in g/10"
    assert "times the soil factor 1.2" in curve.words
    # Without a soil factor it is said that the levels are those on rock.
    bare = rp.load_hazard(written(tmp_path, grid(above)), (13.46, 42.37))
    assert "a_g is given for rock" in bare.warnings[-1]
