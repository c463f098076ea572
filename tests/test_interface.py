"""What users rely on is still there: verbs, options, public names and stored variables of version 0.1.0.

A name that was given up or renamed is listed below, and in CHANGELOG.md.
"""

import argparse
import importlib
import json
from pathlib import Path

import pytest
from make_schema import KINDS

from rockpulse.cli import build_parser

TOP = Path(__file__).parents[1]
BEFORE = json.loads(Path(__file__).with_name("interface_0_1_0.json").read_text(encoding="utf-8"))
CHANGELOG = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")

#: Names of 0.1.0 that are gone, each with what stands in its place.
RENAMED = {
    "rule_demand": "Rule.demand",
    "rule_safety_factor": "Rule.safety_factor",
    "rule_sequence": "Rule.sequence",
}


def options_of(parser, words=()):
    """The options of a parser and of its verbs, by the words of the command."""
    found = {" ".join(words): {flag for action in parser._actions for flag in action.option_strings}}
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, verb in action.choices.items():
                found |= options_of(verb, (*words, name))
    return found


def test_every_verb_and_option_is_still_there():
    now = options_of(build_parser())
    assert set(BEFORE["options"]) <= set(now)
    lost = {words: set(flags) - now[words] for words, flags in BEFORE["options"].items()}
    assert {words: flags for words, flags in lost.items() if flags} == {}


@pytest.mark.parametrize("module", BEFORE["public names"])
def test_every_public_name_is_still_there_or_told_as_renamed(module):
    now = importlib.import_module(module)
    lost = {name for name in BEFORE["public names"][module] if name not in now.__all__}
    assert lost == {name for name in RENAMED if name in BEFORE["public names"][module]}
    assert all(hasattr(now, name) for name in set(BEFORE["public names"][module]) - lost)


def test_what_was_renamed_is_told_in_the_changelog():
    assert [name for name, new in RENAMED.items() if f"`{name}`" not in CHANGELOG or new not in CHANGELOG] == []


@pytest.mark.parametrize("kind", BEFORE["variables"])
def test_every_stored_variable_is_still_declared(kind):
    """Other tests hold the declarations against the files that are written."""
    groups = KINDS[kind.split()[0]].values()
    lost = set(BEFORE["variables"][kind]) - {name for group in groups for name in group}
    assert lost == set()
