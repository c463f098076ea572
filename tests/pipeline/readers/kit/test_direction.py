"""Wordings of components: vertical, azimuth, or unknown rather than guessed."""

import math

import numpy as np
import pytest
from record_writers import csmip_equal, pulse

from rockpulse.readers import read
from rockpulse.readers.kit.direction import direction, heading_direction, means_vertical, on_structure


@pytest.mark.parametrize(
    "wording",
    ["Up", "UP.", "-UP", "- Up", "VRT", "Vert", "VERT.", "V", "Z", "U-D", "BHZ", "HNZ", "HHZ", "EHZ", "HLZ", "ENZ"],
)
def test_vertical(wording):
    assert direction(wording).orientation == "vertical"
    assert direction(wording).sign == 1.0
    assert bool(direction(wording).note) is wording.startswith("-")


@pytest.mark.parametrize(
    ("azimuth", "wordings"),
    [
        (0.0, "N;NS;N-S;North;360;HNN"),
        (5.0, "5°;005;5 degrees"),
        (30.0, "N30E"),
        (67.0, "67;67 Deg"),
        (90.0, "E;EW;E-W;East;BHE;N90E"),
        (150.0, "S30E"),
        (180.0, "S;South"),
        (185.0, "S05W"),
        (270.0, "W;West"),
        (330.0, "N 30 W"),
    ],
)
def test_azimuths(azimuth, wordings):
    found = [direction(wording) for wording in wordings.split(";")]
    assert {(one.orientation, one.azimuth) for one in found} == {("horizontal", azimuth)}


@pytest.mark.parametrize("wording", ["1", "2", "9", "0", "", "INTC", "NNE", "WNW", "360.5", "S90.5W", "XUP", "HN3"])
def test_what_is_no_direction_stays_unknown(wording):
    assert direction(wording).orientation == "unknown"
    assert np.isnan(direction(wording).azimuth)


@pytest.mark.parametrize(
    ("headings", "orientation", "azimuth"),
    [
        ("acc_1;CH 12 (g);channel_10;acc T;acc N E;v", "unknown", np.nan),
        ("10 g;filtered 25 Hz;Acc 0.01;dt=0.005;" + "1" * 60000 + "x", "unknown", np.nan),
        ("HNZ;acc VRT;V", "vertical", np.nan),
        ("acc 5 deg [g]", "horizontal", 5.0),
        ("acc 12.5 deg;acc 12.5°", "horizontal", 12.5),
        ("acc_090;acc EW;acc e;M7.1 090", "horizontal", 90.0),
    ],
)
def test_column_headings(headings, orientation, azimuth):
    for heading in headings.split(";"):
        facing = heading_direction(heading)
        assert facing.orientation == orientation, heading
        assert facing.azimuth == pytest.approx(azimuth, nan_ok=True), heading


def test_a_sign_before_up_keeps_the_samples_and_is_reported(tmp_path):
    values = np.round(pulse(), 6)
    path = tmp_path / "a.RAW"
    path.write_bytes(csmip_equal(values, component="-UP"))
    (record,) = read(path)
    assert (record.orientation, record.unit_factor > 0.0) == ("vertical", True)
    assert "'-UP' does not tell whether upwards is positive" in record.warnings[0]


ON_STRUCTURES = "Subbasement;sub-basement;10th-floor;12th Fl;Level 29;BNZ Building Level 5;West wall 4th level"
ON_STRUCTURES += ";2nd Story;Base of pier;Pier 7;Dam crest"
ON_GROUND = "Santa Monica Pier;1065 Crest Drive;11 Wall St;Ground level;Fire Station #25;"


@pytest.mark.parametrize(
    ("places", "stated", "expected"),
    [
        (ON_STRUCTURES, False, True),
        (ON_GROUND, False, False),
        ("Ground level at SW corner;Ground level: SW corner;GROUND;FREEFIELD", True, False),
        ("Ground floor at SW corner;Courtyard", True, True),
    ],
)
def test_places_on_structures(places, stated, expected):
    assert {place: on_structure(place, stated) for place in places.split(";")} == dict.fromkeys(
        places.split(";"), expected
    )


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
