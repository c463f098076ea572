"""Commands on files of records: ``rockpulse formats`` and ``convert``."""

import argparse
import sys

from rockpulse.commands.parser import command
from rockpulse.commands.shared_options import QUIET, READING, reading_options
from rockpulse.commands.terminal import progress_bars, tell, warn

#: Width of the list [characters].
WIDTH = 100
#: Indentation of the second and further lines of a format.
_INDENT = "    "


@command(examples=("rockpulse formats",))
def formats(args: argparse.Namespace) -> int:
    """List the file formats.

    List the formats that are read, how they are recognised, their unit, whether their records are corrected, and
    the units that can be given for formats that state none.
    """
    from textwrap import fill

    from rockpulse.readers import FORMATS, UNITS
    from rockpulse.readers.source import FILE_LIMIT, MEMBER_LIMIT, RATIO_LIMIT, TOTAL_LIMIT
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


#: Largest number of skipped records that are listed.
LISTED = 3


@command(
    {
        "PATHS": ("files, folders, zip archives or patterns of records", {"nargs": "+"}),
        "-o --output OUT !": "file to write (.AT2, .csv, .mseed), or folder for one AT2 or CSV file per channel; "
        "if several channels are written to one AT2 or CSV name, each file is named OUT.CHANNEL.AT2",
        "--format FORMAT": (
            "format of OUT; default: the format of its suffix",
            {"choices": ("at2", "csv", "mseed"), "metavar": None},
        ),
        **READING,
        "--response HOW": (
            "how a StationXML is used to convert counts to m/s2: division by the sensitivity, or removal of the "
            "full response; default: sensitivity",
            {"choices": ("sensitivity", "remove"), "default": "sensitivity", "metavar": None},
        ),
        "--overwrite": "replace existing files, but never a file from which a record was read",
        "--quiet": QUIET,
    },
    examples=("rockpulse convert CICLC.v1 -o clc.AT2", "rockpulse convert records/ -o converted/ --format csv"),
)
def convert(args: argparse.Namespace) -> int:
    """Convert records to AT2, CSV or miniSEED.

    Read records of any supported format and write them in a format that other programs read. Samples are written as
    they were read, in m/s2 or g: nothing is corrected or filtered; only traces with unequal steps are resampled
    when they are read. The warnings of each record, and what the new format cannot store, are printed.
    """
    from rockpulse.readers.conversion import check_output, write
    from rockpulse.readers.folders import read_all
    from rockpulse.record.record import STANDARD_GRAVITY
    from rockpulse.views.shared.files_used import count_files, rows_not_used
    from rockpulse.views.shared.formatting import paragraph

    options = reading_options(args)
    writer = check_output(args.output, args.format)  # rejects unknown formats before files are read
    with progress_bars(args.quiet)(desc="reading", unit=" files") as bar:
        records, failures = read_all(
            args.paths, options.units, on_file=lambda *_: bar.update(), dt=options.dt, response=args.response
        )
    failed = count_files((record.source for record in records), failures).line
    if not args.quiet and failures:
        tell(rows_not_used(failures, more_in="", listed=LISTED), sys.stderr)
    if not records:
        message = "rockpulse: no record could be read; nothing was written"
        tell(f"{message}: {failed}" if failed else message, sys.stderr)
        return 1
    if failed:
        warn(failed)
    files = write(records, args.output, args.format, args.overwrite)
    if not args.quiet:
        known = {record.id: record for record in records}
        for file in files:
            for name, code in file.records:
                record = known[name]
                size = f"{record.npts} samples at {record.dt:g} s, PGA {record.pga / STANDARD_GRAVITY:.4g} g"
                unsaid = record.orientation == "structural" and not writer.structure
                place = f"; recorded on a structure, which {file.path.name} cannot state" if unsaid else ""
                tell(f"{file.path}: {name}{f' as {code}' if code else ''}: {size}{place}")
                for warning in record.warnings:
                    tell(paragraph(warning, "      ", "    warning: "))
        tell("\n" + paragraph(writer.lost + ".", "  ", ""))
    return 1 if failed else 0
