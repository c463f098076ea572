"""The grids of a study as a user may give them, checked."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rockpulse.errors import ConfigError

__all__ = ["DURATION_LIMITS", "P_LIMITS", "axis", "even_counts", "scan_values"]

#: Frequency parameters [1/s] and lengths of an input [s] that are computed: of bodies from 1 mm to 70 km, and of hours.
P_LIMITS, DURATION_LIMITS = (0.01, 100.0), (0.01, 10_000.0)

#: Larger numbers of secondary impulses cannot be told from their limit.
_LARGEST_COUNT = 1e6

#: Largest number of intervals in a scan.
_LARGEST_SCAN = 100_000


def axis(
    name: str, values: Sequence[float], low: float | None = None, high: float = math.inf, increasing: bool = False
) -> np.ndarray:
    """The different, finite values of the axis `name`; raises ConfigError for any others.

    Both limits are included; without a lower one the values are positive. `increasing` values have to be in order.
    """
    array = np.array(values, dtype=float).reshape(-1)
    given = ", ".join(f"{value:g}" for value in array) or "none"
    inside = array > 0.0 if low is None else (array >= low) & (array <= high)
    if not (array.size and np.all(np.isfinite(array) & inside)):
        limits = "positive numbers" if low is None else f"numbers from {low:g} to {high:g}"
        raise ConfigError(f"{name}: expected {limits}, got {given}")
    if np.unique(array).size != array.size or (increasing and np.any(np.diff(array) <= 0.0)):
        order = "in increasing order" if increasing else "each once"
        raise ConfigError(f"{name}: expected the values {order}, got {given}")
    return array


def even_counts(values: Sequence[float]) -> np.ndarray:
    """Numbers of secondary impulses in a half-cycle: even, or inf for their limit; raises ConfigError for others."""
    array = np.array(values, dtype=float).reshape(-1)
    finite = array[array != math.inf]
    even = np.all((finite >= 2.0) & (finite <= _LARGEST_COUNT) & (np.fmod(finite, 2.0) == 0.0))
    if not (array.size and even) or np.unique(array).size != array.size:
        raise ConfigError(
            "count: expected different even numbers of secondary impulses from 2 to a million, or inf for their limit, "
            f"got {', '.join(f'{value:g}' for value in array) or 'none'}"
        )
    return array


def scan_values(first: float, last: float, step: float) -> list[float]:
    """Positive values from the first to the last one, both included, at a step.

    Raises ConfigError for any other input, or more than 100 000 values.

    Examples
    --------
    >>> scan_values(0.1, 0.3, 0.1)
    [0.1, 0.2, 0.3]
    """
    for name, value in (("first", first), ("last", last), ("step", step)):
        axis(f"scan: {name}", [value])
    count = math.floor((last - first) / step + 1e-9) + 1
    if not 1 <= count <= _LARGEST_SCAN:
        raise ConfigError(
            f"scan: expected 1 to {_LARGEST_SCAN} values from the first to the last, got {count} from {first:g} to "
            f"{last:g} at a step of {step:g}"
        )
    return [round(first + step * index, 12) for index in range(count)]
