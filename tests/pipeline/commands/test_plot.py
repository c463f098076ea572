"""``rockpulse plot`` from a results file to a picture."""

import h5py
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
def test_what_is_drawn_is_what_the_file_holds(results):
    with h5py.File(results) as file:
        stored = {
            name: file[f"summary/{name}"][()] for name in ("pga", "main_impulse", "intense_start", "safety_factor")
        }
        lower = file["overturning_intervals/lower"][()][file["overturning_intervals/model_index"][()] == 1]
        impulse = file["records/half_wave_impulse"][()]
        units = file["summary/main_impulse"].attrs["units"]
    tree = rp.load(results)
    whole, _, impulses = rp.plots.draw(tree, "accelerogram").axes
    assert np.max(np.abs(whole.lines[1].get_ydata())) == stored["pga"][0]
    lines = dict(zip(*reversed(impulses.get_legend_handles_labels()), strict=True))
    assert np.nanmax(np.abs(lines["impulses"].get_ydata())) == np.max(np.abs(impulse))
    assert next(line for words, line in lines.items() if "pm I$" in words).get_ydata()[0] == stored["main_impulse"][0]
    assert (impulses.get_ylabel()[-5:], units) == ("[m/s]", "m s^-1")
    (ax,) = rp.plots.draw(tree, "overturning-map").axes
    (dot,) = (line for line in ax.lines if line.get_label() == "smallest scale factor")
    assert dot.get_xdata() == stored["safety_factor"][0, 0, 1] == lower[0]
    overturns = next(bars for bars in ax.containers if bars.get_label() == "overturns")
    assert overturns[0].get_x() == lower[0]


@pytest.mark.sweep
def test_a_picture_is_the_same_on_every_run(results, tmp_path):
    pictures = [tmp_path / name for name in ("one.svg", "two.svg")]
    for picture in pictures:
        assert main(["plot", str(results), "critical-scale", "-o", str(picture), "--quiet"]) == 0
    assert pictures[0].read_bytes() == pictures[1].read_bytes()
    assert pictures[0].read_bytes().startswith(b"<?xml")


@pytest.mark.sweep
def test_models_and_options_are_passed_on(results, tmp_path, monkeypatch):
    from rockpulse.views.plots import drawing

    target = tmp_path / "picture.svg"
    words = ["--model", "nonlinear", "--model", "resonance", "-o", str(target), "--quiet"]
    assert main(["plot", str(results), "rotation-history", *words]) == 0
    assert "resonance (upper-bound input)" in target.read_text(encoding="utf-8")
    arguments = ["--restitution", "0.9", "-o", str(target), "--overwrite", "--quiet"]
    given, draw = [], drawing.DRAWERS["accelerogram"]

    def drawn(tree, **options):
        given.append(options)
        return draw(tree)

    monkeypatch.setitem(drawing.DRAWERS, "rocking-spectrum", drawn)
    assert main(["plot", str(results), "rocking-spectrum", *arguments]) == 0
    assert given == [{"restitution": 0.9}]


def test_a_picture_that_exists_is_kept(results, tmp_path, capsys):
    target = tmp_path / "picture.svg"
    target.write_text("mine")
    assert main(["plot", str(results), "accelerogram", "-o", str(target)]) == 2
    assert "the file exists" in capsys.readouterr().err
    assert target.read_text() == "mine"


def test_the_kinds_are_listed_with_the_file_each_needs(capsys):
    with pytest.raises(SystemExit) as end:
        main(["plot", "--list"])
    assert end.value.code == 0
    shown = capsys.readouterr().out
    assert "rotation-history" in shown
    assert "from: rockpulse fragility; options: --block, --measure, --limit-state" in shown
