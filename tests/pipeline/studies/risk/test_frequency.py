"""Annual frequencies from a fragility file: against the closed form, with bands and what is said of them."""

import math

import numpy as np
import pytest

import rockpulse as rp
from rockpulse import models
from rockpulse.studies.risk.integral import power_law_frequency

T = np.arange(0.0, 5.0, 0.02)


def shaking(number, event):
    rng = np.random.default_rng(number)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * T + rng.uniform(0.0, 6.0)) for f in (0.6, 1.1, 2.3))
    peak = 3.0 * waves / np.max(np.abs(waves))
    return rp.Record(
        peak * np.exp(-(((T - 2.0) / 1.0) ** 2)), dt=0.02, id=f"r{number}", event=f"e{event}", processed=True
    )


@pytest.fixture(scope="module")
def tree():
    records = [shaking(number, number // 2) for number in range(16)]
    settings = rp.FragilitySettings(
        measures=("pga", "pgv", "velocity_ratio"), overturning_model="lognormal", limit_states=("uplift", "overturning")
    )
    return rp.fragility_curves(
        records,
        rp.Config(fragility=settings),
        blocks={"wall": rp.models.Block(width=0.3, height=2.4), "rock": rp.models.Block(width=3.0, height=6.0)},
    )


@pytest.fixture(scope="module")
def law():
    return rp.PowerLawHazard(k0=2e-3, k=2.0, measure="pgv")


def test_the_frequency_is_that_of_the_fitted_curve(tree, law):
    found = rp.annual_frequency(tree, law, years=100.0, resamples=0)
    curve = tree["fragility"].to_dataset().sel(limit_state="overturning", measure="pgv", block="wall")
    expected = power_law_frequency(2e-3, 2.0, float(curve["median"]), float(curve["beta"]))
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
        same = rp.annual_frequency(tree, other, resamples=0).sel(block="wall")
        assert float(same["frequency"]) == pytest.approx(expected, rel=1e-6)


def test_the_levels_that_nothing_was_looked_at_are_told(tree, law):
    whole = rp.annual_frequency(tree, law, resamples=0).sel(block="wall")
    # The curve ends at 0.3 m/s, below the strongest levels that records were looked at.
    curve = rp.HazardCurve("pgv", [0.05, 0.3], law.rate(np.array([0.05, 0.3])))
    found = rp.annual_frequency(tree, curve, resamples=0).sel(block="wall")
    assert float(found["frequency"]) == pytest.approx(float(whole["frequency"]), rel=1e-6)
    edges = np.log([*whole["bin_low"].values, whole["bin_high"].values[-1]])
    below = np.interp(math.log(0.3), edges, [0.0, *np.cumsum(whole["share"].values)])
    assert float(found["above"]) == pytest.approx(1.0 - below, abs=0.02)
    told = f"{float(found['above']):.0%} of it comes from levels above 0.3, where nothing was looked at"
    assert told in str(found["statement"].values)
    assert float(found["above"]) > float(whole["above"])


def test_the_band_is_over_earthquakes_and_says_where_these_are_few(tree, law):
    found, again = (rp.annual_frequency(tree, law, resamples=200).sel(block="wall") for _ in range(2))
    low, middle, high = (float(found[name]) for name in ("frequency_low", "frequency", "frequency_high"))
    assert 0.0 < low < middle < high
    assert (low, high) == (float(again["frequency_low"]), float(again["frequency_high"]))
    narrow = rp.annual_frequency(tree, law, resamples=200, confidence=0.5).sel(block="wall")
    assert low < float(narrow["frequency_low"]) < float(narrow["frequency_high"]) < high
    assert "the band is too narrow: 8 earthquakes, 14 are needed" in str(found["statement"].values)
    assert float(found["probability_high"]) == pytest.approx(-math.expm1(-50.0 * high))


def test_no_ground_below_uplift_overturns_a_body(tree):
    law = rp.PowerLawHazard(k0=2e-3, k=30.0, measure="pga")
    wall = models.Block(width=0.3, height=2.4)
    lifting = wall.gravity * math.tan(wall.alpha_c)
    assert float(tree["fragility"]["uplift_acceleration"].sel(block="wall")) == pytest.approx(lifting)
    found = rp.annual_frequency(tree, law, resamples=100).sel(block="wall")
    assert float(found["bin_low"].min()) >= lifting * (1.0 - 1e-9)
    assert float(found["frequency"]) < float(law.rate(lifting))
    assert float(found["frequency_low"]) < float(found["frequency"]) < float(found["frequency_high"])
    # Without it the curve's tail alone would count where the hazard is so steep.
    other = tree.copy()
    other["fragility"] = tree["fragility"].to_dataset().drop_vars("uplift_acceleration")
    assert float(rp.annual_frequency(other, law, resamples=0)["frequency"].sel(block="wall")) > 1e3 * float(
        found["frequency"]
    )


def test_a_body_without_a_curve_has_no_frequency_and_says_why(tree, law):
    rock = rp.annual_frequency(tree, law).sel(block="rock")
    assert np.isnan(rock["frequency"])
    assert "no fragility curve" in str(rock["statement"].values)


def test_a_fragility_that_falls_too_little_has_no_frequency(tree):
    settings = tree.attrs["configuration"].replace('overturning_model = "lognormal"', 'overturning_model = "logistic"')
    other = tree.copy()
    other.attrs["configuration"] = settings
    found = rp.annual_frequency(other, rp.PowerLawHazard(k0=1e-3, k=30.0, measure="pgv")).sel(block="wall")
    assert np.isinf(found["frequency"])
    assert "falls towards small levels less than the hazard rises" in str(found["statement"].values)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"limit_state": "collapse"}, "limit state: expected one of uplift, overturning"),
        ({"hazard": rp.PowerLawHazard(1e-3, 2.0, "sa_1")}, "the hazard is of sa_1, the fragility has pga, pgv"),
        ({"years": 0.0}, "years, confidence, resamples"),
        ({"confidence": 1.0}, "years, confidence, resamples"),
    ],
)
def test_what_is_not_there_is_refused(tree, law, options, message):
    given = {"hazard": law} | options
    with pytest.raises(rp.RockpulseError, match=message):
        rp.annual_frequency(tree, given.pop("hazard"), **given)


def test_results_of_an_assessment_are_no_fragility(law):
    tree = rp.assess([shaking(1, 1)], blocks={"wall": rp.models.Block(width=0.3, height=2.4)})
    with pytest.raises(rp.ResultsError, match="results of assess have none"):
        rp.annual_frequency(tree, law)
