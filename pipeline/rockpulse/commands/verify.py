"""``rockpulse verify``: check that a results file and its input records are unchanged."""

import argparse

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import progress_bars, tell

#: Largest number of missing input files in a message.
LISTED = 5


def _run(args: argparse.Namespace) -> int:
    from rockpulse.storage.hdf5.verification import verify

    bars = progress_bars(args.quiet)
    found = verify(args.results, args.inputs, lambda items: bars(items, desc="verifying", leave=False))
    for difference in found.differences:
        tell(f"{args.results}: {difference}")
    if not args.quiet:
        count = len(found.differences)
        verdict = f"{count} difference{'s' * (count != 1)}" if count else "unchanged"
        tell(f"{args.results}: {found.kind}, schema {found.schema}, {found.variables} variables: {verdict}")
        if args.inputs:
            tell(f"input files checked: {found.inputs}, missing: {len(found.absent)}")
            for name in found.absent[:LISTED]:
                tell(f"  {name}")
            if len(found.absent) > LISTED:
                tell(f"  and {len(found.absent) - LISTED} more")
    return 1 if found.differences else 0


VERB = Verb(
    name="verify",
    summary="check that a results file and its inputs are unchanged",
    description="Compare every variable and all attributes of a results file with the checksums stored when it was "
    "written, the file with its schema, and the record files with the SHA-256 of what was read. Exit code 0: "
    "unchanged, 1: something differs, 2: not a results file, or one that cannot be opened.",
    options=(
        {
            "RESULTS": "results file of any kind",
            "--inputs": (
                "also compare the record files with their checksums, if they still exist; default: yes",
                {"action": argparse.BooleanOptionalAction, "default": True},
            ),
            "--quiet": "print only what differs",
        },
    ),
    run=_run,
    examples=("rockpulse verify results.h5",),
)
