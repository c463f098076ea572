"""``rockpulse formats``: which files are read, and by what they are known."""

from __future__ import annotations

import argparse

from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _run(args: argparse.Namespace) -> int:
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


VERB = Verb(
    name="formats",
    summary="list the file formats",
    description="List the formats that are read, and the units that can be named for those that state none.",
    add_arguments=lambda parser: None,
    run=_run,
)
