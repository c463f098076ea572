"""Files that the user names: what is no file, too large, too deep or too long is refused before it costs anything."""

import os
import socket
from pathlib import Path

import pytest

from rockpulse.errors import ConfigError, RecordRefused, ResultsError
from rockpulse.files import DEEPEST, check_regular, parse_toml, read_text


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
