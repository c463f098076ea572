"""Directives `command-help` and `configuration-template`: what the program prints, taken while the manual is built."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from typing import Any
from unittest.mock import patch

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from rockpulse.cli import build_parser
from rockpulse.commands.init_config import config_template

COLUMNS = "100"


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """A parser and all below it, in the order of the help."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from parsers(below)


def help_texts() -> dict[str, str]:
    """Help of every command by its words, "rockpulse" first, as a terminal of 100 columns shows it."""
    with patch.dict(os.environ, {"COLUMNS": COLUMNS, "NO_COLOR": "1"}):
        return {parser.prog: parser.format_help() for parser in parsers(build_parser())}


class CommandHelp(SphinxDirective):
    """A section for each command, with its help as it is printed."""

    def run(self) -> list[nodes.Node]:
        """The sections."""
        sections: list[nodes.Node] = []
        for command, text in help_texts().items():
            section = nodes.section(ids=[nodes.make_id(command)], names=[command])
            section += nodes.title(command, command)
            section += nodes.literal_block(text, text, language="none")
            self.state.document.note_explicit_target(section)
            sections.append(section)
        return sections


class ConfigurationTemplate(SphinxDirective):
    """The configuration that ``rockpulse init-config`` writes."""

    def run(self) -> list[nodes.Node]:
        """The text of the file."""
        text = config_template()
        return [nodes.literal_block(text, text, language="toml")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the directives known to Sphinx."""
    app.add_directive("command-help", CommandHelp)
    app.add_directive("configuration-template", ConfigurationTemplate)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
