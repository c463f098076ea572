"""``rockpulse inspect``: what is in a results file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from rockpulse.commands.verb import Verb

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["VERB"]


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
    if "site" in tree.children:
        return _inspect_site(tree, args)
    if "fragility" in tree.children:
        return _inspect_fragility(tree, args)
    if "statements" in tree.children:
        return _inspect_study(tree, args)
    if "rates" in tree.children:
        return _inspect_rule(tree, args)
    summary = tree["summary"].to_dataset()
    parts = []
    if args.record is not None:
        parts.append(record_details(summary, args.record))
    if args.block is not None:
        parts.append(block_details(summary, args.block))
    if args.failures:
        parts.append(failure_list(tree) or "nothing failed and nothing was skipped")
    print("\n\n".join(parts) if parts else overview(tree))
    return 0


def _inspect_site(tree: xr.DataTree, args: argparse.Namespace) -> int:
    from rockpulse.errors import ResultsError
    from rockpulse.failure_overview import failure_list
    from rockpulse.site_overview import site_overview

    if args.record is not None or args.block is not None:
        raise ResultsError(
            f"{args.results}: --record and --block show results of 'rockpulse assess'; this is a site file, "
            "which inspect shows whole"
        )
    none = "nothing failed and nothing was skipped"
    print((failure_list(tree) or none) if args.failures else site_overview(tree))
    return 0


def _inspect_fragility(tree: xr.DataTree, args: argparse.Namespace) -> int:
    from rockpulse.errors import ResultsError
    from rockpulse.failure_overview import failure_list
    from rockpulse.fragility_overview import fragility_overview

    if args.record is not None or args.block is not None:
        raise ResultsError(
            f"{args.results}: --record and --block show results of 'rockpulse assess'; this is a fragility file, "
            "which inspect shows whole"
        )
    none = "nothing failed and nothing was skipped"
    print((failure_list(tree) or none) if args.failures else fragility_overview(tree))
    return 0


def _inspect_study(tree: xr.DataTree, args: argparse.Namespace) -> int:
    from rockpulse.errors import ResultsError
    from rockpulse.study_overview import study_overview

    if args.record is not None or args.block is not None or args.failures:
        raise ResultsError(
            f"{args.results}: --record, --block and --failures show results of 'rockpulse assess'; this is a study, "
            "which inspect shows whole"
        )
    print(study_overview(tree))
    return 0


def _inspect_rule(tree: xr.DataTree, args: argparse.Namespace) -> int:
    from rockpulse.errors import ResultsError
    from rockpulse.failure_overview import failure_list
    from rockpulse.rule_overview import rule_overview

    if args.record is not None or args.block is not None:
        raise ResultsError(
            f"{args.results}: --record and --block show results of 'rockpulse assess'; these are verdicts of the rule, "
            "which inspect shows whole"
        )
    none = "nothing failed and nothing was skipped"
    print((failure_list(tree) or none) if args.failures else rule_overview(tree))
    return 0


VERB = Verb(
    name="inspect",
    summary="show a results file",
    description="Show the verdicts of a results file, one record or block in detail, or what was not assessed.",
    add_arguments=_add_arguments,
    run=_run,
)
