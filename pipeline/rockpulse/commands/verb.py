"""A verb of the command line: its name, help text, arguments, and the function that runs it."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Verb"]


@dataclass(frozen=True)
class Verb:
    """One verb of the command line."""

    name: str  # the word that calls it
    summary: str  # its line in the list of verbs
    description: str  # the head of its own help
    add_arguments: Callable[[argparse.ArgumentParser], None]  # adds its arguments to its parser
    # returns the exit code; raises RockpulseError or OSError for faults that the user can mend
    run: Callable[[argparse.Namespace], int]
    examples: tuple[str, ...] = ()  # command lines that show its use

    def add_to(self, subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
        """Add a parser for the verb to the subparsers of the program."""
        epilog = "\n  ".join(["examples:", *self.examples]) if self.examples else None
        parser = subparsers.add_parser(self.name, help=self.summary, description=self.description, epilog=epilog)
        self.add_arguments(parser)
        parser.set_defaults(run=self.run)
