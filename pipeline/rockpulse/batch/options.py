"""The workers that carry out a batch, and the fate of a file that exists already."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Protocol, Self

__all__ = ["Bar", "BatchOptions"]


class Bar(AbstractContextManager["Bar"], Protocol):
    """A progress bar, told of every file and record that is done; a ``tqdm.tqdm`` is one."""

    def update(self, n: int) -> object:
        """So many more are done."""


class _NoBar:
    """Shows nothing."""

    def __init__(self, total: int, initial: int, desc: str, unit: str) -> None:
        pass

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def update(self, n: int) -> object:
        """So many more are done."""
        return None


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
    bar: Callable[..., Bar] = _NoBar
    tell: Callable[[str], object] = str
