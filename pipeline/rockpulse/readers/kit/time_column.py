"""The sampling interval of plain columns: first column, heading and caller must agree on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rockpulse.errors import RecordFormatError
from rockpulse.readers.format import ReadOptions, same_step
from rockpulse.readers.kit.headings import Heading
from rockpulse.readers.kit.spacing import even_step, printed_at
from rockpulse.readers.kit.text import unexpected

#: Seconds in the units that may head a column of times.
_SECONDS = {"ms": 1e-3, "mi": 1e-3, "us": 1e-6, "µs": 1e-6}
_MINUTES = 60.0
#: Rows that no acceleration climbs without a fall, at equal steps.
_CLIMB = 20
#: A first column whose values fall at a smaller share of its changes than this can be no acceleration.
TIME_FALLS = 0.05


def names_time(headings: Sequence[Heading]) -> bool:
    """Whether the first column is headed as time."""
    return bool(headings and headings[0].kind == "time")


def counts_rows(table: np.ndarray, headings: Sequence[Heading]) -> bool:
    """Whether the first column numbers the rows, 0 1 2 or 1 2 3, and is not headed as time."""
    first = table[:, 0]
    return bool(
        not names_time(headings) and first[0] in (0.0, 1.0) and np.array_equal(first - first[0], range(len(first)))
    )


def _seconds(name: str, headings: Sequence[Heading]) -> float:
    """Factor from the unit that the heading states to s."""
    unit = headings[0].unit.lower() if headings else ""
    if any(letter.isdigit() for letter in unit) and names_time(headings):
        raise unexpected(
            name, "a column of times in s, ms or min", f"{headings[0].name!r} in {unit!r}", "write the times in s"
        )
    return _MINUTES if unit.startswith("min") else _SECONDS.get(unit[:2], 1.0)


def time_column_step(
    name: str, table: np.ndarray, headings: Sequence[Heading], start: int, declared: float | None
) -> float | None:
    """Interval of the time column [s], or None where the first column is no time.

    It is time if its heading says so or if it hardly ever falls, which no acceleration does; then it has to be equally
    spaced, or to be what rounding makes of the interval `declared` elsewhere.
    """
    named = names_time(headings)
    first = table[:, 0] * _seconds(name, headings)
    steps = np.diff(first)
    falls, changes = int(np.sum(steps < 0.0)), int(np.sum(steps != 0.0))
    if table.shape[1] < 2 or steps.size == 0 or not (named or (changes and falls < TIME_FALLS * changes)):
        return None
    others = [index for index in range(1, table.shape[1]) if climbs(table[:, index])]
    if others:
        expected = "one column of times and accelerations beside it"
        found = f"that columns 1 and {others[0] + 1} both run like time"
        raise unexpected(f"{name}:{start + 1}", expected, found, "take out the one that is none")
    rising = bool(np.all(steps > 0.0))
    step = even_step(first) if rising else None
    if step is not None:
        return step
    if not falls and declared is not None and printed_at(first, declared):
        return declared
    column = f"column {headings[0].name!r}" if named else "first column, which runs like time"
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


def climbs(column: np.ndarray) -> bool:
    """Whether a column runs like time, at equal steps."""
    return bool(column.size >= _CLIMB and np.all(np.diff(column) > 0.0)) and even_step(column) is not None


def agreed_step(name: str, steps: dict[str, float | None], options: ReadOptions) -> float:
    """The one interval [s] that all sources, by name, and the caller give; refused where none does or they differ."""
    asked = options.said_by("dt").removeprefix("the ")
    steps = {**steps, asked: options.dt}
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
    if not same_step(known.values()):
        listed = ", ".join(f"{step:g} s ({source})" for source, step in known.items())
        advice = options.advice("dt") if asked in known else "correct the wrong one"
        raise RecordFormatError(f"{name}: the sampling intervals disagree: {listed}; {advice}")
    return next(iter(known.values()))
