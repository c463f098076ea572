"""Whether the data make a fragility curve and a band, and the statement that says why they do not."""

from __future__ import annotations

import math

import numpy as np

from rockpulse.earthquakes import FEWEST_EVENTS
from rockpulse.storage.variables.fragility import Band, Extrapolated, Status
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, NOT_ABOVE, Observations, has_maximum

#: Relative difference of capacities that are the same but for rounding.
EQUAL = 1e-9


def missing(rows: Observations) -> Status:
    """The status of data that lack something for a curve, as far as it is seen before any fit."""
    known = rows.level[rows.kind == EXACT]
    reached = rows.kind != ABOVE
    if rows.level.size == 0:
        return Status.NO_RECORD
    if rows.records == 1:
        return Status.ONE_RECORD
    if not np.any(reached):
        return Status.NOTHING_REACHED
    if np.all(rows.kind == NOT_ABOVE):
        return Status.EVERYTHING_REACHED
    if np.unique(rows.record[reached]).size == 1:  # in however many rows: of several levels, or bodies put together
        return Status.ONE_REACHED
    if known.size and np.ptp(known) <= EQUAL * known[0]:
        above, below = rows.level[rows.kind == ABOVE], rows.level[rows.kind == NOT_ABOVE]
        if np.all(above <= known[-1]) and np.all(below >= known[0]):
            return Status.STEP
    if not has_maximum(rows.level, rows.kind, np.ones((1, rows.level.size)))[0]:
        return Status.SEPARATED
    return Status.FITTED


def band_statement(band: Band, rows: Observations, slopes: np.ndarray) -> str:
    """The statement on the band of a curve; empty where it is given.

    `slopes` (1 + events,) are b of all rows, then without each event.
    """
    if band == Band.GIVEN:
        return ""
    if band == Band.RESTS_ON_ONE_EVENT:
        alone = [name for name, b in zip(rows.events, slopes[1:], strict=True) if not b > 0.0]
        return f"no band: without the event {alone[0]} there would be no curve"
    return f"no band: the records come from {_several(len(rows.events), 'event')}, it needs {FEWEST_EVENTS}"


def extrapolated(median: float, rows: Observations) -> Extrapolated:
    """Whether the median of a curve, in the unit of the measure, lies above or below every level looked at."""
    if median > np.max(rows.level):
        return Extrapolated.ABOVE
    if median < np.min(rows.level):
        return Extrapolated.BELOW
    return Extrapolated.NO


def extrapolation_statement(median: float, rows: Observations) -> str:
    """The statement on a median beyond the data; empty where it lies among them."""
    side = extrapolated(median, rows)
    if side == Extrapolated.NO:
        return ""
    reached = _several(np.unique(rows.record[rows.kind != ABOVE]).size, "record")
    end = f"above every level looked at, up to {np.max(rows.level):.3g}"
    if side == Extrapolated.BELOW:
        end = f"below every level looked at, from {np.min(rows.level):.3g}"
    return f"extrapolated: the median, {median:.3g}, lies {end}; {reached} of {rows.records} reached the limit state"


def _several(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _range(levels: np.ndarray) -> str:
    low, high = float(np.min(levels)), float(np.max(levels))
    return f"{low:.3g}" if math.isclose(low, high, rel_tol=1e-3) else f"{low:.3g} to {high:.3g}"


def _separated(rows: Observations) -> str:
    not_reached, reached = rows.level[rows.kind == ABOVE], rows.level[rows.kind == NOT_ABOVE]
    if np.ptp(rows.level) == 0.0:
        return f"no curve: all motions are of one level, {rows.level[0]:.3g}; a dispersion needs several"
    if np.max(not_reached) == np.min(reached):
        return (
            f"no curve: no motion below {np.min(reached):.3g} and every motion above it reached the limit state; the "
            "dispersion cannot be told; look at levels nearby"
        )
    if np.max(not_reached) < np.min(reached):
        return (
            f"no curve: no motion up to {np.max(not_reached):.3g} and every motion from {np.min(reached):.3g} reached "
            "the limit state; the median lies between them, the dispersion cannot be told"
        )
    return "no curve: the motions that reached the limit state are no stronger than the others"


#: The statement where there is no curve, by the status.
STATEMENTS = {
    Status.NO_RECORD: lambda rows: "no curve: no record",
    Status.ONE_RECORD: lambda rows: (
        f"no curve: one record only, {_range(rows.level)} "
        f"{'reached' if np.any(rows.kind != ABOVE) else 'not reached'}; a dispersion needs several"
    ),
    Status.NOTHING_REACHED: lambda rows: (
        f"no curve: none of {_several(rows.records, 'record')} reached the limit state, looked at up to "
        f"{_range(rows.level)}"
    ),
    Status.EVERYTHING_REACHED: lambda rows: (
        f"no curve: all of {_several(rows.records, 'record')} reached the limit state at every level, from "
        f"{np.min(rows.level):.3g}; look at lower levels"
    ),
    Status.ONE_REACHED: lambda rows: (
        f"no curve: one record only reached the limit state, at {_range(rows.level[rows.kind != ABOVE])}, of "
        f"{rows.records}; a dispersion needs several"
    ),
    Status.STEP: lambda rows: (
        f"a step at {rows.level[rows.kind == EXACT][0]:.3g}: all capacities that are known are the same, "
        "there is no dispersion"
    ),
    Status.SEPARATED: _separated,
    Status.NOT_INCREASING: lambda rows: "no curve: the limit state is not reached more often at higher levels",
    Status.NO_MAXIMUM: lambda rows: "no curve: the likelihood has no maximum that could be found",
}
