"""The workers that carry out a batch, the fate of a file that exists already, and the outcome."""

import os
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from rockpulse.errors import Failure


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a batch; the message says what is kept and how to go on."""


def _no_bar(**_: Any) -> AbstractContextManager[Any]:
    """A progress bar that shows nothing: told by ``update(n)`` that so many more files or records are done."""
    return nullcontext(SimpleNamespace(update=int))


@dataclass(frozen=True)
class BatchOptions:
    """The way in which a batch is carried out; the results depend on none of it.

    Attributes
    ----------
    workers : int or "all", optional
        Processes; "all" for one a core, of which each has at least eight files to read or records to do; 1 for this
        process on one thread. That of the configuration by default.
    scheduler : str, optional
        Address of a dask.distributed scheduler whose workers do the work; they see the files under the same paths.
    executor : concurrent.futures.Executor, optional
        Any other executor, whose processes can import rockpulse.
    resume : bool
        Keep the records that a stopped run has finished, where neither they nor the options have changed.
    overwrite : bool
        Whether results that exist may be replaced; without `resume` also what a stopped run has finished.
    strict : bool
        Stop at the first file or record that fails.
    written : tuple of path
        Files that are written meanwhile beside the output, such as a log: no input, wherever they lie.
    bar : callable
        Called with ``total``, ``initial``, ``desc`` and ``unit``, returns a progress bar; ``tqdm.tqdm`` is one.
    tell : callable
        Called with what the user should know before it is all over, a line at a time.
    """

    workers: int | str | None = None
    scheduler: str | None = None
    executor: Executor | None = None
    resume: bool = False
    overwrite: bool = False
    strict: bool = False
    written: tuple[str | os.PathLike[str], ...] = ()
    bar: Callable[..., AbstractContextManager[Any]] = _no_bar
    tell: Callable[[str], object] = str


@dataclass
class BatchReport:
    """The outcome of a batch.

    Attributes
    ----------
    path : Path or None
        The file that was written; None where not one record gave a result.
    records : int
        Motions in it.
    resumed : int
        Tasks that an earlier run had finished.
    failures : list of Failure
        The rows of /failures.
    broken_off : int
        Files and records among them that were left undone and are tried again by a run that resumes this one.
    seconds : dict of str to float
        Time that all workers together have spent on each step [s]: "read", "condition", "solve", "pack".
    """

    path: Path | None = None
    records: int = 0
    resumed: int = 0
    failures: list[Failure] = field(default_factory=list)
    broken_off: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
