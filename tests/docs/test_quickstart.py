"""The quick start is a small notebook that runs, shows something in every cell, and carries no output."""

import importlib
import json
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
NOTEBOOK = DOCS / "tutorials" / "quickstart.ipynb"


@pytest.fixture
def run(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS / "extensions"))
    return importlib.import_module("notebook_cells").run


def test_it_is_kept_without_outputs():
    kept = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    code = [cell for cell in kept["cells"] if cell["cell_type"] == "code"]
    assert (kept["nbformat"], kept["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in kept["cells"]}) == len(kept["cells"])
    assert [(cell["outputs"], cell["execution_count"]) for cell in code] == [([], None)] * len(code)


@pytest.mark.sweep
def test_every_cell_runs_and_shows_something_where_the_clone_keeps_it(run):
    cells = [cell for cell in run(NOTEBOOK) if cell.code]
    assert len(cells) > 5
    assert [cell.text for cell in cells if cell.value is None] == []
    values = [cell.value for cell in cells]
    assert ["rocks", "rocks", "overturns"] in [value.tolist() for value in values if hasattr(value, "tolist")]
    (verdicts,) = (value for value in values if hasattr(value, "columns"))
    assert set(verdicts["verdict"]) == {""}  # five earthquakes are needed
    assert verdicts["probability"]["garden wall"] > 0.5 > 0.05 > verdicts["probability"]["parapet"]
    assert sum(hasattr(value, "savefig") for value in values) == 3
