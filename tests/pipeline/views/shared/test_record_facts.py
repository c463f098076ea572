"""What is known of a record in words: earthquake, date, magnitude, station, direction; never an empty word."""

import math

import pytest
from results_tree import RECORDS, results_tree

from rockpulse.selection.events import UNKNOWN
from rockpulse.views.shared.record_facts import Known, RecordFacts

KNOWN = {
    "event_title": "Kahramanmaras",
    "origin_time": "2023-02-06T01:17:32+00:00",
    "start_time": "2023-02-07T00:00:00+00:00",
    "magnitude": 7.7,
    "magnitude_type": "Mw",
    "station": "0201",
    "azimuth": 90.0,
    "component": "HNE",
}


def told(**changed):
    return RecordFacts({**KNOWN, **changed}.get).described


def test_earthquake_date_magnitude_station_and_direction_make_one_line():
    assert told() == "Kahramanmaras 2023-02-06 Mw 7.7, station 0201, E-W"


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"origin_time": ""}, "Kahramanmaras 2023-02-07 Mw 7.7"),
        ({"origin_time": "", "start_time": ""}, "Kahramanmaras Mw 7.7"),
        ({"magnitude": math.nan}, "Kahramanmaras 2023-02-06"),
        ({"magnitude": None, "magnitude_type": ""}, "Kahramanmaras 2023-02-06"),
        ({"magnitude_type": ""}, "Kahramanmaras 2023-02-06 M 7.7"),
        ({"event_title": "Kahramanmaras, 02/06/2023"}, "Kahramanmaras, 02/06/2023 Mw 7.7"),
        ({"event_title": "KOBE 01/16/95"}, "KOBE 01/16/95 Mw 7.7"),
        ({"event_title": "Kahramanmaras M7.7"}, "Kahramanmaras M7.7 2023-02-06"),
    ],
)
def test_the_earthquake_is_told_once_as_far_as_it_is_known(changed, expected):
    assert told(**changed) == f"{expected}, station 0201, E-W"


@pytest.mark.parametrize("title", ["", "2023/02/06 01:17:32 (GMT) M 7.7 Mw", "Rcrd of Mon Feb 6, 2023 01:17:32.0 UTC"])
def test_a_title_that_names_no_earthquake_gives_way_to_date_and_magnitude(title):
    assert told(event_title=title) == "earthquake of 2023-02-06 Mw 7.7, station 0201, E-W"
    assert told(event_title=title, event="Pazarcik").startswith("Pazarcik 2023-02-06 Mw 7.7,")
    assert told(event_title=title, event=UNKNOWN).startswith("earthquake of 2023-02-06 Mw 7.7,")
    nothing = {"origin_time": "", "start_time": "", "magnitude": math.nan, "station": "", "azimuth": math.nan}
    assert told(event_title=title, component="", **nothing) == title


@pytest.mark.parametrize(
    ("code", "name", "expected"),
    [
        ("0201", "Adiyaman", "station 0201 (Adiyaman), "),
        ("", "Adiyaman", "station Adiyaman, "),
        ("00000", "Adiyaman", "station Adiyaman, "),
        ("Adiyaman", "ADIYAMAN", "station ADIYAMAN, "),
        ("", "", ""),
    ],
)
def test_a_station_is_told_by_code_and_name(code, name, expected):
    assert told(station=code, station_name=name) == f"Kahramanmaras 2023-02-06 Mw 7.7, {expected}E-W"


@pytest.mark.parametrize(
    ("azimuth", "component", "expected"),
    [
        (0.0, "360 Deg", "N-S"),
        (180.0, "S", "N-S"),
        (270.0, "W", "E-W"),
        (32.5, "32.5 degrees, rotated", "azimuth 32.5°"),
        (math.nan, "UP", "UP"),
    ],
)
def test_a_direction_is_a_line_of_the_compass_an_azimuth_or_a_word(azimuth, component, expected):
    assert told(azimuth=azimuth, component=component) == f"Kahramanmaras 2023-02-06 Mw 7.7, station 0201, {expected}"


def test_a_magnitude_keeps_the_digits_it_has():
    values = ({"magnitude": value} for value in (7.0, 6.61, 5.9))
    assert [RecordFacts(one.get).magnitude for one in values] == ["M 7.0", "M 6.61", "M 5.9"]


def test_what_a_file_states_is_told_in_units_of_maps_and_nothing_else():
    summary = results_tree()["summary"].to_dataset()
    assert Known(summary, record=RECORDS[0]).stated == []
    assert Known(summary, record=RECORDS[2]).described == ""
    summary = results_tree()["summary"].to_dataset()
    stated = {
        "event_id": "us6000jllz",
        "magnitude": 7.7,
        "hypocentre_latitude": -37.288,
        "hypocentre_longitude": 37.043,
        "hypocentre_depth": 8600.0,
        "epicentral_distance": 61000.0,
        "vs30": 391.0,
        "site_class": "B",
    }
    summary = summary.assign({name: ("record", [value] * 3) for name, value in stated.items()})
    assert Known(summary, record=RECORDS[0]).stated == [
        ("agency event ID", "us6000jllz"),
        ("magnitude", "M 7.7"),
        ("hypocentre", "37.288° S, 37.043° E, depth 8.6 km"),
        ("epicentral distance", "61 km"),
        ("Vs30", "391 m/s"),
        ("class of the site", "B"),
    ]
