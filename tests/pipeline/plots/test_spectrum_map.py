"""The rocking spectrum is drawn darker where blocks rock further, black where they overturn, white at rest."""

import numpy as np
import pytest

from rockpulse.plots.spectrum_map import rocking_spectrum
from rockpulse.record import Record
from rockpulse.spectrum import rocking_spectrum as computed


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
    assert drawn[outcome == 1].tolist() == np.minimum(peak, 1.0)[outcome == 1].tolist()
    assert np.all(drawn[outcome == 2] > 1.0)
    shades = ax.collections[0].cmap(ax.collections[0].norm(np.array([0.05, 0.95, 2.0])))[:, :3].sum(axis=1)
    assert np.all(np.diff(shades) < 0.0)
    assert shades[-1] == 0.0


def test_labels_and_legend(spectrum):
    ax = rocking_spectrum(spectrum, bodies={"a $wall$": (2.0, 0.2)})
    assert ax.get_xlabel() == "frequency parameter $p$ [1/s]"
    assert ax.get_ylabel() == r"critical angle $\alpha_c$ [rad]"
    assert ax.figure.axes[1].get_ylabel() == r"largest rotation over $\alpha_c$ [-]"
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == ["overturns", "at rest", r"a \$wall\$"]
    assert [2.0, 0.2] in [line.get_xydata()[0].tolist() for line in ax.lines]
    assert "Housner" in ax.figure.get_supxlabel()


def test_nothing_overturns_and_nothing_says_it_does(spectrum):
    calm = spectrum.copy(deep=True)
    calm["outcome"].values[:] = 0
    calm["peak_rotation_ratio"].values[:] = 0.0
    words = [text.get_text() for text in rocking_spectrum(calm).get_legend().get_texts()]
    assert words == ["at rest"]


def test_unresolved_blocks_are_crossed_out(spectrum):
    doubted = spectrum.copy(deep=True)
    doubted["outcome"].values[0, 0] = 3
    ax = rocking_spectrum(doubted)
    (line,) = (line for line in ax.lines if line.get_label() == "unresolved")
    assert line.get_xydata().tolist() == [[1.0, 0.1]]


def test_many_bodies_are_counted_and_not_named(spectrum):
    ax = rocking_spectrum(spectrum, bodies={f"body {k}": (1.0 + 0.1 * k, 0.3) for k in range(20)})
    assert [text.get_text() for text in ax.get_legend().get_texts()][-1] == "8 more bodies"
