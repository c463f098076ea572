"""The rocking spectrum is drawn darker where blocks rock further, hatched where they overturn, white at rest."""

import numpy as np
import pytest
from matplotlib.colors import same_color

from rockpulse.assessment.spectra import rocking_spectrum as computed
from rockpulse.record.record import Record
from rockpulse.views.plots.spectra import rocking_spectrum


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
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == ["overturns", "at rest", r"a \$wall\$"]
    assert [2.0, 0.2] in [line.get_xydata()[0].tolist() for line in ax.lines]
    assert "Housner" in ax.figure.get_supxlabel()


def test_nothing_overturns_and_nothing_says_it_does(spectrum):
    calm = spectrum.copy(deep=True)
    calm["outcome"].values[:] = 0
    calm["peak_rotation_ratio"].values[:] = 0.0
    ax = rocking_spectrum(calm)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["at rest"]
    assert not ax.patches
    assert "Every block stays at rest." in ax.figure.get_supxlabel()
    assert "Every block" not in rocking_spectrum(spectrum).figure.get_supxlabel()


def test_unresolved_blocks_are_crossed_out(spectrum):
    doubted = spectrum.copy(deep=True)
    doubted["outcome"].values[0, 0] = 3
    ax = rocking_spectrum(doubted)
    (line,) = (line for line in ax.lines if line.get_label() == "unresolved")
    assert line.get_xydata().tolist() == [[1.0, 0.1]]


def test_many_bodies_are_counted_and_not_named(spectrum):
    ax = rocking_spectrum(spectrum, bodies={f"body {k}": (1.0 + 0.1 * k, 0.3) for k in range(20)})
    assert [text.get_text() for text in ax.get_legend().get_texts()][-1] == "8 more bodies"
