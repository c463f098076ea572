"""The earthquakes and files that a report rests on: columns are there where a file states something."""

import numpy as np
import pytest
from results_tree import results_tree

from rockpulse.assessment.answers import Answers
from rockpulse.views.report.record_tables import earthquake_table, input_table, warning_table
from rockpulse.warning_text import WarningText, with_codes


@pytest.fixture
def summary():
    """Three records of two earthquakes; the file of the second states neither a date nor anything else."""
    return results_tree()["summary"].to_dataset()


def table(summary, **stated):
    found = earthquake_table(Answers(summary.assign({name: ("record", values) for name, values in stated.items()})))
    titles = [heading.title for heading in found.headings]
    return [dict(zip(titles, (cell.text for cell in row), strict=True)) for row in found.rows]


def test_magnitude_and_distances_have_columns_only_where_they_are_stated(summary):
    ridgecrest, other = table(summary)
    assert list(ridgecrest) == ["earthquake", "date", "motions", "which"]
    assert (ridgecrest["date"], ridgecrest["motions"], other["date"]) == ("2019-07-06", "2", "")
    assert list(table(summary, start_time=[""] * 3)[0]) == ["earthquake", "motions", "which"]
    stated = {"magnitude": [7.1, 7.1, np.nan], "magnitude_type": ["Mw", "Mw", ""]}
    ridgecrest, other = table(summary, **stated, epicentral_distance=[30500.0, 4000.0, np.nan])
    assert (ridgecrest["magnitude"], ridgecrest["distance [km]"]) == ("Mw 7.1", "4 to 30.5")
    assert (other["magnitude"], other["distance [km]"]) == ("", "")
    assert "distance [km]" not in table(summary, **stated)[0]


def test_the_magnitudes_of_several_agencies_stand_side_by_side(summary):
    stated = {
        "magnitude": [7.1, 6.9, np.nan],
        "magnitude_type": ["Mw", "ML", ""],
        "origin_time": ["2019-07-05", "", ""],
    }
    ridgecrest, _ = table(summary, **stated)
    assert (ridgecrest["magnitude"], ridgecrest["date"]) == ("Mw 7.1, ML 6.9", "2019-07-05")


def test_a_file_is_told_with_the_earthquake_and_station_of_its_channels(summary):
    table = input_table(summary.assign(magnitude=("record", [7.1, 7.1, 5.0])))
    assert table.headings[-1].title == "earthquake, station"
    assert [row[-1].text for row in table.rows] == ["Ridgecrest 2019-07-06, CCC", ""]
    assert [row[2].text for row in table.rows] == ["2", "1"]
    summary = summary.isel(record=[2])
    assert [heading.title for heading in input_table(summary).headings] == ["file", "format", "records"]
    assert [heading.title for heading in input_table(summary, full=True).headings][1] == "SHA-256"


def test_warnings_of_one_code_share_a_row(summary):
    unknown, note = str(WarningText("orientation_unknown")), "a note of the user"
    texts, codes = zip(
        with_codes([WarningText("orientation_unknown"), WarningText("vertical_short", missing=1.0)]),
        with_codes([WarningText("orientation_unknown"), WarningText("vertical_short", missing=2.0)]),
        (note, ""),
        strict=True,
    )
    summary = summary.assign(warnings=("record", list(texts)), warning_codes=("record", list(codes)))
    rows = [tuple(cell.text for cell in row) for row in warning_table(summary).rows]
    assert rows[-3] == ("2 records", unknown)
    assert rows[-2][0] == "2 records"
    assert "in the 1 s that it does not cover (and 1 similar" in rows[-2][1]
    assert rows[-1] == ("weak.1", note)
