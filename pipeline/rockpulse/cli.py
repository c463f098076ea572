"""The command line; each command has its own module in :mod:`rockpulse.commands`."""

import argparse
import gc
import io
import logging
import os
import signal
import sys
import traceback
from collections.abc import Sequence

from rockpulse.app import CHILD
from rockpulse.commands import VERBS
from rockpulse.commands.parser import Parser
from rockpulse.commands.terminal import (
    WRITTEN,
    differing_results,
    discard_output,
    file_fault,
    interrupt,
    kernel_messages,
    warn,
)
from rockpulse.errors import ConfigError, RockpulseError, StoppedAtFailure
from rockpulse.version import __version__

#: Number of new objects after which Python searches for unused ones; Python's default slows the imports by 0.2 s.
NEW_OBJECTS = 100_000
FAILED = 1
USAGE = 2
INTERRUPTED = 130

EPILOG = """\
first steps, for a wall 0.3 m wide and 2.4 m high:
  rockpulse assess records/ --block wall=0.3x2.4 -o results.h5
  rockpulse inspect results.h5
  rockpulse report results.h5 -o report.html
bodies and options in a file, for --config site.toml:
  rockpulse init-config -o site.toml
options of a command, with examples:
  rockpulse COMMAND --help

Exit codes: 0 success; 1 some records failed, or diff, verify or selftest found a
difference; 2 wrong usage, configuration or results file; 130 interrupted."""


def build_parser(words: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser with all commands; if `words` are given, only the commands among them get their options."""
    parser: argparse.ArgumentParser = Parser(
        prog="rockpulse",
        description="From recorded strong-motion files to the overturning safety of large slender rigid blocks.",
        epilog=EPILOG,
    )
    parser.add_argument("--version", action="version", version=f"rockpulse {__version__}")
    parser.set_defaults(program=parser)  # used by the command `completion`
    subparsers = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for verb in VERBS:
        verb.add_to(subparsers, not words or verb.name in words or "completion" in words)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Parse the arguments (by default ``sys.argv``), run one command, and return the exit code."""
    if argv is None:
        gc.set_threshold(NEW_OBJECTS)
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, interrupt)
        if CHILD in os.environ:
            from rockpulse.app.child import follow_parent

            follow_parent()
    try:
        return _run(argv)
    except KeyboardInterrupt as error:
        if argv is None:  # a second Ctrl-C, while Python shuts down, must not change the exit code
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        return _ended(str(error) or "interrupted", INTERRUPTED)


def _run(argv: Sequence[str] | None) -> int:
    # Warnings are stored and shown in the overview; Python's last-resort handler would break the progress bar.
    logging.getLogger("rockpulse").addHandler(logging.NullHandler())
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed, as by `>&-`: the results file could get its descriptor
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal may not support the characters of a file or block name
    given = sys.argv[1:] if argv is None else argv
    parser = build_parser(given or ["--help"])
    if not given:
        parser.exit(USAGE, parser.format_help())
    args = argparse.Namespace()
    try:
        parser.parse_args(given, args)
        for name in WRITTEN:
            if getattr(args, name, None) == "":
                option = f"--{name.replace('_', '-')}"
                raise ConfigError(f"{option}: expected the name of a file, found nothing; is a shell variable unset?")
        with kernel_messages(getattr(args, "quiet", False)):
            code = args.run(args)
        sys.stdout.flush()
        return code
    except StoppedAtFailure as error:
        return _ended(str(error), FAILED)
    except RockpulseError as error:
        return _ended(str(error), USAGE)
    except OSError as error:
        if isinstance(error, BrokenPipeError) and _output_closed():  # for example by `rockpulse ... | head`
            return 0
        return _ended(file_fault(error, args), USAGE)
    except Exception as error:
        if not (differing := differing_results(args)):
            raise
        logging.getLogger("rockpulse").exception("internal error of %s", args.run.__module__)
        last_line = "".join(traceback.format_exception_only(error)).strip().splitlines()[-1]
        return _ended(f"internal error: {last_line}; it may be caused by a changed file: {differing}", USAGE)


def _ended(why: str, code: int) -> int:
    warn(why)
    return code


def _output_closed() -> bool:
    """Return whether the reader of standard output has closed it; if so, discard all further output."""
    try:
        print(flush=True)  # writes a line, as an empty buffer would cause no error
    except BrokenPipeError:
        discard_output(sys.stdout)
        return True
    return False
