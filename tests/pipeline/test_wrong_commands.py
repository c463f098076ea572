"""Commands and configurations that cannot be: each ends in words on what to do, without a traceback.

The cases stand in wrong_commands.txt and wrong_configurations.txt beside this file, with the beginning of each message.
"""

import os
import re
import shlex
from pathlib import Path

import pytest
from record_writers import at2, pulse
from results_tree import results_bytes

from rockpulse import cli
from rockpulse.cli import main
from rockpulse.storage.hdf5 import results_file

#: What a message begins with: the program, and the verb where the parser speaks.
SPEAKER = re.compile(r"rockpulse[a-z0-9 -]*: (?:error: )?")
#: Configurations that take more room than a line.
LONG = {
    "a = " + "[" * 5000 + "]" * 5000: "c.toml: sections and arrays are nested more than 8 deep",
    "a = " + "9" * 5000: "c.toml: an integer is beyond the limit of 2^63; write a number with a decimal point",
    "[" + ".".join("a" * 3000) + "]": "c.toml: sections and arrays are nested more than 8 deep",
    "#" * 1_100_000: "c.toml: expected a TOML file of at most 1,048,576 bytes, found more",
    "\0": "c.toml: not valid TOML: Invalid statement",
}


def cases(name):
    """Pairs of a case and the beginning of its message."""
    lines = Path(__file__).with_name(name).read_text(encoding="utf-8").splitlines()
    return [tuple(line.split(" => ", 1)) for line in lines if not line.startswith("#")]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a record, results and files that are neither."""
    place = tmp_path_factory.mktemp("wrong")
    (place / "results.h5").write_bytes(results_bytes())
    (place / "a.AT2").write_bytes(at2(pulse(400)))
    (place / "text").write_text("x\n")
    (place / "bin").write_bytes(bytes(range(256)))
    (place / "empty").touch()
    (place / "folder").mkdir()
    (place / "table.csv").write_text("a,b\n1,2\n")
    (place / "hazard.csv").write_text("pga [m/s2],annual rate\n0.01,0.5\n0.1,0.05\n")
    os.mkfifo(place / "pipe")
    return place


@pytest.fixture
def said(place, monkeypatch, capsys):
    """What is said of a command, in one line, without the folder; nothing is shown or written of one that cannot be.

    The parser is built and the results are read once for all commands.
    """
    monkeypatch.chdir(place)
    parser, load = cli.build_parser(), results_file.load_tree
    results = load("results.h5")
    monkeypatch.setattr(cli, "build_parser", lambda given: parser)
    monkeypatch.setattr(results_file, "load_tree", lambda path: results if str(path) == "results.h5" else load(path))

    def said(arguments):
        for left in place.glob("new*"):  # by a case that failed
            left.unlink()
        try:
            code = main(arguments)
        except SystemExit as end:
            code = end.code
        shown, error = capsys.readouterr()
        assert (shown, code in (1, 2)) == ("", True)
        assert "Traceback" not in error
        assert not list(place.glob("new*"))
        line = " ".join(error.split()).replace(f"{place}/", "")
        return line[SPEAKER.search(line).end() :]

    return said


@pytest.mark.sweep
def test_a_wrong_command_is_answered_in_words(said):
    found = [(command, message, said(shlex.split(command))) for command, message in cases("wrong_commands.txt")]
    assert len(found) > 250
    assert [case for case in found if not case[2].startswith(case[1])] == []


@pytest.mark.sweep
def test_a_wrong_configuration_is_answered_in_words(said, place):
    found = []
    for text, message in [*cases("wrong_configurations.txt"), *LONG.items()]:
        body = ["--block", "w=0.5x3"] if text and "block" not in text else []
        (place / "c.toml").write_text(text.replace("\\n", "\n"))
        answer = said(["assess", "a.AT2", *body, "--config", "c.toml", "-o", "new.h5", "--workers", "1"])
        found.append((text[:80], message, answer))
    assert len(found) > 250
    assert [case for case in found if not case[2].startswith(case[1])] == []
