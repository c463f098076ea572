"""``rockpulse formats``: list the readable file formats, and how each is recognised."""

import argparse

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import tell

#: Width of the list [characters].
WIDTH = 100
#: Indentation of the second and further lines of a format.
_INDENT = "    "


def _run(args: argparse.Namespace) -> int:
    from textwrap import fill

    from rockpulse.readers import FORMATS, UNITS
    from rockpulse.readers.archive import MEMBER_LIMIT, TOTAL_LIMIT
    from rockpulse.readers.source import FILE_LIMIT, RATIO_LIMIT
    from rockpulse.views.shared.formatting import ABSENT

    def wrapped(words: str, first: str = "", indent: str = "") -> str:
        return fill(words, WIDTH, initial_indent=first, subsequent_indent=indent, break_on_hyphens=False)

    read = [row for row in FORMATS if row.unit != ABSENT]
    refused = [row for row in FORMATS if row.unit == ABSENT]
    for row in read:
        tell(wrapped(f"{row.name} - {row.what}", "", _INDENT))
        tell(wrapped(f"recognised by: {row.recognised}", _INDENT, 2 * _INDENT))
        tell(wrapped(f"unit: {row.unit}; corrected: {row.processed}; such as {row.example}", _INDENT, 2 * _INDENT))
    if refused:
        tell("\nRecognised but not read (the reason is reported):")
        for row in refused:
            tell(wrapped(f"{row.name} - {row.what}, such as {row.example}", "  ", 2 * _INDENT))
    tell("")
    tell(
        wrapped(
            "Every file may be compressed with gzip or stored in a zip archive: files and members up to "
            f"{FILE_LIMIT // 1024**2} MiB, compressed up to {RATIO_LIMIT} times; archives up to {MEMBER_LIMIT} members "
            f"and {TOTAL_LIMIT // 1024**2} MiB, without archives in them."
        )
    )
    tell(
        wrapped(
            "obspy.read reads these formats too, in m/s2 with calib 1. Exceptions are K-NET, miniSEED and SAC, which "
            "obspy reads by itself, in counts. Columns need format='COLUMNS', units='g' and, without times, dt=0.01."
        )
    )
    tell(f"Units: {', '.join(UNITS)}.")
    return 0


VERB = Verb(
    name="formats",
    summary="list the file formats",
    description="List the formats that are read, how they are recognised, their unit, whether their records "
    "are corrected, and the units that can be given for formats that state none.",
    options=(),
    run=_run,
    examples=("rockpulse formats",),
)
