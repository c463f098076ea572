"""``rockpulse formats``: which files are read, and by what they are known."""

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
        "formats",
        help="list the file formats",
        description="List the formats that are read, and the units that can be named for those that state none.",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the table of formats.

    Parameters
    ----------
    args : argparse.Namespace
        Arguments of the verb.

    Returns
    -------
    int
        Exit code.
    """
    from rockpulse.readers import FORMATS, UNITS
    from rockpulse.terminal import ABSENT, aligned, paragraph

    read = [row for row in FORMATS if row.unit != ABSENT]
    rows = [["name", "files", "recognised by", "unit", "processed"]]
    rows += [[row.name, row.what, row.recognised, row.unit, row.processed] for row in read]
    print("\n".join(aligned(rows, left=5)))
    refused = "; ".join(row.what for row in FORMATS if row not in read)
    print("\n" + paragraph(f"Recognised, but not read by this version: {refused}.", "  ", ""))
    print(f"\nEvery file may be compressed with gzip or lie in a zip archive. Units: {', '.join(UNITS)}.")
    return 0
