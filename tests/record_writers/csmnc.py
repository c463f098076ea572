"""CSMNC (China)."""

from collections.abc import Sequence

import numpy as np

from record_writers._shared import NOTE, peak_time, rows
from rockpulse.record.record import Record


def csmnc(
    values: Sequence[float],
    component: str = "EW",
    kind: str = "UNCORRECTED ACCELERATION",
    unit: str = "CM/SEC/SEC",
    count: int | None = None,
    dt: str = "0.005",
    point: str = "GROUND",
    station: str = "051XXX",
    event: str = "TEST EARTHQUAKE",
    origin: str = "0130420080246 2013-04-20 8:2:46 BTM",
    mark: str = "",
    field: str = "{:12.6E} ",
) -> bytes:
    """One component [cm/s2]; `mark` is the ``$`` that some copies have at the end of every line."""
    largest = values[int(np.argmax(np.abs(values)))]
    number = len(values) if count is None else count
    lines = [
        f"{station}130420080201",
        origin,
        event,
        "EPICENTER  35.770N 117.599W DEPTH 8 KM",
        "MAGNITUDE  7.1(Mw)",
        f"STATION: {station} 35.816N 117.598W",
        "SITE CONDITION: UNKNOWN",
        "INSTRUMENT TYPE: MR2002/SLJ-100",
        f"OBSERVING POINT: {point}",
        f"COMP. {component}",
        f"{kind}          UNIT: {unit}",
        f"NO. OF POINTS:  {number}  EQUALLY SPACED INTERVALS OF:  {dt}  SEC",
        f"PEAK VALUE: {largest:13.3f}   AT {peak_time(values, float(dt)):7.2f} SEC    DURATION: "
        f"{len(values) * float(dt):3.0f} SEC",
        "PRE-EVENT TIME:  20  SEC",
        "CSMNC",
        "",
        *rows([_short(value, field) for value in values], 8),
    ]
    return ("\r\n".join(line + mark for line in lines) + "\r\n").encode()


def _short(value: float, field: str) -> str:
    """`` 3.888539E-2 ``: one digit of the exponent, as the files have it, where the default field is used."""
    if field != "{:12.6E} ":
        return field.format(value)
    mantissa, exponent = f"{value:.6E}".split("E")
    return f"{f'{mantissa}E{int(exponent)}':>12} "


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """One file for each component."""
    files = {}
    for channel, component in zip(channels, ("EW", "NS", "UD"), strict=True):
        content = csmnc(
            100.0 * channel.acceleration,
            component=component,
            dt="0.01",
            station="CLC",
            event=NOTE,
            origin="0190706111953 2019-07-06 11:19:53 BTM",
        )
        files[f"clc_csmnc.{component}.dat"] = content
    return files
