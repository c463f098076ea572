"""The command line as a whole: its exit codes, what it prints, and that no wrong input shows a traceback."""

import os
import shlex
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import pytest
from results_tree import results_bytes

from rockpulse import __version__, cli
from rockpulse.cli import build_parser, main
from rockpulse.commands import VERBS

PROGRAM = (sys.executable, "-m", "rockpulse")


def test_the_version_is_that_of_the_package(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--version"])
    assert end.value.code == 0
    assert capsys.readouterr().out == f"rockpulse {__version__}\n"


@pytest.mark.parametrize("arguments", [["asses"], ["verify", "results.h5", "--no-input"]])  # no abbreviations
def test_wrong_usage_is_exit_code_two(arguments, capsys):
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert "usage: rockpulse" in capsys.readouterr().err


def test_without_a_verb_the_whole_help_is_shown(capsys):
    with pytest.raises(SystemExit) as end:
        main([])
    assert end.value.code == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == build_parser().format_help()
    assert "rockpulse assess records/ --block wall=0.3x2.4" in captured.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["assess", "x", "--ouput", "y"], 'required: -o/--output; --ouput is not known; did you mean "--output"?'),
        (["assess", "x", "-o", "y", "--block=a=1x3", "z"], "unrecognized arguments: z; give all paths together"),
    ],
)
def test_a_word_that_is_not_known_is_answered_with_the_nearest(arguments, message, capsys):
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_what_stands_behind_two_dashes_is_no_option(capsys):
    with pytest.raises(SystemExit):
        main(["inspect", "a", "--", "--worker"])
    assert "did you mean" not in capsys.readouterr().err


@pytest.mark.sweep
def test_the_help_of_every_verb_fits_the_terminal_and_shows_its_examples(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    for verb in VERBS:
        with pytest.raises(SystemExit) as end:
            main([verb.name, "--help"])
        assert end.value.code == 0
        text = capsys.readouterr().out
        head = text.partition("\nexamples:")[0]
        assert max(map(len, head.splitlines())) <= 80, verb.name
        for example in verb.examples:
            assert f"\n  {example}\n" in text


@pytest.mark.sweep
@pytest.mark.parametrize("verb", [verb for verb in VERBS if verb.name != "app"], ids=lambda verb: verb.name)
def test_the_examples_of_a_help_run(verb, example_names, tmp_path, monkeypatch, run):
    """Each in a new folder with the files that it names but the one that it writes. The page waits for a user."""
    assert verb.examples
    for number, example in enumerate(verb.examples):
        folder = tmp_path / str(number)
        shutil.copytree(example_names.folder, folder, symlinks=True)
        monkeypatch.chdir(folder)
        words = shlex.split(example.partition(" >")[0])[1:]  # `completion` is redirected to a file
        for path in Path("records").glob("burst.[1-9].*") if verb.name == "fragility" else ():
            path.unlink()  # two records are enough for a study that takes seconds a record
        written = Path(words[words.index("-o") + 1] if "-o" in words else "report.html")
        if "--overwrite" not in words:
            written.unlink(missing_ok=True)
        if "--append" in words:
            Path("more").mkdir()
            next(Path("records").iterdir()).rename("more/later")
            run(*[word for word in words if word not in ("more/", "--append")])
        assert run(*words).out
        assert "-o" not in words or list(Path().glob(f"{written.stem}*{written.suffix}")), example


@pytest.mark.sweep
def test_a_reader_that_leaves_early_is_no_error():
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w") as pipe:
        done = subprocess.run([*PROGRAM, "init-config"], stdout=pipe, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.sweep
def test_a_report_and_an_overview_are_made_where_standard_output_is_closed(tmp_path, monkeypatch, capsys):
    page, results = tmp_path / "report.html", tmp_path / "results.h5"
    results.write_bytes(results_bytes())
    capsys.readouterr()
    kept = os.dup(1)
    monkeypatch.setattr(sys, "stdout", None)  # what Python makes of `>&-`
    os.close(1)
    try:
        codes = [main(["inspect", str(results)]), main(["report", str(results), "-o", str(page)])]
    finally:
        if sys.stdout is not None:
            sys.stdout.close()
        os.dup2(kept, 1)
        os.close(kept)
    assert codes == [0, 0]
    assert capsys.readouterr().err == ""
    assert page.read_text(encoding="utf-8").rstrip().endswith("</html>")


@pytest.mark.sweep
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no device that is always full")  # noqa: PTH110
def test_standard_output_that_is_full_is_a_message():
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run([*PROGRAM, "formats"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (2, "rockpulse: No space left on device\n")


@pytest.mark.sweep
def test_letters_that_the_terminal_lacks_do_not_stop_the_command(tmp_path):
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    command = [*PROGRAM, "init-config", "-o", str(tmp_path / "città.toml")]
    done = subprocess.run(command, env=environment, capture_output=True)
    assert done.returncode == 0
    assert done.stdout.startswith(b"wrote ")


def test_an_interruption_is_told_and_has_the_usual_code(monkeypatch, run):
    from rockpulse.commands import records

    def interrupt(args):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "VERBS", (replace(records.formats, run=interrupt),))
    assert "interrupted" in run("formats", code=130).err


@pytest.mark.parametrize("changed", [pytest.param(False, marks=pytest.mark.sweep), True])
def test_an_internal_error_is_shown_with_what_differs_in_the_file(changed, golden, tmp_path, monkeypatch, run, caplog):
    path = tmp_path / "results.h5"
    shutil.copy(golden.results, path)
    if changed:
        with h5py.File(path, "r+") as file:
            file["summary/pga"].attrs["foreign"] = 1
    monkeypatch.setattr("rockpulse.views.text.overview.overview", lambda *given, **options: {}["absent"])
    if not changed:
        with pytest.raises(KeyError, match="absent"):
            main(["inspect", str(path)])
        return
    said = run("inspect", path, code=2).err
    assert "KeyError: 'absent'" in said
    assert "was changed after it was written" in said
    assert "Traceback" not in said
    assert caplog.records[-1].exc_info[0] is KeyError
