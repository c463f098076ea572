"""The class of a command (verb), and a parser that accepts only full names and suggests correct ones."""

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from shutil import get_terminal_size
from textwrap import fill
from typing import Any, NoReturn, TypeAlias

from rockpulse.foreign_text import escaped
from rockpulse.option import hint

#: Arguments of a command: flags and value, such as "-o --output FILE", with their help or the keywords of
#: ``add_argument``. An argument without a flag is positional, and one without a value is a switch; "NAME ..." may be
#: repeated and gives a list; "FILE !" is required.
Options: TypeAlias = Mapping[str, str | tuple[str, Mapping[str, Any]]]


class Either(dict[str, "str | tuple[str, Mapping[str, Any]]"]):
    """Options of which a command line may contain only one."""


@dataclass(frozen=True)
class Verb:
    """One command of rockpulse, such as ``assess``."""

    name: str  # name of the command
    summary: str  # line in the list of commands
    description: str  # introduction of its help
    options: tuple[Options, ...]  # arguments, in the order of the help
    run: Callable[[argparse.Namespace], int]  # the function that runs it
    examples: tuple[str, ...]  # example command lines

    def add_to(self, subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]", complete: bool = True) -> None:
        """Add a parser for the command to the subparsers of the program, with its options if `complete`."""
        epilog = "\n  ".join(["examples:", *self.examples])
        parser = subparsers.add_parser(self.name, help=self.summary, description=self.description, epilog=epilog)
        for table in self.options if complete else ():
            target = parser.add_mutually_exclusive_group() if isinstance(table, Either) else parser
            for words, entry in table.items():
                text, more = (entry, {}) if isinstance(entry, str) else entry
                flags, given = _arguments(words)
                target.add_argument(*flags, help=text, **{**given, **more})
        parser.set_defaults(run=self.run)


def command(*options: Options, examples: tuple[str, ...]) -> Callable[[Callable[[argparse.Namespace], int]], Verb]:
    """Make a command of the decorated function: its docstring is the line in the list of commands and the introduction.

    The function returns the exit code, and raises RockpulseError or OSError for errors that the user can correct.
    """

    def made(run: Callable[[argparse.Namespace], int]) -> Verb:
        summary, _, description = (run.__doc__ or "").partition(".\n\n")
        name = run.__name__.replace("_", "-")
        return Verb(name, summary[:1].lower() + summary[1:], " ".join(description.split()), options, run, examples)

    return made


def number(kind: type[int] | type[float], low: float, high: float, expected: str) -> Callable[[str], float]:
    """Return a parser of a finite number from `low` to `high`; its error message says what is `expected`."""

    def parsed(text: str) -> float:
        try:
            value = kind(text) if kind is float or text.isdecimal() else math.nan
        except ValueError:
            value = math.nan
        if not (low <= value <= high and value < math.inf):
            raise argparse.ArgumentTypeError(f"expected {expected}, found {text!r:.40}")
        return value

    return parsed


def _arguments(words: str) -> tuple[list[str], dict[str, Any]]:
    """Convert a text such as "-o --output FILE" to the arguments and keywords for ``add_argument``."""
    parts = words.split()
    flags = [part for part in parts if part.startswith("-")]
    metavar = next((part for part in parts if not part.startswith("-") and part not in ("...", "!")), None)
    if not flags:
        assert metavar is not None
        return [metavar.lower()], {"metavar": metavar}
    if metavar is None:
        return flags, {"action": "store_true"}
    given: dict[str, Any] = {"metavar": metavar}
    if "..." in parts:
        given |= {"action": "append", "default": []}
    if "!" in parts:
        given["required"] = True
    return flags, given


class Parser(argparse.ArgumentParser):
    """An ArgumentParser that accepts no abbreviations, suggests correct words, and keeps line breaks of examples."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **options)
        if self.description:
            self.description = fill(self.description, get_terminal_size().columns - 2)
        self._given: list[str] = []

    # argparse declares its return type by overloads.
    def parse_known_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:  # type: ignore[override]
        """Parse as ArgumentParser does, but report unknown words here, where the options are known."""
        self._given = list(sys.argv[1:] if args is None else args)
        for word in self._given:
            meant = self._option_string_actions.get(f"-{word}")
            if meant is not None and meant.nargs != 0:  # argparse would parse -output as -o with the value "utput"
                self.error(f"unrecognized arguments: {word}")
        found, left = super().parse_known_args(self._given, namespace)
        if left:
            several = any(one.nargs in ("*", "+") for one in self._actions if not one.option_strings)
            apart = "; give all paths together" if several and not left[0].startswith("-") else ""
            self.error(f"unrecognized arguments: {' '.join(left)}{apart}")
        return found, left

    def error(self, message: str) -> NoReturn:
        """Exit as ArgumentParser does; the message suggests correct words for misspelt words."""
        super().error("".join([message, *self._hints(message)]))

    def _print_message(self, message: str, file: Any = None) -> None:
        super()._print_message(escaped(message), file)

    def _hints(self, message: str) -> Iterator[str]:
        options = list(self._option_string_actions)
        verbs = next((list(one.choices) for one in self._actions if isinstance(one, argparse._SubParsersAction)), [])
        for word in self._given:
            if word == "--":
                return
            if word.startswith("-"):
                name = word.partition("=")[0]
                near = "" if name in options else hint(name if name.startswith("--") else f"-{name}", options)
                yield near if name in message or not near else f"; {name} is not known{near}"
            elif verbs:
                yield "" if word in verbs else hint(word, verbs)
                return  # the parser of the command checks later words
