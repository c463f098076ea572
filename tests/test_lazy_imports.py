"""Frequent imports are fast: the help and the reader plugins load neither numba, xarray nor matplotlib."""

import json
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest
import scipy

READERS = Path(__file__).parents[1] / "pipeline" / "rockpulse" / "readers"
HEAVY = ("numba", "xarray", "h5py", "pandas", "scipy.signal", "obspy", "matplotlib", "jinja2")


def loaded(script, of=HEAVY):
    """Which of some packages a fresh interpreter has loaded after a script."""
    report = f"\nimport json, sys\nprint(json.dumps([name for name in {of!r} if name in sys.modules]), file=sys.stderr)"
    run = [sys.executable, "-c", script + report]
    done = subprocess.run(run, capture_output=True, text=True, timeout=300, check=True)
    return json.loads(done.stderr.splitlines()[-1])


def command(*arguments):
    return (
        "from rockpulse.cli import main\n"
        f"try:\n    main({list(arguments)!r})\nexcept SystemExit as end:\n    assert end.code == 0, end.code"
    )


SMALL = ("--help", "--version", "assess --help", "inspect --help", "report --help", "plot --help", "plot --list")
SMALL += ("formats", "init-config", "completion bash")


def none_of(steps):
    """A script of all the steps that stops at the first after which anything heavy is loaded, and names it."""
    check = f"heavy = [name for name in {HEAVY!r} if name in sys.modules]"
    return "import sys\n" + "\n".join(f"{step}\n{check}\nassert not heavy, ({step!r}, heavy)" for step in steps)


@pytest.mark.sweep
def test_the_help_does_not_load_numpy():
    assert "numpy" not in loaded(command("--help"), of=("numpy",))


@pytest.mark.sweep
def test_no_reader_loads_anything_heavy():
    paths = [path.relative_to(READERS.parent) for path in sorted(READERS.rglob("*.py")) if path.stem != "__init__"]
    names = [f"rockpulse.{'.'.join(path.with_suffix('').parts)}" for path in paths]
    assert len(names) > 20
    assert loaded(none_of(f"import {name}" for name in ["rockpulse.readers", *names])) == []


@pytest.mark.sweep
def test_small_verbs_the_faces_and_the_configuration_load_nothing_heavy():
    faces = ("rockpulse", "rockpulse.models", "rockpulse.config", "rockpulse.plots")
    assert loaded(none_of([*(command(*one.split()) for one in SMALL), *(f"import {name}" for name in faces)])) == []


@pytest.mark.sweep
def test_looking_at_results_loads_no_solver(golden):
    path = str(golden.results)
    commands = (["inspect", path, "--worst", "3"], ["diff", path, path])
    script = "\n".join(command(*arguments) for arguments in commands)
    assert not set(loaded(script)) & {"numba", "scipy.signal", "obspy", "matplotlib"}


#: What an assessment of text files may load of scipy, of which numba loads scipy.linalg.
OF_SCIPY = {"scipy.special", "scipy.linalg"}


@pytest.mark.sweep
def test_an_assessment_of_text_files_loads_only_what_it_uses(tmp_path):
    record = READERS.parents[2] / "data" / "samples" / "records" / "CICLC.v1"
    given = ["--block", "wall=0.3x2.4", "--demand", "pga=0.3g", "-o", str(tmp_path / "results.h5")]
    # If dask is installed, xarray loads it, and dask loads half of scipy.
    script = "import sys\nsys.modules['dask'] = None\n" + command("assess", str(record), *given)
    parts = [f"scipy.{one.name}" for one in pkgutil.iter_modules(scipy.__path__) if one.ispkg and one.name[0] != "_"]
    others = ("obspy", "matplotlib", "jinja2", "distributed", "h5netcdf")
    assert {"scipy.signal", "scipy.stats", "scipy.optimize", *OF_SCIPY} < set(parts)
    assert not set(loaded(script, of=(*parts, *others))) - OF_SCIPY


@pytest.mark.sweep
def test_the_measurement_sees_what_is_loaded():
    assert loaded("import colorsys", of=("colorsys", "h5py")) == ["colorsys"]
    with pytest.raises(subprocess.CalledProcessError) as stopped:
        loaded(none_of(["import json", "import h5py", "import colorsys"]))
    assert "AssertionError: ('import h5py', ['h5py'])" in stopped.value.stderr
