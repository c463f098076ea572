"""The page on records of one's own: every heading that it says works is read as it says."""

import re
from pathlib import Path

import numpy as np
import pytest

import rockpulse as rp

TOP = Path(__file__).parents[2]
PAGE = (TOP / "docs" / "tutorials" / "records.md").read_text(encoding="utf-8")
#: Orientation (azimuth, or u: up, ?: unknown) of each column, in the order of the table.
FOUND = [(0, 90), (0, 90, "u"), (45, 135), (30, 120), (0, 90, "u"), (0, 90), ("?",)]
HEADINGS = re.findall(r"^\| `([^`]+)` \|", PAGE[PAGE.index("| headings |") :], re.MULTILINE)


@pytest.mark.parametrize(("headings", "expected"), list(zip(HEADINGS, FOUND, strict=True)))
def test_every_heading_of_the_page_works(tmp_path, headings, expected):
    delimiter = ";" if ";" in headings else ","
    timed = len(headings.split(delimiter)) > len(expected)
    time = 0.01 * np.arange(400)
    motion = [(1.0 + place) * np.sin(5.0 * time + place) for place in range(len(expected))]
    table = np.column_stack([time, *motion] if timed else motion)
    np.savetxt(tmp_path / "x.csv", table, "%.5f", delimiter, header=headings, comments="", encoding="utf-8")
    records = rp.read(tmp_path / "x.csv", dt=None if timed else 0.01)
    facing = {"vertical": "u", "unknown": "?"}
    assert tuple(facing.get(one.orientation, one.azimuth) for one in records) == expected
    unit = re.findall(r"[\[(]([^\])]+)[\])]", headings)[-1]
    factor = {"g": 9.80665, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01}[unit]
    assert [one.unit_factor for one in records] == [factor] * len(expected)
    assert {one.dt for one in records} == {0.01}


def test_the_page_names_every_unit():
    from rockpulse.readers.kit.text import UNITS

    (line,) = re.findall(r"^Units are (.*?)\. ", PAGE, re.MULTILINE)
    assert set(re.findall(r"`([^`]+)`", line)) == set(UNITS)


def test_the_page_and_the_readme_list_every_format_that_is_read():
    from rockpulse.readers import FORMATS

    rows = [row for row in FORMATS if row.unit != "-"]
    listed = re.findall(r"^\| `(\w+)` \| (.*?) \| (.*?) \|$", PAGE, re.MULTILINE)
    assert listed == [(row.name, row.what, row.unit) for row in rows]
    readme = (TOP / "README.md").read_text(encoding="utf-8")
    section = readme[readme.index("## Which files") :].split("```")[0]
    assert [row.name for row in rows if row.what.split()[0].rstrip(",") not in section] == []
