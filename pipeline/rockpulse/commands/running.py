"""Functions for all commands that process many records: batch options, log file, signals, and final output."""

from __future__ import annotations

import argparse
import logging
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.commands.terminal import interrupt, progress_bars, tell
from rockpulse.errors import ConfigError, Failure, alike
from rockpulse.foreign_text import escaped

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.run.options import BatchOptions


LOG_FORMAT = "%(asctime)s %(levelname)s %(message)s"


def batch_options(args: argparse.Namespace) -> BatchOptions:
    """Return the batch options given on the command line."""
    from rockpulse.run.options import BatchOptions

    return BatchOptions(
        workers=args.workers,
        scheduler=args.scheduler,
        resume=args.resume,
        overwrite=args.overwrite,
        append=getattr(args, "append", False),
        strict=args.strict,
        written=() if args.log_file is None else (args.log_file,),
        bar=progress_bars(args.quiet),
        tell=str if args.quiet else _say,
    )


class _Escaping(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        """Format a log record as one or several lines."""
        return escaped(super().format(record))


class _LogFile(logging.FileHandler):
    """A log file to which nothing is written after an error; `failed` contains the reason, and the run continues."""

    failed = ""

    def handleError(self, record: logging.LogRecord) -> None:
        """Store the reason why a line could not be written, and write no more lines."""
        fault = sys.exception()
        if not isinstance(fault, OSError):
            super().handleError(record)
        elif not self.failed:
            self.failed = fault.strerror or str(fault)
            with suppress(OSError):  # the buffered lines cannot be written
                self.close()
            self.stream = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115


@contextmanager
def recorded(args: argparse.Namespace) -> Iterator[None]:
    """Write the requested log file and treat SIGTERM like Ctrl-C, in a ``with`` block."""
    with ExitStack() as meanwhile:
        if args.log_file is not None:
            meanwhile.enter_context(_logged(Path(args.log_file), Path(args.output)))
        if threading.current_thread() is threading.main_thread():  # only the main thread can handle signals
            meanwhile.callback(signal.signal, signal.SIGTERM, signal.signal(signal.SIGTERM, interrupt))
        yield


@contextmanager
def _logged(log: Path, output: Path) -> Iterator[None]:
    _check_log(log, output)
    logger, begun = logging.getLogger("rockpulse"), False
    before, handler = logger.level, _LogFile(log, encoding="utf-8")
    handler.setFormatter(_Escaping(LOG_FORMAT))
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        logger.info("rockpulse %s", " ".join(sys.argv[1:]))
        if handler.failed:
            raise ConfigError(f"--log-file {log}: cannot be written ({handler.failed}); choose another file")
        begun = True
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before)
        handler.close()
        if handler.failed and begun:
            _say(f"--log-file {log}: the end of the log is missing ({handler.failed})")


def _check_log(log: Path, output: Path) -> None:
    if log.absolute() == output.absolute():
        raise ConfigError(f"--log-file {log}: expected a file other than the output; choose another name")
    if log.is_fifo():  # opening a pipe without a reader would block
        try:
            os.close(os.open(log, os.O_WRONLY | os.O_NONBLOCK))
        except OSError as error:
            raise ConfigError(f"--log-file {log}: no program reads from this pipe; choose another file") from error
    if not log.is_file():
        return
    with log.open("rb") as file:
        head = file.read(len("2000-01-01 00:00:00"))
    if head and not re.fullmatch(rb"\d{4}(-\d\d){2} \d\d(:\d\d){2}", head):
        raise ConfigError(
            f"--log-file {log}: expected a new file or an existing log, found a file of another kind; choose another "
            "name"
        )


def nothing_written(failures: Sequence[Failure], what: str, quiet: bool) -> int:
    """Print why no record could be used (one line if `quiet`), and return the exit code."""
    from rockpulse.views.shared.files_used import count_files
    from rockpulse.views.text.left_out import rows_not_used

    listed = "" if quiet else rows_not_used(failures, more_in="")
    message = f"rockpulse: no record could be {what}; nothing was written"
    # If nothing failed, the reason is that records were too weak, or no horizontal ground motion.
    unused = [row for row in failures if row.kind not in ("failed", "duplicate") and row.stage not in ("find", "read")]
    why = count_files((), failures).line or "; ".join(f"{group[0].place}: {group[0].bare}" for group in alike(unused))
    tell("\n".join(filter(None, (listed, f"{message}: {why}" if why else message))), sys.stderr)
    return 1


def print_overview(tree: xr.DataTree, args: argparse.Namespace, overview: Callable[[xr.DataTree], str]) -> int:
    """Print the overview of the results or, with --quiet, only a line on failures; return the exit code."""
    from rockpulse.views.shared.files_used import files_used

    failed = files_used(tree).line
    if not args.quiet:
        tell(overview(tree))
    elif failed:
        _say(failed)
    return 1 if failed else 0


def _say(text: str) -> None:
    tell(f"rockpulse: {text}", sys.stderr)
