"""Annual frequencies from a fragility file: against the closed form, with bands and what is said of them.

What bodies that have stood for long say of a hazard.
"""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from bursts import packet

import rockpulse as rp
from rockpulse import models
from rockpulse.storage.variables.risk import RiskStatus
from rockpulse.studies.fragility.likelihood import ABOVE, FAMILIES, NOT_ABOVE, Observations
from rockpulse.studies.risk.integral import band_of, fitted_lines, integrate


@pytest.fixture(scope="module")
def tree():
    records = [packet(number, number // 2, seconds=5.0) for number in range(16)]
    settings = rp.FragilitySettings(
        measures=("pga", "pgv", "velocity_ratio"), overturning_model="lognormal", limit_states=("uplift", "overturning")
    )
    return rp.fragility(
        records,
        rp.Config(fragility=settings),
        bodies={"wall": rp.models.Block(width=0.3, height=2.4), "rock": rp.models.Block(width=3.0, height=6.0)},
    )


@pytest.fixture(scope="module")
def law():
    return rp.PowerLawHazard(k0=2e-3, k=2.0, measure="pgv")


def test_the_frequency_is_that_of_the_fitted_curve(tree, law):
    found = rp.risk(tree, law, years=100.0, resamples=0)
    curve = tree["fragility"].to_dataset().sel(limit_state="overturning", measure="pgv", block="wall")
    expected = 2e-3 * float(curve["median"]) ** -2.0 * math.exp(0.5 * (2.0 * float(curve["beta"])) ** 2)
    wall = found.sel(block="wall")
    assert float(wall["frequency"]) == pytest.approx(expected, rel=1e-6)
    assert float(wall["probability"]) == pytest.approx(1.0 - math.exp(-100.0 * expected))
    assert float(wall["survival"]) == pytest.approx(math.exp(-100.0 * expected))
    assert np.isnan(wall["frequency_low"])
    assert float(wall["share"].sum()) == pytest.approx(0.998, abs=1e-3)
    assert (wall["bin_low"].values[1:] == wall["bin_high"].values[:-1]).all()
    # A power law in other units, and a curve through it, are the same hazard.
    again = rp.PowerLawHazard(k0=2e-3 * 100.0**2.0, k=2.0, measure="pgv", unit="cm/s")
    level = np.geomspace(0.01, 20.0, 30)
    for other in (again, rp.HazardCurve("pgv", level, law.rate(level))):
        same = rp.risk(tree, other, resamples=0).sel(block="wall")
        assert float(same["frequency"]) == pytest.approx(expected, rel=1e-6)


def test_the_levels_that_nothing_was_looked_at_are_reported(tree, law):
    whole = rp.risk(tree, law, resamples=0).sel(block="wall")
    # The curve ends at 0.3 m/s, below the strongest levels that records were looked at.
    curve = rp.HazardCurve("pgv", [0.05, 0.3], law.rate(np.array([0.05, 0.3])))
    found = rp.risk(tree, curve, resamples=0).sel(block="wall")
    assert float(found["frequency"]) == pytest.approx(float(whole["frequency"]), rel=1e-6)
    edges = np.log([*whole["bin_low"].values, whole["bin_high"].values[-1]])
    below = np.interp(math.log(0.3), edges, [0.0, *np.cumsum(whole["share"].values)])
    assert float(found["above"]) == pytest.approx(1.0 - below, abs=0.02)
    shown = f"{float(found['above']):.0%} of its frequency comes from levels above 0.3 m/s, where the hazard curve ends"
    assert str(found["warning"].values) == shown
    assert float(found["above"]) > float(whole["above"])


def drawn(earthquakes, seed=3):
    """Observations of capacities whose logarithm scatters by 0.25 between and 0.35 within earthquakes of 2 records."""
    random = np.random.default_rng(seed)
    event = np.repeat(np.arange(earthquakes), 2)
    capacity = np.exp(0.25 * random.standard_normal(earthquakes)[event] + 0.35 * random.standard_normal(event.size))
    level = np.tile([0.4, 0.6, 0.8, 1.1, 1.5, 2.2], event.size)
    kind = np.where(np.repeat(capacity, 6) <= level, NOT_ABOVE, ABOVE)
    return Observations.of(level, kind, np.repeat(event, 6).astype(str))


@pytest.mark.sweep
def test_the_band_is_over_earthquakes():
    rows, hazard, family = drawn(12), rp.PowerLawHazard(1e-3, 2.5), FAMILIES["lognormal"]
    lines = fitted_lines(rows, family)
    middle = integrate(family, (lines[0, 0], lines[0, 1]), hazard).frequency
    found, narrow = (
        band_of(rows, family, hazard, lines, math.log(middle), confidence, 40, 0) for confidence in (0.9, 0.5)
    )
    assert 0.0 < found.low < middle < found.high
    assert found.lost == 0.0
    assert found.low < narrow.low < narrow.high < found.high


@pytest.mark.slow
def test_draws_that_rest_on_one_earthquake_are_lost_and_reported(tree, law):
    """Draws with no curve without one of their earthquakes have no standard error: left out, they would narrow it."""
    found = rp.risk(tree, law, resamples=200).sel(block="wall")
    assert np.isnan(found["frequency_low"])
    assert str(found["statement"].values) == (
        "no band: 44% of the resamples give no curve, or no curve without one of their earthquakes"
    )


@pytest.mark.sweep
def test_few_earthquakes_are_reported(tree):
    """In PGA the levels of these records overlap enough for a band of 8 earthquakes, in which some draws are lost."""
    found = rp.risk(tree, rp.PowerLawHazard(k0=2e-3, k=2.0), resamples=200).sel(block="wall")
    shown = str(found["statement"].values)
    assert "the band is too narrow: 8 earthquakes, but 14 are needed" in shown
    assert float(found["probability_high"]) == pytest.approx(-math.expm1(-50.0 * float(found["frequency_high"])))


@pytest.mark.sweep
def test_no_ground_below_uplift_overturns_a_body(tree):
    law = rp.PowerLawHazard(k0=2e-3, k=30.0, measure="pga")
    wall = models.Block(width=0.3, height=2.4)
    lifting = wall.gravity * math.tan(wall.alpha_c)
    assert float(tree["fragility"]["uplift_acceleration"].sel(block="wall")) == pytest.approx(lifting)
    found = rp.risk(tree, law, resamples=100).sel(block="wall")
    assert float(found["bin_low"].min()) >= lifting * (1.0 - 1e-9)
    assert float(found["frequency"]) < float(law.rate(lifting))
    assert float(found["frequency_low"]) < float(found["frequency"]) < float(found["frequency_high"])
    # Without it the curve's tail alone would count where the hazard is so steep.
    other, curves = tree.copy(), tree["fragility"].to_dataset()
    other["fragility"] = curves.assign(uplift_acceleration=curves["uplift_acceleration"] * np.nan)
    tail = rp.risk(other, law, resamples=0)["frequency"].sel(block="wall")
    assert float(tail) > 1e3 * float(found["frequency"])


def test_a_body_without_a_curve_has_no_frequency_and_says_why(tree, law):
    rock = rp.risk(tree, law, resamples=0).sel(block="rock")
    assert np.isnan(rock["frequency"])
    assert str(rock["statement"].values).startswith("no curve: none of 16 records reached the limit state")
    assert int(rock["status"]) == RiskStatus.NO_CURVE


def test_a_fragility_that_falls_too_little_has_no_frequency(tree):
    settings = tree.attrs["configuration"].replace('overturning_model = "lognormal"', 'overturning_model = "logistic"')
    other = tree.copy()
    other.attrs["configuration"] = settings
    found = rp.risk(other, rp.PowerLawHazard(k0=1e-3, k=30.0, measure="pgv")).sel(block="wall")
    assert np.isnan(found["frequency"])
    assert int(found["status"]) == RiskStatus.NO_LIMIT
    assert "towards small levels the fragility decreases more slowly than the hazard" in str(found["statement"].values)


def test_uplift_in_pga_is_the_rate_of_the_acceleration_that_lifts(tree):
    """g b/h = 9.80665 0.3/2.4 = 1.22583 m/s2 for the wall, half of g for the rock, whatever records were scaled to."""
    found = rp.risk(tree, rp.PowerLawHazard(k0=2e-3, k=2.0), "uplift")
    assert found["frequency"].values == pytest.approx([2e-3 * 1.2258312**-2.0, 2e-3 * 4.903325**-2.0], rel=1e-6)
    assert "is exact and has no band" in str(found["statement"].values[0])
    curve = rp.HazardCurve("pga", [0.5, 2.0], [8e-3, 5e-4])
    wall = rp.risk(tree, curve, "uplift").sel(block="wall")
    assert float(wall["above"]) == pytest.approx(5e-4 / float(wall["frequency"]), rel=1e-6)
    assert "where the hazard curve ends" in str(wall["warning"].values)
    # In another measure a curve is fitted, or the statement of the fragility says why not.
    other = rp.risk(tree, rp.PowerLawHazard(k0=2e-3, k=2.0, measure="pgv"), "uplift", resamples=0)
    assert all(
        len(words) > 20
        for words, known in zip(other["statement"].values, np.isfinite(other["frequency"].values), strict=True)
        if not known
    )


def test_what_is_taken_for_granted_is_reported(tree, law):
    shown = rp.risk(tree, law, resamples=0).attrs
    assert "records scaled to levels (stripes); lognormal" in shown["fragility"]
    assert "16 records of 8 earthquakes, equally weighted" in shown["fragility"]
    assert "an arbitrary horizontal component" in shown["hazard_conditions"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"limit_state": "collapse"}, "limit state: expected one of uplift, overturning"),
        (
            {"hazard": rp.PowerLawHazard(1e-3, 2.0, "sa_1")},
            "the hazard is given in sa_1, but the fragility in pga, pgv",
        ),
        ({"years": 0.0}, "years, confidence, resamples"),
        ({"confidence": 1.0}, "years, confidence, resamples"),
    ],
)
def test_what_is_not_there_is_refused(tree, law, options, message):
    given = {"hazard": law} | options
    with pytest.raises(rp.RockpulseError, match=message):
        rp.risk(tree, given.pop("hazard"), **given)


