"""Finds the interval of sample times that are equally spaced but rounded; resamples unequally spaced samples."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rockpulse.errors import RecordFormatError, Remedy
from rockpulse.readers.kit.checks import surplus
from rockpulse.readers.kit.headings import ColumnHeading
from rockpulse.readers.kit.text import (
    FILE_DAMAGED,
    GIVE_INTERVAL,
    UNITS,
    canonical_unit,
    check_count,
    fixed_width,
    unexpected,
)
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.warning_text import WarningText

#: Largest ratio of the number of samples of a resampled record to the number in the file.
GROWTH_LIMIT = 10
#: Largest share of a step that rounding may explain; a missing row changes times by half a step or more.
ROUNDING_SHARE = 0.2
#: Ratio of a step to the median step above which it is a gap, if all other steps are equal.
LONG_STEP = 1.5
#: For a clock with jitter: smallest step, and deviation above which a step is unusual, as shares of the median step;
#: share of unusual steps below which they mean damaged times.
_SHORT_STEP, _ODD_STEP, _FEW_ODD = 0.3, 0.001, 0.02
_SAME_CLOCK = 0.01  # largest relative difference of the mean interval of a clock from the declared one
_SAME_STEP = 1.001  # largest ratio of two stated sampling intervals
#: Largest accepted time [s], which allows for Unix time in ms; larger ones may overflow.
LATEST = 1e13
#: Seconds in each unit that a column of times may have.
_SECONDS = {"ms": 1e-3, "mi": 1e-3, "us": 1e-6, "µs": 1e-6}
_MINUTES = 60.0
_CLIMB = 20  # smallest number of rows, rising in equal steps, that are times and not accelerations
#: Share of decreasing steps below which the first column cannot be an acceleration.
TIME_FALLS = 0.05
PAIRS_PER_ROW = 5
_LONGEST_LINE = 400  # number of characters of a line that are read as a unit
_POINTS = re.compile(r"no\. of points\s*=\s*(\d{1,15})\b", re.IGNORECASE)
_UNIT = re.compile(r"units (?:of uncor (?:accel|data) )?(?:is|are)\s+(?:sec(?:onds)?\s+and\s+)?(\S+)", re.IGNORECASE)


def _half_digit(times: np.ndarray) -> float:
    """Return half a unit of the last decimal of printed times [s]."""
    for decimals in range(9):
        if np.all(np.abs(times - np.round(times, decimals)) < 1e-9 * np.maximum(1.0, np.abs(times))):
            return 0.5 * 10.0**-decimals
    return 0.0


def same_step(steps: Iterable[float]) -> bool:
    """Return whether sampling intervals [s] are equal, apart from the rounding of their digits."""
    known = list(steps)
    return max(known) <= _SAME_STEP * min(known)


def even_step(times: np.ndarray) -> float | None:
    """Return the interval [s] of equally spaced, rounded times (n,); None if the spacing is unequal."""
    if not np.all(np.abs(times) <= LATEST):
        return None
    times = times - times[0]  # differences of large times have fewer digits to compare
    return _fitted_step(times, _half_digit(times))


def _fitted_step(times: np.ndarray, rounding: float) -> float | None:
    """Return the interval of equally spaced times (n,) from 0, rounded by at most `rounding`; None for other times."""
    steps = np.arange(times.size)
    mean = float(times[-1]) / (times.size - 1)
    tolerance = min(rounding, ROUNDING_SHARE * mean) + 0.01 * mean
    rate = 1.0 / mean
    for step in (float(f"{mean:.2g}"), 1.0 / round(rate) if rate >= 1.0 else mean, float(f"{mean:.4g}"), mean):
        if np.max(np.abs(times - step * steps)) <= tolerance:
            return step
    return None


def printed_at(times: np.ndarray, dt: float) -> bool:
    """Return whether the times (n,) are rounded times of samples at the interval `dt` [s]."""
    if not (np.isfinite(dt) and dt > 0.0) or not np.all(np.abs(times) <= LATEST):
        return False
    times = times - times[0]
    spread = float(np.ptp(times - dt * np.arange(times.size)))
    unit = 2.0 * _half_digit(times)
    slack = 1e-6 * dt + 1e-9 * max(1.0, float(np.max(np.abs(times))))
    # A missing row shifts all later times by dt; rounding to multiples of dt or of a finer unit never does.
    return spread <= unit + slack and (dt < unit - slack or spread < 0.999 * dt)


def long_step(times: np.ndarray) -> int | None:
    """Return the index of the first gap in times (n,) that are otherwise equally spaced; None if there is no gap."""
    if not np.all(np.abs(times) <= LATEST):
        return None
    times = times - times[0]
    steps = np.diff(times)
    gaps = steps > LONG_STEP * np.median(steps)
    if not gaps.any():
        return None
    step, rounding = float(np.mean(steps[~gaps])), _half_digit(times)
    # A gap of whole steps passes its rounding on to the rows after it; a gap may also be no whole number of steps.
    left = np.clip(steps - step * np.round(steps / step), -2.0 * rounding, 2.0 * rounding)
    closed = (np.cumsum(np.where(gaps, step + rest, steps)) for rest in (left, 0.0))
    found = any(_fitted_step(np.concatenate([[0.0], series]), rounding) is not None for series in closed)
    return int(np.argmax(gaps)) if found else None


def make_even(
    times: np.ndarray, samples: np.ndarray, name: str, first: int, per_row: int, gravity_per_unit: float
) -> tuple[np.ndarray, float, list[str]]:
    """Return equally spaced samples, interval [s] and warnings from times (n,) and samples (n,) of a digitised trace.

    Unequally spaced samples are interpolated linearly at the median interval; gaps and times that do not increase are
    rejected. Messages use the file `name`, the line `first` of the first pair, `per_row` pairs per line, and
    `gravity_per_unit`, the unit of the samples in g.
    """
    if times.size < 2:
        raise unexpected(f"{name}:{first}", "at least 2 samples", str(times.size), "the file may be truncated")
    beyond = ~(np.abs(times) <= LATEST)
    if beyond.any():
        at = int(np.argmax(beyond))
        found = f"{times[at]:g} s (pair {at + 1})"
        raise unexpected(f"{name}:{first + at // per_row}", f"times in s of at most {LATEST:g} s", found, FILE_DAMAGED)
    steps = np.diff(times)
    if np.any(steps <= 0.0):
        at = int(np.argmax(steps <= 0.0)) + 1
        found = f"{times[at]:g} s after {times[at - 1]:g} s (pair {at + 1})"
        advice = "correct the times, or write each channel into a file of its own"
        raise unexpected(f"{name}:{first + at // per_row}", "increasing times", found, advice)
    even = even_step(times)
    if even is not None:
        return samples, even, []
    dt = float(f"{np.median(steps):.6g}")
    count = (times[-1] - times[0]) / dt
    gap = long_step(times)
    if gap is None and count > GROWTH_LIMIT * times.size:
        gap = int(np.argmax(steps))
    if gap is not None:
        raise RecordFormatError(
            f"{name}:{first + (gap + 1) // per_row}: a step of {steps[gap]:g} s after {times[gap]:g} s among steps of "
            f"{dt:g} s; samples are missing or the times are damaged: repair them"
        )
    grid = times[0] + dt * np.arange(int(count + 1e-6) + 1)
    even_samples = np.interp(grid, times, samples)
    before, after = (float(np.max(np.abs(values))) * gravity_per_unit for values in (samples, even_samples))
    note = (
        f"unequal steps of {steps.min():.4g} to {steps.max():.4g} s, resampled by linear interpolation at their "
        f"median, {dt:g} s; the peak changes from {before:.4g} to {after:.4g} g"
    )
    return even_samples, dt, [note]


@dataclass(frozen=True)
class ChannelSamples:
    """The equally spaced samples of one channel, with their interval, unit and warnings."""

    samples: np.ndarray  # (n,) equally spaced accelerations [unit]
    dt: float  # sampling interval [s]
    unit: str  # a key of `UNITS`
    times: np.ndarray  # (m,) times stated or implied by the file, before any resampling [s]
    values: np.ndarray  # (m,) accelerations at these times [unit]
    warnings: tuple[str, ...] = ()

    @property
    def peak(self) -> float:
        """Return the largest absolute value before resampling [unit]."""
        return float(np.max(np.abs(self.values)))

    @property
    def duration(self) -> float:
        """Return the duration before resampling, including one step after the last value [s]."""
        return float(self.times[-1] - self.times[0]) + self.dt

    def noting(self, *warnings: str) -> "ChannelSamples":
        """Return a copy with `warnings` added."""
        return replace(self, warnings=(*self.warnings, *warnings))


def declared_points(line: str, where: str) -> int:
    """Return the number in a line ``No. of Points = 11999``; raise RecordFormatError if it is missing."""
    match = _POINTS.search(line)
    if not match:
        raise unexpected(where, "'No. of Points = N'", repr(line[:60].strip()))
    return int(match[1])


def pair_unit(line: str, where: str) -> str:
    """Return the key of `UNITS` for a line ``Units are sec and g/10``; raise UnitError if it is missing or unknown."""
    match = _UNIT.search(line)
    return canonical_unit((match[1] if match else line.strip())[:_LONGEST_LINE], where)


def pair_block(name: str, lines: Sequence[str], first: int, end: int, count: int, unit: str) -> ChannelSamples:
    """Read `count` pairs of time and acceleration of one channel and make them equally spaced."""
    check_count(f"{name}:{end}", count, PAIRS_PER_ROW * max(end - first, 0), "pairs")
    rows = -(-count // PAIRS_PER_ROW)
    block = lines[first : first + rows]
    fields = 2 * min(PAIRS_PER_ROW, count)
    width, rest = divmod(len(block[0].rstrip()), fields)
    margin = 0
    if rest == 1 and all(row.startswith(" ") for row in block):
        # Every row begins with a control character for a line printer.
        block, margin = [row[1:] for row in block], 1
    pairs = fixed_width(block, first + 1, width or 1, 2 * PAIRS_PER_ROW, 2 * count, name).reshape(-1, 2)
    gravity = UNITS[unit] / STANDARD_GRAVITY
    samples, dt, notes = make_even(pairs[:, 0], pairs[:, 1], name, first + 1, PAIRS_PER_ROW, gravity)
    used = margin + 2 * width * (count - (rows - 1) * PAIRS_PER_ROW)
    left = surplus(lines, first + rows, end, used=used)
    return ChannelSamples(samples, dt, unit, pairs[:, 0], pairs[:, 1], (*left, *notes))


def names_time(headings: Sequence[ColumnHeading]) -> bool:
    """Return whether the heading of the first column means time."""
    return bool(headings and headings[0].kind == "time")


def counts_rows(table: np.ndarray, headings: Sequence[ColumnHeading]) -> bool:
    """Return whether the first column contains row numbers (0 1 2 or 1 2 3) and its heading does not mean time."""
    first = table[:, 0]
    counts = first[0] in (0.0, 1.0) and np.array_equal(first - first[0], range(len(first)))
    return bool(counts and not names_time(headings))


def jitters(times: np.ndarray) -> bool:
    """Return whether rising times (n,) come from a clock with jitter or drift, and no row is missing or damaged.

    True if every step is shorter than at a missing row and longer than at an additional row, and many steps differ
    from the median.
    """
    steps = np.diff(times)
    usual = float(np.median(steps))
    if not np.all(np.abs(times) <= LATEST) or steps.size < _CLIMB or not (steps > _SHORT_STEP * usual).all():
        return False
    odd = np.abs(steps - usual) > max(_ODD_STEP * usual, 1.01 * 2.0 * _half_digit(times - times[0]))
    few = 0 < int(odd.sum()) < max(_FEW_ODD * steps.size, 3)
    return bool(np.all(steps < LONG_STEP * usual)) and not few


def at_even_times(times: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, WarningText]:
    """Return the columns interpolated by splines to equal time steps, and a warning about the interpolation."""
    from scipy.interpolate import CubicSpline

    step = float(times[-1] - times[0]) / (times.size - 1)
    even = times[0] + step * np.arange(times.size)
    uneven = float(np.max(np.abs(times - even))) / step
    return CubicSpline(times, table)(even), WarningText("resampled_clock", interval=step, uneven=uneven)


def time_column_step(
    name: str, table: np.ndarray, headings: Sequence[ColumnHeading], start: int, declared: float | None
) -> tuple[float | None, np.ndarray | None]:
    """Return the interval [s] if the first column contains times (else None), and the times if a clock ran unevenly.

    A column contains times if its heading names time, or if it hardly ever decreases. The second value is None, except
    for a clock with jitter or drift: then it contains the times [s], and the interval is their mean.
    """
    named = names_time(headings)
    unit = headings[0].unit.lower() if headings else ""
    if named and any(letter.isdigit() for letter in unit):
        found = f"{headings[0].name!r} in {unit!r}"
        raise unexpected(name, "a column of times in s, ms or min", found, "write the times in s")
    first = table[:, 0] * (_MINUTES if unit.startswith("min") else _SECONDS.get(unit[:2], 1.0))
    steps = np.diff(first)
    falls, changes = int(np.sum(steps < 0.0)), int(np.sum(steps != 0.0))
    if table.shape[1] < 2 or steps.size == 0 or not (named or (changes and falls < TIME_FALLS * changes)):
        return None, None
    other = next((index + 1 for index in range(1, table.shape[1]) if climbs(table[:, index])), None)
    if other:
        expected = "one column of times and accelerations beside it"
        found = f"that columns 1 and {other} both increase like times"
        raise unexpected(f"{name}:{start + 1}", expected, found, "remove the one that does not contain times")
    rising = bool(np.all(steps > 0.0))
    step = even_step(first) if rising else None
    if step is not None:
        return step, None
    if not falls and declared is not None and printed_at(first, declared):
        return declared, None
    if rising and jitters(first):
        mean = float(first[-1] - first[0]) / (first.size - 1)
        return declared if declared and abs(declared / mean - 1.0) < _SAME_CLOCK else mean, first
    column = f"column {headings[0].name!r}" if named else "first column, which increases like times"
    if falls or (declared is None and not rising):
        at, advice, remedies = int(np.argmin(steps)), "repair the times", []
        if not falls:
            remedies = [GIVE_INTERVAL]
            advice += ", or give the interval (option dt) if they are rounded to steps longer than the interval"
        found = f"{first[at + 1]:g} after {first[at]:g}"
        raise unexpected(f"{name}:{start + at + 2}", f"increasing times in the {column}", found, advice, *remedies)
    at = int(np.argmax(np.abs(steps - np.median(steps))))
    expected = f"equally spaced times in the {column}"
    advice = "rows are missing or the times are damaged: fill the gap or resample the record"
    if declared is not None:
        expected += f", at the declared interval of {declared:g} s"
    remedies = [] if declared else [GIVE_INTERVAL]
    if remedies:
        advice += ", or give the interval (option dt) if the times are rounded"
    found = f"a step of {steps[at]:g} s among steps of {np.median(steps):g} s"
    raise unexpected(f"{name}:{start + at + 2}", expected, found, advice, *remedies)


def climbs(column: np.ndarray) -> bool:
    """Return whether a column rises in equal steps, as times do."""
    return bool(column.size >= _CLIMB and np.all(np.diff(column) > 0.0)) and even_step(column) is not None


def agreed_step(name: str, steps: dict[str, float | None], advice: str, given: str = "") -> float:
    """Return the interval [s] on which all sources agree, or raise an error; `given` is the source set by the user."""
    known = {source: step for source, step in steps.items() if step is not None}
    if not known:
        raise RecordFormatError(
            f"{name}: expected a time column, a first line with the number of samples and the interval, or the option "
            f"dt for the sampling interval, found none; {GIVE_INTERVAL.advice(name)}",
            GIVE_INTERVAL,
        )
    for source, step in known.items():
        if not (np.isfinite(step) and step > 0.0):
            raise RecordFormatError(f"{name}: expected a positive sampling interval in s, found {step!r} ({source})")
    if not same_step(known.values()):
        listed = ", ".join(f"{step:g} s ({source})" for source, step in known.items())
        stated = tuple(dict.fromkeys(f"{step:.9g}" for source, step in known.items() if source != given))
        remedies = [Remedy("dt", stated)] if given in known else []
        raise RecordFormatError(f"{name}: the sampling intervals disagree: {listed}; {advice}", *remedies)
    return next(iter(known.values()))
