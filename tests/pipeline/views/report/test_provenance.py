"""The origin of the numbers: files with the earthquakes and stations of their records."""

from report_cases import WORDS
from results_tree import results_tree

from rockpulse.views.report.provenance import input_table


def test_a_file_is_told_with_the_earthquake_and_station_of_its_channels():
    summary = results_tree()["summary"].to_dataset().assign(magnitude=("record", [7.1, 7.1, 5.0]))
    table = input_table(WORDS, summary)
    assert table.headings[-1].title == "earthquake, station"
    assert [row[-1].text for row in table.rows] == ["Ridgecrest 2019-07-06, CCC", ""]
    assert [row[3].text for row in table.rows] == ["2", "1"]


def test_files_of_which_nothing_is_known_have_no_such_column():
    summary = results_tree()["summary"].to_dataset().isel(record=[2])
    assert [heading.title for heading in input_table(WORDS, summary).headings] == [
        "file",
        "SHA-256",
        "format",
        "records",
    ]
