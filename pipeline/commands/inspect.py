"""``rockpulse inspect``: what is in a results file."""

from __future__ import annotations

import argparse

__all__ = ["add_parser", "run"]


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb.

    Parameters
    ----------
    subparsers : argparse subparsers
        What ``add_subparsers`` returned.
    """
    parser = subparsers.add_parser(
        "inspect",
        help="show a results file",
        description="Show the verdicts of a results file, one record or block in detail, or what was not assessed.",
    )
    parser.add_argument("results", metavar="RESULTS", help="file written by rockpulse assess")
    parser.add_argument("--record", metavar="ID", help="one record in detail")
    parser.add_argument("--block", metavar="NAME", help="one block in detail")
    parser.add_argument("--failures", action="store_true", help="what failed or was skipped, and why")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the overview, or the details asked for.

    Parameters
    ----------
    args : argparse.Namespace
        Arguments of the verb.

    Returns
    -------
    int
        Exit code.
    """
    from rockpulse.details import block_details, record_details
    from rockpulse.overview import failure_list, overview
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
