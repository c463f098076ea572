"""One table per concept: properties are read from its rows, and no other module repeats the names of its rows.

Read from the source text. A name that is a word of something else there too is allowed by module, with the reason.
"""

import ast
from functools import cache

import pytest
from test_architecture import SOURCES, TOPS, dotted, parsed

from rockpulse.model_table import MODELS
from rockpulse.record.measures import MEASURES, ROWS

#: Modules in which words that are names of models in their own table are something else, and what.
NO_MODEL = {
    "rockpulse.assessment.answers": {"sequence"},  # the kind of the motions: records, pairs or that of a site
    "rockpulse.views.text.verdicts": {"sequence"},
    "rockpulse.commands.terminal": {"sequence"},  # a file that holds a sequence
    "rockpulse.sequences.rule": {"balanced", "conservative"},  # points of the rule, after which models are called
    "rockpulse.config.settings": {"linear", "nonlinear"},  # a baseline correction, and the method of a spectrum
    "rockpulse.record.conditioning": {"linear"},
    "rockpulse.studies.selftest.baseline": {"linear", "nonlinear"},  # equations of a stored case
    "rockpulse.assessment.spectra": {"nonlinear"},  # the method of an overturning spectrum
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
    """By modules other than the home of a table the names of its rows that stand there as literals and need not.

    Also those that are `allowed` and not there. Modules that begin with `deciding` may read a stored variable by such a
    name, but decide nothing by it; those that begin with `foreign` have words of their own.
    """
    found = {
        module: {node.value for node in literals(tree, module.startswith(tuple(deciding)))} & set(names)
        for module, tree in (modules or pipeline()).items()
        if module != home and not module.startswith(tuple(foreign))
    }
    wrong = {module: words ^ allowed.get(module, set()) for module, words in found.items()}
    return {module: words for module, words in wrong.items() if words}


@pytest.mark.sweep
def test_names_of_models_stand_in_their_table_alone():
    assert strays({*MODELS}, "rockpulse.model_table", NO_MODEL) == {}


@pytest.mark.sweep
def test_names_of_measures_stand_in_their_table_alone():
    """The views and the page have columns and inputs of measures by their names; below them none."""
    names, views, readers = {*MEASURES, *ROWS} - HOMONYMS, ["rockpulse.views", "rockpulse.app"], ["rockpulse.readers"]
    assert strays(names, "rockpulse.record.measures", {}, deciding=views, foreign=readers) == {}


@pytest.mark.parametrize(
    ("text", "every", "decided"),
    [
        ('unit = "m/s" if name in ("pgv", "si") else "m/s2"', {"pgv", "si"}, {"pgv", "si"}),
        ('if measure != "pga": pass', {"pga"}, {"pga"}),
        ('STRENGTH = {"pga": largest}', {"pga"}, set()),
        ('values = summary["pga"]', {"pga"}, set()),
        ('__all__ = ["pga"]\ndef f(x):\n    """pga"""\n    return f"{x}pga", "a pga"', set(), set()),
        ('if motions.kind == "pga": pass', set(), set()),
    ],
)
def test_the_search_sees_literals_and_what_decides(text, every, decided):
    for deciding, seen in ((False, every), (True, decided)):
        found = {node.value for node in literals(ast.parse(text), deciding)}
        assert found & {"pga", "pgv", "si"} == seen


def test_an_allowance_holds_for_one_module_and_name_and_has_to_be_needed():
    modules = {"a.table": ast.parse('ROWS = ("fast", "slow")'), "a.wrong": ast.parse('CHOSEN = "fast"')}
    assert strays({"fast", "slow"}, "a.table", {}, modules) == {"a.wrong": {"fast"}}
    assert strays({"fast", "slow"}, "a.table", {"a.wrong": {"fast"}}, modules) == {}
    assert strays({"slow"}, "a.table", {"a.wrong": {"fast"}}, modules) == {"a.wrong": {"fast"}}
    for aside in ("foreign", "deciding"):
        assert strays({"fast", "slow"}, "a.table", {}, modules, **{aside: ["a.wr"]}) == {}
