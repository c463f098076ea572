"""The design of a site: overturning spectra, sequences of equal effect, and limit accelerograms."""

import numpy as np
import pytest
from drawn import labelled, small_print
from matplotlib.text import Text
from site_spectra import BLOCKS, base_at, site_of, usual_site

import rockpulse as rp
from rocking.body.limits import RATES
from rocking.search.capacity import sequence_critical_scale
from rockpulse.errors import ResultsError
from rockpulse.models import ImpulseSequence
from rockpulse.views.plots.site import calibration

#: Median and 84 % quantile of the strengths of the usual site: see the tests of the spectrum.
MEDIAN, DESIGNED = np.sqrt(0.9), 1.3 * (1.4 / 1.3) ** 0.24


def test_too_few_earthquakes_are_said_and_nothing_is_drawn_of_a_design():
    (ax,) = calibration(site_of(np.ones(3)))
    assert "median over earthquakes" not in labelled(ax)
    assert "Not enough earthquakes (3; at least 7" in small_print(ax)


def test_sequences_on_a_line_of_equal_effect_overturn_the_body_at_one_factor():
    site = usual_site()["site"].to_dataset()
    ax = calibration(usual_site())[1]
    assert ax.get_title(loc="left") == "Lines of equal effect for wall"
    own = site.sel(block="wall")
    lines = [line for line in ax.lines if line.get_label().startswith("$N$ = ")]
    assert [line.get_label()[6:].split()[0] for line in lines] == [
        f"{float(own[name]):g}" for name in ("main_count_lower", "main_count", "main_count_upper")
    ]
    for line in lines:
        ratio, main = (float(values[30]) for values in line.get_data())
        count = int(line.get_label()[6:].split()[0])
        one = ImpulseSequence(main, ratio * main, float(own["interval"]), np.inf, count)
        found = sequence_critical_scale(BLOCKS["wall"], one).safety_factor[0]
        assert found == pytest.approx(float(own["design_factor"]), rel=0.02)
    point = ax.containers[0].lines[0].get_xydata()[0]
    assert point == pytest.approx([float(own["ratio"]), float(own["main"])])


@pytest.mark.sweep
def test_the_limit_accelerogram_of_a_site_is_that_of_the_sequence_of_a_body():
    figure = rp.plots.draw(usual_site(), "limit-accelerogram", block="pier")
    main = float(usual_site()["site"]["main"].sel(block="pier"))
    assert f"I = {main:.3g} m/s" in " ".join(text.get_text() for text in figure.findobj(match=Text)).replace("$", "")
    with pytest.raises(ResultsError, match="chest: the site has no design sequence for this body"):
        rp.plots.draw(usual_site(), "limit-accelerogram", block="chest")


@pytest.fixture(scope="module")
def spectrum():
    return calibration(usual_site())[0]


def test_median_and_84_percent_are_drawn_at_the_median_restitution_of_the_bodies(spectrum):
    c = np.median([block.restitution for block in BLOCKS.values()])
    shown = labelled(spectrum)
    for name, strength in (("median over earthquakes", MEDIAN), ("84 %", DESIGNED)):
        p, s = shown[name].get_data()
        np.testing.assert_allclose(p, RATES)
        np.testing.assert_allclose(s, strength * 0.4 * RATES**0.5 * np.exp(2.0 * (c - 0.9)), rtol=1e-12)
    assert "90 % interval of the 84 % spectrum" in shown
    assert sum(line.get_label() == "10 records" for line in spectrum.lines) == 1
    assert (spectrum.get_xscale(), spectrum.get_yscale()) == ("log", "log")


def test_every_body_is_a_point_at_its_speed_beside_its_own_effective_impulse(spectrum):
    points = [tuple(np.ravel(line.get_xydata())) for line in spectrum.lines if line.get_marker() == "o"]
    for block, point in zip(BLOCKS.values(), points, strict=True):
        assert point == pytest.approx((block.p, block.gravity * np.tan(block.alpha_c) / block.p))
    (bars,) = [container for container in spectrum.containers if container.get_label().startswith("$I_{eff}$")]
    middle = bars.lines[0].get_xydata()
    expected = [(block.p, DESIGNED * base_at(block)) for block in (BLOCKS["wall"], BLOCKS["pier"])]
    np.testing.assert_allclose(middle, expected, rtol=1e-12)
