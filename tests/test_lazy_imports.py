"""What is imported often costs little: the help and the reader plugins load neither numba, xarray nor matplotlib."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from results_tree import results_tree

from rockpulse.store import save

READERS = Path(__file__).parents[1] / "pipeline" / "readers"
HEAVY = ("numba", "xarray", "h5py", "pandas", "scipy.signal", "obspy", "matplotlib", "jinja2")


def loaded(script):
    """Which heavy packages a fresh interpreter has loaded after a script."""
    report = (
        f"\nimport json, sys\nprint(json.dumps([name for name in {HEAVY!r} if name in sys.modules]), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script + report], capture_output=True, text=True, timeout=300, check=True
    )
    return json.loads(done.stderr.splitlines()[-1])


def command(*arguments):
    return (
        "from rockpulse.cli import main\n"
        f"try:\n    main({list(arguments)!r})\nexcept SystemExit as end:\n    assert end.code == 0, end.code"
    )


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["--version"],
        ["assess", "--help"],
        ["inspect", "--help"],
        ["report", "--help"],
        ["accuracy", "--help"],
        ["study", "figure4", "--help"],
        ["plot", "--help"],
        ["plot", "--list"],
        ["formats"],
        ["init-config"],
    ],
    ids=" ".join,
)
def test_help_and_small_verbs_load_nothing_heavy(arguments):
    assert loaded(command(*arguments)) == []


def test_no_reader_loads_anything_heavy():
    names = [f"rockpulse.readers.{path.stem}" for path in sorted(READERS.glob("*.py")) if path.stem != "__init__"]
    assert len(names) > 20
    script = f"""
import importlib, sys
for name in ["rockpulse.readers", *{names!r}, "rockpulse.obspy_plugin"]:
    importlib.import_module(name)
    heavy = [package for package in {HEAVY!r} if package in sys.modules]
    assert not heavy, (name, heavy)
"""
    assert loaded(script) == []


@pytest.mark.parametrize("name", ["rockpulse", "rockpulse.models", "rockpulse.config", "rockpulse.plots"])
def test_the_faces_and_the_configuration_load_nothing_heavy(name):
    assert loaded(f"import {name}") == []


def test_looking_at_results_loads_no_solver(tmp_path):
    path = str(tmp_path / "results.h5")
    save(results_tree(), path)
    commands = (["inspect", path], ["inspect", path, "--worst", "3"], ["diff", path, path])
    script = "\n".join(command(*arguments) for arguments in commands)
    assert not set(loaded(script)) & {"numba", "scipy.signal", "obspy", "matplotlib"}


def test_the_measurement_sees_what_is_loaded():
    assert "xarray" in loaded("import xarray")
