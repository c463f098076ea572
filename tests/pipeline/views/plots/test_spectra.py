"""Overturning spectra are curves over p with bodies at g tan(alpha)/p; rocking spectra maps, the darker the further."""

import math

import numpy as np
import pytest
import xarray as xr
from drawn import in_legend, small_print
from matplotlib.colors import same_color

from rockpulse.assessment.spectra import rocking_spectrum as computed
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import SPECTRUM, SPECTRUM_AXES
from rockpulse.views.plots.spectra import overturning_spectra, rocking_spectrum

P, C = np.array([1.0, 2.0, 4.0]), np.array([0.85, 0.95])


def spectra(*strengths):
    curve = np.array(strengths)[:, None, None] * np.outer([0.2, 0.5, 0.4], [1.0, 1.5])
    values = {"spectrum": curve, "spectrum_low": 0.9 * curve, "spectrum_high": 1.1 * curve}
    variables = {name: SPECTRUM[name].variable(array, ("record", "p", "restitution")) for name, array in values.items()}
    axes = {"p": SPECTRUM_AXES["p"].variable(P), "restitution": SPECTRUM_AXES["restitution"].variable(C)}
    return xr.Dataset(variables, {**axes, "record": [f"r{place}" for place in range(len(strengths))]})


def lines(ax):
    return {line.get_label(): line.get_ydata() for line in ax.lines}


@pytest.mark.sweep
def test_one_record_has_its_curve_and_the_median_counts_every_earthquake_once():
    ax = overturning_spectra(spectra(1.0), restitution=0.86)
    assert lines(ax)["spectrum of the record"] == pytest.approx([0.2, 0.5, 0.4])
    assert "0.85" in ax.figure.get_suptitle()
    assert ax.get_xscale() == ax.get_yscale() == "log"
    many = spectra(*[1.0] * 9, 2.0, 3.0)
    ax = overturning_spectra(many, restitution=0.85, events=["a"] * 9 + ["b", "c"])
    assert lines(ax)["median"] == pytest.approx(2.0 * np.array([0.2, 0.5, 0.4]))
    assert lines(ax)["84 %"] == pytest.approx(3.0 * np.array([0.2, 0.5, 0.4]))
    assert lines(overturning_spectra(many, restitution=0.85))["median"] == pytest.approx([0.2, 0.5, 0.4])


@pytest.mark.sweep
def test_a_body_stands_at_its_speed_and_the_median_at_a_demand_is_that_of_scaled_records():
    ax = overturning_spectra(spectra(1.0, 2.0), bodies={"a $wall$": (2.0, 0.2)})
    ax.figure.draw_without_rendering()
    places = [line.get_xydata()[0] for line in ax.lines if len(line.get_xydata()) == 1]
    assert any(place == pytest.approx([2.0, 9.80665 * math.tan(0.2) / 2.0]) for place in places)
    assert r"a \$wall\$" in in_legend(ax)
    ax = overturning_spectra(spectra(1.0, 2.0, 4.0), restitution=0.85, demands={"code": np.array([3.0, 1.5, 0.75])})
    assert lines(ax)["median at the demand code"] == pytest.approx(3.0 * np.array([0.2, 0.5, 0.4]))


@pytest.mark.sweep
def test_where_no_body_lies_the_curve_is_straight_and_a_record_without_one_is_left_out():
    some = spectra(1.0, 2.0)
    some["spectrum"].values[:, 1] = np.nan
    ax = overturning_spectra(some, restitution=0.85, bodies={"wall": (1.0, 0.2)})
    assert lines(ax)["median"] == pytest.approx([0.2, 0.4])
    assert ax.get_xlim() == pytest.approx((1.0, 4.0))
    assert "Between the p of the bodies the curve is a straight line" in small_print(ax)
    some["spectrum"].values[:, 2] = np.nan
    # Nothing is drawn beyond.
    assert overturning_spectra(some, restitution=0.85).get_xlim() == pytest.approx((1.0, 1.6))
    some = spectra(1.0, 2.0)
    some["spectrum"].values[0] = np.nan
    ax = overturning_spectra(some, restitution=0.85)
    assert lines(ax)["spectrum of the record"] == pytest.approx([0.4, 1.0, 0.8])
    some["spectrum"].values[:] = np.nan
    assert "No spectrum" in overturning_spectra(some).figure.get_supxlabel()


def test_records_far_below_every_body_are_counted_and_not_shown():
    many, body = spectra(1.0, 2.0, 1e-3), {"wall": (2.0, 0.1)}
    ax = overturning_spectra(many, restitution=0.85, bodies=body)
    assert ax.get_ylim()[0] == pytest.approx(0.1 * 9.80665 * math.tan(0.1) / 2.0)
    assert "Far below all bodies and not drawn: 1 of 3 curves." in small_print(ax)
    alone = overturning_spectra(many, restitution=0.85)
    assert alone.get_ylim()[0] < 2e-4
    assert "Below the picture" not in small_print(alone)


