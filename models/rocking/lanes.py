"""Arrays with one value per lane (a body, or a body under one scale factor), and threads that compute many lanes."""

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import field, fields
from itertools import pairwise
from typing import Any, Self, TypeVar

import numpy as np

Item = TypeVar("Item")
Found = TypeVar("Found")
#: Number of slices per thread: lanes differ in cost, so a thread that finishes early takes another slice.
SLICES_PER_THREAD = 8
#: The limits in force: a list, because `with` blocks of several threads may overlap and end in any order.
_limits: list[int] = []
_changing = threading.Lock()


#: The default settings of :func:`lane_field`.
OF_LANES = {"fill": np.nan, "axis": -1}


def lane_field(fill: Any = np.nan, axis: int = -1, **options: Any) -> Any:
    """Declare a field of a dataclass with one value per lane; `fill` is the value of lanes without a result."""
    return field(metadata={"fill": fill, "axis": axis}, **options)


class LaneValues:
    """Base class of dataclasses whose fields made by :func:`lane_field` contain one value per lane."""

    @classmethod
    def lane_fields(cls) -> dict[str, tuple[Any, int]]:
        """Return the fill value and the axis of each field made by :func:`lane_field`, by name."""
        declared = {one.name: one.metadata for one in fields(cls)}  # type: ignore[arg-type]
        return {name: (own["fill"], own["axis"]) for name, own in declared.items() if "axis" in own}

    def changed(self, **values: Any) -> Self:
        """Return a copy with new values of some fields, which are not checked."""
        other = object.__new__(type(self))
        vars(other).update(vars(self) | values)
        return other

    def take(self, places: Any) -> Self:
        """Return a copy with the lanes selected by indices, a mask or a slice."""
        found: dict[str, Any] = {}
        for name, (_, axis) in self.lane_fields().items():
            value = getattr(self, name)
            if isinstance(value, LaneValues):
                found[name] = value.take(places)
            elif value is not None:
                values = np.asarray(value)
                index = (..., places, *[slice(None)] * (-1 - axis))
                found[name] = np.ascontiguousarray(values[index])
        return self.changed(**found)

    @classmethod
    def join(cls, parts: Sequence[Self], places: Sequence[np.ndarray], count: int, **fills: Any) -> Self:
        """Return `count` lanes with the values of each part at its indices `places`; other lanes get the fill value."""
        found: dict[str, Any] = {}
        for name, (fill, axis) in cls.lane_fields().items():
            values = [getattr(part, name) for part in parts]
            if any(value is None for value in values):
                found[name] = None
            elif isinstance(values[0], LaneValues):
                found[name] = type(values[0]).join(values, places, count)
            else:
                moved = [np.moveaxis(np.asarray(value), axis, -1) for value in values]
                longest = np.max([value.shape[:-1] for value in moved], axis=0, initial=0).tolist()
                whole = np.full((*longest, count), fills.get(name, fill), dtype=moved[0].dtype)
                for where, value in zip(places, moved, strict=True):
                    own: tuple[Any, ...] = (*map(slice, value.shape[:-1]), where)
                    whole[own] = value
                found[name] = np.ascontiguousarray(np.moveaxis(whole, -1, axis))
        return parts[0].changed(**found)

    def squeezed(self, drop: tuple[bool, bool]) -> Self:
        """Return a copy of a (q, m) result without the axes whose `drop` is True, because the caller gave a scalar."""
        found: dict[str, Any] = {}
        for name, (_, axis) in self.lane_fields().items():
            value = getattr(self, name)
            if isinstance(value, LaneValues):
                found[name] = value.squeezed(drop)
            elif value is not None:
                found[name] = squeezed(value, drop, axis)
        return self.changed(**found)


def squeezed(values: np.ndarray, drop: tuple[bool, bool], axis: int = -1) -> Any:
    """Return a (q, m) result, m along `axis`, without the axes whose `drop` is True; a number if no axis is left."""
    values = values.squeeze(axis=tuple(axis - 1 + place for place, dropped in enumerate(drop) if dropped))
    return values.item() if values.ndim == 0 else values


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def thread_limit(threads: int) -> Iterator[None]:
    """Limit the threads of calls with ``threads=None`` in the whole process; the smallest of several limits applies."""
    threads = _checked(threads, "a whole number of at least 1")
    with _changing:
        _limits.append(threads)
    try:
        yield
    finally:
        with _changing:
            _limits.remove(threads)


def split_lanes(kernel_call: Callable[[int, int], None], lanes: int, threads: int | None, smallest: int = 64) -> None:
    """Run ``kernel_call(first, last)`` in threads on slices of the lanes, each of at least `smallest` lanes."""
    threads = _allowed(threads)
    slices = min(threads * SLICES_PER_THREAD, lanes // smallest)
    if threads == 1 or slices < 2:
        kernel_call(0, lanes)
        return
    edges = [lanes * i // slices for i in range(slices + 1)]
    with ThreadPoolExecutor(threads) as pool:
        for running in [pool.submit(kernel_call, *ends) for ends in pairwise(edges)]:
            running.result()


def spread(call: Callable[[Item, int], Found], items: Sequence[Item], threads: int | None) -> Iterator[Found]:
    """Yield ``call(item, inner)`` for each item in order, computed in threads; each call may use `inner` threads."""
    threads = _allowed(threads)
    if threads == 1 or len(items) < 2:
        yield from (call(item, threads) for item in items)
        return
    inner = max(1, threads // len(items))
    with ThreadPoolExecutor(min(threads, len(items))) as pool:
        yield from pool.map(lambda item: call(item, inner), items)


def _allowed(threads: int | None) -> int:
    """Return the number of threads to use: as given, or all cores within the limits for None."""
    if threads is None:
        threads = min([available_cores(), *_limits])
    return _checked(threads, "a whole number of at least 1, or None for all cores")


def _checked(threads: int, expected: str) -> int:
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise ValueError(f"threads: expected {expected}, got {threads!r}")
    return int(threads)
