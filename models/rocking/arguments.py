"""Checks of the arguments of the models, and the types of their results."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A number for one block under one scale factor, or an array for several blocks or factors.
Floats: TypeAlias = float | NDArray[np.float64]
Integers: TypeAlias = int | NDArray[np.integer[Any]]
Booleans: TypeAlias = bool | NDArray[np.bool_]


def numbers(
    name: str, value: ArrayLike, expected: str, lanes: bool = True, within: tuple[float, float] | None = None
) -> np.ndarray:
    """Return finite numbers `within` limits; raise ValueError for other values, and for arrays if `lanes` is False."""
    shape = "or an array of them" if lanes else "not an array"
    try:
        array = np.asarray(_real(value), dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected {expected}, got {value!r}") from None
    if array.ndim > int(lanes):
        raise ValueError(f"{name}: expected {expected}, {shape}, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: expected {expected}, finite, got {value!r}")
    if within and not np.all((array >= within[0]) & (array <= within[1])):
        raise ValueError(f"{name}: expected {expected}, got {value!r}")
    return array


def positive(name: str, value: ArrayLike, unit: str, lanes: bool = True) -> np.ndarray:
    """Return positive, finite numbers in `unit` as an array; raise ValueError for other values, see :func:`numbers`."""
    array = numbers(name, value, f"a positive number in {unit}", lanes)
    if not np.all(array > 0.0):
        raise ValueError(f"{name}: expected a positive, finite number in {unit}, got {value!r}")
    return array


#: Value of the number of main impulses for "no limit".
UNLIMITED = 2**62


def counts(name: str, value: Any, least: int, lanes: bool = True) -> Any:
    """Return one whole number, or an array of them if `lanes` is True; raise ValueError if one is below `least`."""
    array = np.asarray(value)
    if array.ndim > int(lanes) or not np.issubdtype(array.dtype, np.integer):
        shape = " or a (q,) array of them" if lanes else ""
        raise ValueError(f"{name}: expected a whole number{shape}, got {value!r}")
    if not np.all((array >= least) & (array < UNLIMITED)):
        raise ValueError(f"{name}: expected at least {least}, got {value!r}")
    return int(array) if array.ndim == 0 else array.astype(np.int64)


def common_shape(**values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return arrays of equal length, in which single values are repeated; raise ValueError for different lengths."""
    try:
        return tuple(np.broadcast_arrays(*values.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        raise ValueError(f"{', '.join(values)}: expected single values or arrays of one length, got {shapes}") from None


def record_samples(name: str, values: ArrayLike) -> np.ndarray:
    """Return the accelerations (n,) of a record [m/s2]; raise ValueError unless there are two or more, all finite."""
    try:
        array = np.ascontiguousarray(_real(values), dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected an (n,) array of numbers in m/s2, got {values!r:.80}") from None
    if array.ndim != 1 or array.size < 2:
        raise ValueError(f"{name}: expected an (n,) array of at least 2 samples in m/s2, got shape {array.shape}")
    if not (np.isfinite(np.min(array)) and np.isfinite(np.max(array))):  # NaN propagates
        first = int(np.flatnonzero(~np.isfinite(array))[0])
        raise ValueError(f"{name}: sample {first} is {array[first]}; replace NaN and infinite samples first")
    return read_only(array)


def _real(values: ArrayLike) -> ArrayLike:
    """Return the values; raise TypeError for masked and for complex values (numpy would drop the imaginary part)."""
    if np.ma.is_masked(values) or np.iscomplexobj(values):
        raise TypeError
    return values


def read_only(array: np.ndarray) -> np.ndarray:
    """Return a read-only view of the array, so that each kernel is compiled for one type of array only."""
    view = array.view()
    view.flags.writeable = False
    return view