@pytest.fixture(scope="module")
def spectrum():
    time = np.arange(0.0, 1.005, 0.01)
    record = Record(3.0 * np.sin(2.0 * np.pi * time), dt=0.01, id="one sine")
    return computed(record, p=np.linspace(1.0, 5.0, 9), alpha=np.linspace(0.1, 0.4, 7))


def test_the_map_holds_the_peaks(spectrum):
    ax = rocking_spectrum(spectrum)
    drawn = ax.collections[0].get_array()
    outcome, peak = spectrum["outcome"].values, spectrum["peak_rotation_ratio"].values
    assert np.array_equal(drawn.mask, outcome == 0)
    assert drawn.data[outcome == 1] == pytest.approx(np.minimum(peak, 1.0)[outcome == 1])
    assert np.all(drawn[outcome == 2] > 1.0)
    corners = ax.collections[0].get_coordinates()
    centres = 0.25 * (corners[1:, 1:] + corners[:-1, 1:] + corners[1:, :-1] + corners[:-1, :-1])
    assert np.allclose(centres[..., 0], spectrum["p"].values[None, :])
    assert np.allclose(centres[..., 1], spectrum["alpha_c"].values[:, None])
    assert ax.get_xlim() == pytest.approx((0.75, 5.25))
    assert ax.get_ylim() == pytest.approx((0.075, 0.425))
    shades = ax.collections[0].cmap(ax.collections[0].norm(np.array([0.05, 0.95])))[:, :3].sum(axis=1)
    assert shades[1] < shades[0]


def test_what_overturns_is_told_apart_from_every_rotation(spectrum):
    """Hatched cell by cell, in a colour that is far from all of the map, and named so in the legend."""
    ax = rocking_spectrum(spectrum)
    mesh, (hatched,) = ax.collections[0], ax.patches
    fallen = mesh.cmap(mesh.norm(2.0))[:3]
    rotations = mesh.cmap(mesh.norm(np.linspace(0.0, 1.0, 101)[:-1]))[:, :3]
    assert np.abs(rotations - fallen).max(axis=1).min() > 0.2
    entry = ax.get_legend().get_patches()[0]
    assert same_color(entry.get_facecolor(), fallen)
    assert entry.get_hatch() == hatched.get_hatch()
    assert hatched.get_hatch()
    overturns = spectrum["outcome"].values == 2
    p, alpha = np.meshgrid(spectrum["p"].values, spectrum["alpha_c"].values)
    inside = hatched.get_path().contains_points(np.stack([p.ravel(), alpha.ravel()], axis=1))
    assert np.array_equal(inside.reshape(overturns.shape), overturns)


def test_a_rotation_beyond_alpha_that_comes_back_is_no_overturning(spectrum):
    far = spectrum.copy(deep=True)
    row, column = np.argwhere(far["outcome"].values == 1)[0]
    far["peak_rotation_ratio"].values[row, column] = 1.2
    ax = rocking_spectrum(far)
    mesh = ax.collections[0]
    shade = mesh.cmap(mesh.norm(mesh.get_array()[row, column]))
    assert same_color(shade, mesh.cmap(mesh.norm(0.95)))
    assert not ax.patches[0].get_path().contains_point((far["p"][column], far["alpha_c"][row]))


@pytest.mark.sweep
def test_labels_and_legend(spectrum):
    ax = rocking_spectrum(spectrum, bodies={"a $wall$": (2.0, 0.2)})
    ax.figure.draw_without_rendering()
    assert ax.get_xlabel() == "frequency parameter $p$ [1/s]"
    assert ax.get_ylabel() == r"critical angle $\alpha_c$ [rad]"
    (top,) = ax.child_axes
    assert top.get_xlabel() == "half the diagonal R of a rectangle [m]"
    p = np.array([1.0, 2.0, 5.0])
    assert top.transData.transform(np.stack([0.75 * 9.80665 / p**2, 0 * p], 1))[:, 0] == pytest.approx(
        ax.transData.transform(np.stack([p, 0 * p], 1))[:, 0], abs=0.01
    )
    assert ax.figure.axes[1].get_ylabel() == r"largest rotation over $\alpha_c$ [-]"
    assert in_legend(ax) == ["overturns", "at rest", r"a \$wall\$"]
    assert [2.0, 0.2] in [line.get_xydata()[0].tolist() for line in ax.lines]
    assert "Housner" in small_print(ax)
    ax = rocking_spectrum(spectrum, bodies={f"body {k}": (1.0 + 0.1 * k, 0.3) for k in range(20)})
    assert in_legend(ax)[-1] == "more bodies: 8"


def test_nothing_overturns_and_an_unresolved_block_is_crossed_out(spectrum):
    calm = spectrum.copy(deep=True)
    calm["peak_rotation_ratio"].values[:] = calm["outcome"].values[:] = 0
    assert "Every block stays at rest." in small_print(rocking_spectrum(calm))
    calm["outcome"].values[0, 0] = 3
    ax = rocking_spectrum(calm)
    assert in_legend(ax) == ["at rest", "unresolved"]
    assert not ax.patches
    (line,) = (line for line in ax.lines if line.get_label() == "unresolved")
    assert line.get_xydata().tolist() == [[1.0, 0.1]]
    assert "Every block" not in small_print(ax)
