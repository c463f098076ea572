"""The text of a site file."""

import re

import numpy as np
import pytest
from site_spectra import site_of, usual_site

from rockpulse.views.text.site import site_overview


@pytest.mark.parametrize("scaled", ["pga 4 m/s2", "pgv 0.5 m/s", "impulse 0.5 m/s"])
def test_the_target_that_records_are_scaled_to_has_its_unit(scaled):
    tree = usual_site().copy()
    site = tree["site"].to_dataset()
    tree["site"] = site.assign_attrs(scaled_to=scaled.rpartition(" ")[0])
    assert f"earthquakes, scaled to {scaled}: Earthquake 0" in " ".join(site_overview(tree).split())


def test_the_effective_impulse_is_shown_before_the_sequence():
    text = site_overview(usual_site())
    assert text.startswith("! no design for bodies outside the range of the spectrum: chest")
    assert 'by the rule, from its half-waves alone; weights: "event".' in text
    first, second = text.partition("Sequence of the site")[::2]
    # I_eff is 1.323 times 0.4 sqrt(p) exp(2 (C - 0.9)), and the body overturns at g tan(alpha)/p.
    assert re.search(r"wall +0\.985 +0\.933 +0\.\d+ to 1\.\d+ +0\.444 +0\.48 OVERTURNS +80 %", first)
    assert re.search(r"pier +0\.929 +0\.793 +0\.\d+ to 0\.\d+ +1\.09 +1\.38 +0 %", first)
    assert "number of main impulses N = 6 (90 % interval 3 to 9), I_s/I = 0.278 (" in " ".join(second.split())
    site = usual_site()["site"].sel(block="pier")
    main, size = float(site["main"]), (float(site[name]) for name in ("critical_impulse", "critical_impulse_2"))
    words = " +".join(f"{value:.3g}" for value in size)
    assert re.search(rf"pier +{main:.3g} .*{0.2778 * main:.3g} +\d+-\d+ +{words} +0\.\d+ +overturns in half", second)
    assert re.search(r"wall .* OVERTURNS +overturns in half-cycle \d", second)
    largest = float(usual_site()["site"]["main"].sel(block="wall"))
    assert f"The largest I of the bodies is that of wall: I = {largest:.3g} m/s (" in " ".join(second.split())
    assert "all sequences on a line of equal effect (rockpulse plot FILE calibration) overturn" in " ".join(
        second.split()
    )
    assert len(text.splitlines()) <= 40
    assert not re.search(r"\bnan\b", text, re.I)


def test_a_body_outside_the_fit_of_the_rule_is_marked():
    tree = usual_site().copy()
    assert "outside the range of this model" not in site_overview(tree)
    site = tree["site"].to_dataset()
    tree["site"] = site.assign(p=site["p"].where(site["block"] != "pier", 9.0))
    text = site_overview(tree)
    assert re.search(r"\n +pier\* ", text)
    assert not re.search(r"\n +wall\* ", text)
    assert "*: outside the range of this model" in text


@pytest.mark.sweep
def test_without_bodies_the_spectrum_is_shown():
    text = site_overview(site_of(np.linspace(0.5, 1.4, 10), blocks=None, quantile=0.8))
    assert "Effective impulse I_eff of blocks with C = 0.9" in text
    assert re.search(r"\n +median +84 % +80 %\n +p \[1/s\] +\[m/s\] +\[m/s\] +\[m/s\] +90 % interval", text)
    assert re.search(r"^ +0\.5 +0\.268 +0\.374 +0\.362 ", text, re.M)  # 0.4 sqrt(p) times 0.949, 1.323, 1.279
