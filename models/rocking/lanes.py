"""Lanes split over threads: the kernels release the interpreter lock, so plain threads run them side by side."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import pairwise

import numpy as np

__all__ = ["available_cores", "split_lanes", "thread_limit"]

#: Slices per thread: lanes differ in cost, so a thread that is done early takes another one.
SLICES_PER_THREAD = 8

#: The limits in force. A list, not one number: the blocks of several threads overlap and end in any order.
_limits: list[int] = []
_changing = threading.Lock()


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def thread_limit(threads: int) -> Iterator[None]:
    """Let ``threads=None`` mean at most this many threads, everywhere in this process, while the block lasts.

    A process that shares the machine with others of its kind runs its kernels on one thread this way; the answers do
    not depend on it. Of several limits in force, in nested blocks or in blocks of several threads, the smallest holds.

    Examples
    --------
    >>> slices = []
    >>> with thread_limit(1):
    ...     split_lanes(lambda first, last: slices.append((first, last)), 1000, threads=None)
    >>> slices
    [(0, 1000)]
    """
    threads = _checked(threads, "a whole number of at least 1")
    with _changing:
        _limits.append(threads)
    try:
        yield
    finally:
        with _changing:
            _limits.remove(threads)


def split_lanes(kernel_call: Callable[[int, int], None], lanes: int, threads: int | None, smallest: int = 64) -> None:
    """Run a kernel over all lanes, in slices on several threads; None for all that :func:`thread_limit` leaves.

    ``kernel_call(first, last)`` answers lanes first to last - 1, writes to no others and releases the interpreter lock.
    An exception that it raises is passed on. With fewer than two slices of `smallest` lanes everything runs in the
    calling thread.
    """
    if threads is None:
        threads = min([available_cores(), *_limits])
    threads = _checked(threads, "a whole number of at least 1, or None for all cores")
    slices = min(threads * SLICES_PER_THREAD, lanes // smallest)
    if threads == 1 or slices < 2:
        kernel_call(0, lanes)
        return
    edges = [lanes * i // slices for i in range(slices + 1)]
    with ThreadPoolExecutor(threads) as pool:
        for running in [pool.submit(kernel_call, *ends) for ends in pairwise(edges)]:
            running.result()


def _checked(threads: int, expected: str) -> int:
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise ValueError(f"threads: expected {expected}, got {threads!r}")
    return int(threads)
