"""Architecture rules checked on the source text: layers in one order, no cycles, short files; ruff has the others."""

import ast
import sys
import tomllib
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOPS = [ROOT / "models", ROOT / "pipeline"]
SOURCES = [path for top in TOPS for path in sorted(top.rglob("*.py"))]

#: The rooms from the ground up, those of one line side by side: a module imports from its own room and from the lines
#: above its own. A room is the longest of these names that a module's dotted name begins with.
ROOMS = """
rocking.arguments rocking.pictures rocking.lanes rocking.kernel_cache
rocking.response
rocking.body
rocking.march
rocking.impulses
rocking.search
rocking.spectrum
rocking
rockpulse.version rockpulse.warning_text rockpulse.earthquakes
rockpulse.errors
rockpulse.option rockpulse.foreign_text
rockpulse.files
rockpulse.record
rockpulse.readers
rockpulse.sequences
rockpulse.model_table
rockpulse.config
rockpulse.selection
rockpulse.run.analysis
rockpulse.storage
rockpulse.assessment
rockpulse.studies.selftest
rockpulse.studies.site
rockpulse.studies.fragility
rockpulse.studies.risk
rockpulse.studies.check
rockpulse.studies.selection
rockpulse.run
rockpulse.views.shared
rockpulse.views.text
rockpulse.views.plots
rockpulse.views.diff
rockpulse.views.report
rockpulse.app
rockpulse.commands
rockpulse.cli
rockpulse.__main__
rockpulse.models rockpulse.plots
rockpulse
"""
LEVEL = {room: level for level, line in enumerate(ROOMS.split("\n")) for room in line.split()}
#: Packages that hold rooms and nothing else.
HALLS = {"rockpulse.studies", "rockpulse.views"}


@cache
def parsed(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def dotted(path):
    top = next(top for top in TOPS if path.is_relative_to(top))
    return ".".join(path.relative_to(top).with_suffix("").parts).removesuffix(".__init__")


def room_of(module):
    """The room of a module; empty for one that is in none."""
    names = module.split(".")
    lines = (".".join(names[:count]) for count in range(len(names), 0, -1))
    # The face is a room of one module: what is in no other room is not in it either.
    return next((name for name in lines if name in LEVEL and (name != "rockpulse" or module == name)), "")


def module_graph(sources):
    """The modules that each module imports, anywhere in its text and also where only types are checked.

    ``sources`` maps dotted names to syntax trees. An import from a package counts as one of the submodule of that name,
    where there is one.
    """
    graph = {name: set() for name in sources}
    for name, tree in sources.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                graph[name] |= {alias.name for alias in node.names} & set(sources)
            elif isinstance(node, ast.ImportFrom) and node.module in sources:
                inside = {f"{node.module}.{alias.name}" for alias in node.names}
                graph[name] |= (inside & set(sources)) or {node.module}
    return graph


def upward(graph):
    """The imports that lead to a line below the importer's own in the list of rooms, or to another room of its line."""
    found = []
    for name, imported in sorted(graph.items()):
        for other in sorted(imported):
            here, there = room_of(name), room_of(other)
            if here != there and here and there and LEVEL[there] >= LEVEL[here]:
                found.append(f"{name} -> {other}")
    return found


def circle(graph):
    """The modules of a circle of imports; empty where there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as found:
        return found.args[1]
    return []


@cache
def graph_of_all():
    return module_graph({dotted(path): parsed(path) for path in SOURCES})


def imports(path):
    """The names of the packages that a file imports, wherever an import stands."""
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module.split(".")[0]


@pytest.mark.sweep
def test_rocking_imports_only_numerics_and_itself():
    allowed = {*sys.stdlib_module_names, "numpy", "scipy", "numba", "platformdirs", "rocking"}
    for path in (path for path in SOURCES if path.is_relative_to(TOPS[0])):
        # The face needs the lazy loader and nothing else.
        assert set(imports(path)) - allowed <= ({"lazy_loader"} if path.name == "__init__.py" else set()), path


@pytest.mark.sweep
def test_every_module_has_a_room_and_every_room_a_module():
    homeless = [name for name in graph_of_all() if not room_of(name)]
    assert set(homeless) == HALLS
    assert {room_of(name) for name in graph_of_all()} - {""} == set(LEVEL)


@pytest.mark.sweep
def test_no_import_leads_upward():
    assert upward(graph_of_all()) == []


@pytest.mark.sweep
def test_no_modules_import_each_other_in_a_circle():
    assert circle(graph_of_all()) == []


def test_a_wrong_import_is_seen():
    wrong = {"rockpulse.record.record": "from rockpulse.views.text import overview", "rockpulse.views.text": "pass"}
    assert upward(module_graph({name: ast.parse(text) for name, text in wrong.items()})) == [
        "rockpulse.record.record -> rockpulse.views.text"
    ]
    face = {"rockpulse.storage.export.row_selection": "def f():\n    import rockpulse", "rockpulse": "pass"}
    assert len(upward(module_graph({name: ast.parse(text) for name, text in face.items()}))) == 1
    types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from rockpulse.config.bodies import Bodies"
    round_about = {"rockpulse.config.bodies": "import rockpulse.config.settings", "rockpulse.config.settings": types}
    assert set(circle(module_graph({name: ast.parse(text) for name, text in round_about.items()}))) == set(round_about)


def test_the_build_takes_the_two_packages_and_installs_them_in_place():
    build = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]
    assert build["targets"]["wheel"]["packages"] == ["pipeline/rockpulse", "models/rocking"]
    assert build["dev-mode-dirs"] == ["pipeline", "models"]
    packages = {dotted(path) for top in TOPS for path in top.glob("*/__init__.py")}
    assert packages == {"rockpulse", "rocking"}


def test_no_file_grows_beyond_four_hundred_lines():
    lengths = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    assert {name: length for name, length in lengths.items() if length > 400} == {}


def test_the_public_names_are_there_and_the_short_names_are_the_packages_themselves():
    import rocking
    import rockpulse
    from rockpulse import models
    from rockpulse.views import plots

    for package in (rockpulse, rocking, plots):
        tree = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
        named = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert named
        assert named <= set(package.__all__)
        assert all(getattr(package, name) is not None for name in named)
    for short, package in ((models, rocking), (rockpulse.plots, plots)):
        assert short.__all__ == package.__all__
        assert set(dir(short)) >= set(package.__all__)
        assert all(getattr(short, name) is getattr(package, name) for name in package.__all__)
    assert not hasattr(models, "no_such_name")


def test_the_tests_that_judge_mutants_exist():
    for tests in tomllib.loads((ROOT / "tests" / "mutants" / "tests.toml").read_text()).values():
        for path, _, name in (test.partition("::") for test in tests):
            assert f"def {name}" in (ROOT / path).read_text(), (path, name)
