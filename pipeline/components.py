"""Which channels are assessed as horizontal motion, and which vertical one belongs to them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rockpulse.failures import Failure
from rockpulse.record import Record

__all__ = ["align", "matching_vertical", "select_horizontal", "uncovered"]


_REASONS = {
    "vertical": "vertical channel: read, not assessed as horizontal",
    "structural": "channel on a structure: read, not assessed as ground motion",
}


def select_horizontal(records: Iterable[Record]) -> tuple[list[Record], list[Failure]]:
    """Keep the channels that are assessed as horizontal ground motion.

    Parameters
    ----------
    records : iterable of Record
        Records of any orientation.

    Returns
    -------
    horizontal : list of Record
        Horizontal channels, and those of unknown orientation with a warning, in the order given.
    failures : list of Failure
        A row for each of the others, kind "vertical" or "structural".
    """
    horizontal, failures = [], []
    for record in records:
        kind = record.orientation
        if kind == "vertical" or kind == "structural":
            failures.append(Failure(record.source, "select", f"{record.id}: {_REASONS[kind]}", kind))
        elif kind == "unknown":
            note = "the orientation is unknown; assessed as horizontal"
            horizontal.append(record.with_warning(note))
        else:
            horizontal.append(record)
    return horizontal, failures


def matching_vertical(record: Record, verticals: Iterable[Record]) -> Record | None:
    """The vertical channel that was recorded together with a horizontal one.

    Parameters
    ----------
    record : Record
        Horizontal channel.
    verticals : iterable of Record
        Vertical channels to choose from.

    Returns
    -------
    Record or None
        Of the same file, or of the same network, station and location (station known) and overlapping in time; the
        same file comes first, then the longest overlap. None if there is none.
    """
    together = [vertical for vertical in verticals if _together(record, vertical)]
    return max(together, key=lambda one: (one.source == record.source, _overlap(record, one)), default=None)


def align(vertical: Record, record: Record) -> np.ndarray:
    """Acceleration of a vertical channel at the samples of a horizontal one.

    Parameters
    ----------
    vertical, record : Record
        The two channels, conditioned.

    Returns
    -------
    (n,) ndarray
        a_v [m/s2], positive up, on absolute time where both channels know it, else from the first sample on; linear
        between its samples, zero where the vertical channel does not reach.
    """
    offset = _offset(record, vertical)
    return np.interp(record.time, vertical.time + offset, vertical.acceleration, left=0.0, right=0.0)


def uncovered(vertical: Record, record: Record) -> float:
    """How much of a record its vertical channel does not reach [s]."""
    return max(0.0, record.duration - _overlap(record, vertical))


def _together(record: Record, vertical: Record) -> bool:
    codes = (record.network, record.station, record.location)
    same_station = bool(record.station) and codes == (vertical.network, vertical.station, vertical.location)
    timed = record.start_time is not None and vertical.start_time is not None
    same_file = record.source == vertical.source and record.station == vertical.station
    return (same_file or (same_station and timed)) and _overlap(record, vertical) > 0.0


def _offset(record: Record, vertical: Record) -> float:
    if record.start_time is None or vertical.start_time is None:
        return 0.0
    return (vertical.start_time - record.start_time).total_seconds()


def _overlap(record: Record, vertical: Record) -> float:
    offset = _offset(record, vertical)
    return min(record.duration, offset + vertical.duration) - max(0.0, offset)
