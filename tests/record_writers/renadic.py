"""RENADIC volume 1: (time, acceleration) pairs in g/10, four channels, records cut into parts."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.record.record import STANDARD_GRAVITY, Record


def renadic(
    columns: Sequence[Sequence[float]],
    components: Sequence[str] = ("L", "V", "T"),
    dt: float = 0.01,
    first: float = 0.0,
    trigger: str = "2/27/2010 3:55:14.000 GMT",
    event: str = "MAULE 2010",
    name: str = "CURICO S/N 499",
) -> bytes:
    """A file of several channels, accelerations in g/10, from `first` [s] on."""
    lines: list[str] = []
    for number, (values, component) in enumerate(zip(columns, components, strict=True), start=1):
        points = len(values)
        at = int(np.argmax(np.abs(values)))
        lines += [
            "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 05/24/2011",
            event,
            "02/27/2010 3:54:54 (GMT)                (ORIGIN: 02/27/2010 3:54:54 GMT)",
            f"                                   TRIGGER TIME: {trigger}",
            f"STATION NO.          0.000N    0.000E  QDR       S/N  499 ({len(columns)}  CHNS OF "
            f"{len(columns)}  AT STA)",
            name,
            f"CHAN {number:2d}: {component:9s}(STA CHN: {number:2d})               ",
            "UNIVERSIDAD DE CHILE - RENADIC",
            "HYPOCENTER:   0.000N    0.000E  H=   0.0KM   ML= 0.00",
            "INSTR PERIOD = 0.0391 SEC,  DAMPING =0.7000,  SENSITIVITY =1.250 VDC/G",
            f"NO. OF POINTS = {points:6d}  RECORD LENGTH ={points * dt:7.3f} SEC",
            f"UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  ={np.max(np.abs(values)) / 10.0:7.3f} G, "
            f"AT {first + at * dt:7.3f} SEC",
            "RMS ACCEL OF COMPLETE RECORD = 0.082 G",
            "    0" * 16,
            f"{'    0' * 11}{points % 100_000:5d}{'    0' * 4}",
            *["    0" * 16] * 4,
            "    0" * 4,
            f"{'     0.000' * 2}{points * dt:10.3f}{'     0.000' * 3}{np.max(np.abs(values)) / 10.0:10.3f}"
            f"{first + at * dt:10.3f}",
            *["     0.000" * 8] * 5,
            "     0.000" * 2,
            *rows([f"{first + dt * index:7.3f}{value:7.3f}" for index, value in enumerate(values)], 5),
            f"/&  ----------  END OF DATA FOR CHANNEL {number}  ----------",
        ]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1")


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Three channels."""
    east, north, up = (10.0 * channel.acceleration / STANDARD_GRAVITY for channel in channels)
    content = renadic(
        [north, up, east],
        ("NS", "V", "EW"),
        dt=channels[0].dt,
        trigger="7/6/2019 3:19:58.000 GMT",
        event=NOTE,
        name="CHINA LAKE",
    )
    return {"clc_renadic.v1": content}
