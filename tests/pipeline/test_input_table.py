"""Tables of the user as texts and numbers."""

import pytest

from rockpulse.errors import ConfigError
from rockpulse.files import column_numbers, table_of


@pytest.mark.parametrize(
    "text",
    [
        "name,a [m],b\nx,1.5,\n\n# a warning\ny,-2e-1,3\n",
        "name;a [m];b\nx;1,5;\ny;-2e-1;3\n",
        "name\ta [m]\tb\n x \t1.5\ny\t-,2\t3\n",
        '"name", "a [m]", b,,\nx,1.5,,,\ny,-0.2,3,,\n',
    ],
)
def test_cells_are_texts_whatever_stands_between_them(text):
    table = table_of("t.csv", text)
    assert table.columns.tolist() == ["name", "a [m]", "b"]
    assert table["name"].tolist() == ["x", "y"]
    assert table["b"].tolist() == ["", "3"]
    assert column_numbers("t.csv", table, "a [m]").tolist() == [1.5, -0.2]


def test_a_name_with_commas_stays_as_it_is():
    assert table_of("t.csv", "name;a\nMuro, nord;1,5\n").iloc[0].tolist() == ["Muro, nord", "1.5"]
    assert table_of("t.csv", 'name,a\n"Muro, nord",1.5\nNA,2\n')["name"].tolist() == ["Muro, nord", "NA"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a,b\n1,2\n1,2,3\n", r"t.csv: row 2: expected 2 cells, as in the heading, found 3: \['1', '2', '3'\]"),
        ("a,b,a\n1,2,3\n", "t.csv: expected each column once, found 'a' 2 times"),
        ("a,b\n" + "x" * 200_000 + ",2\n", "t.csv: cannot be read as a table: field larger than field limit"),
    ],
)
def test_what_is_no_table_is_refused(text, told):
    with pytest.raises(ConfigError, match=told):
        table_of("t.csv", text)


@pytest.mark.parametrize("cell", ["", "x", "nan", "inf"])
def test_what_is_no_number_is_refused(cell):
    with pytest.raises(ConfigError, match=f"t.csv: row 2 of column 'a': expected a number, found '{cell}'"):
        column_numbers("t.csv", table_of("t.csv", f"a,b\n1,1\n{cell},1\n"), "a")


def test_nothing_is_a_table_without_columns():
    assert table_of("t.csv", "\n").columns.tolist() == []
