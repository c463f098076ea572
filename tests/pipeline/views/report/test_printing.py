"""The report as a PDF: printed by the browser that is found, refused in words where there is none."""

import re
import shutil
import stat
from importlib.resources import files

import pytest
from results_tree import results_tree

from rockpulse.errors import ResultsError
from rockpulse.views.plots import style
from rockpulse.views.report import writing as printing
from rockpulse.views.report.writing import PDF_MARK, report


@pytest.fixture
def nowhere(monkeypatch, tmp_path):
    """A machine without a browser."""
    monkeypatch.setattr(printing.shutil, "which", lambda name: None)
    for name in printing.PROGRAMS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(printing.sys, "platform", "linux")


def test_without_a_browser_nothing_is_written_and_it_is_said_what_to_do(nowhere, tmp_path):
    with pytest.raises(ResultsError, match=r"no Chrome, Chromium or Edge was found .* write the report as \.html"):
        report(results_tree(), tmp_path / "report.pdf")
    assert list(tmp_path.iterdir()) == []


def test_a_browser_in_a_usual_place_of_windows_is_found(nowhere, monkeypatch, tmp_path):
    program = tmp_path / "Microsoft/Edge/Application/msedge.exe"
    program.parent.mkdir(parents=True)
    program.touch()
    monkeypatch.setenv("ProgramFiles(x86)", str(tmp_path))
    assert printing.browser() == str(program)


def scripted(monkeypatch, path, script):
    """A program in place of the browser."""
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(printing, "browser", lambda: str(path))


@pytest.mark.sweep
def test_a_browser_that_prints_nothing_or_never_ends_is_an_error_in_words(monkeypatch, tmp_path):
    scripted(monkeypatch, tmp_path / "fails", "echo no display >&2; exit 3")
    with pytest.raises(ResultsError, match=r"printed no PDF \(exit code 3\): no display; write the report as \.html"):
        printing.printed("<p>")
    monkeypatch.setattr(printing, "LONGEST", 0.2)
    scripted(monkeypatch, tmp_path / "hangs", "exec sleep 30")
    with pytest.raises(ResultsError, match="did not print the report within"):
        printing.printed("<p>")


def test_the_smallest_printed_text_has_seven_points():
    """In the style sheet, and in the pictures at the width at which they are printed."""
    sheet = files("rockpulse.views.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    printed = sheet.partition("@media print")[2]
    assert min(float(size) for size in re.findall(r"font-size: ([\d.]+)pt", printed)) >= 7.0
    (width,) = re.findall(r"figure svg:not\(.strip, .drawing\) { width: (\d+)mm", printed)
    assert style.SMALL * float(width) / (25.4 * style.WIDTH) > 7.0


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="no browser: apt-get install chromium")
def test_only_a_pdf_of_ours_is_replaced(tmp_path, monkeypatch):
    target = tmp_path / "report.pdf"
    report(results_tree(), target)
    content = target.read_bytes()
    assert content.startswith(b"%PDF-")
    assert content.endswith(PDF_MARK)
    assert len(re.findall(rb"/Type /Page\b", content)) > 3
    monkeypatch.setattr(printing, "printed", lambda page: content)
    report(results_tree(), target, overwrite=True)
    other = tmp_path / "other.pdf"
    other.write_bytes(b"%PDF-1.4\n%%EOF\n")
    with pytest.raises(ResultsError, match="not replaced even with"):
        report(results_tree(), other, overwrite=True)
