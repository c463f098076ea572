"""The common part of the verbs that work through many records: workers, a log, and the message of a stop."""

from __future__ import annotations

import argparse
import logging
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from rockpulse.commands.terminal import compiling_told, progress_bars, tell
from rockpulse.errors import ConfigError
from rockpulse.foreign_text import escaped

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.errors import Failure
    from rockpulse.run.batch import BatchOptions

__all__ = ["add_batch_arguments", "batch_given", "batch_options", "nothing_written", "recorded", "told"]

LOG_FORMAT = "%(asctime)s %(levelname)s %(message)s"


def add_batch_arguments(parser: argparse.ArgumentParser) -> None:
    """Add who works, and what happens when a run stops half-way."""
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=_workers,
        metavar="N",
        help='processes: a number, or "all" (one a core, none where files are few); default: [run] workers, by default '
        '"all"',
    )
    where.add_argument(
        "--scheduler", metavar="ADDRESS", help="let this dask.distributed cluster work, such as tcp://10.0.0.1:8786"
    )
    parser.add_argument("--resume", action="store_true", help="go on with a run that was stopped, or begin")
    parser.add_argument(
        "--strict",
        action="store_true",
        help="stop at the first file or record that fails, also while the files are read; nothing is written to the "
        "output then, and --resume goes on with what was finished",
    )
    parser.add_argument("--log-file", metavar="FILE", help="add what happens, with its time, to the end of this file")


def batch_given(args: argparse.Namespace) -> list[str]:
    """Names of the options of a batch that were given."""
    names = ("workers", "scheduler", "resume", "strict", "log_file")
    return [f"--{name.replace('_', '-')}" for name in names if getattr(args, name)]


def batch_options(args: argparse.Namespace) -> BatchOptions:
    """The options by which the batch is carried out."""
    from rockpulse.run.batch import BatchOptions

    return BatchOptions(
        workers=args.workers,
        scheduler=args.scheduler,
        resume=args.resume,
        overwrite=args.overwrite,
        strict=args.strict,
        written=() if args.log_file is None else (args.log_file,),
        bar=progress_bars(args.quiet),
        tell=str if args.quiet else _say,
    )


class _Escaping(logging.Formatter):
    """Lines of a log with control characters as escapes."""

    def format(self, record: logging.LogRecord) -> str:
        """The line, or the lines, of a record."""
        return escaped(super().format(record))


class _LogFile(logging.FileHandler):
    """A log that ends where it can no longer be written, for the reason `failed`; the work goes on."""

    failed = ""

    def handleError(self, record: logging.LogRecord) -> None:
        """Remember why a line could not be written, and write no further one."""
        fault = sys.exception()
        if not isinstance(fault, OSError):
            super().handleError(record)
        elif not self.failed:
            self.failed = fault.strerror or str(fault)
            with suppress(OSError):  # what it holds cannot be written
                self.close()
            self.stream = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115


@contextmanager
def recorded(args: argparse.Namespace) -> Iterator[None]:
    """Log to the file that is asked for, and take a polite request to end (SIGTERM) like Ctrl-C, meanwhile.

    Raises ConfigError where the log would go to the end of a file that is no log, OSError where it cannot be written.
    """
    if args.log_file is not None:
        _check_log(Path(args.log_file), Path(args.output))
    logger, begun = logging.getLogger("rockpulse"), False
    before = logger.level
    handler = None if args.log_file is None else _LogFile(args.log_file, encoding="utf-8")
    if handler is not None:
        handler.setFormatter(_Escaping(LOG_FORMAT))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        logger.info("rockpulse %s", " ".join(sys.argv[1:]))
    main = threading.current_thread() is threading.main_thread()  # signals are the main thread's
    old = signal.signal(signal.SIGTERM, _end) if main else None
    try:
        if handler is not None and handler.failed:
            raise ConfigError(f"--log-file {args.log_file}: cannot be written ({handler.failed}); choose another file")
        begun = True
        with compiling_told(args.quiet):
            yield
    finally:
        if main:
            signal.signal(signal.SIGTERM, old)
        if handler is not None:
            logger.removeHandler(handler)
            logger.setLevel(before)
            handler.close()
            if handler.failed and begun:
                _say(f"--log-file {args.log_file}: {handler.failed}: the end of the log is missing")


def nothing_written(failures: Sequence[Failure], what: str, quiet: bool) -> int:
    """Tell why not one record could be used, in a quiet run in one line; the exit code."""
    from rockpulse.errors import alike
    from rockpulse.views.shared.files_used import count_files
    from rockpulse.views.text.left_out import rows_not_used

    listed = "" if quiet else rows_not_used(failures, more_in="")
    told = f"rockpulse: not one record could be {what}, nothing was written"
    # Where nothing failed, records that were too weak are why.
    weak = [row for row in failures if row.kind == "skipped" and row.stage not in ("find", "read")]
    why = count_files((), failures).line or "; ".join(f"{group[0].place}: {group[0].bare}" for group in alike(weak))
    tell("\n".join(filter(None, (listed, f"{told}: {why}" if why else told))), sys.stderr)
    return 1


def told(tree: xr.DataTree, args: argparse.Namespace, overview: Callable[[xr.DataTree], str]) -> int:
    """Print the overview, or with --quiet one line on what failed; the exit code."""
    from rockpulse.views.shared.files_used import files_used

    failed = files_used(tree).line
    if not args.quiet:
        tell(overview(tree))
    elif failed:
        _say(failed)
    return 1 if failed else 0


def _check_log(log: Path, output: Path) -> None:
    if log.absolute() == output.absolute():
        raise ConfigError(f"--log-file {log}: expected another file than the output; choose another name")
    if log.is_fifo():
        _check_read(log)
    if not log.is_file():
        return
    with log.open("rb") as file:
        head = file.read(len("2000-01-01 00:00:00"))
    if head and not re.fullmatch(rb"\d{4}(-\d\d){2} \d\d(:\d\d){2}", head):
        raise ConfigError(
            f"--log-file {log}: expected a new file, or a log to be added to, found something else; choose another name"
        )


def _check_read(pipe: Path) -> None:
    """Whether somebody reads from a pipe; who opens one that nobody reads from waits for ever."""
    try:
        os.close(os.open(pipe, os.O_WRONLY | os.O_NONBLOCK))
    except OSError as error:
        raise ConfigError(f"--log-file {pipe}: nobody reads from this pipe; choose another file") from error


def _say(text: str) -> None:
    tell(f"rockpulse: {text}", sys.stderr)


def _end(number: int, frame: object) -> NoReturn:
    raise KeyboardInterrupt


def _workers(text: str) -> int | str:
    if text == "all":
        return text
    from rockpulse.config.settings import MOST_WORKERS

    value = int(text) if text.isdecimal() and len(text) <= len(str(MOST_WORKERS)) else 0
    if not 1 <= value <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f'expected "all" or an integer from 1 to {MOST_WORKERS}, found {text!r:.40}')
    return value
