"""The literal hint of an error, applied to the input that it is printed for, gets the next run further."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
from results_tree import results_tree

import rockpulse as rp
from rockpulse.cli import main

SAMPLE = Path(__file__).parents[3] / "data" / "samples" / "formats" / "clc_90.v2"
BODY = '[[block]]\nname = "w"\nwidth = 0.3\nheight = 2.4\n'
#: Files beside the results: columns without unit and interval, and configurations with one mistake each.
FILES = {
    "columns.txt": "".join(f"{0.01 * (place % 7)}\n" for place in range(400)),
    "large.txt": "".join(f"{9.0 * (place % 7 - 3)}\n" for place in range(400)),
    "curve.csv": "pga [g],rate\n0.1,0.02\n0.2,0.01\n",
    "key.toml": '[records]\nunit = "g"\n' + BODY,
    "section.toml": '[record]\nunits = "g"\n' + BODY,
    "word.toml": '[records]\ncomponents = "horizntal"\n' + BODY,
    "unit.toml": '[records]\nunits = "gg"\n' + BODY,
    "single.toml": BODY.replace("[[block]]", "[block]"),
    "millimetres.toml": BODY.replace("0.3", "300").replace("2.4", "2400"),
    "body key.toml": BODY.replace("width", "widht"),
}

#: A command, what in it or in its file is wrong (nothing: an option is missing), and the hint of its message.
HINTS = [
    ("convert columns.txt -o a.csv", "", r"(--units g) on the command line"),
    ("convert columns.txt -o a.csv --units g", "", r"(--dt 0\.01)"),
    ("convert columns.txt -o a.csv --units gg --dt 0.01", "gg", r'did you mean "(\w+)"'),
    ("convert columns.txt -o a.csv --unit g --dt 0.01", "--unit", r'did you mean "(--\w+)"'),
    ("convrt columns.txt -o a.csv --units g --dt 0.01", "convrt", r'did you mean "(\w+)"'),
    ("convert sample.v2 -o there.csv", "", r"\((--overwrite)\)"),
    ("convert sample.v2 -o there.zip", "there.zip", r"(at2)"),
    ("assess none --block w=300x2400 -o a.h5", "", r"add (--confirm-size)"),
    ("assess none --config key.toml -o a.h5", "unit", r'did you mean "(\w+)"'),
    ("assess none --config section.toml -o a.h5", "record", r'did you mean "(\w+)"'),
    ("assess none --config word.toml -o a.h5", "horizntal", r'did you mean "(\w+)"'),
    ("assess none --config unit.toml -o a.h5", "gg", r'did you mean "(\w+)"'),
    ("assess none --config single.toml -o a.h5", "[block]", r"expected (\[\[block\]\])"),
    ("assess none --config millimetres.toml -o a.h5", "height", r"set (confirm_size = true)"),
    ("assess none --config 'body key.toml' -o a.h5", "widht", r'did you mean "(\w+)"'),
    ("inspect results.h5 --block colum", "colum", r'did you mean "(\w+)"'),
    ("inspect results.h5 --record CCC", "CCC", r"the pattern '([^']+)' selects"),
    ("inspect results.h5 --where 'safety < 1'", "safety", r'did you mean "(\w+)"'),
    ("inspect results.h5 --descending", "", r"expected (--sort) VARIABLE"),
    ("inspect results.h5 --outcome overturn", "overturn", r'did you mean "(\w+)"'),
    ("export results.h5 -o table.txt", ".txt", r"ends in (\.csv)"),
    ("export results.h5 -o table.csv --group sumary", "sumary", r'did you mean "(\w+)"'),
    ("export results.h5 -o table.csv --columns pgaa", "pgaa", r'did you mean "(\w+)"'),
    ("export results.h5 -o table.xlsx --decimal-comma", "--decimal-comma", r"(remove the option)"),
    ("plot results.h5 bodyes -o a.png", "bodyes", r'did you mean "(\w+)"'),
    ("report results.h5 -o a.html --language de", "de", r"expected one of en, (it)"),
    ("report results.h5 -o a.doc", ".doc", r"ends in (\.html)"),
    ("assess large.txt --units g --dt 0.01 --block w=0.3x2.4 -o a.h5", "", r"give (--confirm \S+),"),
]
#: What stands for a hint that is no word to be typed.
SAID = {"remove the option": "", "--sort": "--sort pga", "at2": "there.at2"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    rp.save(results_tree(), tmp_path / "results.h5")
    shutil.copy(SAMPLE, tmp_path / "sample.v2")
    (tmp_path / "there.csv").write_text("time [s],acceleration [g]\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def said(capsys, words):
    """The message of a command; empty where it ends well."""
    try:
        code = main(words)
    except SystemExit as end:
        code = end.code
    printed = capsys.readouterr()
    return " ".join((printed.out + printed.err).split()) if code else ""


@pytest.mark.sweep
@pytest.mark.parametrize(("command", "wrong", "hint"), HINTS)
def test_a_hint_gets_further(folder, capsys, command, wrong, hint):
    words = shlex.split(command)
    first = said(capsys, words)
    found = re.search(hint, first)
    assert found, first
    typed = SAID.get(found[1], found[1])
    names = [name for name in words if name.endswith(".toml")]
    if names and wrong:
        path = folder / names[0]
        new = f"{typed}\n{wrong}" if "=" in typed else typed
        path.write_text(path.read_text(encoding="utf-8").replace(wrong, new, 1), encoding="utf-8")
    else:
        words = [typed if word == wrong else word.replace(wrong, typed) if wrong else word for word in words]
        words = [word for word in words if word] + ([] if wrong else shlex.split(typed))
    second = said(capsys, words)
    assert not re.search(hint, second), second
    assert second != first


def test_a_command_that_makes_a_missing_file_makes_it(folder, capsys):
    first = said(capsys, ["check", "--config", "mine.toml", "--code"])
    made = re.search(r"\(rockpulse (.*?) writes one", first)
    assert made, first
    assert said(capsys, shlex.split(made[1])) == ""
    assert "no such file" not in said(capsys, ["check", "--config", "mine.toml", "--code"])
