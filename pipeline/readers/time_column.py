"""The sampling interval of plain columns: from the first column, a heading, or the caller, and all of one mind."""

from __future__ import annotations

import re

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.spacing import even_step, printed_at
from rockpulse.readers.table_layout import Layout

__all__ = ["agreed_step", "counts_rows", "names_time", "time_column_step"]

_TIME_NAME = re.compile(r"(?:t|time|zeit|temps|tempo|sec|seconds)\b", re.IGNORECASE)
_MILLISECONDS = re.compile(r"(?<![a-z])m(?:illi)?s(?:ec\w*)?(?![a-z])", re.IGNORECASE)
#: Rows that no acceleration climbs without a fall, at equal steps.
_CLIMB = 20
#: A first column whose values fall at a smaller share of its changes than this can be no acceleration.
TIME_FALLS = 0.05


def names_time(layout: Layout) -> bool:
    """Whether the first column is headed as time."""
    return bool(layout.names and _TIME_NAME.match(layout.names[0]))


def counts_rows(table: np.ndarray, layout: Layout) -> bool:
    """Whether the first column numbers the rows, 0 1 2 or 1 2 3, and is not headed as time."""
    first = table[:, 0]
    return bool(
        not names_time(layout) and first[0] in (0.0, 1.0) and np.array_equal(first - first[0], range(len(first)))
    )


def time_column_step(name: str, table: np.ndarray, layout: Layout, start: int, declared: float | None) -> float | None:
    """Interval of the time column [s], or None where the first column is no time.

    It is time if its heading says so or if it hardly ever falls, which no acceleration does; then it has to be equally
    spaced, or to be what rounding makes of the interval `declared` elsewhere.
    """
    first = table[:, 0] * (1e-3 if layout.names and _MILLISECONDS.search(layout.names[0]) else 1.0)
    steps = np.diff(first)
    falls, changes = int(np.sum(steps < 0.0)), int(np.sum(steps != 0.0))
    named = names_time(layout)
    if layout.width < 2 or steps.size == 0 or not (named or (changes and falls < TIME_FALLS * changes)):
        return None
    climbs = [index for index in range(1, layout.width) if _climbs(table[:, index])]
    if climbs:
        raise RecordFormatError(
            f"{name}:{start + 1}: expected one column of times and accelerations beside it, found that columns 1 and "
            f"{climbs[0] + 1} both run like time; take out the one that is none"
        )
    rising = bool(np.all(steps > 0.0))
    step = even_step(first) if rising else None
    if step is not None:
        return step
    if not falls and declared is not None and printed_at(first, declared):
        return declared
    column = f"column {layout.names[0]!r}" if named else "first column, which runs like time"
    if falls or (declared is None and not rising):
        at = int(np.argmin(steps))
        raise RecordFormatError(
            f"{name}:{start + at + 2}: expected increasing times in the {column}, found {first[at + 1]:g} after "
            f"{first[at]:g}; repair the times"
            + ("" if falls else ", or give the interval (option dt) if they are rounded more coarsely than it")
        )
    at = int(np.argmax(np.abs(steps - np.median(steps))))
    interval = "" if declared is None else f", at the declared interval of {declared:g} s"
    raise RecordFormatError(
        f"{name}:{start + at + 2}: expected equally spaced times in the {column}{interval}, found a step of "
        f"{steps[at]:g} s among steps of {np.median(steps):g} s; rows are missing or the times are damaged: fill the "
        "gap or resample the record"
        + ("" if declared else ", or give the interval (option dt) if the times are rounded")
    )


def _climbs(column: np.ndarray) -> bool:
    return bool(column.size >= _CLIMB and np.all(np.diff(column) > 0.0)) and even_step(column) is not None


def agreed_step(name: str, steps: dict[str, float | None]) -> float:
    """The one interval [s] that the sources, by name, give; refused where there is none or they differ."""
    known = {source: step for source, step in steps.items() if step is not None}
    if not known:
        raise RecordFormatError(
            f"{name}: expected a time column, a first line 'N dt', or the option dt for the sampling interval, found "
            "none; give it: --dt 0.01 on the command line, dt = 0.01 under [records] of the configuration, or "
            "read(path, units='g', dt=0.01)"
        )
    for source, step in known.items():
        if not (np.isfinite(step) and step > 0.0):
            raise RecordFormatError(f"{name}: expected a positive sampling interval in s, found {step!r} ({source})")
    if max(known.values()) > 1.001 * min(known.values()):
        listed = ", ".join(f"{step:g} s ({source})" for source, step in known.items())
        raise RecordFormatError(f"{name}: the sampling intervals disagree: {listed}; correct the wrong one")
    return next(iter(known.values()))
