"""The checks against time histories: cases of small motions, and rates worked by hand."""

import numpy as np
import pandas as pd
import pytest

import rockpulse as rp
from rockpulse.config.check_settings import CheckSettings
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.studies.accuracy.model_form import blocks
from rockpulse.studies.check.against_histories import ALLOWED, check_cases, check_rates, check_study
from rockpulse.studies.rule.cases import StrongMotion
from rockpulse.views.text.study import study_overview


def motion(seed):
    times = np.arange(0.0, 8.0, 0.02)
    rng = np.random.default_rng(seed)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * times + rng.uniform(0.0, 6.0)) for f in (0.5, 0.9, 2.1))
    waves *= 3.0 / np.max(np.abs(waves)) * np.exp(-(((times - 4.0) / 2.0) ** 2))
    return StrongMotion(rp.Record(waves, dt=0.02, id=f"r{seed}", event=str(seed)), f"event {seed}")


@pytest.fixture(scope="module")
def cases():
    return check_cases([motion(seed) for seed in range(2)])


def test_each_channel_is_its_own_code(cases):
    assert len(cases) == 2 * 12
    bodies, record = blocks(), motion(0).record
    first = cases[cases["record"] == "r0"].reset_index(drop=True)
    # Linear: a_0* over PGA/q. Nonlinear: 0.4 d_0 over the displacement of the record's own spectrum at T_s.
    assert first["linear"].to_numpy() == pytest.approx(9.80665 * np.tan(bodies.alpha_c) / (record.pga / 2.0))
    lane = 5
    furthest = bodies.radius[lane] * np.sin(bodies.alpha_c[lane])
    period = 2.0 * np.pi * (0.16 * furthest / (0.84 * 9.80665 * np.tan(bodies.alpha_c[lane]))) ** 0.5
    asked = spectral_acceleration(record, period) * (period / (2.0 * np.pi)) ** 2
    assert first["nonlinear"][lane] == pytest.approx(0.4 * furthest / asked)
    assert (first["both"] == first[["linear", "nonlinear"]].min(axis=1)).all()


def test_the_confidence_factor_lowers_what_is_allowed(cases):
    sure = cases[cases["record"] == "r0"].reset_index(drop=True)
    unsure = check_cases([motion(0)], CheckSettings(confidence_factor=1.35))
    assert unsure["linear"].to_numpy() == pytest.approx(sure["linear"].to_numpy() / 1.35)
    assert (unsure["displacement"] <= sure["displacement"]).all()


def table(rows):
    frame = pd.DataFrame(rows, columns=["event", "factor_50", "allowed"])
    return frame.assign(**dict.fromkeys(ALLOWED, frame["allowed"]))


def test_rates_are_those_counted_by_hand():
    """At factor 1 two overturn, one of them allowed up to 1.2 (missed); two stand, one allowed only to 0.9 (false)."""
    found = check_rates(table([("a", 0.8, 1.2), ("a", 0.9, 0.4), ("b", 3.0, 0.9), ("b", 1.5, 4.0)]))
    one = found[(found["check"] == "linear") & (found["factor"] == 1.0)].iloc[0]
    assert one[["overturned", "missed", "standing", "false"]].tolist() == [2, 1, 2, 1]
    assert (one["missed_share"], one["false_share"]) == (0.5, 0.5)
    assert np.isnan(one["missed_low"])  # two earthquakes have no interval
    whole = found[(found["check"] == "linear") & found["factor"].isna()].iloc[0]
    parts = found[(found["check"] == "linear") & found["factor"].notna()]
    assert whole["missed"] == parts["missed"].sum()
    assert whole["overturned"] + whole["standing"] == 12


def test_intervals_are_over_earthquakes():
    """Forty copies of a case tell no more than one: the interval of ten earthquakes is as wide with one case each."""
    rng = np.random.default_rng(0)
    single = [(f"e{k}", 0.8, 1.2 if rng.uniform() < 0.3 else 0.5) for k in range(10)]
    one, many = (check_rates(table(rows)) for rows in (single, [row for row in single for _ in range(40)]))
    for name in ("missed_low", "missed_high"):
        assert many[name].to_numpy() == pytest.approx(one[name].to_numpy(), nan_ok=True)
    at_one = one[(one["check"] == "linear") & (one["factor"] == 1.0)].iloc[0]
    assert at_one["missed_low"] < at_one["missed_share"] < at_one["missed_high"]


def test_a_study_says_what_holds_in_how_many_cases(cases):
    tree = check_study(cases)
    assert "2 channels of 2 earthquakes, 12 bodies" in tree.attrs["title"]
    statements = tree["statements"].to_dataset()
    rates = tree["rates"].to_dataset().to_dataframe()
    linear = rates[(rates["check"] == "linear") & rates["factor"].isna()].iloc[0]
    passed = statements.sel(statement="linear: safe")
    assert passed["cases"].item() == linear["missed"] + linear["standing"] - linear["false"]
    assert passed["held"].item() == linear["standing"] - linear["false"]
    shown = study_overview(tree)
    assert "Checks at factors on the records" in shown
    assert "what passes the linear check of Circolare 617/2009 and 7/2019 stands" in shown
    with pytest.raises(ValueError, match="at least one strong motion"):
        check_study(cases.iloc[:0])
