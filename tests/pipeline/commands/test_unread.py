"""Motions that no reader takes are never lost quietly: exit code, verdict, report, ``inspect``, and one quiet line."""

import io
import re
from contextlib import redirect_stderr, redirect_stdout

import numpy as np
import pytest
from markupsafe import Markup
from record_writers import at2, pulse

from rockpulse.cli import main

#: Layouts that no reader takes, as agencies change theirs from one year to the next.
HEADER = "".join(f"NEW_KEY_{number}: value {number}.5\n" for number in range(9))
ROWS = "".join(f"{number:6d}: {np.sin(number):9.4f} {np.cos(number):9.4f}\n" for number in range(60))
GOOD, UNREAD = 2, 6
COUNT = "2 of 8 files used (6 rejected)"
WHY = "no reader recognises the file (m00.asc, m01.txt, m02.acc, m03.asc, m04.txt, m05.acc)"
BLOCK = ["--block", "statue=0.6x1.9"]


def motions():
    """Names and contents of two good motions and of six that no reader takes, each another motion."""
    good = {f"good{number}.AT2": at2(pulse(200, 0.3 + 0.01 * number)) for number in range(GOOD)}
    suffixes = ("asc", "txt", "acc")
    unread = {
        f"m{number:02}.{suffixes[number % 3]}": f"{HEADER}STATION: {number}\n{ROWS}".encode()
        for number in range(UNREAD)
    }
    beside = {"notes.txt": b"Visit on 3 May, battery changed.\n", "list.csv": b"file,event\nm00.asc,Kobe\n"}
    return {**good, **unread, **beside}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("motions")
    for name, content in motions().items():
        (folder / name).write_bytes(content)
    return folder


@pytest.fixture(scope="module")
def assessed(folder, quick, tmp_path_factory):
    """The results of a quiet run, which told what failed in one line."""
    target = tmp_path_factory.mktemp("results") / "results.h5"
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        assert main(["assess", str(folder), *BLOCK, "--config", str(quick), "-o", str(target), "--quiet"]) == 1
    assert (out.getvalue(), err.getvalue()) == ("", f"rockpulse: {COUNT}: {WHY}.\n")
    return target


def flat(text):
    return " ".join(text.split())


@pytest.mark.sweep
def test_the_count_stands_beside_the_verdict_and_the_reason_is_told_once(folder, quick, tmp_path, run):
    given = ["--config", str(quick), *BLOCK, "-o", str(tmp_path / "results.h5")]
    out = run("assess", folder, *given, code=1).out
    told = flat(out)
    assert re.search(rf"! {re.escape(f'{COUNT}: {WHY}')}\. Each body, 2 records ", told)
    named = ", ".join(str(path) for path in sorted(folder.glob("m*")))
    files = f"6 files ({named}): no reader recognises the"
    assert f"failed: 6; records with warnings: 2 {files}" in told
    assert told.count("'rockpulse formats' lists") == 1
    assert "not records: list.csv, notes.txt" in out


@pytest.mark.sweep
def test_inspect_tells_the_count_and_lists_every_file_where_asked_for(assessed, run):
    assert f"! {COUNT}: {WHY}." in flat(run("inspect", assessed).out)
    assert run("inspect", assessed, "--failures").out.count("no reader recognises the file") == UNREAD


@pytest.mark.sweep
def test_the_first_sentence_of_the_report_has_the_count(assessed, tmp_path, monkeypatch):
    from rockpulse.views.report.report_pictures import PageElement, Pictures

    monkeypatch.setattr(Pictures, "_drawn", lambda pictures, draw, name, caption: PageElement(Markup(""), caption))
    assert main(["report", str(assessed), "-o", str(tmp_path / "report.html")]) == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    words = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page.split("<body", 1)[1]))
    first, second = words.split("Limits of the verdict", 1)[0], words.split("Basis of the verdict", 2)[2]
    assert f"; {COUNT}." in first
    told = f"failed 6 {WHY}"
    assert told in second.split("Explore the motion", 1)[0]
    assert words.count("m05.acc no reader recognises the file") == 1  # the annex names every file, by its reason
    assert all(words.count(f"m{number:02}.") >= 1 for number in range(UNREAD))


@pytest.mark.parametrize("quiet", [True, False])
def test_where_nothing_can_be_used_the_count_and_the_reason_are_reported(folder, tmp_path, run, quiet):
    given = ["assess", str(folder / "m*"), *BLOCK, "-o", str(tmp_path / "results.h5"), *(["--quiet"] if quiet else [])]
    said = run(*given, code=1).err
    line = f"rockpulse: no record could be assessed; nothing was written: 6 files could not be used: {WHY}.\n"
    assert said.endswith(line)
    assert (said == line) == quiet
    assert flat(said).count("'rockpulse formats' lists") == (0 if quiet else 1)
    assert not list(tmp_path.iterdir())


@pytest.mark.sweep
@pytest.mark.parametrize("verb", ["fragility", "calibrate"])
def test_a_fragility_file_and_a_site_tell_the_count(folder, tmp_path, run, verb):
    config = tmp_path / "site.toml"
    config.write_text(
        "[search]\npoints = 16\n[calibration]\nbootstrap = 100\n"
        '[fragility]\nlimit_states = ["uplift"]\nmeasures = ["pga"]\n'
    )
    path = tmp_path / "out.h5"
    block = ["--block", "wall=0.3x2.4"]
    assert (
        run(verb, folder, *block, "--config", config, "-o", path, "--quiet", code=1).err
        == f"rockpulse: {COUNT}: {WHY}.\n"
    )
    assert f"! {COUNT}: {WHY}." in flat(run("inspect", path).out)


def test_what_is_converted_is_counted_too(folder, tmp_path, run):
    assert run("convert", folder, "-o", tmp_path / "all.mseed", "--quiet", code=1) == (
        "",
        f"rockpulse: {COUNT}: {WHY}.\n",
    )
