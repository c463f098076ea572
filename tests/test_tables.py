"""One table for each concept: what a row can do is asked from the row, and no name of one stands in another module.

Read from the source text. A name that is a word of something else there too is allowed by module, with the reason.
"""

import ast

import pytest
from test_architecture import SOURCES, TOPS, dotted, parsed

from rockpulse.model_table import MODELS
from rockpulse.record.measures import MEASURES, ROWS

TOP = TOPS[1] / "rockpulse"
PIPELINE = {dotted(path): parsed(path) for path in SOURCES if path.is_relative_to(TOPS[1])}

#: Measures whose names other things have too: the impulse of a half-wave, and the ratio of the main impulse of a
#: sequence.
HOMONYMS = {"impulse", "impulse_ratio"}
NAMES = {*MEASURES, *ROWS} - HOMONYMS

#: Formats of files have words of their own.
FOREIGN = ("readers",)


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
        if file != "record/measures.py" and not file.startswith(FOREIGN):
            literals = named(ast.parse(path.read_text(encoding="utf-8")), NAMES, decisions=file.startswith("views"))
            found += [f"{file}:{line}: {name}" for line, name in literals]
    assert found == []


#: Words that are names of models in their own table, and of something else in these modules.
NO_MODEL = {
    "an input of models, and the equations of the solver, as a row says them": {
        ("rockpulse.model_row", "sequence"),
        ("rockpulse.model_row", "linear"),
        ("rockpulse.model_row", "nonlinear"),
    },
    "a section of the configuration": {
        ("rockpulse.config.settings", "sequence"),
    },
    "the kind of the motions: records, pairs or the sequence of a site": {
        ("rockpulse.assessment.answers", "sequence"),
        ("rockpulse.views.plots.probability_map", "sequence"),
        ("rockpulse.views.shared.verdict_notes", "sequence"),
        ("rockpulse.views.text.verdicts", "sequence"),
    },
    "a file that holds a sequence, and a fact on a record": {
        ("rockpulse.commands.file_fault", "sequence"),
        ("rockpulse.views.report.pages", "sequence"),
    },
    "a working point of the rule, after which its model is called": {
        ("rockpulse.calibration.rule", "balanced"),
        ("rockpulse.calibration.rule", "conservative"),
    },
    "the straight line of a baseline correction": {
        ("rockpulse.config.settings", "linear"),
        ("rockpulse.record.conditioning", "linear"),
    },
    "the equation that a stored case of the selftest is solved with": {
        ("rockpulse.studies.selftest.baseline", "linear"),
        ("rockpulse.studies.selftest.baseline", "nonlinear"),
    },
    "the method of an overturning spectrum": {
        ("rockpulse.assessment.overturning", "nonlinear"),
        ("rockpulse.config.settings", "nonlinear"),
        ("rockpulse.views.text.site", "nonlinear"),
    },
}


def literals(tree):
    """Every text of a module but docstrings, parts of f-strings, and what an attribute `kind` is compared with."""
    aside = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            aside |= set(ast.walk(node))
        elif isinstance(node, ast.Compare) and isinstance(node.left, ast.Attribute) and node.left.attr == "kind":
            aside |= set(node.comparators)
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in aside
    ]


def strays(names, home, allowed, modules=PIPELINE):
    """Where names of the rows of a table stand as literals outside of it, and allowances that nothing needs any more.

    Parameters
    ----------
    names : the names of the rows.
    home : module of the table.
    allowed : reason why a name stands in another module, with the (module, name) that it holds for.
    modules : syntax tree of every module, by its dotted name.
    """
    excused = set().union(*allowed.values())
    places = {
        (module, node.value): node.lineno
        for module, tree in modules.items()
        if module != home
        for node in literals(tree)
        if node.value in names
    }
    found = [f"{module}:{places[module, name]}: {name!r}" for module, name in sorted(places.keys() - excused)]
    return found + [f"{module}: {name!r} is allowed and not there" for module, name in sorted(excused - places.keys())]


def test_names_of_models_stand_in_their_table_alone():
    assert strays({*MODELS}, "rockpulse.model_table", NO_MODEL) == []


def test_a_name_outside_of_its_table_is_seen():
    passed = '"""fast"""\n\ndef f(x):\n    """slow"""\n    return x.kind == "slow", f"{x}fast"\n'
    modules = {"a.table": ast.parse('ROWS = ("fast", "slow")'), "a.other": ast.parse(passed)}
    assert strays({"fast", "slow"}, "a.table", {}, modules) == []
    for wrong in ('CHOSEN = "fast"', 'def f(x):\n    return x == "fast"', 'def f(x):\n    return {"fast": 1}[x]'):
        modules["a.wrong"] = ast.parse(wrong)
        (found,) = strays({"fast", "slow"}, "a.table", {}, modules)
        assert found.startswith("a.wrong:")
        assert found.endswith(": 'fast'")
        assert strays({"fast", "slow"}, "a.table", {"a reason": {("a.wrong", "fast")}}, modules) == []
    (stale,) = strays({"slow"}, "a.table", {"a reason": {("a.wrong", "fast")}}, modules)
    assert "not there" in stale
