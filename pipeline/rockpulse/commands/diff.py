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
        raise argparse.ArgumentTypeError(f"expected a number >= 0, found {words!r}")
    return value


VERB = Verb(
    name="diff",
    summary="list what changed between two results files",
    description="Compare two results files: versions and configuration, records, blocks and models that only one of "
    "them has, verdicts that changed, scale factors and capacities over demand that crossed 1, and variables beyond a "
    "tolerance. Bodies are compared by the nonlinear model if it was run; its changes come first in every list. Rows "
    "are matched by name. Exit code 0: the results are the same, 1: they differ; differences of versions "
    "and configuration are listed, but do not change the exit code.",
    options=(
        {
            "first": ("results file", {"metavar": "BEFORE"}),
            "second": ("results file of the same kind", {"metavar": "AFTER"}),
            "--rtol R": (
                "relative tolerance; default: %(default)g",
                {"type": _tolerance, "default": 1e-9},
            ),
            "--atol A": (
                "absolute tolerance, in the unit of each variable; default: %(default)g",
                {"type": _tolerance, "default": 0.0},
            ),
            "--ignore VARIABLE ...": "do not compare this variable, given by its name or its path (/summary/pga); "
            "repeatable",
            "--limit N": (
                "list at most N changed verdicts, and scale factors and capacities that crossed 1; default: 3, with "
                "--full 20",
                {"type": parse_count},
            ),
            "--full": "list every variable, name and line that differs; default: one screen",
        },
    ),
    run=_run,
    examples=("rockpulse diff before.h5 after.h5", "rockpulse diff before.h5 after.h5 --rtol 1e-6 --ignore warnings"),
)
