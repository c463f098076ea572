"""The options of a batch run, and the report that it returns."""

import logging
import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from rocking.pictures import short_repr
from rockpulse.errors import Failure

logger = logging.getLogger("rockpulse")


class Interrupted(KeyboardInterrupt):
    """Error: a batch was stopped by Ctrl-C; the message states what is kept and how to continue."""


def no_bar(**_: Any) -> AbstractContextManager[Any]:
    """Return a progress bar that shows nothing."""
    return nullcontext(SimpleNamespace(update=int))


@dataclass(frozen=True)
class BatchOptions:
    """Options of a batch; the results do not depend on them.

    Attributes
    ----------
    workers : int or "all", optional
        Number of processes; "all" for one process per core, each with at least eight files or records; 1 for this
        process alone, on one thread. By default the number in the configuration.
    scheduler : str, optional
        Address of a dask.distributed scheduler whose workers find the files under the same paths.
    executor : concurrent.futures.Executor, optional
        Any other executor whose processes can import rockpulse.
    resume : bool
        Keep the finished records of a stopped run if neither the records nor the options have changed.
    overwrite : bool
        Replace existing results and, without `resume`, the finished records of a stopped run.
    append : bool
        Keep the rows of an existing results file of :func:`assess_files`, and process only the other records; the file
        must have the same options, bodies and program, and its records must be among the given files.
    strict : bool
        Stop at the first file or record that fails.
    written : tuple of path
        Other files written during the run, such as a log, which are not read as records.
    bar : callable
        Function of ``total``, ``initial``, ``desc`` and ``unit`` that returns a progress bar, as ``tqdm.tqdm`` does.
    tell : callable
        Function that shows a line of text to the user.

    Examples
    --------
    >>> options = rp.BatchOptions(workers=1, overwrite=True)
    >>> rp.assess_files("records/burst.2.AT2", config, "batch.h5", options).records
    1
    """

    __repr__ = short_repr

    workers: int | str | None = None
    scheduler: str | None = None
    executor: Executor | None = None
    resume: bool = False
    overwrite: bool = False
    append: bool = False
    strict: bool = False
    written: tuple[str | os.PathLike[str], ...] = ()
    bar: Callable[..., AbstractContextManager[Any]] = no_bar
    tell: Callable[[str], object] = str


@dataclass
class BatchReport:
    """The report of a batch.

    Attributes
    ----------
    path : Path or None
        The written file; None if no record gave a result.
    records, resumed : int
        Number of records in the file, and number of tasks finished by an earlier run.
    failures : list of Failure
        The rows of /failures.
    broken_off : int
        Number of failures that a resumed run tries again.
    seconds : dict of str to float
        Total time of the workers for each step [s]: "read", "condition", "solve", "pack".

    Examples
    --------
    >>> report = rp.assess_files("velocity.csv", config, "none.h5")
    >>> report.path, report.records, report.failures[0].kind
    (None, 0, 'failed')
    """

    __repr__ = short_repr

    path: Path | None = None
    records: int = 0
    resumed: int = 0
    failures: list[Failure] = field(default_factory=list)
    broken_off: int = 0
    seconds: dict[str, float] = field(default_factory=dict)


@contextmanager
def quiet_bar(bar: Callable[..., AbstractContextManager[Any]], **about: Any) -> Iterator[Any]:
    """Show a progress bar in a ``with`` block; messages that would interrupt the bar are printed after it."""
    held: list[logging.LogRecord] = []

    def hold(record: logging.LogRecord) -> bool:
        if _is_printed():
            held.append(record)
            return False
        return True

    if bar is not no_bar:
        logger.filters.insert(0, hold)
    try:
        with bar(**about) as shown:
            yield shown
    finally:
        logger.removeFilter(hold)
        for record in held:
            logger.handle(record)


def _is_printed() -> bool:
    """Return whether messages of the logger appear on standard output or standard error."""
    if not logger.hasHandlers():
        return True  # Python's handler of last resort
    place: logging.Logger | None = logger
    while place is not None:
        if any(getattr(handler, "stream", None) in (sys.stdout, sys.stderr) for handler in place.handlers):
            return True
        place = place.parent if place.propagate else None
    return False
