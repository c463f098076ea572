"""``rockpulse inspect``: what is in a results file."""

from __future__ import annotations

import argparse
from importlib import import_module
from typing import TYPE_CHECKING

from rockpulse.commands.verb import Verb

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["VERB"]

#: Files of other verbs by the group that tells them: what they are, and the module and function of their text.
SHOWN_WHOLE = {
    "site": ("this is a site file", "site_overview"),
    "fragility": ("this is a fragility file", "fragility_overview"),
    "statements": ("this is a study", "study_overview"),
    "rates": ("these are verdicts of the rule", "rule_overview"),
}

NOTHING = "nothing failed and nothing was skipped"


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "results", metavar="RESULTS", help="file of rockpulse assess, calibrate, fragility, rule judge or study"
    )
    parser.add_argument("--record", metavar="ID", help="one record in detail")
    parser.add_argument("--block", metavar="NAME", help="one block in detail")
    parser.add_argument("--failures", action="store_true", help="what failed or was skipped, and why")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.details import block_details, record_details
    from rockpulse.failure_overview import failure_list
    from rockpulse.overview import overview
    from rockpulse.store import load

    tree = load(args.results)
    for group in SHOWN_WHOLE:
        if group in tree.children:
            return _inspect_whole(tree, group, args)
    summary = tree["summary"].to_dataset()
    parts = []
    if args.record is not None:
        parts.append(record_details(summary, args.record))
    if args.block is not None:
        parts.append(block_details(summary, args.block))
    if args.failures:
        parts.append(failure_list(tree) or NOTHING)
    print("\n\n".join(parts) if parts else overview(tree))
    return 0


def _inspect_whole(tree: xr.DataTree, group: str, args: argparse.Namespace) -> int:
    from rockpulse.errors import ResultsError
    from rockpulse.failure_overview import failure_list

    said, name = SHOWN_WHOLE[group]
    listed = "failures" in tree.children
    if args.record is not None or args.block is not None or (args.failures and not listed):
        options = "--record and --block" if listed else "--record, --block and --failures"
        raise ResultsError(
            f"{args.results}: {options} show results of 'rockpulse assess'; {said}, which inspect shows whole"
        )
    if args.failures:
        print(failure_list(tree) or NOTHING)
    else:
        print(getattr(import_module(f"rockpulse.{name}"), name)(tree))
    return 0


VERB = Verb(
    name="inspect",
    summary="show a results file",
    description="Show the verdicts of a results file, one record or block in detail, or what was not assessed.",
    add_arguments=_add_arguments,
    run=_run,
)
