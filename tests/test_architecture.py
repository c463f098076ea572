"""The shape of the house, read from the source text: three rings, imports that point inward, docstrings, packages."""

import ast
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PIPELINE, MODELS = ROOT / "pipeline", ROOT / "models"
SOURCES = sorted([*PIPELINE.rglob("*.py"), *MODELS.rglob("*.py")])

#: The outer ring of the package: files in, files and text out. What is not named here is the middle ring.
EDGE = {"readers", "sources", "store", "cli", "commands", "overview", "details", "terminal", "__main__"}
EDGE |= {"capacity_overview", "direction_overview", "failure_overview"}
EDGE |= {"fragility_overview"}
EDGE |= {"conversion", "obspy_plugin", "obspy_trace", "writers"}
EDGE |= {"accuracy_overview", "accuracy_files", "plots"}
EDGE |= {"design_file", "rule_overview", "site_overview"}
EDGE |= {"study_overview"}
EDGE |= {"checksums", "input_files", "target_file", "tree_writer", "verification"}
EDGE |= {"report"}
EDGE |= {"batch"}
EDGE |= {"results_file", "selection", "long_table", "table_files", "answer_lists", "large_overview"}
EDGE |= {"differences", "difference_overview", "row_matching"}
#: The face of the package, which names everything.
FACE = {"__init__"}


def imported(path):
    """(line, dotted name) of every import, wherever it stands; names imported from a package count as modules of it."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def ids(paths):
    return [str(path.relative_to(ROOT)) for path in paths]


@pytest.mark.parametrize("path", sorted(MODELS.rglob("*.py")), ids=ids(sorted(MODELS.rglob("*.py"))))
def test_models_import_only_numerics_and_themselves(path):
    allowed = set(sys.stdlib_module_names) | {"numpy", "scipy", "numba"}
    for line, name in imported(path):
        inside = name.startswith("rockpulse.models.")
        # The face of the models needs the lazy loader and nothing else.
        face = path.name == "__init__.py" and name.startswith("lazy_loader")
        assert inside or face or name.split(".")[0] in allowed, f"{path}:{line}: {name}"


def ring_member(path):
    return path.relative_to(PIPELINE).parts[0].removesuffix(".py")


MIDDLE = [path for path in sorted(PIPELINE.rglob("*.py")) if ring_member(path) not in EDGE | FACE]


@pytest.mark.parametrize("path", MIDDLE, ids=ids(MIDDLE))
def test_the_middle_ring_does_not_import_the_edge(path):
    for line, name in imported(path):
        parts = name.split(".")
        if parts[0] == "rockpulse":
            assert len(parts) > 1, f"{path}:{line}: the face of the package; import the submodule"
            assert parts[1] not in EDGE, f"{path}:{line}: {name} belongs to the edge"


READERS = sorted((PIPELINE / "readers").rglob("*.py"))


@pytest.mark.parametrize("path", READERS, ids=ids(READERS))
def test_readers_know_nothing_of_the_assessment(path):
    allowed = {"readers", "record", "errors"}
    for line, name in imported(path):
        parts = name.split(".")
        assert parts[0] != "rockpulse" or parts[1] in allowed, f"{path}:{line}: {name}"


def test_the_rings_hold_every_module_they_name():
    names = {ring_member(path) for path in PIPELINE.rglob("*.py")}
    assert names >= EDGE | FACE
    assert {"record", "assessment", "config", "accuracy", "reference", "synthetic"} <= {
        ring_member(path) for path in MIDDLE
    }


def test_the_packages_of_the_distribution_are_the_folders():
    setuptools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    folders = {"rockpulse"}
    for top, name in ((PIPELINE, "rockpulse"), (MODELS, "rockpulse.models")):
        for path in top.rglob("*.py"):
            folders.add(".".join([name, *path.parent.relative_to(top).parts]))
    assert set(setuptools["packages"]) == folders
    assert setuptools["package-dir"] == {"rockpulse": "pipeline", "rockpulse.models": "models"}


@pytest.mark.parametrize("path", SOURCES, ids=ids(SOURCES))
def test_every_module_and_every_public_function_has_a_docstring(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.get_docstring(tree), f"{path}: module"
    for node in [*tree.body, *(item for part in tree.body if isinstance(part, ast.ClassDef) for item in part.body)]:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            assert ast.get_docstring(node), f"{path}:{node.lineno}: {node.name}"


@pytest.mark.parametrize("path", SOURCES, ids=ids(SOURCES))
def test_no_file_grows_beyond_four_hundred_lines(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


@pytest.mark.parametrize("path", SOURCES, ids=ids(SOURCES))
def test_no_error_is_caught_bare_or_passed_over(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ExceptHandler):
            assert node.type is not None, f"{path}:{node.lineno}: bare except"
            assert not all(isinstance(item, ast.Pass) for item in node.body), f"{path}:{node.lineno}: passed over"


def test_the_public_names_are_there():
    import rockpulse
    from rockpulse import models

    for package, stub in ((rockpulse, PIPELINE / "__init__.pyi"), (models, MODELS / "__init__.pyi")):
        tree = ast.parse(stub.read_text(encoding="utf-8"))
        named = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert named
        assert named <= set(package.__all__)
        assert all(getattr(package, name) is not None for name in named)
