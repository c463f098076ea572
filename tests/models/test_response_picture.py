"""What a response says of its outcomes, and the picture of its peaks or of its history."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking import Block, Outcome, Response, recorded_response, resonance
from rocking.svg_lines import BLUE, RED

SVG = "{http://www.w3.org/2000/svg}"
DT = 0.01
SHAKING = 3.2 * np.sin(2.0 * np.pi * np.arange(0.0, 6.0, DT))


def made(outcome, peak):
    count = np.shape(outcome)
    nothing = np.full(count, -1)
    return Response(peak, outcome, np.zeros(count, dtype=int), np.full(count, np.nan), nothing, nothing)


EVERY = made(np.arange(4), np.array([0.0, 0.4, np.inf, np.nan]))


def drawn(response):
    return ET.fromstring(response._repr_html_()).find(f".//{SVG}svg")


def test_overturned_is_a_bool_for_one_lane_and_an_array_for_several():
    one = resonance(Block(width=0.5, height=2.0), 1.0, half_cycles=2)
    assert one.overturned is True
    assert one.outcome_name == "overturns"
    assert EVERY.overturned.tolist() == [False, False, True, False]
    assert EVERY.overturned.dtype == bool


def test_names_of_outcomes_are_those_that_results_store():
    from rockpulse.storage.variables.summary import SUMMARY

    stored = SUMMARY["outcome"].variable(np.zeros((1, 1, 1)), ("record", "block", "model")).attrs["flag_meanings"]
    assert EVERY.outcome_name.tolist() == str(stored).split() == [outcome.word for outcome in Outcome]


def test_shapes_are_those_of_the_outcome():
    response = recorded_response(Block(width=[0.25, 0.6], height=2.2), SHAKING, DT, scale=[0.1, 1.0, 4.0])
    assert response.overturned.shape == response.outcome_name.shape == (3, 2)
    assert np.array_equal(response.overturned, response.outcome_name == "overturns")


def test_a_response_is_told_in_a_line():
    rocks = recorded_response(Block(width=0.6, height=2.2), 0.9 * SHAKING, DT)
    assert repr(rocks) == f"<Response rocks, peak {rocks.peak_rotation_ratio:.4g} alpha_c, impacts {rocks.impacts}>"
    falls = recorded_response(Block(width=0.25, height=2.2), 4.0 * SHAKING, DT, history=True)
    assert repr(falls).startswith(f"<Response overturns by {falls.overturning_time:.4g} s, impacts ")
    assert repr(falls).endswith(f"history of {falls.time.size} samples>")
    told = "<Response of 4 lanes, at_rest 1, rocks 1, overturns 1, unresolved 1, peak of those that rock 0.4 alpha_c>"
    assert repr(EVERY) == told


def test_peaks_are_bars_in_the_colour_of_their_outcome():
    heights = {}
    for path in drawn(EVERY).findall(f"{SVG}path"):
        base, tip = path.attrib["d"].partition(" ")[2].split("V")
        heights[path.attrib["stroke"]] = float(base) - float(tip)
    assert heights[RED] / heights[BLUE] == pytest.approx(3.0, rel=0.02)  # an overturning one reaches 1.2, this one 0.4
    assert len(heights) == 4


def test_a_history_is_a_line_that_stays_short():
    long = recorded_response(Block(width=0.6, height=2.2), np.tile(0.9 * SHAKING, 40), DT, history=True)
    lines = drawn(long).findall(f"{SVG}polyline")
    assert lines[-1].attrib["stroke"] == BLUE
    assert 100 < len(lines[-1].attrib["points"].split()) <= 600
    assert len(long._repr_html_()) < 12_000
