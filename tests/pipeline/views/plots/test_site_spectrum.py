"""The overturning spectrum of a site as a picture."""

import numpy as np
import pytest
from site_spectra import BLOCKS, base_at, site_of, usual_site

from rocking.body.limits import RATES
from rockpulse.views.plots.site import calibration, site_spectrum


@pytest.fixture(scope="module")
def ax():
    return site_spectrum(usual_site())


def labelled(ax):
    return dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))


def test_median_and_84_percent_are_drawn_at_the_median_restitution_of_the_bodies(ax):
    c = np.median([block.restitution for block in BLOCKS.values()])
    shown = labelled(ax)
    for name, strength in (("median over earthquakes", 0.9), ("84 %", 1.3)):
        p, s = shown[name].get_data()
        np.testing.assert_allclose(p, RATES)
        np.testing.assert_allclose(s, strength * 0.4 * RATES**0.5 * np.exp(2.0 * (c - 0.9)), rtol=1e-12)
    assert "90 % interval of the 84 % spectrum" in shown
    assert sum(line.get_label() == "10 records" for line in ax.lines) == 1
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")


def test_every_body_is_a_point_at_its_speed_beside_its_own_effective_impulse(ax):
    points = [tuple(np.ravel(line.get_xydata())) for line in ax.lines if line.get_marker() == "o"]
    for block, point in zip(BLOCKS.values(), points, strict=True):
        assert point == pytest.approx((block.p, block.gravity * np.tan(block.alpha_c) / block.p))
    (bars,) = [container for container in ax.containers if container.get_label().startswith("$I_{eff}$")]
    middle = bars.lines[0].get_xydata()
    expected = [(block.p, 1.3 * base_at(block)) for block in (BLOCKS["wall"], BLOCKS["pier"])]
    np.testing.assert_allclose(middle, expected, rtol=1e-12)


def test_a_site_of_too_few_earthquakes_says_so():
    ax = calibration(site_of(np.ones(3)))[0]
    assert "median over earthquakes" not in labelled(ax)
    assert "Not enough earthquakes (3; at least 7" in ax.figure.get_supxlabel()
