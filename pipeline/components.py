"""Which channels are assessed as horizontal motion, and which vertical one belongs to them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from rockpulse.failures import Failure
from rockpulse.record import Record

__all__ = ["matching_vertical", "select_horizontal"]


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


def matching_vertical(record: Record, verticals: Sequence[Record]) -> np.ndarray | None:
    """Vertical acceleration of a horizontal record's station, on the record's own samples.

    Parameters
    ----------
    record : Record
        Horizontal channel, (n,).
    verticals : sequence of Record
        Vertical channels to choose from.

    Returns
    -------
    (n,) ndarray or None
        a_v [m/s2], positive up, aligned on absolute time where both channels know it, else on the first sample; zero
        where the vertical channel does not reach. None if no channel of that network, station and location overlaps
        the record (channels without a time match inside one file only).
    """
    times = record.time
    for vertical in verticals:
        codes = (vertical.network, vertical.station, vertical.location)
        if codes != (record.network, record.station, record.location):
            continue
        if record.start_time is not None and vertical.start_time is not None:
            offset = (vertical.start_time - record.start_time).total_seconds()
        elif vertical.source == record.source:
            offset = 0.0
        else:
            continue
        if offset < record.duration and offset + vertical.duration > 0.0:
            return np.interp(times, vertical.time + offset, vertical.acceleration, left=0.0, right=0.0)
    return None
