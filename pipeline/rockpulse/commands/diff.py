"""``rockpulse diff``: the changes between two results files."""

from __future__ import annotations

import argparse
import math

from rockpulse.commands.selection_input import count
from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("first", metavar="BEFORE", help="results file")
    parser.add_argument("second", metavar="AFTER", help="results file of the same kind")
    parser.add_argument(
        "--rtol",
        type=_tolerance,
        default=1e-9,
        metavar="R",
        help="numbers may differ by R times the larger; default: %(default)g",
    )
    parser.add_argument(
        "--atol",
        type=_tolerance,
        default=0.0,
        metavar="A",
        help="and by A, in the unit of each variable; default: %(default)g",
    )
    parser.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="VARIABLE",
        help="do not compare this variable, named as it is or as in the output (/summary/pga); repeatable",
    )
    parser.add_argument(
        "--limit",
        type=count,
        metavar="N",
        help="most flipped verdicts, factors and capacities that crossed 1, that are named; default: 3, with --full 20",
    )
    parser.add_argument(
        "--full", action="store_true", help="every variable, name and line that differs; default: one screen of them"
    )


def _run(args: argparse.Namespace) -> int:
    from rockpulse.storage.hdf5.results_file import open_results
    from rockpulse.views.diff.differences import compare_results
    from rockpulse.views.diff.overview import difference_overview

    with open_results(args.first) as first, open_results(args.second) as second:
        limit = args.limit or (20 if args.full else 3)
        found = compare_results(first, second, args.rtol, args.atol, args.ignore, limit)
        tolerance = f"rtol {args.rtol:g}" + (f", atol {args.atol:g}" if args.atol else "")
        tell(difference_overview(found, first, second, tolerance, args.full))
    return 0 if found.same else 1


def _tolerance(words: str) -> float:
    try:
        value = float(words)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"expected a number from 0, found {words!r}")
    return value


VERB = Verb(
    name="diff",
    summary="what changed between two results files",
    description="Compare two results files: versions and configuration, records, blocks and models that only one has, "
    "verdicts that flipped, safety factors and capacities over demand that crossed 1, and variables beyond a "
    "tolerance. The bodies, and what comes first in every list, are by the nonlinear model where it answered. Rows are "
    "matched by name. "
    "Exit code 0 where the results are the same, 1 where they differ; versions and configuration are told and do not "
    "count.",
    add_arguments=_add_arguments,
    run=_run,
    examples=("rockpulse diff before.h5 after.h5", "rockpulse diff before.h5 after.h5 --rtol 1e-6 --ignore warnings"),
)
