"""From a half-cycle kernel over lanes to a :class:`~rocking.response.Response` with its table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rocking.response import HalfCycles, Response, empty_results, response_of
from rocking.sequence_kernel import COLUMNS, Table
from rocking.threads import split_lanes

__all__ = ["TABLE_ROWS", "combined", "empty_table", "tabulated_response"]

#: A march lower than this is one through the ground [-]; above it is rounding.
GROUND_TOLERANCE = 1e-12

#: Half-cycles kept in a table unless the caller asks for more.
TABLE_ROWS = 1000


def combined(
    by_input: tuple[Any, ...], by_block: tuple[Any, ...], paired: bool = False
) -> tuple[tuple[int, int], tuple[bool, bool], list[np.ndarray]]:
    """Every combination of (q,) inputs and (m,) blocks, or the pairs of them where every block has an input of its own.

    Returns the shape, (q, m) or (1, m) for pairs; which of its axes stand for a scalar, the first one of pairs; and the
    values flattened to (q m,), inputs first.
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


def empty_table(rows: int, lanes: int) -> Table:
    """A table of so many half-cycles for a kernel to write to."""
    table = Table(np.full((COLUMNS, rows, lanes), np.nan), np.empty(lanes), np.empty(lanes, dtype=np.int64))
    table.columns[3] = -1.0  # impulse_count
    return table


def tabulated_response(
    kernel: Callable[..., None],
    lanes: tuple[Any, ...],
    shape: tuple[int, int],
    drop: tuple[bool, bool],
    table_rows: int,
    threads: int | None = None,
) -> Response:
    """Run ``kernel(first, last, lanes, results, table)``, then again with a table as long as the longest motion.

    The table has at most `table_rows` half-cycles; without any the response has no `half_cycles`.
    """
    if table_rows < 0:
        raise ValueError(f"table_rows: expected 0 (no table) or a number of half-cycles, got {table_rows}")
    size = shape[0] * shape[1]
    results = empty_results(size)

    def run(rows: int) -> Table:
        table = empty_table(rows, size)
        split_lanes(lambda first, last: kernel(first, last, lanes, results, table), size, threads)
        return table

    table = run(0)
    half_cycles = None
    if table_rows:
        rows = int(min(table_rows, table.followed.max(initial=0)))
        table = run(rows)
        columns = [column.reshape(rows, *shape) for column in table.columns]
        columns[3] = columns[3].astype(np.int64)
        half_cycles = HalfCycles(*columns)
    contact = table.lowest.reshape(shape) < -GROUND_TOLERANCE
    return response_of(results, shape, drop, half_cycles=half_cycles, ground_contact=contact)
