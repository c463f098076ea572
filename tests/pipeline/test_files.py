"""Files and tables that the user names: what is no file, too large, too deep or no table is refused."""

import os
import socket
from pathlib import Path

import pytest

from rockpulse.errors import ConfigError, RecordRefused, ResultsError
from rockpulse.files import DEEPEST, check_regular, column_numbers, parse_toml, read_text, table_of


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    return tmp_path / "pipe"


@pytest.mark.parametrize("error", [ConfigError, RecordRefused, ResultsError])
def test_a_pipe_is_refused_and_not_opened(pipe, error):
    with pytest.raises(error, match=r"pipe: expected a file, found a pipe; write its content to a file"):
        check_regular(pipe, error)


def test_a_device_and_a_socket_are_refused(tmp_path, monkeypatch):
    with pytest.raises(ConfigError, match="/dev/zero: expected a file, found a device"):
        read_text(Path("/dev/zero"))
    monkeypatch.chdir(tmp_path)  # the name of a socket is short
    with socket.socket(socket.AF_UNIX) as bound:
        bound.bind("s")
        with pytest.raises(ConfigError, match="s: expected a file, found a socket"):
            check_regular("s")


@pytest.mark.parametrize("name", ["there is none", "x" * 5000, "nul\0"])
def test_what_is_not_there_passes_and_opening_it_tells(tmp_path, name):
    check_regular(tmp_path / name)
    check_regular(tmp_path)
    with pytest.raises((OSError, ValueError)):
        read_text(tmp_path / name)


def test_a_file_is_read_up_to_its_limit(tmp_path):
    path = tmp_path / "x.csv"
    path.write_bytes(b"\xef\xbb\xbf" + "ä".encode())
    assert read_text(path, 5) == "ä"
    with pytest.raises(ConfigError, match=r"x\.csv: expected a table of at most 4 bytes, found more"):
        read_text(path, 4, "a table")
    path.write_bytes(b"abc\xff")
    with pytest.raises(
        ConfigError, match=r"x\.csv: expected a text file in UTF-8, found an invalid byte at position 3"
    ):
        read_text(path)


def nested(depth):
    return "a = " + "[" * depth + "]" * depth


@pytest.mark.sweep
def test_toml_is_read_up_to_a_depth():
    # The table is the first level and each array a further one; the innermost may be empty.
    parse_toml(nested(DEEPEST - 1), "x")
    dotted = ".".join("a" * 5000) + " = 1"
    for text in (nested(DEEPEST + 1), nested(5000), dotted, "[" + ".".join("a" * 100) + "]"):
        with pytest.raises(ConfigError, match=r"^x: sections and arrays are nested more than 8 deep; flatten them$"):
            parse_toml(text, "x")


@pytest.mark.parametrize("number", ["9" * 5000, str(2**63), f"-{2**64}", "0x" + "f" * 5000])
def test_toml_is_read_up_to_so_many_digits(number):
    with pytest.raises(ResultsError, match=r"^x: an integer is beyond the limit of 2\^63"):
        parse_toml(f"[a]\nb = [1, {number}]", "x", ResultsError)
    assert parse_toml(f"a = {2**63 - 1}", "x") == {"a": 2**63 - 1}


def test_what_is_no_toml_is_told_with_its_place():
    with pytest.raises(ConfigError, match=r"^x: not valid TOML: Invalid value"):
        parse_toml("a = 1\nb =", "x")


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
    assert table_of("t.xlsx", 'name;a\n"Nord;1\n"A" b;2\n', quoted=False)["name"].tolist() == ['"Nord', '"A" b']


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "a,b\n1,2\n1,2,3\n",
            r"t.csv: row 2: expected 2 cells, as in the heading, found 3: \['1', '2', '3'\]; a ',' within",
        ),
        ('a,b\n1,"2\n3,4\n', "t.csv: cannot be read as a table: unexpected end of data"),
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
