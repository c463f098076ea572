"""The records of a site over every parameter with the design sequence, and its overturning spectrum."""

import numpy as np
import pytest
from drawn import labelled, small_print
from site_spectra import BLOCKS, base_at, site_of, usual_site

import rockpulse as rp
from rocking.body.limits import RATES
from rockpulse import CalibrationSettings
from rockpulse.config.configuration import Config
from rockpulse.views.plots.site import calibration, site_spectrum


@pytest.fixture(scope="module")
def tree(ridgecrest):
    settings = Config(calibration=CalibrationSettings(method="statistics", bootstrap=100))
    wall = rp.models.Block(0.4, 2.0)
    return rp.calibrate([one for one in ridgecrest if "Up" not in one.id], settings, bodies={"wall": wall})


@pytest.fixture(scope="module")
def panels(tree):
    return calibration(tree)


def test_every_parameter_has_a_panel_with_its_unit_and_few_earthquakes_are_said(panels):
    labels = ["$I$ [m/s]", "$I_s/I$ [-]", r"$\Delta T$ [s]", "number [-]", "time [s]"]
    assert [ax.get_xlabel() for ax in panels[:5]] == labels
    assert panels[0].get_title(loc="left") == "main impulse I"
    assert not panels[5].axison
    assert [ax.get_ylabel() for ax in panels[:5]] == ["share of the records [-]", ""] * 2 + ["share of the records [-]"]
    assert "ONE EVENT" in small_print(panels[0])
    assert "6 records of 1 earthquake" in panels[0].figure.get_suptitle()


def test_each_step_is_a_record_and_the_design_sequence_a_line(tree, panels):
    site = tree["site"].to_dataset()
    for ax, name in zip(panels, site["parameter"].values, strict=False):
        own, shown = site.sel(parameter=name), labelled(ax)
        assert shown["records"].get_xdata()[1:].tolist() == np.sort(own["value"].values).tolist()
        assert shown["records"].get_ydata()[-1] == pytest.approx(1.0)
        assert shown["design sequence"].get_xdata()[0] == float(own["design"])


def test_the_fit_and_the_intervals_are_those_of_the_file(tree):
    copy = tree.copy(deep=True)
    given = {"median": 0.2, "dispersion": 0.5, "median_lower": 0.15, "median_upper": 0.26}
    for name, value in (given | {"design": 0.3, "design_lower": 0.25, "design_upper": 0.4}).items():
        copy["site"][name].values[0] = value
    value = np.array([0.1, 0.15, 0.2, 0.3, 0.35, 0.4])
    copy["site"]["value"].values[:, 0] = value
    ax = calibration(copy)[0]
    shown = labelled(ax)
    median, fit = shown["90 % interval of the median"], shown["lognormal fit"]
    assert median.get_xydata().tolist() == [[0.15, 0.5], [0.26, 0.5]]
    assert np.interp(0.2, *fit.get_data()) == pytest.approx(0.5)
    assert np.interp(0.2 * np.exp(0.5), *fit.get_data()) == pytest.approx(0.8413, abs=1e-3)
    box = shown["its 90 % interval ($I$ alone)"].get_bbox()
    assert (box.x0, box.x1) == pytest.approx((0.25, 0.4))
    low, high = ax.get_xlim()
    assert 0.05 < low < 0.09
    assert 0.44 < high < 0.6
    assert ax.get_xscale() == "log"


@pytest.mark.sweep
def test_records_without_a_limit_are_counted_and_too_few_earthquakes_are_said(tree):
    copy = tree.copy(deep=True)
    copy["site"]["value"].values[:2, 3] = np.nan
    copy["site"]["value"].values[:, 4] = np.nan
    panels = calibration(copy)
    assert [text.get_text() for text in panels[3].texts] == ["2 without a limit"]
    assert [text.get_text() for text in panels[4].texts] == ["no record has a value"]
    ax = calibration(site_of(np.ones(3)))[0]
    assert "median over earthquakes" not in labelled(ax)
    assert "Not enough earthquakes (3; at least 7" in small_print(ax)


@pytest.fixture(scope="module")
def spectrum():
    return site_spectrum(usual_site())


def test_median_and_84_percent_are_drawn_at_the_median_restitution_of_the_bodies(spectrum):
    c = np.median([block.restitution for block in BLOCKS.values()])
    shown = labelled(spectrum)
    for name, strength in (("median over earthquakes", 0.9), ("84 %", 1.3)):
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
    expected = [(block.p, 1.3 * base_at(block)) for block in (BLOCKS["wall"], BLOCKS["pier"])]
    np.testing.assert_allclose(middle, expected, rtol=1e-12)
