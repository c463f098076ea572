"""Figure 5: the motion of two blocks under main impulses of I_2c (Casapulla & Maione 2017, section 4).

.. note:: The paper states neither the interval dT of the secondary impulses nor their positions in the half-cycle. Its
   text ("the same number of half-cycles", "a slight increment" at I_s/I = 0.7) agrees only with a common dT in seconds.
   The statements are therefore tested over a range of dT, for every spacing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields

import numpy as np
import pandas as pd
import xarray as xr

from laboratory.paper.blocks import (
    DURATION,
    RADII,
    RESTITUTIONS,
    critical_double_impulse,
    half_cycle_counts,
    no_motion,
    paper_block,
)
from laboratory.paper.figure5_statements import FIGURE5_STATEMENTS
from laboratory.paper.finding import Finding, Statement, examine, interval_ranges, statement_table
from rocking.body.block import Block
from rocking.impulses.half_cycle import hop
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rocking.impulses.main_sequence import critical_impulse
from rocking.impulses.sequence import sequence_response
from rocking.impulses.sequence_kernel import HALF_CYCLE_LIMIT
from rocking.response import HalfCycles, Response
from rockpulse.views.plots.model_histories import HalfCycle, motion_samples

#: I_s/I: the text names 0, 0.7 and the range from 0.3 on; 0.5 lies between.
STUDIED_RATIOS = (0.0, 0.3, 0.5, 0.7)
#: Trial interval dT of the histories [s]: within the range that fits the text.
INTERVAL = 0.5
#: Trial intervals of the scan [s], up to the first half-cycle without secondary impulses (0.610 s; step 3 of section
#: 3.2 wants them shorter).
SCAN = tuple(round(0.002 * step, 10) for step in range(10, 306))
#: Step of the histories [s].
STEP = 0.01
LANES = ("block", "restitution", "secondary_ratio", "spacing", "interval")
#: Columns of the table under the names of the file.
_COLUMNS = {item.name: item.name for item in fields(HalfCycles)} | {"interval": "corrected_interval"}
#: Value of a variable where a half-cycle does not exist; NaN for all others.
_ABSENT = {"impulse_count": -1}


def figure5(
    interval: float = INTERVAL,
    intervals: Sequence[float] = SCAN,
    secondary_ratios: Sequence[float] = STUDIED_RATIOS,
    duration: float = DURATION,
    step: float = STEP,
) -> tuple[xr.Dataset, xr.Dataset, pd.DataFrame]:
    """Histories of blocks A and B, a scan of the common interval dT, and the verdict on each statement for every dT.

    The histories, of `step` [s] up to the end of the input of `duration` [s], and their half-cycles are those of the
    trial `interval` [s]; the scan goes over `intervals` [s], rising. I_s/I rises from 0. Between the impulses the
    motion is Eq. (2).

    Examples
    --------
    >>> figure, scan, statements = figure5(interval=0.5, intervals=[0.5])
    >>> numbers = figure["overturning_half_cycle"].sel(restitution=0.9, secondary_ratio=0.7, spacing="end")
    >>> numbers.values.tolist()
    [6, 7]
    """
    spacings, ratios = list(SPACINGS), list(secondary_ratios)
    figure = half_cycle_tables(RESTITUTIONS, ratios, spacings, [interval], duration).isel(interval=0)
    scanned = half_cycle_tables(RESTITUTIONS, ratios, spacings, list(intervals), duration)
    findings = examine(scanned, FIGURE5_STATEMENTS)
    return _with_histories(figure, duration, step), _intervals(scanned, findings), statement_table(findings)


def half_cycle_tables(
    restitutions: Sequence[float],
    secondary_ratios: Sequence[float],
    spacings: Sequence[str],
    intervals: Sequence[float],
    duration: float,
) -> xr.Dataset:
    """Both blocks under main impulses of I_2c each, for every C, I_s/I, spacing and trial interval dT [s].

    The interval has no meaning for the spacing "continuous". Main impulses act in half-cycles that start before
    `duration` [s]. The answer has the properties of the blocks, the answers of the lanes over :data:`LANES`, and the
    table of half-cycles with a further dimension half_cycle.
    """
    names, shape = list(RADII), (len(secondary_ratios), len(intervals))
    ratio, interval = (grid.ravel() for grid in np.meshgrid(secondary_ratios, intervals, indexing="ij"))
    columns = {}
    blocks = {(name, c): paper_block(name, c) for name in names for c in restitutions}
    for (name, c), block in blocks.items():
        impulse = float(critical_impulse(block, 2))
        for spacing in spacings:
            sequence = ImpulseSequence(impulse, ratio * impulse, interval, duration, spacing=spacing)
            response = sequence_response(block, sequence, table_rows=HALF_CYCLE_LIMIT)
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
    return xr.Dataset(variables, coords)


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
    main = np.array([[critical_impulse(blocks[name, c], 2) for c in restitutions] for name in names])
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


def _with_histories(figure: xr.Dataset, duration: float, step: float) -> xr.Dataset:
    """The half-cycles with the rotation at instants up to the end of the input."""
    dims = LANES[:-1]
    times = np.arange(0.0, duration + 0.5 * step, step)
    times = times[times <= duration]
    rotation = np.empty((*(figure.sizes[dim] for dim in dims), times.size))
    columns = ("start_velocity", "duration", "impulse_count", "corrected_interval")
    tables = np.stack([figure[name].transpose(*dims, "half_cycle").values for name in columns], axis=-1)
    for place in np.ndindex(rotation.shape[:-1]):
        block, case, ratio, spacing = place
        rows = tables[place][np.isfinite(tables[place][:, 0])]
        secondary = float(figure["impulse_ratio"][block, case] * figure["secondary_ratio"][ratio])
        cycles = [HalfCycle(float(u), float(t), int(n), float(dt)) for u, t, n, dt in rows]
        elapsed = sum(cycle.duration for cycle in cycles)
        while elapsed < duration:  # the table ends where the motion repeats itself
            cycles.append(cycles[-1])
            elapsed += cycles[-1].duration
        p, name = float(figure["p"][block]), str(figure["spacing"].values[spacing])
        rotation[place] = motion_samples(cycles, p, secondary, name, times)
    history = xr.Dataset({"rotation_ratio": ((*dims, "time"), rotation)}, {"time": times})
    return figure.merge(history).assign_attrs(duration=duration)


def _intervals(scanned: xr.Dataset, findings: Mapping[Statement, Finding]) -> xr.Dataset:
    """Half-cycles and times of overturning over the scan, and the cases in which each statement holds."""
    shape = ("spacing", "interval")
    like = scanned["ground_contact"].isel(block=0, restitution=0, secondary_ratio=0)
    holds = [
        finding.held.all([dim for dim in finding.held.dims if dim not in shape]).broadcast_like(like).transpose(*shape)
        for finding in findings.values()
    ]
    flags = np.array([held.values for held in holds])
    names = np.array([statement.name for statement in findings])
    somewhere = flags.any(axis=(1, 2))
    result = scanned[[name for name, one in scanned.data_vars.items() if one.dims == LANES]].assign_coords(
        statement=names
    )
    result["holds"] = (("statement", *shape), flags)
    result["all_hold"] = (shape, flags[somewhere].all(axis=0))
    result.attrs["comment"] = (
        f"All that holds anywhere holds together with {interval_ranges(result['all_hold'])}. "
        f"Holding nowhere: {', '.join(names[~somewhere]) or 'none'}."
    )
    return result
