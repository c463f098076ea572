"""USGS SMC."""

from collections.abc import Mapping, Sequence

import numpy as np

from record_writers._shared import NOTE, rows
from rockpulse.record.record import Record


def _smc_field(value: float) -> str:
    mantissa, exponent = f"{value if abs(value) > 1e-9 else 0.0:.4E}".split("E")
    return f"{mantissa}E{int(exponent):+d}".rjust(10)


def smc(
    values: Sequence[float],
    kind: str = "2 CORRECTED ACCELEROGRAM",
    rate: float | None = 100.0,
    station: str = "CA: Somewhere; Fire Station",
    component: str = "360",
    azimuth: int = 360,
    vertical: int = -32768,
    count: int | None = None,
    moment: Sequence[int] = (2011, 235, 17, 50, 56, 250),
    codes: Mapping[int, int] = {},
    facts: Mapping[int, float] = {},
    event: str = "2011  08  23    1751 TEST EARTHQUAKE",
    note: str = "written by a test",
) -> bytes:
    null, null_real = -32768, 1.7e38
    integers = [null] * 48
    integers[1:7] = moment
    integers[12], integers[13], integers[15] = vertical, azimuth, 2
    integers[16] = len(values) if count is None else count
    integers[29] = 2555
    for number, code in codes.items():
        integers[number - 1] = code
    reals = [null_real] * 50
    reals[1] = null_real if rate is None else rate
    accelerations = values if rate is not None else values[1::2]
    times = np.arange(len(values)) / rate if rate is not None else values[::2]
    for number, at in ((28, int(np.argmax(accelerations))), (30, int(np.argmin(accelerations)))):
        reals[number : number + 2] = times[at], accelerations[at]
    for number, fact in facts.items():
        reals[number - 1] = fact
    lines = [
        kind,
        "*",
        "2555b",
        f"     {event}",
        "Moment Mag= 5.80     Ms=          Ml=",
        f"station = {station}   component= {component}",
        f"epicentral dist =    121.4       pk acc =  {np.max(np.abs(accelerations)):.2E}",
        "inst type=K2         data source = USGS",
        *"***",
        *rows([f"{number:10d}" for number in integers], 8),
        *rows([f"{number:15.7E}" for number in reals], 5),
        "|",
        f"| {note}",
        *rows([_smc_field(value) for value in values], 8),
    ]
    return ("\n".join(lines) + "\n").encode()


def samples(channels: Sequence[Record]) -> dict[str, bytes]:
    """Corrected at equal steps, uncorrected at equal steps, uncorrected in pairs of time and acceleration."""
    east, north, up = (100.0 * channel.acceleration for channel in channels)
    raw = "1 UNCORRECTED ACCELEROGRAM"
    event = "2019  07  06    0319 RIDGECREST, CA"
    common = {"event": event, "station": "CA: China Lake", "moment": (2019, 187, 3, 19, 58, 0), "note": NOTE}
    pairs = np.column_stack([channels[0].time, east]).ravel()
    return {
        "clc_1.smc": smc(pairs, raw, rate=None, component="90", azimuth=90, **common),
        "clc_2.smc": smc(north, component="360", azimuth=360, **common),
        "clc_3.smc": smc(up, raw, component="UP", azimuth=-32768, vertical=0, **common),
    }
