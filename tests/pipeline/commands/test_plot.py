"""``rockpulse plot`` from a results file to a picture."""

import numpy as np
import pytest
from nominal import Config

import rockpulse as rp
from rockpulse import ModelSettings, SearchSettings
from rockpulse.cli import main


@pytest.fixture(scope="module")
def results(tmp_path_factory, loaded_once):
    """One channel on one body: neither has to be named."""
    path = tmp_path_factory.mktemp("plot") / "results.h5"
    settings = Config(models=ModelSettings(use=("resonance", "nonlinear")), search=SearchSettings(points=8))
    body = rp.models.Block(0.45, 1.8)
    time = 0.01 * np.arange(400)
    burst = 6.0 * np.sin(2.0 * np.pi * time) * np.exp(-((time - 2.0) ** 2))
    strong = rp.Record(burst, dt=0.01, id="CI.CCC..360@20190706T031937", processed=True)
    rp.save(rp.assess([strong], settings, bodies={"pinnacle": body}), path)
    return path


@pytest.mark.sweep
def test_the_suffix_chooses_the_format(results, tmp_path, capsys):
    target = tmp_path / "picture.png"
    assert main(["plot", str(results), "accelerogram", "-o", str(target)]) == 0
    assert target.read_bytes().startswith(b"\x89PNG")
    assert capsys.readouterr().out == f"written: {target}\n"


@pytest.mark.sweep
def test_models_and_options_are_passed_on(results, tmp_path, monkeypatch):
    from rockpulse.views.plots import drawing

    target = tmp_path / "picture.svg"
    words = ["--model", "nonlinear", "--model", "resonance", "-o", str(target), "--quiet"]
    assert main(["plot", str(results), "rotation-history", *words]) == 0
    assert "resonance (upper-bound input)" in target.read_text(encoding="utf-8")
    arguments = ["--restitution", "0.9", "-o", str(target), "--overwrite", "--quiet"]
    given, draw = [], drawing.DRAWERS["accelerogram"]

    def drawn(tree, axes, **options):
        given.append(options)
        return draw(tree)

    monkeypatch.setitem(drawing.DRAWERS, "rocking-spectrum", drawn)
    assert main(["plot", str(results), "rocking-spectrum", *arguments]) == 0
    assert given == [{"restitution": 0.9}]


def test_a_picture_that_exists_is_kept(results, tmp_path, run):
    target = tmp_path / "picture.svg"
    target.write_text("mine")
    assert "the file exists" in run("plot", results, "accelerogram", "-o", target, code=2).err
    assert target.read_text() == "mine"


def test_the_kinds_are_listed_with_the_file_each_needs(capsys):
    with pytest.raises(SystemExit) as end:
        main(["plot", "--list"])
    assert end.value.code == 0
    shown = capsys.readouterr().out
    assert "rotation-history" in shown
    assert "from: rockpulse fragility; options: --block, --measure, --limit-state" in shown