def test_results_of_an_assessment_are_no_fragility(law):
    with pytest.raises(rp.ResultsError, match="expected a fragility file, found an assessment file"):
        rp.risk(xr.DataTree(), law)


def risk(frequency):
    low, high = 0.5 * np.array(frequency), 2.0 * np.array(frequency)
    values = {"frequency": frequency, "frequency_low": low, "frequency_high": high}
    return xr.Dataset({name: ("body", value) for name, value in values.items()}, {"body": ["a", "b", "c"]})


def test_an_age_leaves_a_largest_frequency():
    """ln 20 = 2.995732: 10,000 years leave 2.9957e-4 a year, a third of 8.9872e-4, three times 9.9858e-5."""
    found = rp.standing_test(risk([8.987197e-4, 9.985774e-5, np.nan]), 1e4)
    assert found["largest"].values == pytest.approx(2.995732e-4, rel=1e-6)
    assert found["factor"].values[:2] == pytest.approx([1.0 / 3.0, 3.0], rel=1e-6)
    assert found["contradicted"].values.tolist() == [1, 0, -1]
    # exp(-8.987197), and at half and twice the frequency.
    assert found["chance"].values[0] == pytest.approx(1.25e-4, rel=1e-3)
    assert found["chance_low"].values[0] == pytest.approx(1.25e-4**2, rel=2e-3)
    assert found["chance_high"].values[0] == pytest.approx(1.25e-4**0.5, rel=1e-3)
    # The hazard times the factor leaves the chance 5 %.
    assert np.exp(-found["factor"].values[0] * 8.987197) == pytest.approx(0.05, rel=1e-6)


@pytest.mark.parametrize("given", [{"age": 0.0}, {"age": 10.0, "confidence": 1.0}])
def test_what_is_no_age_is_refused(given):
    with pytest.raises(rp.ConfigError, match="age, confidence"):
        rp.standing_test(risk([1.0, 1.0, 1.0]), **given)


COVERAGE = Path(__file__).parents[4] / "benchmarks" / "risk_coverage.py"


@pytest.mark.slow
@pytest.mark.parametrize("place", [0, 1])
def test_bands_of_fourteen_earthquakes_cover_what_they_say(place):
    """Between 0.85 and 0.95 at a nominal 0.90, give or take the binomial error of 200 cases, 0.025 at 0.85."""
    spec = importlib.util.spec_from_file_location("risk_coverage", COVERAGE)
    benchmark = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(benchmark)
    assert benchmark.SETTINGS[place][0] == 14
    bands, low, high, _ = benchmark.coverage(place, cases=200, seed=31)
    assert bands >= 195
    inside = 1.0 - (low + high) / bands
    error = math.sqrt(0.85 * 0.15 / bands)
    assert 0.85 - 1.64 * error <= inside <= 0.95 + 1.64 * error
