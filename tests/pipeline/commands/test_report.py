"""``rockpulse report`` on a tree that is known."""

import pytest

from rockpulse.app import CHILD
from rockpulse.cli import main


@pytest.mark.sweep
def test_it_writes_the_page_and_says_where(results, tmp_path, capsys, monkeypatch):
    report = tmp_path / "report.html"
    assert main(["report", results, "-o", str(report)]) == 0
    assert capsys.readouterr().out.startswith(f"report: {report} (0.")
    assert "boundary wall" in report.read_text(encoding="utf-8")
    assert main(["report", results, "-o", str(report)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    monkeypatch.setenv(CHILD, "1")  # started by the page, which shows the bar
    assert main(["report", results, "-o", str(report), "--overwrite"]) == 0
    assert "drawing: 100%" in capsys.readouterr().err
