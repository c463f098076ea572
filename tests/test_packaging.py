"""What states the dependencies more than once states the same: pyproject.toml, the lowest versions and the recipe."""

import re
import tomllib
from pathlib import Path

from rockpulse import __version__

TOP = Path(__file__).parents[1]
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BOUNDS = dict(item.split(">=") for item in PROJECT["dependencies"])
#: Packages that conda calls otherwise.
CONDA = {"matplotlib": "matplotlib-base"}


def test_every_dependency_has_a_lower_bound_that_is_tried():
    lines = [line for line in (TOP / ".ci/lowest.txt").read_text().splitlines() if not line.startswith("#")]
    assert dict(line.split("==") for line in lines) == BOUNDS


def test_the_recipe_for_conda_agrees_with_the_project():
    recipe = (TOP / "conda/meta.yaml").read_text()
    run = re.search(r"  run:\n((?:    - .*\n)+)", recipe)[1]
    expected = {CONDA.get(name, name): bound for name, bound in BOUNDS.items()}
    expected["python"] = PROJECT["requires-python"].removeprefix(">=")
    assert dict(re.findall(r"- (\S+) >=(\S+)", run)) == expected
    assert f'version: "{__version__}"' in recipe
    assert PROJECT["scripts"] == {"rockpulse": "rockpulse.cli:main"}
    assert "- rockpulse = rockpulse.cli:main" in recipe


def test_the_container_copies_what_the_build_needs_and_runs_as_no_root():
    text = (TOP / "Containerfile").read_text()
    copied = [word for line in re.findall(r"^COPY (.*)$", text, re.MULTILINE) for word in line.split()[:-1]]
    assert all((TOP / name).exists() for name in copied)
    assert {"pyproject.toml", "hatch_build.py", PROJECT["readme"], "pipeline", "models"} <= set(copied)
    assert re.findall(r"^USER (.*)$", text, re.MULTILINE) == ["1000"]
