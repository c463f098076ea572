"""Overturning spectra are drawn over p, with the bodies at g tan(alpha)/p."""

import math

import numpy as np
import pytest
import xarray as xr

from rockpulse.storage.variables.probability import SPECTRUM, SPECTRUM_AXES
from rockpulse.views.plots.spectra import overturning_spectra

P, C = np.array([1.0, 2.0, 4.0]), np.array([0.85, 0.95])


def spectra(*strengths):
    curve = np.array(strengths)[:, None, None] * np.outer([0.2, 0.5, 0.4], [1.0, 1.5])
    values = {"spectrum": curve, "spectrum_low": 0.9 * curve, "spectrum_high": 1.1 * curve}
    variables = {name: SPECTRUM[name].variable(array, ("record", "p", "restitution")) for name, array in values.items()}
    axes = {"p": SPECTRUM_AXES["p"].variable(P), "restitution": SPECTRUM_AXES["restitution"].variable(C)}
    return xr.Dataset(variables, {**axes, "record": [f"r{place}" for place in range(len(strengths))]})


def lines(ax):
    return {line.get_label(): line.get_ydata() for line in ax.lines}


def test_one_record_has_its_curve_at_the_nearest_restitution():
    ax = overturning_spectra(spectra(1.0), restitution=0.86)
    assert lines(ax)["spectrum of the record"] == pytest.approx([0.2, 0.5, 0.4])
    assert "0.85" in ax.figure.get_suptitle()
    assert ax.get_xscale() == ax.get_yscale() == "log"


def test_the_median_counts_every_earthquake_once():
    """Nine records of one earthquake do not outvote two others."""
    many = spectra(*[1.0] * 9, 2.0, 3.0)
    ax = overturning_spectra(many, restitution=0.85, events=["a"] * 9 + ["b", "c"])
    assert lines(ax)["median"] == pytest.approx(2.0 * np.array([0.2, 0.5, 0.4]))
    assert lines(ax)["84 %"] == pytest.approx(3.0 * np.array([0.2, 0.5, 0.4]))
    assert lines(overturning_spectra(many, restitution=0.85))["median"] == pytest.approx([0.2, 0.5, 0.4])


def test_a_body_stands_at_its_speed_and_is_named():
    ax = overturning_spectra(spectra(1.0, 2.0), bodies={"a $wall$": (2.0, 0.2)})
    ax.figure.draw_without_rendering()
    places = [line.get_xydata()[0] for line in ax.lines if len(line.get_xydata()) == 1]
    assert any(place == pytest.approx([2.0, 9.80665 * math.tan(0.2) / 2.0]) for place in places)
    assert r"a \$wall\$" in [text.get_text() for text in ax.get_legend().get_texts()]


def test_the_median_at_a_demand_is_that_of_the_scaled_records():
    ax = overturning_spectra(spectra(1.0, 2.0, 4.0), restitution=0.85, demands={"code": np.array([3.0, 1.5, 0.75])})
    assert lines(ax)["median at the demand code"] == pytest.approx(3.0 * np.array([0.2, 0.5, 0.4]))


def test_where_no_body_lies_the_curve_is_straight():
    some = spectra(1.0, 2.0)
    some["spectrum"].values[:, 1] = np.nan
    ax = overturning_spectra(some, restitution=0.85, bodies={"wall": (1.0, 0.2)})
    assert lines(ax)["median"] == pytest.approx([0.2, 0.4])
    assert ax.get_xlim() == pytest.approx((1.0, 4.0))
    some["spectrum"].values[:, 2] = np.nan
    assert overturning_spectra(some, restitution=0.85).get_xlim() == pytest.approx(
        (1.0, 1.6)
    )  # nothing is drawn beyond
    assert "Straight where no body lies" in ax.figure.get_supxlabel()


def test_records_far_below_every_body_are_counted_and_not_shown():
    many, body = spectra(1.0, 2.0, 1e-3), {"wall": (2.0, 0.1)}
    ax = overturning_spectra(many, restitution=0.85, bodies=body)
    assert ax.get_ylim()[0] == pytest.approx(0.1 * 9.80665 * math.tan(0.1) / 2.0)
    assert "Below the picture, far from every body: 1 of 3 curves." in " ".join(ax.figure.get_supxlabel().split())
    alone = overturning_spectra(many, restitution=0.85)
    assert alone.get_ylim()[0] < 2e-4
    assert "Below the picture" not in alone.figure.get_supxlabel()


def test_a_record_without_a_spectrum_is_left_out():
    some = spectra(1.0, 2.0)
    some["spectrum"].values[0] = np.nan
    ax = overturning_spectra(some, restitution=0.85)
    assert lines(ax)["spectrum of the record"] == pytest.approx([0.4, 1.0, 0.8])
    some["spectrum"].values[:] = np.nan
    assert "No spectrum" in overturning_spectra(some).figure.get_supxlabel()
