"""Wordings of components: vertical, azimuth, or unknown rather than guessed."""

import math

import numpy as np
import pytest
from record_writers import csmip_equal, pulse

from rockpulse.readers import read
from rockpulse.readers.kit.direction import (
    direction,
    heading_direction,
    means_vertical,
    on_structure,
)


@pytest.mark.parametrize(
    "wording",
    ["Up", "UP.", "-UP", "- Up", "VRT", "Vert", "VERT.", "V", "Z", "U-D", "BHZ", "HNZ", "HHZ", "EHZ", "HLZ", "ENZ"],
)
def test_vertical(wording):
    assert direction(wording).orientation == "vertical"
    assert direction(wording).sign == 1.0
    assert bool(direction(wording).note) is wording.startswith("-")


@pytest.mark.parametrize(
    ("wording", "azimuth"),
    [
        ("1 Deg", 1.0),
        ("2 degrees", 2.0),
        ("5°", 5.0),
        ("005", 5.0),
        ("67", 67.0),
        ("360", 0.0),
        ("BHE", 90.0),
        ("HNN", 0.0),
        ("S05W", 185.0),
        ("N30E", 30.0),
        ("N 30 W", 330.0),
        ("S30E", 150.0),
        ("N90E", 90.0),
        ("N0W", 0.0),
        ("10", 10.0),
    ],
)
def test_azimuths(wording, azimuth):
    assert (direction(wording).orientation, direction(wording).azimuth) == ("horizontal", azimuth)


@pytest.mark.parametrize(
    ("wordings", "azimuth"),
    [
        (["N", "NS", "N-S", "North"], 0.0),
        (["E", "EW", "E-W", "East"], 90.0),
        (["S", "South"], 180.0),
        (["W", "West"], 270.0),
    ],
)
def test_words_of_the_compass(wordings, azimuth):
    assert [direction(word).azimuth for word in wordings] == [azimuth] * len(wordings)


@pytest.mark.parametrize("wording", ["1", "2", "9", "0", "", "INTC", "NNE", "WNW", "360.5", "S90.5W", "XUP", "HN3"])
def test_what_is_no_direction_stays_unknown(wording):
    assert direction(wording).orientation == "unknown"
    assert np.isnan(direction(wording).azimuth)


@pytest.mark.parametrize(
    ("heading", "orientation", "azimuth"),
    [
        ("acc_1", "unknown", np.nan),
        ("CH 12 (g)", "unknown", np.nan),
        ("channel_10", "unknown", np.nan),
        ("acc 5 deg [g]", "horizontal", 5.0),
        ("acc_090", "horizontal", 90.0),
        ("HNZ", "vertical", np.nan),
        ("acc VRT", "vertical", np.nan),
        ("V", "vertical", np.nan),
        ("acc EW", "horizontal", 90.0),
        ("acc e", "horizontal", 90.0),
        ("acc T", "unknown", np.nan),
        ("acc N E", "unknown", np.nan),
        ("v", "unknown", np.nan),
        ("acc 12.5 deg", "horizontal", 12.5),
        ("acc 12.5°", "horizontal", 12.5),
        ("M7.1 090", "horizontal", 90.0),
        ("10 g", "unknown", np.nan),
        ("filtered 25 Hz", "unknown", np.nan),
        ("Acc 0.01", "unknown", np.nan),
        ("dt=0.005", "unknown", np.nan),
        ("1" * 60000 + "x", "unknown", np.nan),
    ],
)
def test_column_headings(heading, orientation, azimuth):
    facing = heading_direction(heading)
    assert facing.orientation == orientation
    assert facing.azimuth == pytest.approx(azimuth, nan_ok=True)


def test_a_sign_before_up_keeps_the_samples_and_is_reported(tmp_path):
    values = np.round(pulse(), 6)
    path = tmp_path / "a.RAW"
    path.write_bytes(csmip_equal(values, component="-UP"))
    (record,) = read(path)
    assert (record.orientation, record.unit_factor > 0.0) == ("vertical", True)
    assert "'-UP' does not tell whether upwards is positive" in record.warnings[0]


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ("Subbasement", True),
        ("sub-basement", True),
        ("10th-floor", True),
        ("12th Fl", True),
        ("Level 29", True),
        ("BNZ Building Level 5", True),
        ("West wall 4th level", True),
        ("2nd Story", True),
        ("Base of pier", True),
        ("Pier 7", True),
        ("Dam crest", True),
        ("Santa Monica Pier", False),
        ("1065 Crest Drive", False),
        ("11 Wall St", False),
        ("Ground level", False),
        ("Fire Station #25", False),
        ("", False),
    ],
)
def test_places_on_structures(place, expected):
    assert on_structure(place) is expected


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ("Ground level at SW corner", False),
        ("Ground level: SW corner", False),
        ("GROUND", False),
        ("FREEFIELD", False),
        ("Ground floor at SW corner", True),
        ("Courtyard", True),
    ],
)
def test_places_of_instrumented_structures(place, expected):
    assert on_structure(place, stated=True) is expected


@pytest.mark.parametrize("wording", ["Down", "DN", "downwards"])
def test_a_channel_that_is_positive_downwards(wording):
    found = direction(wording)
    assert (found.orientation, found.sign, found.note) == ("vertical", -1.0, "")
    assert math.isnan(found.azimuth)
    assert direction(f"- {wording}").sign == 1.0
    assert "does not tell whether upwards is positive" in direction(f"+{wording}").note


@pytest.mark.parametrize("wording", ["HN1", "HN2", "L", "Long", "Transverse"])
def test_a_horizontal_direction_without_an_azimuth(wording):
    assert (direction(wording).orientation, np.isnan(direction(wording).azimuth)) == ("horizontal", True)


def test_the_letter_of_seed_for_a_vertical_channel():
    assert [means_vertical(code) for code in (" hnz ", "HNN", "HN1", "Z")] == [True, False, False, False]
