"""One table for each concept: what a row can do is asked from the row, and no name of one stands in another module.

Read from the source text. A name that is a word of something else there too is allowed by module, with the reason.
"""

import ast

from test_architecture import SOURCES, TOPS, dotted, parsed

from rockpulse.model_table import MODELS

PIPELINE = {dotted(path): parsed(path) for path in SOURCES if path.is_relative_to(TOPS[1])}

#: Words that are names of models in their own table, and of something else in these modules.
NO_MODEL = {
    "an input of models, and the equations of the solver, as a row says them": {
        ("rockpulse.model_row", "sequence"),
        ("rockpulse.model_row", "linear"),
        ("rockpulse.model_row", "nonlinear"),
    },
    "a section of the configuration": {
        ("rockpulse.config.settings", "sequence"),
        ("rockpulse.storage.save_load", "sequence"),
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
    "the method of an overturning spectrum": {
        ("rockpulse.assessment.overturning", "nonlinear"),
        ("rockpulse.config.settings", "nonlinear"),
        ("rockpulse.views.text.site", "nonlinear"),
    },
    "a kinematic check of a code": {
        ("rockpulse.storage.study_variables", "linear"),
        ("rockpulse.storage.study_variables", "nonlinear"),
        ("rockpulse.studies.check.against_histories", "linear"),
        ("rockpulse.studies.check.against_histories", "nonlinear"),
        ("rockpulse.views.plots.code_checks", "linear"),
        ("rockpulse.views.plots.code_checks", "nonlinear"),
    },
    "accuracy of the solver of an equation, and of models against it": {
        ("rockpulse.studies.accuracy.baseline", "linear"),
        ("rockpulse.studies.accuracy.baseline", "nonlinear"),
        ("rockpulse.studies.accuracy.convergence", "nonlinear"),
        ("rockpulse.studies.accuracy.model_form", "nonlinear"),
        ("rockpulse.views.text.accuracy", "nonlinear"),
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
