"""SIGMA/ITACA ``.acc``: ten lines of header, then five accelerations of 14 characters in a row, in m/s2."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.record.record import Record

#: The header; the misspelling of the last line is that of the real files.
_HEADER = """\
Event Date & Time             : {event}
Station Code / Name           : CLC / {note}
Network                       : CI
Orientation                   : {orientation}
Processing Info               : {processing}
Filter Cut-off Frequency (Hz) : {corners}
Time Increment (s)            : {dt:g}
Number of Data                : {count}
PGA (m/s/s)                   : {peak:.7E}
{series}
"""


def sigma(
    values: Sequence[float],
    dt: float = 0.01,
    event: str = "2009-04-06 01:32:39",
    orientation: str = "WE",
    processing: str = "Acausal Butterworth bandpass filtering (4pole-4pole).",
    corners: str = "0.100 - 50.000",
    series: str = "Accelaration time series in m/s/s",
    count: int | None = None,
) -> bytes:
    """One component, accelerations in m/s2; `count` is the declared number, where that is not the number of samples."""
    header = _HEADER.format(
        event=event,
        note=NOTE,
        orientation=orientation,
        processing=processing,
        corners=corners,
        dt=dt,
        count=len(values) if count is None else count,
        peak=float(np.max(np.abs(values))),
        series=series,
    )
    block = rows([f"{value:14.7E}" for value in values], 5)
    return "\n".join([*header.splitlines(), *block, ""]).encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """The east component, and the vertical one."""
    east, _, up = channels
    return {
        "clc_H2.cor.acc": sigma(east.acceleration, east.dt, event="2019-07-06 03:19:58"),
        "clc_V.cor.acc": sigma(up.acceleration, up.dt, orientation="UP", event="2019-07-06 03:19:58"),
    }
