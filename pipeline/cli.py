"""The command line: one module per verb under :mod:`rockpulse.commands`.

Exit codes: 0 all done, 1 some records failed, 2 wrong usage, configuration or results file.
"""

from __future__ import annotations

import argparse
import io
import logging
import sys
from collections.abc import Sequence

from rockpulse import __version__
from rockpulse.commands import VERBS
from rockpulse.commands.telling import forsake, tell
from rockpulse.errors import RockpulseError, StoppedAtFailure

__all__ = ["build_parser", "main"]

FAILED = 1
USAGE = 2
INTERRUPTED = 130


def build_parser() -> argparse.ArgumentParser:
    """The parser with all verbs; building it imports neither numba nor xarray."""
    parser = argparse.ArgumentParser(
        prog="rockpulse",
        description="From recorded strong-motion files to the overturning safety of large slender rigid blocks.",
        epilog="Exit codes: 0 all done, 1 some records failed, 2 wrong usage, configuration or results file.",
    )
    parser.add_argument("--version", action="version", version=f"rockpulse {__version__}")
    subparsers = parser.add_subparsers(title="verbs", required=True, metavar="VERB")
    for verb in VERBS:
        verb.add_to(subparsers)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Parse the arguments and run one verb.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the name of the program; those of the process by default.

    Returns
    -------
    int
        Exit code.
    """
    # Warnings are stored and shown in the overview; Python's last-resort handler would tear the progress bar.
    logging.getLogger("rockpulse").addHandler(logging.NullHandler())
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal may lack the letters of a file or block name
    args = build_parser().parse_args(argv)
    try:
        code = args.run(args)
        sys.stdout.flush()
        return code
    except StoppedAtFailure as error:
        return _ended(str(error), FAILED)
    except RockpulseError as error:
        return _ended(str(error), USAGE)
    except OSError as error:
        if isinstance(error, BrokenPipeError) and _reader_has_left():  # as in `rockpulse ... | head`
            return 0
        where = "" if error.filename is None else f"{error.filename}: "
        return _ended(f"{where}{error.strerror or error}", USAGE)
    except KeyboardInterrupt as error:
        return _ended(str(error) or "interrupted", INTERRUPTED)


def _ended(why: str, code: int) -> int:
    tell(f"rockpulse: {why}", sys.stderr)
    return code


def _reader_has_left() -> bool:
    """Whether it is standard output that nobody reads, and not a pipe of the work itself; what is left is dropped."""
    try:
        print(flush=True)  # what could not be written before may have been dropped already
    except BrokenPipeError:
        forsake(sys.stdout)
        return True
    return False
