"""The options by which inspect and export take a part of a results file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rockpulse.storage.export.selection import Selection

__all__ = ["add_selection", "count", "read_selection"]


def add_selection(parser: argparse.ArgumentParser) -> None:
    """Add the options to the parser of a verb that already has ``--record`` and ``--block``."""
    parser.add_argument(
        "--model", action="append", metavar="NAME", help="only this model; * and ? stand for any letters; repeatable"
    )
    parser.add_argument(
        "--outcome",
        action="append",
        metavar="WORD",
        help="only this outcome: at_rest, rocks, overturns or unresolved; repeatable",
    )
    parser.add_argument(
        "--where",
        action="append",
        default=[],
        metavar="CONDITION",
        help="only where a variable, or a column of the tables, is so: 'factor_10 < 1', 'SF < 1', 'P > 0.5', "
        "'source = *.AT2'; repeatable, all have to hold",
    )
    parser.add_argument(
        "--sort", metavar="VARIABLE", help="by this variable or column, smallest first; what is not known last"
    )
    parser.add_argument("--descending", action="store_true", help="with --sort: largest first")
    parser.add_argument("--limit", type=count, metavar="N", help="at most so many rows")


def read_selection(args: argparse.Namespace) -> Selection:
    """The selection that the options of :func:`add_selection` and ``record`` and ``block`` (lists or None) ask for.

    Raises ResultsError for a condition that cannot be understood.
    """
    from rockpulse.errors import ResultsError
    from rockpulse.storage.export.selection import SHOWN, Condition, Selection

    if args.descending and args.sort is None:
        raise ResultsError("--descending goes with --sort VARIABLE")
    names = {dim: tuple(getattr(args, dim) or ()) for dim in ("record", "block", "model")}
    conditions = [Condition.parse(words) for words in args.where]
    if args.outcome:
        conditions.append(Condition("outcome", "=", "|".join(args.outcome)))
    return Selection(
        {dim: patterns for dim, patterns in names.items() if patterns},
        tuple(conditions),
        SHOWN.get(args.sort, args.sort),
        args.descending,
        args.limit,
    )


def count(words: str) -> int:
    """Parse an argument as a whole number from 1; raises ArgumentTypeError for any other text."""
    number = int(words) if words.isdecimal() else 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number from 1, found {words!r}")
    return number
