"""The shape of the house, read from the source text: three rings, imports that point inward, docstrings, packages.

Each rule is one test over all sources, which names every offender.
"""

import ast
import sys
import tomllib
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PIPELINE, MODELS = ROOT / "pipeline", ROOT / "models"
PIPELINE_FILES, MODEL_FILES = sorted(PIPELINE.rglob("*.py")), sorted(MODELS.rglob("*.py"))
SOURCES = [*PIPELINE_FILES, *MODEL_FILES]
READERS = [path for path in PIPELINE_FILES if path.is_relative_to(PIPELINE / "readers")]

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
EDGE |= {"answer_changes", "differences", "difference_overview", "row_matching"}
EDGE |= {"record_marks", "verdict_notes"}
#: The face of the package, which names everything.
FACE = {"__init__"}


@cache
def parsed(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def place(path, node):
    return f"{path.relative_to(ROOT)}:{node.lineno}"


def imports(paths):
    """(place, file, dotted name) of every import, wherever it stands; names from a package count as modules of it."""
    for path in paths:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Import):
                yield from ((place(path, node), path, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                module = "." * node.level + (node.module or "")
                yield from ((place(path, node), path, f"{module}.{alias.name}") for alias in node.names)


def test_no_import_is_relative():
    assert [f"{where}: {name}" for where, _, name in imports(SOURCES) if name.startswith(".")] == []


def test_models_import_only_numerics_and_themselves():
    allowed = set(sys.stdlib_module_names) | {"numpy", "scipy", "numba"}
    offenders = []
    for where, path, name in imports(MODEL_FILES):
        inside = name.startswith("rockpulse.models.")
        # The face of the models needs the lazy loader and nothing else.
        face = path.name == "__init__.py" and name.startswith("lazy_loader")
        if not (inside or face or name.split(".")[0] in allowed):
            offenders.append(f"{where}: {name}")
    assert offenders == []


def ring_member(path):
    return path.relative_to(PIPELINE).parts[0].removesuffix(".py")


MIDDLE = [path for path in PIPELINE_FILES if ring_member(path) not in EDGE | FACE]


def test_the_middle_ring_imports_neither_the_edge_nor_the_face():
    # Of the face, which is `rockpulse` itself, the submodule is to be imported.
    ours = [(where, name.split(".")) for where, _, name in imports(MIDDLE) if name.split(".")[0] == "rockpulse"]
    assert [f"{where}: {'.'.join(parts)}" for where, parts in ours if len(parts) == 1 or parts[1] in EDGE] == []


def test_readers_know_nothing_of_the_assessment():
    allowed = {"readers", "record", "errors"}
    ours = [(where, name.split(".")) for where, _, name in imports(READERS) if name.split(".")[0] == "rockpulse"]
    assert [f"{where}: {'.'.join(parts)}" for where, parts in ours if not allowed.intersection(parts[1:2])] == []


def test_the_rings_hold_every_module_they_name():
    names = {ring_member(path) for path in PIPELINE_FILES}
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


def test_every_module_and_every_public_function_has_a_docstring():
    offenders = []
    for path in SOURCES:
        tree = parsed(path)
        inner = [item for part in tree.body if isinstance(part, ast.ClassDef) for item in part.body]
        public = [
            node
            for node in [*tree.body, *inner]
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
        ]
        offenders += [] if ast.get_docstring(tree) else [f"{path.relative_to(ROOT)}: module"]
        offenders += [f"{place(path, node)}: {node.name}" for node in public if not ast.get_docstring(node)]
    assert offenders == []


def test_no_file_grows_beyond_four_hundred_lines():
    lengths = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    assert {name: length for name, length in lengths.items() if length > 400} == {}


def test_no_error_is_caught_bare_or_passed_over():
    offenders = []
    for path in SOURCES:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ExceptHandler):
                offenders += [f"{place(path, node)}: bare except"] if node.type is None else []
                passed = all(isinstance(item, ast.Pass) for item in node.body)
                offenders += [f"{place(path, node)}: passed over"] if passed else []
    assert offenders == []


def test_the_public_names_are_there():
    import rockpulse
    from rockpulse import models

    for package, stub in ((rockpulse, PIPELINE / "__init__.pyi"), (models, MODELS / "__init__.pyi")):
        tree = ast.parse(stub.read_text(encoding="utf-8"))
        named = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert named
        assert named <= set(package.__all__)
        assert all(getattr(package, name) is not None for name in named)
