"""A name that has a row in a table stands nowhere else as a literal: what depends on it is read from the row."""

import ast
from pathlib import Path

import pytest

from rockpulse.record.measures import MEASURES, ROWS

TOP = Path(__file__).parents[1] / "pipeline" / "rockpulse"

#: Measures whose names other things have too: the impulse of a half-wave, and the ratio of the main impulse of a
#: sequence.
HOMONYMS = {"impulse", "impulse_ratio"}
NAMES = {*MEASURES, *ROWS} - HOMONYMS

#: Formats of files have words of their own.
FOREIGN = ("readers",)
#: Studies with tables of their own.
OWN = ("studies/accuracy", "studies/rule", "storage/rule_variables.py", "views/text/accuracy.py")


def named(tree, names, decisions=False):
    """The literals among some names, with their lines; with `decisions` only those that something is decided by.

    These are the sides of a comparison, but not what is subscripted or called with one: the stored variable of that
    name is read there.
    """
    exported = {
        id(one)
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and any(getattr(target, "id", "") == "__all__" for target in node.targets)
        for one in ast.walk(node)
    }
    nodes = ast.walk(tree)
    if decisions:
        sides = (side for node in nodes if isinstance(node, ast.Compare) for side in (node.left, *node.comparators))
        nodes = (
            one
            for side in sides
            for one in [side, *(side.elts if isinstance(side, (ast.Tuple, ast.List, ast.Set)) else [])]
        )
    return [
        (node.lineno, node.value)
        for node in nodes
        if isinstance(node, ast.Constant) and node.value in names and id(node) not in exported
    ]


@pytest.mark.parametrize(
    ("text", "every", "decided"),
    [
        ('unit = "m/s" if name in ("pgv", "si") else "m/s2"', 2, 2),
        ('if measure != "pga": pass', 1, 1),
        ('STRENGTH = {"pga": largest}', 1, 0),
        ('values = summary["pga"]', 1, 0),
        ('__all__ = ["pga"]', 0, 0),
        ('"the pga of a record"', 0, 0),
    ],
)
def test_the_search_sees_literals_and_what_decides(text, every, decided):
    tree = ast.parse(text)
    assert (len(named(tree, {"pga", "pgv", "si"})), len(named(tree, {"pga", "pgv", "si"}, True))) == (every, decided)


def test_measures_are_named_in_their_table_alone():
    """The views read the variables that they have columns for by their names; below them nothing does."""
    found = []
    for path in sorted(TOP.rglob("*.py")):
        file = path.relative_to(TOP).as_posix()
        if file != "record/measures.py" and not file.startswith((*FOREIGN, *OWN)):
            literals = named(ast.parse(path.read_text(encoding="utf-8")), NAMES, decisions=file.startswith("views"))
            found += [f"{file}:{line}: {name}" for line, name in literals]
    assert found == []
