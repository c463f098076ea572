"""From a half-cycle kernel over lanes to a :class:`~rocking.response.Response` with its table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rocking.response import HalfCycles, Response, drop_axes
from rocking.sequence_kernel import COLUMNS
from rocking.threads import split_lanes

__all__ = ["TABLE_ROWS", "lanes", "tabulated_response"]

#: A march lower than this is one through the ground [-]; above it is rounding.
GROUND_TOLERANCE = 1e-12

#: Half-cycles kept in a table unless the caller asks for more.
TABLE_ROWS = 1000


def lanes(
    by_input: tuple[Any, ...], by_block: tuple[Any, ...], paired: bool = False
) -> tuple[tuple[int, int], tuple[bool, bool], list[np.ndarray]]:
    """Every combination of inputs and blocks, or the pairs of them, flattened.

    Parameters
    ----------
    by_input : tuple of float or (q,) ndarray
        Values that vary with the input.
    by_block : tuple of float or (m,) ndarray
        Values that vary with the block.
    paired : bool
        Every block has an input of its own: (m,) of each, or one of either for all.

    Returns
    -------
    shape : tuple of int
        (q, m); (1, m) for pairs.
    drop : tuple of bool
        Which of the two axes stands for a scalar; the first one of pairs.
    flat : list of (q m,) ndarray
        The values in the order given, inputs first.

    Raises
    ------
    ValueError
        For pairs of different numbers.
    """
    inputs = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in by_input))
    blocks = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in by_block))
    if paired:
        if inputs[0].ndim and blocks[0].ndim and inputs[0].shape != blocks[0].shape:
            raise ValueError(
                f"paired: expected one sequence for each block, got {inputs[0].size} for {blocks[0].size} blocks"
            )
        pairs = np.broadcast_arrays(*inputs, *blocks)
        return (1, pairs[0].size), (True, pairs[0].ndim == 0), [np.array(value).reshape(-1) for value in pairs]
    shape = (inputs[0].size, blocks[0].size)
    flat = [np.repeat(value.reshape(-1), shape[1]) for value in inputs]
    flat += [np.tile(value.reshape(-1), shape[0]) for value in blocks]
    return shape, (inputs[0].ndim == 0, blocks[0].ndim == 0), flat


def tabulated_response(
    kernel: Callable[..., None],
    arguments: tuple[Any, ...],
    shape: tuple[int, int],
    drop: tuple[bool, bool],
    table_rows: int,
    threads: int | None = None,
) -> Response:
    """Run a kernel over the lanes, then again with a table as long as the longest motion.

    Parameters
    ----------
    kernel : callable
        ``kernel(first_lane, last_lane, table, floats, integers, *arguments)``, see
        :func:`~rocking.sequence_kernel.sequence_lanes`.
    arguments : tuple
        What the kernel needs.
    shape : tuple of int
        (q, m).
    drop : tuple of bool
        Axes to drop.
    table_rows : int
        Largest number of half-cycles in the table; 0 for no table.
    threads : int, optional
        Threads that share the lanes; None for all available cores.

    Returns
    -------
    Response
        With `half_cycles` unless `table_rows` is 0.
    """
    if table_rows < 0:
        raise ValueError(f"table_rows: expected 0 (no table) or a number of half-cycles, got {table_rows}")
    size = shape[0] * shape[1]
    floats, integers = np.empty((3, size)), np.empty((5, size), dtype=np.int64)

    def run(table: np.ndarray) -> None:
        def kernel_call(first: int, last: int) -> None:
            kernel(first, last, table, floats, integers, *arguments)

        split_lanes(kernel_call, size, threads)

    run(np.empty((COLUMNS, 0, size)))
    half_cycles = None
    if table_rows:
        rows = int(min(table_rows, integers[4].max(initial=0)))
        table = np.full((COLUMNS, rows, size), np.nan)
        table[3] = -1.0
        run(table)
        start_velocity, peak, duration, count, interval, impact_speed = (
            column.reshape(rows, *shape) for column in table
        )
        half_cycles = HalfCycles(
            start_velocity=start_velocity,
            peak=peak,
            duration=duration,
            impulse_count=count.astype(np.int64),
            interval=interval,
            impact_speed=impact_speed,
        )
    response = Response(
        peak_rotation_ratio=floats[0].reshape(shape),
        overturning_time=floats[1].reshape(shape),
        outcome=integers[0].reshape(shape),
        reason=integers[1].reshape(shape),
        overturning_half_cycle=integers[2].reshape(shape),
        impacts=integers[3].reshape(shape),
        half_cycles=half_cycles,
        ground_contact=floats[2].reshape(shape) < -GROUND_TOLERANCE,
    )
    return drop_axes(response, 2, drop)
