"""Messages, progress bars, log file, signals and file errors of the commands; the terminal may be closed."""

from __future__ import annotations

import argparse
import errno
import logging
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

from rockpulse.app import CHILD
from rockpulse.errors import ConfigError, Failure, RockpulseError, alike
from rockpulse.foreign_text import escaped

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.run.options import BatchOptions

#: Smallest number of records for which a line is printed in place of a progress bar.
ANNOUNCED = 20


def tell(text: str, file: TextIO | None = None) -> None:
    """Print a text with control characters escaped; print nothing if the pipe is closed, as after ``| head``."""
    file = sys.stdout if file is None else file
    try:
        print(escaped(text), file=file, flush=True)
    except BrokenPipeError:
        discard_output(file)


def warn(text: str) -> None:
    """Print a message after the name of the program on standard error."""
    tell(f"rockpulse: {text}", sys.stderr)


def discard_output(file: TextIO) -> None:
    """Discard all further text written to standard output or standard error."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, file.fileno())
    os.close(nowhere)


def interrupt(number: int, frame: object) -> NoReturn:
    """Raise KeyboardInterrupt, and ignore further signals of this kind, so that the run can end properly."""
    signal.signal(number, lambda number, frame: None)
    raise KeyboardInterrupt


def progress_bars(quiet: bool) -> Callable[..., Any]:
    """Return ``tqdm.tqdm`` for standard error; a terminal and the page of ``rockpulse app`` show it unless `quiet`.

    Elsewhere the number of records, if it is large, is printed on one line before they are processed.
    """
    from tqdm import tqdm

    # On a terminal that reports no size, tqdm would show nothing.
    sized = quiet or not sys.stderr.isatty() or os.get_terminal_size(sys.stderr.fileno()).columns > 0
    bar = partial(
        tqdm,
        disable=True if quiet else False if CHILD in os.environ else None,
        **({} if sized else {"ncols": 80, "nrows": 24}),
    )
    return bar if quiet or CHILD in os.environ or sys.stderr.isatty() else partial(_announced, bar)


def _announced(bar: Callable[..., Any], *planned: Any, **about: Any) -> Any:
    """Print how many records are processed, unless they are few, and return the progress bar."""
    left = (len(planned[0]) if planned else about.get("total", 0)) - about.get("initial", 0)
    if about.get("unit") == " records" and left >= ANNOUNCED:
        warn(f"{about['desc']}: {left} records")
    return bar(*planned, **about)


class _KernelLines(logging.Handler):
    """Log handler that prints messages of the kernel cache; only warnings and errors if there is no terminal."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print the message of a log record."""
        from tqdm import tqdm

        if record.levelno >= logging.WARNING or sys.stderr.isatty() or CHILD in os.environ:
            with tqdm.external_write_mode(file=sys.stderr):
                warn(record.getMessage())


@contextmanager
def kernel_messages(quiet: bool) -> Iterator[None]:
    """Print messages of the kernel cache on standard error in a ``with`` block, unless `quiet`."""
    logger, handler = logging.getLogger("rockpulse.kernels"), _KernelLines()
    if not quiet:
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(logging.NOTSET)


#: For each argument that names a file: the command that makes the file if it is missing.
MISSING = {
    "config": "rockpulse init-config -o {file} writes one to fill in",
    "sequence": "rockpulse calibrate writes one",
    "site": "rockpulse calibrate writes one",
    "fragility": "rockpulse fragility writes one",
    "results": "rockpulse assess writes one",
    "first": "rockpulse assess writes one",
    "second": "rockpulse assess writes one",
}

#: For each number of an operating-system error: advice on what to do.
ADVICE = {
    (errno.ENOSPC, errno.EDQUOT): "; free some space there, or choose another folder",
    (errno.EACCES, errno.EPERM, errno.EROFS): "; check the permissions, or choose another folder",
    (errno.ENAMETOOLONG,): "; choose a shorter name: most file systems take 255 bytes",
    (errno.EAGAIN, errno.EBUSY, errno.ETXTBSY): "; another program has the file open: close it there, or wait",
}

#: Arguments that name a results file to read.
RESULTS = ("results", "first", "second", "fragility", "site", "sequence")
#: Largest number of differences of a results file that a message lists.
SAID = 3
#: Arguments that name a file to write.
WRITTEN = ("output", "log_file")
#: Arguments whose name is omitted in messages, which begin with the file name.
BARE = ("results", "first", "second")


def file_fault(error: OSError, args: argparse.Namespace) -> str:
    """Describe a file error, with the argument that names the file, and suggest a remedy."""
    if not isinstance(error.filename, str | bytes | os.PathLike):
        return str(error.strerror or error)
    shown = os.fsdecode(error.filename)
    path = Path(shown).absolute()
    named = [name for name, value in vars(args).items() if isinstance(value, str) and Path(value).absolute() == path]
    option = named[0] if named else ""
    path_given = getattr(args, option) if option else shown
    if option:
        shown = path_given
        shown = shown if option in BARE else f"--{option.replace('_', '-')} {shown}"
    if error.errno == errno.EISDIR:
        return f"{shown}: expected a file, found a folder"
    if error.errno not in (errno.ENOENT, errno.ENOTDIR):
        advice = next((text for numbers, text in ADVICE.items() if error.errno in numbers), "")
        return f"{shown}: {error.strerror or error}{advice}"
    if not path.parent.is_dir():
        return f"{shown}: there is no folder {path.parent}; check the path, or create it first"
    if option in WRITTEN:
        return f"{shown}: cannot be written ({error.strerror}); choose another folder"
    command = f" ({MISSING[option].format(file=path_given)})" if option in MISSING else ""
    return f"{shown}: no such file; check the path{command}"


def differing_results(args: argparse.Namespace) -> str:
    """Describe how a results file was changed after it was written; empty if it was not changed."""
    from rockpulse.storage.hdf5.verification import verify

    named = [value for name in RESULTS if isinstance(value := getattr(args, name, None), str)]
    for path in named:
        if not Path(path).is_file():
            continue
        try:
            found = verify(path, inputs=False)
        except RockpulseError as error:
            return str(error)
        if found.variables and found.differences:  # without checksums no comparison is possible
            changed = [one for one in found.differences if one.startswith("variable ")] or [*found.differences]
            return (
                f"{path} was changed after it was written ({'; '.join(changed[:SAID])}); 'rockpulse verify {path}' "
                "lists every difference; run the assessment again"
            )
    return ""


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
        tell=str if args.quiet else warn,
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
            warn(f"--log-file {log}: the end of the log is missing ({handler.failed})")


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
    from rockpulse.views.shared.files_used import count_files, rows_not_used

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
        warn(failed)
    return 1 if failed else 0
