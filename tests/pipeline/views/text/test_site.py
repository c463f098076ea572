"""The text of a site file."""

import re

import numpy as np
import pytest
from site_spectra import site_of, usual_site

import rockpulse as rp
from rockpulse import CalibrationSettings
from rockpulse.errors import Failure
from rockpulse.models import Block
from rockpulse.views.text.site import design, site_overview

TIME = 0.01 * np.arange(900)


@pytest.fixture(scope="module")
def tree():
    """Six bursts of six events, and a body that all of them overturn."""
    config = rp.Config(calibration=CalibrationSettings(method="statistics", bootstrap=100))
    records = [
        rp.Record(
            (2.0 + 0.4 * number)
            * np.sin(2.0 * np.pi * TIME * (0.8 + 0.05 * number))
            * np.exp(-(((TIME - 4) / 2) ** 2)),
            dt=0.01,
            id=f"burst{number}",
            event=f"Quake {'ABCDEF'[number] * 3}",
            processed=True,
        )
        for number in range(6)
    ]
    blocks = {"stele": Block(0.2, 3.0), "pier": Block(1.0, 4.0)}
    return rp.calibrate(records, config, blocks, failures=[Failure("a.AT2", "read", "why", "failed")])


def test_everything_is_there_and_nothing_is_nan(tree):
    text = site_overview(tree)
    site = tree["site"].to_dataset()
    for words in (
        "FEW RECORDS: 6",
        "Calibrated on 6 records of 6 earthquakes, not scaled: Quake AAA (1)",
        "main impulse I [m/s]",
        "number of main impulses",
        "I_s/I",
        "dispersion, low, high: of the logarithm.",
        "correlation",
        f"I = {float(site['design'][0]):.3g} m/s",
        "nominal 84 %",
        "stele",
        "OVERTURNS",
        "a.AT2: why",
    ):
        assert words in text, words
    assert not re.search(r"\bnan\b", text, re.I)
    assert max(map(len, text.splitlines())) <= 140


def test_what_is_not_known_of_the_coverage_is_said_in_words(tree):
    tree = tree.copy()
    site = tree["site"].to_dataset()
    gone = dict.fromkeys(("coverage", "coverage_lower", "coverage_upper", "coverage_all"), np.nan)
    one = site.assign(**{name: site[name].copy(data=value) for name, value in gone.items()}, judged_pairs=0)
    tree["site"] = one
    text = " ".join(site_overview(tree).split())
    assert "Coverage of other earthquakes: not known, because no earthquake could be left out" in text
    assert "covers -" not in text
    assert "Judged" not in text
    tree["site"] = one.isel(site_event=[0])
    assert "not known, because there is only one earthquake, which cannot be" in " ".join(site_overview(tree).split())
    tree["site"] = site.assign(**{name: site[name].copy(data=np.nan) for name in ("coverage_lower", "coverage_upper")})
    assert "(one earthquake: no interval) of the recorded rotations" in " ".join(site_overview(tree).split())


@pytest.mark.parametrize("scaled", ["pga 4 m/s2", "pgv 0.5 m/s", "impulse 0.5 m/s"])
def test_the_target_that_records_are_scaled_to_has_its_unit(tree, scaled):
    tree = tree.copy()
    site = tree["site"].to_dataset()
    tree["site"] = site.assign_attrs(scaled_to=scaled.rpartition(" ")[0])
    assert f"earthquakes, scaled to {scaled}: Quake AAA" in " ".join(site_overview(tree).split())


@pytest.mark.parametrize(
    ("count", "words"),
    [(np.nan, "main impulses without limit in number"), (5.0, "5 main impulses"), (1.0, "1 main impulse")],
)
def test_the_number_of_main_impulses_of_the_design_is_said_once(tree, count, words):
    site = tree["site"].to_dataset().copy(deep=True)
    site["design"].loc[{"parameter": "main_count"}] = count
    assert f" s, {words} within " in design(site)


def test_the_interval_of_the_design_is_in_words_and_many_blocks_are_told_by_extremes(tree):
    site = tree["site"].to_dataset().copy(deep=True)
    main = {"parameter": "main"}
    site["design"].loc[main], site["design_lower"].loc[main], site["design_upper"].loc[main] = 0.3, 0.2, np.inf
    assert "I = 0.3 m/s (90 % confidence: 0.2 m/s to no limit), " in design(site)
    site["design_lower"].loc[main] = site["design_upper"].loc[main] = np.nan
    assert "I = 0.3 m/s (90 % confidence: no interval), " in design(site)
    site = tree["site"].to_dataset()
    many = site.isel(block=[0, 1] * 10)
    tree = tree.copy()
    tree["site"] = many
    text = site_overview(tree)
    assert "The design overturns 10 of 20 blocks" in text
    assert text.count("stele") <= 1


def test_the_effective_impulse_is_shown_before_the_sequence():
    text = site_overview(usual_site())
    assert text.startswith("! outside the spectrum, and without a design: chest")
    assert 'by the rule, from its half-waves alone; weights: "event".' in text
    first, second = text.partition("An equivalent sequence")[::2]
    # I_eff is 1.3 times 0.4 sqrt(p) exp(2 (C - 0.9)), and the body overturns at g tan(alpha)/p.
    assert re.search(r"wall +0\.985 +0\.916 +0\.753 to 1\.11 +0\.444 +0\.48 OVERTURNS +80 %", first)
    assert re.search(r"pier +0\.929 +0\.779 +0\.641 to 0\.948 +1\.09 +1\.40 +0 %", first)
    assert re.search(r"wall +0\.213 +0\.175 to 0\.259 +0\.278 +0\.\d+ to 0\.\d+ +6 +\d to \d", second)
    assert "are not determined separately: every sequence with the same I_eff overturns the same bodies" in " ".join(
        second.split()
    )
    assert not re.search(r"\bnan\b", text, re.I)


@pytest.mark.sweep
def test_without_bodies_the_spectrum_is_shown_and_of_few_earthquakes_one_line():
    text = site_overview(site_of(np.linspace(0.5, 1.4, 10), blocks=None, quantile=0.8))
    assert "Effective impulse I_eff of blocks with C = 0.9" in text
    assert re.search(r"\n +median +84 % +80 %\n +p \[1/s\] +\[m/s\] +\[m/s\] +\[m/s\] +90 % interval", text)
    assert re.search(r"^ +0\.5 +0\.255 +0\.368 +0\.339 ", text, re.M)  # 0.4 sqrt(p) times 0.9, 1.3, 1.2
    text = site_overview(site_of(np.ones(3)))
    assert text.startswith(
        "! not enough earthquakes (3; at least 7 for the quantile 0.84)\n\nCalibrated on 3 records of"
    )
    assert "wall" not in text
    assert "I_eff" not in text
