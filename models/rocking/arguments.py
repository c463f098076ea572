"""Arguments and answers of the models: numbers for one lane, a block under a scale factor, and arrays for several."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A number for one lane, an array of them for several.
Floats: TypeAlias = float | NDArray[np.float64]
Integers: TypeAlias = int | NDArray[np.integer[Any]]
Booleans: TypeAlias = bool | NDArray[np.bool_]


def numbers(name: str, value: ArrayLike, expected: str, lanes: bool = True) -> np.ndarray:
    """The value as a finite number, or a one-dimensional array of them if `lanes` allows it; else a ValueError."""
    shape = "or an array of them" if lanes else "not an array"
    try:
        array = np.asarray(_real(value), dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected {expected}, got {value!r}") from None
    if array.ndim > int(lanes):
        raise ValueError(f"{name}: expected {expected}, {shape}, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: expected {expected}, finite, got {value!r}")
    return array


def positive(name: str, value: ArrayLike, unit: str, lanes: bool = True) -> np.ndarray:
    """As :func:`numbers`, each of them above zero, in `unit`."""
    array = numbers(name, value, f"a positive number in {unit}", lanes)
    if not np.all(array > 0.0):
        raise ValueError(f"{name}: expected a positive, finite number in {unit}, got {value!r}")
    return array


#: A number of main impulses that is no limit.
UNLIMITED = 2**62


def counts(name: str, value: Any, least: int, lanes: bool = True) -> Any:
    """A whole number of at least `least`, or an array (q,) of them if `lanes` allows it; else a ValueError."""
    array = np.asarray(value)
    if array.ndim > int(lanes) or not np.issubdtype(array.dtype, np.integer):
        shape = " or a (q,) array of them" if lanes else ""
        raise ValueError(f"{name}: expected a whole number{shape}, got {value!r}")
    if not np.all((array >= least) & (array < UNLIMITED)):
        raise ValueError(f"{name}: expected at least {least}, got {value!r}")
    return int(array) if array.ndim == 0 else array.astype(np.int64)


def together(**values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Values of one shape: single ones repeated, arrays of one length as they are; a ValueError for several lengths."""
    try:
        return tuple(np.broadcast_arrays(*values.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        raise ValueError(f"{', '.join(values)}: expected single values or arrays of one length, got {shapes}") from None


def record_samples(name: str, values: ArrayLike) -> np.ndarray:
    """Accelerations (n,) at the samples of a record [m/s2], finite, at least two; a ValueError otherwise."""
    try:
        array = np.ascontiguousarray(_real(values), dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected a (n,) array of numbers in m/s2, got {values!r:.80}") from None
    if array.ndim != 1 or array.size < 2:
        raise ValueError(f"{name}: expected a (n,) array of at least 2 samples in m/s2, got shape {array.shape}")
    if not (np.isfinite(np.min(array)) and np.isfinite(np.max(array))):  # NaN is the smallest: no copy is made
        first = int(np.flatnonzero(~np.isfinite(array))[0])
        raise ValueError(f"{name}: sample {first} is {array[first]}; NaN and infinite samples must be mended first")
    return read_only(array)


def _real(values: ArrayLike) -> ArrayLike:
    """The values; a TypeError for complex ones, of which numpy would drop a part, and for values that are masked."""
    if np.ma.is_masked(values) or np.iscomplexobj(values):
        raise TypeError
    return values


def read_only(array: np.ndarray) -> np.ndarray:
    """The array, not to be written to: of one type whoever gives it, so that the kernel is compiled once for all."""
    view = array.view()
    view.flags.writeable = False
    return view
