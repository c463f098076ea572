"""``rockpulse inspect``: what is in a results file."""

from __future__ import annotations

import argparse

from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", metavar="RESULTS", help="file written by rockpulse assess")
    parser.add_argument("--record", metavar="ID", help="one record in detail")
    parser.add_argument("--block", metavar="NAME", help="one block in detail")
    parser.add_argument("--failures", action="store_true", help="what failed or was skipped, and why")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.details import block_details, record_details
    from rockpulse.failure_overview import failure_list
    from rockpulse.overview import overview
    from rockpulse.store import load

    tree = load(args.results)
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


VERB = Verb(
    name="inspect",
    summary="show a results file",
    description="Show the verdicts of a results file, one record or block in detail, or what was not assessed.",
    add_arguments=_add_arguments,
    run=_run,
)
