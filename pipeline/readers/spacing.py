"""Equal spacing of sample times: recognised through the rounding of printed times, or made by interpolation."""

from __future__ import annotations

import numpy as np

from rockpulse.errors import RecordFormatError

__all__ = ["even_step", "make_even"]

#: A resampled record may have at most this many times the samples of the file.
GROWTH_LIMIT = 10


def _half_digit(times: np.ndarray) -> float:
    """Half a unit of the last decimal that the times use [s]."""
    for decimals in range(9):
        if np.all(np.abs(times - np.round(times, decimals)) < 1e-9 * np.maximum(1.0, np.abs(times))):
            return 0.5 * 10.0**-decimals
    return 0.0


def even_step(times: np.ndarray) -> float | None:
    """Sampling interval of equally spaced times.

    Parameters
    ----------
    times : (n,) ndarray
        Strictly increasing times [s], n >= 2, rounded as printed.

    Returns
    -------
    float or None
        The interval [s]; a round interval or rate is preferred where the printed digits allow it. None if a time is
        off the grid by more than its rounding and 1 % of the interval.
    """
    steps = np.arange(times.size)
    mean = float(times[-1] - times[0]) / (times.size - 1)
    tolerance = _half_digit(times) + 0.01 * mean
    rate = 1.0 / mean
    for step in (float(f"{mean:.2g}"), 1.0 / round(rate) if rate >= 1.0 else mean, float(f"{mean:.4g}"), mean):
        if np.max(np.abs(times - times[0] - step * steps)) <= tolerance:
            return step
    return None


def make_even(
    times: np.ndarray, samples: np.ndarray, where: str, gravity_per_unit: float
) -> tuple[np.ndarray, float, list[str]]:
    """Equally spaced samples from (time, acceleration) pairs of a digitised trace.

    Parameters
    ----------
    times : (n,) ndarray
        Times [s].
    samples : (n,) ndarray
        Accelerations [file unit]; linear in between.
    where : str
        ``file:line`` of the first pair, for messages.
    gravity_per_unit : float
        g per file unit, for the warning.

    Returns
    -------
    samples : (k,) ndarray
        The samples themselves if they are equally spaced, else interpolated linearly at the median interval.
    dt : float
        Sampling interval [s].
    warnings : list of str
        What was done.

    Raises
    ------
    RecordFormatError
        Times that do not increase, or a jump that would need far more samples than there are.
    """
    if times.size < 2:
        raise RecordFormatError(f"{where}: expected at least 2 samples, found {times.size}; the file may be truncated")
    steps = np.diff(times)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        at = int(back[0])
        raise RecordFormatError(
            f"{where}: expected increasing times, found {times[at + 1]:g} s after {times[at]:g} s (pair {at + 2}); "
            "the file is damaged or holds more than one channel: download it again"
        )
    even = even_step(times)
    if even is not None:
        return samples, even, []
    dt = float(f"{np.median(steps):.6g}")
    count = (times[-1] - times[0]) / dt
    if count > GROWTH_LIMIT * times.size:
        at = int(np.argmax(steps))
        raise RecordFormatError(
            f"{where}: a step of {steps[at]:g} s after {times[at]:g} s among steps of {dt:g} s; "
            "the times are damaged: repair them or download the file again"
        )
    grid = times[0] + dt * np.arange(int(count + 1e-6) + 1)
    even_samples = np.interp(grid, times, samples)
    before, after = (float(np.max(np.abs(values))) * gravity_per_unit for values in (samples, even_samples))
    return (
        even_samples,
        dt,
        [
            f"unequal steps of {steps.min():.4g} to {steps.max():.4g} s, resampled by linear interpolation at their "
            f"median, {dt:g} s; the peak goes from {before:.4g} to {after:.4g} g"
        ],
    )
