"""One table per concept: properties are read from its rows, and no other module repeats the names of its rows.

Read from the source text. A name that is a word of something else there too is allowed by module, with the reason.
"""

import ast
from functools import cache

import pytest
from test_architecture import SOURCES, TOPS, dotted, parsed

from rockpulse.model_table import MODELS
from rockpulse.record.measures import MEASURES, ROWS

#: Words that are names of models in their own table, and of something else in these modules.
NO_MODEL = {
    "an input of models, and the equations of the solver, as a row says them": {
        ("rockpulse.model_row", "sequence"),
        ("rockpulse.model_row", "linear"),
        ("rockpulse.model_row", "nonlinear"),
    },
    "a section of the configuration": {},
    "the kind of the motions: records, pairs or the sequence of a site": {
        ("rockpulse.assessment.answers", "sequence"),
        ("rockpulse.views.text.verdicts", "sequence"),
    },
    "a file that holds a sequence": {("rockpulse.commands.terminal", "sequence")},
    "a working point of the rule, after which its model is called": {
        ("rockpulse.sequences.rule", "balanced"),
        ("rockpulse.sequences.rule", "conservative"),
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
        ("rockpulse.assessment.spectra", "nonlinear"),
        ("rockpulse.config.settings", "nonlinear"),
    },
}

#: Measures whose names other things have too: the impulse of a half-wave, and the ratio of the main impulse of a
#: sequence.
HOMONYMS = {"impulse", "impulse_ratio"}


@cache
def pipeline():
    """The syntax trees of the modules of rockpulse by their dotted names."""
    return {dotted(path): parsed(path) for path in SOURCES if path.is_relative_to(TOPS[1])}


def literals(tree, deciding=False):
    """The texts of a module; with ``deciding`` only the sides of comparisons, by which something is decided.

    Without docstrings, parts of f-strings, `__all__`, and what an attribute `kind` is compared with.
    """
    aside, sides = set(), set()
    for node in ast.walk(tree):
        of_all = isinstance(node, ast.Assign) and any(getattr(one, "id", "") == "__all__" for one in node.targets)
        docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if of_all or docstring or isinstance(node, ast.JoinedStr):
            aside |= set(ast.walk(node))
        elif isinstance(node, ast.Compare):
            compared = [node.left, *node.comparators]
            sides |= {one for side in compared for one in (side, *getattr(side, "elts", []))}
            aside |= set(node.comparators) if getattr(node.left, "attr", "") == "kind" else set()
    nodes = sides if deciding else ast.walk(tree)
    return [
        node for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in aside
    ]


def strays(names, home, allowed, modules=None, deciding=(), foreign=()):
    """Where names of the rows of a table stand as literals outside of it, and allowances that nothing needs any more.

    Parameters
    ----------
    names : the names of the rows.
    home : module of the table.
    allowed : reason why a name stands in another module, with the (module, name) that it holds for.
    modules : syntax tree of every module, by its dotted name; those of rockpulse by default.
    deciding : beginnings of modules that may read a stored variable by such a name, but decide nothing by it.
    foreign : beginnings of modules that have words of their own.
    """
    excused = set().union(*allowed.values())
    modules = pipeline() if modules is None else modules
    places = {
        (module, node.value): node.lineno
        for module, tree in modules.items()
        if module != home and not module.startswith(tuple(foreign))
        for node in literals(tree, deciding=module.startswith(tuple(deciding)))
        if node.value in names
    }
    found = [f"{module}:{places[module, name]}: {name!r}" for module, name in sorted(places.keys() - excused)]
    return found + [f"{module}: {name!r} is allowed and not there" for module, name in sorted(excused - places.keys())]


@pytest.mark.sweep
def test_names_of_models_stand_in_their_table_alone():
    assert strays({*MODELS}, "rockpulse.model_table", NO_MODEL) == []


@pytest.mark.sweep
def test_names_of_measures_stand_in_their_table_alone():
    """The views and the page have columns and inputs of measures by their names; below them none."""
    names, views, readers = {*MEASURES, *ROWS} - HOMONYMS, ["rockpulse.views", "rockpulse.app"], ["rockpulse.readers"]
    assert strays(names, "rockpulse.record.measures", {}, deciding=views, foreign=readers) == []


@pytest.mark.parametrize(
    ("text", "every", "decided"),
    [
        ('unit = "m/s" if name in ("pgv", "si") else "m/s2"', {"pgv", "si"}, {"pgv", "si"}),
        ('if measure != "pga": pass', {"pga"}, {"pga"}),
        ('STRENGTH = {"pga": largest}', {"pga"}, set()),
        ('values = summary["pga"]', {"pga"}, set()),
        ('if summary["pga"] > 1.0: pass', {"pga"}, set()),
        ('__all__ = ["pga"]', set(), set()),
        ('"""pga"""', set(), set()),
        ('def f(x):\n    """pga"""\n    return f"{x}pga"', set(), set()),
        ('if motions.kind == "pga": pass', set(), set()),
        ('"the pga of a record"', set(), set()),
    ],
)
def test_the_search_sees_literals_and_what_decides(text, every, decided):
    for deciding, seen in ((False, every), (True, decided)):
        found = {node.value for node in literals(ast.parse(text), deciding)}
        assert found & {"pga", "pgv", "si"} == seen


def test_an_allowance_holds_for_one_module_and_name_and_has_to_be_needed():
    modules = {"a.table": ast.parse('ROWS = ("fast", "slow")'), "a.wrong": ast.parse('CHOSEN = "fast"')}
    excuse = {"a reason": {("a.wrong", "fast")}}
    assert strays({"fast", "slow"}, "a.table", {}, modules) == ["a.wrong:1: 'fast'"]
    assert strays({"fast", "slow"}, "a.table", excuse, modules) == []
    assert strays({"fast", "slow"}, "a.table", {}, modules, foreign=["a.wr"]) == []
    assert strays({"fast", "slow"}, "a.table", {}, modules, deciding=["a.wr"]) == []
    assert strays({"slow"}, "a.table", excuse, modules) == ["a.wrong: 'fast' is allowed and not there"]
