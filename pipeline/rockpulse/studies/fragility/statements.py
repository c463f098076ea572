"""Checks whether a fragility curve and its band can be determined from the data, and states the reason if not."""

import math
from collections.abc import Callable

import numpy as np

from rockpulse.earthquakes import FEWEST_EVENTS
from rockpulse.storage.variables.fragility import Band, Extrapolated, Status
from rockpulse.studies.fragility.likelihood import ABOVE, EXACT, NOT_ABOVE, Observations, has_maximum
from rockpulse.warning_text import WarningText, counted

#: Capacities with a smaller relative difference count as equal.
EQUAL = 1e-9


def missing(rows: Observations) -> Status:
    """Return the status FITTED if a curve can be fitted to the data, otherwise the status of the reason."""
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
    if np.unique(rows.record[reached]).size == 1:  # a record may have several rows
        return Status.ONE_REACHED
    if known.size and np.ptp(known) <= EQUAL * known[0]:
        above, below = rows.level[rows.kind == ABOVE], rows.level[rows.kind == NOT_ABOVE]
        if np.all(above <= known[-1]) and np.all(below >= known[0]):
            return Status.STEP
    if not has_maximum(rows.level, rows.kind, np.ones((1, rows.level.size)))[0]:
        return Status.SEPARATED
    return Status.FITTED


def band_statement(band: Band, rows: Observations, slopes: np.ndarray) -> list[WarningText]:
    """Return the reason for a missing band, or an empty list; `slopes` are b with all, then without each event."""
    if band == Band.GIVEN:
        return []
    if band == Band.RESTS_ON_ONE_EVENT:
        alone = [name for name, b in zip(rows.events, slopes[1:], strict=True) if not b > 0.0]
        return [WarningText("band_one_event", event=str(alone[0]))]
    return [WarningText("band_few_events", events=counted(len(rows.events), "event"), needed=FEWEST_EVENTS)]


def extrapolated(median: float, rows: Observations) -> Extrapolated:
    """Return whether the median of a curve is above or below all observed levels."""
    if median > np.max(rows.level):
        return Extrapolated.ABOVE
    if median < np.min(rows.level):
        return Extrapolated.BELOW
    return Extrapolated.NO


def extrapolation_statement(median: float, rows: Observations) -> list[WarningText]:
    """Return a warning if the median of a curve is outside the observed levels, otherwise an empty list."""
    side = extrapolated(median, rows)
    if side == Extrapolated.NO:
        return []
    reached = counted(np.unique(rows.record[rows.kind != ABOVE]).size, "record")
    level = np.max(rows.level) if side == Extrapolated.ABOVE else np.min(rows.level)
    code = f"median_{side.name.lower()}"
    return [WarningText(code, median=float(median), level=float(level), reached=reached, records=int(rows.records))]


def _range(levels: np.ndarray) -> str:
    low, high = float(np.min(levels)), float(np.max(levels))
    return f"{low:.3g}" if math.isclose(low, high, rel_tol=1e-3) else WarningText("interval", low=low, high=high)


def _nothing_reached(rows: Observations) -> WarningText:
    records, levels = counted(rows.records, "record"), _range(rows.level)
    if isinstance(levels, WarningText):
        return WarningText("nothing_reached_between", records=records, **levels.values)
    return WarningText("nothing_reached", records=records, level=float(np.min(rows.level)))


def _one_record(rows: Observations) -> WarningText:
    reached = "reached" if np.any(rows.kind != ABOVE) else "not_reached"
    return WarningText(f"one_record_{reached}", levels=_range(rows.level))


def _separated(rows: Observations) -> WarningText:
    if np.ptp(rows.level) == 0.0:
        return WarningText("one_level", level=float(rows.level[0]))
    not_reached, reached = (
        extreme(rows.level[rows.kind == kind]) for extreme, kind in ((np.max, ABOVE), (np.min, NOT_ABOVE))
    )
    if not_reached == reached:
        return WarningText("separated_at", level=float(reached))
    if not_reached < reached:
        return WarningText("separated", low=float(not_reached), high=float(reached))
    return WarningText("not_stronger")


#: Functions that word the reason for a missing curve, by status.
STATEMENTS: dict[Status, Callable[[Observations], WarningText]] = {
    Status.NO_RECORD: lambda rows: WarningText("no_record"),
    Status.ONE_RECORD: _one_record,
    Status.NOTHING_REACHED: _nothing_reached,
    Status.EVERYTHING_REACHED: lambda rows: WarningText(
        "everything_reached", records=counted(rows.records, "record"), level=float(np.min(rows.level))
    ),
    Status.ONE_REACHED: lambda rows: WarningText(
        "one_reached", levels=_range(rows.level[rows.kind != ABOVE]), records=int(rows.records)
    ),
    Status.STEP: lambda rows: WarningText("step", level=float(rows.level[rows.kind == EXACT][0])),
    Status.SEPARATED: _separated,
    Status.NOT_INCREASING: lambda rows: WarningText("not_increasing"),
    Status.NO_MAXIMUM: lambda rows: WarningText("no_maximum"),
}
