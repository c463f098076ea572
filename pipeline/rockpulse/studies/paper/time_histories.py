"""Figure 5: the motion of two blocks under main impulses of I_2c (Casapulla & Maione 2017, section 4).

.. note:: The paper names neither the interval dT of the secondary impulses nor where they stand in the half-cycle. The
   text ("the same number of half-cycles", "a slight increment" at I_s/I = 0.7) fits a common dT in seconds only, so the
   statements are looked at over a range of it, for every spacing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from rocking.impulses.impulse_sequence import SPACINGS
from rockpulse.errors import ConfigError
from rockpulse.storage.study_variables import FIGURE5, INTERVALS, STUDY, described_set
from rockpulse.studies.paper.finding import Finding, Statement, examine, interval_ranges, statement_table
from rockpulse.studies.paper.half_cycle_tables import LANES, half_cycle_tables
from rockpulse.studies.paper.history_statements import HISTORY_STATEMENTS
from rockpulse.studies.paper.motion_history import HalfCycle, rotation_history
from rockpulse.studies.paper.options import axis
from rockpulse.studies.paper.paper_blocks import DURATION, GRAVITY, RESTITUTIONS

__all__ = ["INTERVAL", "SCAN", "STUDIED_RATIOS", "figure5"]

#: I_s/I: the text names 0, 0.7 and the range from 0.3 on; 0.5 lies between.
STUDIED_RATIOS = (0.0, 0.3, 0.5, 0.7)

#: Trial interval dT of the histories [s]: within the range that fits the text.
INTERVAL = 0.5

#: Trial intervals of the scan [s], up to the first half-cycle without secondary impulses (0.610 s; step 3 of section
#: 3.2 wants them shorter).
SCAN = tuple(round(0.002 * step, 10) for step in range(10, 306))

#: Intervals that make sense [s]: below, the limit n -> infinity says the same; above, n is 2 throughout.
LIMITS = (1e-3, 10.0)

#: Step of the histories [s].
STEP = 0.01

#: Largest number of instants of a history.
MOST_INSTANTS = 100_000


def figure5(
    restitutions: Sequence[float] = RESTITUTIONS,
    secondary_ratios: Sequence[float] = STUDIED_RATIOS,
    interval: float = INTERVAL,
    intervals: Sequence[float] = SCAN,
    duration: float = DURATION,
    step: float = STEP,
    threads: int | None = None,
) -> xr.DataTree:
    """Time histories and half-cycles of blocks A and B, and the verdict on each statement for every common dT.

    Parameters
    ----------
    restitutions : sequence of float
        C [-], at least two: the statements compare the largest and the smallest.
    secondary_ratios : sequence of float
        I_s/I [-], increasing from 0, at least three.
    interval : float
        Trial interval dT of the histories [s].
    intervals : sequence of float
        Trial intervals of the scan [s], increasing.
    duration : float
        Main impulses act in half-cycles that start before this time [s]; the histories end there.
    step : float
        Step of the histories [s].
    threads : int, optional
        Threads that share the lanes; None for all available cores.

    Returns
    -------
    xarray.DataTree
        Nodes /figure5 (histories and half-cycles at `interval`), /intervals (the scan), /statements (docs/schema.md).

    Raises
    ------
    ConfigError
        For a value out of range.

    Notes
    -----
    The half-cycles are those of :func:`~rocking.impulses.sequence.sequence_response`; between the impulses the motion
    is Eq. (2).

    Examples
    --------
    >>> tree = figure5(interval=0.5, intervals=[0.5])
    >>> numbers = tree["figure5/overturning_half_cycle"].sel(restitution=0.9, secondary_ratio=0.7, spacing="end")
    >>> numbers.values.tolist()
    [6, 7]
    """
    cases = axis("restitution", restitutions, 0.0, 1.0).tolist()
    ratios = axis("secondary ratio I_s/I", secondary_ratios, 0.0, 1.0, increasing=True).tolist()
    if len(cases) < 2 or len(ratios) < 3 or ratios[0] != 0.0:
        raise ConfigError(
            "figure 5 compares: expected at least two restitutions and at least three ratios I_s/I of which the first "
            f"is 0, got {cases} and {ratios}"
        )
    scan = axis("interval of the scan", intervals, *LIMITS, increasing=True).tolist()
    axis("interval", [interval], *LIMITS)
    for name, value in (("duration", duration), ("step", step)):
        axis(name, [value])
    if duration / step > MOST_INSTANTS:
        raise ConfigError(
            f"step: expected at most {MOST_INSTANTS} instants of a history, got {duration / step:.3g} "
            f"in {duration:g} s at a step of {step:g} s"
        )
    spacings = list(SPACINGS)
    figure = half_cycle_tables(cases, ratios, spacings, [interval], duration, threads).isel(interval=0)
    figure = _with_histories(figure, duration, step)
    scanned = half_cycle_tables(cases, ratios, spacings, scan, duration, threads)
    findings = examine(scanned, HISTORY_STATEMENTS)
    tree = xr.DataTree.from_dict(
        {"/figure5": figure, "/intervals": _intervals(scanned, findings), "/statements": statement_table(findings)}
    )
    tree.attrs.update(
        kind=STUDY,
        title="Casapulla & Maione (2017), Figure 5: two blocks under main impulses of I_2c",
        duration=float(duration),
        gravity=GRAVITY,
    )
    return tree


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
        rotation[place] = rotation_history(cycles, p, secondary, name, times)
    history = described_set({"rotation_ratio": ((*dims, "time"), rotation)}, {"time": times}, FIGURE5)
    complete = figure.merge(history)
    complete.attrs["comment"] = (
        f"Trial interval {float(figure['interval']):g} s for both blocks; I = I_2c of each block and restitution. "
        "The text names I_s/I = 0, 0.7 and the range from 0.3 to 0.7, neither the interval nor the spacing."
    )
    return complete


def _intervals(scanned: xr.Dataset, findings: Mapping[Statement, Finding]) -> xr.Dataset:
    """Half-cycles and times of overturning over the scan, and the cases in which each statement holds."""
    shape = {dim: scanned.sizes[dim] for dim in ("spacing", "interval")}
    holds = []
    for finding in findings.values():
        held = finding.held.all([dim for dim in finding.held.dims if dim not in shape])
        holds.append(held.broadcast_like(scanned["ground_contact"].isel(block=0, restitution=0, secondary_ratio=0)))
    flags = np.array([held.transpose(*shape).values for held in holds])
    somewhere = flags.any(axis=(1, 2))
    together = flags[somewhere].all(axis=0)
    variables = {
        name: (LANES, scanned[name].values)
        for name in INTERVALS
        if name in scanned and name not in ("holds", "all_hold")
    }
    coords = {name: scanned[name].values for name in LANES}
    coords["statement"] = np.array([statement.name for statement in findings])
    result = described_set(
        {
            **variables,
            "holds": (("statement", "spacing", "interval"), flags),
            "all_hold": (("spacing", "interval"), together),
        },
        coords,
        INTERVALS,
    )
    never = ", ".join(coords["statement"][~somewhere].tolist())
    ranges = interval_ranges(result["all_hold"] == 1)
    result.attrs["comment"] = (
        f"All that holds anywhere holds together with {ranges}. Holding nowhere: {never or 'none'}."
    )
    return result
