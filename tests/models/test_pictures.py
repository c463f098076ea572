"""Small pictures as SVG: well-formed, in the units of their data, short whatever the length of a line."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking.pictures import BLUE, Picture, Shown, brief, thinned

SVG = "{http://www.w3.org/2000/svg}"


def points(element):
    return np.array([[float(number) for number in pair.split(",")] for pair in element.attrib["points"].split()])


def test_a_line_runs_from_corner_to_corner_with_y_upwards():
    picture = Picture((0.0, 10.0), (-1.0, 1.0), width=228.0, height=128.0)
    picture.line([0.0, 5.0, 10.0], [-1.0, 0.0, 1.0], BLUE)
    root = ET.fromstring(picture.svg("a line"))
    assert points(root.find(f"{SVG}polyline")) == pytest.approx(np.array([[14, 114], [114, 64], [214, 14]]))
    assert root.attrib["aria-label"] == "a line"


def test_equal_scales_keep_a_square_square():
    picture = Picture((0.0, 4.0), (0.0, 1.0), equal=True)
    picture.polygon([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0])
    drawn = points(ET.fromstring(picture.svg("a square")).find(f"{SVG}polygon"))
    assert np.ptp(drawn[:, 0]) == pytest.approx(np.ptp(drawn[:, 1]), abs=0.11)


def test_stems_stand_on_zero():
    picture = Picture((0.0, 1.0), (-1.0, 1.0), width=128.0, height=128.0)
    picture.stems([0.0, 1.0], [1.0, -1.0])
    path = ET.fromstring(picture.svg("stems")).find(f"{SVG}path").attrib["d"]
    assert path == "M14.0 64.0V14.0M114.0 64.0V114.0"


def test_words_cannot_break_out_of_the_picture():
    picture = Picture((0.0, 1.0), (0.0, 1.0))
    picture.words("</svg><script>alert(1)</script>", 0.0, 0.0)
    text = picture.svg('a "label" <b>')
    assert "<script" not in text
    root = ET.fromstring(text)
    assert root.find(f"{SVG}text").text == "</svg><script>alert(1)</script>"
    assert root.attrib["aria-label"] == 'a "label" <b>'


def test_a_thinned_line_keeps_its_extremes_its_order_and_its_gaps():
    x = np.arange(20_000.0)
    y = np.sin(x / 50.0)
    y[12_345], y[777] = 9.0, -7.0
    y[5000:6000] = np.nan
    few_x, few_y = thinned(x, y)
    assert few_x.size <= 600
    assert np.all(np.diff(few_x) > 0.0)
    assert (np.nanmax(few_y), np.nanmin(few_y)) == (9.0, -7.0)
    assert np.isnan(few_y).any()


def test_a_short_line_stays_as_it_is():
    x, y = np.arange(4.0), np.array([0.0, 3.0, 2.0, 1.0])
    assert thinned(x, y, columns=2) == (x, y)


def test_ranges_are_told_in_few_words():
    assert brief(np.array([1.0, np.nan, 1.00001]), "m") == "1 m"
    assert brief([], "m") == "unknown"
    assert brief(np.inf, "s") == "inf s"


class Thing(Shown):
    def _facts(self):
        return {"": "<odd>", "size": "3 m"}

    def _picture(self):
        return None


def test_facts_are_told_in_a_line_and_escaped_on_a_card():
    assert repr(Thing()) == "<Thing <odd>, size 3 m>"
    card = Thing()._repr_html_()
    assert "&lt;odd&gt;" in card
    assert re.findall(r"<td[^>]*>([^<]*)</td>", card) == ["&lt;odd&gt;", "3 m"]
    assert "<svg" not in card
