"""The cheapest model that answers, and the check of predictability, from the configuration to the file."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from nominal import toml

from rockpulse.cli import main

SCHEMA = Path(__file__).parents[3] / "docs" / "schema.md"
CONFIGURATION = """
[models]
use = ["nonlinear"]
auto = true
predictability = true
[[block]]
name = "parapet"
width = 0.25
height = 2.2
[[block]]
name = "column"
width = 1.1
height = 8.0
[[block]]
name = "chest"
width = 1.0
height = 2.0
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A smooth burst at two strengths, one column a file, assessed."""
    folder = tmp_path_factory.mktemp("auto")
    time = 0.01 * np.arange(1500)
    burst = np.sin(2.0 * np.pi * 1.7 * time) * np.exp(-(((time - 6.0) / 2.0) ** 2))
    for name, peak in (("strong", 4.5), ("weak", 1.5)):
        np.savetxt(folder / f"{name}.txt", np.column_stack([time, peak * burst]), fmt="%.6f")
    (folder / "site.toml").write_text(CONFIGURATION + toml(without="models"))
    target = folder / "results.h5"
    records = [str(folder / name) for name in ("strong.txt", "weak.txt")]
    arguments = ["--units", "m/s2", "--config", str(folder / "site.toml"), "-o", str(target)]
    assert main(["assess", *records, *arguments]) == 0
    return target


def flags(variable):
    """Number to name, as a reader of CF flags makes it."""
    return dict(zip(variable.attrs["flag_values"].tolist(), variable.attrs["flag_meanings"].split(), strict=True))


def test_the_file_says_which_model_answered_each_lane(results):
    with h5py.File(results) as file:
        summary = file["summary"]
        models = summary["model"].asstr()[:].tolist()
        assert models == ["nonlinear", "auto"]
        used, outcome = summary["model_used"], summary["outcome"]
        assert used.dtype == outcome.dtype == np.int8
        names = np.vectorize(flags(used).get)(used[:])
        assert set(flags(used).values()) >= {"resonance", "impulsive", "static", "settled", "nonlinear"}
        assert set(names[..., 0].ravel()) == {"nonlinear"}
        at_rest = np.vectorize(flags(outcome).get)(outcome[..., 1]) == "at_rest"
        assert np.array_equal(names[..., 1] == "static", at_rest)
        assert at_rest.any()
        assert np.array_equal(outcome[..., 0], outcome[..., 1])
        assert "auto = true" in file.attrs["configuration"]


def test_the_check_of_predictability_is_stored(results):
    with h5py.File(results) as file:
        marks = file["summary/predictable"]
        assert marks.dtype == np.int8
        assert flags(marks) == {-1: "not_checked", 0: "no", 1: "yes"}
        assert set(marks[:].ravel()) <= {0, 1}
        assert (marks[1, :, 0] == 1).all()  # a weak record is no matter of digits to the nonlinear model
        assert "1e-9" in marks.attrs["comment"]


def test_the_schema_names_what_is_new():
    text = SCHEMA.read_text(encoding="utf-8")
    for word in ("`predictable`", "`model_used`", "`static`", "`settled`", "`auto`"):
        assert word in text


def test_the_table_says_how_often_which_model_answered(results, capsys):
    assert main(["inspect", str(results), "--all"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "auto: the cheapest model that answers, here" in text
    assert "What overturns (by the nonlinear model)" in text


def test_inspect_names_the_model_behind_every_body(results, capsys):
    assert main(["inspect", str(results), "--block", "parapet"]) == 0
    part = capsys.readouterr().out.split("The model that answered for auto:\n")[1].split("\n\n")[0]
    with h5py.File(results) as file:
        used = file["summary/model_used"]
        names = np.vectorize(flags(used).get)(used[:])
        block = file["summary/block"].asstr()[:].tolist().index("parapet")
        assert [line.split()[-1] for line in part.splitlines()] == names[:, block, 1].tolist()
        assert [line.split()[0] for line in part.splitlines()] == file["summary/record"].asstr()[:].tolist()
