"""``rockpulse report`` on a tree that is known."""

import pytest

from rockpulse.app import CHILD


@pytest.mark.sweep
def test_it_writes_the_page_and_says_where(results, tmp_path, run, monkeypatch):
    report = tmp_path / "report.html"
    assert run("report", results, "-o", report).out.startswith(f"report: {report} (0.")
    assert "boundary wall" in report.read_text(encoding="utf-8")
    assert "--overwrite" in run("report", results, "-o", report, code=2).err
    monkeypatch.setenv(CHILD, "1")  # started by the page, which shows the bar
    assert "drawing: 100%" in run("report", results, "-o", report, "--overwrite").err
