"""Lanes split over threads: the kernels release the interpreter lock, so plain threads run them side by side."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

__all__ = ["available_cores", "split_lanes"]

#: Slices per thread: lanes differ in cost, so a thread that is done early takes another one.
SLICES_PER_THREAD = 8


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def split_lanes(kernel_call: Callable[[int, int], None], lanes: int, threads: int | None, smallest: int = 64) -> None:
    """Run a kernel over all lanes, in slices on several threads.

    Parameters
    ----------
    kernel_call : callable
        ``kernel_call(first, last)`` answers lanes first to last - 1; it writes to those lanes only and releases the
        interpreter lock.
    lanes : int
        Number of lanes.
    threads : int or None
        Number of threads; None for one per available core.
    smallest : int
        Fewest lanes in a slice; with fewer than two slices of work everything runs in the calling thread.

    Raises
    ------
    ValueError
        For a number of threads below one. What `kernel_call` raises is passed on.
    """
    if threads is None:
        threads = available_cores()
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise ValueError(f"threads: expected a whole number of at least 1, or None for all cores, got {threads!r}")
    slices = min(threads * SLICES_PER_THREAD, lanes // smallest)
    if threads == 1 or slices < 2:
        kernel_call(0, lanes)
        return
    edges = [lanes * i // slices for i in range(slices + 1)]
    with ThreadPoolExecutor(threads) as pool:
        for running in [pool.submit(kernel_call, edges[i], edges[i + 1]) for i in range(slices)]:
            running.result()
