"""NSMN (Turkey, before AFAD)."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE
from rockpulse.record.record import Record


def nsmn(
    values: np.ndarray,
    place: str = "AYDIN GERMENCİK",
    event: str = "2017/07/20 22:31:09 (GMT)",
    start: str = "20/07/2017 22:30:58.250000 (GMT)",
    station: str = "0921",
    count: int | None = None,
    dt: str = "0.01",
) -> bytes:
    """Rows of a (n, 3) table: N-S, E-W, U-D [gal]."""
    north, east, up = np.max(np.abs(values), axis=0)
    lines = [
        "STRONG GROUND MOTION RECORDS OF TURKIYE",
        f"PLACE                   : {place}",
        f"EARTHQUAKE DATE         : {event}",
        "EPICENTER COORDINATES   : 35.77000N-117.59900W",
        "EARTHQUAKE DEPTH (km)   : 8.00",
        "EARTHQUAKE MAGNITUDE    : 7.1 Mw",
        f"STATION ID              : {station}",
        "STATION COORDINATES     : 35.81574N-117.59751W",
        "STATION ALTITUDE (m)    : 66",
        "RECORDER TYPE           : Sara acebox",
        "RECORDER SERIAL NO      : 1856",
        f"RECORD TIME             : {start}",
        f"NUMBER OF DATA          : {len(values) if count is None else count}",
        f"SAMPLING INTERVAL (sec) : {dt}",
        f"RAW PGA VALUES (gal)    : (N-S) {north:.6f} (E-W) {east:.6f} (U-D) {up:.6f}",
        "Copyright EARTHQUAKE DEPARTMENT",
        "DISASTER AND EMERGENCY MANAGEMENT PRESIDENCY",
        "       N-S          E-W          U-D",
        *(f"{row[0]:12.6f}{row[1]:14.6f}{row[2]:13.6f}" for row in values),
    ]
    return ("\r\n".join(lines) + "\r\n").encode("iso8859-9")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """The three channels in the order of the format."""
    east, north, up = (100.0 * channel.acceleration for channel in channels)
    content = nsmn(
        np.column_stack([north, east, up]),
        place=NOTE,
        event="2019/07/06 03:19:53 (GMT)",
        start="06/07/2019 03:19:58.000000 (GMT)",
        station="CLC",
    )
    return {"clc_nsmn.txt": content}
