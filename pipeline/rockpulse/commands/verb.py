"""What the verbs have in common: a name, a help text, arguments, and what is done with them."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Verb"]


@dataclass(frozen=True)
class Verb:
    """One verb of the command line.

    Attributes
    ----------
    name : str
        The word that calls it.
    summary : str
        Its line in the list of verbs.
    description : str
        The head of its own help.
    add_arguments : callable
        Adds its arguments to its parser.
    run : callable
        From the parsed arguments to the exit code; raises RockpulseError or OSError for what the user can mend.
    examples : tuple of str
        Command lines that show how it is used.
    """

    name: str
    summary: str
    description: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]
    examples: tuple[str, ...] = ()

    def add_to(self, subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
        """Make the verb known to a parser.

        Parameters
        ----------
        subparsers : argparse subparsers
            What ``add_subparsers`` returned.
        """
        epilog = "\n  ".join(["examples:", *self.examples]) if self.examples else None
        parser = subparsers.add_parser(self.name, help=self.summary, description=self.description, epilog=epilog)
        self.add_arguments(parser)
        parser.set_defaults(run=self.run)
