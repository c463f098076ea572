"""The table of records that were chosen elsewhere."""

import pytest

from rockpulse.config.configuration import Config
from rockpulse.config.study_settings import FragilitySettings
from rockpulse.errors import ConfigError
from rockpulse.selection.tables import SelectedRecords, read_selection_table, selection_of


def read(tmp_path, text):
    path = tmp_path / "chosen.csv"
    path.write_text(text)
    return read_selection_table(path)


def test_rows_of_a_record_stand_together_and_weigh_one_without_weights(tmp_path):
    found = read(tmp_path, "record,factor,magnitude\nb,2\na,1.5,6.5\nb,0.5\n")
    assert found == SelectedRecords(True, {"b": ((0.5, 1.0), (2.0, 1.0)), "a": ((1.5, 1.0),)})
    assert found.most == 2


def test_levels_and_weights_are_read(tmp_path):
    assert read(tmp_path, "record,level,weight\na,0.4,0.25\n") == SelectedRecords(False, {"a": ((0.4, 0.25),)})


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("record,weight\na,1\n", "expected either a column factor or a column level, found neither"),
        ("record,factor,level\na,1,1\n", "expected either a column factor or a column level, found factor and level"),
        ("record,factor\na,0\n", "row 1 of column 'factor': expected a number above 0, found '0'"),
        ("record,factor,weight\na,1\n", "row 1 of column 'weight': expected a number above 0, found ''"),
        ("record,factor\n,1\n", "row 1: expected the id of a record, found an empty cell"),
        ("record,factor\na,1\na,1\n", "row 2 repeats factor 1 of a; remove it"),
        ("record,factor\n", "expected a row for each record that was chosen, found none"),
        ('record,factor\na,"1\nb,2\n', "cannot be read as a table: unexpected end of data"),
        ("", "missing: record; found: none, as it is empty"),
        ("id,factor\na,1\n", "expected a CSV table with the columns record and factor"),
    ],
)
def test_wrong_tables_are_told(tmp_path, text, told):
    with pytest.raises(ConfigError, match=told):
        read(tmp_path, text)


def test_a_table_that_is_not_there_is_told(tmp_path):
    settings = FragilitySettings(selection="none.csv")
    with pytest.raises(ConfigError, match=r"none\.csv: no such file; expected a CSV table with the columns record"):
        selection_of(Config(fragility=settings, folder=tmp_path))
    assert selection_of(Config()) is None
    with pytest.raises(ConfigError, match=r"selection: .*none\.csv: no such file; .* the columns record and factor$"):
        read_selection_table(tmp_path / "none.csv", "[[demand]] d: selection")
