"""``rockpulse diff``: show the changes between two results files."""

import argparse
import math

from rockpulse.commands.parser import Verb
from rockpulse.commands.shared_options import parse_count
from rockpulse.commands.terminal import tell


def _run(args: argparse.Namespace) -> int:
    from rockpulse.views.diff.difference_overview import diff

    found = diff(args.first, args.second, args.rtol, args.atol, args.ignore, args.limit, args.full)
    tell(str(found))
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
    "matched by name. Exit code 0 where the results are the same, 1 where they differ; differences of versions "
    "and configuration are listed, but do not change the exit code.",
    options=(
        {
            "first": ("results file", {"metavar": "BEFORE"}),
            "second": ("results file of the same kind", {"metavar": "AFTER"}),
            "--rtol R": (
                "numbers may differ by R times the larger; default: %(default)g",
                {"type": _tolerance, "default": 1e-9},
            ),
            "--atol A": (
                "and by A, in the unit of each variable; default: %(default)g",
                {"type": _tolerance, "default": 0.0},
            ),
            "--ignore VARIABLE ...": "do not compare this variable, named as it is or as in the output (/summary/pga); "
            "repeatable",
            "--limit N": (
                "most flipped verdicts, factors and capacities that crossed 1, that are named; default: 3, with --full "
                "20",
                {"type": parse_count},
            ),
            "--full": "every variable, name and line that differs; default: one screen of them",
        },
    ),
    run=_run,
    examples=("rockpulse diff before.h5 after.h5", "rockpulse diff before.h5 after.h5 --rtol 1e-6 --ignore warnings"),
)
