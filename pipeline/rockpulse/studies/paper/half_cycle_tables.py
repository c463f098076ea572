"""Blocks A and B of Figure 5 half-cycle by half-cycle, for common intervals of the secondary impulses in seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.impulses.half_cycle import hop
from rocking.impulses.main import critical_impulse_at
from rocking.impulses.sequence import ImpulseSequence, sequence_response
from rocking.impulses.sequence_kernel import HALF_CYCLE_LIMIT
from rocking.response import HalfCycles, Response
from rockpulse.storage.study_variables import FIGURE5, described_set, no_motion
from rockpulse.studies.paper.double_impulse import critical_double_impulse
from rockpulse.studies.paper.paper_blocks import RADII, half_cycle_counts, paper_block

__all__ = ["LANES", "half_cycle_tables"]

LANES = ("block", "restitution", "secondary_ratio", "spacing", "interval")

#: Columns of the table under the names of the file.
_COLUMNS = {item.name: item.name for item in fields(HalfCycles)} | {"interval": "corrected_interval"}

#: Value of a variable where a half-cycle does not exist; NaN for all others.
_ABSENT = {"impulse_count": -1}


def half_cycle_tables(
    restitutions: Sequence[float],
    secondary_ratios: Sequence[float],
    spacings: Sequence[str],
    intervals: Sequence[float],
    duration: float,
    threads: int | None = None,
) -> xr.Dataset:
    """Both blocks under main impulses of I_2c each, for every C, I_s/I, spacing and trial interval dT [s].

    The interval has no meaning for the spacing "continuous". Main impulses act in half-cycles that start before
    `duration` [s]. The answer has the variables of ``FIGURE5`` but for the histories; those of the lanes over
    :data:`LANES`, the table with a further dimension half_cycle.
    """
    names, shape = list(RADII), (len(secondary_ratios), len(intervals))
    ratio, interval = (grid.ravel() for grid in np.meshgrid(secondary_ratios, intervals, indexing="ij"))
    columns = {}
    blocks = {(name, c): paper_block(name, c) for name in names for c in restitutions}
    for (name, c), block in blocks.items():
        impulse = float(critical_impulse_at(block, 2))
        for spacing in spacings:
            sequence = ImpulseSequence(impulse, ratio * impulse, interval, duration, spacing=spacing)
            response = sequence_response(block, sequence, table_rows=HALF_CYCLE_LIMIT, threads=threads)
            columns[name, c, spacing] = _columns(response, shape, duration)
    rows = max(found["peak"].shape[-1] for found in columns.values())
    coords = {
        "block": names,
        "restitution": list(restitutions),
        "secondary_ratio": list(secondary_ratios),
        "spacing": list(spacings),
        "interval": list(intervals),
        "half_cycle": np.arange(1, rows + 1),
    }
    variables = _block_variables(names, restitutions, blocks)
    for variable in columns[names[0], restitutions[0], spacings[0]]:
        table = variable in _COLUMNS.values()
        values = [
            [
                [
                    _padded(columns[name, c, spacing][variable], rows, variable)
                    if table
                    else columns[name, c, spacing][variable]
                    for spacing in spacings
                ]
                for c in restitutions
            ]
            for name in names
        ]
        # (block, restitution, spacing, ratio, interval, ...) in the order of LANES
        variables[variable] = ((*LANES, "half_cycle") if table else LANES, np.moveaxis(np.array(values), 2, 3))
    return described_set(variables, coords, FIGURE5)


def _columns(response: Response, shape: tuple[int, int], duration: float) -> dict[str, np.ndarray]:
    """Variables of all lanes of a response, (ratio, interval), those of the table with a last axis half_cycle."""
    assert response.half_cycles is not None
    answer = ("peak_rotation_ratio", "outcome", "overturning_half_cycle", "overturning_time", "ground_contact")
    found = {name: np.asarray(getattr(response, name)).reshape(shape) for name in answer}
    found["half_cycle_count"] = half_cycle_counts(response, duration).reshape(shape)
    found["no_motion"] = no_motion(found["ground_contact"], found["peak_rotation_ratio"])
    for name, variable in _COLUMNS.items():
        column = getattr(response.half_cycles, name)
        found[variable] = np.moveaxis(column, 0, -1).reshape(*shape, -1)
    return found


def _padded(column: np.ndarray, rows: int, variable: str) -> np.ndarray:
    missing = [(0, 0)] * (column.ndim - 1) + [(0, rows - column.shape[-1])]
    return np.pad(column, missing, constant_values=_ABSENT.get(variable, np.nan))


def _block_variables(
    names: Sequence[str], restitutions: Sequence[float], blocks: dict[tuple[str, float], Block]
) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """Properties of each block, and its critical and main impulses."""
    alone = [paper_block(name, "housner") for name in names]
    double = np.array([critical_double_impulse(block) for block in alone])
    main = np.array([[critical_impulse_at(blocks[name, c], 2) for c in restitutions] for name in names])
    critical = np.array([block.critical_impulse for block in alone])
    p = np.array([block.p for block in alone])
    second = np.array([[hop(ratio)[1] for ratio in row] for row in main / critical[:, None]]) / p[:, None]
    by_block = {
        "width": [2.0 * block.half_width for block in alone],
        "height": [2.0 * block.half_height for block in alone],
        **{name: [getattr(block, name) for block in alone] for name in ("radius", "alpha_c", "slenderness")},
        "p": p,
        "critical_impulse": critical,
        "housner_restitution": [block.restitution for block in alone],
        "double_impulse": double[:, 0],
        "double_impulse_time": double[:, 1],
    }
    by_case = {"main_impulse": main, "impulse_ratio": main / critical[:, None], "second_impulse_time": second}
    return {
        **{name: (("block",), np.asarray(values, dtype=float)) for name, values in by_block.items()},
        **{name: (("block", "restitution"), values) for name, values in by_case.items()},
    }
